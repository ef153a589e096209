/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// scene.h -- the scene as the panel edits it. Every change goes through the library's own checks: what a setter refuses
// leaves everything as it was. Knows no window.
#ifndef PANEL_SCENE_H
#define PANEL_SCENE_H

#include "handles.h"
#include "vec.h"

#include <iterator>
#include <string>
#include <vector>

// The camera about the hole, which it looks at once it was moved. Scene lengths and radians.
struct Orbit {
    double distance = 30.0, azimuth = -90.0 * DEGREE, elevation = 10.0 * DEGREE;
};

struct Hole {
    double mass = 1.0, spin = 0.0;
    double axis[3] = {0.0, 0.0, 1.0};
};

constexpr BhrPreset NO_PRESET = -1;

// The effects that have strengths.
constexpr uint32_t GRADED_EFFECTS[] = {BHR_EFFECT_DOPPLER_SHIFT, BHR_EFFECT_GRAVITY_SHIFT, BHR_EFFECT_BEAMING};

class Scene {
public:
    explicit Scene(BhrContext *context) : context_(context) {}

    // The scene that the panel begins with.
    // NO_PRESET: the library's look; `matter`: the presets', then and later.
    Result begin(BhrPreset preset, BhrPresetMatter matter);

    // The values in force.
    const Hole       &hole() const { return hole_; }
    const Orbit      &orbit() const { return orbit_; }
    const BhrCamera  &camera() const { return camera_; }
    const BhrDisk    &disk() const { return disk_; }
    bool              has_disk() const { return has_disk_; }
    const std::vector<BhrVolume>  &volumes() const { return volumes_; }
    const std::vector<BhrHotSpot> &hot_spots() const { return hot_spots_; }
    const BhrSky     &sky() const { return sky_; }
    const BhrFilm    &film() const { return film_; }
    const BhrQuality &quality() const { return quality_; }
    BhrView           view() const { return view_; }
    uint32_t          effects() const { return effects_; }
    double            effect_strength(uint32_t effect) const; // of one of GRADED_EFFECTS
    const std::string &lut_path() const { return lut_path_; } // "": none that was set here
    double            time() const { return time_; }
    double            shutter() const { return shutter_; }
    Chart             chart() const { return Chart(hole_.axis); }

    // Numbers that grow with every change: of anything a frame shows, and of rays and what they meet only.
    uint64_t version() const { return version_; }
    uint64_t geometry_version() const { return geometry_version_; }

    Result set_mass(double mass);
    Result set_spin(double spin);
    Result set_axis(const double axis[3]);
    Result set_orbit(const Orbit &orbit);
    Result set_camera(const BhrCamera &camera); // lens and motion; place and direction are the orbit's
    Result set_disk(const BhrDisk *disk);       // NULL: none
    Result set_volumes(const std::vector<BhrVolume> &volumes);
    Result set_hot_spots(const std::vector<BhrHotSpot> &hot_spots);
    Result set_sky(const BhrSky &sky);
    Result set_film(const BhrFilm &film);
    Result set_quality(const BhrQuality &quality);
    Result set_preset(BhrPreset preset);
    Result set_preset_matter(BhrPresetMatter matter); // with the preset that was set last
    // The matter that presets are to have, and the one that the last of them has.
    BhrPresetMatter preset_matter() const { return preset_options_.matter; }
    BhrPresetMatter chosen_matter() const { return chosen_matter_; }
    Result set_view(BhrView view);
    Result set_effects(uint32_t effects);
    Result set_effect_strength(uint32_t effect, double strength);
    Result set_lut_file(const char *path); // "": none
    Result set_time(double time);
    Result set_shutter(double duration);

    // Moves the camera along its world line, and the scene's time with it.
    Result advance_camera(double proper_time);

    // All of it as text, in memory and in files (docs/scenes.md).
    Result save_text(std::string &out) const;
    Result load_text(const std::string &text);
    Result save_file(const char *path) const;
    Result load_file(const char *path);

private:
    BhrPresetOptions preset_options_{};
    BhrPreset        preset_ = NO_PRESET; // that was set last
    BhrPresetMatter  chosen_matter_ = BHR_PRESET_MATTER_THIN;
    Result accepted(BhrStatus status, bool changes_rays);
    void   read_back();
    Result loaded(BhrStatus status);

    BhrContext *context_;
    Hole        hole_;
    Orbit       orbit_;
    BhrCamera   camera_{};
    BhrDisk     disk_{};
    bool        has_disk_ = true;
    std::vector<BhrVolume>  volumes_;
    std::vector<BhrHotSpot> hot_spots_;
    BhrSky      sky_{};
    BhrFilm     film_{};
    BhrQuality  quality_{};
    BhrView     view_ = BHR_VIEW_LIGHT;
    uint32_t    effects_ = BHR_EFFECT_ALL;
    double      effect_strengths_[std::size(GRADED_EFFECTS)] = {1.0, 1.0, 1.0};
    std::string lut_path_;
    double      time_ = 0.0, shutter_ = 0.0;
    uint64_t    version_ = 0, geometry_version_ = 0;
};

#endif
