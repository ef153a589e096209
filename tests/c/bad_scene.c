/* bad_scene.c -- every setter of the scene asked wrongly: NULL, NaN, infinities, values beyond each documented limit,
 * unknown constants, structs of other sizes. Each refusal must leave the context as it was. Values at the limits must
 * be taken. */
#include "check.h"

#include <math.h>
#include <string.h>

static const double NOT_FINITE[] = {NAN, INFINITY, -INFINITY};

/* A struct as hosts of other releases pass it. `grown` has members known and tail, is filled by `init`, a call with
 * `size`, and `set` must take it with every struct_size from `first`, the first release's, to that of the struct;
 * with a tail that this version does not know, only if that is zero; and with none below `first`. `get` must write
 * struct_size bytes, the tail's zero. */
#define CHECK_STRUCT_SIZES(watch, grown, first, init, set, get)                                                        \
    do {                                                                                                               \
        for (size_t size = (first); size <= sizeof(grown); size++) {                                                   \
            memset(&(grown), UNTOUCHED, sizeof(grown));                                                                \
            CHECK_OK(init);                                                                                            \
            CHECK((grown).known.struct_size == size, "init left another struct_size than %u", (unsigned)size);         \
            CHECK(is_after(&(grown), sizeof(grown).known, size, 0), "init at %u: the tail is not 0", (unsigned)size);  \
            CHECK(is_after(&(grown), size, sizeof(grown), UNTOUCHED), "init at %u wrote further", (unsigned)size);     \
            CHECK_OK(set);                                                                                             \
            memset(&(grown), UNTOUCHED, sizeof(grown));                                                                \
            (grown).known.struct_size = (uint32_t)size;                                                                \
            CHECK_OK(get);                                                                                             \
            CHECK((grown).known.struct_size == size, "a getter changed struct_size %u", (unsigned)size);               \
            CHECK(is_after(&(grown), sizeof(grown).known, size, 0), "get at %u: the tail is not 0", (unsigned)size);   \
            CHECK(is_after(&(grown), size, sizeof(grown), UNTOUCHED), "get at %u wrote further", (unsigned)size);      \
        }                                                                                                              \
        watch_begin((watch), (watch)->context);                                                                        \
        (grown).tail[sizeof(grown).tail - 1] = 1;                                                                      \
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", set);                                          \
        (grown).tail[sizeof(grown).tail - 1] = 0;                                                                      \
        const uint32_t wrong[] = {(first) - 1, (first) / 2, 4, 0, 1u << 20, UINT32_MAX};                               \
        for (size_t at = 0; at < COUNT_OF(wrong); at++) {                                                              \
            (grown).known.struct_size = wrong[at];                                                                     \
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", set);                                      \
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", get);                                      \
            const size_t size = wrong[at];                                                                             \
            CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", init);                                              \
        }                                                                                                              \
    } while (0)

/* Whether bytes begin .. end - 1 of the struct are all `value`. */
static int is_after(const void *structure, size_t begin, size_t end, unsigned char value) {
    const unsigned char *bytes = structure;
    while (begin < end && bytes[begin] == value) {
        begin++;
    }
    return begin >= end;
}

/* A number that a setter must refuse, and what its message must name. */
typedef struct BadNumber {
    size_t      offset; /* of the double in its struct */
    double      value;
    const char *words;
} BadNumber;

/* A small frame of linear light succeeds, and every number in it is finite. */
static void finite_frame(BhrContext *context, const char *what, size_t index) {
    static float   light[WATCH_WIDTH * WATCH_HEIGHT * 4];
    const BhrImage image = image_of(BHR_FORMAT_RGBA32F, WATCH_WIDTH, WATCH_HEIGHT, light, sizeof light);
    CHECK_OK(bhr_render_image(context, &image));
    size_t finite = 0;
    for (size_t i = 0; i < COUNT_OF(light); i++) {
        finite += isfinite(light[i]) && light[i] >= 0.0f;
    }
    CHECK(finite == COUNT_OF(light), "%s %u: %u numbers are finite", what, (unsigned)index, (unsigned)finite);
}

static void put(void *destination, size_t offset, double value) {
    memcpy((char *)destination + offset, &value, sizeof value);
}

/* ---- the hole ---- */

static void mass(Watch *watch, BhrContext *context) {
    static const double bad[] = {0.0, -0.0, -1.0, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "mass", bhr_set_mass(context, bad[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_mass(NULL, 1.0));
}

static void spin(Watch *watch, BhrContext *context) {
    static const double bad[] = {0.99900001, -0.99900001, 1.0, -1.0, 5.0, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "spin", bhr_set_spin(context, bad[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_spin(NULL, 0.0));
    CHECK_OK(bhr_set_spin(context, -0.999));
    CHECK_OK(bhr_set_spin(context, 0.999));
    CHECK_OK(bhr_set_spin(context, watch->spin));
}

static void axis(Watch *watch, BhrContext *context) {
    static const double zero[3] = {0.0, 0.0, -0.0};
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "axis", bhr_set_axis(context, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "axis", bhr_set_axis(context, zero));
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        for (int k = 0; k < 3; k++) {
            double bad[3] = {0.1, 0.2, 1.0};
            bad[k] = NOT_FINITE[i];
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "axis", bhr_set_axis(context, bad));
        }
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_axis(NULL, watch->axis));
    /* Any non-zero length is taken. */
    static const double long_axis[3] = {0.0, 3e300, 4e300}, short_axis[3] = {0.0, 3e-310, 4e-310};
    double              m, a, got[3];
    CHECK_OK(bhr_set_axis(context, long_axis));
    CHECK_OK(bhr_get_hole(context, &m, &a, got));
    CHECK(fabs(got[1] / got[2] - 0.75) < 1e-12, "axis is (%g, %g, %g)", got[0], got[1], got[2]);
    CHECK_OK(bhr_set_axis(context, short_axis));
    CHECK_OK(bhr_get_hole(context, &m, &a, got));
    CHECK(fabs(got[1] / got[2] - 0.75) < 1e-9, "axis is (%g, %g, %g)", got[0], got[1], got[2]);
    CHECK_OK(bhr_set_axis(context, watch->axis));
    check_unchanged(watch, __FILE__, __LINE__, "the axis set back");

    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_hole(NULL, &m, &a, got));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_mass", bhr_get_hole(context, NULL, &a, got));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_spin", bhr_get_hole(context, &m, NULL, got));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_axis", bhr_get_hole(context, &m, &a, NULL));
}

/* ---- the camera ---- */

static BhrCamera default_camera(void) {
    BhrCamera camera;
    memset(&camera, 0, sizeof camera);
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    return camera;
}

static void camera_vectors(Watch *watch, BhrContext *context) {
    static const struct {
        size_t      offset;
        const char *name;
    } vectors[] = {
        {offsetof(BhrCamera, position), "position"},
        {offsetof(BhrCamera, forward), "forward"},
        {offsetof(BhrCamera, up), "up"},
        {offsetof(BhrCamera, velocity), "velocity"},
    };
    for (size_t v = 0; v < COUNT_OF(vectors); v++) {
        for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
            for (size_t k = 0; k < 3; k++) {
                BhrCamera camera = default_camera();
                put(&camera, vectors[v].offset + k * sizeof(double), NOT_FINITE[i]);
                CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, vectors[v].name, bhr_set_camera(context, &camera));
            }
        }
        if (strcmp(vectors[v].name, "velocity") != 0) {
            BhrCamera camera = default_camera();
            for (size_t k = 0; k < 3; k++) {
                put(&camera, vectors[v].offset + k * sizeof(double), 0.0);
            }
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, vectors[v].name, bhr_set_camera(context, &camera));
        }
    }
}

static void camera_axes(Watch *watch, BhrContext *context) {
    for (int sign = -1; sign <= 1; sign += 2) {
        BhrCamera camera = default_camera();
        for (int k = 0; k < 3; k++) {
            camera.up[k] = 7.0 * sign * camera.forward[k];
        }
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "parallel", bhr_set_camera(context, &camera));
    }
}

static void camera_numbers(Watch *watch, BhrContext *context) {
    static const double bad_fov[] = {0.0, -0.5, PI, 4.0, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad_fov); i++) {
        BhrCamera camera = default_camera();
        camera.fov_y = bad_fov[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "fov_y", bhr_set_camera(context, &camera));
    }
    /* A fisheye may show the whole sphere; the other projections have no such limit. */
    static const double bad_circle[] = {0.0, -0.5, 2.0 * PI + 1e-9, 7.0, NAN, INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad_circle); i++) {
        BhrCamera camera = default_camera();
        camera.projection = BHR_PROJECTION_FISHEYE;
        camera.fov_y = bad_circle[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "fov_y", bhr_set_camera(context, &camera));
    }
    static const double fast[][3] = {{1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}, {0.6, 0.6, 0.6}, {0.0, 0.0, 1e300}};
    for (size_t i = 0; i < COUNT_OF(fast); i++) {
        BhrCamera camera = default_camera();
        camera.motion = BHR_MOTION_VELOCITY;
        memcpy(camera.velocity, fast[i], sizeof fast[i]);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "velocity", bhr_set_camera(context, &camera));
    }
    static const int32_t unknown[] = {-1, 4, 77, INT32_MIN, INT32_MAX};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        BhrCamera camera = default_camera();
        camera.motion = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "motion", bhr_set_camera(context, &camera));
        camera = default_camera();
        camera.projection = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "projection", bhr_set_camera(context, &camera));
    }
    BhrCamera camera = default_camera();
    camera.reserved = 1;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "reserved", bhr_set_camera(context, &camera));
}

static void camera(Watch *watch, BhrContext *context) {
    camera_vectors(watch, context);
    camera_axes(watch, context);
    camera_numbers(watch, context);
    BhrCamera good = default_camera();
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_set_camera(context, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_get_camera(context, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_camera(NULL, &good));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_camera(NULL, &good));
    good = default_camera(); /* a failed getter clears what it was to fill in */
    /* Just inside the limits. */
    good.fov_y = PI - 1e-9;
    good.motion = BHR_MOTION_VELOCITY;
    good.velocity[0] = 1.0 - 1e-9;
    CHECK_OK(bhr_set_camera(context, &good));
    for (BhrProjection projection = BHR_PROJECTION_PERSPECTIVE; projection <= BHR_PROJECTION_CUBE; projection++) {
        BhrCamera kept = {.struct_size = sizeof kept};
        good = default_camera();
        good.projection = projection;
        good.fov_y = projection == BHR_PROJECTION_FISHEYE       ? 2.0 * PI
                     : projection == BHR_PROJECTION_PERSPECTIVE ? 1.0
                                                                : -9.0;
        CHECK_OK(bhr_set_camera(context, &good));
        CHECK_OK(bhr_get_camera(context, &kept));
        CHECK(memcmp(&kept, &good, sizeof kept) == 0, "projection %d is not kept", (int)projection);
    }
    good = default_camera();
    CHECK_OK(bhr_set_camera(context, &good));

    struct {
        BhrCamera     known;
        unsigned char tail[24];
    } grown;
    CHECK_STRUCT_SIZES(watch, grown, FIRST_CAMERA, bhr_camera_init(&grown.known, size),
                       bhr_set_camera(context, &grown.known), bhr_get_camera(context, &grown.known));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_camera_init(NULL, sizeof good));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_camera_init(&good, FIRST_CAMERA - 1));
}

/* The helpers that write a camera leave it alone when they fail. */
static void camera_helpers(void) {
    static const double at[3] = {0.0, -30.0, 5.0}, origin[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
    static const double along[3] = {0.0, -60.0, 10.0}, not_finite[3] = {0.0, NAN, 0.0};
    BhrCamera           camera = default_camera();
    const BhrCamera     before = camera;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_camera_look_at(NULL, at, origin, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "position", bhr_camera_look_at(&camera, NULL, origin, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "target", bhr_camera_look_at(&camera, at, NULL, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "up", bhr_camera_look_at(&camera, at, origin, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "position", bhr_camera_look_at(&camera, not_finite, origin, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "target", bhr_camera_look_at(&camera, at, not_finite, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "up", bhr_camera_look_at(&camera, at, origin, not_finite));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "target", bhr_camera_look_at(&camera, at, at, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "up", bhr_camera_look_at(&camera, at, origin, origin));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "up|parallel", bhr_camera_look_at(&camera, at, origin, along));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_camera_orbit(NULL, 30.0, 0.0, 0.0));
    static const double bad_distance[] = {0.0, -1.0, NAN, INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad_distance); i++) {
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "distance", bhr_camera_orbit(&camera, bad_distance[i], 0.0, 0.0));
    }
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "azimuth", bhr_camera_orbit(&camera, 30.0, NOT_FINITE[i], 0.0));
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "elevation", bhr_camera_orbit(&camera, 30.0, 0.0, NOT_FINITE[i]));
    }
    CHECK(memcmp(&camera, &before, sizeof camera) == 0, "a failed helper changed the camera");
    camera.struct_size = 8;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_camera_orbit(&camera, 30.0, 0.0, 0.0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_camera_look_at(&camera, at, origin, up));
    camera.struct_size = sizeof camera;
    CHECK_OK(bhr_camera_orbit(&camera, 30.0, 0.0, PI / 2.0)); /* straight above the pole has axes too */
    CHECK_OK(bhr_camera_orbit(&camera, 30.0, 0.0, -PI / 2.0));
    CHECK_OK(bhr_camera_look_at(&camera, at, origin, up));
}

/* ---- disk, sky, film, quality ---- */

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
    };
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        BhrDisk value;
        CHECK_OK(bhr_disk_init(&value, sizeof value));
        put(&value, bad[i].offset, bad[i].value);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, bad[i].words, bhr_set_disk(context, &value));
    }
    BhrDisk value;
    int32_t present = 7;
    CHECK_OK(bhr_disk_init(&value, sizeof value));
    value.flags = 0x40;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "flags", bhr_set_disk(context, &value));
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
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        BhrSky value;
        CHECK_OK(bhr_sky_init(&value, sizeof value));
        put(&value, bad[i].offset, bad[i].value);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, bad[i].words, bhr_set_sky(context, &value));
    }
    BhrSky value;
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
    };
    BhrFilm value;
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        CHECK_OK(bhr_film_init(&value, sizeof value));
        put(&value, bad[i].offset, bad[i].value);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, bad[i].words, bhr_set_film(context, &value));
    }
    static const int32_t unknown[] = {-1, 3, 99, INT32_MIN, INT32_MAX};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        CHECK_OK(bhr_film_init(&value, sizeof value));
        value.tone_map = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "tone_map", bhr_set_film(context, &value));
    }
    /* At the limits: from black to white, under every tone map. */
    for (int32_t tone_map = BHR_TONE_MAP_NONE; tone_map <= BHR_TONE_MAP_AGX; tone_map++) {
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
        {offsetof(BhrQuality, reserved), 1, "reserved"},
    };
    BhrQuality value;
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        CHECK_OK(bhr_quality_init(&value, sizeof value));
        put(&value, bad[i].offset, bad[i].value);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, bad[i].words, bhr_set_quality(context, &value));
    }
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

/* ---- the rest ---- */

static void time_effects_view(Watch *watch, BhrContext *context) {
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "time", bhr_set_time(context, NOT_FINITE[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_time(NULL, 0.0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_effects(NULL, BHR_EFFECT_ALL));
    /* Unknown bits are ignored: the watched scene is lit with all of them set, all but BEAMING. */
    CHECK_OK(bhr_set_effects(context, BHR_EFFECT_DOPPLER_SHIFT | BHR_EFFECT_GRAVITY_SHIFT | BHR_EFFECT_LIGHT_DELAY));
    check_unchanged(watch, __FILE__, __LINE__, "unknown effects");
    static const int32_t unknown[] = {-1, 6, 1000, INT32_MIN};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "view", bhr_set_view(context, unknown[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_view(NULL, BHR_VIEW_LIGHT));
}

/* A scene in which every setter has been used: the default would hide a refused call that resets something. */
static void unusual_scene(BhrContext *context) {
    static const double tilted[3] = {0.1, -0.2, 1.0};
    BhrCamera           camera = default_camera();
    CHECK_OK(bhr_set_mass(context, 1.25));
    CHECK_OK(bhr_set_spin(context, 0.5));
    CHECK_OK(bhr_set_axis(context, tilted));
    camera.motion = BHR_MOTION_FREE_FALL;
    camera.fov_y = 0.9;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_time(context, 3.0));
    CHECK_OK(bhr_set_effects(context, BHR_EFFECT_ALL & ~BHR_EFFECT_BEAMING));
}

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    static Watch watch;
    unusual_scene(context);
    watch_begin(&watch, context);
    CHECK(watch.frame_status == BHR_OK, "the watched scene cannot be rendered: %s", bhr_error_message());
    mass(&watch, context);
    spin(&watch, context);
    axis(&watch, context);
    time_effects_view(&watch, context);
    camera(&watch, context);
    camera_helpers();
    disk(&watch, context);
    sky(&watch, context);
    film(&watch, context);
    quality(&watch, context);
    bhr_context_destroy(context);
    return check_end();
}
