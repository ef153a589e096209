// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/scene.hpp -- the values that a scene is set with, in C++: enum classes for the constants of bhr.h, and its plain
 * structs with their defaults. Touches no context. Include bhr.hpp. */
#ifndef BHR_SCENE_HPP
#define BHR_SCENE_HPP

#include "result.hpp"

#include <array>
#include <chrono>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>

namespace bhr {

/// Components along x, y and z.
using Vector = std::array<double, 3>;

/* ---- constants ---- */

/// BhrLogLevel.
enum class LogLevel : std::int32_t {
    off = BHR_LOG_OFF,
    error = BHR_LOG_ERROR,
    warn = BHR_LOG_WARN,
    info = BHR_LOG_INFO,
    debug = BHR_LOG_DEBUG,
    trace = BHR_LOG_TRACE,
};

/// BhrBackend.
enum class Backend : std::int32_t {
    automatic = BHR_BACKEND_AUTO,
    cpu = BHR_BACKEND_CPU,
    vulkan = BHR_BACKEND_VULKAN,
    metal = BHR_BACKEND_METAL,
    d3d12 = BHR_BACKEND_D3D12,
    gl = BHR_BACKEND_GL,
};

/// BhrWindowKind.
enum class WindowKind : std::int32_t {
    xlib = BHR_WINDOW_XLIB,
    xcb = BHR_WINDOW_XCB,
    wayland = BHR_WINDOW_WAYLAND,
    win32 = BHR_WINDOW_WIN32,
    appkit = BHR_WINDOW_APPKIT,
    uikit = BHR_WINDOW_UIKIT,
    metal_layer = BHR_WINDOW_METAL_LAYER,
    android = BHR_WINDOW_ANDROID,
};

/// BhrProjection.
enum class Projection : std::int32_t {
    perspective = BHR_PROJECTION_PERSPECTIVE,
    fisheye = BHR_PROJECTION_FISHEYE,
    equirect = BHR_PROJECTION_EQUIRECT,
    cube = BHR_PROJECTION_CUBE,
    frustum = BHR_PROJECTION_FRUSTUM,
};

/// BhrEye.
enum class Eye : std::int32_t {
    middle = BHR_EYE_MIDDLE,
    left = BHR_EYE_LEFT,
    right = BHR_EYE_RIGHT,
};

/// BhrMotion. (static is a word of the language.)
enum class Motion : std::int32_t {
    static_ = BHR_MOTION_STATIC,
    free_fall = BHR_MOTION_FREE_FALL,
    orbit = BHR_MOTION_ORBIT,
    velocity = BHR_MOTION_VELOCITY,
};

/// BhrDiskReference.
enum class DiskReference : std::int32_t {
    at_hottest = BHR_DISK_AT_HOTTEST,
    at_median = BHR_DISK_AT_MEDIAN,
};

/// BhrEmissionLaw.
enum class EmissionLaw : std::int32_t {
    isotropic = BHR_DISK_ISOTROPIC,
    limb_darkened = BHR_DISK_LIMB_DARKENED,
};

/// BhrVolumeShape.
enum class VolumeShape : std::int32_t {
    disk = BHR_VOLUME_DISK,
    torus = BHR_VOLUME_TORUS,
    halo = BHR_VOLUME_HALO,
    jet = BHR_VOLUME_JET,
};

/// BhrFlow.
enum class Flow : std::int32_t {
    keplerian = BHR_FLOW_KEPLERIAN,
    angular_momentum = BHR_FLOW_ANGULAR_MOMENTUM,
    outflow = BHR_FLOW_OUTFLOW,
};

/// Most volumes, and most hot spots, of a scene.
inline constexpr std::size_t max_volumes = BHR_MAX_VOLUMES;
inline constexpr std::size_t max_hot_spots = BHR_MAX_HOT_SPOTS;

/// BhrFormat.
enum class Format : std::int32_t {
    rgba8_srgb = BHR_FORMAT_RGBA8_SRGB,
    bgra8_srgb = BHR_FORMAT_BGRA8_SRGB,
    rgba16f = BHR_FORMAT_RGBA16F,
    rgba32f = BHR_FORMAT_RGBA32F,
    r32f = BHR_FORMAT_R32F,
};

/// BhrToneMap.
enum class ToneMap : std::int32_t {
    none = BHR_TONE_MAP_NONE,
    aces = BHR_TONE_MAP_ACES,
    agx = BHR_TONE_MAP_AGX,
};

/// BhrColourMap.
enum class ColourMap : std::int32_t {
    none = BHR_COLOUR_MAP_NONE,
    afmhot = BHR_COLOUR_MAP_AFMHOT,
};

/// BhrMethod.
enum class Method : std::int32_t {
    automatic = BHR_METHOD_AUTO,
    rk4 = BHR_METHOD_RK4,
    adaptive = BHR_METHOD_ADAPTIVE,
};

/// BhrVolumeResolution.
enum class VolumeResolution : std::int32_t {
    full = BHR_VOLUME_RESOLUTION_FULL,
    half = BHR_VOLUME_RESOLUTION_HALF,
};

/// BhrView.
enum class View : std::int32_t {
    light = BHR_VIEW_LIGHT,
    redshift = BHR_VIEW_REDSHIFT,
    order = BHR_VIEW_ORDER,
    deflection = BHR_VIEW_DEFLECTION,
    steps = BHR_VIEW_STEPS,
    metric = BHR_VIEW_METRIC,
    optical_depth = BHR_VIEW_OPTICAL_DEPTH,
    intensity = BHR_VIEW_INTENSITY,
};

/// BhrPresentMode.
enum class PresentMode : std::int32_t {
    vsync = BHR_PRESENT_VSYNC,
    immediate = BHR_PRESENT_IMMEDIATE,
    mailbox = BHR_PRESENT_MAILBOX,
};

/// BhrFate.
enum class Fate : std::int32_t {
    captured = BHR_FATE_CAPTURED,
    escaped = BHR_FATE_ESCAPED,
    unresolved = BHR_FATE_UNRESOLVED,
    invalid = BHR_FATE_INVALID,
};

/* ---- bits ---- */

/// BhrAdapterInfo.flags.
enum class AdapterFlags : std::uint32_t {
    none = 0,
    discrete = BHR_ADAPTER_DISCRETE,
    software = BHR_ADAPTER_SOFTWARE,
};

/// BhrContextOptions.flags.
enum class ContextFlags : std::uint32_t {
    none = 0,
    validation = BHR_CONTEXT_VALIDATION,
};

/// BhrDisk.flags.
enum class DiskFlags : std::uint32_t {
    none = 0,
    retrograde = BHR_DISK_RETROGRADE,
    plunges = BHR_DISK_PLUNGES,
};

/// BhrVolume.flags.
enum class VolumeFlags : std::uint32_t {
    none = 0,
    retrograde = BHR_VOLUME_RETROGRADE,
    power_law = BHR_VOLUME_POWER_LAW,
};

/// BhrHotSpot.flags.
enum class HotSpotFlags : std::uint32_t {
    none = 0,
    retrograde = BHR_HOT_SPOT_RETROGRADE,
    thermal = BHR_HOT_SPOT_THERMAL,
};

/// BhrImage.flags.
enum class ImageFlags : std::uint32_t {
    none = 0,
    transparent = BHR_IMAGE_TRANSPARENT,
    bottom_up = BHR_IMAGE_BOTTOM_UP,
    lensed = BHR_IMAGE_LENSED,
};

/// BhrSky.flags.
enum class SkyFlags : std::uint32_t {
    none = 0,
    stars = BHR_SKY_STARS,
    procedural = BHR_SKY_PROCEDURAL,
    milky_way = BHR_SKY_MILKY_WAY,
    map = BHR_SKY_MAP,
    grid = BHR_SKY_GRID,
};

/// Bits for bhr_set_effects.
enum class Effects : std::uint32_t {
    none = 0,
    doppler_shift = BHR_EFFECT_DOPPLER_SHIFT,
    gravity_shift = BHR_EFFECT_GRAVITY_SHIFT,
    beaming = BHR_EFFECT_BEAMING,
    light_delay = BHR_EFFECT_LIGHT_DELAY,
    all = BHR_EFFECT_ALL,
};

namespace detail {
template <class E>
inline constexpr bool is_bits =
    std::is_same_v<E, AdapterFlags> || std::is_same_v<E, ContextFlags> || std::is_same_v<E, DiskFlags> ||
    std::is_same_v<E, ImageFlags> || std::is_same_v<E, SkyFlags> || std::is_same_v<E, Effects> ||
    std::is_same_v<E, VolumeFlags> || std::is_same_v<E, HotSpotFlags>;
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

namespace detail {

/// The C struct of the same layout. The bytes are copied, because C++ does not let one be used as the other.
template <class C, class T> C as_c(const T &object) noexcept {
    static_assert(sizeof(C) == sizeof(T) && alignof(C) == alignof(T), "the structs of bhr.hpp are those of bhr.h");
    static_assert(std::is_trivially_copyable_v<C> && std::is_trivially_copyable_v<T>);
    C copy;
    std::memcpy(&copy, &object, sizeof copy);
    return copy;
}

template <class T, class C> void take(T &object, const C &from) noexcept {
    static_assert(sizeof(C) == sizeof(T) && std::is_trivially_copyable_v<T>);
    std::memcpy(static_cast<void *>(&object), &from, sizeof from);
}

/// Fills in a struct by the function of bhr.h that has its defaults. They cannot fail with a struct of this size.
template <class T, class C> void defaults(T &object, BhrStatus (*init)(C *, std::size_t)) noexcept {
    C copy{};
    static_cast<void>(init(&copy, sizeof copy));
    take(object, copy);
}

/// Asks for a struct that begins with struct_size by a getter of bhr.h.
template <class T, class C, class Function> Result<T> ask_struct(Function &&function) {
    return ask(T(), [&](T &object) {
        C copy{};
        BHR_INIT(copy);
        const BhrStatus status = function(&copy);
        take(object, copy);
        return status;
    });
}

/// Asks for one that may not be there.
template <class T, class C, class Function> Result<std::optional<T>> ask_or_none(Function &&function) {
    std::int32_t    present = 0;
    const Result<T> value = ask_struct<T, C>([&](C *it) { return function(it, &present); });
    if (!value) {
        return value.error();
    }
    return present != 0 ? std::optional<T>(*value) : std::optional<T>();
}

} // namespace detail

/// BhrDisk, with the defaults of bhr_disk_init.
struct Disk {
    std::uint32_t struct_size;
    DiskFlags flags;
    double inner_radius;
    double outer_radius;
    double temperature;
    double opacity;
    double brightness;
    double turbulence;
    std::uint64_t seed;
    DiskReference reference;
    EmissionLaw emission_law;
    double edge_softness;

    Disk() noexcept { detail::defaults(*this, bhr_disk_init); }
    BhrDisk c() const noexcept { return detail::as_c<BhrDisk>(*this); }
};

/// BhrVolume, with the defaults of bhr_volume_init.
struct Volume {
    std::uint32_t struct_size;
    VolumeFlags flags;
    VolumeShape shape;
    Flow flow;
    double inner_radius;
    double outer_radius;
    double radius;
    double width;
    double thickness;
    double opening;
    double slope;
    double absorption;
    double temperature;
    double temperature_slope;
    double spectral_index;
    std::array<double, 3> tint;
    double brightness;
    double sub_keplerian;
    double infall;
    double angular_momentum;
    double speed;
    double turbulence;
    double clumping;
    double heating;
    std::uint64_t seed;

    Volume() noexcept { detail::defaults(*this, bhr_volume_init); }
    BhrVolume c() const noexcept { return detail::as_c<BhrVolume>(*this); }
};

/// BhrHotSpot, with the defaults of bhr_hot_spot_init.
struct HotSpot {
    std::uint32_t struct_size;
    HotSpotFlags flags;
    double radius;
    double size;
    double azimuth;
    double absorption;
    double temperature;
    double spectral_index;
    std::array<double, 3> tint;
    double brightness;

    HotSpot() noexcept { detail::defaults(*this, bhr_hot_spot_init); }
    BhrHotSpot c() const noexcept { return detail::as_c<BhrHotSpot>(*this); }
};

/// BhrSky, with the defaults of bhr_sky_init.
struct Sky {
    std::uint32_t struct_size;
    SkyFlags flags;
    double stars_brightness;
    double map_brightness;
    std::array<double, 4> orientation;
    std::uint64_t seed;

    Sky() noexcept { detail::defaults(*this, bhr_sky_init); }
    BhrSky c() const noexcept { return detail::as_c<BhrSky>(*this); }
};

/// BhrFilm, with the defaults of bhr_film_init.
struct Film {
    std::uint32_t struct_size;
    ToneMap tone_map;
    double exposure_ev;
    double bloom;
    double beam_fwhm;
    ColourMap colour_map;
    std::uint32_t reserved;

    Film() noexcept { detail::defaults(*this, bhr_film_init); }
    BhrFilm c() const noexcept { return detail::as_c<BhrFilm>(*this); }
};

/// BhrQuality, with the defaults of bhr_quality_init.
struct Quality {
    std::uint32_t struct_size;
    Method method;
    std::uint32_t samples_per_pixel;
    std::uint32_t max_steps;
    double step;
    double tolerance;
    std::uint32_t max_disk_order;
    std::uint32_t reserved;
    double render_scale;
    VolumeResolution volume_resolution;
    std::uint32_t reserved2;

    Quality() noexcept { detail::defaults(*this, bhr_quality_init); }
    BhrQuality c() const noexcept { return detail::as_c<BhrQuality>(*this); }
};

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
