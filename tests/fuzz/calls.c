/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* calls.c -- sequences of calls that bytes decide: any order, any values, several contexts and jobs. A call may succeed
 * or fail with a status that bhr.h lists and a message; it never fails internally, writes past what it was lent, or
 * brings the process down. With libFuzzer the bytes are its; alone, the program makes them from a seed:
 *
 *     calls BACKEND CALLS [SEED]
 */
#define _POSIX_C_SOURCE 200809L

#include <bhr.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONTEXTS 2
#define JOBS 3
#define PIXELS 4096u /* bytes that an image may have */
#define GUARD 0x5Au

static BhrBackend backend = BHR_BACKEND_CPU;
static uint64_t   calls, failures, frames;

/* ---- bytes ---- */

static const uint8_t *next_byte, *last_byte;

static uint8_t byte(void) {
    return next_byte < last_byte ? *next_byte++ : 0;
}

static void bytes(void *to, size_t size) {
    for (uint8_t *place = to; size > 0; size--) {
        *place++ = byte();
    }
}

static double number(void) {
    static const double NUMBERS[] = {0.0,   -0.0,  1.0,   -1.0,     0.5,    0.998,   -0.998, 0.999,    1e-7,  2.0,
                                     3.0,   6.0,   10.0,  30.0,     1e3,    1e6,     1e15,   1e-300,   1e308, 5e-324,
                                     -10.0, 0.25,  3.14,  6.283186, 20.0,   4500.0,  1e-14,  26.0,     2.5,   0.1};
    const uint8_t       kind = byte();
    double              value;
    if (kind < 200) {
        return NUMBERS[kind % (sizeof NUMBERS / sizeof NUMBERS[0])];
    }
    if (kind < 230) {
        return (double)byte() / 16.0 - 8.0;
    }
    if (kind < 240) {
        return kind < 234 ? (double)NAN : kind < 237 ? (double)INFINITY : -(double)INFINITY;
    }
    bytes(&value, sizeof value);
    return value;
}

static uint32_t count(void) {
    static const uint32_t COUNTS[] = {0, 1, 2, 3, 7, 8, 12, 16, 31, 1u << 20, (1u << 20) + 1, UINT32_MAX};
    const uint8_t         kind = byte();
    return kind < 220 ? 1u + kind % 12u : COUNTS[kind % (sizeof COUNTS / sizeof COUNTS[0])];
}

/* A constant: mostly one that the header lists. */
static int32_t constant(int32_t largest) {
    const uint8_t kind = byte();
    return kind < 235 ? kind % (largest + 1) : kind < 245 ? -1 : kind < 250 ? largest + 1 : INT32_MIN;
}

/* One of two values; the first one far more often. */
static uint32_t mostly(uint32_t usual, uint32_t rare) {
    return byte() < 245 ? usual : rare;
}

/* The size of an array's elements that a call is told: a wrong one is smaller, as a larger one says that the array
 * takes more memory than it does. */
static size_t element_size(size_t size) {
    return mostly((uint32_t)size, byte() % (uint32_t)size);
}

/* ---- what is checked ---- */

static void fail(const char *what) {
    fprintf(stderr, "call %llu: %s: %s\n", (unsigned long long)calls, what, bhr_error_message());
    abort();
}

static BhrStatus check(BhrStatus status) {
    calls++;
    if (status < 0) {
        failures++;
        if (status < BHR_ERROR_IO || bhr_error_message()[0] == '\0') {
            fail(bhr_status_name(status));
        }
    } else if (status > BHR_FRAME_SKIPPED) {
        fail("an unknown success");
    }
    return status;
}

/* The length of a message is that of a string that fits, and its end is written. */
static void check_message(size_t length, const char *text, size_t size) {
    if (length >= 10000 || (size > 0 && strlen(text) > length)) {
        fail("a message of another length");
    }
}

/* ---- images: one block for each job, and one for calls that wait ---- */

static uint8_t blocks[JOBS + 1][PIXELS + 64];

static BhrImage image_on(uint8_t *block) {
    BhrImage image;
    bhr_image_init(&image, sizeof image);
    image.width = 1u + byte() % 12u;
    image.height = 1u + byte() % 12u;
    image.pixels = block + 32;
    image.byte_size = PIXELS; /* never more than there is */
    image.format = 1 + byte() % 4;
    if (byte() < 128) {
        return image; /* as hosts have them */
    }
    image.struct_size = mostly(sizeof image, byte());
    image.format = constant(BHR_FORMAT_R32F);
    image.width = count();
    image.height = count();
    image.pixels = byte() < 250 ? block + 32 : NULL;
    image.byte_size = mostly(PIXELS, byte());
    if (byte() > 220) {
        image.row_stride = (int64_t)(int8_t)byte() * (byte() > 128 ? 4 : 1);
    }
    /* With a negative stride pixels is the block's last row. */
    if (image.row_stride < 0 && image.height > 0 && image.pixels != NULL) {
        const uint64_t before = (uint64_t)(image.height - 1) * (uint64_t)-image.row_stride;
        image.pixels = block + 32 + (before < PIXELS ? before : 0);
    }
    image.flags = byte() % 4;
    image.reserved = mostly(0, 1);
    return image;
}

static void check_guards(void) {
    for (size_t i = 0; i <= JOBS; i++) {
        for (size_t k = 0; k < 32; k++) {
            if (blocks[i][k] != GUARD || blocks[i][32 + PIXELS + k] != GUARD) {
                fail("memory beside an image was written");
            }
        }
    }
}

/* ---- calls ---- */

static BhrContext *contexts[CONTEXTS];
static BhrJob     *jobs[JOBS];

static int32_t progress(void *user, double fraction) {
    (void)user;
    if (!(fraction >= 0.0 && fraction <= 1.0)) {
        fail("a fraction out of range");
    }
    /* Refused, and does no harm. */
    if (bhr_set_spin(contexts[0], 0.5) != BHR_ERROR_INVALID_STATE && contexts[0] != NULL) {
        fail("a setter ran inside a callback");
    }
    return fraction > 0.5 && byte() > 200;
}

static void create(size_t i) {
    BhrContextOptions options;
    if (contexts[i] != NULL) {
        return;
    }
    bhr_context_options_init(&options, sizeof options);
    options.struct_size = mostly(sizeof options, byte());
    options.backend = backend;
    options.cpu_threads = mostly(1, count());
    if (options.cpu_threads > 4 && options.cpu_threads <= 1024) {
        options.cpu_threads = 2; /* threads of the machine are not what is tested */
    }
    options.flags = mostly(0, 2);
    options.adapter_index = (int32_t)mostly((uint32_t)-1, (uint32_t)-2);
    const BhrStatus status = check(bhr_context_create(mostly(BHR_ABI_VERSION, 7), &options, &contexts[i]));
    if ((status == BHR_OK) != (contexts[i] != NULL)) {
        fail("status and context disagree");
    }
}

static void scene_call(BhrContext *context) {
    double    vector[3] = {number(), number(), number()}, gamma[64];
    BhrCamera camera;
    BhrDisk   disk;
    BhrSky    sky;
    BhrPresetOptions options;
    BhrFilm   film;
    float     nodes[192];
    BhrVolume  volumes[2];
    BhrHotSpot spots[2];
    switch (byte() % 19) {
    case 0: check(bhr_set_mass(context, number())); break;
    case 1: check(bhr_set_spin(context, number())); break;
    case 2: check(bhr_set_axis(context, byte() < 250 ? vector : NULL)); break;
    case 3:
        bhr_camera_init(&camera, sizeof camera);
        camera.struct_size = mostly(sizeof camera, byte());
        camera.projection = constant(BHR_PROJECTION_FRUSTUM);
        camera.motion = constant(BHR_MOTION_VELOCITY);
        if (byte() < 128) {
            memcpy(camera.position, vector, sizeof vector);
        }
        camera.fov_y = mostly(1, 0) != 0 ? camera.fov_y : number();
        camera.velocity[byte() % 3] = number() / 16.0;
        camera.tan_left = mostly(1, 0) != 0 ? camera.tan_left : number();
        camera.tan_up = mostly(1, 0) != 0 ? camera.tan_up : number();
        camera.jitter[byte() % 2] = number() / 8.0;
        camera.chart = mostly(1, 0) != 0 ? (BhrChart)(byte() % 2) : constant(BHR_CHART_RAIN);
        camera.transport = mostly(1, 0) != 0 ? BHR_TRANSPORT_TRIAD : constant(BHR_TRANSPORT_PARALLEL);
        camera.eye = mostly(1, 0) != 0 ? BHR_EYE_MIDDLE : constant(BHR_EYE_RIGHT);
        camera.eye_distance = mostly(1, 0) != 0 ? 0.0 : number();
        check(bhr_set_camera(context, &camera));
        break;
    case 4:
        bhr_camera_init(&camera, sizeof camera);
        check(bhr_camera_orbit(&camera, number(), number(), number()));
        check(bhr_camera_through_lens(&camera, number(), number(), number(), byte() % 20, byte() % 20));
        check(bhr_camera_matrices(&camera, count(), count(), number(), number(), byte(), gamma, gamma + 16));
        check(bhr_camera_from_matrices(&camera, gamma, gamma + 16, byte()));
        check(bhr_set_camera(context, &camera));
        break;
    case 5:
        bhr_disk_init(&disk, sizeof disk);
        disk.struct_size = mostly(sizeof disk, byte());
        disk.flags = byte() % 5;
        disk.inner_radius = number();
        disk.outer_radius = number();
        disk.opacity = number();
        disk.turbulence = number();
        disk.edge_softness = number();
        disk.reference = constant(1);
        disk.emission_law = constant(1);
        bytes(&disk.seed, sizeof disk.seed);
        check(bhr_set_disk(context, byte() < 240 ? &disk : NULL));
        break;
    case 6:
        bhr_sky_init(&sky, sizeof sky);
        sky.struct_size = mostly(sizeof sky, byte());
        sky.flags = byte() % 33;
        sky.stars_brightness = number();
        check(bhr_set_sky(context, &sky));
        break;
    case 7:
        bhr_film_init(&film, sizeof film);
        film.struct_size = mostly(sizeof film, byte());
        film.tone_map = constant(BHR_TONE_MAP_FILMIC);
        film.exposure_ev = number();
        film.bloom = number();
        film.beam_fwhm = number();
        film.colour_map = constant(1);
        film.white_balance = number();
        film.tint = number();
        film.contrast = number(), film.saturation = number();
        film.toe_strength = number(), film.toe_length = number();
        film.shoulder_strength = number();
        film.shoulder_length = number();
        film.shoulder_angle = number();
        film.vignette = number();
        film.auto_exposure = number();
        film.auto_percentile = number();
        film.auto_target = number();
        film.auto_least_ev = number(), film.auto_most_ev = number();
        film.auto_adaptation = number();
        film.highlights = number(), film.shadows = number(), film.grain = number(), film.grain_seed = number();
        film.lut_strength = number(), film.spike_blades = byte();
        film.spikes = number(), film.spike_angle = number(), film.spike_length = number();
        film.streak = number(), film.streak_length = number(), film.streak_tint = number();
        film.paper_white = number(), film.peak = number(), film.flare = number(), film.flare_ghosts = byte();
        check(bhr_set_film(context, &film));
        for (size_t i = 0; i < sizeof nodes / sizeof *nodes; i++) {
            nodes[i] = byte() < 255 ? byte() / 255.0f : (float)number();
        }
        check(bhr_set_film_lut(context, byte() < 250 ? nodes : NULL, mostly(24, byte() % 193), mostly(2, byte())));
        break;
    case 8: check(bhr_set_time(context, number())), check(bhr_set_shutter(context, number())); break;
    case 9: /* AUTO would take a while */
        check(bhr_set_preset(context, constant(BHR_PRESET_TEACHING)));
        bhr_preset_options_init(&options, sizeof options);
        options.struct_size = mostly(sizeof options, byte());
        options.matter = BHR_PRESET_MATTER_THIN + byte() % 3;
        options.frame_ms = number();
        options.measure_anew = byte() % 3;
        options.may_halve = byte() % 3;
        check(bhr_set_preset_with(context, constant(BHR_PRESET_TEACHING), &options, NULL));
        break;
    case 10: check(bhr_set_view(context, constant(BHR_VIEW_INTENSITY))); break;
    case 11:
        check(bhr_set_effects(context, byte()));
        check(bhr_set_effect_strength(context, byte(), number()));
        break;
    case 12: check(bhr_metric_at(context, vector, gamma)); break;
    case 13: check(bhr_christoffel_at(context, vector, gamma)); break;
    case 15:
        for (size_t i = 0; i < 2; i++) {
            bhr_volume_init(&volumes[i], sizeof volumes[i]);
            volumes[i].struct_size = mostly(sizeof volumes[i], byte());
            volumes[i].flags = mostly(byte() % 4, byte());
            volumes[i].shape = constant(BHR_VOLUME_JET);
            volumes[i].flow = constant(BHR_FLOW_OUTFLOW);
            volumes[i].thickness = mostly(1, 0) != 0 ? volumes[i].thickness : number();
            volumes[i].outer_radius = mostly(1, 0) != 0 ? volumes[i].outer_radius : number();
            volumes[i].absorption = mostly(1, 0) != 0 ? volumes[i].absorption : number();
        }
        check(bhr_set_volumes(context, volumes, element_size(sizeof volumes[0]), mostly(byte() % 3, 5)));
        break;
    case 16:
        for (size_t i = 0; i < 2; i++) {
            bhr_hot_spot_init(&spots[i], sizeof spots[i]);
            spots[i].struct_size = mostly(sizeof spots[i], byte());
            spots[i].flags = mostly(byte() % 16, byte());
            spots[i].position[byte() % 3] = mostly(1, 0) != 0 ? 2.0 + byte() / 8.0 : number();
            spots[i].velocity[byte() % 3] = number() / 16.0;
            spots[i].time = mostly(1, 0) != 0 ? 0.0 : number();
            spots[i].radius = mostly(1, 0) != 0 ? spots[i].radius : number();
            spots[i].azimuth = number();
        }
        check(bhr_set_hot_spots(context, spots, element_size(sizeof spots[0]), mostly(byte() % 3, 9)));
        break;
    case 14:
        bhr_camera_init(&camera, sizeof camera);
        check(bhr_get_camera(context, &camera));
        check(bhr_camera_advance(context, &camera, number(), &gamma[0]));
        break;
    case 17: {
        /* The scene's own text, of which a few bytes are others. */
        static char text[1 << 14];
        size_t      size = 0;
        if (bhr_scene_save(context, text, sizeof text, &size) == BHR_OK) {
            for (size_t i = byte() % 4; i > 0 && size > 0; i--) {
                text[(byte() * 256u + byte()) % size] = (char)byte();
            }
            check(bhr_scene_load(context, text, mostly((uint32_t)size, byte())));
        }
        check(bhr_scene_at(context, number()));
        break;
    }
    default: check(bhr_set_progress(context, byte() < 128 ? progress : NULL, NULL)); break;
    }
}

/* Frames stay cheap: a hundred thousand steps for each of 256 samples would be seconds for a pixel. */
static void set_quality(BhrContext *context) {
    BhrQuality quality;
    bhr_quality_init(&quality, sizeof quality);
    quality.struct_size = mostly(sizeof quality, byte());
    quality.method = constant(BHR_METHOD_ADAPTIVE);
    quality.samples_per_pixel = mostly(1 + byte() % 3, 257 + byte());
    quality.max_steps = mostly(16 + byte() * 4u, byte() % 16);
    quality.step = mostly(0, 1) == 0 ? 0.0 : number();
    quality.tolerance = mostly(0, 1) == 0 ? 0.0 : number();
    quality.max_disk_order = byte() % 18;
    quality.render_scale = mostly(1, 0) != 0 ? 1.0 : number();
    quality.volume_resolution = constant(BHR_VOLUME_RESOLUTION_HALF);
    check(bhr_set_quality(context, &quality));
}

static void ray_call(BhrContext *context) {
    BhrRay   rays[3];
    BhrHit   hits[3];
    BhrTransfer found_matter[3];
    double   points[4 * 16];
    uint32_t found = 0;
    for (size_t i = 0; i < 3; i++) {
        for (size_t k = 0; k < 3; k++) {
            rays[i].position[k] = number();
            rays[i].direction[k] = number();
        }
        rays[i].frequency_ratio = number();
    }
    switch (byte() % 7) {
    case 6: {
        double  times[4];
        BhrBody body, bodies[4];
        bhr_body_init(&body, sizeof body);
        body.struct_size = mostly(sizeof body, byte() % (uint32_t)sizeof body);
        body.chart = constant(BHR_CHART_RAIN);
        memcpy(body.position, rays[0].position, sizeof body.position);
        for (size_t k = 0; k < 3; k++) {
            body.velocity[k] = mostly(1, 0) != 0 ? (double)byte() / 300.0 - 0.4 : number();
        }
        body.time = number();
        for (size_t i = 0; i < 4; i++) {
            times[i] = byte() < 250 ? (double)byte() - 128.0 : number();
        }
        check(bhr_world_line(context, &body, times, byte() % 5, bodies, element_size(sizeof bodies[0])));
        break;
    }
    case 5: {
        BhrProjectedPoint image;
        image.struct_size = mostly(sizeof image, 3);
        check(bhr_project_point(context, count(), count(), rays[0].position, mostly(0, byte()), &image));
        BhrProjectedPoint many[4];
        check(bhr_project_points(context, count(), count(), rays[0].position, byte() % 3, mostly(0, byte()), many,
                                 mostly(sizeof many[0], 3)));
        break;
    }
    case 4:
        check(bhr_transfer_rays(context, rays, mostly(sizeof rays[0], 3), byte() % 4, found_matter,
                                sizeof found_matter[0]));
        break;
    case 0: check(bhr_trace_rays(context, rays, mostly(sizeof rays[0], 3), byte() % 4, hits, sizeof hits[0])); break;
    case 1: check(bhr_trace_path(context, &rays[0], byte() % 17, points, &found)); break;
    case 2: check(bhr_camera_ray(context, count(), count(), number(), number(), &rays[0])); break;
    default: check(bhr_camera_rays(context, 1, 3, rays)); break;
    }
    if (found > 16) {
        fail("more points than there is room for");
    }
}

/* Outputs that share a block: each is whole, and the last one stays. */
static void output_call(BhrContext *context, size_t i) {
    BhrImage       images[3];
    BhrOutput      outputs[3];
    const uint32_t number_of = byte() % 4;
    const int      async = byte() < 100 && jobs[i] == NULL;
    for (size_t k = 0; k < 3; k++) {
        images[k] = image_on(blocks[async ? i : JOBS]);
        bhr_output_init(&outputs[k], sizeof outputs[k]);
        outputs[k].struct_size = mostly(sizeof outputs[k], byte());
        outputs[k].kind = constant(BHR_OUTPUT_VIEW);
        outputs[k].index = outputs[k].kind == BHR_OUTPUT_VIEW ? byte() % 9u : mostly(0, byte());
        outputs[k].image = byte() < 250 ? &images[k] : NULL;
        if (byte() < 220) {
            /* Images such as hosts have: of one size, in the kind's format, if that fits into a block. */
            const int single = outputs[k].kind == BHR_OUTPUT_DEPTH || outputs[k].kind == BHR_OUTPUT_TRANSMISSION ||
                               outputs[k].kind == BHR_OUTPUT_VIEW;
            images[k].width = images[0].width;
            images[k].height = images[0].height;
            images[k].row_stride = 0;
            images[k].pixels = blocks[async ? i : JOBS] + 32;
            images[k].format = single ? BHR_FORMAT_R32F : BHR_FORMAT_RGBA32F;
        }
    }
    const size_t size = element_size(sizeof outputs[0]);
    if (byte() < 20) {
        check(bhr_save_outputs(context, outputs, size, number_of, "/absent/outputs.exr"));
        return;
    }
    const BhrStatus status = check(bhr_render_outputs(context, outputs, size, number_of, async ? &jobs[i] : NULL));
    frames += status == BHR_OK;
    if (async && (status == BHR_OK) != (jobs[i] != NULL)) {
        fail("status and job disagree");
    }
}

static void render_call(BhrContext *context) {
    BhrImage  image = image_on(blocks[JOBS]);
    BhrRegion region = {.struct_size = mostly(sizeof region, byte())};
    size_t    i = byte() % JOBS;
    switch (byte() % 10) {
    case 9:
        switch (byte() % 4) {
        case 0: check(bhr_begin_accumulation(context, image.width, image.height, image.flags)); break;
        case 1: frames += check(bhr_end_accumulation(context, byte() < 200 ? &image : NULL)) == BHR_OK; break;
        default: frames += check(bhr_accumulate(context, byte() < 128 ? 1.0 : number())) == BHR_OK; break;
        }
        break;
    case 6:
    case 7: output_call(context, i); break;
    case 8:
        image.format = BHR_FORMAT_R32F;
        check(bhr_set_occluder(context, byte() < 60 ? &image : NULL));
        break;
    case 0:
    case 1: frames += check(bhr_render_image(context, &image)) == BHR_OK; break;
    case 2:
        if (jobs[i] == NULL) {
            image = image_on(blocks[i]);
            const BhrStatus status = check(bhr_render_image_async(context, &image, &jobs[i]));
            if ((status == BHR_OK) != (jobs[i] != NULL)) {
                fail("status and job disagree");
            }
        }
        break;
    case 3:
        region.full_width = count();
        region.full_height = count();
        region.x = count() - 1;
        region.y = count() - 1;
        check(bhr_set_region(context, byte() < 128 ? &region : NULL));
        break;
    case 4: check(bhr_set_sky_map(context, byte() < 200 ? &image : NULL)); break;
    default: set_quality(context); break;
    }
}

static void job_call(size_t i) {
    char   text[40];
    size_t size;
    double fraction;
    switch (byte() % 4) {
    case 0:
        frames += check(bhr_job_wait(jobs[i], mostly(UINT32_MAX, byte()), byte() < 128 ? &fraction : NULL)) == BHR_OK;
        return; /* which counts itself */
    case 1: bhr_job_cancel(jobs[i]); break;
    case 2: size = byte() % sizeof text, check_message(bhr_job_error_message(jobs[i], text, size), text, size); break;
    default:
        bhr_job_destroy(jobs[i]);
        jobs[i] = NULL;
        break;
    }
    calls++;
}

static void one_call(void) {
    const size_t  i = byte() % CONTEXTS;
    const uint8_t kind = byte();
    char          text[64];
    if (kind < 4) {
        bhr_context_destroy(contexts[i]);
        contexts[i] = NULL;
    } else if (kind < 20 || contexts[i] == NULL) {
        create(i);
    } else if (kind < 205) {
        scene_call(contexts[i]);
    } else if (kind < 216) {
        ray_call(contexts[i]);
    } else if (kind < 230) {
        render_call(contexts[i]);
    } else if (kind < 245) {
        job_call(byte() % JOBS);
    } else if (kind < 250) {
        /* Calls without a context fail. */
        scene_call(NULL);
    } else {
        const size_t size = byte() % sizeof text;
        check_message(bhr_context_error_message(contexts[i], text, size), text, size);
        calls++;
    }
}

static void sequence(const uint8_t *data, size_t size) {
    next_byte = data, last_byte = data + size;
    memset(blocks, GUARD, sizeof blocks);
    while (next_byte < last_byte) {
        one_call();
    }
    check_guards();
    const int jobs_first = size % 2 == 0;
    for (size_t i = 0; jobs_first && i < JOBS; i++) {
        bhr_job_destroy(jobs[i]);
        jobs[i] = NULL;
    }
    for (size_t i = 0; i < CONTEXTS; i++) {
        bhr_context_destroy(contexts[i]);
        contexts[i] = NULL;
    }
    for (size_t i = 0; i < JOBS; i++) {
        bhr_job_destroy(jobs[i]);
        jobs[i] = NULL;
    }
    check_guards();
}

#ifdef LIBFUZZER
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    sequence(data, size);
    return 0;
}
#else
/* Knuth's constants, The Art of Computer Programming 2, 3.3.4. */
static uint64_t state;

static uint8_t random_byte(void) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint8_t)(state >> 56);
}

int main(int argc, char **argv) {
    static uint8_t data[1 << 14];
    if (argc < 3) {
        fprintf(stderr, "usage: %s cpu|vulkan CALLS [SEED]\n", argv[0]);
        return 2;
    }
    backend = strcmp(argv[1], "vulkan") == 0 ? BHR_BACKEND_VULKAN : BHR_BACKEND_CPU;
    const uint64_t wanted = strtoull(argv[2], NULL, 10);
    uint64_t       seed = argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
    while (calls < wanted) {
        state = seed++;
        const size_t size = sizeof data - random_byte();
        for (size_t i = 0; i < size; i++) {
            data[i] = random_byte();
        }
        sequence(data, size);
    }
    printf("%llu calls, %llu of them refused, %llu frames; the next seed is %llu\n", (unsigned long long)calls,
           (unsigned long long)failures, (unsigned long long)frames, (unsigned long long)seed);
    /* Where nothing works, nothing is tested. */
    return frames == 0 || failures > calls / 2;
}
#endif
