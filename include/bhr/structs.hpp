// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/structs.hpp -- the structs that programs fill in, with the defaults of bhr.h. Include bhr.hpp. Made by
 * tests/header/bindings.rs from include/bhr.json; do not edit. */
#ifndef BHR_STRUCTS_HPP
#define BHR_STRUCTS_HPP

#include "constants.hpp"
#include "layout.hpp"

#include <array>

namespace bhr {

/// Components along x, y and z.
using Vector = std::array<double, 3>;

/// BhrCamera: The camera: an observer with a lens. Its fields; Camera has the rest.
struct CameraFields {
    /// Sizeof(BhrCamera).
    std::uint32_t struct_size;
    /// BHR_PROJECTION_*.
    Projection projection;
    /// Default (0, 26, 2.5).
    Vector position;
    /// Any non-zero length.
    Vector forward;
    /// Any non-zero length, not parallel to forward.
    Vector up;
    /// Radians: full vertical angle, (0, pi), for PERSPECTIVE; across the circle, (0, 2 pi], for FISHEYE.
    double fov_y;
    /// BHR_MOTION_*.
    Motion motion;
    /// Reserved: 0.
    std::uint32_t reserved;
    /// For BHR_MOTION_VELOCITY: v / c against the observer of the chart's triad (by default the local static one, the
    /// ZAMO), |v| < 1; components as for a direction given at position.
    Vector velocity;
    /// For FRUSTUM: the borders of the picture on the plane at distance 1 ahead, to the right and up, within +-1e9;
    /// left less than right, down less than up.
    double tan_left;
    /// The right border.
    double tan_right;
    /// The lower border.
    double tan_down;
    /// The upper border.
    double tan_up;
    /// Pixels that the whole picture moves to the right and down, each within +-1, for temporal antialiasing.
    std::array<double, 2> jitter;
    /// For EQUIRECT with an eye: the distance of the two eyes, scene lengths, at least 0.
    double eye_distance;
    /// BHR_EYE_*.
    Eye eye;
    /// Reserved: 0.
    std::uint32_t reserved2;
    /// BHR_CHART_*: that of position, forward, up and velocity, of the time of bhr_set_time, and of the rays, paths and
    /// points that this context is asked for.
    Chart chart;
    /// BHR_TRANSPORT_*.
    Transport transport;
};

/// BhrDisk: A geometrically thin disk in the equatorial plane, on circular geodesics, with the Page-Thorne flux.
/// Defaults: bhr_disk_init.
struct Disk {
    /// Sizeof(BhrDisk).
    std::uint32_t struct_size;
    /// Any of BHR_DISK_RETROGRADE | BHR_DISK_PLUNGES.
    DiskFlags flags;
    /// In M, 0 .. 1e6.
    double inner_radius;
    /// In M, 0 .. 1e6, greater than inner_radius.
    double outer_radius;
    /// Kelvin at the ring that `reference` says, 500 .. 1e9.
    double temperature;
    /// 0 .. 1.
    double opacity;
    /// 0 .. 1e6: the luminance of that ring at rest.
    double brightness;
    /// Contrast of the structure that orbits with the matter, 0 .. 1; 0 is smooth.
    double turbulence;
    /// Selects the turbulence: the same seed always gives the same pattern.
    std::uint64_t seed;
    /// BHR_DISK_AT_*.
    DiskReference reference;
    /// BHR_DISK_ISOTROPIC (default), BHR_DISK_LIMB_DARKENED.
    EmissionLaw emission_law;
    /// 0 .. 1, default 0.4, 0 is sharp: opacity and light fade to nothing over this share of the way from the inner
    /// edge to the outer one, at its end, and near the ISCO.
    double edge_softness;

    Disk() noexcept { detail::defaults(*this, bhr_disk_init); }
    BhrDisk c() const noexcept { return detail::as_c<BhrDisk>(*this); }
};

/// BhrVolume: Matter with depth, which shines and absorbs by the equation of transfer; nothing is scattered. Defaults:
/// bhr_volume_init.
struct Volume {
    /// Sizeof(BhrVolume).
    std::uint32_t struct_size;
    /// Any of BHR_VOLUME_RETROGRADE | BHR_VOLUME_POWER_LAW.
    VolumeFlags flags;
    /// BHR_VOLUME_DISK (default), _TORUS, _HALO, _JET.
    VolumeShape shape;
    /// BHR_FLOW_KEPLERIAN (default), _ANGULAR_MOMENTUM, _OUTFLOW.
    Flow flow;
    /// In M, 1e-6 .. 1e4, or 0 (default): the ISCO of matter that moves as flags say.
    double inner_radius;
    /// In M, 0 .. 1e4, greater than inner_radius.
    double outer_radius;
    /// In M, 0.1 .. 1e4.
    double radius;
    /// In M, 1e-3 .. 1e4, of a TORUS at least radius / 100: its Gaussian width in R.
    double width;
    /// 0.01 .. 1e6: the Gaussian width in c; TORUS: in z, over radius.
    double thickness;
    /// JET: the wall's angle from the axis at `radius`, radians, 0.01 .. 1.5.
    double opening;
    /// DISK, JET: 0 .. 4.
    double slope;
    /// Per M at density 1, 0 .. 1e6.
    double absorption;
    /// Kelvin, 500 .. 1e9, at inner_radius (DISK, JET) or at radius (TORUS, HALO).
    double temperature;
    /// 0 .. 2: the temperature goes as r^-temperature_slope.
    double temperature_slope;
    /// POWER_LAW: -4 .. 4.
    double spectral_index;
    /// POWER_LAW: the colour of its light at every shift, linear Rec. 709, each 0 .. 1.
    Vector tint;
    /// A factor on the light, 0 .. 1e6, which changes neither its colour nor what is absorbed.
    double brightness;
    /// KEPLERIAN: the share of the orbit's angular momentum, 0 .. 1.
    double sub_keplerian;
    /// KEPLERIAN: a share without a unit, 0 .. 1: 0 (default) is orbits, 1 free fall from rest at infinity.
    double infall;
    /// ANGULAR_MOMENTUM: 0 .. 1.
    double angular_momentum;
    /// OUTFLOW: the velocity far away in units of c, 0 .. 0.995.
    double speed;
    /// 0 .. 1: the contrast of structure that the matter carries along: a pattern P = e^(turbulence G) over its mean, G
    /// being noise of mean 0 and about variance 1.
    double turbulence;
    /// 0.5 .. 3: the density is multiplied by P^clumping over its mean; more makes filaments.
    double clumping;
    /// 0 .. 0.5: the temperature is multiplied by P^heating, so that dense matter is hotter.
    double heating;
    /// Selects the structure: the same seed always gives the same one.
    std::uint64_t seed;

    Volume() noexcept { detail::defaults(*this, bhr_volume_init); }
    BhrVolume c() const noexcept { return detail::as_c<BhrVolume>(*this); }
};

/// BhrHotSpot: A glowing blob, by default on a circular geodesic in the equatorial plane: n = e^(-(d / size)^2 / 2),
/// cut off at 7 sizes, d being the distance from its centre in chart coordinates. Defaults: bhr_hot_spot_init.
struct HotSpot {
    /// Sizeof(BhrHotSpot).
    std::uint32_t struct_size;
    /// Any of BHR_HOT_SPOT_RETROGRADE | BHR_HOT_SPOT_THERMAL | BHR_HOT_SPOT_FREE | BHR_HOT_SPOT_RAIN.
    HotSpotFlags flags;
    /// In M, 1 .. 1000.
    double radius;
    /// In M, 0.05 .. radius / 4, and at least radius / 200; FREE: from 0.05 to 250.
    double size;
    /// The centre at scene time 0, radians within +-1e6.
    double azimuth;
    /// Per M at the centre, 0 .. 1e6.
    double absorption;
    /// Kelvin, 500 .. 1e9.
    double temperature;
    /// Without THERMAL: -4 .. 4.
    double spectral_index;
    /// Without THERMAL: the colour of its light at every shift, linear Rec. 709, each 0 .. 1.
    Vector tint;
    /// 0 .. 1e6, as BhrVolume.brightness.
    double brightness;
    /// FREE: where the centre is at `time`, scene axes and lengths, as BhrBody has it.
    Vector position;
    /// FREE: its velocity there in units of c, |v| < 1, scene axes, as BhrBody has it.
    Vector velocity;
    /// FREE: scene time, in scene lengths, that position and velocity are of; RAIN: rain time.
    double time;

    HotSpot() noexcept { detail::defaults(*this, bhr_hot_spot_init); }
    BhrHotSpot c() const noexcept { return detail::as_c<BhrHotSpot>(*this); }
};

/// BhrSky: The sky: everything that lies at infinity. Defaults: bhr_sky_init.
struct Sky {
    /// Sizeof(BhrSky).
    std::uint32_t struct_size;
    /// BHR_SKY_* bits; 0: black.
    SkyFlags flags;
    /// A factor on the light of the stars, 0 .. 1e6.
    double stars_brightness;
    /// A factor on the light of the Milky Way and the map, 0 .. 1e6.
    double map_brightness;
    /// Unit quaternion x y z w that takes sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole) to
    /// scene axes.
    std::array<double, 4> orientation;
    /// Selects the stars of BHR_SKY_PROCEDURAL: any number.
    std::uint64_t seed;

    Sky() noexcept { detail::defaults(*this, bhr_sky_init); }
    BhrSky c() const noexcept { return detail::as_c<BhrSky>(*this); }
};

/// BhrFilm: How light becomes pixels, in formats of 8 and 10 bits and windows of BHR_VIEW_LIGHT only: float formats
/// hold linear radiance, and other views show values. Defaults: bhr_film_init.
struct Film {
    /// Sizeof(BhrFilm).
    std::uint32_t struct_size;
    /// BHR_TONE_MAP_*.
    ToneMap tone_map;
    /// Stops, -20 .. 20.
    double exposure_ev;
    /// Glare, 0 .. 1, 0 off, default 0.25: optics scatter 0.4 bloom of each pixel's light over its surroundings, alike
    /// at every resolution.
    double bloom;
    /// The full width at half maximum of a Gaussian that the picture is spread by, as by a telescope's beam; in frame
    /// heights, 0 .. 1, 0 off (default).
    double beam_fwhm;
    /// BHR_COLOUR_MAP_*.
    ColourMap colour_map;
    /// Blades of the lens's aperture, 3 .. 8: an even number of them makes as many spikes, an odd one twice as many.
    std::uint32_t spike_blades;
    /// Kelvin, 1667 .. 25000, of the blackbody whose light is to look white: the lower, the bluer the picture.
    double white_balance;
    /// -1 .. 1: the picture turns towards magenta above 0, towards green below.
    double tint;
    /// 0.25 .. 4, the exponent of light; light of 0.18, middle grey, stays as it is.
    double contrast;
    /// 0 .. 4, a factor on how far colours are from the grey of their luminance; 0 is grey.
    double saturation;
    /// FILMIC, 0 .. 1: at 0 dark light stays linear, at 1 all of the toe, the curve's dark end, is black.
    double toe_strength;
    /// FILMIC: 0 .. 1; the toe ends at light toe_length^2.2 / 2.
    double toe_length;
    /// FILMIC: stops, 0 .. 16; light from about 2^shoulder_strength on is white.
    double shoulder_strength;
    /// FILMIC, 0 .. 1: the share that the shoulder, the curve's bright end, has of all that is above the toe.
    double shoulder_length;
    /// FILMIC: how steep the shoulder still is at white, 0 .. 1; at 0 it ends flat.
    double shoulder_angle;
    /// 0 .. 1, the share of a lens' natural darkening, cos^4 of an angle whose tangent is 1 in the corners of the whole
    /// frame: at 1, light is a quarter there.
    double vignette;
    /// Auto exposure, 0 .. 1: how far the exposure goes to where auto_percentile is auto_target.
    double auto_exposure;
    /// The percentile of the frame's luminance that auto exposure goes by, 0 .. 100.
    double auto_percentile;
    /// The luminance that auto exposure brings the percentile to, 0.001 .. 1000; middle grey is 0.18.
    double auto_target;
    /// The least that auto exposure adds, stops, -20 .. 20.
    double auto_least_ev;
    /// The most that auto exposure adds, stops, -20 .. 20.
    double auto_most_ev;
    /// 0.000001 .. 1: the share of the way that a frame goes from the exposure of the last frame of its size that this
    /// context measured.
    double auto_adaptation;
    /// Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, bright parts of the picture come;
    /// their structure stays.
    double highlights;
    /// Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, dark parts of the picture come.
    double shadows;
    /// Grain, 0 .. 1: light varies at random from place to place, with a standard deviation of 0.25 grain of itself.
    double grain;
    /// Any number within +-1e15: each is another grain, for instance that of a film's frame.
    double grain_seed;
    /// 0 .. 1, the share of the colours that the LUT of bhr_set_film_lut has in the picture; 0 off.
    double lut_strength;
    /// Diffraction spikes, 0 .. 1, 0 off (default): the lens throws 0.4 spikes of each pixel's light along lines that
    /// lie across the edges of the aperture's blades; they are reddish.
    double spikes;
    /// The direction of one spike, radians anticlockwise from upright, -2 pi .. 2 pi.
    double spike_angle;
    /// In frame heights, 0.01 .. 2: the length of the spikes' faint tails, which fall off by exp(-distance /
    /// spike_length).
    double spike_length;
    /// The horizontal streak of an anamorphic lens, 0 .. 1, 0 off (default): 0.4 streak of each pixel's light is thrown
    /// to its left and right.
    double streak;
    /// In frame heights, 0.01 .. 4: the length of the streak's tails, which fall off by exp(-distance / streak_length).
    double streak_length;
    /// The streak's colour, -1 .. 1: -1 is amber, 0 that of the light, 1 blue.
    double streak_tint;
    /// BHR_FORMAT_RGB10A2_*: what the display shows for light of 1, diffuse white; cd/m^2, 10 .. 1000.
    double paper_white;
    /// BHR_FORMAT_RGB10A2_*: the brightest that the display shows, cd/m^2, 100 .. 10000, to which brighter light is
    /// rolled off.
    double peak;
    /// Lens flare, 0 .. 1, 0 off (default): the lens reflects 0.15 flare of each pixel's light into ghosts, blurred
    /// images of its aperture (spike_blades, spike_angle) in several colours, on the line from that pixel through the
    /// middle of the frame.
    double flare;
    /// How many ghosts each light has, 0 .. 8; 0, the default, stands for 5.
    std::uint32_t flare_ghosts;
    /// Reserved: 0.
    std::uint32_t reserved;

    Film() noexcept { detail::defaults(*this, bhr_film_init); }
    BhrFilm c() const noexcept { return detail::as_c<BhrFilm>(*this); }
};

/// BhrPresetOptions: Settings of bhr_set_preset_with. Defaults: bhr_preset_options_init.
struct PresetOptions {
    /// Sizeof(BhrPresetOptions).
    std::uint32_t struct_size;
    /// BHR_PRESET_MATTER_AUTO (default), _THIN, _DEEP.
    PresetMatter matter;
    /// AUTO: the width of the frames that are to be rendered, in pixels, 1 .. 1048576; 0 means the default, 1920.
    std::uint32_t width;
    /// AUTO: their height, in pixels, 1 .. 1048576; 0 means the default, 1080.
    std::uint32_t height;
    /// AUTO: the time that such a frame may take, in milliseconds, 0.001 .. 1e9; 0 means the default, 16.
    double frame_ms;
    /// AUTO: 1 forgets what was measured for the preset before; 0 (default) keeps it.
    std::uint32_t measure_anew;
    /// AUTO: 1 takes DEEP at half resolution where FULL is too slow, and sets BhrQuality.volume_resolution to what DEEP
    /// fits with; 0 (default) leaves that as it is.
    std::uint32_t may_halve;

    PresetOptions() noexcept { detail::defaults(*this, bhr_preset_options_init); }
    BhrPresetOptions c() const noexcept { return detail::as_c<BhrPresetOptions>(*this); }
};

/// BhrQuality: How exactly to trace. Defaults: bhr_quality_init.
struct Quality {
    /// Sizeof(BhrQuality).
    std::uint32_t struct_size;
    /// BHR_METHOD_*.
    Method method;
    /// Samples of each pixel, 1 .. 256.
    std::uint32_t samples_per_pixel;
    /// Steps of an integrated ray, 16 .. 100000.
    std::uint32_t max_steps;
    /// RK4: the step, 1e-3 .. 0.5, in Mino time scaled to the ray (docs/numerics.md); 0 means the default, 0.1.
    double step;
    /// ADAPTIVE: the relative tolerance, 1e-14 .. 1e-3; 0: the default, 1e-10.
    double tolerance;
    /// Images of the disk to follow, 0 .. 15; 0: the direct one only.
    std::uint32_t max_disk_order;
    /// Reserved: 0.
    std::uint32_t reserved;
    /// Windows: traced size / window size, 0.1 .. 1.
    double render_scale;
    /// BHR_VOLUME_RESOLUTION_*.
    VolumeResolution volume_resolution;
    /// Reserved: 0.
    std::uint32_t reserved2;

    Quality() noexcept { detail::defaults(*this, bhr_quality_init); }
    BhrQuality c() const noexcept { return detail::as_c<BhrQuality>(*this); }
};

} // namespace bhr

#endif
