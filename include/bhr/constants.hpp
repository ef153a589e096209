// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/constants.hpp -- the constants of bhr.h as enum classes, and sets of bits. Include bhr.hpp. Made by
 * tests/header/bindings.rs from include/bhr.json; do not edit. */
#ifndef BHR_CONSTANTS_HPP
#define BHR_CONSTANTS_HPP

#include <bhr.h>

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace bhr {

/// BhrLogLevel: How much a log callback is told: messages of this level and of the more severe ones.
enum class LogLevel : std::int32_t {
    /// No messages.
    off = BHR_LOG_OFF,
    /// Every failed call, but for cancels, and errors of the graphics stack.
    error = BHR_LOG_ERROR,
    /// Also trouble that failed no call, such as an adapter passed over.
    warn = BHR_LOG_WARN,
    /// Also cancels, why an adapter was chosen, and errors of the graphics stack about others.
    info = BHR_LOG_INFO,
    /// Also what the graphics stack (wgpu) reports about itself.
    debug = BHR_LOG_DEBUG,
    /// Everything: slow.
    trace = BHR_LOG_TRACE,
};

/// BhrBackend: The interface to an adapter.
enum class Backend : std::int32_t {
    /// The best one there is, in the order above.
    automatic = BHR_BACKEND_AUTO,
    /// The built-in double-precision CPU tracer: needs no driver.
    cpu = BHR_BACKEND_CPU,
    /// Vulkan.
    vulkan = BHR_BACKEND_VULKAN,
    /// Metal.
    metal = BHR_BACKEND_METAL,
    /// Direct3D 12, never tried on Windows itself; its compiler: docs/platforms.md.
    d3d12 = BHR_BACKEND_D3D12,
    /// OpenGL or OpenGL ES, by EGL or WGL.
    gl = BHR_BACKEND_GL,
};

/// BhrWindowKind: The kind of a BhrWindow.
enum class WindowKind : std::int32_t {
    /// X11 through Xlib: display = Display *, id = Window.
    xlib = BHR_WINDOW_XLIB,
    /// X11 through XCB: display = xcb_connection_t *, id = xcb_window_t.
    xcb = BHR_WINDOW_XCB,
    /// Wayland: display = wl_display *, handle = wl_surface *.
    wayland = BHR_WINDOW_WAYLAND,
    /// Windows: handle = HWND, aux = HINSTANCE; NULL: the window's own.
    win32 = BHR_WINDOW_WIN32,
    /// MacOS: handle = NSView *.
    appkit = BHR_WINDOW_APPKIT,
    /// IOS: handle = UIView *.
    uikit = BHR_WINDOW_UIKIT,
    /// MacOS, iOS: handle = CAMetalLayer *.
    metal_layer = BHR_WINDOW_METAL_LAYER,
    /// Android: handle = ANativeWindow *.
    android = BHR_WINDOW_ANDROID,
};

/// BhrChart: How azimuths and times are told, and the triad that directions and velocities are told along.
enum class Chart : std::int32_t {
    /// Boyer and Lindquist's ph and t, and the triad of the static observer (ZAMO).
    static_ = BHR_CHART_STATIC,
    /// Doran's, and the triad of the rain observer, who falls from rest at infinity.
    rain = BHR_CHART_RAIN,
};

/// BhrProjection: The lens.
enum class Projection : std::int32_t {
    /// A flat picture; fov_y in (0, pi).
    perspective = BHR_PROJECTION_PERSPECTIVE,
    /// Dome master, equidistant: the angle from forward grows evenly with the distance from the frame's centre, to
    /// fov_y / 2 (fov_y to 2 pi) at the circle inscribed in the frame.
    fisheye = BHR_PROJECTION_FISHEYE,
    /// All-round picture, 360 x 180 degrees in even steps: longitude from forward (middle) to the right, latitude
    /// towards up (top); fov_y is ignored.
    equirect = BHR_PROJECTION_EQUIRECT,
    /// Six faces of a cube side by side: right, left, up, down, front, back.
    cube = BHR_PROJECTION_CUBE,
    /// A flat picture between four tangents, as the frustum of a projection matrix: tan_left, tan_right, tan_down,
    /// tan_up.
    frustum = BHR_PROJECTION_FRUSTUM,
};

/// BhrMotion: How the camera's observer moves.
enum class Motion : std::int32_t {
    /// At rest, outside the horizon; with spin, the zero angular momentum observer (ZAMO).
    static_ = BHR_MOTION_STATIC,
    /// Falls from rest at infinity with E = 1 and L = Q = 0, inside the horizon too (with spin in chart RAIN).
    free_fall = BHR_MOTION_FREE_FALL,
    /// On a circle towards +ph: without spin at any latitude, with r > 3 M and beta = 1 / sqrt(r / M - 2); with spin on
    /// the circular geodesic, in the equatorial plane only (to within 1e-12 of the radius).
    orbit = BHR_MOTION_ORBIT,
    /// Moves with BhrCamera.velocity.
    velocity = BHR_MOTION_VELOCITY,
};

/// BhrEye: The eye for which an EQUIRECT picture is made.
enum class Eye : std::int32_t {
    /// The camera's own place: no stereo picture.
    middle = BHR_EYE_MIDDLE,
    /// The left eye.
    left = BHR_EYE_LEFT,
    /// The right eye.
    right = BHR_EYE_RIGHT,
};

/// BhrTransport: How bhr_camera_advance carries a camera's axes along.
enum class Transport : std::int32_t {
    /// Forward and up keep their angles to e_r, e_th and e_ph.
    triad = BHR_TRANSPORT_TRIAD,
    /// Forward and up stay parallel to themselves along the world line, as the axes of gyroscopes do.
    parallel = BHR_TRANSPORT_PARALLEL,
};

/// BhrDiskReference: The ring at whose radius a disk has the stated temperature and brightness.
enum class DiskReference : std::int32_t {
    /// The hottest ring of the profile: at spin 0 r = 9.55 M, at spin 0.998 r = 1.58 M.
    at_hottest = BHR_DISK_AT_HOTTEST,
    /// The ring that halves the disk's area, r^2 = (inner^2 + outer^2) / 2, but for the outermost quarter of a soft
    /// outer edge's fading: the disk as a whole keeps its look when spin or edges change.
    at_median = BHR_DISK_AT_MEDIAN,
};

/// BhrEmissionLaw: How the disk's light depends on the angle to its normal, in the frame of its matter.
enum class EmissionLaw : std::int32_t {
    /// The disk's surface shines alike in all directions.
    isotropic = BHR_DISK_ISOTROPIC,
    /// Like an atmosphere of free electrons: 1.269 times as bright along the normal, 0.414 times at grazing angles.
    limb_darkened = BHR_DISK_LIMB_DARKENED,
};

/// BhrVolumeShape: The place of a volume's matter: its density n, with c = cos th, R = r sin th, z = r c, and lengths
/// in M.
enum class VolumeShape : std::int32_t {
    /// About the equatorial plane: n = (r / inner_radius)^-slope e^(-(c / thickness)^2 / 2), with soft edges.
    disk = BHR_VOLUME_DISK,
    /// A ring about the axis: n = e^(-((R - radius) / width)^2 / 2 - (z / (thickness radius))^2 / 2).
    torus = BHR_VOLUME_TORUS,
    /// About the hole: n = e^(-(r / radius)^2 / 2 - (c / thickness)^2 / 2), with thickness = 1e6 a sphere.
    halo = BHR_VOLUME_HALO,
    /// A hollow jet along the axis and one opposite: matter in the wall of a cone about the axis, n = (r /
    /// radius)^-slope e^(-((|c| - cos psi) / thickness)^2 / 2), psi = opening sqrt(radius / r), at most pi / 2, with
    /// soft edges.
    jet = BHR_VOLUME_JET,
};

/// BhrFlow: The motion of a volume's matter.
enum class Flow : std::int32_t {
    /// On circles, inside the ISCO plunging with the energy and the angular momentum of the orbit there.
    keplerian = BHR_FLOW_KEPLERIAN,
    /// -u_ph / u_t = angular_momentum R^(3/2) / (1 + R), without radial motion: the flow of Gold et al. 2020.
    angular_momentum = BHR_FLOW_ANGULAR_MOMENTUM,
    /// Away from the hole, the faster the farther, as the matter of a jet: at rest at r = inner_radius, at speed far
    /// away, falling in nearer to the hole.
    outflow = BHR_FLOW_OUTFLOW,
};

/// BhrFormat: A pixel's bytes in memory order.
enum class Format : std::int32_t {
    /// 4 bytes: red, green, blue with the sRGB curve, alpha.
    rgba8_srgb = BHR_FORMAT_RGBA8_SRGB,
    /// 4 bytes: blue, green, red with the sRGB curve, alpha.
    bgra8_srgb = BHR_FORMAT_BGRA8_SRGB,
    /// 4 half floats: linear radiance, Rec. 709 primaries; alpha.
    rgba16f = BHR_FORMAT_RGBA16F,
    /// 4 floats: linear radiance, Rec. 709 primaries; alpha.
    rgba32f = BHR_FORMAT_RGBA32F,
    /// 1 float: the value of a view or an output, or the distance of an occluder.
    r32f = BHR_FORMAT_R32F,
    /// A uint32_t: from the lowest bit on 10 bits of red, green and blue, and 2 of alpha, as in R10G10B10A2 of DXGI and
    /// A2B10G10R10 of Vulkan.
    rgb10a2_pq = BHR_FORMAT_RGB10A2_PQ,
    /// The bits of RGB10A2_PQ by the curve HLG (ITU-R BT.2100), for a display whose peak is that of the film.
    rgb10a2_hlg = BHR_FORMAT_RGB10A2_HLG,
};

/// BhrColourSpace: The primaries of linear light in RGBA16F and RGBA32F.
enum class ColourSpace : std::int32_t {
    /// Rec. 709, white D65.
    rec709 = BHR_COLOUR_SPACE_REC709,
    /// DCI-P3, white D65 (SMPTE EG 432-1).
    p3_d65 = BHR_COLOUR_SPACE_P3_D65,
    /// Rec. 2020, white D65.
    rec2020 = BHR_COLOUR_SPACE_REC2020,
    /// ACEScg: AP1, the white of ACES (Academy S-2014-004).
    acescg = BHR_COLOUR_SPACE_ACESCG,
};

/// BhrToneMap: The curve from light to pixels.
enum class ToneMap : std::int32_t {
    /// No curve: light above 1 is clipped.
    none = BHR_TONE_MAP_NONE,
    /// A filmic curve, the fit of ACES 1.0 by Stephen Hill; middle grey, 0.18, becomes 127 of 255.
    aces = BHR_TONE_MAP_ACES,
    /// AgX, base look; middle grey becomes 128 of 255, and bright saturated light shifts its hue less than under ACES.
    agx = BHR_TONE_MAP_AGX,
    /// A filmic curve with settings, John Hable's of three powers: `toe_strength` to `shoulder_angle`.
    filmic = BHR_TONE_MAP_FILMIC,
};

/// BhrColourMap: The colours of a picture.
enum class ColourMap : std::int32_t {
    /// The picture has the colours of the light.
    none = BHR_COLOUR_MAP_NONE,
    /// The map afmhot, in which the Event Horizon Telescope publishes its images, of the luminance after the tone map:
    /// red 2 s, green 2 s - 1/2, blue 2 s - 1, each within 0 .. 1, in sRGB code values.
    afmhot = BHR_COLOUR_MAP_AFMHOT,
};

/// BhrPreset: A named look: values for all of BhrDisk, all of BhrFilm, the effects, and flags and brightness of BhrSky,
/// which setters can then change.
enum class Preset : std::int32_t {
    /// The default: a golden disk with structure and soft edges, its approaching side nearly white, and glare.
    cinematic = BHR_PRESET_CINEMATIC,
    /// A smooth disk, no glare, no tone curve; light is shown as it is, two stops down, until it clips.
    physical = BHR_PRESET_PHYSICAL,
    /// The look of the Event Horizon Telescope's sources: a ring blurred by a beam, in one colour map, on black.
    observatory = BHR_PRESET_OBSERVATORY,
    /// For lessons: a grid on the sky, and a smooth disk in the colours of its shifts, without beaming and delay.
    teaching = BHR_PRESET_TEACHING,
};

/// BhrPresetMatter: The matter that bhr_set_preset_with shows.
enum class PresetMatter : std::int32_t {
    /// DEEP where the adapter is fast enough for it, else THIN.
    automatic = BHR_PRESET_MATTER_AUTO,
    /// The thin disk, as bhr_set_preset.
    thin = BHR_PRESET_MATTER_THIN,
    /// One volume in place of the disk; TEACHING has no such look and stays THIN.
    deep = BHR_PRESET_MATTER_DEEP,
};

/// BhrMethod: The way in which light is followed.
enum class Method : std::int32_t {
    /// The fastest: rays are looked up in tables where that pays, else integrated.
    automatic = BHR_METHOD_AUTO,
    /// Every ray integrated by fixed-step fourth-order Runge-Kutta.
    rk4 = BHR_METHOD_RK4,
    /// Every ray integrated by embedded Runge-Kutta with error control.
    adaptive = BHR_METHOD_ADAPTIVE,
};

/// BhrVolumeResolution: The rays along which volumes and hot spots are summed.
enum class VolumeResolution : std::int32_t {
    /// The rays of all pixels.
    full = BHR_VOLUME_RESOLUTION_FULL,
    /// One ray of each block of 2 x 2 pixels, and those of pixels that interpolation would get wrong.
    half = BHR_VOLUME_RESOLUTION_HALF,
};

/// BhrView: The quantity that pixels show.
enum class View : std::int32_t {
    /// The picture.
    light = BHR_VIEW_LIGHT,
    /// The redshift g of the first crossing within the disk's radii, else that of the sky; NaN where the ray is
    /// captured without such a crossing.
    redshift = BHR_VIEW_REDSHIFT,
    /// The number of the image, 0, 1, 2 ..., of the first crossing within the disk's radii; -1 sky; -2 captured.
    order = BHR_VIEW_ORDER,
    /// The angle between look direction and sky direction, radians; NaN where the ray is captured.
    deflection = BHR_VIEW_DEFLECTION,
    /// The integration steps of the pixel's ray; 0 where it was looked up (BHR_METHOD_AUTO).
    steps = BHR_VIEW_STEPS,
    /// -g_tt = 1 - 2 M / r at the first crossing of the equatorial plane; NaN without one.
    metric = BHR_VIEW_METRIC,
    /// The optical depth of all volumes and hot spots, as in BhrTransfer; NaN unless the ray escapes.
    optical_depth = BHR_VIEW_OPTICAL_DEPTH,
    /// The intensity of volumes and hot spots with a power law, as in BhrTransfer.
    intensity = BHR_VIEW_INTENSITY,
};

/// BhrOutputKind: A kind of output.
enum class OutputKind : std::int32_t {
    /// The picture, or with BhrView another than LIGHT its values: what bhr_render_image makes, byte for byte, in any
    /// format that goes with the view.
    light = BHR_OUTPUT_LIGHT,
    /// R32F: the distance from the camera to what the ray meets first: along a straight line to the direct image of the
    /// disk; for light of higher orders, and captured rays, to the point of the line of sight that is nearest to the
    /// hole, 0 where that lies behind; infinity where the ray escapes without a crossing.
    depth = BHR_OUTPUT_DEPTH,
    /// RGBA32F, the lens map: the unit vector from which the light of the sky comes, and g = nu(camera) / nu(at
    /// infinity).
    sky = BHR_OUTPUT_SKY,
    /// R32F: the share of the sky's light that the disk, volumes and hot spots let pass, 0 .. 1; 0 where the ray is
    /// captured.
    transmission = BHR_OUTPUT_TRANSMISSION,
    /// RGBA32F: x, y, z of crossing number index, and its order, 0 for the direct image.
    position = BHR_OUTPUT_POSITION,
    /// RGBA32F: radius, azimuth, redshift and delay of crossing number index, as in BhrCrossing; NaN without that
    /// crossing.
    disk = BHR_OUTPUT_DISK,
    /// R32F: the value of the view whose BHR_VIEW_* index is, but not LIGHT.
    view = BHR_OUTPUT_VIEW,
};

/// BhrPresentMode: How frames reach the screen.
enum class PresentMode : std::int32_t {
    /// Never torn: a frame waits for the display.
    vsync = BHR_PRESENT_VSYNC,
    /// Frames are shown at once, and may tear.
    immediate = BHR_PRESENT_IMMEDIATE,
    /// Never torn: the newest frame at the display's rate; older ones are dropped.
    mailbox = BHR_PRESENT_MAILBOX,
};

/// BhrFate: How a ray ends.
enum class Fate : std::int32_t {
    /// The ray ends at the horizon.
    captured = BHR_FATE_CAPTURED,
    /// The ray reaches the sky.
    escaped = BHR_FATE_ESCAPED,
    /// BhrQuality.max_steps ran out.
    unresolved = BHR_FATE_UNRESOLVED,
    /// The ray is not valid: not finite, direction zero, or no frame at its place.
    invalid = BHR_FATE_INVALID,
};

/// BhrWorldLineEnd: Whether and where a world line has ended.
enum class WorldLineEnd : std::int32_t {
    /// The line goes on.
    goes_on = BHR_WORLD_LINE_GOES_ON,
    /// At r- (1 + 1e-6); without spin in the centre, at r = 1e-9 M.
    inner_horizon = BHR_WORLD_LINE_INNER_HORIZON,
    /// At r+, within 1e-6 of it: in STATIC, or backward in time.
    horizon = BHR_WORLD_LINE_HORIZON,
};

/// Bits of BhrAdapterInfo.flags.
enum class AdapterFlags : std::uint32_t {
    none = 0,
    /// A GPU with memory of its own.
    discrete = BHR_ADAPTER_DISCRETE,
    /// A software driver, or the CPU tracer.
    software = BHR_ADAPTER_SOFTWARE,
};

/// Bits of BhrContextOptions.flags.
enum class ContextFlags : std::uint32_t {
    none = 0,
    /// The driver's validation layers check bhr and report to the log.
    validation = BHR_CONTEXT_VALIDATION,
};

/// Bits of bhr_camera_matrices.flags.
enum class MatrixFlags : std::uint32_t {
    none = 0,
    /// Matrices lie in memory row by row, else column by column.
    row_major = BHR_MATRIX_ROW_MAJOR,
    /// Clip space's y = +1 is the image's bottom row, as in Vulkan; else its top row, as in OpenGL, Direct3D and Metal.
    y_down = BHR_MATRIX_Y_DOWN,
    /// Depths lie in 0 .. 1, else in -1 .. 1 (OpenGL).
    zero_to_one = BHR_MATRIX_ZERO_TO_ONE,
    /// The near plane has the greatest depth, the far one the least.
    reversed = BHR_MATRIX_REVERSED,
    /// The camera looks along its own +z, with x to the right and y up (Direct3D, Unreal), else along -z (OpenGL,
    /// Vulkan, Unity).
    forward_z = BHR_MATRIX_FORWARD_Z,
};

/// Bits of BhrDisk.flags.
enum class DiskFlags : std::uint32_t {
    none = 0,
    /// The matter orbits towards -ph.
    retrograde = BHR_DISK_RETROGRADE,
    /// Matter shines on its way from the ISCO to the horizon, too, where it falls freely.
    plunges = BHR_DISK_PLUNGES,
};

/// Bits of BhrVolume.flags.
enum class VolumeFlags : std::uint32_t {
    none = 0,
    /// The matter moves towards -ph.
    retrograde = BHR_VOLUME_RETROGRADE,
    /// The light is a power law of the frequency, not a blackbody's.
    power_law = BHR_VOLUME_POWER_LAW,
};

/// Bits of BhrHotSpot.flags.
enum class HotSpotFlags : std::uint32_t {
    none = 0,
    /// The spot moves towards -ph.
    retrograde = BHR_HOT_SPOT_RETROGRADE,
    /// The light is a blackbody's, not a power law's; without absorption there is none.
    thermal = BHR_HOT_SPOT_THERMAL,
    /// The centre is a body in free fall, which position, velocity and time tell; radius, azimuth and RETROGRADE have
    /// no meaning.
    free = BHR_HOT_SPOT_FREE,
    /// With FREE, these are told in BHR_CHART_RAIN instead of BHR_CHART_STATIC.
    rain = BHR_HOT_SPOT_RAIN,
};

/// Bits of BhrImage.flags.
enum class ImageFlags : std::uint32_t {
    none = 0,
    /// The sky is left out, and alpha is 1 - the sky's share, premultiplied.
    transparent = BHR_IMAGE_TRANSPARENT,
    /// The picture's bottom row comes first in memory, as OpenGL has it.
    bottom_up = BHR_IMAGE_BOTTOM_UP,
    /// For bhr_set_occluder, and flags of bhr_set_occluder_target: the host has drawn the things where bent light shows
    /// them (BhrProjectedPoint.apparent).
    lensed = BHR_IMAGE_LENSED,
};

/// Bits of BhrSky.flags.
enum class SkyFlags : std::uint32_t {
    none = 0,
    /// The real sky, from the embedded star catalogue.
    stars = BHR_SKY_STARS,
    /// A random field of a million stars to V = 11, with the real sky's numbers and colours, the same on every machine
    /// for the same seed.
    procedural = BHR_SKY_PROCEDURAL,
    /// The glow of the Milky Way, true to about a degree, and next to the stars eight times as bright as the eye sees
    /// it.
    milky_way = BHR_SKY_MILKY_WAY,
    /// The map that bhr_set_sky_map was given; nothing without one.
    map = BHR_SKY_MAP,
    /// A grid in sky axes, which shows the lensing: right ascension every hour, declination every 15 degrees, lines 1.3
    /// pixels wide.
    grid = BHR_SKY_GRID,
};

/// Bits of bhr_set_effects.effects.
enum class Effects : std::uint32_t {
    none = 0,
    /// The frequency shift by motion colours the light.
    doppler_shift = BHR_EFFECT_DOPPLER_SHIFT,
    /// The gravitational redshift colours the light.
    gravity_shift = BHR_EFFECT_GRAVITY_SHIFT,
    /// The intensity follows g^3 (I_nu), g^4 (bolometric).
    beaming = BHR_EFFECT_BEAMING,
    /// Moving matter is seen at its retarded time.
    light_delay = BHR_EFFECT_LIGHT_DELAY,
    /// All effects, as a new context has them.
    all = BHR_EFFECT_ALL,
};

/// Most volumes of a scene.
inline constexpr std::size_t max_volumes = BHR_MAX_VOLUMES;

/// Most hot spots of a scene.
inline constexpr std::size_t max_hot_spots = BHR_MAX_HOT_SPOTS;

/// Outputs of one call at most.
inline constexpr std::uint32_t max_outputs = BHR_MAX_OUTPUTS;

/// Crossings that a BhrHit lists.
inline constexpr std::size_t max_crossings = BHR_MAX_CROSSINGS;

/// The highest order that bhr_project_point looks for.
inline constexpr std::uint32_t max_image_order = BHR_MAX_IMAGE_ORDER;

namespace detail {
/// Whether a type is a set of bits.
template <class E>
inline constexpr bool is_bits =
    std::is_same_v<E, AdapterFlags> ||
    std::is_same_v<E, ContextFlags> ||
    std::is_same_v<E, MatrixFlags> ||
    std::is_same_v<E, DiskFlags> ||
    std::is_same_v<E, VolumeFlags> ||
    std::is_same_v<E, HotSpotFlags> ||
    std::is_same_v<E, ImageFlags> ||
    std::is_same_v<E, SkyFlags> ||
    std::is_same_v<E, Effects>;
} // namespace detail

} // namespace bhr

#endif
