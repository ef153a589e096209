// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/scene.hpp -- what structs.hpp and constants.hpp leave: sets of bits, windows, adapters, and what calls tell.
 * Touches no context. Include bhr.hpp. */
#ifndef BHR_SCENE_HPP
#define BHR_SCENE_HPP

#include "result.hpp"
#include "structs.hpp"

#include <array>
#include <chrono>
#include <type_traits>

namespace bhr {

/* ---- bits ---- */

namespace detail {
template <class E> using Bits = std::enable_if_t<is_bits<E>, E>;
} // namespace detail

template <class E> constexpr detail::Bits<E> operator|(E a, E b) noexcept {
    return static_cast<E>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
template <class E> constexpr detail::Bits<E> operator&(E a, E b) noexcept {
    return static_cast<E>(static_cast<std::uint32_t>(a) & static_cast<std::uint32_t>(b));
}
template <class E> constexpr detail::Bits<E> operator~(E a) noexcept {
    return static_cast<E>(~static_cast<std::uint32_t>(a));
}
template <class E> constexpr detail::Bits<E> &operator|=(E &a, E b) noexcept { return a = a | b; }
template <class E> constexpr detail::Bits<E> &operator&=(E &a, E b) noexcept { return a = a & b; }

/// Whether all of `bits` are among `flags`.
template <class E> constexpr std::enable_if_t<detail::is_bits<E>, bool> has(E flags, E bits) noexcept {
    return (flags & bits) == bits;
}

/* ---- structs ---- */

/// BhrRegion: the part of a frame of full_width x full_height pixels that begins at x, y.
struct Region {
    std::uint32_t struct_size = sizeof(BhrRegion);
    std::uint32_t full_width = 0;
    std::uint32_t full_height = 0;
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    std::uint32_t reserved = 0;

    BhrRegion c() const noexcept { return detail::as_c<BhrRegion>(*this); }
};

/// BhrWindow. The functions fill in what each kind of window has.
struct Window {
    std::uint32_t struct_size = sizeof(BhrWindow);
    WindowKind kind = WindowKind::xlib;
    void *display = nullptr;
    void *handle = nullptr;
    void *aux = nullptr;
    std::uint64_t id = 0;
    std::uint64_t visual_id = 0;
    std::int32_t screen = 0;
    std::uint32_t reserved = 0;

    BhrWindow c() const noexcept { return detail::as_c<BhrWindow>(*this); }

    static Window xlib(void *display, std::uint64_t id) noexcept { return with_id(WindowKind::xlib, display, id); }
    static Window xcb(void *connection, std::uint32_t id) noexcept { return with_id(WindowKind::xcb, connection, id); }
    static Window wayland(void *display, void *surface) noexcept {
        return of(WindowKind::wayland, display, surface, nullptr);
    }
    static Window win32(void *hwnd, void *hinstance = nullptr) noexcept {
        return of(WindowKind::win32, nullptr, hwnd, hinstance);
    }
    static Window appkit(void *view) noexcept { return of(WindowKind::appkit, nullptr, view, nullptr); }
    static Window uikit(void *view) noexcept { return of(WindowKind::uikit, nullptr, view, nullptr); }
    static Window metal_layer(void *layer) noexcept { return of(WindowKind::metal_layer, nullptr, layer, nullptr); }
    static Window android(void *window) noexcept { return of(WindowKind::android, nullptr, window, nullptr); }

  private:
    static Window of(WindowKind kind, void *display, void *handle, void *aux) noexcept {
        Window window;
        window.kind = kind;
        window.display = display;
        window.handle = handle;
        window.aux = aux;
        return window;
    }
    static Window with_id(WindowKind kind, void *display, std::uint64_t id) noexcept {
        Window window = of(kind, display, nullptr, nullptr);
        window.id = id;
        return window;
    }
};

/// BhrAdapterInfo.
struct AdapterInfo {
    std::uint32_t struct_size = sizeof(BhrAdapterInfo);
    Backend backend = Backend::automatic;
    AdapterFlags flags = AdapterFlags::none;
    std::uint32_t vendor_id = 0;
    std::uint32_t device_id = 0;
    std::uint32_t reserved = 0;
    char name[256] = {};
    char driver[256] = {};

    BhrAdapterInfo c() const noexcept { return detail::as_c<BhrAdapterInfo>(*this); }
};

/// BhrHoleInfo.
struct HoleInfo : BhrHoleInfo {};

/// BhrFrameStats, with its times as durations, too.
struct FrameStats : BhrFrameStats {
    std::chrono::nanoseconds cpu_time() const noexcept { return of(cpu_ns); }
    std::chrono::nanoseconds gpu_time() const noexcept { return of(gpu_ns); }
    std::chrono::nanoseconds readback_time() const noexcept { return of(readback_ns); }

  private:
    static std::chrono::nanoseconds of(std::uint64_t count) noexcept {
        return std::chrono::nanoseconds(static_cast<std::chrono::nanoseconds::rep>(count));
    }
};

/// The mass, the spin and the axis of the hole (bhr_get_hole).
struct Hole {
    double mass = 0.0;
    double spin = 0.0;
    Vector axis = {};
};

/// BhrRay. All 0 at first.
struct Ray {
    Vector position = {};
    Vector direction = {};
    double frequency_ratio = 1.0;
};

/// BhrCrossing.
using Crossing = BhrCrossing;

/// BhrHit; crossings beyond crossing_count are 0.
struct Hit {
    Fate fate = Fate::invalid;
    std::uint32_t crossing_count = 0;
    Vector sky_direction = {};
    double sky_redshift = 0.0;
    double swept_angle = 0.0;
    std::uint32_t steps = 0;
    std::uint32_t reserved = 0;
    std::array<Crossing, BHR_MAX_CROSSINGS> crossings = {};
};

/// BhrTransfer.
struct Transfer {
    Fate fate = Fate::invalid;
    std::uint32_t reserved = 0;
    double intensity = 0.0;
    double optical_depth = 0.0;
    std::array<double, 3> light = {};
};

/// A point of the curve that a ray follows (bhr_trace_path): place in scene axes, and time.
struct PathPoint {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    double t = 0.0;
};

/// BhrBody: a body at rest, told in the chart STATIC, until its fields say otherwise.
struct Body {
    std::uint32_t struct_size = sizeof(Body);
    Chart chart = Chart::static_;
    Vector position = {};
    Vector velocity = {};
    double time = 0.0;
    double proper_time = 0.0;
    WorldLineEnd end = WorldLineEnd::goes_on;
    std::uint32_t reserved = 0;
};

/* ---- adapters ---- */

/// bhr_adapter_count.
inline Result<std::uint32_t> adapter_count() {
    return detail::ask(std::uint32_t(0), [](std::uint32_t &count) { return bhr_adapter_count(&count); });
}

/// bhr_adapter_info.
inline Result<AdapterInfo> adapter_info(std::uint32_t index) {
    return detail::ask_struct<AdapterInfo, BhrAdapterInfo>([&](BhrAdapterInfo *info) {
        return bhr_adapter_info(index, info);
    });
}

} // namespace bhr

#endif
