// SPDX-License-Identifier: MIT OR Apache-2.0
// settings.cpp -- see settings.h.
#include "settings.h"

#include "../matter.h"
#include "draw.h"
#include "field_look.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <imgui.h>

namespace {

constexpr float LABEL_EMS = 6.6F; // the width of the labels' column

// Says what the last widget is for, where the mouse rests on it. NULL: it needs no words.
void tell(const char *about) {
    if (about != nullptr && ImGui::IsItemHovered()) {
        ImGui::BeginTooltip();
        ImGui::PushTextWrapPos(40.0F * ImGui::GetFontSize());
        ImGui::TextUnformatted(about);
        ImGui::PopTextWrapPos();
        ImGui::EndTooltip();
    }
}

// A row's label; the widget goes on beside it with the rest of the line.
void begin_row(const char *label, const char *about) {
    ImGui::PushID(label);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(label);
    tell(about);
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

bool every_field(const Field &) {
    return true;
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
                           bool logarithmic, Set set, const char *about) {
    begin_row(label, about);
    const ImGuiSliderFlags flags = logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
    if (ImGui::SliderScalar("##value", ImGuiDataType_Double, &value, &low, &high, format, flags)) {
        try_number(label, value, [&] { return set(value); });
    }
    ImGui::PopID();
    show_message(label);
}

template <class Set>
void SettingsPanel::whole(const char *label, uint32_t value, uint32_t low, uint32_t high, Set set,
                          const char *about) {
    begin_row(label, about);
    const ImGuiSliderFlags flags = high > 100 ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
    if (ImGui::SliderScalar("##value", ImGuiDataType_U32, &value, &low, &high, "%u", flags)) {
        try_number(label, value, [&] { return set(value); });
    }
    ImGui::PopID();
    show_message(label);
}

template <class Set>
void SettingsPanel::vector(const char *label, const double value[3], Set set, const char *about) {
    double edited[3] = {value[0], value[1], value[2]};
    begin_row(label, about);
    if (ImGui::DragScalarN("##value", ImGuiDataType_Double, edited, 3, 0.005F, nullptr, nullptr, "%.3f")) {
        report(section_, label, set(edited).message);
    }
    ImGui::PopID();
    show_message(label);
}

// A value that is none of the choices shows nothing.
template <class Set>
void SettingsPanel::choice(const char *label, int32_t value, const Choice *choices, Set set, const char *about) {
    const Choice *chosen = choices;
    while (chosen->name != nullptr && chosen->value != value) {
        chosen++;
    }
    begin_row(label, about);
    if (ImGui::BeginCombo("##value", chosen->name != nullptr ? as_label(chosen->name).c_str() : "")) {
        for (; choices->name != nullptr; choices++) {
            if (ImGui::Selectable(as_label(choices->name).c_str(), choices->value == value)) {
                report(section_, label, set(choices->value).message);
            }
        }
        ImGui::EndCombo();
    }
    ImGui::PopID();
    show_message(label);
}

template <class Set> void SettingsPanel::flag(const char *label, uint32_t flags, uint32_t bit, Set set) {
    if (ImGui::CheckboxFlags(label, &flags, bit)) {
        report(section_, label, set(flags).message);
    }
}

// A widget for each field of a struct that `shown` is true for. defaults: such a struct as the library begins it.
template <class Struct, class Set, class Shown>
void SettingsPanel::fields(const Field *list, Struct &value, const Struct &defaults, Set set, Shown shown) {
    const auto at = [](const auto &object, const Field &field) {
        return reinterpret_cast<const char *>(&object) + field.offset;
    };
    for (const Field *field = list; field->option != nullptr; field++) {
        if (shown(*field)) {
            char *target = reinterpret_cast<char *>(&value) + field->offset;
            this->field(list, *field, target, at(defaults, *field), set);
        }
    }
}

// Assigns, and asks for the struct that has the new value.
template <class Set>
void SettingsPanel::field(const Field *list, const Field &field, char *target, const char *by_default, Set set) {
    const std::string label = label_of(list, field);
    const auto        assign = [&](auto value) {
        *reinterpret_cast<decltype(value) *>(target) = value;
        return set();
    };
    switch (field.kind) {
    case OPTION_BIT: {
        const uint32_t flags = *reinterpret_cast<const uint32_t *>(target);
        // Two in a row; the bits of a struct come first.
        if ((&field - list) % 2 == 1) {
            ImGui::SameLine(0.5F * ImGui::GetWindowContentRegionMax().x);
        }
        flag(label.c_str(), flags, static_cast<uint32_t>(field.choices->value), assign);
        tell(field.about);
        for (const Field *bit = list; (&field)[1].kind != OPTION_BIT && bit <= &field; bit++) {
            show_message(label_of(list, *bit).c_str()); // below the last of them
        }
        break;
    }
    case OPTION_BITS:
        bits(*reinterpret_cast<const uint32_t *>(target), field.choices, assign);
        break;
    case OPTION_CHOICE:
        choice(label.c_str(), *reinterpret_cast<const int32_t *>(target), field.choices, assign, field.about);
        break;
    case OPTION_UINT:
        whole(label.c_str(), *reinterpret_cast<const uint32_t *>(target), static_cast<uint32_t>(field.low),
              static_cast<uint32_t>(field.high), assign, field.about);
        break;
    case OPTION_UINT64:
        seed(label.c_str(), *reinterpret_cast<const uint64_t *>(target), assign, field.about);
        break;
    case OPTION_VECTOR:
        vector(label.c_str(), reinterpret_cast<const double *>(target), [&](const double edited[3]) {
            std::copy(edited, edited + 3, reinterpret_cast<double *>(target));
            return set();
        }, field.about);
        break;
    case OPTION_DOUBLE:
    case OPTION_DEGREES: {
        const double    now = *reinterpret_cast<const double *>(target);
        const FieldLook look = look_of(list, field, *reinterpret_cast<const double *>(by_default), now);
        number(look.label.c_str(), now / look.unit, look.low, look.high, look.format.c_str(), look.logarithmic,
               [&](double shown) { return assign(shown * look.unit); }, field.about);
        break;
    }
    default:
        break; // pairs and fours have no widget
    }
}

// A check box for each bit, three in a row.
template <class Set> void SettingsPanel::bits(uint32_t flags, const Choice *choices, Set set) {
    for (const Choice *part = choices; part->name != nullptr; part++) {
        const auto column = (part - choices) % 3;
        if (column != 0) {
            ImGui::SameLine(static_cast<float>(column) * LABEL_EMS * ImGui::GetFontSize());
        }
        flag(as_label(part->name).c_str(), flags, static_cast<uint32_t>(part->value), set);
    }
    for (const Choice *part = choices; part->name != nullptr; part++) {
        show_message(as_label(part->name).c_str());
    }
}

template <class Set>
void SettingsPanel::seed(const char *label, uint64_t value, Set set, const char *about) {
    begin_row(label, about);
    constexpr uint64_t one = 1;
    if (ImGui::InputScalar("##value", ImGuiDataType_U64, &value, &one)) {
        report(section_, label, set(value).message);
    }
    ImGui::PopID();
    show_message(label);
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
    choice("motion", camera.motion, MOTIONS, [&](int32_t motion) {
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
    fields(DISK_FIELDS, disk, with_defaults(bhr_disk_init), [&] { return scene.set_disk(&disk); }, every_field);
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
    });
    fields(VOLUME_FIELDS, volume, with_defaults(bhr_volume_init), set,
           [](const Field &field) { return field.choices != VOLUME_KINDS; });
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
    fields(HOT_SPOT_FIELDS, spot, with_defaults(bhr_hot_spot_init), [&] { return scene.set_hot_spots(spots); },
           every_field);
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
    BhrSky sky = scene.sky();
    fields(SKY_FIELDS, sky, with_defaults(bhr_sky_init), [&] { return scene.set_sky(sky); }, every_field);
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
    // None of them is in force once something else was changed: so none is shown as chosen.
    choice("preset", NO_PRESET, PRESETS, [&](int32_t preset) { return scene.set_preset(preset); });
    // The name of AUTO says which it has chosen.
    const bool deep = scene.chosen_matter() == BHR_PRESET_MATTER_DEEP;
    const Choice matters[] = {{deep ? "auto: deep" : "auto: thin", BHR_PRESET_MATTER_AUTO},
                              {"thin", BHR_PRESET_MATTER_THIN},
                              {"deep", BHR_PRESET_MATTER_DEEP},
                              {nullptr, 0}};
    choice("its matter", scene.preset_matter(), matters,
           [&](int32_t matter) { return scene.set_preset_matter(matter); });
    BhrFilm film = scene.film();
    fields(FILM_FIELDS, film, with_defaults(bhr_film_init), [&] { return scene.set_film(film); }, every_field);
}

void SettingsPanel::quality(Scene &scene, FrameSettings &frames) {
    if (!section("Quality", true)) {
        return;
    }
    BhrQuality quality = scene.quality();
    // Two fields say how far a step goes; each method reads one of them. The picture has a scale of its own.
    const char *unread = quality.method == BHR_METHOD_ADAPTIVE ? "--step" : "--tolerance";
    fields(QUALITY_FIELDS, quality, with_defaults(bhr_quality_init), [&] { return scene.set_quality(quality); },
           [&](const Field &field) {
               return std::strcmp(field.option, unread) != 0 && std::strcmp(field.option, "--render-scale") != 0;
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
    choice("view", scene.view(), VIEWS, [&](int32_t view) { return scene.set_view(view); });
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
