// SPDX-License-Identifier: MIT OR Apache-2.0
// scene.d.ts -- what a scene is made of, under the names of scenes as text (docs/scenes.md).
// Made by tests/header/typescript.rs from include/bhr.json; do not edit.

import type {
    Chart,
    ColourMap,
    DiskFlag,
    DiskReference,
    EmissionLaw,
    Eye,
    Flow,
    HotSpotFlag,
    Method,
    Motion,
    Projection,
    SkyFlag,
    ToneMap,
    Transport,
    VolumeFlag,
    VolumeResolution,
    VolumeShape,
} from "./words";

/** Components along x, y and z, or red, green and blue. */
export type Vector = readonly [number, number, number];

/** The camera: an observer with a lens. Positions and axes in scene axes and lengths. */
export interface Camera {
    /**
     * One of Projection. Default PERSPECTIVE.
     * @default "perspective"
     */
    projection: Projection;
    /**
     * Default (0, 26, 2.5). Not (0, 0, 0).
     * @default [0, 26, 2.5]
     */
    position: Vector;
    /**
     * Any non-zero length. Default: towards the hole.
     * @default [0, -26, -2.5]
     */
    forward: Vector;
    /**
     * Any non-zero length, not parallel to forward. Default +z.
     * @default [0, 0, 1]
     */
    up: Vector;
    /**
     * Radians: full vertical angle, (0, pi), for PERSPECTIVE; across the circle, (0, 2 pi], for FISHEYE. Default pi /
     * 4.
     * @unit rad
     * @default 0.7853981633974483
     */
    fov_y: number;
    /**
     * One of Motion. Default STATIC.
     * @default "static"
     */
    motion: Motion;
    /**
     * For "velocity": v / c against the observer of the chart's triad (by default the local static one, the ZAMO), |v|
     * < 1; components as for a direction given at position. Default 0.
     * @default [0, 0, 0]
     */
    velocity: Vector;
    /**
     * For FRUSTUM: the borders of the picture on the plane at distance 1 ahead, to the right and up, within +-1e9; left
     * less than right, down less than up. Default -1, 1, -1, 1. Other projections ignore them.
     * @range -1e9 .. 1e9
     * @default -1
     */
    tan_left: number;
    /**
     * The right border.
     * @default 1
     */
    tan_right: number;
    /**
     * The lower border.
     * @default -1
     */
    tan_down: number;
    /**
     * The upper border.
     * @default 1
     */
    tan_up: number;
    /**
     * Pixels that the whole picture moves to the right and down, each within +-1, for temporal antialiasing. For
     * PERSPECTIVE and FRUSTUM; other projections ignore it. Default 0.
     * @range -1 .. 1 pixel
     * @default [0, 0]
     */
    jitter: readonly [number, number];
    /**
     * For EQUIRECT with an eye: the distance of the two eyes, scene lengths, at least 0. Default 0.
     * @unit scene length
     * @default 0
     */
    eye_distance: number;
    /**
     * One of Eye. With LEFT or RIGHT and an eye_distance above 0 an EQUIRECT picture is one of two for 360-degree
     * stereo (omnidirectional stereo, ODS), and takes longer. Bloom of a preset is then left out; other bloom, and all
     * else of a film that regions cannot have, are INVALID_STATE; windows, bhr_project_point, outputs other than LIGHT,
     * occluders and targets on the GPU are UNSUPPORTED. Other projections ignore it. Default MIDDLE. docs/cameras.md.
     * @default "middle"
     */
    eye: Eye;
    /**
     * One of Chart: that of position, forward, up and velocity, of the time of bhr_set_time, and of the rays, paths and
     * points that this context is asked for. RAIN is needed at and inside a spinning hole's horizon; a fall that is to
     * go there must be told in it from the start. Default STATIC.
     * @default "static"
     */
    chart: Chart;
    /**
     * One of Transport. Default TRIAD.
     * @default "triad"
     */
    transport: Transport;
}

/**
 * A geometrically thin disk in the equatorial plane, on circular geodesics, with the Page-Thorne flux. Radii in units
 * of M. docs/matter.md has the model.
 */
export interface Disk {
    /**
     * Any of "retrograde" | "plunges". Default 0.
     * @default []
     */
    flags: readonly DiskFlag[];
    /**
     * In M, 0 .. 1e6. The disk begins here, but not inside the ISCO, or with "plunges" not inside the horizon. Default
     * 0: at the ISCO, or at the horizon.
     * @range 0 .. 1e6 M
     * @default 0
     */
    inner_radius: number;
    /**
     * In M, 0 .. 1e6, greater than inner_radius. Default 17.
     * @range 0 .. 1e6 M
     * @default 17
     */
    outer_radius: number;
    /**
     * Kelvin at the ring that `reference` says, 500 .. 1e9. Default 3500.
     * @range 500 .. 1e9 K
     * @default 3500
     */
    temperature: number;
    /**
     * 0 .. 1. Default 1.
     * @range 0 .. 1
     * @default 1
     */
    opacity: number;
    /**
     * 0 .. 1e6: the luminance of that ring at rest. Default 0.6.
     * @range 0 .. 1e6
     * @default 0.6
     */
    brightness: number;
    /**
     * Contrast of the structure that orbits with the matter, 0 .. 1; 0 is smooth. Default 1. Its mean is the smooth
     * disk's light. bhr_set_time carries it along, forwards and backwards, at any time to 1e9 M and more.
     * @range 0 .. 1
     * @default 1
     */
    turbulence: number;
    /**
     * Selects the turbulence: the same seed always gives the same pattern. Any number. Default 0.
     * @default 0
     */
    seed: number | bigint;
    /**
     * One of DiskReference. Default AT_MEDIAN; AT_HOTTEST in structs of 0.1.0's size.
     * @default "at_median"
     */
    reference: DiskReference;
    /**
     * "isotropic" (default), "limb_darkened".
     * @default "isotropic"
     */
    emission_law: EmissionLaw;
    /**
     * 0 .. 1, default 0.4, 0 is sharp: opacity and light fade to nothing over this share of the way from the inner edge
     * to the outer one, at its end, and near the ISCO. A disk that inner_radius cuts off outside the hottest ring is
     * sharp there.
     * @range 0 .. 1
     * @default 0.4
     */
    edge_softness: number;
}

/**
 * Matter with depth, which shines and absorbs by the equation of transfer; nothing is scattered. Radii are in units of
 * M, other lengths those that the matter itself measures. Thermal matter absorbs alike at all frequencies, and without
 * absorption does not shine. A power law emits j = n (nu / nu_camera)^-spectral_index per M, and its absorption per M
 * is absorption n (nu / nu_camera)^-(2.5 + spectral_index), nu being the frequency that the matter measures: a picture
 * shows its light at the one frequency nu_camera, in the colour tint. No matter is inside the horizon. Fields that
 * shape and flow do not use are checked all the same. docs/matter.md.
 */
export interface Volume {
    /**
     * Any of "retrograde" | "power_law". Default 0.
     * @default []
     */
    flags: readonly VolumeFlag[];
    /**
     * "disk" (default), TORUS, HALO, JET.
     * @default "disk"
     */
    shape: VolumeShape;
    /**
     * "keplerian" (default), ANGULAR_MOMENTUM, OUTFLOW.
     * @default "keplerian"
     */
    flow: Flow;
    /**
     * In M, 1e-6 .. 1e4, or 0 (default): the ISCO of matter that moves as flags say. DISK, JET: the inner edge;
     * OUTFLOW: the place where matter is at rest.
     * @range 1e-6 .. 10000 M
     * @default 0
     */
    inner_radius: number;
    /**
     * In M, 0 .. 1e4, greater than inner_radius. There is nothing beyond it, whatever the shape, and nothing at all of
     * a DISK or JET whose outer_radius is less than 0.9 times its inner edge, be that the ISCO. Default 17.
     * @range 0 .. 10000 M
     * @default 17
     */
    outer_radius: number;
    /**
     * In M, 0.1 .. 1e4. TORUS: the ring's; HALO: the scale; JET: where psi = opening. Default 8.
     * @range 0.1 .. 10000 M
     * @default 8
     */
    radius: number;
    /**
     * In M, 1e-3 .. 1e4, of a TORUS at least radius / 100: its Gaussian width in R. Default 2.
     * @range 0.001 .. 10000 M
     * @default 2
     */
    width: number;
    /**
     * 0.01 .. 1e6: the Gaussian width in c; TORUS: in z, over radius. Default 0.05, a soft disk; 0.14 is thick.
     * @range 0.01 .. 1e6
     * @default 0.05
     */
    thickness: number;
    /**
     * JET: the wall's angle from the axis at `radius`, radians, 0.01 .. 1.5. Default 0.3.
     * @range 0.01 .. 1.5 rad
     * @default 0.3
     */
    opening: number;
    /**
     * DISK, JET: 0 .. 4. Default 0.7.
     * @range 0 .. 4
     * @default 0.7
     */
    slope: number;
    /**
     * Per M at density 1, 0 .. 1e6. Default 3; less than 0.5 is mist, more than 5 a surface.
     * @range 0 .. 1e6 1/M
     * @default 3
     */
    absorption: number;
    /**
     * Kelvin, 500 .. 1e9, at inner_radius (DISK, JET) or at radius (TORUS, HALO). Default 4800.
     * @range 500 .. 1e9 K
     * @default 4800
     */
    temperature: number;
    /**
     * 0 .. 2: the temperature goes as r^-temperature_slope. Default 0.35; 0.75 is like a thin disk.
     * @range 0 .. 2
     * @default 0.35
     */
    temperature_slope: number;
    /**
     * POWER_LAW: -4 .. 4. Default 1.
     * @range -4 .. 4
     * @default 1
     */
    spectral_index: number;
    /**
     * POWER_LAW: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1.
     * @range 0 .. 1
     * @default [1, 1, 1]
     */
    tint: Vector;
    /**
     * A factor on the light, 0 .. 1e6, which changes neither its colour nor what is absorbed. At 1 the light is as
     * bright as white without exposure and tone map: of thermal matter of `temperature` at rest that is so thick that
     * nothing shines through; of a power law, of 1 M of density 1 at rest which absorbs nothing. Default 1.
     * @range 0 .. 1e6
     * @default 1
     */
    brightness: number;
    /**
     * KEPLERIAN: the share of the orbit's angular momentum, 0 .. 1. Default 1.
     * @range 0 .. 1
     * @default 1
     */
    sub_keplerian: number;
    /**
     * KEPLERIAN: a share without a unit, 0 .. 1: 0 (default) is orbits, 1 free fall from rest at infinity.
     * @range 0 .. 1
     * @default 0
     */
    infall: number;
    /**
     * ANGULAR_MOMENTUM: 0 .. 1. Default 1.
     * @range 0 .. 1
     * @default 1
     */
    angular_momentum: number;
    /**
     * OUTFLOW: the velocity far away in units of c, 0 .. 0.995. Default 0.9.
     * @range 0 .. 0.995 c
     * @default 0.9
     */
    speed: number;
    /**
     * 0 .. 1: the contrast of structure that the matter carries along: a pattern P = e^(turbulence G) over its mean, G
     * being noise of mean 0 and about variance 1. Default 1; 0 is even matter, as is that of a host whose BhrVolume
     * ends before this field.
     * @range 0 .. 1
     * @default 1
     */
    turbulence: number;
    /**
     * 0.5 .. 3: the density is multiplied by P^clumping over its mean; more makes filaments. Default 1.8.
     * @range 0.5 .. 3
     * @default 1.8
     */
    clumping: number;
    /**
     * 0 .. 0.5: the temperature is multiplied by P^heating, so that dense matter is hotter. Default 0.15.
     * @range 0 .. 0.5
     * @default 0.15
     */
    heating: number;
    /**
     * Selects the structure: the same seed always gives the same one. Any number. Default 0.
     * @default 0
     */
    seed: number | bigint;
}

/**
 * A glowing blob, by default on a circular geodesic in the equatorial plane: n = e^(-(d / size)^2 / 2), cut off at 7
 * sizes, d being the distance from its centre in chart coordinates. It is rigid: all of it turns as its centre does, at
 * dph/dt = 1 / (radius^(3/2) + a), with RETROGRADE -1 / (radius^(3/2) - a), per M; parts that would be faster than
 * light, beside the hole, are left out. It shines and absorbs as BhrVolume says, and its delay matters
 * (docs/matter.md). With "free" the centre moves on any geodesic, for some six hundred turns about the hole before and
 * after `time` and out to 1e4 M, and distances are those of Doran's chart.
 */
export interface HotSpot {
    /**
     * Any of "retrograde" | "thermal" | "free" | "rain". Default 0.
     * @default []
     */
    flags: readonly HotSpotFlag[];
    /**
     * In M, 1 .. 1000. Inside the ISCO no orbit is stable: there the spot is taken to be at the ISCO. Default 8.
     * @range 1 .. 1000 M
     * @default 8
     */
    radius: number;
    /**
     * In M, 0.05 .. radius / 4, and at least radius / 200; FREE: from 0.05 to 250. Default 0.8.
     * @unit M
     * @default 0.8
     */
    size: number;
    /**
     * The centre at scene time 0, radians within +-1e6. Default 0.
     * @range -1e6 .. 1e6 rad
     * @default 0
     */
    azimuth: number;
    /**
     * Per M at the centre, 0 .. 1e6. Default 0.
     * @range 0 .. 1e6 1/M
     * @default 0
     */
    absorption: number;
    /**
     * Kelvin, 500 .. 1e9. Default 10000.
     * @range 500 .. 1e9 K
     * @default 10000
     */
    temperature: number;
    /**
     * Without THERMAL: -4 .. 4. Default 1.
     * @range -4 .. 4
     * @default 1
     */
    spectral_index: number;
    /**
     * Without THERMAL: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1.
     * @range 0 .. 1
     * @default [1, 1, 1]
     */
    tint: Vector;
    /**
     * 0 .. 1e6, as BhrVolume.brightness. Default 1.
     * @range 0 .. 1e6
     * @default 1
     */
    brightness: number;
    /**
     * FREE: where the centre is at `time`, scene axes and lengths, as BhrBody has it. Default 0, 0, 0, which FREE
     * refuses.
     * @default [0, 0, 0]
     */
    position: Vector;
    /**
     * FREE: its velocity there in units of c, |v| < 1, scene axes, as BhrBody has it. Default 0, 0, 0.
     * @unit c
     * @default [0, 0, 0]
     */
    velocity: Vector;
    /**
     * FREE: scene time, in scene lengths, that position and velocity are of; RAIN: rain time. Default 0.
     * @unit scene length
     * @default 0
     */
    time: number;
}

/** The sky: everything that lies at infinity. */
export interface Sky {
    /**
     * SkyFlag bits; 0: black. Default STARS | MILKY_WAY.
     * @default ["stars", "milky_way"]
     */
    flags: readonly SkyFlag[];
    /**
     * A factor on the light of the stars, 0 .. 1e6. Default 1.
     * @range 0 .. 1e6
     * @default 1
     */
    stars_brightness: number;
    /**
     * A factor on the light of the Milky Way and the map, 0 .. 1e6. Default 1.
     * @range 0 .. 1e6
     * @default 1
     */
    map_brightness: number;
    /**
     * Unit quaternion x y z w that takes sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole) to
     * scene axes. Default (0, 0, 0, 1).
     * @default [0, 0, 0, 1]
     */
    orientation: readonly [number, number, number, number];
    /**
     * Selects the stars of "procedural": any number. Default 0.
     * @default 0
     */
    seed: number | bigint;
}

/**
 * How light becomes pixels, in formats of 8 and 10 bits and windows of "light" only: float formats hold linear
 * radiance, and other views show values. In this order: exposure, bloom, beam, flare, spikes and streak, auto exposure,
 * highlights and shadows, vignette, white balance, contrast, saturation, grain, tone map, the sRGB curve and the LUT,
 * or the colour map, dithering.
 */
export interface Film {
    /**
     * One of ToneMap. Default ACES.
     * @default "aces"
     */
    tone_map: ToneMap;
    /**
     * Stops, -20 .. 20. Default 0.
     * @range -20 .. 20 EV
     * @default 0
     */
    exposure_ev: number;
    /**
     * Glare, 0 .. 1, 0 off, default 0.25: optics scatter 0.4 bloom of each pixel's light over its surroundings, alike
     * at every resolution. No light is lost, and transparent images keep their alpha. With a region set, 8- and 10-bit
     * images of light are INVALID_STATE when they are rendered; but where no bhr_set_film came after the context was
     * made, or after the last bhr_set_preset, they are rendered without glare. docs/colour-and-film.md.
     * @range 0 .. 1
     * @default 0.25
     */
    bloom: number;
    /**
     * The full width at half maximum of a Gaussian that the picture is spread by, as by a telescope's beam; in frame
     * heights, 0 .. 1, 0 off (default). Alpha is left alone. With a region set, 8- and 10-bit images of light are
     * INVALID_STATE when they are rendered, also when a preset set the beam. docs/colour-and-film.md.
     * @range 0 .. 1 frame height
     * @default 0
     */
    beam_fwhm: number;
    /**
     * One of ColourMap. Default NONE.
     * @default "none"
     */
    colour_map: ColourMap;
    /**
     * Blades of the lens's aperture, 3 .. 8: an even number of them makes as many spikes, an odd one twice as many. 0,
     * the default, stands for 6.
     * @range 3 .. 8
     * @default 0
     */
    spike_blades: number;
    /**
     * Kelvin, 1667 .. 25000, of the blackbody whose light is to look white: the lower, the bluer the picture. Default
     * 0: colours stay as they are.
     * @range 1667 .. 25000 K
     * @default 0
     */
    white_balance: number;
    /**
     * -1 .. 1: the picture turns towards magenta above 0, towards green below. Default 0. The light that is to look
     * white has a Duv of 0.02 tint (CIE 1960): above 0 it is greener than a blackbody's.
     * @range -1 .. 1
     * @default 0
     */
    tint: number;
    /**
     * 0.25 .. 4, the exponent of light; light of 0.18, middle grey, stays as it is. Default 1.
     * @range 0.25 .. 4
     * @default 1
     */
    contrast: number;
    /**
     * 0 .. 4, a factor on how far colours are from the grey of their luminance; 0 is grey. Default 1.
     * @range 0 .. 4
     * @default 1
     */
    saturation: number;
    /**
     * FILMIC, 0 .. 1: at 0 dark light stays linear, at 1 all of the toe, the curve's dark end, is black. Default 0.5.
     * @range 0 .. 1
     * @default 0.5
     */
    toe_strength: number;
    /**
     * FILMIC: 0 .. 1; the toe ends at light toe_length^2.2 / 2. Default 0.5.
     * @range 0 .. 1
     * @default 0.5
     */
    toe_length: number;
    /**
     * FILMIC: stops, 0 .. 16; light from about 2^shoulder_strength on is white. Default 2.
     * @range 0 .. 16 EV
     * @default 2
     */
    shoulder_strength: number;
    /**
     * FILMIC, 0 .. 1: the share that the shoulder, the curve's bright end, has of all that is above the toe. Default
     * 0.5.
     * @range 0 .. 1
     * @default 0.5
     */
    shoulder_length: number;
    /**
     * FILMIC: how steep the shoulder still is at white, 0 .. 1; at 0 it ends flat. Default 1.
     * @range 0 .. 1
     * @default 1
     */
    shoulder_angle: number;
    /**
     * 0 .. 1, the share of a lens' natural darkening, cos^4 of an angle whose tangent is 1 in the corners of the whole
     * frame: at 1, light is a quarter there. Default 0.
     * @range 0 .. 1
     * @default 0
     */
    vignette: number;
    /**
     * Auto exposure, 0 .. 1: how far the exposure goes to where auto_percentile is auto_target. Default 0: off. The
     * frame's luminance is measured after exposure_ev and bloom, in small cells; cells darker than 2^-16 do not count.
     * exposure_ev is taken back by it: auto_target is what makes the picture brighter. bhr_frame_stats has what was
     * added. With a region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered.
     * @range 0 .. 1
     * @default 0
     */
    auto_exposure: number;
    /**
     * The percentile of the frame's luminance that auto exposure goes by, 0 .. 100. Default 90.
     * @range 0 .. 100
     * @default 90
     */
    auto_percentile: number;
    /**
     * The luminance that auto exposure brings the percentile to, 0.001 .. 1000; middle grey is 0.18. Default 0.5.
     * @range 0.001 .. 1000
     * @default 0.5
     */
    auto_target: number;
    /**
     * The least that auto exposure adds, stops, -20 .. 20. Default -8.
     * @range -20 .. 20 EV
     * @default -8
     */
    auto_least_ev: number;
    /**
     * The most that auto exposure adds, stops, -20 .. 20. Default 8. If it is below auto_least_ev, this is what is
     * added.
     * @range -20 .. 20 EV
     * @default 8
     */
    auto_most_ev: number;
    /**
     * 0.000001 .. 1: the share of the way that a frame goes from the exposure of the last frame of its size that this
     * context measured. Default 1: all of it, so that a picture depends on its scene alone. For frames t apart and a
     * time constant T it is 1 - exp(-t / T).
     * @range 1e-6 .. 1
     * @default 1
     */
    auto_adaptation: number;
    /**
     * Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, bright parts of the picture come;
     * their structure stays. Default 0: off. With a region set, 8- and 10-bit images of light are INVALID_STATE when
     * they are rendered.
     * @range 0 .. 1
     * @default 0
     */
    highlights: number;
    /**
     * Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, dark parts of the picture come.
     * Default 0: off. Black stays black, but glare over it is lifted like other light: use less bloom with it. With a
     * region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered.
     * @range 0 .. 1
     * @default 0
     */
    shadows: number;
    /**
     * Grain, 0 .. 1: light varies at random from place to place, with a standard deviation of 0.25 grain of itself.
     * Default 0: off. The mean light stays. Its cells are a 1080th of the frame's height wide, but no smaller than a
     * pixel.
     * @range 0 .. 1
     * @default 0
     */
    grain: number;
    /**
     * Any number within +-1e15: each is another grain, for instance that of a film's frame. Default 0.
     * @range -1e15 .. 1e15
     * @default 0
     */
    grain_seed: number;
    /**
     * 0 .. 1, the share of the colours that the LUT of bhr_set_film_lut has in the picture; 0 off. Default 1.
     * @range 0 .. 1
     * @default 1
     */
    lut_strength: number;
    /**
     * Diffraction spikes, 0 .. 1, 0 off (default): the lens throws 0.4 spikes of each pixel's light along lines that
     * lie across the edges of the aperture's blades; they are reddish. No light is lost. With a region set, 8- and
     * 10-bit images of light are INVALID_STATE when they are rendered. docs/colour-and-film.md.
     * @range 0 .. 1
     * @default 0
     */
    spikes: number;
    /**
     * The direction of one spike, radians anticlockwise from upright, -2 pi .. 2 pi. Default 0.
     * @unit rad
     * @default 0
     */
    spike_angle: number;
    /**
     * In frame heights, 0.01 .. 2: the length of the spikes' faint tails, which fall off by exp(-distance /
     * spike_length). Default 0.25.
     * @range 0.01 .. 2 frame height
     * @default 0.25
     */
    spike_length: number;
    /**
     * The horizontal streak of an anamorphic lens, 0 .. 1, 0 off (default): 0.4 streak of each pixel's light is thrown
     * to its left and right. No light is lost. With a region set, 8- and 10-bit images of light are INVALID_STATE when
     * they are rendered. docs/colour-and-film.md.
     * @range 0 .. 1
     * @default 0
     */
    streak: number;
    /**
     * In frame heights, 0.01 .. 4: the length of the streak's tails, which fall off by exp(-distance / streak_length).
     * Default 0.5.
     * @range 0.01 .. 4 frame height
     * @default 0.5
     */
    streak_length: number;
    /**
     * The streak's colour, -1 .. 1: -1 is amber, 0 that of the light, 1 blue. Default 0.
     * @range -1 .. 1
     * @default 0
     */
    streak_tint: number;
    /**
     * BHR_FORMAT_RGB10A2_*: what the display shows for light of 1, diffuse white; cd/m^2, 10 .. 1000. Default 203, as
     * in ITU-R BT.2408.
     * @range 10 .. 1000
     * @default 203
     */
    paper_white: number;
    /**
     * BHR_FORMAT_RGB10A2_*: the brightest that the display shows, cd/m^2, 100 .. 10000, to which brighter light is
     * rolled off. Default 1000.
     * @range 100 .. 10000
     * @default 1000
     */
    peak: number;
    /**
     * Lens flare, 0 .. 1, 0 off (default): the lens reflects 0.15 flare of each pixel's light into ghosts, blurred
     * images of its aperture (spike_blades, spike_angle) in several colours, on the line from that pixel through the
     * middle of the frame. Ghosts of lights near the border are faint: that light is lost, no other. With a region set,
     * 8- and 10-bit images of light are INVALID_STATE when they are rendered. docs/colour-and-film.md.
     * @range 0 .. 1
     * @default 0
     */
    flare: number;
    /**
     * How many ghosts each light has, 0 .. 8; 0, the default, stands for 5.
     * @range 0 .. 8
     * @default 0
     */
    flare_ghosts: number;
}

/** How exactly to trace. */
export interface Quality {
    /**
     * One of Method. Default AUTO.
     * @default "auto"
     */
    method: Method;
    /**
     * Samples of each pixel, 1 .. 256. Default 1. More than one are weighted by a B-spline 3 pixels wide; in a CUBE
     * they lie evenly in the pixel; while a shutter is open they are moments, all through the pixel's middle. Views
     * other than "light" take one. Pixels that an edge runs through get more rays in any case.
     * @range 1 .. 256 pixel
     * @default 1
     */
    samples_per_pixel: number;
    /**
     * Steps of an integrated ray, 16 .. 100000. Default 2000. A ray that needs more is "unresolved".
     * @range 16 .. 100000
     * @default 2000
     */
    max_steps: number;
    /**
     * RK4: the step, 1e-3 .. 0.5, in Mino time scaled to the ray (docs/numerics.md); 0 means the default, 0.1.
     * @range 0.001 .. 0.5
     * @default 0
     */
    step: number;
    /**
     * ADAPTIVE: the relative tolerance, 1e-14 .. 1e-3; 0: the default, 1e-10. Single-precision tracers use their own.
     * @range 1e-14 .. 0.001
     * @default 0
     */
    tolerance: number;
    /**
     * Images of the disk to follow, 0 .. 15; 0: the direct one only. Default 3.
     * @range 0 .. 15
     * @default 3
     */
    max_disk_order: number;
    /**
     * Windows: traced size / window size, 0.1 .. 1. Default 1.
     * @range 0.1 .. 1
     * @default 1
     */
    render_scale: number;
    /**
     * One of VolumeResolution. Default FULL. No effect without volumes and hot spots.
     * @default "full"
     */
    volume_resolution: VolumeResolution;
}

/**
 * The part of a larger frame that an image holds: for tiles, dome walls and render farms. Tiles that are joined have
 * the same bytes as the frame, unless its film needs the light of the whole frame (see bhr_set_region).
 */
export interface Region {
    /**
     * Pixels of the whole frame, 1 .. 2^20.
     * @range 1 .. 1.048576e6 pixel
     */
    full_width: number;
    /**
     * Pixels of the whole frame, 1 .. 2^20.
     * @range 1 .. 1.048576e6 pixel
     */
    full_height: number;
    /**
     * Column of the image's left pixels in the frame, < full_width.
     * @unit pixel
     */
    x: number;
    /**
     * Row of the image's top pixels in the frame, < full_height.
     * @unit pixel
     */
    y: number;
}

/** Numbers about the hole and the camera's observer. Lengths are in scene units; what is not defined is NaN. */
export interface HoleInfo {
    /** r+ = M + sqrt(M^2 - a^2). */
    horizon_radius: number;
    /** 2 M, at every spin. */
    ergosphere_equatorial_radius: number;
    /** Equatorial circular photon orbit towards +ph. */
    photon_orbit_prograde: number;
    /** Equatorial circular photon orbit towards -ph. */
    photon_orbit_retrograde: number;
    /** Innermost stable circular orbit of matter towards +ph. */
    isco_prograde: number;
    /** Innermost stable circular orbit of matter towards -ph. */
    isco_retrograde: number;
    /** Spin 0: 3 sqrt(3) M; NaN with spin. */
    critical_impact_parameter: number;
    /**
     * Spin 0: angular radius of the shadow as the camera's observer sees it, radians; NaN with spin.
     * @unit rad
     */
    shadow_angular_radius: number;
    /** Boyer-Lindquist r of the camera. */
    camera_radius: number;
    /** d tau / d t, the rate of the clock of the camera's observer; t is the time of BhrCamera.chart. */
    camera_time_rate: number;
    /** r- = M - sqrt(M^2 - a^2), down to which the inside of a spinning hole is known; 0 without spin. */
    inner_horizon_radius: number;
}

/** A ray, followed backward in time from an observer. It does not grow within one BHR_ABI_VERSION. */
export interface Ray {
    /** Scene axes and lengths. */
    position: Vector;
    /**
     * The direction in which the observer looks, opposite to the photon's momentum; any non-zero length. Components are
     * along the frame that Directions, above, gives, in the chart of the context's camera.
     */
    direction: Vector;
    /**
     * nu(camera) / nu(observer of the local frame), > 0; 1 for an observer at rest in it. Multiplies the hit's
     * redshifts.
     */
    frequency_ratio: number;
}

/** A crossing of the equatorial plane outside the horizon. Within one BHR_ABI_VERSION it does not grow. */
export interface Crossing {
    /**
     * Boyer-Lindquist r, scene lengths.
     * @unit scene length
     */
    radius: number;
    /** Boyer-Lindquist ph in the chart, (-pi, pi], of rays in chart RAIN too. */
    azimuth: number;
    /**
     * g = nu(camera) / nu(emitter on the disk's circular orbit); inside the ISCO that of falling matter with "plunges",
     * else NaN.
     */
    redshift: number;
    /**
     * Coordinate time since the photon left, scene lengths; NaN from inside the horizon. In chart RAIN: rain time T at
     * the ray's begin less the coordinate time t at which the photon left.
     * @unit scene length
     */
    delay: number;
}
