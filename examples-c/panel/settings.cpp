// SPDX-License-Identifier: MIT OR Apache-2.0
// settings.cpp -- see settings.h; the film's settings are in film_settings.cpp.
#include "settings.h"

#include "../matter.h"

#include <cmath>
#include <cstring>

namespace {

bool every_field(const Field &) {
    return true;
}

} // namespace

void SettingsPanel::hole(Scene &scene, const BhrHoleInfo &numbers) {
    if (!section("Hole", true)) {
        return;
    }
    const Hole &now = scene.hole();
    number("mass M", now.mass, 0.05, 20.0, "%.3f", true, [&](double mass) { return scene.set_mass(mass); },
           "the hole's mass, as a length: G M / c^2\nunit: scene lengths, the chart's\n\nbhr_set_mass in bhr.h");
    number("spin a / M", now.spin, -0.999, 0.999, "%.3f", false, [&](double spin) { return scene.set_spin(spin); },
           "the angular momentum a, over M; 0: Schwarzschild's metric, else Kerr's\nrange: -0.9999 .. 0.9999\n\n"
           "bhr_set_spin in bhr.h; docs/physics.md\nR. P. Kerr 1963; a disk's own light keeps it at 0.998 or below: "
           "K. S. Thorne 1974");
    vector("axis", now.axis, [&](const double *axis) { return scene.set_axis(axis); },
           "the direction of the spin, in scene axes, of any length\n\nbhr_set_axis in bhr.h");
    ImGui::BeginGroup();
    fact("horizon", numbers.horizon_radius, "%.4f", true);
    fact("ergosphere", numbers.ergosphere_equatorial_radius, "%.4f", false);
    fact("photon +", numbers.photon_orbit_prograde, "%.4f", true);
    fact("photon -", numbers.photon_orbit_retrograde, "%.4f", false);
    fact("ISCO +", numbers.isco_prograde, "%.4f", true);
    fact("ISCO -", numbers.isco_retrograde, "%.4f", false);
    fact("critical b", numbers.critical_impact_parameter, "%.4f", true);
    fact("shadow", numbers.shadow_angular_radius / DEGREE, "%.3f\xC2\xB0", false);
    ImGui::EndGroup();
    tell("radii in the equatorial plane: the horizon, the ergosphere's edge, circular orbits of light and the "
         "innermost stable ones of matter, + with the spin and - against it; without spin also the critical impact "
         "parameter and the shadow's angular radius\nunit: scene lengths\n\nBhrHoleInfo in bhr.h\n"
         "Bardeen, Press and Teukolsky 1972; the shadow: J. L. Synge 1966");
}

void SettingsPanel::camera(Scene &scene, const BhrHoleInfo &numbers) {
    if (!section("Camera", true)) {
        return;
    }
    const Orbit orbit = scene.orbit();
    number("distance", orbit.distance, 1.0, 500.0, "%.3f", true,
           [&](double distance) { return scene.set_orbit({distance, orbit.azimuth, orbit.elevation}); },
           "from the hole's centre, in the chart\nunit: scene lengths\n\nbhr_camera_orbit in bhr.h; docs/cameras.md");
    number("azimuth", orbit.azimuth / DEGREE, -180.0, 180.0, "%.2f\xC2\xB0", false,
           [&](double degrees) { return scene.set_orbit({orbit.distance, degrees * DEGREE, orbit.elevation}); },
           "about scene z, from scene x\nunit: degrees; in bhr.h radians\n\n"
           "bhr_camera_orbit in bhr.h; docs/cameras.md");
    number("elevation", orbit.elevation / DEGREE, -90.0, 90.0, "%.2f\xC2\xB0", false,
           [&](double degrees) { return scene.set_orbit({orbit.distance, orbit.azimuth, degrees * DEGREE}); },
           "above the scene's x-y plane\nunit: degrees; in bhr.h radians\n\n"
           "bhr_camera_orbit in bhr.h; docs/cameras.md");
    BhrCamera camera = scene.camera();
    number("field of view", camera.fov_y / DEGREE, 1.0, 170.0, "%.1f\xC2\xB0", false, [&](double degrees) {
        camera.fov_y = degrees * DEGREE;
        return scene.set_camera(camera);
    }, "from the picture's lower edge to its upper one\nunit: degrees; in bhr.h radians\n\n"
       "BhrCamera.fov_y in bhr.h; docs/cameras.md");
    choice("motion", camera.motion, MOTIONS, [&](int32_t motion) {
        camera.motion = motion;
        return scene.set_camera(camera);
    }, "how the observer moves: aberration and the Doppler shift follow from it\n\n"
       "BhrCamera.motion in bhr.h; docs/cameras.md");
    if (camera.motion == BHR_MOTION_VELOCITY) {
        vector("velocity / c", camera.velocity, [&](const double *velocity) {
            std::copy(velocity, velocity + 3, camera.velocity);
            return scene.set_camera(camera);
        }, "against the observer at rest there, in scene axes\nunit: c\nrange: below 1\n\n"
           "BhrCamera.velocity in bhr.h; docs/cameras.md");
    }
    fact("r", numbers.camera_radius, "%.4f", true);
    fact("d tau / d t", numbers.camera_time_rate, "%.6f", false);
}

void SettingsPanel::disk(Scene &scene) {
    if (!section("Disk", true)) {
        return;
    }
    BhrDisk disk = scene.disk();
    bool    present = scene.has_disk();
    if (ImGui::Checkbox("disk", &present)) {
        report("Disk", "disk", scene.set_disk(present ? &disk : nullptr).message);
    }
    show_message("disk");
    if (!present) {
        return;
    }
    const BhrDisk defaults = with_defaults(bhr_disk_init);
    fields(DISK_FIELDS, &disk, &defaults, [&] { return scene.set_disk(&disk); }, every_field);
}

void SettingsPanel::volume(Scene &scene, size_t index) {
    static const char *const names[BHR_MAX_VOLUMES] = {"Volume 1", "Volume 2", "Volume 3", "Volume 4"};
    if (!section(names[index], false)) {
        return;
    }
    ImGui::PushID(names[index]);
    std::vector<BhrVolume> volumes = scene.volumes();
    BhrVolume             &volume = volumes[index];
    const auto             set = [&] { return scene.set_volumes(volumes); };
    // Each shape begins with values that suit it.
    choice("shape", volume.shape, VOLUME_KINDS, [&](int32_t shape) {
        const Result begun = result_of(volume_begin(&volume, shape));
        return begun.ok() ? set() : begun;
    }, "the place of the volume's matter; another shape begins with values that suit it\n\n"
       "BhrVolume.shape in bhr.h; docs/matter.md");
    const BhrVolume defaults = with_defaults(bhr_volume_init);
    fields(VOLUME_FIELDS, &volume, &defaults, set, [](const Field &field) { return field.choices != VOLUME_KINDS; });
    ImGui::PopID();
}

void SettingsPanel::hot_spot(Scene &scene, size_t index) {
    static const char *const names[BHR_MAX_HOT_SPOTS] = {"Hot spot 1", "Hot spot 2", "Hot spot 3", "Hot spot 4",
                                                         "Hot spot 5", "Hot spot 6", "Hot spot 7", "Hot spot 8"};
    if (!section(names[index], false)) {
        return;
    }
    ImGui::PushID(names[index]);
    std::vector<BhrHotSpot> spots = scene.hot_spots();
    BhrHotSpot             &spot = spots[index];
    const BhrHotSpot defaults = with_defaults(bhr_hot_spot_init);
    fields(HOT_SPOT_FIELDS, &spot, &defaults, [&] { return scene.set_hot_spots(spots); }, every_field);
    ImGui::PopID();
}

// How many there are, and each in a section of its own. New ones are the library's defaults.
void SettingsPanel::matter(Scene &scene) {
    if (section("Matter with depth", true)) {
        std::vector<BhrVolume>  volumes = scene.volumes();
        std::vector<BhrHotSpot> spots = scene.hot_spots();
        whole("volumes", static_cast<uint32_t>(volumes.size()), 0, BHR_MAX_VOLUMES, [&](uint32_t count) {
            volumes.resize(std::min<size_t>(count, BHR_MAX_VOLUMES), with_defaults(bhr_volume_init));
            return scene.set_volumes(volumes);
        }, "clouds of matter about the hole: disk, torus, halo, jet; each has a section below\n\n"
           "BhrVolume in bhr.h; docs/matter.md");
        whole("hot spots", static_cast<uint32_t>(spots.size()), 0, BHR_MAX_HOT_SPOTS, [&](uint32_t count) {
            spots.resize(std::min<size_t>(count, BHR_MAX_HOT_SPOTS), with_defaults(bhr_hot_spot_init));
            return scene.set_hot_spots(spots);
        }, "blobs of matter that orbit the hole, or fall; each has a section below\n\n"
           "BhrHotSpot in bhr.h; docs/matter.md");
    }
    for (size_t i = 0; i < scene.volumes().size(); i++) {
        volume(scene, i);
    }
    for (size_t i = 0; i < scene.hot_spots().size(); i++) {
        hot_spot(scene, i);
    }
}

void SettingsPanel::sky(Scene &scene) {
    if (!section("Sky", true)) {
        return;
    }
    BhrSky sky = scene.sky();
    const BhrSky defaults = with_defaults(bhr_sky_init);
    fields(SKY_FIELDS, &sky, &defaults, [&] { return scene.set_sky(sky); }, every_field);
    // The part of the orientation that a slider can show: a turn about the scene's z.
    const double turn = 2.0 * std::atan2(sky.orientation[2], sky.orientation[3]) / DEGREE;
    number("turned by", turn, -180.0, 180.0, "%.1f\xC2\xB0", false, [&](double degrees) {
        sky.orientation[2] = std::sin(0.5 * degrees * DEGREE);
        sky.orientation[3] = std::cos(0.5 * degrees * DEGREE);
        return scene.set_sky(sky);
    }, "the sky's turn about scene z\nunit: degrees\n\nBhrSky.orientation in bhr.h; docs/maps.md");
}

void SettingsPanel::quality(Scene &scene, FrameSettings &frames) {
    if (!section("Quality", true)) {
        return;
    }
    BhrQuality quality = scene.quality();
    // Two fields say how far a step goes; each method reads one of them. The picture has a scale of its own.
    const char *unread = quality.method == BHR_METHOD_ADAPTIVE ? "--step" : "--tolerance";
    const BhrQuality defaults = with_defaults(bhr_quality_init);
    fields(QUALITY_FIELDS, &quality, &defaults, [&] { return scene.set_quality(quality); },
           [&](const Field &field) {
               return std::strcmp(field.option, unread) != 0 && std::strcmp(field.option, "--render-scale") != 0;
           });
    number("resolution", frames.scale, 0.1, 1.0, "%.2f", false, [&](double scale) {
        frames.scale = std::clamp(scale, 0.1, 1.0);
        return Result{};
    }, "of the traced picture, against its place in the window\nrange: 0.1 .. 1");
    whole("in flight", frames.in_flight, 1, static_cast<uint32_t>(FrameQueue::CAPACITY), [&](uint32_t count) {
        frames.in_flight = std::clamp(count, 1U, static_cast<uint32_t>(FrameQueue::CAPACITY));
        return Result{};
    }, "pictures that are asked for before the first of them has come\n\n"
       "bhr_render_image_async in bhr.h; docs/jobs.md");
    ImGui::Checkbox("coarser while moving", &frames.adaptive);
    tell("a picture with fewer pixels while it changes, so that it follows the hand");
    ImGui::SameLine();
    ImGui::Checkbox("never rest", &frames.always);
    tell("frames go on where nothing has changed: to measure their speed");
}

void SettingsPanel::view(Scene &scene) {
    if (!section("View", true)) {
        return;
    }
    choice("view", scene.view(), VIEWS, [&](int32_t view) { return scene.set_view(view); },
           "the quantity that pixels show; all but light are in false colour, without film\n\n"
           "bhr_set_view in bhr.h; docs/views.md has the colours and their scales");
}

// A switch and a strength each, but for the delay, which has no strength.
void SettingsPanel::effects(Scene &scene) {
    if (!section("Effects", true)) {
        return;
    }
    static const struct {
        const char *name, *strength;
        uint32_t    bit;
        const char *about;
    } rows[] = {
        {"Doppler shift", "strength##Doppler", BHR_EFFECT_DOPPLER_SHIFT,
         "the frequency shift by motion colours the light"},
        {"gravity shift", "strength##gravity", BHR_EFFECT_GRAVITY_SHIFT,
         "the gravitational redshift colours the light"},
        {"beaming", "strength##beaming", BHR_EFFECT_BEAMING, "the intensity follows g^3 (I_nu), g^4 (all light)"},
        {"light delay", nullptr, BHR_EFFECT_LIGHT_DELAY, "moving matter is seen where it was when its light left"},
    };
    const auto set = [&](uint32_t effects) { return scene.set_effects(effects); };
    for (const auto &row : rows) {
        flag(row.name, scene.effects(), row.bit, set,
             std::string(row.about) + "\n\nbhr_set_effects in bhr.h; docs/physics.md");
        show_message(row.name);
        if (row.strength != nullptr) {
            ImGui::BeginDisabled((scene.effects() & row.bit) == 0);
            number(row.strength, scene.effect_strength(row.bit), 0.0, 1.0, "%.2f", false,
                   [&](double strength) { return scene.set_effect_strength(row.bit, strength); },
                   std::string("the strength of: ") + row.about + "; its factor counts to this power, for films; 1 is "
                   "physics\nrange: 0 .. 1\n\nbhr_set_effect_strength in bhr.h; docs/physics.md\nas for "
                   "\"Interstellar\": O. James et al. 2015");
            ImGui::EndDisabled();
        }
    }
}

void SettingsPanel::time(Scene &scene, Clock &clock) {
    if (!section("Time", true)) {
        return;
    }
    const ImVec2 button(0.9F * LABEL_EMS * ImGui::GetFontSize(), 0.0F);
    if (ImGui::Button(clock.running ? "pause" : "run", button)) {
        clock.running = !clock.running;
    }
    ImGui::SameLine(LABEL_EMS * ImGui::GetFontSize());
    ImGui::Checkbox("camera follows its motion", &clock.moves_camera);
    tell("a camera that falls or orbits goes on along its world line\n\n"
         "bhr_camera_advance in bhr.h; docs/cameras.md");
    show_message("camera follows its motion");
    number("speed, M / s", clock.speed, -100.0, 100.0, "%.1f", false, [&](double speed) {
        clock.speed = speed;
        return Result{};
    }, "of the scene's time\nunit: M a second of yours");
    number("time", scene.time(), 0.0, 1000.0 * scene.hole().mass, "%.2f", false,
           [&](double time) { return scene.set_time(time); },
           "the scene's time, which matter moves by\nunit: scene lengths, by the speed of light\n\n"
           "bhr_set_time in bhr.h");
    number("shutter", scene.shutter(), 0.0, 20.0 * scene.hole().mass, "%.2f", false,
           [&](double duration) { return scene.set_shutter(duration); },
           "how long the shutter is open: matter that moves is seen at as many moments as a pixel has samples\n"
           "unit: scene lengths; 0: a moment\n\n"
           "bhr_set_shutter in bhr.h; docs/motion-blur.md");
}

void SettingsPanel::draw(Scene &scene, const BhrHoleInfo &numbers, FrameSettings &frames, Clock &clock,
                         SectionReports &reports, const std::function<void()> &light) {
    forget_places();
    if (!ImGui::BeginTabBar("settings")) {
        return;
    }
    // The rest of the window is a part that scrolls; the tabs, and what stands above it, stay.
    const auto tab = [&](const char *name, const char *tip, const std::function<void()> &above,
                         const std::function<void()> &content) {
        begin_section("tabs");
        const bool chosen = ImGui::BeginTabItem(name);
        mark(name);
        tell(tip);
        if (!chosen) {
            return;
        }
        above();
        {
            const Part part(reports, (std::string("Settings, ") + name).c_str(), {0.0F, 0.0F});
            content();
        }
        ImGui::EndTabItem();
    };
    const auto nothing = [] {};
    tab("Scene", "hole, camera, disk, matter with depth, sky", nothing, [&] {
        hole(scene, numbers);
        camera(scene, numbers);
        disk(scene);
        matter(scene);
        sky(scene);
    });
    tab("Film", "from light to pixels: exposure, grade, curve, lens, grain, LUT", light, [&] { film(scene); });
    tab("Effects", "the view, relativistic effects, the clock", nothing, [&] {
        view(scene);
        effects(scene);
        time(scene, clock);
    });
    tab("Frames", "how rays are followed, and how frames are made", nothing, [&] { quality(scene, frames); });
    ImGui::EndTabBar();
}

void SettingsPanel::mark_tab(const char *bar, const char *name) {
    begin_section(bar);
    mark(name);
}
