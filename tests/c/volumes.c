/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* volumes.c -- matter with depth asked for wrongly: volumes, hot spots, and the matter along rays. Each refusal must
 * leave the context as it was, values at the limits must be taken, and frames and jobs keep what they began with. Right
 * numbers are tested against golden values elsewhere. */
#include "check.h"
#include "refusals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A number of a struct, the least and the largest that it may have, and its name. */
typedef struct Limits {
    size_t      offset;
    double      least, most;
    const char *name;
} Limits;

static const Limits VOLUME[] = {
    {offsetof(BhrVolume, inner_radius), 0.0, 1e4, "inner_radius"},
    {offsetof(BhrVolume, outer_radius), 0.0, 1e4, "outer_radius"},
    {offsetof(BhrVolume, radius), 0.1, 1e4, "radius"},
    {offsetof(BhrVolume, width), 1e-3, 1e4, "width"},
    {offsetof(BhrVolume, thickness), 0.01, 1e6, "thickness"},
    {offsetof(BhrVolume, opening), 0.01, 1.5, "opening"},
    {offsetof(BhrVolume, slope), 0.0, 4.0, "slope"},
    {offsetof(BhrVolume, absorption), 0.0, 1e6, "absorption"},
    {offsetof(BhrVolume, temperature), 500.0, 1e9, "temperature"},
    {offsetof(BhrVolume, temperature_slope), 0.0, 2.0, "temperature_slope"},
    {offsetof(BhrVolume, spectral_index), -4.0, 4.0, "spectral_index"},
    {offsetof(BhrVolume, tint), 0.0, 1.0, "tint"},
    {offsetof(BhrVolume, tint) + sizeof(double), 0.0, 1.0, "tint"},
    {offsetof(BhrVolume, tint) + 2 * sizeof(double), 0.0, 1.0, "tint"},
    {offsetof(BhrVolume, brightness), 0.0, 1e6, "brightness"},
    {offsetof(BhrVolume, sub_keplerian), 0.0, 1.0, "sub_keplerian"},
    {offsetof(BhrVolume, infall), 0.0, 1.0, "infall"},
    {offsetof(BhrVolume, angular_momentum), 0.0, 1.0, "angular_momentum"},
    {offsetof(BhrVolume, speed), 0.0, 0.995, "speed"},
    {offsetof(BhrVolume, turbulence), 0.0, 1.0, "turbulence"},
    {offsetof(BhrVolume, clumping), 0.5, 3.0, "clumping"},
    {offsetof(BhrVolume, heating), 0.0, 0.5, "heating"},
};

static const Limits HOT_SPOT[] = {
    {offsetof(BhrHotSpot, radius), 1.0, 1e3, "radius"},
    {offsetof(BhrHotSpot, size), 0.05, 250.0, "size"},
    {offsetof(BhrHotSpot, azimuth), -1e6, 1e6, "azimuth"},
    {offsetof(BhrHotSpot, absorption), 0.0, 1e6, "absorption"},
    {offsetof(BhrHotSpot, temperature), 500.0, 1e9, "temperature"},
    {offsetof(BhrHotSpot, spectral_index), -4.0, 4.0, "spectral_index"},
    {offsetof(BhrHotSpot, tint), 0.0, 1.0, "tint"},
    {offsetof(BhrHotSpot, tint) + sizeof(double), 0.0, 1.0, "tint"},
    {offsetof(BhrHotSpot, tint) + 2 * sizeof(double), 0.0, 1.0, "tint"},
    {offsetof(BhrHotSpot, brightness), 0.0, 1e6, "brightness"},
};

/* Just outside a limit on the side `sign`, and what is no number. */
static double outside(double limit, int sign) {
    return limit + sign * (fabs(limit) * 1e-3 + 1e-6);
}

static BhrVolume a_volume(void) {
    BhrVolume volume;
    CHECK_OK(bhr_volume_init(&volume, sizeof volume));
    return volume;
}

static BhrHotSpot a_spot(void) {
    BhrHotSpot spot;
    CHECK_OK(bhr_hot_spot_init(&spot, sizeof spot));
    return spot;
}


/* A host that was compiled when matter was even still gets even matter. */
static void shorter_struct(BhrContext *context) {
    enum { SHORTER = 168 };
    union {
        BhrVolume     volume;
        unsigned char bytes[sizeof(BhrVolume)];
    } old, read;
    memset(old.bytes, 0xff, sizeof old.bytes);
    CHECK_OK(bhr_volume_init(&old.volume, SHORTER));
    CHECK(old.volume.struct_size == SHORTER && old.bytes[SHORTER] == 0xff, "beyond the host's struct");
    CHECK_OK(bhr_set_volumes(context, &old.volume, SHORTER, 1));
    uint32_t count = 0;
    CHECK_OK(bhr_get_volumes(context, &read.volume, sizeof read.volume, 1, &count));
    CHECK(count == 1 && read.volume.turbulence == 0.0 && read.volume.clumping == a_volume().clumping,
          "turbulence %g, clumping %g", read.volume.turbulence, read.volume.clumping);
    CHECK(a_volume().turbulence == 1.0, "turbulence %g", a_volume().turbulence);
}

/* In `tests/run all` each limit is tried with every shape. Everyday with one: where only some shapes read the member,
 * with one of them, else with all in turn. */
static int is_tried(size_t limit, BhrVolumeShape shape) {
    const size_t member = VOLUME[limit].offset;
    if (check_runs_all()) {
        return 1;
    }
    if (member == offsetof(BhrVolume, width) || member == offsetof(BhrVolume, radius)) {
        return shape == BHR_VOLUME_TORUS;
    }
    if (member == offsetof(BhrVolume, opening)) {
        return shape == BHR_VOLUME_JET;
    }
    if (member == offsetof(BhrVolume, thickness)) {
        return shape == BHR_VOLUME_DISK;
    }
    return (BhrVolumeShape)(limit % (BHR_VOLUME_JET + 1)) == shape;
}

static void numbers(Watch *watch, BhrContext *context) {
    const double no_number[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(VOLUME); i++) {
        const Limits *limits = &VOLUME[i];
        const double  bad[] = {outside(limits->least, -1), outside(limits->most, 1), NAN, INFINITY, -INFINITY};
        for (size_t k = 0; k < COUNT_OF(bad); k++) {
            BhrVolume two[2] = {a_volume(), a_volume()};
            put(&two[1], limits->offset, bad[k]);
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, limits->name,
                          bhr_set_volumes(context, two, sizeof two[0], 2));
            CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "volumes[1]", bhr_set_volumes(context, two, sizeof two[0], 2));
        }
        const double good[] = {limits->least, limits->most};
        for (size_t k = 0; k < COUNT_OF(good); k++) {
            for (BhrVolumeShape shape = BHR_VOLUME_DISK; shape <= BHR_VOLUME_JET; shape++) {
                BhrVolume volume = a_volume();
                volume.shape = shape;
                volume.flow = (BhrFlow)(i % 3);
                volume.flags = shape % 2 ? BHR_VOLUME_POWER_LAW : BHR_VOLUME_RETROGRADE;
                volume.width = 100.0;
                /* The outer radius is to be larger than the inner one. */
                const int edge = limits->offset == offsetof(BhrVolume, inner_radius) && k == 1;
                put(&volume, limits->offset, edge ? 9999.0 : good[k]);
                volume.outer_radius = edge ? 1e4 : volume.outer_radius;
                if (is_tried(i, shape) && volume.outer_radius > 0.0 && volume.width >= 0.01 * volume.radius) {
                    CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, 1));
                    finite_frame(context, limits->name, k);
                }
            }
        }
        CHECK_OK(bhr_set_volumes(context, watch->volumes, sizeof watch->volumes[0], watch->volume_count));
    }
    for (size_t i = 0; i < COUNT_OF(HOT_SPOT); i++) {
        const Limits *limits = &HOT_SPOT[i];
        for (size_t k = 0; k < 2 + COUNT_OF(no_number); k++) {
            BhrHotSpot spot = a_spot();
            spot.radius = 1e3, spot.size = 100.0; /* which go together */
            put(&spot, limits->offset,
                k == 0 ? outside(limits->least, -1) : k == 1 ? outside(limits->most, 1) : no_number[k - 2]);
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, limits->name,
                          bhr_set_hot_spots(context, &spot, sizeof spot, 1));
        }
        for (size_t k = 0; k < 2; k++) {
            BhrHotSpot spot = a_spot();
            /* A size and a radius that go together, whichever of them is at its limit. */
            spot.radius = limits->offset == offsetof(BhrHotSpot, size) && k == 0 ? 8.0 : 1e3;
            spot.size = limits->offset == offsetof(BhrHotSpot, radius) && k == 0 ? 0.1 : 100.0;
            spot.flags = k == 0 ? BHR_HOT_SPOT_THERMAL : BHR_HOT_SPOT_RETROGRADE;
            put(&spot, limits->offset, k == 0 ? limits->least : limits->most);
            CHECK_OK(bhr_set_hot_spots(context, &spot, sizeof spot, 1));
            finite_frame(context, limits->name, k);
        }
        CHECK_OK(bhr_set_hot_spots(context, watch->hot_spots, sizeof watch->hot_spots[0], watch->hot_spot_count));
    }
    /* Numbers that do not go together. */
    BhrVolume volume = a_volume();
    volume.inner_radius = volume.outer_radius;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "outer_radius",
                  bhr_set_volumes(context, &volume, sizeof volume, 1));
    volume = a_volume();
    volume.shape = BHR_VOLUME_TORUS;
    volume.width = 0.0099 * volume.radius;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "width", bhr_set_volumes(context, &volume, sizeof volume, 1));
    BhrHotSpot spot = a_spot();
    spot.size = 0.2501 * spot.radius;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "size", bhr_set_hot_spots(context, &spot, sizeof spot, 1));
    spot.radius = 100.0, spot.size = 0.499;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "at least 0.005 of radius",
                  bhr_set_hot_spots(context, &spot, sizeof spot, 1));
}

/* An inner edge that is stated is no less than 1e-6. Even matter from far inside the horizon is the same however far
 * in it begins. */
static void inner_edges(Watch *watch, BhrBackend backend) {
    enum { WIDTH = 24, HEIGHT = 14, BYTES = WIDTH * HEIGHT * 4 };
    static const double  bad[] = {1e-39, 5e-324, 1e-7, 9.9e-7, -1e-39};
    static const double  good[] = {1.0, 1e-3, 1e-6};
    static unsigned char none[BYTES], pictures[COUNT_OF(good)][BYTES];
    BhrContext          *context = check_context(backend);
    BhrVolume            volume = a_volume();
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, none, BYTES);
    volume.slope = volume.temperature_slope = volume.turbulence = 0.0;
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        volume.inner_radius = bad[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "inner_radius",
                      bhr_set_volumes(watch->context, &volume, sizeof volume, 1));
    }
    CHECK_OK(bhr_set_disk(context, NULL));
    CHECK_OK(bhr_render_image(context, &image));
    for (size_t i = 0; i < COUNT_OF(good); i++) {
        int differ = 0;
        volume.inner_radius = good[i];
        image.pixels = pictures[i];
        CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, 1));
        CHECK_OK(bhr_render_image(context, &image));
        for (size_t k = 0; k < BYTES; k++) {
            differ += abs(pictures[i][k] - pictures[0][k]) > 1;
        }
        CHECK(differ == 0, "%d bytes differ with an inner edge at %g", differ, good[i]);
        CHECK(memcmp(pictures[i], none, BYTES) != 0, "no matter is shown with an inner edge at %g", good[i]);
    }
    bhr_context_destroy(context);
}

static void flags_and_kinds(Watch *watch, BhrContext *context) {
    static const int32_t unknown[] = {-1, 4, 99, INT32_MIN, INT32_MAX};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        BhrVolume volume = a_volume();
        volume.shape = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "shape", bhr_set_volumes(context, &volume, sizeof volume, 1));
        volume = a_volume();
        volume.flow = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "flow", bhr_set_volumes(context, &volume, sizeof volume, 1));
        volume = a_volume();
        volume.flags = 4u << i;
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "flags", bhr_set_volumes(context, &volume, sizeof volume, 1));
        BhrHotSpot spot = a_spot();
        spot.flags = 16u << i;
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "flags", bhr_set_hot_spots(context, &spot, sizeof spot, 1));
    }
}

/* A spot that falls from not far outside the hole. */
static BhrHotSpot a_free_spot(void) {
    BhrHotSpot spot = a_spot();
    spot.flags = BHR_HOT_SPOT_FREE;
    spot.position[0] = 9.0, spot.position[2] = 2.0;
    spot.velocity[1] = 0.3, spot.velocity[2] = 0.2;
    return spot;
}

/* Spots in free fall: places, velocities and times that cannot be, others at the extremes, and what is read again. */
static void free_spots(Watch *watch, BhrContext *context) {
    const double no_number[] = {NAN, INFINITY, -INFINITY};
    const struct {
        size_t      offset;
        const char *name;
    } fields[] = {
        {offsetof(BhrHotSpot, position), "position"},
        {offsetof(BhrHotSpot, velocity) + 2 * sizeof(double), "velocity"},
        {offsetof(BhrHotSpot, time), "time"},
    };
    for (size_t i = 0; i < COUNT_OF(fields); i++) {
        for (size_t k = 0; k < COUNT_OF(no_number); k++) {
            BhrHotSpot spot = a_free_spot();
            put(&spot, fields[i].offset, no_number[k]);
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, fields[i].name,
                          bhr_set_hot_spots(context, &spot, sizeof spot, 1));
            /* They mean nothing without FREE. */
            spot.flags = 0;
            CHECK_OK(bhr_set_hot_spots(context, &spot, sizeof spot, 1));
            CHECK_OK(bhr_set_hot_spots(context, watch->hot_spots, sizeof watch->hot_spots[0], watch->hot_spot_count));
        }
    }
    BhrHotSpot spots[2] = {a_free_spot(), a_free_spot()};
    spots[1].velocity[0] = 1.0, spots[1].velocity[1] = spots[1].velocity[2] = 0.0;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "below 1", bhr_set_hot_spots(context, spots, sizeof spots[0], 2));
    spots[1] = a_free_spot();
    spots[1].position[0] = spots[1].position[2] = 0.0;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "hot_spots[1]",
                  bhr_set_hot_spots(context, spots, sizeof spots[0], 2));
    spots[1].position[0] = 1e300;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "hot_spots[1]",
                  bhr_set_hot_spots(context, spots, sizeof spots[0], 2));
    /* Inside the horizon, where only rain observers are. */
    spots[1] = a_free_spot();
    spots[1].position[0] = 1.2, spots[1].position[2] = 0.0;
    CHECK_REFUSED(watch, BHR_ERROR_UNSUPPORTED, "r+", bhr_set_hot_spots(context, spots, sizeof spots[0], 2));
    spots[1].flags |= BHR_HOT_SPOT_RAIN;
    CHECK_OK(bhr_set_hot_spots(context, spots, sizeof spots[0], 2));
    finite_frame(context, "a spot that begins inside", 0);

    const double times[] = {0.0, 40.0, -3000.0, 1e9, -1e300};
    /* The last two are beyond what is followed of a line, which takes seconds. */
    for (size_t i = 0; i < (check_runs_all() ? COUNT_OF(times) : 3); i++) {
        CHECK_OK(bhr_set_time(context, times[i]));
        finite_frame(context, "the time of free spots", i);
        CHECK_OK(bhr_set_effects(context, BHR_EFFECT_ALL & ~BHR_EFFECT_LIGHT_DELAY));
        finite_frame(context, "free spots in fast light", i);
        CHECK_OK(bhr_set_effects(context, watch->effects));
    }
    CHECK_OK(bhr_set_time(context, watch->time));
    BhrHotSpot read[2];
    uint32_t   count = 0;
    CHECK_OK(bhr_get_hot_spots(context, read, sizeof read[0], 2, &count));
    CHECK(count == 2 && read[1].flags == (BHR_HOT_SPOT_FREE | BHR_HOT_SPOT_RAIN) && read[1].position[0] == 1.2 &&
              read[0].velocity[1] == 0.3 && read[0].time == 0.0,
          "%u spots, flags %u", count, read[1].flags);
    /* A host whose struct ends before them has circles. */
    CHECK_OK(bhr_get_hot_spots(context, read, FIRST_HOT_SPOT, 2, &count));
    CHECK_OK(bhr_set_hot_spots(context, watch->hot_spots, sizeof watch->hot_spots[0], watch->hot_spot_count));
}

static void arrays(Watch *watch, BhrContext *context) {
    BhrVolume  volumes[BHR_MAX_VOLUMES + 1];
    BhrHotSpot spots[BHR_MAX_HOT_SPOTS + 1];
    uint32_t   count = 7;
    for (size_t i = 0; i < COUNT_OF(volumes); i++) {
        volumes[i] = a_volume();
        volumes[i].temperature = 1000.0 + (double)i;
        volumes[i].seed = UINT64_MAX - i;
    }
    for (size_t i = 0; i < COUNT_OF(spots); i++) {
        spots[i] = a_spot();
        spots[i].azimuth = (double)i;
    }
    const size_t one = sizeof volumes[0], spot = sizeof spots[0];
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "volume", bhr_volume_init(NULL, one));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_volume_init(volumes, FIRST_VOLUME - 1));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "hot spot", bhr_hot_spot_init(NULL, spot));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_hot_spot_init(spots, FIRST_HOT_SPOT - 1));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_volumes(NULL, volumes, one, 1));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_hot_spots(NULL, spots, spot, 1));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_volumes(NULL, volumes, one, 1, &count));
    CHECK(count == 0, "out_count is %u after a failure", (unsigned)count);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_hot_spots(NULL, spots, spot, 1, &count));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "volumes", bhr_set_volumes(context, NULL, one, 1));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "hot_spots", bhr_set_hot_spots(context, NULL, spot, 1));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "volumes", bhr_get_volumes(context, NULL, one, 1, &count));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "hot_spots", bhr_get_hot_spots(context, NULL, spot, 1, &count));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_count", bhr_get_volumes(context, volumes, one, 1, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_count", bhr_get_hot_spots(context, spots, spot, 1, NULL));
    const uint32_t many[] = {BHR_MAX_VOLUMES + 1, BHR_MAX_HOT_SPOTS + 1, 1000, UINT32_MAX};
    for (size_t i = 0; i < COUNT_OF(many); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "volume count",
                      bhr_set_volumes(context, volumes, one, many[i]));
        if (many[i] > BHR_MAX_HOT_SPOTS) {
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "hot spot count",
                          bhr_set_hot_spots(context, spots, spot, many[i]));
        }
    }
    const size_t sizes[] = {0, 4, FIRST_HOT_SPOT - 1, 1u << 20, SIZE_MAX};
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "volume_size", bhr_set_volumes(context, volumes, sizes[i], 1));
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "hot_spot_size",
                      bhr_set_hot_spots(context, spots, sizes[i], 1));
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "volume_size",
                      bhr_get_volumes(context, volumes, sizes[i], 1, &count));
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "hot_spot_size",
                      bhr_get_hot_spots(context, spots, sizes[i], 1, &count));
    }
    /* An element's own size: too small, garbage, and larger than the elements are. */
    const uint32_t stated[] = {0, 4, FIRST_HOT_SPOT - 1, 1u << 20, UINT32_MAX, (uint32_t)sizeof volumes[0] + 8};
    for (size_t i = 0; i < COUNT_OF(stated); i++) {
        BhrVolume  wrong[2] = {volumes[0], volumes[1]};
        BhrHotSpot wrong_spot = spots[0];
        wrong[1].struct_size = stated[i];
        wrong_spot.struct_size = stated[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_set_volumes(context, wrong, one, 2));
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size",
                      bhr_set_hot_spots(context, &wrong_spot, spot, 1));
    }
    /* The most that there may be come back in their order; no more are written than there is room for. */
    CHECK_OK(bhr_set_volumes(context, volumes, one, BHR_MAX_VOLUMES));
    CHECK_OK(bhr_set_hot_spots(context, spots, spot, BHR_MAX_HOT_SPOTS));
    BhrVolume  read[BHR_MAX_VOLUMES];
    BhrHotSpot seen[BHR_MAX_HOT_SPOTS];
    memset(read, UNTOUCHED, sizeof read);
    memset(seen, UNTOUCHED, sizeof seen);
    CHECK_OK(bhr_get_volumes(context, read, one, 2, &count));
    CHECK(count == BHR_MAX_VOLUMES && all_untouched(&read[2], 2 * one), "%u volumes", (unsigned)count);
    CHECK(memcmp(read, volumes, 2 * one) == 0, "the volumes are not those that were set");
    CHECK_OK(bhr_get_hot_spots(context, seen, spot, BHR_MAX_HOT_SPOTS, &count));
    CHECK(count == BHR_MAX_HOT_SPOTS && memcmp(seen, spots, sizeof seen) == 0, "the hot spots are others");
    finite_frame(context, "all", 0);
    CHECK_OK(bhr_get_volumes(context, NULL, 0, 0, &count));
    CHECK(count == BHR_MAX_VOLUMES, "%u volumes", (unsigned)count);
    CHECK_OK(bhr_set_volumes(context, NULL, 0, 0));
    CHECK_OK(bhr_set_hot_spots(context, NULL, 0, 0));
    CHECK_OK(bhr_get_hot_spots(context, NULL, 0, 0, &count));
    CHECK(count == 0, "%u hot spots", (unsigned)count);
    /* A newer host's larger structs: what this library does not know must be 0, and is cleared. */
    struct {
        BhrVolume     known;
        unsigned char tail[16];
    } grown[2];
    for (size_t i = 0; i < 2; i++) {
        CHECK_OK(bhr_volume_init(&grown[i].known, sizeof grown[i]));
        grown[i].known.temperature = 2000.0 + (double)i;
    }
    CHECK_OK(bhr_set_volumes(context, &grown[0].known, sizeof grown[0], 2));
    memset(grown, UNTOUCHED, sizeof grown);
    CHECK_OK(bhr_get_volumes(context, &grown[0].known, sizeof grown[0], 2, &count));
    CHECK(count == 2 && grown[1].known.temperature == 2001.0 && grown[1].known.struct_size == sizeof grown[1],
          "a larger struct comes back with %g K", grown[1].known.temperature);
    CHECK(grown[0].tail[0] == 0 && grown[1].tail[15] == 0, "the tail of a larger struct is not cleared");
    grown[1].tail[15] = 1;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "volumes[1]",
                bhr_set_volumes(context, &grown[0].known, sizeof grown[0], 2));
    CHECK_OK(bhr_set_volumes(context, watch->volumes, one, watch->volume_count));
    CHECK_OK(bhr_set_hot_spots(context, watch->hot_spots, spot, watch->hot_spot_count));
    check_unchanged(watch, __FILE__, __LINE__, "volumes and hot spots set back");
}

/* ---- rays ---- */

static BhrRay good_ray(void) {
    const BhrRay ray = {{30.0, 0.0, 4.0}, {-1.0, 0.25, -0.1}, 1.0};
    return ray;
}

static void rays(Watch *watch, BhrContext *context) {
    BhrVolume volume = a_volume();
    volume.flags = BHR_VOLUME_POWER_LAW;
    volume.absorption = 0.1;
    CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, 1));
    enum { COUNT = 6 };
    BhrRay      given[COUNT];
    BhrTransfer found[COUNT], alone;
    for (int i = 0; i < COUNT; i++) {
        given[i] = good_ray();
    }
    given[1].position[0] = NAN;
    given[2].direction[1] = INFINITY;
    memset(given[3].direction, 0, sizeof given[3].direction);
    given[4].frequency_ratio = -1.0;
    CHECK_OK(bhr_transfer_rays(context, given, sizeof given[0], COUNT, found, sizeof found[0]));
    CHECK_OK(bhr_transfer_rays(context, given, sizeof given[0], 1, &alone, sizeof alone));
    CHECK(alone.fate == BHR_FATE_ESCAPED && alone.intensity > 0.0 && alone.optical_depth > 0.0 &&
              alone.light[0] == alone.light[2] && alone.light[0] > 0.0,
          "fate %d, intensity %g, depth %g", (int)alone.fate, alone.intensity, alone.optical_depth);
    for (int i = 0; i < COUNT; i++) {
        if (i == 0 || i == COUNT - 1) {
            CHECK(memcmp(&found[i], &alone, sizeof alone) == 0, "ray %d differs from the same ray alone", i);
        } else {
            CHECK(found[i].fate == BHR_FATE_INVALID && isnan(found[i].intensity) && isnan(found[i].optical_depth) &&
                      isnan(found[i].light[1]),
                  "bad ray %d has fate %d", i, (int)found[i].fate);
        }
    }
    BhrRay inwards = good_ray();
    inwards.direction[1] = 0.0;
    CHECK_OK(bhr_transfer_rays(context, &inwards, sizeof inwards, 1, &alone, sizeof alone));
    CHECK(alone.fate == BHR_FATE_CAPTURED && isnan(alone.optical_depth) && alone.intensity > 0.0,
          "a captured ray has fate %d and depth %g", (int)alone.fate, alone.optical_depth);
    const BhrRay ray = good_ray();
    memset(&alone, UNTOUCHED, sizeof alone);
    CHECK_OK(bhr_transfer_rays(context, NULL, sizeof ray, 0, NULL, sizeof alone));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context",
                bhr_transfer_rays(NULL, &ray, sizeof ray, 1, &alone, sizeof alone));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "rays",
                bhr_transfer_rays(context, NULL, sizeof ray, 1, &alone, sizeof alone));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out", bhr_transfer_rays(context, &ray, sizeof ray, 1, NULL, sizeof alone));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "ray_size",
                bhr_transfer_rays(context, &ray, FIRST_RAY - 1, 1, &alone, sizeof alone));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_size",
                bhr_transfer_rays(context, &ray, sizeof ray, 1, &alone, FIRST_TRANSFER - 1));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "count",
                bhr_transfer_rays(context, &ray, sizeof ray, SIZE_MAX, &alone, sizeof alone));
    CHECK(all_untouched(&alone, sizeof alone), "a refused call wrote to out");
    struct {
        BhrTransfer   known;
        unsigned char tail[8];
    } grown[2];
    memset(grown, UNTOUCHED, sizeof grown);
    const BhrRay two[2] = {ray, ray};
    CHECK_OK(bhr_transfer_rays(context, two, sizeof ray, 2, &grown[0].known, sizeof grown[0]));
    CHECK(memcmp(&grown[1].known, &found[0], sizeof found[0]) == 0, "the second of two longer results differs");
    CHECK(grown[0].tail[0] == 0 && grown[1].tail[7] == 0, "the tail of a longer result is not cleared");
    CHECK_OK(bhr_set_volumes(context, watch->volumes, sizeof watch->volumes[0], watch->volume_count));
    check_unchanged(watch, __FILE__, __LINE__, "the volumes set back after rays");
}

/* ---- views, jobs ---- */

static void views(Watch *watch, BhrContext *context) {
    static float   values[WATCH_WIDTH * WATCH_HEIGHT];
    const BhrImage image = image_of(BHR_FORMAT_R32F, WATCH_WIDTH, WATCH_HEIGHT, values, sizeof values);
    BhrVolume      volume = a_volume();
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "view", bhr_set_view(context, BHR_VIEW_INTENSITY + 1));
    volume.flags = BHR_VOLUME_POWER_LAW;
    CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, 1));
    for (BhrView view = BHR_VIEW_OPTICAL_DEPTH; view <= BHR_VIEW_INTENSITY; view++) {
        CHECK_OK(bhr_set_view(context, view));
        CHECK_OK(bhr_render_image(context, &image));
        size_t good = 0, shown = 0;
        for (size_t i = 0; i < COUNT_OF(values); i++) {
            good += values[i] >= 0.0f || (isnan(values[i]) && view == BHR_VIEW_OPTICAL_DEPTH);
            shown += values[i] > 0.1f;
        }
        CHECK(good == COUNT_OF(values) && shown > 20, "view %d: %u are values, %u are seen", (int)view, (unsigned)good,
              (unsigned)shown);
        const BhrImage light = image_of(BHR_FORMAT_RGBA16F, 8, 8, values, sizeof values);
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, view == BHR_VIEW_INTENSITY ? "INTENSITY" : "OPTICAL_DEPTH",
                    bhr_render_image(context, &light));
    }
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    CHECK_OK(bhr_set_volumes(context, watch->volumes, sizeof watch->volumes[0], watch->volume_count));
    check_unchanged(watch, __FILE__, __LINE__, "the view set back");
}

/* A job keeps the volumes that it began with, whatever is set while it runs. */
static void jobs(Watch *watch, BhrContext *context) {
    enum { WIDTH = 160, HEIGHT = 120, BYTES = WIDTH * HEIGHT * 4 };
    static unsigned char expected[BYTES], pixels[BYTES];
    const uint32_t       part = check_runs_all() ? 1 : 4; /* everyday smaller */
    BhrImage             image =
        image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH / part, HEIGHT / part, expected, sizeof expected);
    BhrVolume  volume = a_volume();
    BhrHotSpot spot = a_spot();
    CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, 1));
    CHECK_OK(bhr_set_hot_spots(context, &spot, sizeof spot, 1));
    CHECK_OK(bhr_render_image(context, &image));
    image.pixels = pixels;
    BhrJob *job = NULL;
    CHECK_OK(bhr_render_image_async(context, &image, &job));
    for (int i = 0; i < 50; i++) {
        volume.thickness = 0.05 + 0.01 * i;
        spot.azimuth = i;
        CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, (uint32_t)(i % 2)));
        CHECK_OK(bhr_set_hot_spots(context, &spot, sizeof spot, (uint32_t)(i % 2)));
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "volume count", bhr_set_volumes(context, &volume, sizeof volume, 99));
    }
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
    CHECK(memcmp(pixels, expected, sizeof pixels) == 0, "a job shows volumes that were set after it began");
    CHECK_OK(bhr_set_volumes(context, watch->volumes, sizeof watch->volumes[0], watch->volume_count));
    CHECK_OK(bhr_set_hot_spots(context, watch->hot_spots, sizeof watch->hot_spots[0], watch->hot_spot_count));
    check_unchanged(watch, __FILE__, __LINE__, "the scene set back after jobs");
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    BhrContext      *context = check_context(backend);
    static Watch     watch;
    watch_unusual_scene(&watch, context);
    inner_edges(&watch, backend);
    free_spots(&watch, context);
    arrays(&watch, context);
    shorter_struct(context);
    CHECK_OK(bhr_set_volumes(context, watch.volumes, sizeof watch.volumes[0], watch.volume_count));
    numbers(&watch, context);
    flags_and_kinds(&watch, context);
    rays(&watch, context);
    views(&watch, context);
    jobs(&watch, context);
    /* Once more, beside volumes that are set. */
    const BhrVolume  volume = a_volume();
    const BhrHotSpot spot = a_spot();
    CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, 1));
    CHECK_OK(bhr_set_hot_spots(context, &spot, sizeof spot, 1));
    watch_begin(&watch, context);
    flags_and_kinds(&watch, context);
    bhr_context_destroy(context);
    return check_end();
}
