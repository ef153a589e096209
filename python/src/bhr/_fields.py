# SPDX-License-Identifier: MIT OR Apache-2.0
"""The structs of bhr.h as frozen dataclasses, with the library's defaults.
Made by tests/header/python_structs.rs from include/bhr.json; do not edit."""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar

from ._camera import CameraMethods
from ._constants import (
    AdapterFlags,
    Backend,
    Chart,
    ChartName,
    ColourMap,
    ColourMapName,
    DiskFlags,
    DiskReference,
    DiskReferenceName,
    EmissionLaw,
    EmissionLawName,
    Eye,
    EyeName,
    Flow,
    FlowName,
    HotSpotFlags,
    Method,
    MethodName,
    Motion,
    MotionName,
    Projection,
    ProjectionName,
    SkyFlags,
    ToneMap,
    ToneMapName,
    Transport,
    TransportName,
    VolumeFlags,
    VolumeResolution,
    VolumeResolutionName,
    VolumeShape,
    VolumeShapeName,
)
from ._names import Named, named
from ._struct import Quaternion, Struct, Vector


@dataclasses.dataclass(frozen=True)
class Camera(CameraMethods):
    """The camera: an observer with a lens. Positions and axes in scene axes and lengths."""

    c_name: ClassVar[str] = "BhrCamera"
    c_enums = {"projection": Projection, "motion": Motion, "eye": Eye, "chart": Chart, "transport": Transport}

    #: Default (0, 26, 2.5). Not (0, 0, 0).
    position: Vector = (0.0, 26.0, 2.5)
    #: Any non-zero length. Default: towards the hole.
    forward: Vector = (0.0, -26.0, -2.5)
    #: Any non-zero length, not parallel to forward. Default +z.
    up: Vector = (0.0, 0.0, 1.0)
    #: Radians: full vertical angle, (0, pi), for PERSPECTIVE; across the circle, (0, 2 pi], for FISHEYE. Default pi /
    #: 4.
    fov_y: float = 0.7853981633974483
    #: One of Projection. Default PERSPECTIVE.
    projection: Named[Projection, ProjectionName] = named(Projection.PERSPECTIVE)
    #: One of Motion. Default STATIC.
    motion: Named[Motion, MotionName] = named(Motion.STATIC)
    #: For Motion.VELOCITY: v / c against the observer of the chart's triad (by default the local static one, the ZAMO),
    #: |v| < 1; components as for a direction given at position. Default 0.
    velocity: Vector = (0.0, 0.0, 0.0)
    #: For FRUSTUM: the borders of the picture on the plane at distance 1 ahead, to the right and up, within +-1e9; left
    #: less than right, down less than up. Default -1, 1, -1, 1. Other projections ignore them.
    tan_left: float = -1.0
    #: The right border.
    tan_right: float = 1.0
    #: The lower border.
    tan_down: float = -1.0
    #: The upper border.
    tan_up: float = 1.0
    #: Pixels that the whole picture moves to the right and down, each within +-1, for temporal antialiasing. For
    #: PERSPECTIVE and FRUSTUM; other projections ignore it. Default 0.
    jitter: tuple[float, float] = (0.0, 0.0)
    #: For EQUIRECT with an eye: the distance of the two eyes, scene lengths, at least 0. Default 0.
    eye_distance: float = 0.0
    #: One of Eye. With LEFT or RIGHT and an eye_distance above 0 an EQUIRECT picture is one of two for 360-degree
    #: stereo (omnidirectional stereo, ODS), and takes longer. Bloom of a preset is then left out; other bloom, and all
    #: else of a film that regions cannot have, are INVALID_STATE; windows, bhr_project_point, outputs other than LIGHT,
    #: occluders and targets on the GPU are UNSUPPORTED. Other projections ignore it. Default MIDDLE. docs/cameras.md.
    eye: Named[Eye, EyeName] = named(Eye.MIDDLE)
    #: One of Chart: that of position, forward, up and velocity, of the time of bhr_set_time, and of the rays, paths and
    #: points that this context is asked for. RAIN is needed at and inside a spinning hole's horizon; a fall that is to
    #: go there must be told in it from the start. Default STATIC.
    chart: Named[Chart, ChartName] = named(Chart.STATIC)
    #: One of Transport. Default TRIAD.
    transport: Named[Transport, TransportName] = named(Transport.TRIAD)


@dataclasses.dataclass(frozen=True)
class Disk(Struct):
    """A geometrically thin disk in the equatorial plane, on circular geodesics, with the Page-Thorne flux. Radii in
    units of M. docs/matter.md has the model."""

    c_name: ClassVar[str] = "BhrDisk"
    c_enums = {"flags": DiskFlags, "reference": DiskReference, "emission_law": EmissionLaw}

    #: In M, 0 .. 1e6. The disk begins here, but not inside the ISCO, or with DiskFlags.PLUNGES not inside the horizon.
    #: Default 0: at the ISCO, or at the horizon.
    inner_radius: float = 0.0
    #: In M, 0 .. 1e6, greater than inner_radius. Default 17.
    outer_radius: float = 17.0
    #: Kelvin at the ring that `reference` says, 500 .. 1e9. Default 3500.
    temperature: float = 3500.0
    #: 0 .. 1. Default 1.
    opacity: float = 1.0
    #: 0 .. 1e6: the luminance of that ring at rest. Default 0.6.
    brightness: float = 0.6
    #: Contrast of the structure that orbits with the matter, 0 .. 1; 0 is smooth. Default 1. Its mean is the smooth
    #: disk's light. bhr_set_time carries it along, forwards and backwards, at any time to 1e9 M and more.
    turbulence: float = 1.0
    #: Selects the turbulence: the same seed always gives the same pattern. Any number. Default 0.
    seed: int = 0
    #: Any of DiskFlags.RETROGRADE | DiskFlags.PLUNGES. Default 0.
    flags: Named[DiskFlags, str] = named(DiskFlags(0))
    #: One of DiskReference. Default AT_MEDIAN; AT_HOTTEST in structs of 0.1.0's size.
    reference: Named[DiskReference, DiskReferenceName] = named(DiskReference.AT_MEDIAN)
    #: EmissionLaw.ISOTROPIC (default), EmissionLaw.LIMB_DARKENED.
    emission_law: Named[EmissionLaw, EmissionLawName] = named(EmissionLaw.ISOTROPIC)
    #: 0 .. 1, default 0.4, 0 is sharp: opacity and light fade to nothing over this share of the way from the inner edge
    #: to the outer one, at its end, and near the ISCO. A disk that inner_radius cuts off outside the hottest ring is
    #: sharp there.
    edge_softness: float = 0.4


@dataclasses.dataclass(frozen=True)
class Volume(Struct):
    """Matter with depth, which shines and absorbs by the equation of transfer; nothing is scattered. Radii are in units
    of M, other lengths those that the matter itself measures. Thermal matter absorbs alike at all frequencies, and
    without absorption does not shine. A power law emits j = n (nu / nu_camera)^-spectral_index per M, and its
    absorption per M is absorption n (nu / nu_camera)^-(2.5 + spectral_index), nu being the frequency that the matter
    measures: a picture shows its light at the one frequency nu_camera, in the colour tint. No matter is inside the
    horizon. Fields that shape and flow do not use are checked all the same. docs/matter.md."""

    c_name: ClassVar[str] = "BhrVolume"
    c_enums = {"shape": VolumeShape, "flow": Flow, "flags": VolumeFlags}

    #: VolumeShape.DISK (default), TORUS, HALO, JET.
    shape: Named[VolumeShape, VolumeShapeName] = named(VolumeShape.DISK)
    #: Flow.KEPLERIAN (default), ANGULAR_MOMENTUM, OUTFLOW.
    flow: Named[Flow, FlowName] = named(Flow.KEPLERIAN)
    #: Any of VolumeFlags.RETROGRADE | VolumeFlags.POWER_LAW. Default 0.
    flags: Named[VolumeFlags, str] = named(VolumeFlags(0))
    #: In M, 1e-6 .. 1e4, or 0 (default): the ISCO of matter that moves as flags say. DISK, JET: the inner edge;
    #: OUTFLOW: the place where matter is at rest.
    inner_radius: float = 0.0
    #: In M, 0 .. 1e4, greater than inner_radius. There is nothing beyond it, whatever the shape, and nothing at all of
    #: a DISK or JET whose outer_radius is less than 0.9 times its inner edge, be that the ISCO. Default 17.
    outer_radius: float = 17.0
    #: In M, 0.1 .. 1e4. TORUS: the ring's; HALO: the scale; JET: where psi = opening. Default 8.
    radius: float = 8.0
    #: In M, 1e-3 .. 1e4, of a TORUS at least radius / 100: its Gaussian width in R. Default 2.
    width: float = 2.0
    #: 0.01 .. 1e6: the Gaussian width in c; TORUS: in z, over radius. Default 0.05, a soft disk; 0.14 is thick.
    thickness: float = 0.05
    #: JET: the wall's angle from the axis at `radius`, radians, 0.01 .. 1.5. Default 0.3.
    opening: float = 0.3
    #: DISK, JET: 0 .. 4. Default 0.7.
    slope: float = 0.7
    #: Per M at density 1, 0 .. 1e6. Default 3; less than 0.5 is mist, more than 5 a surface.
    absorption: float = 3.0
    #: Kelvin, 500 .. 1e9, at inner_radius (DISK, JET) or at radius (TORUS, HALO). Default 4800.
    temperature: float = 4800.0
    #: 0 .. 2: the temperature goes as r^-temperature_slope. Default 0.35; 0.75 is like a thin disk.
    temperature_slope: float = 0.35
    #: POWER_LAW: -4 .. 4. Default 1.
    spectral_index: float = 1.0
    #: POWER_LAW: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1.
    tint: Vector = (1.0, 1.0, 1.0)
    #: A factor on the light, 0 .. 1e6, which changes neither its colour nor what is absorbed. At 1 the light is as
    #: bright as white without exposure and tone map: of thermal matter of `temperature` at rest that is so thick that
    #: nothing shines through; of a power law, of 1 M of density 1 at rest which absorbs nothing. Default 1.
    brightness: float = 1.0
    #: KEPLERIAN: the share of the orbit's angular momentum, 0 .. 1. Default 1.
    sub_keplerian: float = 1.0
    #: KEPLERIAN: a share without a unit, 0 .. 1: 0 (default) is orbits, 1 free fall from rest at infinity.
    infall: float = 0.0
    #: ANGULAR_MOMENTUM: 0 .. 1. Default 1.
    angular_momentum: float = 1.0
    #: OUTFLOW: the velocity far away in units of c, 0 .. 0.995. Default 0.9.
    speed: float = 0.9
    #: 0 .. 1: the contrast of structure that the matter carries along: a pattern P = e^(turbulence G) over its mean, G
    #: being noise of mean 0 and about variance 1. Default 1; 0 is even matter, as is that of a host whose BhrVolume
    #: ends before this field.
    turbulence: float = 1.0
    #: 0.5 .. 3: the density is multiplied by P^clumping over its mean; more makes filaments. Default 1.8.
    clumping: float = 1.8
    #: 0 .. 0.5: the temperature is multiplied by P^heating, so that dense matter is hotter. Default 0.15.
    heating: float = 0.15
    #: Selects the structure: the same seed always gives the same one. Any number. Default 0.
    seed: int = 0


@dataclasses.dataclass(frozen=True)
class HotSpot(Struct):
    """A glowing blob, by default on a circular geodesic in the equatorial plane: n = e^(-(d / size)^2 / 2), cut off at
    7 sizes, d being the distance from its centre in chart coordinates. It is rigid: all of it turns as its centre does,
    at dph/dt = 1 / (radius^(3/2) + a), with RETROGRADE -1 / (radius^(3/2) - a), per M; parts that would be faster than
    light, beside the hole, are left out. It shines and absorbs as BhrVolume says, and its delay matters
    (docs/matter.md). With HotSpotFlags.FREE the centre moves on any geodesic, for some six hundred turns about the hole
    before and after `time` and out to 1e4 M, and distances are those of Doran's chart."""

    c_name: ClassVar[str] = "BhrHotSpot"
    c_enums = {"flags": HotSpotFlags}

    #: In M, 1 .. 1000. Inside the ISCO no orbit is stable: there the spot is taken to be at the ISCO. Default 8.
    radius: float = 8.0
    #: In M, 0.05 .. radius / 4, and at least radius / 200; FREE: from 0.05 to 250. Default 0.8.
    size: float = 0.8
    #: The centre at scene time 0, radians within +-1e6. Default 0.
    azimuth: float = 0.0
    #: Any of HotSpotFlags.RETROGRADE | HotSpotFlags.THERMAL | HotSpotFlags.FREE | HotSpotFlags.RAIN. Default 0.
    flags: Named[HotSpotFlags, str] = named(HotSpotFlags(0))
    #: Per M at the centre, 0 .. 1e6. Default 0.
    absorption: float = 0.0
    #: Kelvin, 500 .. 1e9. Default 10000.
    temperature: float = 10000.0
    #: Without THERMAL: -4 .. 4. Default 1.
    spectral_index: float = 1.0
    #: Without THERMAL: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1.
    tint: Vector = (1.0, 1.0, 1.0)
    #: 0 .. 1e6, as BhrVolume.brightness. Default 1.
    brightness: float = 1.0
    #: FREE: where the centre is at `time`, scene axes and lengths, as BhrBody has it. Default 0, 0, 0, which FREE
    #: refuses.
    position: Vector = (0.0, 0.0, 0.0)
    #: FREE: its velocity there in units of c, |v| < 1, scene axes, as BhrBody has it. Default 0, 0, 0.
    velocity: Vector = (0.0, 0.0, 0.0)
    #: FREE: scene time, in scene lengths, that position and velocity are of; RAIN: rain time. Default 0.
    time: float = 0.0


@dataclasses.dataclass(frozen=True)
class Sky(Struct):
    """The sky: everything that lies at infinity."""

    c_name: ClassVar[str] = "BhrSky"
    c_enums = {"flags": SkyFlags}

    #: SkyFlags bits; 0: black. Default STARS | MILKY_WAY.
    flags: Named[SkyFlags, str] = named(SkyFlags.STARS | SkyFlags.MILKY_WAY)
    #: A factor on the light of the stars, 0 .. 1e6. Default 1.
    stars_brightness: float = 1.0
    #: A factor on the light of the Milky Way and the map, 0 .. 1e6. Default 1.
    map_brightness: float = 1.0
    #: Unit quaternion x y z w that takes sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole) to
    #: scene axes. Default (0, 0, 0, 1).
    orientation: Quaternion = (0.0, 0.0, 0.0, 1.0)
    #: Selects the stars of SkyFlags.PROCEDURAL: any number. Default 0.
    seed: int = 0


@dataclasses.dataclass(frozen=True)
class Film(Struct):
    """How light becomes pixels, in formats of 8 and 10 bits and windows of View.LIGHT only: float formats hold linear
    radiance, and other views show values. In this order: exposure, bloom, beam, flare, spikes and streak, auto
    exposure, highlights and shadows, vignette, white balance, contrast, saturation, grain, tone map, the sRGB curve and
    the LUT, or the colour map, dithering."""

    c_name: ClassVar[str] = "BhrFilm"
    c_enums = {"tone_map": ToneMap, "colour_map": ColourMap}

    #: One of ToneMap. Default ACES.
    tone_map: Named[ToneMap, ToneMapName] = named(ToneMap.ACES)
    #: Stops, -20 .. 20. Default 0.
    exposure_ev: float = 0.0
    #: Glare, 0 .. 1, 0 off, default 0.25: optics scatter 0.4 bloom of each pixel's light over its surroundings, alike
    #: at every resolution. No light is lost, and transparent images keep their alpha. With a region set, 8- and 10-bit
    #: images of light are INVALID_STATE when they are rendered; but where no bhr_set_film came after the context was
    #: made, or after the last bhr_set_preset, they are rendered without glare. docs/colour-and-film.md.
    bloom: float = 0.25
    #: The full width at half maximum of a Gaussian that the picture is spread by, as by a telescope's beam; in frame
    #: heights, 0 .. 1, 0 off (default). Alpha is left alone. With a region set, 8- and 10-bit images of light are
    #: INVALID_STATE when they are rendered, also when a preset set the beam. docs/colour-and-film.md.
    beam_fwhm: float = 0.0
    #: One of ColourMap. Default NONE.
    colour_map: Named[ColourMap, ColourMapName] = named(ColourMap.NONE)
    #: Blades of the lens's aperture, 3 .. 8: an even number of them makes as many spikes, an odd one twice as many. 0,
    #: the default, stands for 6.
    spike_blades: int = 0
    #: Kelvin, 1667 .. 25000, of the blackbody whose light is to look white: the lower, the bluer the picture. Default
    #: 0: colours stay as they are.
    white_balance: float = 0.0
    #: -1 .. 1: the picture turns towards magenta above 0, towards green below. Default 0. The light that is to look
    #: white has a Duv of 0.02 tint (CIE 1960): above 0 it is greener than a blackbody's.
    tint: float = 0.0
    #: 0.25 .. 4, the exponent of light; light of 0.18, middle grey, stays as it is. Default 1.
    contrast: float = 1.0
    #: 0 .. 4, a factor on how far colours are from the grey of their luminance; 0 is grey. Default 1.
    saturation: float = 1.0
    #: FILMIC, 0 .. 1: at 0 dark light stays linear, at 1 all of the toe, the curve's dark end, is black. Default 0.5.
    toe_strength: float = 0.5
    #: FILMIC: 0 .. 1; the toe ends at light toe_length^2.2 / 2. Default 0.5.
    toe_length: float = 0.5
    #: FILMIC: stops, 0 .. 16; light from about 2^shoulder_strength on is white. Default 2.
    shoulder_strength: float = 2.0
    #: FILMIC, 0 .. 1: the share that the shoulder, the curve's bright end, has of all that is above the toe. Default
    #: 0.5.
    shoulder_length: float = 0.5
    #: FILMIC: how steep the shoulder still is at white, 0 .. 1; at 0 it ends flat. Default 1.
    shoulder_angle: float = 1.0
    #: 0 .. 1, the share of a lens' natural darkening, cos^4 of an angle whose tangent is 1 in the corners of the whole
    #: frame: at 1, light is a quarter there. Default 0.
    vignette: float = 0.0
    #: Auto exposure, 0 .. 1: how far the exposure goes to where auto_percentile is auto_target. Default 0: off. The
    #: frame's luminance is measured after exposure_ev and bloom, in small cells; cells darker than 2^-16 do not count.
    #: exposure_ev is taken back by it: auto_target is what makes the picture brighter. bhr_frame_stats has what was
    #: added. With a region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered.
    auto_exposure: float = 0.0
    #: The percentile of the frame's luminance that auto exposure goes by, 0 .. 100. Default 90.
    auto_percentile: float = 90.0
    #: The luminance that auto exposure brings the percentile to, 0.001 .. 1000; middle grey is 0.18. Default 0.5.
    auto_target: float = 0.5
    #: The least that auto exposure adds, stops, -20 .. 20. Default -8.
    auto_least_ev: float = -8.0
    #: The most that auto exposure adds, stops, -20 .. 20. Default 8. If it is below auto_least_ev, this is what is
    #: added.
    auto_most_ev: float = 8.0
    #: 0.000001 .. 1: the share of the way that a frame goes from the exposure of the last frame of its size that this
    #: context measured. Default 1: all of it, so that a picture depends on its scene alone. For frames t apart and a
    #: time constant T it is 1 - exp(-t / T).
    auto_adaptation: float = 1.0
    #: Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, bright parts of the picture come;
    #: their structure stays. Default 0: off. With a region set, 8- and 10-bit images of light are INVALID_STATE when
    #: they are rendered.
    highlights: float = 0.0
    #: Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, dark parts of the picture come.
    #: Default 0: off. Black stays black, but glare over it is lifted like other light: use less bloom with it. With a
    #: region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered.
    shadows: float = 0.0
    #: Grain, 0 .. 1: light varies at random from place to place, with a standard deviation of 0.25 grain of itself.
    #: Default 0: off. The mean light stays. Its cells are a 1080th of the frame's height wide, but no smaller than a
    #: pixel.
    grain: float = 0.0
    #: Any number within +-1e15: each is another grain, for instance that of a film's frame. Default 0.
    grain_seed: float = 0.0
    #: 0 .. 1, the share of the colours that the LUT of bhr_set_film_lut has in the picture; 0 off. Default 1.
    lut_strength: float = 1.0
    #: Diffraction spikes, 0 .. 1, 0 off (default): the lens throws 0.4 spikes of each pixel's light along lines that
    #: lie across the edges of the aperture's blades; they are reddish. No light is lost. With a region set, 8- and
    #: 10-bit images of light are INVALID_STATE when they are rendered. docs/colour-and-film.md.
    spikes: float = 0.0
    #: The direction of one spike, radians anticlockwise from upright, -2 pi .. 2 pi. Default 0.
    spike_angle: float = 0.0
    #: In frame heights, 0.01 .. 2: the length of the spikes' faint tails, which fall off by exp(-distance /
    #: spike_length). Default 0.25.
    spike_length: float = 0.25
    #: The horizontal streak of an anamorphic lens, 0 .. 1, 0 off (default): 0.4 streak of each pixel's light is thrown
    #: to its left and right. No light is lost. With a region set, 8- and 10-bit images of light are INVALID_STATE when
    #: they are rendered. docs/colour-and-film.md.
    streak: float = 0.0
    #: In frame heights, 0.01 .. 4: the length of the streak's tails, which fall off by exp(-distance / streak_length).
    #: Default 0.5.
    streak_length: float = 0.5
    #: The streak's colour, -1 .. 1: -1 is amber, 0 that of the light, 1 blue. Default 0.
    streak_tint: float = 0.0
    #: BHR_FORMAT_RGB10A2_*: what the display shows for light of 1, diffuse white; cd/m^2, 10 .. 1000. Default 203, as
    #: in ITU-R BT.2408.
    paper_white: float = 203.0
    #: BHR_FORMAT_RGB10A2_*: the brightest that the display shows, cd/m^2, 100 .. 10000, to which brighter light is
    #: rolled off. Default 1000.
    peak: float = 1000.0
    #: Lens flare, 0 .. 1, 0 off (default): the lens reflects 0.15 flare of each pixel's light into ghosts, blurred
    #: images of its aperture (spike_blades, spike_angle) in several colours, on the line from that pixel through the
    #: middle of the frame. Ghosts of lights near the border are faint: that light is lost, no other. With a region set,
    #: 8- and 10-bit images of light are INVALID_STATE when they are rendered. docs/colour-and-film.md.
    flare: float = 0.0
    #: How many ghosts each light has, 0 .. 8; 0, the default, stands for 5.
    flare_ghosts: int = 0


@dataclasses.dataclass(frozen=True)
class Quality(Struct):
    """How exactly to trace."""

    c_name: ClassVar[str] = "BhrQuality"
    c_enums = {"method": Method, "volume_resolution": VolumeResolution}

    #: One of Method. Default AUTO.
    method: Named[Method, MethodName] = named(Method.AUTO)
    #: Samples of each pixel, 1 .. 256. Default 1. More than one are weighted by a B-spline 3 pixels wide; in a CUBE
    #: they lie evenly in the pixel; while a shutter is open they are moments, all through the pixel's middle. Views
    #: other than View.LIGHT take one. Pixels that an edge runs through get more rays in any case.
    samples_per_pixel: int = 1
    #: Steps of an integrated ray, 16 .. 100000. Default 2000. A ray that needs more is Fate.UNRESOLVED.
    max_steps: int = 2000
    #: RK4: the step, 1e-3 .. 0.5, in Mino time scaled to the ray (docs/numerics.md); 0 means the default, 0.1.
    step: float = 0.0
    #: ADAPTIVE: the relative tolerance, 1e-14 .. 1e-3; 0: the default, 1e-10. Single-precision tracers use their own.
    tolerance: float = 0.0
    #: Images of the disk to follow, 0 .. 15; 0: the direct one only. Default 3.
    max_disk_order: int = 3
    #: Windows: traced size / window size, 0.1 .. 1. Default 1.
    render_scale: float = 1.0
    #: One of VolumeResolution. Default FULL. No effect without volumes and hot spots.
    volume_resolution: Named[VolumeResolution, VolumeResolutionName] = named(VolumeResolution.FULL)


@dataclasses.dataclass(frozen=True)
class Region(Struct):
    """The part of a larger frame that an image holds: for tiles, dome walls and render farms. Tiles that are joined
    have the same bytes as the frame, unless its film needs the light of the whole frame (see bhr_set_region)."""

    c_name: ClassVar[str] = "BhrRegion"

    #: Pixels of the whole frame, 1 .. 2^20.
    full_width: int
    #: Pixels of the whole frame, 1 .. 2^20.
    full_height: int
    #: Column of the image's left pixels in the frame, < full_width.
    x: int = 0
    #: Row of the image's top pixels in the frame, < full_height.
    y: int = 0


@dataclasses.dataclass(frozen=True)
class ProjectedPoint(Struct):
    """An image of a point: where on the screen it appears, and how."""

    c_name: ClassVar[str] = "BhrProjectedPoint"

    #: 1: a ray to the point was found. 0: there is none (the point is in the hole, or where the camera is), or it is
    #: lost; the numbers are then NaN, the ray's 0.
    found: int
    #: 1: it is within the image, whatever matter or sky may be before it. 0: beside it, or not found.
    on_screen: int
    #: 1: none was found, though there may be one.
    lost: int
    #: Pixel position to the right, as of bhr_camera_ray; beyond the image where it is not on the screen. NaN where the
    #: projection has no place for the direction: behind a PERSPECTIVE or FRUSTUM.
    x: float
    #: Pixel position downwards, likewise.
    y: float
    #: The ray from the camera to the point, on the screen or not: bhr_camera_ray at x, y.
    ray: Any
    #: The solid angle in which the camera, moving as it does, sees something small at the point, over A / distance^2,
    #: that without the hole; negative where the image is mirrored. A is its area square to the light, as the ZAMO there
    #: measures it (any observer there finds the same); its area in chart coordinates is less near the hole, without
    #: spin by sqrt(1 - 2 M / r) where it lies along the radius. It grows without limit near a caustic.
    magnification: float
    #: Coordinate time (in chart RAIN rain time) since the light left the point, scene lengths; NaN from inside the
    #: horizon in chart STATIC.
    delay: float
    #: g = nu(camera) / nu(observer at rest at the point, with spin the ZAMO).
    redshift: float
    #: The straight distance from the camera to the point, scene lengths: its depth for OutputKind.DEPTH and
    #: bhr_set_occluder.
    distance: float
    #: Where the point seems to be, scene axes: as far from the camera as it is, in the direction of its image. A vertex
    #: that is drawn here with the camera's own matrices appears at x, y, with the depth that belongs to it.
    apparent: Vector


@dataclasses.dataclass(frozen=True)
class HoleInfo(Struct):
    """Numbers about the hole and the camera's observer. Lengths are in scene units; what is not defined is NaN."""

    c_name: ClassVar[str] = "BhrHoleInfo"

    #: r+ = M + sqrt(M^2 - a^2).
    horizon_radius: float
    #: 2 M, at every spin.
    ergosphere_equatorial_radius: float
    #: Equatorial circular photon orbit towards +ph.
    photon_orbit_prograde: float
    #: Equatorial circular photon orbit towards -ph.
    photon_orbit_retrograde: float
    #: Innermost stable circular orbit of matter towards +ph.
    isco_prograde: float
    #: Innermost stable circular orbit of matter towards -ph.
    isco_retrograde: float
    #: Spin 0: 3 sqrt(3) M; NaN with spin.
    critical_impact_parameter: float
    #: Spin 0: angular radius of the shadow as the camera's observer sees it, radians; NaN with spin.
    shadow_angular_radius: float
    #: Boyer-Lindquist r of the camera.
    camera_radius: float
    #: d tau / d t, the rate of the clock of the camera's observer; t is the time of BhrCamera.chart.
    camera_time_rate: float
    #: r- = M - sqrt(M^2 - a^2), down to which the inside of a spinning hole is known; 0 without spin.
    inner_horizon_radius: float


@dataclasses.dataclass(frozen=True)
class FrameStats(Struct):
    """Numbers about the last finished frame; all 0 before the first. Times in nanoseconds."""

    c_name: ClassVar[str] = "BhrFrameStats"

    #: Counts the finished frames of a context from 1: images, jobs, windows, and each call that accumulates or ends.
    frame_index: int
    #: Pixels times samples.
    rays: int
    #: Integration steps of all rays; rays that were looked up take none.
    steps: int
    #: From the call's beginning to its end; for a job, from its request until it was done.
    cpu_ns: int
    #: Time on the GPU; 0 where the adapter has no timestamps, or traces on the CPU.
    gpu_ns: int
    #: Time to copy pixels into the host's memory, without the wait for the GPU.
    readback_ns: int
    #: Device memory that the context holds.
    device_bytes: int
    #: Lens tables made for this frame: 0 where those of an earlier one served, or none were needed.
    lens_tables: int
    #: Stops that auto exposure (BhrFilm.auto_exposure) added to the film's exposure_ev; 0 without it.
    auto_ev: float


@dataclasses.dataclass(frozen=True)
class AdapterInfo(Struct):
    """One adapter."""

    c_name: ClassVar[str] = "BhrAdapterInfo"
    c_enums = {"backend": Backend, "flags": AdapterFlags}

    #: UTF-8, cut where it is longer.
    name: str
    #: Name and version of the driver, UTF-8; "" where it is not known. D3D12: and who compiles kernels, DXC or FXC.
    driver: str
    #: One of Backend, never AUTO.
    backend: Backend
    #: AdapterFlags bits.
    flags: AdapterFlags
    #: PCI id of the vendor; 0 for the CPU tracer.
    vendor_id: int
    #: PCI id of the device; 0 for the CPU tracer.
    device_id: int
