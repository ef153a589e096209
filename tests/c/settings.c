/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* settings.c -- what is set is read back as it was: time, shutter, view and region. The structs that calls fill, and
 * those without defaults, have a function that sets their size and clears the rest; BHR_INIT is that function, and bad
 * arguments of either are refused. */
#include "check.h"

#include <math.h>
#include <string.h>

static void times(BhrContext *context) {
    static const double all[] = {12.5, -1e300, 0.0};
    double              time = -1.0;
    CHECK_OK(bhr_get_time(context, &time));
    CHECK(time == 0.0, "a new context's time is %g", time);
    for (size_t i = 0; i < COUNT_OF(all); i++) {
        CHECK_OK(bhr_set_time(context, all[i]));
        CHECK_OK(bhr_get_time(context, &time));
        CHECK(time == all[i], "the time is %g, not %g", time, all[i]);
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_time(NULL, &time));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_time", bhr_get_time(context, NULL));
}

static void shutters(BhrContext *context) {
    static const double all[] = {0.5, 1e300, 0.0}, refused[] = {-0.01, 2e300, NAN, INFINITY, -INFINITY};
    double              duration = -1.0;
    CHECK_OK(bhr_get_shutter(context, &duration));
    CHECK(duration == 0.0, "a new context's shutter is %g", duration);
    for (size_t i = 0; i < COUNT_OF(all); i++) {
        CHECK_OK(bhr_set_shutter(context, all[i]));
        for (size_t j = 0; j < COUNT_OF(refused); j++) {
            CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "shutter", bhr_set_shutter(context, refused[j]));
        }
        CHECK_OK(bhr_get_shutter(context, &duration));
        CHECK(duration == all[i], "the shutter is %g, not %g", duration, all[i]);
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_shutter(NULL, 0.0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_shutter(NULL, &duration));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_shutter", bhr_get_shutter(context, NULL));
}

static void views(BhrContext *context) {
    BhrView view = -1;
    CHECK_OK(bhr_get_view(context, &view));
    CHECK(view == BHR_VIEW_LIGHT, "a new context's view is %d", (int)view);
    for (BhrView each = BHR_VIEW_INTENSITY; each >= BHR_VIEW_LIGHT; each--) {
        CHECK_OK(bhr_set_view(context, each));
        CHECK_OK(bhr_get_view(context, &view));
        CHECK(view == each, "the view is %d, not %d", (int)view, (int)each);
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "view", bhr_set_view(context, BHR_VIEW_INTENSITY + 1));
    CHECK_OK(bhr_get_view(context, &view));
    CHECK(view == BHR_VIEW_LIGHT, "a refused view was set");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_view(NULL, &view));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_view", bhr_get_view(context, NULL));
}

static void regions(BhrContext *context) {
    BhrRegion region, set;
    int32_t   present = 7;
    BHR_INIT(region);
    CHECK_OK(bhr_get_region(context, &region, &present));
    CHECK(present == 0 && region.struct_size == sizeof region && region.full_width == 0, "a new context has a region");
    BHR_INIT(set);
    set.full_width = 100, set.full_height = 80, set.x = 99, set.y = 7;
    CHECK_OK(bhr_set_region(context, &set));
    CHECK_OK(bhr_get_region(context, &region, &present));
    CHECK(present == 1 && memcmp(&region, &set, sizeof set) == 0, "another region than that which was set");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_present", bhr_get_region(context, &region, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "region", bhr_get_region(context, NULL, &present));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_region(NULL, &region, &present));
    region.struct_size = FIRST_REGION - 1;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_get_region(context, &region, &present));
    CHECK(present == 0, "a refused call says that there is a region");
    CHECK_OK(bhr_set_region(context, NULL));
    BHR_INIT(region);
    CHECK_OK(bhr_get_region(context, &region, &present));
    CHECK(present == 0 && region.full_width == 0, "the region is still set");
}

/* The function clears all of the struct but its size, and nothing beyond; BHR_INIT does the same. */
#define CHECK_INIT(Struct, function)                                                                                   \
    do {                                                                                                               \
        struct {                                                                                                       \
            Struct        one;                                                                                         \
            unsigned char beyond[8];                                                                                   \
        } by_function, by_macro;                                                                                       \
        memset(&by_function, UNTOUCHED, sizeof by_function);                                                           \
        memset(&by_macro, UNTOUCHED, sizeof by_macro);                                                                 \
        CHECK_OK(function(&by_function.one, sizeof by_function.one));                                                  \
        BHR_INIT(by_macro.one);                                                                                        \
        CHECK(memcmp(&by_function, &by_macro, sizeof by_macro) == 0, "BHR_INIT differs from " #function);              \
        CHECK(by_macro.one.struct_size == sizeof(Struct), "the size is %u", (unsigned)by_macro.one.struct_size);       \
        CHECK(all_untouched(by_macro.beyond, sizeof by_macro.beyond), #function " writes beyond the struct");          \
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "NULL", function(NULL, sizeof(Struct)));                               \
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", function(&by_macro.one, 4));                            \
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", function(&by_macro.one, SIZE_MAX));                     \
    } while (0)

static int is_clear(const void *memory, size_t size) {
    const unsigned char *bytes = memory;
    for (size_t i = sizeof(uint32_t); i < size; i++) {
        if (bytes[i] != 0) {
            return 0;
        }
    }
    return 1;
}

static void structs(void) {
    BhrWindow         window;
    BhrFrameStats     stats;
    BhrProjectedPoint points[2];
    CHECK_INIT(BhrAdapterInfo, bhr_adapter_info_init);
    CHECK_INIT(BhrBody, bhr_body_init);
    CHECK_INIT(BhrFrameStats, bhr_frame_stats_init);
    CHECK_INIT(BhrHoleInfo, bhr_hole_info_init);
    CHECK_INIT(BhrProjectedPoint, bhr_projected_point_init);
    CHECK_INIT(BhrRegion, bhr_region_init);
    CHECK_INIT(BhrWindow, bhr_window_init);
    CHECK_INIT(BhrCamera, bhr_camera_init);
    CHECK_INIT(BhrContextOptions, bhr_context_options_init);
    memset(&window, UNTOUCHED, sizeof window);
    memset(&stats, UNTOUCHED, sizeof stats);
    memset(points, UNTOUCHED, sizeof points);
    BHR_INIT(window);
    BHR_INIT(stats);
    points[1].found = 1;
    BHR_INIT(points[1]);
    CHECK(is_clear(&window, sizeof window) && is_clear(&stats, sizeof stats), "a struct has values");
    CHECK(points[1].found == 0 && points[1].x != points[1].x, "a point that nobody asked for has an image");
    CHECK(all_untouched(&points[0], sizeof points[0]), "BHR_INIT writes beside the variable");
}

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    structs();
    times(context);
    shutters(context);
    views(context);
    regions(context);
    bhr_context_destroy(context);
    return check_end();
}
