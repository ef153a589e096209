// SPDX-License-Identifier: MIT OR Apache-2.0
// film_settings.cpp -- the film's part of SettingsPanel (settings.h): every field of BhrFilm, in groups by what a
// colourist does with it. A field that the library gains stands in a group of its own until it has a place here.
#include "settings.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace {

using Names = std::vector<const char *>;

const Names EXPOSURE = {"--exposure-ev", "--auto-exposure"};
const Names METER = {"--auto-percentile", "--auto-target", "--auto-least-ev", "--auto-most-ev", "--auto-adaptation"};
const Names LOCAL = {"--highlights", "--shadows"};
const Names CURVE = {"--tone-map"};
const Names FILMIC = {"--toe-strength", "--toe-length", "--shoulder-strength", "--shoulder-length",
                      "--shoulder-angle"};
const Names GRADE = {"--white-balance", "--tint", "--contrast", "--saturation"};
const Names LENS = {"--bloom", "--beam-fwhm", "--vignette", "--spikes", "--streak", "--flare"};
const Names SPIKES = {"--spike-blades", "--spike-angle", "--spike-length"};
const Names STREAK = {"--streak-length", "--streak-tint"};
const Names FLARE = {"--flare-ghosts"};
const Names GRAIN = {"--grain", "--grain-seed"};
const Names LUT = {"--lut-strength", "--colour-map"};
const Names HDR = {"--paper-white", "--peak"};

bool holds(const Names &names, const Field &field) {
    return std::any_of(names.begin(), names.end(),
                       [&](const char *name) { return std::strcmp(name, field.option) == 0; });
}

bool has_group(const Field &field) {
    for (const Names *names :
         {&EXPOSURE, &METER, &LOCAL, &CURVE, &FILMIC, &GRADE, &LENS, &SPIKES, &STREAK, &FLARE, &GRAIN, &LUT, &HDR}) {
        if (holds(*names, field)) {
            return true;
        }
    }
    return false;
}

bool any_without_group() {
    for (const Field *field = FILM_FIELDS; field->option != nullptr; field++) {
        if (!has_group(*field)) {
            return true;
        }
    }
    return false;
}

} // namespace

void SettingsPanel::film_fields(Scene &scene, const Shown &shown) {
    BhrFilm       film = scene.film();
    const BhrFilm defaults = with_defaults(bhr_film_init);
    fields(FILM_FIELDS, &film, &defaults, [&] { return scene.set_film(film); }, shown);
}

// A look as a whole.
void SettingsPanel::preset(Scene &scene) {
    if (!section("Look", true)) {
        return;
    }
    // None of them is in force once something else was changed: so none is shown as chosen.
    choice("preset", NO_PRESET, PRESETS, [&](int32_t preset) { return scene.set_preset(preset); },
           "a look as a whole: disk, matter with depth, sky, film and effects\n\n"
           "bhr_set_preset in bhr.h; docs/presets.md");
    // The name of AUTO says which it has chosen.
    const bool   deep = scene.chosen_matter() == BHR_PRESET_MATTER_DEEP;
    const Choice matters[] = {{deep ? "auto: deep" : "auto: thin", BHR_PRESET_MATTER_AUTO},
                              {"thin", BHR_PRESET_MATTER_THIN},
                              {"deep", BHR_PRESET_MATTER_DEEP},
                              {nullptr, 0}};
    choice("its matter", scene.preset_matter(), matters,
           [&](int32_t matter) { return scene.set_preset_matter(matter); },
           "of presets: a disk without depth, matter with depth, or that where it is fast enough\n\n"
           "BhrPresetOptions.matter in bhr.h; docs/presets.md");
}

void SettingsPanel::film(Scene &scene) {
    const auto of = [](const Names &names) {
        return [&names](const Field &field) { return holds(names, field); };
    };
    preset(scene);
    if (section("Exposure", true)) {
        film_fields(scene, of(EXPOSURE));
        ImGui::BeginDisabled(scene.film().auto_exposure == 0.0);
        film_fields(scene, of(METER));
        ImGui::EndDisabled();
    }
    if (section("Highlights and shadows", true)) {
        film_fields(scene, of(LOCAL));
    }
    if (section("Curve", true)) {
        film_fields(scene, of(CURVE));
        ImGui::BeginDisabled(scene.film().tone_map != BHR_TONE_MAP_FILMIC);
        film_fields(scene, of(FILMIC));
        ImGui::EndDisabled();
    }
    if (section("Grade", true)) {
        film_fields(scene, of(GRADE));
    }
    if (section("Lens", true)) {
        film_fields(scene, of(LENS));
        ImGui::BeginDisabled(scene.film().spikes == 0.0);
        film_fields(scene, of(SPIKES));
        ImGui::EndDisabled();
        ImGui::BeginDisabled(scene.film().streak == 0.0);
        film_fields(scene, of(STREAK));
        ImGui::EndDisabled();
        ImGui::BeginDisabled(scene.film().flare == 0.0);
        film_fields(scene, of(FLARE));
        ImGui::EndDisabled();
    }
    if (section("Grain", true)) {
        film_fields(scene, of(GRAIN));
    }
    if (section("LUT and colour map", true)) {
        text("LUT file", scene.lut_path(), [&](const char *path) { return scene.set_lut_file(path); },
             "a .cube file, asked for by Enter; empty: none. A scene's file may bring a LUT whose name this row does "
             "not show\n\nbhr_set_film_lut_file in bhr.h; docs/colour-and-film.md\nCube LUT Specification 1.0, Adobe");
        film_fields(scene, of(LUT));
    }
    // The panel's pictures have 8 bits: these are for scenes that are saved.
    if (section("High dynamic range", true)) {
        film_fields(scene, of(HDR));
    }
    if (any_without_group() && section("More", true)) {
        film_fields(scene, [](const Field &field) { return !has_group(field); });
    }
}
