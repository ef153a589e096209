/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* presets.c -- bhr_set_preset and bhr_set_preset_with: the values that docs/presets.md states, and nothing else;
 * setters change them; whose volumes leave with a look; a choice that is measured; bad input is refused. */
#include "check.h"
#include "refusals.h"

typedef struct Look {
    BhrPreset    preset;
    double       outer_radius, temperature, brightness, turbulence, edge_softness;
    int32_t      reference;
    uint32_t     sky_flags;
    BhrToneMap   tone_map;
    double       exposure_ev, bloom, beam_fwhm;
    BhrColourMap colour_map;
    uint32_t     effects;
} Look;

/* The table of docs/presets.md. */
static const Look LOOKS[] = {
    {BHR_PRESET_CINEMATIC, 17.0, 3500.0, 0.6, 1.0, 0.4, BHR_DISK_AT_MEDIAN, BHR_SKY_STARS |
     BHR_SKY_MILKY_WAY,
     BHR_TONE_MAP_ACES, 0.0, 0.25, 0.0, BHR_COLOUR_MAP_NONE, BHR_EFFECT_ALL},
    {BHR_PRESET_PHYSICAL, 20.0, 6500.0, 1.0, 0.0, 0.0, BHR_DISK_AT_MEDIAN, BHR_SKY_STARS | BHR_SKY_MILKY_WAY,
     BHR_TONE_MAP_NONE, -2.0, 0.0, 0.0, BHR_COLOUR_MAP_NONE, BHR_EFFECT_ALL},
    {BHR_PRESET_OBSERVATORY, 12.0, 15000.0, 1.0, 0.0, 0.0, BHR_DISK_AT_MEDIAN, 0, BHR_TONE_MAP_NONE, -0.5, 0.0, 0.15,
     BHR_COLOUR_MAP_AFMHOT, BHR_EFFECT_ALL},
    {BHR_PRESET_TEACHING, 12.0, 5000.0, 0.8, 0.0, 0.0, BHR_DISK_AT_MEDIAN, BHR_SKY_GRID, BHR_TONE_MAP_NONE, 0.0, 0.0,
     0.0, BHR_COLOUR_MAP_NONE, BHR_EFFECT_DOPPLER_SHIFT | BHR_EFFECT_GRAVITY_SHIFT},
};

/* A scene of which nothing has a default: presets must leave part of it alone. */
static void set_odd_scene(BhrContext *context) {
    BhrDisk disk;
    BhrSky  sky;
    BhrFilm film;
    CHECK_OK(bhr_set_mass(context, 2.0));
    CHECK_OK(bhr_set_spin(context, 0.5));
    CHECK_OK(bhr_disk_init(&disk, sizeof disk));
    disk.flags = BHR_DISK_RETROGRADE, disk.inner_radius = 7.0, disk.opacity = 0.3, disk.seed = 9;
    CHECK_OK(bhr_set_disk(context, &disk));
    CHECK_OK(bhr_sky_init(&sky, sizeof sky));
    sky.flags = BHR_SKY_MAP, sky.stars_brightness = 3.0, sky.map_brightness = 4.0, sky.seed = 5;
    sky.orientation[0] = 0.6, sky.orientation[3] = 0.8;
    CHECK_OK(bhr_set_sky(context, &sky));
    CHECK_OK(bhr_film_init(&film, sizeof film));
    film.bloom = 0.7, film.exposure_ev = 3.0, film.beam_fwhm = 0.4;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_set_effects(context, 0));
    CHECK_OK(bhr_set_effect_strength(context, BHR_EFFECT_DOPPLER_SHIFT | BHR_EFFECT_BEAMING, 0.3));
}

static void states_what_the_header_states(BhrContext *context) {
    for (size_t i = 0; i < COUNT_OF(LOOKS); i++) {
        const Look *look = &LOOKS[i];
        Watch       odd, now;
        uint32_t    effects = 0;
        set_odd_scene(context);
        watch_begin(&odd, context);
        CHECK_OK(bhr_set_preset(context, look->preset));
        watch_begin(&now, context);
        CHECK_OK(bhr_get_effects(context, &effects));
        const BhrDisk *disk = &now.disk;
        CHECK(now.disk_present == 1 && disk->flags == 0 && disk->inner_radius == 0.0 && disk->opacity == 1.0 &&
                  disk->seed == 0,
              "preset %d: the disk", (int)look->preset);
        CHECK(disk->outer_radius == look->outer_radius && disk->temperature == look->temperature &&
                  disk->brightness == look->brightness && disk->turbulence == look->turbulence &&
                  disk->edge_softness == look->edge_softness && disk->reference == look->reference,
              "preset %d: the disk's numbers", (int)look->preset);
        CHECK(now.film.tone_map == look->tone_map && now.film.exposure_ev == look->exposure_ev &&
                  now.film.bloom == look->bloom && now.film.beam_fwhm == look->beam_fwhm &&
                  now.film.colour_map == look->colour_map,
              "preset %d: the film", (int)look->preset);
        CHECK(effects == look->effects, "preset %d: the effects are %#x", (int)look->preset, (unsigned)effects);
        CHECK(now.effect_strengths[0] == 1.0 && now.effect_strengths[2] == 1.0, "preset %d: the strengths",
              (int)look->preset);
        CHECK(now.sky.flags == look->sky_flags && now.sky.stars_brightness == 1.0 && now.sky.map_brightness == 1.0,
              "preset %d: the sky", (int)look->preset);
        CHECK(now.sky.seed == 5 && memcmp(now.sky.orientation, odd.sky.orientation, sizeof odd.sky.orientation) == 0,
              "preset %d: the sky's orientation and seed", (int)look->preset);
        CHECK(now.mass == odd.mass && now.spin == odd.spin &&
                  memcmp(&now.camera, &odd.camera, sizeof now.camera) == 0 &&
                  memcmp(&now.quality, &odd.quality, sizeof now.quality) == 0,
              "preset %d changes the hole, the camera or the quality", (int)look->preset);
        CHECK(now.frame_status == BHR_OK, "preset %d: no frame: %s", (int)look->preset, bhr_error_message());
    }
}

/* Each has a picture of its own, with something in it; and the same one again, whatever was set between. */
static void pictures(BhrContext *context) {
    static Watch shown[COUNT_OF(LOOKS)], again;
    for (size_t i = 0; i < COUNT_OF(LOOKS); i++) {
        CHECK_OK(bhr_set_preset(context, LOOKS[i].preset));
        watch_begin(&shown[i], context);
        int most = 0;
        for (size_t k = 0; k < sizeof shown[i].frame; k++) {
            most = k % 4 < 3 && shown[i].frame[k] > most ? shown[i].frame[k] : most;
        }
        CHECK(most > 100, "preset %d: the brightest byte is %d", (int)LOOKS[i].preset, most);
        for (size_t k = 0; k < i; k++) {
            CHECK(memcmp(shown[i].frame, shown[k].frame, sizeof shown[i].frame) != 0, "presets %d and %d are alike",
                  (int)LOOKS[i].preset, (int)LOOKS[k].preset);
        }
    }
    BhrFilm film = {.struct_size = sizeof film};
    CHECK_OK(bhr_set_preset(context, BHR_PRESET_PHYSICAL));
    CHECK_OK(bhr_get_film(context, &film));
    film.exposure_ev = 2.0; /* setters change what a preset has set */
    CHECK_OK(bhr_set_film(context, &film));
    watch_begin(&again, context);
    CHECK(memcmp(again.frame, shown[1].frame, sizeof again.frame) != 0, "exposure changes nothing after a preset");
    CHECK_OK(bhr_set_preset(context, BHR_PRESET_PHYSICAL));
    watch_begin(&again, context);
    CHECK(memcmp(again.frame, shown[1].frame, sizeof again.frame) == 0, "a preset has two pictures");
}

/* ---- matter with depth ---- */

static BhrPresetOptions options_for(BhrPresetMatter matter) {
    BhrPresetOptions options;
    CHECK_OK(bhr_preset_options_init(&options, sizeof options));
    CHECK(options.struct_size == sizeof options && options.matter == BHR_PRESET_MATTER_AUTO && options.width == 1920 &&
              options.height == 1080 && options.frame_ms == 16.0 && options.measure_anew == 0 &&
              options.may_halve == 0,
          "other defaults than bhr.h states");
    options.matter = matter;
    return options;
}

/* The second table of docs/presets.md. */
static BhrVolume volume_of(BhrPreset preset) {
    BhrVolume volume;
    CHECK_OK(bhr_volume_init(&volume, sizeof volume));
    volume.turbulence = 0.0;
    switch (preset) {
    case BHR_PRESET_CINEMATIC: volume.brightness = 1.4, volume.turbulence = 1.0; break;
    case BHR_PRESET_PHYSICAL:
        volume.temperature = 9000.0, volume.temperature_slope = 0.75, volume.brightness = 7.0;
        break;
    default:
        volume.flags = BHR_VOLUME_POWER_LAW, volume.shape = BHR_VOLUME_TORUS;
        volume.outer_radius = 20.0, volume.radius = 5.0, volume.thickness = 0.4, volume.absorption = 0.05;
        volume.brightness = 0.6, volume.sub_keplerian = 0.8, volume.infall = 0.2;
        break;
    }
    return volume;
}

/* A volume instead of the disk, and all else as without; the same picture each time. */
static void looks_with_depth(BhrContext *context) {
    const BhrPresetOptions deep = options_for(BHR_PRESET_MATTER_DEEP), thin = options_for(BHR_PRESET_MATTER_THIN);
    for (size_t i = 0; i < COUNT_OF(LOOKS); i++) {
        const BhrPreset preset = LOOKS[i].preset;
        const int       has_depth = preset != BHR_PRESET_TEACHING;
        static Watch    without, with, again;
        BhrPresetMatter matter = 77;
        CHECK_OK(bhr_set_preset_with(context, preset, &thin, &matter));
        CHECK(matter == BHR_PRESET_MATTER_THIN, "preset %d: THIN gives %d", (int)preset, (int)matter);
        watch_begin(&without, context);
        CHECK(without.disk_present == 1 && without.volume_count == 0, "preset %d: THIN is not thin", (int)preset);
        CHECK_OK(bhr_set_preset(context, preset));
        CHECK(check_unchanged(&without, __FILE__, __LINE__, "bhr_set_preset"), "THIN is another look");
        CHECK_OK(bhr_set_preset_with(context, preset, &deep, &matter));
        CHECK(matter == (has_depth ? BHR_PRESET_MATTER_DEEP : BHR_PRESET_MATTER_THIN), "preset %d: DEEP gives %d",
              (int)preset, (int)matter);
        watch_begin(&with, context);
        CHECK(with.disk_present == !has_depth && with.volume_count == (uint32_t)has_depth, "preset %d: its matter",
              (int)preset);
        CHECK(memcmp(&with.film, &without.film, sizeof with.film) == 0 &&
                  memcmp(&with.sky, &without.sky, sizeof with.sky) == 0,
              "preset %d: film or sky change with depth", (int)preset);
        CHECK((memcmp(with.frame, without.frame, sizeof with.frame) == 0) == !has_depth, "preset %d: the picture",
              (int)preset);
        if (has_depth) {
            const BhrVolume stated = volume_of(preset);
            CHECK(memcmp(&with.volumes[0], &stated, sizeof stated) == 0, "preset %d: the volume", (int)preset);
        }
        set_odd_scene(context);
        CHECK_OK(bhr_set_mass(context, without.mass));
        CHECK_OK(bhr_set_spin(context, without.spin));
        CHECK_OK(bhr_set_sky(context, &without.sky));
        CHECK_OK(bhr_set_preset_with(context, preset, &deep, NULL)); /* out_matter may be NULL */
        watch_begin(&again, context);
        CHECK(memcmp(again.frame, with.frame, sizeof with.frame) == 0, "preset %d: two pictures", (int)preset);
    }
}

/* A volume that a preset set leaves with its look, also after it was read and set as it is; the host's own stay. */
static void whose_volumes(BhrContext *context) {
    const BhrPresetOptions deep = options_for(BHR_PRESET_MATTER_DEEP), thin = options_for(BHR_PRESET_MATTER_THIN);
    const BhrVolume        own = volume_of(BHR_PRESET_OBSERVATORY);
    BhrVolume              volume;
    uint32_t               count;
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_CINEMATIC, &deep, NULL));
    CHECK_OK(bhr_get_volumes(context, &volume, sizeof volume, 1, &count));
    CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, count));
    CHECK_OK(bhr_set_preset(context, BHR_PRESET_CINEMATIC));
    CHECK_OK(bhr_get_volumes(context, NULL, 0, 0, &count));
    CHECK(count == 0, "a preset's volume stays after its look");
    CHECK_OK(bhr_set_volumes(context, &own, sizeof own, 1));
    CHECK_OK(bhr_set_preset(context, BHR_PRESET_PHYSICAL));
    CHECK_OK(bhr_get_volumes(context, &volume, sizeof volume, 1, &count));
    CHECK(count == 1 && memcmp(&volume, &own, sizeof own) == 0, "bhr_set_preset takes the host's volume");
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_CINEMATIC, &deep, NULL));
    CHECK_OK(bhr_get_volumes(context, &volume, sizeof volume, 1, &count));
    volume.absorption = 1.0;
    CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, 1));
    CHECK_OK(bhr_set_preset(context, BHR_PRESET_PHYSICAL));
    CHECK_OK(bhr_get_volumes(context, NULL, 0, 0, &count));
    CHECK(count == 1, "bhr_set_preset takes a volume that the host changed");
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_OBSERVATORY, &deep, NULL));
    CHECK_OK(bhr_set_volumes(context, NULL, sizeof volume, 0));
    CHECK_OK(bhr_set_volumes(context, &own, sizeof own, 1));
    CHECK_OK(bhr_set_preset(context, BHR_PRESET_PHYSICAL));
    CHECK_OK(bhr_get_volumes(context, NULL, 0, 0, &count));
    CHECK(count == 1, "bhr_set_preset takes the host's volume, set after the preset's was removed");
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_PHYSICAL, &thin, NULL));
    CHECK_OK(bhr_get_volumes(context, NULL, 0, 0, &count));
    CHECK(count == 0, "THIN leaves a volume");
}

static int32_t resolution_of(BhrContext *context) {
    BhrQuality quality = {.struct_size = sizeof quality};
    CHECK_OK(bhr_get_quality(context, &quality));
    return quality.volume_resolution;
}

/* Where it may, AUTO sets the resolution that depth fits with, and leaves it where none does. */
static void halved_choices(BhrContext *context) {
    BhrPresetOptions options = options_for(BHR_PRESET_MATTER_AUTO);
    BhrPresetMatter  matter = 77;
    BhrQuality       quality = {.struct_size = sizeof quality}, before = quality;
    CHECK_OK(bhr_get_quality(context, &before));
    quality = before, quality.volume_resolution = BHR_VOLUME_RESOLUTION_HALF;
    CHECK_OK(bhr_set_quality(context, &quality));
    options.may_halve = 1, options.frame_ms = 1e-3, options.width = options.height = 1u << 20;
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_OBSERVATORY, &options, &matter));
    CHECK(matter == BHR_PRESET_MATTER_THIN && resolution_of(context) == BHR_VOLUME_RESOLUTION_HALF,
          "too slow at any resolution: matter %d, resolution %d", (int)matter, (int)resolution_of(context));
    options.frame_ms = 1e9, options.width = options.height = 1, options.measure_anew = 1;
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_OBSERVATORY, &options, &matter));
    CHECK(matter == BHR_PRESET_MATTER_DEEP && resolution_of(context) == BHR_VOLUME_RESOLUTION_FULL,
          "time enough: matter %d, resolution %d", (int)matter, (int)resolution_of(context));
    /* A host that was compiled before has no such fields. */
    CHECK_OK(bhr_set_quality(context, &quality));
    options.struct_size = 24, options.may_halve = options.measure_anew = 99;
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_OBSERVATORY, &options, &matter));
    CHECK(matter == BHR_PRESET_MATTER_DEEP && resolution_of(context) == BHR_VOLUME_RESOLUTION_HALF,
          "an older host: matter %d, resolution %d", (int)matter, (int)resolution_of(context));
    CHECK_OK(bhr_set_quality(context, &before));
}

/* AUTO takes depth where there is time for it, by frames that nothing counts. */
static void choices(BhrContext *context) {
    BhrPresetOptions options = options_for(BHR_PRESET_MATTER_AUTO);
    BhrPresetMatter  matter = 77;
    BhrFrameStats    before = {.struct_size = sizeof before}, after = before;
    CHECK_OK(bhr_frame_stats(context, &before));
    options.frame_ms = 1e9, options.width = options.height = 1;
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_OBSERVATORY, &options, &matter));
    CHECK(matter == BHR_PRESET_MATTER_DEEP, "a pixel in 11 days is thin");
    options.frame_ms = 1e-3, options.width = options.height = 1u << 20;
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_OBSERVATORY, &options, &matter));
    CHECK(matter == BHR_PRESET_MATTER_THIN, "2^40 pixels in a microsecond are deep");
    options.frame_ms = 1e9, options.width = options.height = 0;
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_OBSERVATORY, &options, &matter));
    CHECK(matter == BHR_PRESET_MATTER_DEEP, "1920 x 1080 in 11 days is thin");
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_OBSERVATORY, NULL, &matter)); /* known by now */
    CHECK(matter == BHR_PRESET_MATTER_DEEP || matter == BHR_PRESET_MATTER_THIN, "no choice: %d", (int)matter);
    halved_choices(context);
    CHECK_OK(bhr_frame_stats(context, &after));
    CHECK(after.frame_index == before.frame_index, "frames that were timed are counted");
}

static void refused_options(BhrContext *context) {
    static const double   times[] = {-1.0, 9e-4, 1.1e9, NAN, INFINITY, -INFINITY};
    static const uint32_t sides[] = {(1u << 20) + 1, UINT32_MAX};
    static const int32_t  matters[] = {-1, 3, INT32_MIN, INT32_MAX};
    static const uint32_t flags[] = {2, UINT32_MAX};
    static const uint32_t sizes[] = {0, 4, 23, 1u << 20, UINT32_MAX}; /* 24 without may_halve and measure_anew */
    struct {
        BhrPresetOptions known;
        unsigned char    tail[8];
    } grown;
    Watch            watch;
    BhrPresetOptions options = options_for(BHR_PRESET_MATTER_DEEP);
    BhrPresetMatter  matter = 77;
    watch_begin(&watch, context);
#define REFUSED(words)                                                                                                 \
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, words,                                                           \
                  bhr_set_preset_with(context, BHR_PRESET_PHYSICAL, &options, &matter));                               \
    CHECK(matter == 0, "out_matter is %d after an error", (int)matter);                                                \
    options = options_for(BHR_PRESET_MATTER_DEEP), matter = 77
    for (size_t i = 0; i < COUNT_OF(times); i++) {
        options.frame_ms = times[i];
        REFUSED("frame_ms");
    }
    for (size_t i = 0; i < COUNT_OF(sides); i++) {
        options.width = sides[i];
        REFUSED("width");
        options.height = sides[i];
        REFUSED("height");
    }
    for (size_t i = 0; i < COUNT_OF(flags); i++) {
        options.measure_anew = flags[i];
        REFUSED("measure_anew");
        options.may_halve = flags[i];
        REFUSED("may_halve");
    }
    for (size_t i = 0; i < COUNT_OF(matters); i++) {
        options.matter = matters[i];
        REFUSED("matter");
    }
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        options.struct_size = sizes[i];
        REFUSED("struct_size");
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_preset_options_init(&options, sizes[i]));
    }
    options = options_for(BHR_PRESET_MATTER_DEEP);
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "preset", bhr_set_preset_with(context, 4, &options, NULL));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "preset", bhr_set_preset_with(context, -1, NULL, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_preset_with(NULL, 0, &options, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "options", bhr_preset_options_init(NULL, sizeof options));
    /* A longer struct of a later release, as long as what this one does not know is 0. */
    memset(&grown, 0, sizeof grown);
    grown.known = options, grown.known.struct_size = sizeof grown;
    grown.tail[7] = 1;
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size",
                  bhr_set_preset_with(context, BHR_PRESET_PHYSICAL, &grown.known, NULL));
    grown.tail[7] = 0;
    CHECK_OK(bhr_set_preset_with(context, BHR_PRESET_PHYSICAL, &grown.known, &matter));
    CHECK(matter == BHR_PRESET_MATTER_DEEP, "a longer struct gives %d", (int)matter);
}

static void refusals(BhrContext *context) {
    static const int32_t unknown[] = {-1, 4, 99, INT32_MIN, INT32_MAX};
    Watch                watch;
    watch_begin(&watch, context);
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "preset", bhr_set_preset(context, unknown[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_preset(NULL, BHR_PRESET_PHYSICAL));
}

/* A new context has the cinematic look. Frames of a region cannot have its glare, and do without it, until the host
 * states a film of its own. */
static void new_contexts(BhrBackend backend) {
    enum { WIDTH = 40, HEIGHT = 24 };
    static unsigned char    pixels[WIDTH * HEIGHT * 4];
    const BhrContextOptions options = check_options(backend);
    const BhrImage          image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    const BhrRegion         region = {.struct_size = sizeof region, .full_width = 2 * WIDTH, .full_height = HEIGHT};
    static Watch            fresh, set;
    BhrFilm                 film = {.struct_size = sizeof film};
    BhrContext             *context = NULL;
    CHECK_OK(bhr_context_create(BHR_ABI_VERSION, &options, &context));
    watch_begin(&fresh, context);
    CHECK(fresh.disk.temperature == LOOKS[0].temperature && fresh.film.bloom == LOOKS[0].bloom, "another look");
    CHECK_OK(bhr_set_preset(context, BHR_PRESET_CINEMATIC));
    watch_begin(&set, context);
    CHECK(memcmp(fresh.frame, set.frame, sizeof set.frame) == 0, "a new context has not the cinematic picture");
    CHECK_OK(bhr_set_region(context, &region));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK_OK(bhr_get_film(context, &film));
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "bloom is 0.25", bhr_render_image(context, &image));
    bhr_context_destroy(context);
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    new_contexts(backend);
    BhrContext *context = check_context(backend);
    pictures(context);
    refusals(context);
    refused_options(context);
    looks_with_depth(context);
    whose_volumes(context);
    choices(context);
    states_what_the_header_states(context);
    bhr_context_destroy(context);
    return check_end();
}
