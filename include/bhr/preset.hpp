// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/preset.hpp -- presets in C++: the looks, and how their matter is chosen. Touches no context. Include bhr.hpp. */
#ifndef BHR_PRESET_HPP
#define BHR_PRESET_HPP

#include "scene.hpp"

#include <cstdint>

namespace bhr {

/// BhrPreset.
enum class Preset : std::int32_t {
    cinematic = BHR_PRESET_CINEMATIC,
    physical = BHR_PRESET_PHYSICAL,
    observatory = BHR_PRESET_OBSERVATORY,
    teaching = BHR_PRESET_TEACHING,
};

/// BhrPresetMatter.
enum class PresetMatter : std::int32_t {
    automatic = BHR_PRESET_MATTER_AUTO,
    thin = BHR_PRESET_MATTER_THIN,
    deep = BHR_PRESET_MATTER_DEEP,
};

/// BhrPresetOptions, with the defaults of bhr_preset_options_init.
struct PresetOptions {
    std::uint32_t struct_size;
    PresetMatter matter;
    std::uint32_t width;
    std::uint32_t height;
    double frame_ms;
    std::uint32_t measure_anew;
    std::uint32_t may_halve;

    PresetOptions() noexcept { detail::defaults(*this, bhr_preset_options_init); }
    BhrPresetOptions c() const noexcept { return detail::as_c<BhrPresetOptions>(*this); }
};

} // namespace bhr

#endif
