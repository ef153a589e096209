// SPDX-License-Identifier: MIT OR Apache-2.0
// scene.cpp -- see scene.h.
#include "scene.h"

#include <algorithm>

Result Scene::begin(BhrPreset preset, BhrPresetMatter matter) {
    preset_options_ = with_defaults(bhr_preset_options_init);
    preset_options_.matter = matter;
    preset_options_.may_halve = 1; // the quality panel shows what AUTO took
    camera_ = with_defaults(bhr_camera_init);
    camera_.fov_y = 45.0 * DEGREE;
    read_back();
    Result result = set_spin(0.7);
    if (result.ok()) {
        result = set_orbit(Orbit{});
    }
    if (result.ok()) {
        BhrDisk disk = disk_;
        disk.turbulence = 0.6;
        result = preset == NO_PRESET ? set_disk(&disk) : set_preset(preset);
    }
    return result;
}

// After a setter: what is in force is what the library says, so a refused value never lingers here.
Result Scene::accepted(BhrStatus status, bool changes_rays) {
    const Result result = result_of(status);
    if (result.ok()) {
        version_++;
        geometry_version_ += changes_rays ? 1 : 0;
        read_back();
    }
    return result;
}

// None of these calls can fail: pointers and sizes are right.
void Scene::read_back() {
    bhr_get_hole(context_, &hole_.mass, &hole_.spin, hole_.axis);
    disk_ = sized<BhrDisk>();
    int32_t present = 0;
    bhr_get_disk(context_, &disk_, &present);
    has_disk_ = present != 0;
    uint32_t count = 0;
    volumes_.resize(BHR_MAX_VOLUMES);
    bhr_get_volumes(context_, volumes_.data(), sizeof(BhrVolume), BHR_MAX_VOLUMES, &count);
    volumes_.resize(count);
    hot_spots_.resize(BHR_MAX_HOT_SPOTS);
    bhr_get_hot_spots(context_, hot_spots_.data(), sizeof(BhrHotSpot), BHR_MAX_HOT_SPOTS, &count);
    hot_spots_.resize(count);
    sky_ = sized<BhrSky>();
    bhr_get_sky(context_, &sky_);
    film_ = sized<BhrFilm>();
    bhr_get_film(context_, &film_);
    bhr_get_effects(context_, &effects_);
    for (size_t i = 0; i < std::size(GRADED_EFFECTS); i++) {
        bhr_get_effect_strength(context_, GRADED_EFFECTS[i], &effect_strengths_[i]);
    }
    quality_ = sized<BhrQuality>();
    bhr_get_quality(context_, &quality_);
}

Result Scene::set_mass(double mass) {
    return accepted(bhr_set_mass(context_, mass), true);
}

Result Scene::set_spin(double spin) {
    return accepted(bhr_set_spin(context_, spin), true);
}

Result Scene::set_preset(BhrPreset preset) {
    const Result result = accepted(bhr_set_preset_with(context_, preset, &preset_options_, &chosen_matter_), true);
    if (result.ok()) {
        preset_ = preset;
    }
    return result;
}

Result Scene::set_preset_matter(BhrPresetMatter matter) {
    preset_options_.matter = matter;
    preset_options_.may_halve = 1; // the quality panel shows what AUTO took
    return preset_ == NO_PRESET ? Result{} : set_preset(preset_);
}

Result Scene::set_axis(const double axis[3]) {
    return accepted(bhr_set_axis(context_, axis), true);
}

Result Scene::set_orbit(const Orbit &orbit) {
    BhrCamera moved = camera_;
    Result    result = result_of(bhr_camera_orbit(&moved, orbit.distance, orbit.azimuth, orbit.elevation));
    if (result.ok()) {
        result = set_camera(moved);
    }
    if (result.ok()) {
        orbit_ = orbit;
    }
    return result;
}

Result Scene::set_camera(const BhrCamera &camera) {
    const Result result = accepted(bhr_set_camera(context_, &camera), true);
    if (result.ok()) {
        camera_ = camera;
    }
    return result;
}

Result Scene::set_disk(const BhrDisk *disk) {
    return accepted(bhr_set_disk(context_, disk), true);
}

Result Scene::set_volumes(const std::vector<BhrVolume> &volumes) {
    const auto count = static_cast<uint32_t>(volumes.size());
    return accepted(bhr_set_volumes(context_, volumes.data(), sizeof(BhrVolume), count), false);
}

Result Scene::set_hot_spots(const std::vector<BhrHotSpot> &hot_spots) {
    const auto count = static_cast<uint32_t>(hot_spots.size());
    return accepted(bhr_set_hot_spots(context_, hot_spots.data(), sizeof(BhrHotSpot), count), false);
}

Result Scene::set_sky(const BhrSky &sky) {
    return accepted(bhr_set_sky(context_, &sky), false);
}

Result Scene::set_film(const BhrFilm &film) {
    return accepted(bhr_set_film(context_, &film), false);
}

Result Scene::set_quality(const BhrQuality &quality) {
    return accepted(bhr_set_quality(context_, &quality), true);
}

Result Scene::set_view(BhrView view) {
    const Result result = accepted(bhr_set_view(context_, view), false);
    if (result.ok()) {
        view_ = view;
    }
    return result;
}

Result Scene::set_effects(uint32_t effects) {
    const Result result = accepted(bhr_set_effects(context_, effects), false);
    if (result.ok()) {
        effects_ = effects;
    }
    return result;
}

double Scene::effect_strength(uint32_t effect) const {
    const auto *found = std::find(std::begin(GRADED_EFFECTS), std::end(GRADED_EFFECTS), effect);
    return found == std::end(GRADED_EFFECTS) ? 1.0 : effect_strengths_[found - std::begin(GRADED_EFFECTS)];
}

Result Scene::set_effect_strength(uint32_t effect, double strength) {
    return accepted(bhr_set_effect_strength(context_, effect, strength), false);
}

Result Scene::set_lut_file(const char *path) {
    const bool   none = path[0] == '\0';
    const Result result = accepted(none ? bhr_set_film_lut(context_, nullptr, 0, 0)
                                        : bhr_set_film_lut_file(context_, path), false);
    if (result.ok()) {
        lut_path_ = path;
    }
    return result;
}

Result Scene::set_time(double time) {
    const Result result = accepted(bhr_set_time(context_, time), false);
    if (result.ok()) {
        time_ = time;
    }
    return result;
}

Result Scene::set_shutter(double duration) {
    const Result result = accepted(bhr_set_shutter(context_, duration), false);
    if (result.ok()) {
        shutter_ = duration;
    }
    return result;
}

// The orbit on which a camera is there.
static Orbit orbit_through(const double position[3]) {
    const Vec3   place{position[0], position[1], position[2]};
    const double distance = length(place);
    return {distance, std::atan2(place.y, place.x), std::asin(std::clamp(place.z / distance, -1.0, 1.0))};
}

Result Scene::advance_camera(double proper_time) {
    BhrCamera    moved = camera_;
    double       coordinate_time = 0.0;
    const Result result = result_of(bhr_camera_advance(context_, &moved, proper_time, &coordinate_time));
    if (!result.ok()) {
        return result;
    }
    const Result placed = set_orbit(orbit_through(moved.position));
    return placed.ok() ? set_time(time_ + coordinate_time) : placed;
}

Result Scene::save_text(std::string &out) const {
    size_t    size = 0;
    BhrStatus status = bhr_scene_save(context_, nullptr, 0, &size);
    if (status >= 0) {
        out.resize(size + 1);
        status = bhr_scene_save(context_, out.data(), out.size(), &size);
        out.resize(size);
    }
    return result_of(status);
}

Result Scene::load_text(const std::string &text) {
    return loaded(bhr_scene_load(context_, text.data(), text.size()));
}

Result Scene::save_file(const char *path) const {
    return result_of(bhr_scene_save_file(context_, path));
}

Result Scene::load_file(const char *path) {
    return loaded(bhr_scene_load_file(context_, path));
}

// A text sets as well what read_back leaves to the setters.
Result Scene::loaded(BhrStatus status) {
    const Result result = accepted(status, true);
    if (result.ok()) {
        camera_ = sized<BhrCamera>();
        bhr_get_camera(context_, &camera_);
        orbit_ = orbit_through(camera_.position);
        bhr_get_view(context_, &view_);
        bhr_get_time(context_, &time_);
        bhr_get_shutter(context_, &shutter_);
        preset_ = NO_PRESET;
        lut_path_.clear(); // the text's is in force, whose path no call tells
    }
    return result;
}
