/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bad_light.c -- the setters of disk, sky, film and quality asked wrongly, as bad_scene.c asks those of the hole and
 * the camera: each refusal must leave the context as it was, and values at the limits must be taken. */
#include "check.h"
#include "refusals.h"

#include <math.h>
#include <string.h>

static void disk(Watch *watch, BhrContext *context) {
    static const BadNumber bad[] = {
        {offsetof(BhrDisk, inner_radius), -1.0, "inner_radius"},
        {offsetof(BhrDisk, inner_radius), 20.0, "outer_radius|inner_radius"}, /* as large as the outer one */
        {offsetof(BhrDisk, inner_radius), NAN, "inner_radius"},
        {offsetof(BhrDisk, inner_radius), INFINITY, "inner_radius"},
        {offsetof(BhrDisk, outer_radius), 0.0, "outer_radius"},
        {offsetof(BhrDisk, outer_radius), -3.0, "outer_radius"},
        {offsetof(BhrDisk, outer_radius), NAN, "outer_radius"},
        {offsetof(BhrDisk, outer_radius), INFINITY, "outer_radius"},
        {offsetof(BhrDisk, outer_radius), 1.001e6, "outer_radius"},
        {offsetof(BhrDisk, temperature), 499.0, "temperature"},
        {offsetof(BhrDisk, temperature), 1.1e9, "temperature"},
        {offsetof(BhrDisk, temperature), NAN, "temperature"},
        {offsetof(BhrDisk, temperature), INFINITY, "temperature"},
        {offsetof(BhrDisk, opacity), -0.01, "opacity"},
        {offsetof(BhrDisk, opacity), 1.01, "opacity"},
        {offsetof(BhrDisk, opacity), NAN, "opacity"},
        {offsetof(BhrDisk, opacity), -INFINITY, "opacity"},
        {offsetof(BhrDisk, brightness), -0.01, "brightness"},
        {offsetof(BhrDisk, brightness), 1.001e6, "brightness"},
        {offsetof(BhrDisk, brightness), NAN, "brightness"},
        {offsetof(BhrDisk, brightness), INFINITY, "brightness"},
        {offsetof(BhrDisk, turbulence), -0.01, "turbulence"},
        {offsetof(BhrDisk, turbulence), 1.01, "turbulence"},
        {offsetof(BhrDisk, turbulence), NAN, "turbulence"},
        {offsetof(BhrDisk, turbulence), INFINITY, "turbulence"},
        {offsetof(BhrDisk, edge_softness), -0.01, "edge_softness"},
        {offsetof(BhrDisk, edge_softness), 1.01, "edge_softness"},
        {offsetof(BhrDisk, edge_softness), NAN, "edge_softness"},
        {offsetof(BhrDisk, edge_softness), -INFINITY, "edge_softness"},
    };
    BhrDisk value;
    int32_t present = 7;
    CHECK_BAD_NUMBERS(watch, value, bad, bhr_disk_init(&value, sizeof value), bhr_set_disk(context, &value));
    CHECK_OK(bhr_disk_init(&value, sizeof value));
    value.flags = 0x40;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "flags", bhr_set_disk(context, &value));
    value.flags = BHR_DISK_PLUNGES << 1 | BHR_DISK_PLUNGES;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "flags", bhr_set_disk(context, &value));
    /* Plunging matter lets the disk begin anywhere, but not end where it begins. */
    value.flags = BHR_DISK_PLUNGES, value.inner_radius = value.outer_radius = 3.0;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "outer_radius", bhr_set_disk(context, &value));
    CHECK_OK(bhr_disk_init(&value, sizeof value));
    value.reference = 2;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "disk reference", bhr_set_disk(context, &value));
    value.reference = -1;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "disk reference", bhr_set_disk(context, &value));
    CHECK_OK(bhr_disk_init(&value, sizeof value));
    value.emission_law = 2;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "emission_law", bhr_set_disk(context, &value));
    value.emission_law = -1;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "emission_law", bhr_set_disk(context, &value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "disk", bhr_disk_init(NULL, sizeof value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_disk_init(&value, FIRST_DISK - 1));
    CHECK_OK(bhr_disk_init(&value, sizeof value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_disk(NULL, &value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_disk(NULL, &value, &present));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "disk", bhr_get_disk(context, NULL, &present));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_present", bhr_get_disk(context, &value, NULL));

    struct {
        BhrDisk       known;
        unsigned char tail[16];
    } grown;
    CHECK_STRUCT_SIZES(watch, grown, FIRST_DISK, bhr_disk_init(&grown.known, size), bhr_set_disk(context, &grown.known),
                       bhr_get_disk(context, &grown.known, &present));
    CHECK_OK(bhr_set_disk(context, NULL));
    CHECK_OK(bhr_get_disk(context, &value, &present));
    CHECK(present == 0, "present is %d without a disk", (int)present);
    CHECK_OK(bhr_disk_init(&value, sizeof value));
    CHECK_OK(bhr_set_disk(context, &value));
    CHECK_OK(bhr_get_disk(context, &value, &present));
    CHECK(present == 1, "present is %d with a disk", (int)present);
    watch_begin(watch, context);
}

/* Quaternions x, y, z, w that are no rotation, and some that are, to rounding or to what single precision left. */
static void orientations(Watch *watch, BhrContext *context) {
    static const double bad[][4] = {
        {0.0, 0.0, 0.0, 0.0},      {1.0, 0.0, 0.0, 1.0},       {0.5, 0.5, 0.5, 0.51},
        {0.0, 0.0, 0.0, 1.002},    {0.0, -0.998, 0.0, 0.0},    {1e-200, 0.0, 0.0, 0.0},
        {5e-324, 0.0, 0.0, 0.0},   {1e200, 0.0, 0.0, 0.0},     {1.7e308, 1.7e308, 1.7e308, 1.7e308},
        {NAN, NAN, NAN, NAN},      {INFINITY, 0.0, 0.0, 1.0},  {0.0, 0.0, -INFINITY, 1.0},
    };
    static const double good[][4] = {
        {0.5, 0.5, 0.5, 0.5},    {-0.5, 0.5, -0.5, 0.5}, {0.0, 0.0, 0.0, -1.0},
        {0.0, 1.0, 0.0, 5e-324}, {0.0, 0.0, 0.0, 1.0009}, {0.0, 0.6f, 0.8f, 0.0},
    };
    BhrSky value, before = {.struct_size = sizeof before};
    CHECK_OK(bhr_get_sky(context, &before));
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        CHECK_OK(bhr_sky_init(&value, sizeof value));
        memcpy(value.orientation, bad[i], sizeof bad[i]);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "orientation", bhr_set_sky(context, &value));
    }
    for (size_t i = 0; i < COUNT_OF(good); i++) {
        CHECK_OK(bhr_sky_init(&value, sizeof value));
        memcpy(value.orientation, good[i], sizeof good[i]);
        CHECK_OK(bhr_set_sky(context, &value));
        finite_frame(context, "orientation", i);
    }
    CHECK_OK(bhr_set_sky(context, &before));
    check_unchanged(watch, __FILE__, __LINE__, "the sky set back");
}

static void sky(Watch *watch, BhrContext *context) {
    orientations(watch, context);
    static const BadNumber bad[] = {
        {offsetof(BhrSky, stars_brightness), -1.0, "stars_brightness"},
        {offsetof(BhrSky, stars_brightness), 1.001e6, "stars_brightness"},
        {offsetof(BhrSky, stars_brightness), NAN, "stars_brightness"},
        {offsetof(BhrSky, stars_brightness), INFINITY, "stars_brightness"},
        {offsetof(BhrSky, map_brightness), -1.0, "map_brightness"},
        {offsetof(BhrSky, map_brightness), 1.001e6, "map_brightness"},
        {offsetof(BhrSky, map_brightness), NAN, "map_brightness"},
        {offsetof(BhrSky, map_brightness), INFINITY, "map_brightness"},
        {offsetof(BhrSky, orientation) + 3 * sizeof(double), 0.0, "orientation"}, /* zero length */
        {offsetof(BhrSky, orientation) + 3 * sizeof(double), 2.0, "orientation"},
        {offsetof(BhrSky, orientation), NAN, "orientation"},
        {offsetof(BhrSky, orientation) + sizeof(double), INFINITY, "orientation"},
        {offsetof(BhrSky, orientation) + 2 * sizeof(double), -INFINITY, "orientation"},
    };
    BhrSky value;
    CHECK_BAD_NUMBERS(watch, value, bad, bhr_sky_init(&value, sizeof value), bhr_set_sky(context, &value));
    CHECK_OK(bhr_sky_init(&value, sizeof value));
    CHECK(value.flags == (BHR_SKY_STARS | BHR_SKY_MILKY_WAY), "the default sky's flags are %#x", (unsigned)value.flags);
    value.flags = 0x1000;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "flags", bhr_set_sky(context, &value));
    value.flags = BHR_SKY_PROCEDURAL | 0x80000000u;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "0x80000002", bhr_set_sky(context, &value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "sky", bhr_sky_init(NULL, sizeof value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_sky_init(&value, FIRST_SKY - 1));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_sky(NULL, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_sky(NULL, &value));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "sky", bhr_get_sky(context, NULL));

    struct {
        BhrSky        known;
        unsigned char tail[16];
    } grown;
    CHECK_STRUCT_SIZES(watch, grown, FIRST_SKY, bhr_sky_init(&grown.known, size), bhr_set_sky(context, &grown.known),
                       bhr_get_sky(context, &grown.known));
    CHECK_OK(bhr_set_sky(context, NULL));
    CHECK_OK(bhr_sky_init(&value, sizeof value));
    CHECK_OK(bhr_get_sky(context, &value));
    CHECK(value.flags == 0, "a black sky has flags %#x", (unsigned)value.flags);
    static const uint64_t seeds[] = {0, 1, UINT64_MAX};
    for (size_t i = 0; i < COUNT_OF(seeds); i++) {
        CHECK_OK(bhr_sky_init(&value, sizeof value));
        value.flags = BHR_SKY_PROCEDURAL | (i % 2 ? BHR_SKY_STARS : 0), value.seed = seeds[i];
        CHECK_OK(bhr_set_sky(context, &value));
        BhrSky back;
        CHECK_OK(bhr_sky_init(&back, sizeof back));
        CHECK_OK(bhr_get_sky(context, &back));
        CHECK(back.flags == value.flags && back.seed == seeds[i], "the procedural sky %zu has flags %#x", i,
              (unsigned)back.flags);
    }
    CHECK_OK(bhr_sky_init(&value, sizeof value));
    CHECK_OK(bhr_set_sky(context, &value));
    watch_begin(watch, context);
}

static void film(Watch *watch, BhrContext *context) {
    static const BadNumber bad[] = {
        {offsetof(BhrFilm, exposure_ev), 20.01, "exposure_ev"},
        {offsetof(BhrFilm, exposure_ev), -20.01, "exposure_ev"},
        {offsetof(BhrFilm, exposure_ev), NAN, "exposure_ev"},
        {offsetof(BhrFilm, exposure_ev), INFINITY, "exposure_ev"},
        {offsetof(BhrFilm, exposure_ev), -INFINITY, "exposure_ev"},
        {offsetof(BhrFilm, exposure_ev), 1.7e308, "exposure_ev"},
        {offsetof(BhrFilm, bloom), -0.01, "bloom"},
        {offsetof(BhrFilm, bloom), 1.01, "bloom"},
        {offsetof(BhrFilm, bloom), NAN, "bloom"},
        {offsetof(BhrFilm, bloom), INFINITY, "bloom"},
        {offsetof(BhrFilm, bloom), -INFINITY, "bloom"},
        {offsetof(BhrFilm, bloom), -5e-324, "bloom"},
        {offsetof(BhrFilm, beam_fwhm), -0.01, "beam_fwhm"},
        {offsetof(BhrFilm, beam_fwhm), 1.01, "beam_fwhm"},
        {offsetof(BhrFilm, beam_fwhm), NAN, "beam_fwhm"},
        {offsetof(BhrFilm, beam_fwhm), INFINITY, "beam_fwhm"},
        {offsetof(BhrFilm, beam_fwhm), -INFINITY, "beam_fwhm"},
        {offsetof(BhrFilm, beam_fwhm), -5e-324, "beam_fwhm"},
        {offsetof(BhrFilm, white_balance), -1.0, "white_balance"},
        {offsetof(BhrFilm, white_balance), -5e-324, "white_balance"},
        {offsetof(BhrFilm, white_balance), 5e-324, "white_balance"},
        {offsetof(BhrFilm, white_balance), 1666.9, "white_balance"},
        {offsetof(BhrFilm, white_balance), 25000.1, "white_balance"},
        {offsetof(BhrFilm, white_balance), NAN, "white_balance"},
        {offsetof(BhrFilm, white_balance), INFINITY, "white_balance"},
        {offsetof(BhrFilm, white_balance), -INFINITY, "white_balance"},
        {offsetof(BhrFilm, white_balance), 1.7e308, "white_balance"},
        {offsetof(BhrFilm, tint), -1.01, "tint"},
        {offsetof(BhrFilm, tint), 1.01, "tint"},
        {offsetof(BhrFilm, tint), NAN, "tint"},
        {offsetof(BhrFilm, tint), INFINITY, "tint"},
        {offsetof(BhrFilm, tint), -INFINITY, "tint"},
        {offsetof(BhrFilm, contrast), 0.2499, "contrast"},
        {offsetof(BhrFilm, contrast), 4.01, "contrast"},
        {offsetof(BhrFilm, contrast), 0.0, "contrast"},
        {offsetof(BhrFilm, contrast), -1.0, "contrast"},
        {offsetof(BhrFilm, contrast), NAN, "contrast"},
        {offsetof(BhrFilm, contrast), INFINITY, "contrast"},
        {offsetof(BhrFilm, contrast), -INFINITY, "contrast"},
        {offsetof(BhrFilm, saturation), -0.01, "saturation"},
        {offsetof(BhrFilm, saturation), 4.01, "saturation"},
        {offsetof(BhrFilm, saturation), -5e-324, "saturation"},
        {offsetof(BhrFilm, saturation), NAN, "saturation"},
        {offsetof(BhrFilm, saturation), INFINITY, "saturation"},
        {offsetof(BhrFilm, saturation), -INFINITY, "saturation"},
        {offsetof(BhrFilm, toe_strength), -0.01, "toe_strength"},
        {offsetof(BhrFilm, toe_strength), 1.01, "toe_strength"},
        {offsetof(BhrFilm, toe_strength), NAN, "toe_strength"},
        {offsetof(BhrFilm, toe_strength), INFINITY, "toe_strength"},
        {offsetof(BhrFilm, toe_strength), -INFINITY, "toe_strength"},
        {offsetof(BhrFilm, toe_length), -0.01, "toe_length"},
        {offsetof(BhrFilm, toe_length), 1.01, "toe_length"},
        {offsetof(BhrFilm, toe_length), NAN, "toe_length"},
        {offsetof(BhrFilm, toe_length), INFINITY, "toe_length"},
        {offsetof(BhrFilm, toe_length), -INFINITY, "toe_length"},
        {offsetof(BhrFilm, shoulder_strength), -0.01, "shoulder_strength"},
        {offsetof(BhrFilm, shoulder_strength), 16.01, "shoulder_strength"},
        {offsetof(BhrFilm, shoulder_strength), NAN, "shoulder_strength"},
        {offsetof(BhrFilm, shoulder_strength), INFINITY, "shoulder_strength"},
        {offsetof(BhrFilm, shoulder_strength), -INFINITY, "shoulder_strength"},
        {offsetof(BhrFilm, shoulder_length), -0.01, "shoulder_length"},
        {offsetof(BhrFilm, shoulder_length), 1.01, "shoulder_length"},
        {offsetof(BhrFilm, shoulder_length), NAN, "shoulder_length"},
        {offsetof(BhrFilm, shoulder_length), INFINITY, "shoulder_length"},
        {offsetof(BhrFilm, shoulder_length), -INFINITY, "shoulder_length"},
        {offsetof(BhrFilm, shoulder_angle), -0.01, "shoulder_angle"},
        {offsetof(BhrFilm, shoulder_angle), 1.01, "shoulder_angle"},
        {offsetof(BhrFilm, shoulder_angle), NAN, "shoulder_angle"},
        {offsetof(BhrFilm, shoulder_angle), INFINITY, "shoulder_angle"},
        {offsetof(BhrFilm, shoulder_angle), -INFINITY, "shoulder_angle"},
        {offsetof(BhrFilm, vignette), -0.01, "vignette"},
        {offsetof(BhrFilm, vignette), 1.01, "vignette"},
        {offsetof(BhrFilm, vignette), -5e-324, "vignette"},
        {offsetof(BhrFilm, vignette), NAN, "vignette"},
        {offsetof(BhrFilm, vignette), INFINITY, "vignette"},
        {offsetof(BhrFilm, vignette), -INFINITY, "vignette"},
        {offsetof(BhrFilm, auto_exposure), -0.01, "auto_exposure"},
        {offsetof(BhrFilm, auto_exposure), 1.01, "auto_exposure"},
        {offsetof(BhrFilm, auto_exposure), NAN, "auto_exposure"},
        {offsetof(BhrFilm, auto_exposure), INFINITY, "auto_exposure"},
        {offsetof(BhrFilm, auto_exposure), -INFINITY, "auto_exposure"},
        {offsetof(BhrFilm, auto_percentile), -0.1, "auto_percentile"},
        {offsetof(BhrFilm, auto_percentile), 100.1, "auto_percentile"},
        {offsetof(BhrFilm, auto_percentile), NAN, "auto_percentile"},
        {offsetof(BhrFilm, auto_percentile), INFINITY, "auto_percentile"},
        {offsetof(BhrFilm, auto_percentile), -INFINITY, "auto_percentile"},
        {offsetof(BhrFilm, auto_target), 0.0009, "auto_target"},
        {offsetof(BhrFilm, auto_target), 1001, "auto_target"},
        {offsetof(BhrFilm, auto_target), NAN, "auto_target"},
        {offsetof(BhrFilm, auto_target), INFINITY, "auto_target"},
        {offsetof(BhrFilm, auto_target), -INFINITY, "auto_target"},
        {offsetof(BhrFilm, auto_least_ev), -20.1, "auto_least_ev"},
        {offsetof(BhrFilm, auto_least_ev), 20.1, "auto_least_ev"},
        {offsetof(BhrFilm, auto_least_ev), NAN, "auto_least_ev"},
        {offsetof(BhrFilm, auto_least_ev), INFINITY, "auto_least_ev"},
        {offsetof(BhrFilm, auto_least_ev), -INFINITY, "auto_least_ev"},
        {offsetof(BhrFilm, auto_most_ev), -20.1, "auto_most_ev"},
        {offsetof(BhrFilm, auto_most_ev), 20.1, "auto_most_ev"},
        {offsetof(BhrFilm, auto_most_ev), NAN, "auto_most_ev"},
        {offsetof(BhrFilm, auto_most_ev), INFINITY, "auto_most_ev"},
        {offsetof(BhrFilm, auto_most_ev), -INFINITY, "auto_most_ev"},
        {offsetof(BhrFilm, auto_adaptation), 0.0, "auto_adaptation"},
        {offsetof(BhrFilm, auto_adaptation), 1.01, "auto_adaptation"},
        {offsetof(BhrFilm, auto_adaptation), NAN, "auto_adaptation"},
        {offsetof(BhrFilm, auto_adaptation), INFINITY, "auto_adaptation"},
        {offsetof(BhrFilm, auto_adaptation), -INFINITY, "auto_adaptation"},
        {offsetof(BhrFilm, highlights), -0.01, "highlights"},
        {offsetof(BhrFilm, highlights), 1.01, "highlights"},
        {offsetof(BhrFilm, highlights), NAN, "highlights"},
        {offsetof(BhrFilm, highlights), INFINITY, "highlights"},
        {offsetof(BhrFilm, highlights), -INFINITY, "highlights"},
        {offsetof(BhrFilm, shadows), -0.01, "shadows"},
        {offsetof(BhrFilm, shadows), 1.01, "shadows"},
        {offsetof(BhrFilm, shadows), NAN, "shadows"},
        {offsetof(BhrFilm, shadows), INFINITY, "shadows"},
        {offsetof(BhrFilm, shadows), -INFINITY, "shadows"},
        {offsetof(BhrFilm, grain), -0.01, "grain"},
        {offsetof(BhrFilm, grain), 1.01, "grain"},
        {offsetof(BhrFilm, grain), NAN, "grain"},
        {offsetof(BhrFilm, grain), INFINITY, "grain"},
        {offsetof(BhrFilm, grain), -INFINITY, "grain"},
        {offsetof(BhrFilm, grain_seed), -1.1e15, "grain_seed"},
        {offsetof(BhrFilm, grain_seed), 1.1e15, "grain_seed"},
        {offsetof(BhrFilm, grain_seed), NAN, "grain_seed"},
        {offsetof(BhrFilm, grain_seed), INFINITY, "grain_seed"},
        {offsetof(BhrFilm, grain_seed), -INFINITY, "grain_seed"},
        {offsetof(BhrFilm, lut_strength), -0.01, "lut_strength"},
        {offsetof(BhrFilm, lut_strength), 1.01, "lut_strength"},
        {offsetof(BhrFilm, lut_strength), -5e-324, "lut_strength"},
        {offsetof(BhrFilm, lut_strength), NAN, "lut_strength"},
        {offsetof(BhrFilm, lut_strength), INFINITY, "lut_strength"},
        {offsetof(BhrFilm, lut_strength), -INFINITY, "lut_strength"},
        {offsetof(BhrFilm, spikes), -0.001, "spikes"},
        {offsetof(BhrFilm, spikes), 1.001, "spikes"},
        {offsetof(BhrFilm, spikes), NAN, "spikes"},
        {offsetof(BhrFilm, spikes), INFINITY, "spikes"},
        {offsetof(BhrFilm, spikes), -INFINITY, "spikes"},
        {offsetof(BhrFilm, spike_angle), -6.2842, "spike_angle"},
        {offsetof(BhrFilm, spike_angle), 6.2842, "spike_angle"},
        {offsetof(BhrFilm, spike_angle), NAN, "spike_angle"},
        {offsetof(BhrFilm, spike_angle), INFINITY, "spike_angle"},
        {offsetof(BhrFilm, spike_angle), -INFINITY, "spike_angle"},
        {offsetof(BhrFilm, spike_length), 0.009, "spike_length"},
        {offsetof(BhrFilm, spike_length), 2.001, "spike_length"},
        {offsetof(BhrFilm, spike_length), NAN, "spike_length"},
        {offsetof(BhrFilm, spike_length), INFINITY, "spike_length"},
        {offsetof(BhrFilm, spike_length), -INFINITY, "spike_length"},
        {offsetof(BhrFilm, streak), -0.001, "streak"},
        {offsetof(BhrFilm, streak), 1.001, "streak"},
        {offsetof(BhrFilm, streak), NAN, "streak"},
        {offsetof(BhrFilm, streak), INFINITY, "streak"},
        {offsetof(BhrFilm, streak), -INFINITY, "streak"},
        {offsetof(BhrFilm, streak_length), 0.009, "streak_length"},
        {offsetof(BhrFilm, streak_length), 4.001, "streak_length"},
        {offsetof(BhrFilm, streak_length), NAN, "streak_length"},
        {offsetof(BhrFilm, streak_length), INFINITY, "streak_length"},
        {offsetof(BhrFilm, streak_length), -INFINITY, "streak_length"},
        {offsetof(BhrFilm, streak_tint), -1.001, "streak_tint"},
        {offsetof(BhrFilm, streak_tint), 1.001, "streak_tint"},
        {offsetof(BhrFilm, streak_tint), NAN, "streak_tint"},
        {offsetof(BhrFilm, streak_tint), INFINITY, "streak_tint"},
        {offsetof(BhrFilm, streak_tint), -INFINITY, "streak_tint"},
        {offsetof(BhrFilm, paper_white), 9.99, "paper_white"},
        {offsetof(BhrFilm, paper_white), 1000.1, "paper_white"},
        {offsetof(BhrFilm, paper_white), NAN, "paper_white"},
        {offsetof(BhrFilm, paper_white), INFINITY, "paper_white"},
        {offsetof(BhrFilm, paper_white), -INFINITY, "paper_white"},
        {offsetof(BhrFilm, peak), 99.99, "peak"},
        {offsetof(BhrFilm, peak), 10000.1, "peak"},
        {offsetof(BhrFilm, peak), NAN, "peak"},
        {offsetof(BhrFilm, peak), INFINITY, "peak"},
        {offsetof(BhrFilm, peak), -INFINITY, "peak"},
        {offsetof(BhrFilm, flare), -0.001, "flare"},
        {offsetof(BhrFilm, flare), 1.001, "flare"},
        {offsetof(BhrFilm, flare), NAN, "flare"},
        {offsetof(BhrFilm, flare), INFINITY, "flare"},
        {offsetof(BhrFilm, flare), -INFINITY, "flare"},
    };
    BhrFilm value;
    CHECK_BAD_NUMBERS(watch, value, bad, bhr_film_init(&value, sizeof value), bhr_set_film(context, &value));
    static const int32_t unknown[] = {-1, 4, 99, INT32_MIN, INT32_MAX};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        CHECK_OK(bhr_film_init(&value, sizeof value));
        value.tone_map = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "tone_map", bhr_set_film(context, &value));
        CHECK_OK(bhr_film_init(&value, sizeof value));
        value.colour_map = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "colour_map", bhr_set_film(context, &value));
    }
    static const uint32_t blades[] = {1, 2, 9, 1000, UINT32_MAX};
    for (size_t i = 0; i < COUNT_OF(blades); i++) {
        CHECK_OK(bhr_film_init(&value, sizeof value));
        value.spike_blades = blades[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "spike_blades", bhr_set_film(context, &value));
    }
    static const uint32_t ghosts[] = {9, 1000, UINT32_MAX};
    for (size_t i = 0; i < COUNT_OF(ghosts); i++) {
        CHECK_OK(bhr_film_init(&value, sizeof value));
        value.flare_ghosts = ghosts[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "flare_ghosts", bhr_set_film(context, &value));
        CHECK_OK(bhr_film_init(&value, sizeof value));
        value.reserved = ghosts[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "reserved", bhr_set_film(context, &value));
    }
    /* At the limits: from black to white, under every tone map. */
    for (int32_t tone_map = BHR_TONE_MAP_NONE; tone_map <= BHR_TONE_MAP_FILMIC; tone_map++) {
        static const double stops[] = {-20.0, 20.0};
        unsigned            sums[2];
        for (size_t i = 0; i < COUNT_OF(stops); i++) {
            static unsigned char pixels[WATCH_WIDTH * WATCH_HEIGHT * 4];
            const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WATCH_WIDTH, WATCH_HEIGHT, pixels, sizeof pixels);
            CHECK_OK(bhr_film_init(&value, sizeof value));
            value.tone_map = tone_map;
            value.exposure_ev = stops[i];
            CHECK_OK(bhr_set_film(context, &value));
            CHECK_OK(bhr_render_image(context, &image));
            sums[i] = 0;
            for (size_t k = 0; k < sizeof pixels; k++) {
                sums[i] += k % 4 < 3 ? pixels[k] : 0;
            }
        }
        CHECK(sums[0] < WATCH_WIDTH * WATCH_HEIGHT * 3 && sums[1] > 10 * sums[0] + 10000, "tone map %d: %u, %u",
              (int)tone_map, sums[0], sums[1]);
    }
    CHECK_OK(bhr_film_init(&value, sizeof value));
    value.bloom = 0.0; /* as the contexts of these tests have it */
    CHECK_OK(bhr_set_film(context, &value));
    check_unchanged(watch, __FILE__, __LINE__, "the film set back");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "film", bhr_film_init(NULL, sizeof value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_film(NULL, &value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_film(NULL, &value));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "film", bhr_set_film(context, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "film", bhr_get_film(context, NULL));
    struct {
        BhrFilm       known;
        unsigned char tail[16];
    } grown;
    CHECK_STRUCT_SIZES(watch, grown, FIRST_FILM, bhr_film_init(&grown.known, size), bhr_set_film(context, &grown.known),
                       bhr_get_film(context, &grown.known));
}

static void quality(Watch *watch, BhrContext *context) {
    static const BadNumber bad[] = {
        {offsetof(BhrQuality, step), -0.1, "step"},
        {offsetof(BhrQuality, step), 0.9e-3, "step"},
        {offsetof(BhrQuality, step), 5e-324, "step"},
        {offsetof(BhrQuality, step), 0.51, "step"},
        {offsetof(BhrQuality, step), NAN, "step"},
        {offsetof(BhrQuality, step), INFINITY, "step"},
        {offsetof(BhrQuality, step), -INFINITY, "step"},
        {offsetof(BhrQuality, tolerance), -1e-6, "tolerance"},
        {offsetof(BhrQuality, tolerance), 0.9e-14, "tolerance"},
        {offsetof(BhrQuality, tolerance), 1.1e-3, "tolerance"},
        {offsetof(BhrQuality, tolerance), NAN, "tolerance"},
        {offsetof(BhrQuality, tolerance), INFINITY, "tolerance"},
        {offsetof(BhrQuality, tolerance), -INFINITY, "tolerance"},
        {offsetof(BhrQuality, render_scale), 0.0, "render_scale"},
        {offsetof(BhrQuality, render_scale), 0.09, "render_scale"},
        {offsetof(BhrQuality, render_scale), 1.01, "render_scale"},
        {offsetof(BhrQuality, render_scale), NAN, "render_scale"},
        {offsetof(BhrQuality, render_scale), INFINITY, "render_scale"},
        {offsetof(BhrQuality, render_scale), -INFINITY, "render_scale"},
    };
    static const struct {
        size_t      offset;
        uint32_t    value;
        const char *name;
    } whole[] = {
        {offsetof(BhrQuality, method), 3, "method"},
        {offsetof(BhrQuality, method), 0xFFFFFFFFu, "method"},
        {offsetof(BhrQuality, samples_per_pixel), 0, "samples_per_pixel"},
        {offsetof(BhrQuality, samples_per_pixel), 257, "samples_per_pixel"},
        {offsetof(BhrQuality, samples_per_pixel), 0xFFFFFFFFu, "samples_per_pixel"},
        {offsetof(BhrQuality, max_steps), 0, "max_steps"},
        {offsetof(BhrQuality, max_steps), 15, "max_steps"},
        {offsetof(BhrQuality, max_steps), 100001, "max_steps"},
        {offsetof(BhrQuality, max_steps), 0xFFFFFFFFu, "max_steps"},
        {offsetof(BhrQuality, max_disk_order), 16, "max_disk_order"},
        {offsetof(BhrQuality, max_disk_order), 0xFFFFFFFFu, "max_disk_order"},
        {offsetof(BhrQuality, reserved), 1, "reserved is 1"},
        {offsetof(BhrQuality, volume_resolution), 2, "volume_resolution is 2"},
        {offsetof(BhrQuality, volume_resolution), 0xFFFFFFFFu, "volume_resolution is -1"},
        {offsetof(BhrQuality, reserved2), 1, "reserved2 is 1"},
        {offsetof(BhrQuality, reserved2), 0xFFFFFFFFu, "reserved2 is 4294967295"},
    };
    BhrQuality value;
    CHECK_BAD_NUMBERS(watch, value, bad, bhr_quality_init(&value, sizeof value), bhr_set_quality(context, &value));
    for (size_t i = 0; i < COUNT_OF(whole); i++) {
        CHECK_OK(bhr_quality_init(&value, sizeof value));
        memcpy((char *)&value + whole[i].offset, &whole[i].value, sizeof whole[i].value);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, whole[i].name, bhr_set_quality(context, &value));
    }
    /* At the limits: the coarsest and the finest of each method. */
    static const struct {
        BhrMethod method;
        uint32_t  samples, max_steps, order;
        double    step, tolerance, scale;
    } limits[] = {
        {BHR_METHOD_AUTO, 1, 16, 0, 0.0, 0.0, 0.1},       {BHR_METHOD_AUTO, 256, 100000, 15, 0.0, 0.0, 1.0},
        {BHR_METHOD_RK4, 1, 16, 15, 0.5, 0.0, 1.0},       {BHR_METHOD_RK4, 1, 100000, 15, 1e-3, 0.0, 1.0},
        {BHR_METHOD_ADAPTIVE, 1, 16, 15, 0.0, 1e-3, 1.0}, {BHR_METHOD_ADAPTIVE, 1, 100000, 15, 0.0, 1e-14, 1.0},
    };
    for (size_t i = 0; i < COUNT_OF(limits); i++) {
        CHECK_OK(bhr_quality_init(&value, sizeof value));
        value.method = limits[i].method;
        value.samples_per_pixel = limits[i].samples;
        value.max_steps = limits[i].max_steps;
        value.max_disk_order = limits[i].order;
        value.step = limits[i].step;
        value.tolerance = limits[i].tolerance;
        value.render_scale = limits[i].scale;
        CHECK_OK(bhr_set_quality(context, &value));
        finite_frame(context, "quality", i);
    }
    /* A struct of 0.1.0 says nothing of volumes, which are then at full resolution. */
    CHECK_OK(bhr_quality_init(&value, sizeof value));
    CHECK(value.volume_resolution == BHR_VOLUME_RESOLUTION_FULL, "the default resolution is %d",
          value.volume_resolution);
    value.volume_resolution = BHR_VOLUME_RESOLUTION_HALF;
    CHECK_OK(bhr_set_quality(context, &value));
    finite_frame(context, "quality", COUNT_OF(limits));
    CHECK_OK(bhr_quality_init(&value, sizeof value));
    CHECK_OK(bhr_get_quality(context, &value));
    CHECK(value.volume_resolution == BHR_VOLUME_RESOLUTION_HALF, "the resolution that was set is %d",
          value.volume_resolution);
    value.struct_size = FIRST_QUALITY;
    CHECK_OK(bhr_set_quality(context, &value));
    value.struct_size = sizeof value;
    CHECK_OK(bhr_get_quality(context, &value));
    CHECK(value.volume_resolution == BHR_VOLUME_RESOLUTION_FULL, "a struct of 0.1.0 sets the resolution %d",
          value.volume_resolution);
    CHECK_OK(bhr_quality_init(&value, sizeof value));
    CHECK_OK(bhr_set_quality(context, &value));
    check_unchanged(watch, __FILE__, __LINE__, "the quality set back");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "quality", bhr_quality_init(NULL, sizeof value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_quality(NULL, &value));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_quality(NULL, &value));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "quality", bhr_set_quality(context, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "quality", bhr_get_quality(context, NULL));
    struct {
        BhrQuality    known;
        unsigned char tail[16];
    } grown;
    CHECK_STRUCT_SIZES(watch, grown, FIRST_QUALITY, bhr_quality_init(&grown.known, size),
                       bhr_set_quality(context, &grown.known), bhr_get_quality(context, &grown.known));
}

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    static Watch watch;
    watch_unusual_scene(&watch, context);
    disk(&watch, context);
    sky(&watch, context);
    film(&watch, context);
    quality(&watch, context);
    bhr_context_destroy(context);
    return check_end();
}
