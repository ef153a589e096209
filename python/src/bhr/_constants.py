# SPDX-License-Identifier: MIT OR Apache-2.0
"""The constants of bhr.h as enumerations, and the names that stand for their members. bhr.h says at length what each
one means. Made by tests/header/bindings.rs from include/bhr.json; do not edit."""

from __future__ import annotations

import enum
from typing import Any, Literal, Union


class Status(enum.IntEnum):
    """The result of a call: 0 is success, above 0 success with news, below 0 an error."""

    #: Success.
    OK = 0
    #: Bhr_job_wait: the job was still running when the timeout ran out.
    NOT_READY = 1
    #: Bhr_render_surface: the window is hidden or 0 x 0; nothing presented.
    FRAME_SKIPPED = 2
    #: An argument is NULL, not finite, out of its range, or unknown.
    INVALID_ARGUMENT = -1
    #: Wrong order, an impossible combination, or inside a callback.
    INVALID_STATE = -2
    #: The program was compiled for another BHR_ABI_VERSION.
    INCOMPATIBLE_ABI = -3
    #: Valid, but not on this adapter, platform or build.
    UNSUPPORTED = -4
    #: No adapter of the kind asked for exists.
    NO_ADAPTER = -5
    #: Host or device memory ran out.
    OUT_OF_MEMORY = -6
    #: The progress callback, or bhr_job_cancel, stopped the work.
    CANCELLED = -7
    #: A window is gone or its context recovered: destroy the surface.
    SURFACE_LOST = -8
    #: The GPU device is gone: call bhr_context_recover.
    DEVICE_LOST = -9
    #: A file could not be read or written.
    IO = -10
    #: A bug in bhr was caught; only destroy calls are valid now.
    INTERNAL = -99


class Backend(enum.IntEnum):
    """The interface to an adapter."""

    #: The best one there is, in the order above.
    AUTO = 0
    #: The built-in double-precision CPU tracer: needs no driver.
    CPU = 1
    #: Vulkan.
    VULKAN = 2
    #: Metal.
    METAL = 3
    #: Direct3D 12, never tried on Windows itself; its compiler: docs/platforms.md.
    D3D12 = 4
    #: OpenGL or OpenGL ES, by EGL or WGL.
    GL = 5


class Chart(enum.IntEnum):
    """How azimuths and times are told, and the triad that directions and velocities are told along."""

    #: Boyer and Lindquist's ph and t, and the triad of the static observer (ZAMO).
    STATIC = 0
    #: Doran's, and the triad of the rain observer, who falls from rest at infinity.
    RAIN = 1


class Projection(enum.IntEnum):
    """The lens."""

    #: A flat picture; fov_y in (0, pi).
    PERSPECTIVE = 0
    #: Dome master, equidistant: the angle from forward grows evenly with the distance from the frame's centre, to fov_y
    #: / 2 (fov_y to 2 pi) at the circle inscribed in the frame.
    FISHEYE = 1
    #: All-round picture, 360 x 180 degrees in even steps: longitude from forward (middle) to the right, latitude
    #: towards up (top); fov_y is ignored.
    EQUIRECT = 2
    #: Six faces of a cube side by side: right, left, up, down, front, back.
    CUBE = 3
    #: A flat picture between four tangents, as the frustum of a projection matrix: tan_left, tan_right, tan_down,
    #: tan_up.
    FRUSTUM = 4


class Motion(enum.IntEnum):
    """How the camera's observer moves."""

    #: At rest, outside the horizon; with spin, the zero angular momentum observer (ZAMO).
    STATIC = 0
    #: Falls from rest at infinity with E = 1 and L = Q = 0, inside the horizon too (with spin in chart RAIN).
    FREE_FALL = 1
    #: On a circle towards +ph: without spin at any latitude, with r > 3 M and beta = 1 / sqrt(r / M - 2); with spin on
    #: the circular geodesic, in the equatorial plane only (to within 1e-12 of the radius).
    ORBIT = 2
    #: Moves with BhrCamera.velocity.
    VELOCITY = 3


class Eye(enum.IntEnum):
    """The eye for which an EQUIRECT picture is made."""

    #: The camera's own place: no stereo picture.
    MIDDLE = 0
    #: The left eye.
    LEFT = 1
    #: The right eye.
    RIGHT = 2


class Transport(enum.IntEnum):
    """How bhr_camera_advance carries a camera's axes along."""

    #: Forward and up keep their angles to e_r, e_th and e_ph.
    TRIAD = 0
    #: Forward and up stay parallel to themselves along the world line, as the axes of gyroscopes do.
    PARALLEL = 1


class DiskReference(enum.IntEnum):
    """The ring at whose radius a disk has the stated temperature and brightness."""

    #: The hottest ring of the profile: at spin 0 r = 9.55 M, at spin 0.998 r = 1.58 M.
    AT_HOTTEST = 0
    #: The ring that halves the disk's area, r^2 = (inner^2 + outer^2) / 2, but for the outermost quarter of a soft
    #: outer edge's fading: the disk as a whole keeps its look when spin or edges change.
    AT_MEDIAN = 1


class EmissionLaw(enum.IntEnum):
    """How the disk's light depends on the angle to its normal, in the frame of its matter."""

    #: The disk's surface shines alike in all directions.
    ISOTROPIC = 0
    #: Like an atmosphere of free electrons: 1.269 times as bright along the normal, 0.414 times at grazing angles.
    LIMB_DARKENED = 1


class VolumeShape(enum.IntEnum):
    """The place of a volume's matter: its density n, with c = cos th, R = r sin th, z = r c, and lengths in M."""

    #: About the equatorial plane: n = (r / inner_radius)^-slope e^(-(c / thickness)^2 / 2), with soft edges.
    DISK = 0
    #: A ring about the axis: n = e^(-((R - radius) / width)^2 / 2 - (z / (thickness radius))^2 / 2).
    TORUS = 1
    #: About the hole: n = e^(-(r / radius)^2 / 2 - (c / thickness)^2 / 2), with thickness = 1e6 a sphere.
    HALO = 2
    #: A hollow jet along the axis and one opposite: matter in the wall of a cone about the axis, n = (r /
    #: radius)^-slope e^(-((|c| - cos psi) / thickness)^2 / 2), psi = opening sqrt(radius / r), at most pi / 2, with
    #: soft edges.
    JET = 3


class Flow(enum.IntEnum):
    """The motion of a volume's matter."""

    #: On circles, inside the ISCO plunging with the energy and the angular momentum of the orbit there.
    KEPLERIAN = 0
    #: -u_ph / u_t = angular_momentum R^(3/2) / (1 + R), without radial motion: the flow of Gold et al. 2020.
    ANGULAR_MOMENTUM = 1
    #: Away from the hole, the faster the farther, as the matter of a jet: at rest at r = inner_radius, at speed far
    #: away, falling in nearer to the hole.
    OUTFLOW = 2


class Format(enum.IntEnum):
    """A pixel's bytes in memory order."""

    #: 4 bytes: red, green, blue with the sRGB curve, alpha.
    RGBA8_SRGB = 1
    #: 4 bytes: blue, green, red with the sRGB curve, alpha.
    BGRA8_SRGB = 2
    #: 4 half floats: linear radiance, Rec. 709 primaries; alpha.
    RGBA16F = 3
    #: 4 floats: linear radiance, Rec. 709 primaries; alpha.
    RGBA32F = 4
    #: 1 float: the value of a view or an output, or the distance of an occluder.
    R32F = 5
    #: A uint32_t: from the lowest bit on 10 bits of red, green and blue, and 2 of alpha, as in R10G10B10A2 of DXGI and
    #: A2B10G10R10 of Vulkan.
    RGB10A2_PQ = 6
    #: The bits of RGB10A2_PQ by the curve HLG (ITU-R BT.2100), for a display whose peak is that of the film.
    RGB10A2_HLG = 7


class ColourSpace(enum.IntEnum):
    """The primaries of linear light in RGBA16F and RGBA32F."""

    #: Rec. 709, white D65.
    REC709 = 0
    #: DCI-P3, white D65 (SMPTE EG 432-1).
    P3_D65 = 1
    #: Rec. 2020, white D65.
    REC2020 = 2
    #: ACEScg: AP1, the white of ACES (Academy S-2014-004).
    ACESCG = 3


class ToneMap(enum.IntEnum):
    """The curve from light to pixels."""

    #: No curve: light above 1 is clipped.
    NONE = 0
    #: A filmic curve, the fit of ACES 1.0 by Stephen Hill; middle grey, 0.18, becomes 127 of 255.
    ACES = 1
    #: AgX, base look; middle grey becomes 128 of 255, and bright saturated light shifts its hue less than under ACES.
    AGX = 2
    #: A filmic curve with settings, John Hable's of three powers: `toe_strength` to `shoulder_angle`.
    FILMIC = 3


class ColourMap(enum.IntEnum):
    """The colours of a picture."""

    #: The picture has the colours of the light.
    NONE = 0
    #: The map afmhot, in which the Event Horizon Telescope publishes its images, of the luminance after the tone map:
    #: red 2 s, green 2 s - 1/2, blue 2 s - 1, each within 0 .. 1, in sRGB code values.
    AFMHOT = 1


class Preset(enum.IntEnum):
    """A named look: values for all of BhrDisk, all of BhrFilm, the effects, and flags and brightness of BhrSky, which
    setters can then change."""

    #: The default: a golden disk with structure and soft edges, its approaching side nearly white, and glare.
    CINEMATIC = 0
    #: A smooth disk, no glare, no tone curve; light is shown as it is, two stops down, until it clips.
    PHYSICAL = 1
    #: The look of the Event Horizon Telescope's sources: a ring blurred by a beam, in one colour map, on black.
    OBSERVATORY = 2
    #: For lessons: a grid on the sky, and a smooth disk in the colours of its shifts, without beaming and delay.
    TEACHING = 3


class PresetMatter(enum.IntEnum):
    """The matter that bhr_set_preset_with shows."""

    #: DEEP where the adapter is fast enough for it, else THIN.
    AUTO = 0
    #: The thin disk, as bhr_set_preset.
    THIN = 1
    #: One volume in place of the disk; TEACHING has no such look and stays THIN.
    DEEP = 2


class Method(enum.IntEnum):
    """The way in which light is followed."""

    #: The fastest: rays are looked up in tables where that pays, else integrated.
    AUTO = 0
    #: Every ray integrated by fixed-step fourth-order Runge-Kutta.
    RK4 = 1
    #: Every ray integrated by embedded Runge-Kutta with error control.
    ADAPTIVE = 2


class VolumeResolution(enum.IntEnum):
    """The rays along which volumes and hot spots are summed."""

    #: The rays of all pixels.
    FULL = 0
    #: One ray of each block of 2 x 2 pixels, and those of pixels that interpolation would get wrong.
    HALF = 1


class View(enum.IntEnum):
    """The quantity that pixels show."""

    #: The picture.
    LIGHT = 0
    #: The redshift g of the first crossing within the disk's radii, else that of the sky; NaN where the ray is captured
    #: without such a crossing.
    REDSHIFT = 1
    #: The number of the image, 0, 1, 2 ..., of the first crossing within the disk's radii; -1 sky; -2 captured.
    ORDER = 2
    #: The angle between look direction and sky direction, radians; NaN where the ray is captured.
    DEFLECTION = 3
    #: The integration steps of the pixel's ray; 0 where it was looked up (BHR_METHOD_AUTO).
    STEPS = 4
    #: -g_tt = 1 - 2 M / r at the first crossing of the equatorial plane; NaN without one.
    METRIC = 5
    #: The optical depth of all volumes and hot spots, as in BhrTransfer; NaN unless the ray escapes.
    OPTICAL_DEPTH = 6
    #: The intensity of volumes and hot spots with a power law, as in BhrTransfer.
    INTENSITY = 7


class OutputKind(enum.IntEnum):
    """A kind of output."""

    #: The picture, or with BhrView another than LIGHT its values: what bhr_render_image makes, byte for byte, in any
    #: format that goes with the view.
    LIGHT = 0
    #: R32F: the distance from the camera to what the ray meets first: along a straight line to the direct image of the
    #: disk; for light of higher orders, and captured rays, to the point of the line of sight that is nearest to the
    #: hole, 0 where that lies behind; infinity where the ray escapes without a crossing.
    DEPTH = 1
    #: RGBA32F, the lens map: the unit vector from which the light of the sky comes, and g = nu(camera) / nu(at
    #: infinity).
    SKY = 2
    #: R32F: the share of the sky's light that the disk, volumes and hot spots let pass, 0 .. 1; 0 where the ray is
    #: captured.
    TRANSMISSION = 3
    #: RGBA32F: x, y, z of crossing number index, and its order, 0 for the direct image.
    POSITION = 4
    #: RGBA32F: radius, azimuth, redshift and delay of crossing number index, as in BhrCrossing; NaN without that
    #: crossing.
    DISK = 5
    #: R32F: the value of the view whose BHR_VIEW_* index is, but not LIGHT.
    VIEW = 6


class Fate(enum.IntEnum):
    """How a ray ends."""

    #: The ray ends at the horizon.
    CAPTURED = 0
    #: The ray reaches the sky.
    ESCAPED = 1
    #: BhrQuality.max_steps ran out.
    UNRESOLVED = 2
    #: The ray is not valid: not finite, direction zero, or no frame at its place.
    INVALID = 3


class WorldLineEnd(enum.IntEnum):
    """Whether and where a world line has ended."""

    #: The line goes on.
    GOES_ON = 0
    #: At r- (1 + 1e-6); without spin in the centre, at r = 1e-9 M.
    INNER_HORIZON = 1
    #: At r+, within 1e-6 of it: in STATIC, or backward in time.
    HORIZON = 2


class AdapterFlags(enum.IntFlag):
    """Bits of BhrAdapterInfo.flags in bhr.h."""

    #: A GPU with memory of its own.
    DISCRETE = 1
    #: A software driver, or the CPU tracer.
    SOFTWARE = 2


class MatrixFlags(enum.IntFlag):
    """Bits of bhr_camera_matrices.flags in bhr.h."""

    #: Matrices lie in memory row by row, else column by column.
    ROW_MAJOR = 1
    #: Clip space's y = +1 is the image's bottom row, as in Vulkan; else its top row, as in OpenGL, Direct3D and Metal.
    Y_DOWN = 2
    #: Depths lie in 0 .. 1, else in -1 .. 1 (OpenGL).
    ZERO_TO_ONE = 4
    #: The near plane has the greatest depth, the far one the least.
    REVERSED = 8
    #: The camera looks along its own +z, with x to the right and y up (Direct3D, Unreal), else along -z (OpenGL,
    #: Vulkan, Unity).
    FORWARD_Z = 16


class DiskFlags(enum.IntFlag):
    """Bits of BhrDisk.flags in bhr.h."""

    #: The matter orbits towards -ph.
    RETROGRADE = 1
    #: Matter shines on its way from the ISCO to the horizon, too, where it falls freely.
    PLUNGES = 2


class VolumeFlags(enum.IntFlag):
    """Bits of BhrVolume.flags in bhr.h."""

    #: The matter moves towards -ph.
    RETROGRADE = 1
    #: The light is a power law of the frequency, not a blackbody's.
    POWER_LAW = 2


class HotSpotFlags(enum.IntFlag):
    """Bits of BhrHotSpot.flags in bhr.h."""

    #: The spot moves towards -ph.
    RETROGRADE = 1
    #: The light is a blackbody's, not a power law's; without absorption there is none.
    THERMAL = 2
    #: The centre is a body in free fall, which position, velocity and time tell; radius, azimuth and RETROGRADE have no
    #: meaning.
    FREE = 4
    #: With FREE, these are told in BHR_CHART_RAIN instead of BHR_CHART_STATIC.
    RAIN = 8


class SkyFlags(enum.IntFlag):
    """Bits of BhrSky.flags in bhr.h."""

    #: The real sky, from the embedded star catalogue.
    STARS = 1
    #: A random field of a million stars to V = 11, with the real sky's numbers and colours, the same on every machine
    #: for the same seed.
    PROCEDURAL = 2
    #: The glow of the Milky Way, true to about a degree, and next to the stars eight times as bright as the eye sees
    #: it.
    MILKY_WAY = 4
    #: The map that bhr_set_sky_map was given; nothing without one.
    MAP = 8
    #: A grid in sky axes, which shows the lensing: right ascension every hour, declination every 15 degrees, lines 1.3
    #: pixels wide.
    GRID = 16


class Effects(enum.IntFlag):
    """Bits of bhr_set_effects.effects in bhr.h."""

    #: The frequency shift by motion colours the light.
    DOPPLER_SHIFT = 1
    #: The gravitational redshift colours the light.
    GRAVITY_SHIFT = 2
    #: The intensity follows g^3 (I_nu), g^4 (bolometric).
    BEAMING = 4
    #: Moving matter is seen at its retarded time.
    LIGHT_DELAY = 8
    #: All effects, as a new context has them.
    ALL = 4294967295


BackendName = Literal["auto", "cpu", "vulkan", "metal", "d3d12", "gl"]
BackendLike = Union[Backend, BackendName]
ChartName = Literal["static", "rain"]
ChartLike = Union[Chart, ChartName]
ProjectionName = Literal["perspective", "fisheye", "equirect", "cube", "frustum"]
ProjectionLike = Union[Projection, ProjectionName]
MotionName = Literal["static", "free_fall", "orbit", "velocity"]
MotionLike = Union[Motion, MotionName]
EyeName = Literal["middle", "left", "right"]
EyeLike = Union[Eye, EyeName]
TransportName = Literal["triad", "parallel"]
TransportLike = Union[Transport, TransportName]
DiskReferenceName = Literal["at_hottest", "at_median"]
DiskReferenceLike = Union[DiskReference, DiskReferenceName]
EmissionLawName = Literal["isotropic", "limb_darkened"]
EmissionLawLike = Union[EmissionLaw, EmissionLawName]
VolumeShapeName = Literal["disk", "torus", "halo", "jet"]
VolumeShapeLike = Union[VolumeShape, VolumeShapeName]
FlowName = Literal["keplerian", "angular_momentum", "outflow"]
FlowLike = Union[Flow, FlowName]
FormatName = Literal["rgba8_srgb", "bgra8_srgb", "rgba16f", "rgba32f", "r32f", "rgb10a2_pq", "rgb10a2_hlg"]
FormatLike = Union[Format, FormatName]
ColourSpaceName = Literal["rec709", "p3_d65", "rec2020", "acescg"]
ColourSpaceLike = Union[ColourSpace, ColourSpaceName]
ToneMapName = Literal["none", "aces", "agx", "filmic"]
ToneMapLike = Union[ToneMap, ToneMapName]
ColourMapName = Literal["none", "afmhot"]
ColourMapLike = Union[ColourMap, ColourMapName]
PresetName = Literal["cinematic", "physical", "observatory", "teaching"]
PresetLike = Union[Preset, PresetName]
PresetMatterName = Literal["auto", "thin", "deep"]
PresetMatterLike = Union[PresetMatter, PresetMatterName]
MethodName = Literal["auto", "rk4", "adaptive"]
MethodLike = Union[Method, MethodName]
VolumeResolutionName = Literal["full", "half"]
VolumeResolutionLike = Union[VolumeResolution, VolumeResolutionName]
ViewName = Literal["light", "redshift", "order", "deflection", "steps", "metric", "optical_depth", "intensity"]
ViewLike = Union[View, ViewName]
OutputKindName = Literal["light", "depth", "sky", "transmission", "position", "disk", "view"]
OutputKindLike = Union[OutputKind, OutputKindName]

#: The types of the names of each enumeration; names of flags are any text, as several may be joined.
NAMES: dict[type[enum.IntEnum], Any] = {
    Backend: BackendName,
    Chart: ChartName,
    Projection: ProjectionName,
    Motion: MotionName,
    Eye: EyeName,
    Transport: TransportName,
    DiskReference: DiskReferenceName,
    EmissionLaw: EmissionLawName,
    VolumeShape: VolumeShapeName,
    Flow: FlowName,
    Format: FormatName,
    ColourSpace: ColourSpaceName,
    ToneMap: ToneMapName,
    ColourMap: ColourMapName,
    Preset: PresetName,
    PresetMatter: PresetMatterName,
    Method: MethodName,
    VolumeResolution: VolumeResolutionName,
    View: ViewName,
    OutputKind: OutputKindName,
}
