/* host-0.1.0.c -- a program as one was written for bhr 0.1.0: it is compiled against bhr-0.1.0.h and run against the
 * library of the day (tests/header/abi.rs). It uses every function and every struct of that header, and holds what the
 * header promised: sizes are its own, nothing beyond its structs is written, defaults and results are those of then.
 * New code goes elsewhere.
 *
 *     host-0.1.0 FOLDER        an empty folder for its files; on the CPU backend. Prints what went wrong.
 */
#include "bhr-0.1.0.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define W 48
#define H 32

static int failures;

static void expect(int good, int line, const char *what) {
    if (!good) {
        failures++;
        printf("line %d: %s: %s\n", line, what, bhr_error_message());
    }
}
#define EXPECT(condition) expect((condition) ? 1 : 0, __LINE__, #condition)

/* A struct of this program's with what lies behind it, which is nobody's to write. */
#define GUARD 64
#define GUARDED(type, name)           \
    struct {                          \
        type          it;             \
        unsigned char guard[GUARD];   \
    } name;                           \
    memset(&name, 0xA5, sizeof name); \
    name.it.struct_size = sizeof(type)

static int untouched(const unsigned char *guard) {
    for (int i = 0; i < GUARD; i++) {
        if (guard[i] != 0xA5) {
            return 0;
        }
    }
    return 1;
}

static unsigned char pixels[W * H * 16], again[W * H * 16];
static char          path[1000];
static unsigned      log_lines, progress_calls;

static void on_log(void *user, BhrLogLevel level, const char *message) {
    *(unsigned *)user += level >= BHR_LOG_ERROR && message != NULL;
}

static int32_t on_progress(void *user, double fraction) {
    *(unsigned *)user += fraction >= 0.0 && fraction <= 1.0;
    return 1;
}

static BhrImage image_of(BhrFormat format, void *memory) {
    BhrImage image;
    EXPECT(bhr_image_init(&image, sizeof image) == BHR_OK);
    EXPECT(image.struct_size == sizeof image && image.format == BHR_FORMAT_RGBA8_SRGB && image.flags == 0);
    image.format = format;
    image.width = W;
    image.height = H;
    image.pixels = memory;
    image.byte_size = sizeof pixels;
    return image;
}

static void names(void) {
    EXPECT(bhr_abi_version() == BHR_ABI_VERSION);
    EXPECT(bhr_version() >= (BHR_VERSION_MAJOR << 16 | BHR_VERSION_MINOR << 8 | BHR_VERSION_PATCH));
    EXPECT(bhr_version_string()[0] != '\0');
    EXPECT(strcmp(bhr_status_name(BHR_ERROR_DEVICE_LOST), "BHR_ERROR_DEVICE_LOST") == 0);
}

static void adapters(void) {
    uint32_t count = 0;
    EXPECT(bhr_adapter_count(&count) == BHR_OK && count >= 1);
    GUARDED(BhrAdapterInfo, info);
    EXPECT(bhr_adapter_info(count - 1, &info.it) == BHR_OK && untouched(info.guard));
    EXPECT(info.it.struct_size == sizeof info.it && info.it.backend == BHR_BACKEND_CPU);
    EXPECT((info.it.flags & BHR_ADAPTER_SOFTWARE) && info.it.name[0] != '\0' && info.it.driver[0] != '\0');
    EXPECT(bhr_adapter_info(count, &info.it) == BHR_ERROR_INVALID_ARGUMENT);
}

static BhrContext *context_of_cpu(void) {
    BhrContext *context = NULL;
    GUARDED(BhrContextOptions, options);
    EXPECT(bhr_context_options_init(&options.it, sizeof options.it) == BHR_OK && untouched(options.guard));
    EXPECT(options.it.backend == BHR_BACKEND_AUTO && options.it.adapter_index == -1 && options.it.cpu_threads == 0);
    EXPECT(options.it.log_level == BHR_LOG_WARN && options.it.log_fn == NULL && options.it.compatible_window == NULL);
    options.it.backend = BHR_BACKEND_CPU;
    options.it.cpu_threads = 2;
    options.it.log_fn = on_log;
    options.it.log_user = &log_lines;
    EXPECT(bhr_context_create(BHR_ABI_VERSION + 1, &options.it, &context) == BHR_ERROR_INCOMPATIBLE_ABI);
    EXPECT(bhr_context_create(BHR_ABI_VERSION, &options.it, &context) == BHR_OK && context != NULL);
    GUARDED(BhrAdapterInfo, info);
    EXPECT(bhr_context_adapter(context, &info.it) == BHR_OK && untouched(info.guard));
    EXPECT(info.it.backend == BHR_BACKEND_CPU);
    EXPECT(bhr_context_recover(context) == BHR_OK);
    return context;
}

static void hole(BhrContext *context) {
    static const double axis[3] = {0.0, 0.0, 2.0}, at[3] = {10.0, 1.0, 2.0};
    double              mass, spin, got[3], metric[16], gamma[64];
    EXPECT(bhr_set_mass(context, 2.0) == BHR_OK && bhr_set_spin(context, 0.5) == BHR_OK);
    EXPECT(bhr_set_axis(context, axis) == BHR_OK);
    EXPECT(bhr_get_hole(context, &mass, &spin, got) == BHR_OK);
    EXPECT(mass == 2.0 && spin == 0.5 && got[0] == 0.0 && got[1] == 0.0 && got[2] > 0.0);
    EXPECT(bhr_metric_at(context, at, metric) == BHR_OK && metric[0] < 0.0 && metric[5] > 0.0);
    EXPECT(bhr_christoffel_at(context, at, gamma) == BHR_OK && isfinite(gamma[0]));
    EXPECT(bhr_set_mass(context, 1.0) == BHR_OK && bhr_set_spin(context, 0.0) == BHR_OK);
    GUARDED(BhrHoleInfo, info);
    EXPECT(bhr_hole_info(context, &info.it) == BHR_OK && untouched(info.guard));
    EXPECT(info.it.horizon_radius == 2.0 && fabs(info.it.isco_prograde - 6.0) < 1e-9);
    EXPECT(fabs(info.it.photon_orbit_retrograde - 3.0) < 1e-9 && fabs(info.it.photon_orbit_prograde - 3.0) < 1e-9);
    EXPECT(fabs(info.it.critical_impact_parameter - sqrt(27.0)) < 1e-9 && info.it.shadow_angular_radius > 0.0);
    EXPECT(info.it.camera_radius > 20.0 && info.it.camera_time_rate < 1.0 && info.it.isco_retrograde > 5.9);
    EXPECT(info.it.ergosphere_equatorial_radius == 2.0);
}

static void camera(BhrContext *context) {
    static const double position[3] = {0.0, -20.0, 3.0}, target[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
    double              time = -1.0;
    GUARDED(BhrCamera, camera);
    EXPECT(bhr_camera_init(&camera.it, sizeof camera.it) == BHR_OK && untouched(camera.guard));
    EXPECT(camera.it.projection == BHR_PROJECTION_PERSPECTIVE && camera.it.motion == BHR_MOTION_STATIC);
    EXPECT(fabs(camera.it.position[1]) > 20.0 && camera.it.position[2] > 0.0); /* since 0.2.0 not at (0, -30, 5) */
    EXPECT(bhr_camera_look_at(&camera.it, position, target, up) == BHR_OK && untouched(camera.guard));
    EXPECT(camera.it.position[1] == -20.0 && camera.it.forward[1] > 0.0);
    EXPECT(bhr_camera_orbit(&camera.it, 25.0, 0.0, 0.15) == BHR_OK && untouched(camera.guard));
    EXPECT(bhr_set_camera(context, &camera.it) == BHR_OK);
    GUARDED(BhrCamera, got);
    EXPECT(bhr_get_camera(context, &got.it) == BHR_OK && untouched(got.guard));
    EXPECT(memcmp(&got.it, &camera.it, sizeof got.it) == 0);
    EXPECT(bhr_camera_advance(context, &got.it, 1.0, &time) == BHR_OK && untouched(got.guard));
    EXPECT(time > 1.0 && memcmp(&got.it, &camera.it, sizeof got.it) == 0);
}

static void scene(BhrContext *context) {
    int32_t present = 0;
    GUARDED(BhrDisk, disk);
    GUARDED(BhrSky, sky);
    GUARDED(BhrFilm, film);
    GUARDED(BhrQuality, quality);
    EXPECT(bhr_disk_init(&disk.it, sizeof disk.it) == BHR_OK && untouched(disk.guard));
    EXPECT(disk.it.turbulence == 0.0 && disk.it.seed == 0);
    disk.it.outer_radius = 15.0;
    EXPECT(bhr_set_disk(context, &disk.it) == BHR_OK);
    memset(&disk.it, 0xA5, sizeof disk.it);
    disk.it.struct_size = sizeof disk.it;
    EXPECT(bhr_get_disk(context, &disk.it, &present) == BHR_OK && untouched(disk.guard));
    EXPECT(present == 1 && disk.it.outer_radius == 15.0 && disk.it.struct_size == sizeof disk.it);

    EXPECT(bhr_sky_init(&sky.it, sizeof sky.it) == BHR_OK && untouched(sky.guard));
    EXPECT(sky.it.flags == (BHR_SKY_STARS | BHR_SKY_MILKY_WAY) && sky.it.stars_brightness == 1.0);
    sky.it.flags = BHR_SKY_STARS | BHR_SKY_MAP;
    EXPECT(bhr_set_sky(context, &sky.it) == BHR_OK && bhr_get_sky(context, &sky.it) == BHR_OK && untouched(sky.guard));
    EXPECT(sky.it.flags == (BHR_SKY_STARS | BHR_SKY_MAP) && sky.it.map_brightness == 1.0 && sky.it.seed == 0);
    EXPECT(sky.it.orientation[0] + sky.it.orientation[1] + sky.it.orientation[2] + sky.it.orientation[3] == 1.0);
    memset(again, 0x40, sizeof again);
    const BhrImage map = image_of(BHR_FORMAT_RGBA8_SRGB, again);
    EXPECT(bhr_set_sky_map(context, &map) == BHR_OK);

    EXPECT(bhr_film_init(&film.it, sizeof film.it) == BHR_OK && untouched(film.guard));
    EXPECT(film.it.tone_map == BHR_TONE_MAP_ACES && film.it.exposure_ev == 0.0 && film.it.bloom == 0.0);
    EXPECT(bhr_set_film(context, &film.it) == BHR_OK && bhr_get_film(context, &film.it) == BHR_OK);
    EXPECT(untouched(film.guard) && film.it.struct_size == sizeof film.it);

    EXPECT(bhr_quality_init(&quality.it, sizeof quality.it) == BHR_OK && untouched(quality.guard));
    EXPECT(quality.it.method == BHR_METHOD_AUTO && quality.it.samples_per_pixel == 1 && quality.it.max_steps == 2000);
    EXPECT(quality.it.step == 0.0 && quality.it.tolerance == 0.0 && quality.it.max_disk_order == 3);
    EXPECT(bhr_set_quality(context, &quality.it) == BHR_OK && bhr_get_quality(context, &quality.it) == BHR_OK);
    EXPECT(untouched(quality.guard) && quality.it.render_scale == 1.0);

    EXPECT(bhr_set_effects(context, BHR_EFFECT_ALL) == BHR_OK && bhr_set_time(context, 3.0) == BHR_OK);
    EXPECT(bhr_set_view(context, BHR_VIEW_LIGHT) == BHR_OK && bhr_set_view(context, 77) == BHR_ERROR_INVALID_ARGUMENT);
}

static void frames(BhrContext *context) {
    BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, pixels), part = image_of(BHR_FORMAT_RGBA8_SRGB, again);
    EXPECT(bhr_set_progress(context, on_progress, &progress_calls) == BHR_OK);
    EXPECT(bhr_render_image(context, &image) == BHR_OK && progress_calls > 0);
    EXPECT(bhr_set_progress(context, NULL, NULL) == BHR_OK);
    GUARDED(BhrFrameStats, stats);
    EXPECT(bhr_frame_stats(context, &stats.it) == BHR_OK && untouched(stats.guard));
    EXPECT(stats.it.frame_index == 1 && stats.it.rays == W * H && stats.it.steps > 0 && stats.it.gpu_ns == 0);

    /* Its lower half, as part of the frame; bottom-up. */
    GUARDED(BhrRegion, region);
    memset(&region.it, 0, sizeof region.it);
    region.it.struct_size = sizeof region.it;
    region.it.full_width = W;
    region.it.full_height = H;
    region.it.y = H / 2;
    EXPECT(bhr_set_region(context, &region.it) == BHR_OK);
    part.height = H / 2;
    part.row_stride = -4 * W;
    part.pixels = again + 4 * W * (H / 2 - 1);
    EXPECT(bhr_render_image(context, &part) == BHR_OK);
    for (int y = 0; y < H / 2; y++) {
        EXPECT(memcmp(again + 4 * W * (H / 2 - 1 - y), pixels + 4 * W * (H / 2 + y), 4 * W) == 0);
    }
    EXPECT(bhr_set_region(context, NULL) == BHR_OK);

    /* The same by a job. */
    BhrJob        *job = NULL;
    double         fraction = 0.0;
    const BhrImage target = image_of(BHR_FORMAT_RGBA8_SRGB, again);
    EXPECT(bhr_render_image_async(context, &target, &job) == BHR_OK && job != NULL);
    EXPECT(bhr_job_wait(job, UINT64_MAX, &fraction) == BHR_OK && fraction == 1.0);
    EXPECT(memcmp(again, pixels, 4 * W * H) == 0);
    EXPECT(bhr_job_stats(job, &stats.it) == BHR_OK && untouched(stats.guard) && stats.it.rays == W * H);
    bhr_job_cancel(job);
    bhr_job_destroy(job);

    /* And by a file. */
    BhrImage loaded;
    memset(&loaded, 0, sizeof loaded);
    loaded.struct_size = sizeof loaded;
    EXPECT(bhr_image_save(&image, path) == BHR_OK && bhr_image_load(path, &loaded) == BHR_OK);
    EXPECT(loaded.width == W && loaded.height == H && loaded.format == BHR_FORMAT_RGBA8_SRGB);
    EXPECT(loaded.pixels != NULL && memcmp(loaded.pixels, pixels, 4 * W * H) == 0);
    EXPECT(bhr_image_release(&loaded) == BHR_OK && loaded.pixels == NULL);

    /* Other formats, and views. */
    image.format = BHR_FORMAT_RGBA32F;
    image.flags = BHR_IMAGE_TRANSPARENT;
    EXPECT(bhr_render_image(context, &image) == BHR_OK);
    image.flags = 0;
    image.format = BHR_FORMAT_R32F;
    EXPECT(bhr_render_image(context, &image) == BHR_ERROR_INVALID_ARGUMENT && log_lines > 0);
    EXPECT(bhr_set_view(context, BHR_VIEW_DEFLECTION) == BHR_OK && bhr_render_image(context, &image) == BHR_OK);
    EXPECT(bhr_set_view(context, BHR_VIEW_LIGHT) == BHR_OK);
    EXPECT(bhr_set_sky_map(context, NULL) == BHR_OK && bhr_set_disk(context, NULL) == BHR_OK);
    EXPECT(bhr_set_sky(context, NULL) == BHR_OK);
}

/* There is no window here: the calls must say so. */
static void surfaces(BhrContext *context) {
    GUARDED(BhrWindow, window);
    BhrSurface *surface = (BhrSurface *)pixels;
    memset(&window.it, 0, sizeof window.it);
    window.it.struct_size = sizeof window.it;
    window.it.kind = BHR_WINDOW_XLIB;
    EXPECT(bhr_surface_create(context, &window.it, W, H, BHR_PRESENT_VSYNC, &surface) == BHR_ERROR_INVALID_ARGUMENT);
    EXPECT(strstr(bhr_error_message(), "display") != NULL && surface == NULL);
    EXPECT(bhr_surface_resize(NULL, W, H) == BHR_ERROR_INVALID_ARGUMENT);
    EXPECT(bhr_surface_set_present_mode(NULL, BHR_PRESENT_VSYNC) == BHR_ERROR_INVALID_ARGUMENT);
    EXPECT(bhr_render_surface(context, NULL) == BHR_ERROR_INVALID_ARGUMENT);
    bhr_surface_destroy(NULL);
}

static void rays(BhrContext *context) {
    static struct {
        BhrRay        all[W * H];
        unsigned char guard[GUARD];
    } rays;
    static struct {
        BhrHit        all[W * H];
        unsigned char guard[GUARD];
    } hits;
    struct {
        BhrRay        it;
        unsigned char guard[GUARD];
    } one;
    static double points[4 * 50];
    uint32_t      count = 0, captured = 0, escaped = 0, crossed = 0;
    memset(&rays, 0xA5, sizeof rays);
    memset(&hits, 0xA5, sizeof hits);
    memset(&one, 0xA5, sizeof one);
    EXPECT(bhr_camera_rays(context, W, H, rays.all) == BHR_OK && untouched(rays.guard));
    EXPECT(bhr_camera_ray(context, W, H, 7.5, 5.5, &one.it) == BHR_OK && untouched(one.guard));
    EXPECT(memcmp(&one.it, &rays.all[5 * W + 7], sizeof one.it) == 0 && one.it.frequency_ratio == 1.0);
    EXPECT(bhr_trace_rays(context, rays.all, sizeof(BhrRay), W * H, hits.all, sizeof(BhrHit)) == BHR_OK);
    EXPECT(untouched(hits.guard));
    for (int i = 0; i < W * H; i++) {
        const BhrCrossing first = hits.all[i].crossings[0];
        captured += hits.all[i].fate == BHR_FATE_CAPTURED;
        escaped += hits.all[i].fate == BHR_FATE_ESCAPED;
        EXPECT(hits.all[i].crossing_count <= BHR_MAX_CROSSINGS);
        crossed += hits.all[i].crossing_count > 0 && first.radius > 2.0;
    }
    EXPECT(captured > 20 && escaped > 1000 && captured + escaped == W * H && crossed > 100);
    EXPECT(bhr_trace_path(context, &one.it, 50, points, &count) == BHR_OK && count >= 2 && count <= 50);
    EXPECT(fabs(points[0] - one.it.position[0]) + fabs(points[1] - one.it.position[1]) < 1e-9 && points[3] == 0.0);
}

int main(int argc, char **argv) {
    if (argc != 2) {
        printf("usage: %s FOLDER\n", argv[0]);
        return 2;
    }
    snprintf(path, sizeof path, "%s/frame.png", argv[1]);
    names();
    adapters();
    BhrContext *context = context_of_cpu();
    if (context == NULL) {
        return 1;
    }
    hole(context);
    camera(context);
    scene(context);
    frames(context);
    surfaces(context);
    rays(context);
    bhr_context_destroy(context);
    printf("%d failed\n", failures);
    return failures != 0;
}
