// SPDX-License-Identifier: MIT OR Apache-2.0
// settings.cpp -- see settings.h.
#include "settings.h"

#include "../matter.h"
#include "draw.h"

#include <cmath>
#include <cstdio>
#include <imgui.h>

namespace {

constexpr float LABEL_EMS = 6.6F; // the width of the labels' column

// A row's label; the widget goes on beside it with the rest of the line.
void begin_row(const char *label) {
    ImGui::PushID(label);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(label);
    ImGui::SameLine(LABEL_EMS * ImGui::GetFontSize());
    ImGui::SetNextItemWidth(-1.0F);
}

// Two numbers a row.
void fact(const char *name, double value, const char *format, bool left) {
    if (!left) {
        ImGui::SameLine(0.5F * ImGui::GetWindowContentRegionMax().x);
    }
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim), "%s", name);
    ImGui::SameLine(0.0F, 0.4F * ImGui::GetFontSize());
    if (std::isnan(value)) {
        ImGui::TextUnformatted("-");
    } else {
        ImGui::Text(format, value);
    }
}

} // namespace

void SettingsPanel::report(const char *section, const char *widget, const std::string &message) {
    const std::string key = std::string(section) + "/" + widget;
    if (message.empty()) {
        messages_.erase(key);
        refused_.erase(key);
    } else if (messages_[key] != message) {
        messages_[key] = last_refusal_ = message;
        refusals_++;
    }
}

void SettingsPanel::show_message(const char *label) {
    const auto found = messages_.find(std::string(section_) + "/" + label);
    if (found == messages_.end()) {
        return;
    }
    ImGui::PushStyleColor(ImGuiCol_Text, colour::error);
    ImGui::TextWrapped("%s", found->second.c_str());
    ImGui::PopStyleColor();
}

bool SettingsPanel::section(const char *name, bool open) {
    section_ = name;
    return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None);
}

// ImGui offers a number that is being typed anew with every frame, as long as it is not the one in force: what was
// refused is not asked for again.
template <class Set> void SettingsPanel::try_number(const char *label, double value, Set set) {
    const std::string key = std::string(section_) + "/" + label;
    if (const auto found = refused_.find(key); found != refused_.end() && found->second == value) {
        return;
    }
    const Result result = set();
    report(section_, label, result.message);
    if (!result.ok()) {
        refused_[key] = value;
    }
}

// low and high bound the slider only: with Ctrl and a click any number can be typed, and the library judges it.
template <class Set>
void SettingsPanel::number(const char *label, double value, double low, double high, const char *format,
                           bool logarithmic, Set set) {
    begin_row(label);
    const ImGuiSliderFlags flags = logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
    if (ImGui::SliderScalar("##value", ImGuiDataType_Double, &value, &low, &high, format, flags)) {
        try_number(label, value, [&] { return set(value); });
    }
    ImGui::PopID();
    show_message(label);
}

template <class Set>
void SettingsPanel::whole(const char *label, uint32_t value, uint32_t low, uint32_t high, Set set) {
    begin_row(label);
    const ImGuiSliderFlags flags = high > 100 ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
    if (ImGui::SliderScalar("##value", ImGuiDataType_U32, &value, &low, &high, "%u", flags)) {
        try_number(label, value, [&] { return set(value); });
    }
    ImGui::PopID();
    show_message(label);
}

template <class Set> void SettingsPanel::vector(const char *label, const double value[3], Set set) {
    double edited[3] = {value[0], value[1], value[2]};
    begin_row(label);
    if (ImGui::DragScalarN("##value", ImGuiDataType_Double, edited, 3, 0.005F, nullptr, nullptr, "%.3f")) {
        report(section_, label, set(edited).message);
    }
    ImGui::PopID();
    show_message(label);
}

// names[i] stands for the constant first + i.
template <class Set>
void SettingsPanel::choice(const char *label, int32_t value, const char *const *names, int32_t count, int32_t first,
                           Set set) {
    int index = value - first;
    begin_row(label);
    if (ImGui::Combo("##value", &index, names, count)) {
        report(section_, label, set(first + index).message);
    }
    ImGui::PopID();
    show_message(label);
}

template <class Set> void SettingsPanel::flag(const char *label, uint32_t flags, uint32_t bit, Set set) {
    if (ImGui::CheckboxFlags(label, &flags, bit)) {
        report(section_, label, set(flags).message);
    }
}

void SettingsPanel::hole(Scene &scene, const BhrHoleInfo &numbers) {
    if (!section("Hole", true)) {
        return;
    }
    const Hole &now = scene.hole();
    number("mass M", now.mass, 0.05, 20.0, "%.3f", true, [&](double mass) { return scene.set_mass(mass); });
    number("spin a / M", now.spin, -0.999, 0.999, "%.3f", false, [&](double spin) { return scene.set_spin(spin); });
    vector("axis", now.axis, [&](const double axis[3]) { return scene.set_axis(axis); });
    fact("horizon", numbers.horizon_radius, "%.4f", true);
    fact("ergosphere", numbers.ergosphere_equatorial_radius, "%.4f", false);
    fact("photon +", numbers.photon_orbit_prograde, "%.4f", true);
    fact("photon -", numbers.photon_orbit_retrograde, "%.4f", false);
    fact("ISCO +", numbers.isco_prograde, "%.4f", true);
    fact("ISCO -", numbers.isco_retrograde, "%.4f", false);
    fact("critical b", numbers.critical_impact_parameter, "%.4f", true);
    fact("shadow", numbers.shadow_angular_radius / DEGREE, "%.3f\xC2\xB0", false);
}

void SettingsPanel::camera(Scene &scene, const BhrHoleInfo &numbers) {
    if (!section("Camera", true)) {
        return;
    }
    const Orbit orbit = scene.orbit();
    number("distance", orbit.distance, 1.0, 500.0, "%.3f", true,
           [&](double distance) { return scene.set_orbit({distance, orbit.azimuth, orbit.elevation}); });
    number("azimuth", orbit.azimuth / DEGREE, -180.0, 180.0, "%.2f\xC2\xB0", false,
           [&](double degrees) { return scene.set_orbit({orbit.distance, degrees * DEGREE, orbit.elevation}); });
    number("elevation", orbit.elevation / DEGREE, -90.0, 90.0, "%.2f\xC2\xB0", false,
           [&](double degrees) { return scene.set_orbit({orbit.distance, orbit.azimuth, degrees * DEGREE}); });
    BhrCamera camera = scene.camera();
    number("field of view", camera.fov_y / DEGREE, 1.0, 170.0, "%.1f\xC2\xB0", false, [&](double degrees) {
        camera.fov_y = degrees * DEGREE;
        return scene.set_camera(camera);
    });
    constexpr const char *motions[] = {"static", "free fall", "orbit", "velocity"};
    choice("motion", camera.motion, motions, 4, BHR_MOTION_STATIC, [&](int32_t motion) {
        camera.motion = motion;
        return scene.set_camera(camera);
    });
    if (camera.motion == BHR_MOTION_VELOCITY) {
        vector("velocity / c", camera.velocity, [&](const double velocity[3]) {
            std::copy(velocity, velocity + 3, camera.velocity);
            return scene.set_camera(camera);
        });
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
        report(section_, "disk", scene.set_disk(present ? &disk : nullptr).message);
    }
    show_message("disk");
    if (!present) {
        return;
    }
    ImGui::SameLine(LABEL_EMS * ImGui::GetFontSize());
    const auto set = [&] { return scene.set_disk(&disk); };
    const auto set_flags = [&](uint32_t flags) {
        disk.flags = flags;
        return set();
    };
    flag("retrograde", disk.flags, BHR_DISK_RETROGRADE, set_flags);
    ImGui::SameLine();
    flag("plunges", disk.flags, BHR_DISK_PLUNGES, set_flags);
    const auto field = [&](const char *label, double BhrDisk::*member, double low, double high, const char *format,
                           bool logarithmic) {
        number(label, disk.*member, low, high, format, logarithmic, [&](double value) {
            disk.*member = value;
            return set();
        });
    };
    const char *begin = (disk.flags & BHR_DISK_PLUNGES) != 0 ? "horizon" : "ISCO";
    const char *innermost = disk.inner_radius > 0.0 ? "%.2f" : begin;
    field("inner / M", &BhrDisk::inner_radius, 0.0, 20.0, innermost, false);
    field("outer / M", &BhrDisk::outer_radius, 2.0, 100.0, "%.2f", true);
    field("temperature", &BhrDisk::temperature, 500.0, 1e6, "%.0f K", true);
    field("opacity", &BhrDisk::opacity, 0.0, 1.0, "%.2f", false);
    field("brightness", &BhrDisk::brightness, 0.01, 100.0, "%.2f", true);
    field("turbulence", &BhrDisk::turbulence, 0.0, 1.0, "%.2f", false);
    seed(disk.seed, set);
}

template <class Set> void SettingsPanel::seed(uint64_t &value, Set set) {
    begin_row("seed");
    constexpr uint64_t one = 1;
    if (ImGui::InputScalar("##value", ImGuiDataType_U64, &value, &one)) {
        report(section_, "seed", set().message);
    }
    ImGui::PopID();
    show_message("seed");
}

// A field of a struct of the library: the slider's range, and what it shows.
template <class Struct> struct NumberField {
    const char    *label;
    double Struct::*member;
    double         low, high;
    const char    *format;
    bool           logarithmic;
    double         unit; // of what is shown
};

// A new field of BhrVolume is one line here.
constexpr NumberField<BhrVolume> VOLUME_FIELDS[] = {
    {"inner / M", &BhrVolume::inner_radius, 0.0, 30.0, "%.2f", false, 1.0},
    {"outer / M", &BhrVolume::outer_radius, 2.0, 200.0, "%.2f", true, 1.0},
    {"radius / M", &BhrVolume::radius, 0.5, 50.0, "%.2f", true, 1.0},
    {"width / M", &BhrVolume::width, 0.1, 20.0, "%.2f", true, 1.0},
    {"thickness", &BhrVolume::thickness, 0.01, 2.0, "%.3f", true, 1.0},
    {"opening", &BhrVolume::opening, 1.0, 85.0, "%.1f\xC2\xB0", false, DEGREE},
    {"slope", &BhrVolume::slope, 0.0, 4.0, "%.2f", false, 1.0},
    {"absorption", &BhrVolume::absorption, 1e-3, 1e3, "%.4g", true, 1.0},
    {"temperature", &BhrVolume::temperature, 500.0, 1e6, "%.0f K", true, 1.0},
    {"its slope", &BhrVolume::temperature_slope, 0.0, 2.0, "%.2f", false, 1.0},
    {"index", &BhrVolume::spectral_index, -4.0, 4.0, "%.2f", false, 1.0},
    {"brightness", &BhrVolume::brightness, 0.01, 100.0, "%.2f", true, 1.0},
    {"sub-Kepler", &BhrVolume::sub_keplerian, 0.0, 1.0, "%.2f", false, 1.0},
    {"infall", &BhrVolume::infall, 0.0, 1.0, "%.2f", false, 1.0},
    {"ang. mom.", &BhrVolume::angular_momentum, 0.0, 1.0, "%.2f", false, 1.0},
    {"speed", &BhrVolume::speed, 0.0, 0.995, "%.3f", false, 1.0},
    {"turbulence", &BhrVolume::turbulence, 0.0, 1.0, "%.2f", false, 1.0},
    {"clumping", &BhrVolume::clumping, 0.5, 3.0, "%.2f", false, 1.0},
    {"heating", &BhrVolume::heating, 0.0, 0.5, "%.2f", false, 1.0},
};

constexpr NumberField<BhrHotSpot> HOT_SPOT_FIELDS[] = {
    {"radius / M", &BhrHotSpot::radius, 2.0, 50.0, "%.2f", true, 1.0},
    {"size / M", &BhrHotSpot::size, 0.05, 5.0, "%.2f", true, 1.0},
    {"azimuth", &BhrHotSpot::azimuth, -180.0, 180.0, "%.1f\xC2\xB0", false, DEGREE},
    {"absorption", &BhrHotSpot::absorption, 0.0, 100.0, "%.3g", true, 1.0},
    {"temperature", &BhrHotSpot::temperature, 500.0, 1e6, "%.0f K", true, 1.0},
    {"index", &BhrHotSpot::spectral_index, -4.0, 4.0, "%.2f", false, 1.0},
    {"brightness", &BhrHotSpot::brightness, 0.01, 100.0, "%.2f", true, 1.0},
};

template <class Struct, size_t Count, class Set>
void SettingsPanel::fields(const NumberField<Struct> (&list)[Count], Struct &value, Set set) {
    for (const NumberField<Struct> &field : list) {
        number(field.label, value.*field.member / field.unit, field.low, field.high, field.format, field.logarithmic,
               [&](double shown) {
                   value.*field.member = shown * field.unit;
                   return set();
               });
    }
    vector("tint", value.tint, [&](const double tint[3]) {
        std::copy(tint, tint + 3, value.tint);
        return set();
    });
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
    const auto             set_flags = [&](uint32_t flags) {
        volume.flags = flags;
        return set();
    };
    constexpr const char *shapes[] = {"disk", "torus", "halo", "jet"};
    // Each shape begins with values that suit it.
    choice("shape", volume.shape, shapes, 4, BHR_VOLUME_DISK, [&](int32_t shape) {
        const Result begun = result_of(volume_begin(&volume, shape));
        return begun.ok() ? set() : begun;
    });
    constexpr const char *flows[] = {"Keplerian", "angular momentum", "outflow"};
    choice("flow", volume.flow, flows, 3, BHR_FLOW_KEPLERIAN, [&](int32_t flow) {
        volume.flow = flow;
        return set();
    });
    flag("retrograde", volume.flags, BHR_VOLUME_RETROGRADE, set_flags);
    ImGui::SameLine(0.5F * ImGui::GetWindowContentRegionMax().x);
    flag("power law", volume.flags, BHR_VOLUME_POWER_LAW, set_flags);
    fields(VOLUME_FIELDS, volume, set);
    seed(volume.seed, set);
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
    const auto              set = [&] { return scene.set_hot_spots(spots); };
    const auto              set_flags = [&](uint32_t flags) {
        spot.flags = flags;
        return set();
    };
    flag("retrograde", spot.flags, BHR_HOT_SPOT_RETROGRADE, set_flags);
    ImGui::SameLine(0.5F * ImGui::GetWindowContentRegionMax().x);
    flag("thermal", spot.flags, BHR_HOT_SPOT_THERMAL, set_flags);
    fields(HOT_SPOT_FIELDS, spot, set);
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
        });
        whole("hot spots", static_cast<uint32_t>(spots.size()), 0, BHR_MAX_HOT_SPOTS, [&](uint32_t count) {
            spots.resize(std::min<size_t>(count, BHR_MAX_HOT_SPOTS), with_defaults(bhr_hot_spot_init));
            return scene.set_hot_spots(spots);
        });
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
    BhrSky     sky = scene.sky();
    const auto set_flags = [&](uint32_t flags) {
        sky.flags = flags;
        return scene.set_sky(sky);
    };
    const struct {
        const char *name;
        uint32_t    bit;
    } parts[] = {{"stars", BHR_SKY_STARS},
                 {"milky way", BHR_SKY_MILKY_WAY},
                 {"grid", BHR_SKY_GRID},
                 {"random", BHR_SKY_PROCEDURAL},
                 {"map", BHR_SKY_MAP}};
    int column = 0;
    for (const auto &part : parts) {
        if (column % 3 != 0) {
            ImGui::SameLine(static_cast<float>(column % 3) * LABEL_EMS * ImGui::GetFontSize());
        }
        flag(part.name, sky.flags, part.bit, set_flags);
        column++;
    }
    for (const auto &part : parts) {
        show_message(part.name);
    }
    number("starlight", sky.stars_brightness, 0.01, 100.0, "%.2f", true, [&](double brightness) {
        sky.stars_brightness = brightness;
        return scene.set_sky(sky);
    });
    number("map's light", sky.map_brightness, 0.01, 100.0, "%.2f", true, [&](double brightness) {
        sky.map_brightness = brightness;
        return scene.set_sky(sky);
    });
    // The part of the orientation that a slider can show: a turn about the scene's z.
    const double turn = 2.0 * std::atan2(sky.orientation[2], sky.orientation[3]) / DEGREE;
    number("turned by", turn, -180.0, 180.0, "%.1f\xC2\xB0", false, [&](double degrees) {
        sky.orientation[2] = std::sin(0.5 * degrees * DEGREE);
        sky.orientation[3] = std::cos(0.5 * degrees * DEGREE);
        return scene.set_sky(sky);
    });
}

void SettingsPanel::film(Scene &scene) {
    if (!section("Film", true)) {
        return;
    }
    constexpr const char *presets[] = {"cinematic", "physical", "observatory", "teaching"};
    // None of them is in force once something else was changed: so none is shown as chosen.
    choice("preset", -1, presets, 4, BHR_PRESET_CINEMATIC, [&](int32_t preset) { return scene.set_preset(preset); });
    // The name of AUTO says which it has chosen.
    const bool  deep = scene.chosen_matter() == BHR_PRESET_MATTER_DEEP;
    const char *matters[] = {deep ? "auto: deep" : "auto: thin", "thin", "deep"};
    choice("its matter", scene.preset_matter(), matters, 3, BHR_PRESET_MATTER_AUTO,
           [&](int32_t matter) { return scene.set_preset_matter(matter); });
    BhrFilm               film = scene.film();
    constexpr const char *tone_maps[] = {"none", "ACES", "AgX"};
    choice("tone map", film.tone_map, tone_maps, 3, BHR_TONE_MAP_NONE, [&](int32_t tone_map) {
        film.tone_map = tone_map;
        return scene.set_film(film);
    });
    number("exposure", film.exposure_ev, -10.0, 10.0, "%+.2f EV", false, [&](double exposure) {
        film.exposure_ev = exposure;
        return scene.set_film(film);
    });
    number("bloom", film.bloom, 0.0, 1.0, "%.2f", false, [&](double bloom) {
        film.bloom = bloom;
        return scene.set_film(film);
    });
    number("beam", film.beam_fwhm, 0.0, 1.0, "%.3f", false, [&](double fwhm) {
        film.beam_fwhm = fwhm;
        return scene.set_film(film);
    });
    constexpr const char *colour_maps[] = {"none", "afmhot"};
    choice("colour map", film.colour_map, colour_maps, 2, BHR_COLOUR_MAP_NONE, [&](int32_t colour_map) {
        film.colour_map = colour_map;
        return scene.set_film(film);
    });
}

void SettingsPanel::quality(Scene &scene, FrameSettings &frames) {
    if (!section("Quality", true)) {
        return;
    }
    BhrQuality            quality = scene.quality();
    const auto            set = [&] { return scene.set_quality(quality); };
    constexpr const char *methods[] = {"auto (tables)", "RK4", "adaptive"};
    choice("method", quality.method, methods, 3, BHR_METHOD_AUTO, [&](int32_t method) {
        quality.method = method;
        return set();
    });
    whole("samples", quality.samples_per_pixel, 1, 64, [&](uint32_t samples) {
        quality.samples_per_pixel = samples;
        return set();
    });
    whole("steps, max", quality.max_steps, 16, 100000, [&](uint32_t steps) {
        quality.max_steps = steps;
        return set();
    });
    if (quality.method == BHR_METHOD_ADAPTIVE) {
        number("tolerance", quality.tolerance, 1e-14, 1e-3, quality.tolerance > 0.0 ? "%.1e" : "default", true,
               [&](double tolerance) {
                   quality.tolerance = tolerance;
                   return set();
               });
    } else {
        number("step", quality.step, 1e-3, 0.5, quality.step > 0.0 ? "%.3f" : "default", true, [&](double step) {
            quality.step = step;
            return set();
        });
    }
    whole("disk images", quality.max_disk_order, 0, 15, [&](uint32_t order) {
        quality.max_disk_order = order;
        return set();
    });
    number("resolution", frames.scale, 0.1, 1.0, "%.2f", false, [&](double scale) {
        frames.scale = std::clamp(scale, 0.1, 1.0);
        return Result{};
    });
    whole("in flight", frames.in_flight, 1, static_cast<uint32_t>(FrameQueue::CAPACITY), [&](uint32_t count) {
        frames.in_flight = std::clamp(count, 1U, static_cast<uint32_t>(FrameQueue::CAPACITY));
        return Result{};
    });
    ImGui::Checkbox("coarser while moving", &frames.adaptive);
    ImGui::SameLine();
    ImGui::Checkbox("never rest", &frames.always);
}

void SettingsPanel::view(Scene &scene) {
    if (!section("View and effects", true)) {
        return;
    }
    constexpr const char *views[] = {"light", "redshift", "order", "deflection", "steps", "metric -g_tt",
                                     "optical depth", "intensity"};
    choice("view", scene.view(), views, 8, BHR_VIEW_LIGHT, [&](int32_t view) { return scene.set_view(view); });
    const auto set = [&](uint32_t effects) { return scene.set_effects(effects); };
    flag("Doppler shift", scene.effects(), BHR_EFFECT_DOPPLER_SHIFT, set);
    ImGui::SameLine(0.5F * ImGui::GetWindowContentRegionMax().x);
    flag("gravity shift", scene.effects(), BHR_EFFECT_GRAVITY_SHIFT, set);
    flag("beaming", scene.effects(), BHR_EFFECT_BEAMING, set);
    ImGui::SameLine(0.5F * ImGui::GetWindowContentRegionMax().x);
    flag("light delay", scene.effects(), BHR_EFFECT_LIGHT_DELAY, set);
    for (const char *effect : {"Doppler shift", "gravity shift", "beaming", "light delay"}) {
        show_message(effect);
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
    show_message("camera follows its motion");
    number("speed, M / s", clock.speed, -100.0, 100.0, "%.1f", false, [&](double speed) {
        clock.speed = speed;
        return Result{};
    });
    number("time", scene.time(), 0.0, 1000.0 * scene.hole().mass, "%.2f", false,
           [&](double time) { return scene.set_time(time); });
}

void SettingsPanel::draw(Scene &scene, const BhrHoleInfo &numbers, FrameSettings &frames, Clock &clock) {
    hole(scene, numbers);
    camera(scene, numbers);
    disk(scene);
    matter(scene);
    sky(scene);
    film(scene);
    quality(scene, frames);
    view(scene);
    time(scene, clock);
}
