/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* fields.c -- see fields.h. Made by tests/header/example_fields.rs from include/bhr.json; do not edit. */
#include "fields.h"

const Choice BACKENDS[] = {
    {"auto", BHR_BACKEND_AUTO}, {"cpu", BHR_BACKEND_CPU}, {"vulkan", BHR_BACKEND_VULKAN},
    {"metal", BHR_BACKEND_METAL}, {"d3d12", BHR_BACKEND_D3D12}, {"gl", BHR_BACKEND_GL}, {NULL, 0}};

const Choice PROJECTIONS[] = {
    {"perspective", BHR_PROJECTION_PERSPECTIVE}, {"fisheye", BHR_PROJECTION_FISHEYE},
    {"equirect", BHR_PROJECTION_EQUIRECT}, {"cube", BHR_PROJECTION_CUBE}, {"frustum", BHR_PROJECTION_FRUSTUM},
    {NULL, 0}};

const Choice MOTIONS[] = {
    {"static", BHR_MOTION_STATIC}, {"freefall", BHR_MOTION_FREE_FALL}, {"orbit", BHR_MOTION_ORBIT},
    {"velocity", BHR_MOTION_VELOCITY}, {NULL, 0}};

const Choice EYES[] = {
    {"middle", BHR_EYE_MIDDLE}, {"left", BHR_EYE_LEFT}, {"right", BHR_EYE_RIGHT}, {NULL, 0}};

const Choice DISK_REFERENCES[] = {
    {"hottest", BHR_DISK_AT_HOTTEST}, {"median", BHR_DISK_AT_MEDIAN}, {NULL, 0}};

const Choice EMISSION_LAWS[] = {
    {"isotropic", BHR_DISK_ISOTROPIC}, {"limb-darkened", BHR_DISK_LIMB_DARKENED}, {NULL, 0}};

const Choice VOLUME_KINDS[] = {
    {"disk", BHR_VOLUME_DISK}, {"torus", BHR_VOLUME_TORUS}, {"halo", BHR_VOLUME_HALO}, {"jet", BHR_VOLUME_JET},
    {NULL, 0}};

const Choice FLOWS[] = {
    {"keplerian", BHR_FLOW_KEPLERIAN}, {"angular-momentum", BHR_FLOW_ANGULAR_MOMENTUM}, {"outflow", BHR_FLOW_OUTFLOW},
    {NULL, 0}};

const Choice COLOUR_SPACES[] = {
    {"rec709", BHR_COLOUR_SPACE_REC709}, {"p3-d65", BHR_COLOUR_SPACE_P3_D65}, {"rec2020", BHR_COLOUR_SPACE_REC2020},
    {"acescg", BHR_COLOUR_SPACE_ACESCG}, {NULL, 0}};

const Choice TONE_MAPS[] = {
    {"none", BHR_TONE_MAP_NONE}, {"aces", BHR_TONE_MAP_ACES}, {"agx", BHR_TONE_MAP_AGX},
    {"filmic", BHR_TONE_MAP_FILMIC}, {NULL, 0}};

const Choice COLOUR_MAPS[] = {
    {"none", BHR_COLOUR_MAP_NONE}, {"afmhot", BHR_COLOUR_MAP_AFMHOT}, {NULL, 0}};

const Choice PRESETS[] = {
    {"cinematic", BHR_PRESET_CINEMATIC}, {"physical", BHR_PRESET_PHYSICAL}, {"observatory", BHR_PRESET_OBSERVATORY},
    {"teaching", BHR_PRESET_TEACHING}, {NULL, 0}};

const Choice PRESET_MATTERS[] = {
    {"auto", BHR_PRESET_MATTER_AUTO}, {"thin", BHR_PRESET_MATTER_THIN}, {"deep", BHR_PRESET_MATTER_DEEP}, {NULL, 0}};

const Choice METHODS[] = {
    {"auto", BHR_METHOD_AUTO}, {"rk4", BHR_METHOD_RK4}, {"adaptive", BHR_METHOD_ADAPTIVE}, {NULL, 0}};

const Choice VOLUME_RESOLUTIONS[] = {
    {"full", BHR_VOLUME_RESOLUTION_FULL}, {"half", BHR_VOLUME_RESOLUTION_HALF}, {NULL, 0}};

const Choice VIEWS[] = {
    {"light", BHR_VIEW_LIGHT}, {"redshift", BHR_VIEW_REDSHIFT}, {"order", BHR_VIEW_ORDER},
    {"deflection", BHR_VIEW_DEFLECTION}, {"steps", BHR_VIEW_STEPS}, {"metric", BHR_VIEW_METRIC},
    {"optical_depth", BHR_VIEW_OPTICAL_DEPTH}, {"intensity", BHR_VIEW_INTENSITY}, {NULL, 0}};

static const Choice DISK_FLAGS[] = {
    {"retrograde", BHR_DISK_RETROGRADE}, {"plunges", BHR_DISK_PLUNGES}, {NULL, 0}};

const Field DISK_FIELDS[] = {
    {"--retrograde", OPTION_BIT, offsetof(BhrDisk, flags), NULL, 0, 0, NULL,
     "the matter orbits towards -ph", &DISK_FLAGS[0]},
    {"--plunges", OPTION_BIT, offsetof(BhrDisk, flags), NULL, 0, 0, NULL,
     "matter shines on its way from the ISCO to the horizon, too, where it falls freely", &DISK_FLAGS[1]},
    {"--inner-radius", OPTION_DOUBLE, offsetof(BhrDisk, inner_radius), "M", 0, 1e6, "0 .. 1e6",
     "in M, 0 .. 1e6", NULL},
    {"--outer-radius", OPTION_DOUBLE, offsetof(BhrDisk, outer_radius), "M", 0, 1e6, "0 .. 1e6",
     "in M, 0 .. 1e6, greater than inner_radius", NULL},
    {"--temperature", OPTION_DOUBLE, offsetof(BhrDisk, temperature), "K", 500, 1e9, "500 .. 1e9",
     "kelvin at the ring that `reference` says, 500 .. 1e9", NULL},
    {"--opacity", OPTION_DOUBLE, offsetof(BhrDisk, opacity), NULL, 0, 1, "0 .. 1",
     "0 .. 1", NULL},
    {"--brightness", OPTION_DOUBLE, offsetof(BhrDisk, brightness), NULL, 0, 1e6, "0 .. 1e6",
     "0 .. 1e6: the luminance of that ring at rest", NULL},
    {"--turbulence", OPTION_DOUBLE, offsetof(BhrDisk, turbulence), NULL, 0, 1, "0 .. 1",
     "contrast of the structure that orbits with the matter, 0 .. 1; 0 is smooth", NULL},
    {"--seed", OPTION_UINT64, offsetof(BhrDisk, seed), NULL, 0, 0, NULL,
     "selects the turbulence: the same seed always gives the same pattern", NULL},
    {"--reference", OPTION_CHOICE, offsetof(BhrDisk, reference), NULL, 0, 0, NULL,
     "the ring at whose radius a disk has the stated temperature and brightness", DISK_REFERENCES},
    {"--emission-law", OPTION_CHOICE, offsetof(BhrDisk, emission_law), NULL, 0, 0, NULL,
     "how the disk's light depends on the angle to its normal, in the frame of its matter", EMISSION_LAWS},
    {"--edge-softness", OPTION_DOUBLE, offsetof(BhrDisk, edge_softness), NULL, 0, 1, "0 .. 1",
     "0 .. 1, 0 is sharp: opacity and light fade to nothing over this share of the way from the inner edge to the "
     "outer one, at its end, and near the ISCO", NULL},
    {NULL, OPTION_FLAG, 0, NULL, 0, 0, NULL, NULL, NULL}};

static const Choice VOLUME_FLAGS[] = {
    {"retrograde", BHR_VOLUME_RETROGRADE}, {"power-law", BHR_VOLUME_POWER_LAW}, {NULL, 0}};

const Field VOLUME_FIELDS[] = {
    {"--retrograde", OPTION_BIT, offsetof(BhrVolume, flags), NULL, 0, 0, NULL,
     "the matter moves towards -ph", &VOLUME_FLAGS[0]},
    {"--power-law", OPTION_BIT, offsetof(BhrVolume, flags), NULL, 0, 0, NULL,
     "the light is a power law of the frequency, not a blackbody's", &VOLUME_FLAGS[1]},
    {"--shape", OPTION_CHOICE, offsetof(BhrVolume, shape), NULL, 0, 0, NULL,
     "the place of a volume's matter: its density n, with c = cos th, R = r sin th, z = r c, and lengths in M",
     VOLUME_KINDS},
    {"--flow", OPTION_CHOICE, offsetof(BhrVolume, flow), NULL, 0, 0, NULL,
     "the motion of a volume's matter", FLOWS},
    {"--inner-radius", OPTION_DOUBLE, offsetof(BhrVolume, inner_radius), "M", 1e-6, 10000, "1e-6 .. 10000",
     "in M, 1e-6 .. 1e4, or 0: the ISCO of matter that moves as flags say", NULL},
    {"--outer-radius", OPTION_DOUBLE, offsetof(BhrVolume, outer_radius), "M", 0, 10000, "0 .. 10000",
     "in M, 0 .. 1e4, greater than inner_radius", NULL},
    {"--radius", OPTION_DOUBLE, offsetof(BhrVolume, radius), "M", 0.1, 10000, "0.1 .. 10000",
     "in M, 0.1 .. 1e4", NULL},
    {"--width", OPTION_DOUBLE, offsetof(BhrVolume, width), "M", 0.001, 10000, "0.001 .. 10000",
     "in M, 1e-3 .. 1e4, of a TORUS at least radius / 100: its Gaussian width in R", NULL},
    {"--thickness", OPTION_DOUBLE, offsetof(BhrVolume, thickness), NULL, 0.01, 1e6, "0.01 .. 1e6",
     "0.01 .. 1e6: the Gaussian width in c; TORUS: in z, over radius", NULL},
    {"--opening", OPTION_DEGREES, offsetof(BhrVolume, opening), "rad", 0.01, 1.5, "0.57 .. 85.94",
     "JET: the wall's angle from the axis at `radius`", NULL},
    {"--slope", OPTION_DOUBLE, offsetof(BhrVolume, slope), NULL, 0, 4, "0 .. 4",
     "DISK, JET: 0 .. 4", NULL},
    {"--absorption", OPTION_DOUBLE, offsetof(BhrVolume, absorption), "1/M", 0, 1e6, "0 .. 1e6",
     "per M at density 1, 0 .. 1e6", NULL},
    {"--temperature", OPTION_DOUBLE, offsetof(BhrVolume, temperature), "K", 500, 1e9, "500 .. 1e9",
     "kelvin, 500 .. 1e9, at inner_radius (DISK, JET) or at radius (TORUS, HALO)", NULL},
    {"--temperature-slope", OPTION_DOUBLE, offsetof(BhrVolume, temperature_slope), NULL, 0, 2, "0 .. 2",
     "0 .. 2: the temperature goes as r^-temperature_slope", NULL},
    {"--spectral-index", OPTION_DOUBLE, offsetof(BhrVolume, spectral_index), NULL, -4, 4, "-4 .. 4",
     "POWER_LAW: -4 .. 4", NULL},
    {"--tint", OPTION_VECTOR, offsetof(BhrVolume, tint), NULL, 0, 1, "0 .. 1",
     "POWER_LAW: the colour of its light at every shift, linear Rec. 709, each 0 .. 1", NULL},
    {"--brightness", OPTION_DOUBLE, offsetof(BhrVolume, brightness), NULL, 0, 1e6, "0 .. 1e6",
     "a factor on the light, 0 .. 1e6, which changes neither its colour nor what is absorbed", NULL},
    {"--sub-keplerian", OPTION_DOUBLE, offsetof(BhrVolume, sub_keplerian), NULL, 0, 1, "0 .. 1",
     "KEPLERIAN: the share of the orbit's angular momentum, 0 .. 1", NULL},
    {"--infall", OPTION_DOUBLE, offsetof(BhrVolume, infall), NULL, 0, 1, "0 .. 1",
     "KEPLERIAN: a share without a unit, 0 .. 1: 0 is orbits, 1 free fall from rest at infinity", NULL},
    {"--angular-momentum", OPTION_DOUBLE, offsetof(BhrVolume, angular_momentum), NULL, 0, 1, "0 .. 1",
     "ANGULAR_MOMENTUM: 0 .. 1", NULL},
    {"--speed", OPTION_DOUBLE, offsetof(BhrVolume, speed), "c", 0, 0.995, "0 .. 0.995",
     "OUTFLOW: the velocity far away in units of c, 0 .. 0.995", NULL},
    {"--turbulence", OPTION_DOUBLE, offsetof(BhrVolume, turbulence), NULL, 0, 1, "0 .. 1",
     "0 .. 1: the contrast of structure that the matter carries along: a pattern P = e^(turbulence G) over its "
     "mean, G being noise of mean 0 and about variance 1", NULL},
    {"--clumping", OPTION_DOUBLE, offsetof(BhrVolume, clumping), NULL, 0.5, 3, "0.5 .. 3",
     "0.5 .. 3: the density is multiplied by P^clumping over its mean; more makes filaments", NULL},
    {"--heating", OPTION_DOUBLE, offsetof(BhrVolume, heating), NULL, 0, 0.5, "0 .. 0.5",
     "0 .. 0.5: the temperature is multiplied by P^heating, so that dense matter is hotter", NULL},
    {"--seed", OPTION_UINT64, offsetof(BhrVolume, seed), NULL, 0, 0, NULL,
     "selects the structure: the same seed always gives the same one", NULL},
    {NULL, OPTION_FLAG, 0, NULL, 0, 0, NULL, NULL, NULL}};

static const Choice HOT_SPOT_FLAGS[] = {
    {"retrograde", BHR_HOT_SPOT_RETROGRADE}, {"thermal", BHR_HOT_SPOT_THERMAL}, {"free", BHR_HOT_SPOT_FREE},
    {"rain", BHR_HOT_SPOT_RAIN}, {NULL, 0}};

const Field HOT_SPOT_FIELDS[] = {
    {"--retrograde", OPTION_BIT, offsetof(BhrHotSpot, flags), NULL, 0, 0, NULL,
     "the spot moves towards -ph", &HOT_SPOT_FLAGS[0]},
    {"--thermal", OPTION_BIT, offsetof(BhrHotSpot, flags), NULL, 0, 0, NULL,
     "the light is a blackbody's, not a power law's; without absorption there is none", &HOT_SPOT_FLAGS[1]},
    {"--free", OPTION_BIT, offsetof(BhrHotSpot, flags), NULL, 0, 0, NULL,
     "the centre is a body in free fall, which position, velocity and time tell; radius, azimuth and RETROGRADE "
     "have no meaning", &HOT_SPOT_FLAGS[2]},
    {"--rain", OPTION_BIT, offsetof(BhrHotSpot, flags), NULL, 0, 0, NULL,
     "with FREE, these are told in BHR_CHART_RAIN instead of BHR_CHART_STATIC", &HOT_SPOT_FLAGS[3]},
    {"--radius", OPTION_DOUBLE, offsetof(BhrHotSpot, radius), "M", 1, 1000, "1 .. 1000",
     "in M, 1 .. 1000", NULL},
    {"--size", OPTION_DOUBLE, offsetof(BhrHotSpot, size), "M", 0, 0, NULL,
     "in M, 0.05 .. radius / 4, and at least radius / 200; FREE: from 0.05 to 250", NULL},
    {"--azimuth", OPTION_DEGREES, offsetof(BhrHotSpot, azimuth), "rad", -1e6, 1e6, NULL,
     "the centre at scene time 0", NULL},
    {"--absorption", OPTION_DOUBLE, offsetof(BhrHotSpot, absorption), "1/M", 0, 1e6, "0 .. 1e6",
     "per M at the centre, 0 .. 1e6", NULL},
    {"--temperature", OPTION_DOUBLE, offsetof(BhrHotSpot, temperature), "K", 500, 1e9, "500 .. 1e9",
     "kelvin, 500 .. 1e9", NULL},
    {"--spectral-index", OPTION_DOUBLE, offsetof(BhrHotSpot, spectral_index), NULL, -4, 4, "-4 .. 4",
     "without THERMAL: -4 .. 4", NULL},
    {"--tint", OPTION_VECTOR, offsetof(BhrHotSpot, tint), NULL, 0, 1, "0 .. 1",
     "without THERMAL: the colour of its light at every shift, linear Rec. 709, each 0 .. 1", NULL},
    {"--brightness", OPTION_DOUBLE, offsetof(BhrHotSpot, brightness), NULL, 0, 1e6, "0 .. 1e6",
     "0 .. 1e6, as BhrVolume.brightness", NULL},
    {"--position", OPTION_VECTOR, offsetof(BhrHotSpot, position), NULL, 0, 0, NULL,
     "FREE: where the centre is at `time`, scene axes and lengths, as BhrBody has it", NULL},
    {"--velocity", OPTION_VECTOR, offsetof(BhrHotSpot, velocity), "c", 0, 0, NULL,
     "FREE: its velocity there in units of c, |v| < 1, scene axes, as BhrBody has it", NULL},
    {"--time", OPTION_DOUBLE, offsetof(BhrHotSpot, time), "scene length", 0, 0, NULL,
     "FREE: scene time, in scene lengths, that position and velocity are of; RAIN: rain time", NULL},
    {NULL, OPTION_FLAG, 0, NULL, 0, 0, NULL, NULL, NULL}};

static const Choice SKY_FLAGS[] = {
    {"stars", BHR_SKY_STARS}, {"procedural", BHR_SKY_PROCEDURAL}, {"milky-way", BHR_SKY_MILKY_WAY},
    {"map", BHR_SKY_MAP}, {"grid", BHR_SKY_GRID}, {NULL, 0}};

const Field SKY_FIELDS[] = {
    {"--flags", OPTION_BITS, offsetof(BhrSky, flags), NULL, 0, 0, NULL,
     "BHR_SKY_* bits; 0: black", SKY_FLAGS},
    {"--stars-brightness", OPTION_DOUBLE, offsetof(BhrSky, stars_brightness), NULL, 0, 1e6, "0 .. 1e6",
     "a factor on the light of the stars, 0 .. 1e6", NULL},
    {"--map-brightness", OPTION_DOUBLE, offsetof(BhrSky, map_brightness), NULL, 0, 1e6, "0 .. 1e6",
     "a factor on the light of the Milky Way and the map, 0 .. 1e6", NULL},
    {"--orientation", OPTION_FOUR, offsetof(BhrSky, orientation), NULL, 0, 0, NULL,
     "unit quaternion x y z w that takes sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole) to "
     "scene axes", NULL},
    {"--seed", OPTION_UINT64, offsetof(BhrSky, seed), NULL, 0, 0, NULL,
     "selects the stars of BHR_SKY_PROCEDURAL: any number", NULL},
    {NULL, OPTION_FLAG, 0, NULL, 0, 0, NULL, NULL, NULL}};

const Field FILM_FIELDS[] = {
    {"--tone-map", OPTION_CHOICE, offsetof(BhrFilm, tone_map), NULL, 0, 0, NULL,
     "the curve from light to pixels", TONE_MAPS},
    {"--exposure-ev", OPTION_DOUBLE, offsetof(BhrFilm, exposure_ev), "EV", -20, 20, "-20 .. 20",
     "stops, -20 .. 20", NULL},
    {"--bloom", OPTION_DOUBLE, offsetof(BhrFilm, bloom), NULL, 0, 1, "0 .. 1",
     "glare, 0 .. 1, 0 off: optics scatter 0.4 bloom of each pixel's light over its surroundings, alike at every "
     "resolution", NULL},
    {"--beam-fwhm", OPTION_DOUBLE, offsetof(BhrFilm, beam_fwhm), "frame height", 0, 1, "0 .. 1",
     "the full width at half maximum of a Gaussian that the picture is spread by, as by a telescope's beam; in "
     "frame heights, 0 .. 1, 0 off", NULL},
    {"--colour-map", OPTION_CHOICE, offsetof(BhrFilm, colour_map), NULL, 0, 0, NULL,
     "the colours of a picture", COLOUR_MAPS},
    {"--spike-blades", OPTION_UINT, offsetof(BhrFilm, spike_blades), NULL, 3, 8, "3 .. 8",
     "blades of the lens's aperture, 3 .. 8: an even number of them makes as many spikes, an odd one twice as many",
     NULL},
    {"--white-balance", OPTION_DOUBLE, offsetof(BhrFilm, white_balance), "K", 1667, 25000, "1667 .. 25000",
     "kelvin, 1667 .. 25000, of the blackbody whose light is to look white: the lower, the bluer the picture", NULL},
    {"--tint", OPTION_DOUBLE, offsetof(BhrFilm, tint), NULL, -1, 1, "-1 .. 1",
     "-1 .. 1: the picture turns towards magenta above 0, towards green below", NULL},
    {"--contrast", OPTION_DOUBLE, offsetof(BhrFilm, contrast), NULL, 0.25, 4, "0.25 .. 4",
     "0.25 .. 4, the exponent of light; light of 0.18, middle grey, stays as it is", NULL},
    {"--saturation", OPTION_DOUBLE, offsetof(BhrFilm, saturation), NULL, 0, 4, "0 .. 4",
     "0 .. 4, a factor on how far colours are from the grey of their luminance; 0 is grey", NULL},
    {"--toe-strength", OPTION_DOUBLE, offsetof(BhrFilm, toe_strength), NULL, 0, 1, "0 .. 1",
     "FILMIC, 0 .. 1: at 0 dark light stays linear, at 1 all of the toe, the curve's dark end, is black", NULL},
    {"--toe-length", OPTION_DOUBLE, offsetof(BhrFilm, toe_length), NULL, 0, 1, "0 .. 1",
     "FILMIC: 0 .. 1; the toe ends at light toe_length^2.2 / 2", NULL},
    {"--shoulder-strength", OPTION_DOUBLE, offsetof(BhrFilm, shoulder_strength), "EV", 0, 16, "0 .. 16",
     "FILMIC: stops, 0 .. 16; light from about 2^shoulder_strength on is white", NULL},
    {"--shoulder-length", OPTION_DOUBLE, offsetof(BhrFilm, shoulder_length), NULL, 0, 1, "0 .. 1",
     "FILMIC, 0 .. 1: the share that the shoulder, the curve's bright end, has of all that is above the toe", NULL},
    {"--shoulder-angle", OPTION_DOUBLE, offsetof(BhrFilm, shoulder_angle), NULL, 0, 1, "0 .. 1",
     "FILMIC: how steep the shoulder still is at white, 0 .. 1; at 0 it ends flat", NULL},
    {"--vignette", OPTION_DOUBLE, offsetof(BhrFilm, vignette), NULL, 0, 1, "0 .. 1",
     "0 .. 1, the share of a lens' natural darkening, cos^4 of an angle whose tangent is 1 in the corners of the "
     "whole frame: at 1, light is a quarter there", NULL},
    {"--auto-exposure", OPTION_DOUBLE, offsetof(BhrFilm, auto_exposure), NULL, 0, 1, "0 .. 1",
     "auto exposure, 0 .. 1: how far the exposure goes to where auto_percentile is auto_target", NULL},
    {"--auto-percentile", OPTION_DOUBLE, offsetof(BhrFilm, auto_percentile), NULL, 0, 100, "0 .. 100",
     "the percentile of the frame's luminance that auto exposure goes by, 0 .. 100", NULL},
    {"--auto-target", OPTION_DOUBLE, offsetof(BhrFilm, auto_target), NULL, 0.001, 1000, "0.001 .. 1000",
     "the luminance that auto exposure brings the percentile to, 0.001 .. 1000; middle grey is 0.18", NULL},
    {"--auto-least-ev", OPTION_DOUBLE, offsetof(BhrFilm, auto_least_ev), "EV", -20, 20, "-20 .. 20",
     "the least that auto exposure adds, stops, -20 .. 20", NULL},
    {"--auto-most-ev", OPTION_DOUBLE, offsetof(BhrFilm, auto_most_ev), "EV", -20, 20, "-20 .. 20",
     "the most that auto exposure adds, stops, -20 .. 20", NULL},
    {"--auto-adaptation", OPTION_DOUBLE, offsetof(BhrFilm, auto_adaptation), NULL, 1e-6, 1, "1e-6 .. 1",
     "0.000001 .. 1: the share of the way that a frame goes from the exposure of the last frame of its size that "
     "this context measured", NULL},
    {"--highlights", OPTION_DOUBLE, offsetof(BhrFilm, highlights), NULL, 0, 1, "0 .. 1",
     "local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, bright parts of the picture "
     "come; their structure stays", NULL},
    {"--shadows", OPTION_DOUBLE, offsetof(BhrFilm, shadows), NULL, 0, 1, "0 .. 1",
     "local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, dark parts of the picture come",
     NULL},
    {"--grain", OPTION_DOUBLE, offsetof(BhrFilm, grain), NULL, 0, 1, "0 .. 1",
     "grain, 0 .. 1: light varies at random from place to place, with a standard deviation of 0.25 grain of itself",
     NULL},
    {"--grain-seed", OPTION_DOUBLE, offsetof(BhrFilm, grain_seed), NULL, -1e15, 1e15, "-1e15 .. 1e15",
     "any number within +-1e15: each is another grain, for instance that of a film's frame", NULL},
    {"--lut-strength", OPTION_DOUBLE, offsetof(BhrFilm, lut_strength), NULL, 0, 1, "0 .. 1",
     "0 .. 1, the share of the colours that the LUT of bhr_set_film_lut has in the picture; 0 off", NULL},
    {"--spikes", OPTION_DOUBLE, offsetof(BhrFilm, spikes), NULL, 0, 1, "0 .. 1",
     "diffraction spikes, 0 .. 1, 0 off: the lens throws 0.4 spikes of each pixel's light along lines that lie "
     "across the edges of the aperture's blades; they are reddish", NULL},
    {"--spike-angle", OPTION_DEGREES, offsetof(BhrFilm, spike_angle), "rad", 0, 0, NULL,
     "the direction of one spike", NULL},
    {"--spike-length", OPTION_DOUBLE, offsetof(BhrFilm, spike_length), "frame height", 0.01, 2, "0.01 .. 2",
     "in frame heights, 0.01 .. 2: the length of the spikes' faint tails, which fall off by exp(-distance / "
     "spike_length)", NULL},
    {"--streak", OPTION_DOUBLE, offsetof(BhrFilm, streak), NULL, 0, 1, "0 .. 1",
     "the horizontal streak of an anamorphic lens, 0 .. 1, 0 off: 0.4 streak of each pixel's light is thrown to its "
     "left and right", NULL},
    {"--streak-length", OPTION_DOUBLE, offsetof(BhrFilm, streak_length), "frame height", 0.01, 4, "0.01 .. 4",
     "in frame heights, 0.01 .. 4: the length of the streak's tails, which fall off by exp(-distance / "
     "streak_length)", NULL},
    {"--streak-tint", OPTION_DOUBLE, offsetof(BhrFilm, streak_tint), NULL, -1, 1, "-1 .. 1",
     "the streak's colour, -1 .. 1: -1 is amber, 0 that of the light, 1 blue", NULL},
    {"--paper-white", OPTION_DOUBLE, offsetof(BhrFilm, paper_white), NULL, 10, 1000, "10 .. 1000",
     "BHR_FORMAT_RGB10A2_*: what the display shows for light of 1, diffuse white; cd/m^2, 10 .. 1000", NULL},
    {"--peak", OPTION_DOUBLE, offsetof(BhrFilm, peak), NULL, 100, 10000, "100 .. 10000",
     "BHR_FORMAT_RGB10A2_*: the brightest that the display shows, cd/m^2, 100 .. 10000, to which brighter light is "
     "rolled off", NULL},
    {"--flare", OPTION_DOUBLE, offsetof(BhrFilm, flare), NULL, 0, 1, "0 .. 1",
     "lens flare, 0 .. 1, 0 off: the lens reflects 0.15 flare of each pixel's light into ghosts, blurred images of "
     "its aperture (spike_blades, spike_angle) in several colours, on the line from that pixel through the middle "
     "of the frame", NULL},
    {"--flare-ghosts", OPTION_UINT, offsetof(BhrFilm, flare_ghosts), NULL, 0, 8, "0 .. 8",
     "how many ghosts each light has, 0 .. 8; 0, the default, stands for 5", NULL},
    {NULL, OPTION_FLAG, 0, NULL, 0, 0, NULL, NULL, NULL}};

const Field QUALITY_FIELDS[] = {
    {"--method", OPTION_CHOICE, offsetof(BhrQuality, method), NULL, 0, 0, NULL,
     "the way in which light is followed", METHODS},
    {"--samples-per-pixel", OPTION_UINT, offsetof(BhrQuality, samples_per_pixel), "pixel", 1, 256, "1 .. 256",
     "samples of each pixel, 1 .. 256", NULL},
    {"--max-steps", OPTION_UINT, offsetof(BhrQuality, max_steps), NULL, 16, 100000, "16 .. 100000",
     "steps of an integrated ray, 16 .. 100000", NULL},
    {"--step", OPTION_DOUBLE, offsetof(BhrQuality, step), NULL, 0.001, 0.5, "0.001 .. 0.5",
     "RK4: the step, 1e-3 .. 0.5, in Mino time scaled to the ray (docs/numerics.md); 0 means the default, 0.1", NULL},
    {"--tolerance", OPTION_DOUBLE, offsetof(BhrQuality, tolerance), NULL, 1e-14, 0.001, "1e-14 .. 0.001",
     "ADAPTIVE: the relative tolerance, 1e-14 .. 1e-3; 0: the default, 1e-10", NULL},
    {"--max-disk-order", OPTION_UINT, offsetof(BhrQuality, max_disk_order), NULL, 0, 15, "0 .. 15",
     "images of the disk to follow, 0 .. 15; 0: the direct one only", NULL},
    {"--render-scale", OPTION_DOUBLE, offsetof(BhrQuality, render_scale), NULL, 0.1, 1, "0.1 .. 1",
     "windows: traced size / window size, 0.1 .. 1", NULL},
    {"--volume-resolution", OPTION_CHOICE, offsetof(BhrQuality, volume_resolution), NULL, 0, 0, NULL,
     "the rays along which volumes and hot spots are summed", VOLUME_RESOLUTIONS},
    {NULL, OPTION_FLAG, 0, NULL, 0, 0, NULL, NULL, NULL}};
