// SPDX-License-Identifier: MIT OR Apache-2.0
// words.d.ts -- the words of a scene's choices and flags, under the names of scenes as text (docs/scenes.md).
// Made by tests/header/typescript.rs from include/bhr.json; do not edit.

/**
 * The interface to an adapter. AUTO takes the best GPU that Vulkan, Metal or, with DXC, Direct3D 12 reaches; else one
 * that only OpenGL reaches, or Direct3D 12 with FXC; else a software driver for Vulkan (Mesa's lavapipe) or Direct3D
 * 12; else the CPU tracer. It never takes software OpenGL.
 */
export type Backend =
    /** The best one there is, in the order above. */
    | "auto"
    /** The built-in double-precision CPU tracer: needs no driver. */
    | "cpu"
    /** Vulkan. */
    | "vulkan"
    /** Metal. */
    | "metal"
    /** Direct3D 12, never tried on Windows itself; its compiler: docs/platforms.md. */
    | "d3d12"
    /** OpenGL or OpenGL ES, by EGL or WGL. */
    | "gl";

/**
 * How azimuths and times are told, and the triad that directions and velocities are told along. Radii and polar angles
 * are Boyer and Lindquist's in both. RAIN is regular at both horizons for all that falls in, and needed at and inside a
 * spinning hole's. Without spin azimuths do not differ, and the triad at and inside the horizon is that of RAIN.
 * docs/cameras.md.
 */
export type Chart =
    /** Boyer and Lindquist's ph and t, and the triad of the static observer (ZAMO). */
    | "static"
    /** Doran's, and the triad of the rain observer, who falls from rest at infinity. */
    | "rain";

/** The colours of a picture. */
export type ColourMap =
    /** The picture has the colours of the light. */
    | "none"
    /**
     * The map afmhot, in which the Event Horizon Telescope publishes its images, of the luminance after the tone map:
     * red 2 s, green 2 s - 1/2, blue 2 s - 1, each within 0 .. 1, in sRGB code values.
     */
    | "afmhot";

/** Bits of BhrDisk.flags. */
export type DiskFlag =
    /** The matter orbits towards -ph. */
    | "retrograde"
    /** Matter shines on its way from the ISCO to the horizon, too, where it falls freely. */
    | "plunges";

/** The ring at whose radius a disk has the stated temperature and brightness. */
export type DiskReference =
    /** The hottest ring of the profile: at spin 0 r = 9.55 M, at spin 0.998 r = 1.58 M. */
    | "at_hottest"
    /**
     * The ring that halves the disk's area, r^2 = (inner^2 + outer^2) / 2, but for the outermost quarter of a soft
     * outer edge's fading: the disk as a whole keeps its look when spin or edges change.
     */
    | "at_median";

/** Bits of bhr_set_effects.effects. */
export type Effect =
    /** The frequency shift by motion colours the light. */
    | "doppler_shift"
    /** The gravitational redshift colours the light. */
    | "gravity_shift"
    /** The intensity follows g^3 (I_nu), g^4 (bolometric). */
    | "beaming"
    /** Moving matter is seen at its retarded time. */
    | "light_delay"
    /** All effects, as a new context has them. */
    | "all";

/** How the disk's light depends on the angle to its normal, in the frame of its matter. The flux is the same. */
export type EmissionLaw =
    /** The disk's surface shines alike in all directions. */
    | "isotropic"
    /** Like an atmosphere of free electrons: 1.269 times as bright along the normal, 0.414 times at grazing angles. */
    | "limb_darkened";

/** The eye for which an EQUIRECT picture is made. */
export type Eye =
    /** The camera's own place: no stereo picture. */
    | "middle"
    /** The left eye. */
    | "left"
    /** The right eye. */
    | "right";

/** The motion of a volume's matter. Every flow is slower than light everywhere; docs/matter.md has the laws. */
export type Flow =
    /** On circles, inside the ISCO plunging with the energy and the angular momentum of the orbit there. */
    | "keplerian"
    /** -u_ph / u_t = angular_momentum R^(3/2) / (1 + R), without radial motion: the flow of Gold et al. 2020. */
    | "angular_momentum"
    /**
     * Away from the hole, the faster the farther, as the matter of a jet: at rest at r = inner_radius, at speed far
     * away, falling in nearer to the hole.
     */
    | "outflow";

/** Bits of BhrHotSpot.flags. */
export type HotSpotFlag =
    /** The spot moves towards -ph. */
    | "retrograde"
    /** The light is a blackbody's, not a power law's; without absorption there is none. */
    | "thermal"
    /**
     * The centre is a body in free fall, which position, velocity and time tell; radius, azimuth and RETROGRADE have no
     * meaning.
     */
    | "free"
    /** With FREE, these are told in "rain" instead of "static". */
    | "rain";

/**
 * The way in which light is followed. Frames by different methods differ by less than their errors, which
 * docs/quality.md states: 2e-6 to 2e-5 of look directions and radii on GPUs, which work in single precision, 1e-8 by
 * the CPU tracer's ADAPTIVE.
 */
export type Method =
    /** The fastest: rays are looked up in tables where that pays, else integrated. */
    | "auto"
    /** Every ray integrated by fixed-step fourth-order Runge-Kutta. */
    | "rk4"
    /** Every ray integrated by embedded Runge-Kutta with error control. */
    | "adaptive";

/**
 * How the camera's observer moves. A motion that is not possible at the camera's place is INVALID_STATE when a frame or
 * rays are asked for.
 */
export type Motion =
    /** At rest, outside the horizon; with spin, the zero angular momentum observer (ZAMO). */
    | "static"
    /** Falls from rest at infinity with E = 1 and L = Q = 0, inside the horizon too (with spin in chart RAIN). */
    | "free_fall"
    /**
     * On a circle towards +ph: without spin at any latitude, with r > 3 M and beta = 1 / sqrt(r / M - 2); with spin on
     * the circular geodesic, in the equatorial plane only (to within 1e-12 of the radius).
     */
    | "orbit"
    /** Moves with BhrCamera.velocity. */
    | "velocity";

/**
 * A named look: values for all of BhrDisk, all of BhrFilm, the effects, and flags and brightness of BhrSky, which
 * setters can then change. Hole, camera, hot spots, time, shutter, view, quality, region, and the sky's orientation,
 * seed and map stay as they are: a host that shows its own map sets "map" again. docs/presets.md has the tables of the
 * values.
 */
export type Preset =
    /** The default: a golden disk with structure and soft edges, its approaching side nearly white, and glare. */
    | "cinematic"
    /** A smooth disk, no glare, no tone curve; light is shown as it is, two stops down, until it clips. */
    | "physical"
    /** The look of the Event Horizon Telescope's sources: a ring blurred by a beam, in one colour map, on black. */
    | "observatory"
    /** For lessons: a grid on the sky, and a smooth disk in the colours of its shifts, without beaming and delay. */
    | "teaching";

/** The matter that bhr_set_preset_with shows. */
export type PresetMatter =
    /** DEEP where the adapter is fast enough for it, else THIN. */
    | "auto"
    /** The thin disk, as bhr_set_preset. */
    | "thin"
    /** One volume in place of the disk; TEACHING has no such look and stays THIN. */
    | "deep";

/** The lens. Camera axes: right = forward x up, then up = right x forward. */
export type Projection =
    /** A flat picture; fov_y in (0, pi). */
    | "perspective"
    /**
     * Dome master, equidistant: the angle from forward grows evenly with the distance from the frame's centre, to fov_y
     * / 2 (fov_y to 2 pi) at the circle inscribed in the frame.
     */
    | "fisheye"
    /**
     * All-round picture, 360 x 180 degrees in even steps: longitude from forward (middle) to the right, latitude
     * towards up (top); fov_y is ignored.
     */
    | "equirect"
    /** Six faces of a cube side by side: right, left, up, down, front, back. */
    | "cube"
    /**
     * A flat picture between four tangents, as the frustum of a projection matrix: tan_left, tan_right, tan_down,
     * tan_up.
     */
    | "frustum";

/** Bits of BhrSky.flags. */
export type SkyFlag =
    /** The real sky, from the embedded star catalogue. */
    | "stars"
    /**
     * A random field of a million stars to V = 11, with the real sky's numbers and colours, the same on every machine
     * for the same seed.
     */
    | "procedural"
    /**
     * The glow of the Milky Way, true to about a degree, and next to the stars eight times as bright as the eye sees
     * it.
     */
    | "milky_way"
    /** The map that bhr_set_sky_map was given; nothing without one. */
    | "map"
    /**
     * A grid in sky axes, which shows the lensing: right ascension every hour, declination every 15 degrees, lines 1.3
     * pixels wide.
     */
    | "grid";

/** The curve from light to pixels. */
export type ToneMap =
    /** No curve: light above 1 is clipped. */
    | "none"
    /** A filmic curve, the fit of ACES 1.0 by Stephen Hill; middle grey, 0.18, becomes 127 of 255. */
    | "aces"
    /**
     * AgX, base look; middle grey becomes 128 of 255, and bright saturated light shifts its hue less than under ACES.
     */
    | "agx"
    /** A filmic curve with settings, John Hable's of three powers: `toe_strength` to `shoulder_angle`. */
    | "filmic";

/** How bhr_camera_advance carries a camera's axes along. */
export type Transport =
    /** Forward and up keep their angles to e_r, e_th and e_ph. */
    | "triad"
    /** Forward and up stay parallel to themselves along the world line, as the axes of gyroscopes do. */
    | "parallel";

/**
 * The quantity that pixels show. 8-bit formats and windows show it in false colour, without film; R32F holds its value,
 * NaN where there is none. RGBA16F and RGBA32F hold LIGHT only, R32F every view but LIGHT: else rendering is
 * INVALID_ARGUMENT. A backend may lack a view: then rendering is UNSUPPORTED. docs/views.md has the colours.
 */
export type View =
    /** The picture. */
    | "light"
    /**
     * The redshift g of the first crossing within the disk's radii, else that of the sky; NaN where the ray is captured
     * without such a crossing.
     */
    | "redshift"
    /** The number of the image, 0, 1, 2 ..., of the first crossing within the disk's radii; -1 sky; -2 captured. */
    | "order"
    /** The angle between look direction and sky direction, radians; NaN where the ray is captured. */
    | "deflection"
    /** The integration steps of the pixel's ray; 0 where it was looked up ("auto"). */
    | "steps"
    /** -g_tt = 1 - 2 M / r at the first crossing of the equatorial plane; NaN without one. */
    | "metric"
    /** The optical depth of all volumes and hot spots, as in BhrTransfer; NaN unless the ray escapes. */
    | "optical_depth"
    /** The intensity of volumes and hot spots with a power law, as in BhrTransfer. */
    | "intensity";

/** Bits of BhrVolume.flags. */
export type VolumeFlag =
    /** The matter moves towards -ph. */
    | "retrograde"
    /** The light is a power law of the frequency, not a blackbody's. */
    | "power_law";

/** The rays along which volumes and hot spots are summed. */
export type VolumeResolution =
    /** The rays of all pixels. */
    | "full"
    /** One ray of each block of 2 x 2 pixels, and those of pixels that interpolation would get wrong. */
    | "half";

/**
 * The place of a volume's matter: its density n, with c = cos th, R = r sin th, z = r c, and lengths in M. n is 1 at
 * inner_radius (DISK), at radius (JET) or in the middle (TORUS, HALO), but for soft edges at inner_radius and
 * outer_radius (docs/matter.md).
 */
export type VolumeShape =
    /** About the equatorial plane: n = (r / inner_radius)^-slope e^(-(c / thickness)^2 / 2), with soft edges. */
    | "disk"
    /** A ring about the axis: n = e^(-((R - radius) / width)^2 / 2 - (z / (thickness radius))^2 / 2). */
    | "torus"
    /** About the hole: n = e^(-(r / radius)^2 / 2 - (c / thickness)^2 / 2), with thickness = 1e6 a sphere. */
    | "halo"
    /**
     * A hollow jet along the axis and one opposite: matter in the wall of a cone about the axis, n = (r /
     * radius)^-slope e^(-((|c| - cos psi) / thickness)^2 / 2), psi = opening sqrt(radius / r), at most pi / 2, with
     * soft edges.
     */
    | "jet";
