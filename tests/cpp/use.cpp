// SPDX-License-Identifier: MIT OR Apache-2.0
/* use.cpp -- a C++ host of bhr.hpp that does all that a context can do without a window, on the CPU backend. It is
 * compiled with and without exceptions, as C++17 and C++20 (tests/cpp/run).
 *
 *     use FOLDER        an empty folder for its files. Prints what went wrong; the exit status is 0 if nothing did.
 *     use hook          value() without a value, where there are no exceptions: the hook ends the program with 7
 */
#include <bhr.hpp>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

#define WIDTH 48
#define HEIGHT 32

static std::atomic<int> failures{0};

static void expect(bool good, int line, const char *text) {
    if (!good) {
        failures++;
        std::printf("line %d: %s: %s\n", line, text, bhr_error_message());
    }
}
#define EXPECT(...) expect(static_cast<bool>(__VA_ARGS__), __LINE__, #__VA_ARGS__)

static bool near(double a, double b) { return std::fabs(a - b) <= 1e-12 * std::fabs(b); }

static bhr::Context made(bhr::LogFunction log = {}) {
    bhr::ContextOptions options(bhr::Backend::cpu);
    options.log_level = bhr::LogLevel::error;
    return bhr::Context::create(options, std::move(log)).value();
}

/* ---- the library, adapters, errors ---- */

static void library() {
    EXPECT(bhr::abi_version() == BHR_ABI_VERSION && bhr::version() == bhr_version());
    EXPECT(std::strcmp(bhr::version_string(), bhr_version_string()) == 0);
    EXPECT(std::strcmp(bhr::name(bhr::StatusCode::device_lost), "BHR_ERROR_DEVICE_LOST") == 0);
    const std::uint32_t count = bhr::adapter_count().value();
    const bhr::AdapterInfo last = bhr::adapter_info(count - 1).value();
    EXPECT(last.backend == bhr::Backend::cpu && bhr::has(last.flags, bhr::AdapterFlags::software) && last.name[0]);
    const bhr::Result<bhr::AdapterInfo> none = bhr::adapter_info(count);
    EXPECT(!none && none.status() == bhr::StatusCode::invalid_argument);
    EXPECT(std::strstr(none.error().what(), "bhr_adapter_info") != nullptr);
    bhr::ContextOptions metal(bhr::Backend::metal);
    const bhr::Result<bhr::Context> refused = bhr::Context::create(metal);
    EXPECT(!refused && refused.status() == bhr::StatusCode::no_adapter);
}

/* The message is that of the call, whatever other threads do. */
static void errors_of_threads() {
    bhr::Context context = made();
    std::thread threads[4];
    for (int i = 0; i < 4; i++) {
        threads[i] = std::thread([&context, i] {
            for (int n = 0; n < 200; n++) {
                const double spin = 2.0 + i;
                const bhr::Result<void> result = context.set_spin(spin);
                const char number[] = {static_cast<char>('2' + i), '\0'};
                EXPECT(!result && std::strstr(result.error().what(), number) != nullptr);
            }
        });
    }
    for (std::thread &thread : threads) {
        thread.join();
    }
}

/* ---- the scene ---- */

static void scene() {
    bhr::Context context = made();
    EXPECT(context.adapter().value().backend == bhr::Backend::cpu);
    EXPECT(context.set_mass(2.0) && context.set_spin(-0.5) && context.set_axis({0.0, 3.0, 0.0}));
    const bhr::Hole hole = context.hole().value();
    EXPECT(hole.mass == 2.0 && hole.spin == -0.5 && near(hole.axis[1], 1.0));
    const bhr::HoleInfo info = context.hole_info().value();
    EXPECT(near(info.horizon_radius, 2.0 + std::sqrt(3.0)) && near(info.ergosphere_equatorial_radius, 4.0));
    EXPECT(context.error_message().empty() && !context.set_spin(2.0));
    EXPECT(context.error_message().find("spin is 2;") != std::string::npos);
    EXPECT(context.set_mass(1.0) && context.set_spin(0.0) && context.set_axis({0.0, 0.0, 1.0}));
    EXPECT(near(context.metric_at({10.0, 0.0, 0.0}).value()[0], -0.8));
    EXPECT(near(context.christoffel_at({10.0, 0.0, 0.0}).value()[16 * 0 + 4 * 0 + 1], 0.0125));
    EXPECT(!context.metric_at({0.0, 0.0, 0.0}));

    bhr::Camera camera;
    EXPECT(camera.projection == bhr::Projection::perspective && camera.position[1] == 26.0 && camera.up[2] == 1.0);
    EXPECT(camera.look_at({20.0, 0.0, 1.0}, {0.0, 0.0, 0.0}) && camera.position[0] == 20.0);
    EXPECT(!camera.orbit(-1.0, 0.0, 0.0) && camera.position[0] == 20.0);
    EXPECT(camera.orbit(20.0, 0.0, 0.1));
    bhr::Camera on_lens = camera;
    EXPECT(on_lens.through_lens(0.5, 20.0, 1.5, 1, 16) && on_lens.projection == bhr::Projection::frustum);
    EXPECT(!on_lens.through_lens(0.5, 20.0, 1.5, 16, 16));
    const auto flags = bhr::MatrixFlags::zero_to_one | bhr::MatrixFlags::reversed;
    const bhr::CameraMatrices seen_by = camera.matrices(16, 9, 0.1, INFINITY, flags).value();
    bhr::Camera again;
    EXPECT(again.from_matrices(seen_by.view, seen_by.projection) && again.projection == bhr::Projection::frustum);
    EXPECT(std::fabs(again.position[0] - camera.position[0]) < 1e-12 && again.tan_up > 0.0);
    EXPECT(!camera.matrices(0, 9, 0.1, 1.0) && !again.from_matrices(seen_by.projection, seen_by.view));
    camera.motion = bhr::Motion::free_fall;
    EXPECT(context.set_camera(camera));
    EXPECT(context.camera().value().motion == bhr::Motion::free_fall);
    const double gone = context.advance(camera, 1.0).value();
    EXPECT(gone > 1.0 && std::hypot(camera.position[0], camera.position[2]) < 20.0);
    camera.chart = bhr::Chart::rain;
    camera.transport = bhr::Transport::parallel;
    EXPECT(context.set_camera(camera) && context.camera().value().chart == bhr::Chart::rain);
    camera.chart = bhr::Chart::static_;
    camera.transport = bhr::Transport::triad;
    camera.motion = bhr::Motion::static_;
    EXPECT(camera.orbit(20.0, 0.0, 0.1) && context.set_camera(camera));

    EXPECT(context.disk().value().has_value());
    bhr::Disk disk;
    EXPECT(disk.outer_radius == 17.0 && disk.reference == bhr::DiskReference::at_median);
    disk.flags = bhr::DiskFlags::retrograde | bhr::DiskFlags::plunges;
    disk.emission_law = bhr::EmissionLaw::limb_darkened;
    EXPECT(context.set_disk(disk));
    disk.flags = context.disk().value()->flags;
    EXPECT(bhr::has(disk.flags, bhr::DiskFlags::plunges));
    disk.flags &= ~bhr::DiskFlags::plunges;
    EXPECT(disk.flags == bhr::DiskFlags::retrograde);
    EXPECT(context.set_disk(std::nullopt) && !context.disk().value().has_value());

    bhr::Volume volume;
    EXPECT(volume.outer_radius == 17.0 && volume.tint[2] == 1.0 && volume.shape == bhr::VolumeShape::disk);
    volume.shape = bhr::VolumeShape::halo;
    EXPECT(volume.turbulence == 1.0 && volume.clumping == 1.8 && volume.heating == 0.15 && volume.seed == 0);
    volume.flow = bhr::Flow::angular_momentum;
    volume.flags = bhr::VolumeFlags::power_law;
    const bhr::Volume two[] = {volume, bhr::Volume()};
    EXPECT(context.volumes().value().empty() && context.set_volumes(two));
    EXPECT(context.volumes().value().size() == 2 && context.volumes().value()[0].flow == volume.flow);
    EXPECT(!context.set_volumes(std::vector<bhr::Volume>(bhr::max_volumes + 1)));
    bhr::HotSpot spot;
    spot.flags = bhr::HotSpotFlags::thermal | bhr::HotSpotFlags::retrograde;
    EXPECT(context.set_hot_spots(std::vector<bhr::HotSpot>(bhr::max_hot_spots, spot)));
    EXPECT(context.hot_spots().value().size() == 8 && context.hot_spots().value()[7].flags == spot.flags);
    EXPECT(context.set_volumes(bhr::span<const bhr::Volume>(two, 1)) && context.set_hot_spots({}));
    const std::vector<bhr::Transfer> seen = context.transfer(context.camera_rays(2, 2).value()).value();
    EXPECT(seen.size() == 4 && seen[0].intensity > 0.0 && seen[0].fate != bhr::Fate::invalid);
    EXPECT(context.set_volumes({}) && context.volumes().value().empty());

    bhr::Sky sky;
    EXPECT(sky.flags == (bhr::SkyFlags::stars | bhr::SkyFlags::milky_way));
    sky.flags = bhr::SkyFlags::grid;
    sky.orientation = {0.0, 0.0, 1.0, 0.0};
    EXPECT(context.set_sky(sky) && context.sky().value().orientation[2] == 1.0);
    bhr::Film film;
    film.tone_map = bhr::ToneMap::agx;
    film.bloom = 0.0;
    EXPECT(context.set_film(film) && context.film().value().tone_map == bhr::ToneMap::agx);
    EXPECT(context.set_effects(bhr::Effects::all & ~bhr::Effects::beaming));
    EXPECT(!bhr::has(context.effects().value(), bhr::Effects::beaming));
    EXPECT(context.set_effect_strength(bhr::Effects::beaming | bhr::Effects::doppler_shift, 0.25));
    EXPECT(context.effect_strength(bhr::Effects::beaming).value() == 0.25);
    EXPECT(!context.set_effect_strength(bhr::Effects::light_delay, 0.25));
    EXPECT(context.set_time(12.5) && context.time().value() == 12.5);
    EXPECT(context.set_shutter(0.5) && context.shutter().value() == 0.5 && context.set_shutter(0.0));
    bhr::Quality quality;
    quality.method = bhr::Method::rk4;
    quality.volume_resolution = bhr::VolumeResolution::half;
    EXPECT(context.set_quality(quality) && context.quality().value().method == bhr::Method::rk4);
    EXPECT(context.quality().value().volume_resolution == bhr::VolumeResolution::half);
    EXPECT(context.set_preset(bhr::Preset::teaching) && context.film().value().tone_map == bhr::ToneMap::none);
    bhr::PresetOptions options;
    EXPECT(options.matter == bhr::PresetMatter::automatic && options.width == 1920 && options.frame_ms == 16.0);
    EXPECT(options.measure_anew == 0 && options.may_halve == 0);
    options.matter = bhr::PresetMatter::deep;
    EXPECT(context.set_preset_with(bhr::Preset::physical, options).value() == bhr::PresetMatter::deep);
    EXPECT(!context.disk().value() && context.volumes().value().size() == 1);
    EXPECT(context.set_preset_with(bhr::Preset::teaching, options).value() == bhr::PresetMatter::thin);
    options.frame_ms = -1.0;
    EXPECT(context.set_preset_with(bhr::Preset::physical, options).status() == bhr::StatusCode::invalid_argument);
    EXPECT(context.disk().value() && context.volumes().value().empty());
    EXPECT(context.set_sky(std::nullopt) && context.sky().value().flags == bhr::SkyFlags::none);
    const bhr::Result<void> refused = context.set_preset(static_cast<bhr::Preset>(99));
    EXPECT(!refused && refused.status() == bhr::StatusCode::invalid_argument);
    EXPECT(context.recover());
}

/* ---- frames ---- */

static void quick(bhr::Context &context) {
    EXPECT(context.set_preset(bhr::Preset::physical) && context.set_sky(std::nullopt));
}

static void frames(const std::string &folder) {
    bhr::Context context = made();
    quick(context);
    EXPECT(context.prepare() && context.frame_stats().value().frame_index == 0);
    const bhr::Frame frame = context.render(WIDTH, HEIGHT).value();
    EXPECT(frame.bytes().size() == WIDTH * HEIGHT * 4 && frame.channel<std::uint8_t>(0, 0, 3) == 255);
    const bhr::FrameStats stats = context.frame_stats().value();
    EXPECT(stats.frame_index == 1 && stats.rays == WIDTH * HEIGHT && stats.cpu_time() > std::chrono::nanoseconds(0));

    // C gives the same pixels, through the handle.
    std::vector<std::uint8_t> pixels(WIDTH * HEIGHT * 4);
    bhr::Image image(pixels, WIDTH, HEIGHT);
    EXPECT(image.format == bhr::Format::rgba8_srgb && image.byte_size == pixels.size());
    const BhrImage raw = image.c();
    EXPECT(bhr_render_image(context.get(), &raw) == BHR_OK);
    EXPECT(std::memcmp(pixels.data(), frame.bytes().data(), pixels.size()) == 0);
    EXPECT(context.prepare(image));

    // The mean of two frames of one scene is the frame.
    std::vector<std::uint8_t> mean(pixels.size());
    EXPECT(!context.accumulate() && !context.end_accumulation(bhr::Image(mean, WIDTH, HEIGHT)));
    EXPECT(context.begin_accumulation(WIDTH, HEIGHT) && context.accumulate() && context.accumulate(2.0));
    EXPECT(context.end_accumulation(bhr::Image(mean, WIDTH, HEIGHT)));
    std::size_t off = 0;
    for (std::size_t i = 0; i < mean.size(); i++) {
        off += std::size_t(std::abs(mean[i] - pixels[i]) > 1 ? 1 : 0);
    }
    EXPECT(off * 200 < mean.size());
    EXPECT(context.begin_accumulation(WIDTH, HEIGHT, bhr::ImageFlags::transparent) && context.end_accumulation());

    // Beside the picture.
    bhr::Frame depth(WIDTH, HEIGHT, bhr::output_format(bhr::OutputKind::depth));
    bhr::Frame sky(WIDTH, HEIGHT, bhr::output_format(bhr::OutputKind::sky));
    bhr::Frame order(WIDTH, HEIGHT, bhr::Format::r32f);
    const BhrImage images[] = {depth.image().c(), sky.image().c(), order.image().c(), raw};
    const bhr::Output outputs[] = {bhr::Output(bhr::OutputKind::depth, images[0]),
                                   bhr::Output(bhr::OutputKind::sky, images[1]),
                                   bhr::Output(bhr::View::order, images[2]),
                                   bhr::Output(bhr::OutputKind::light, images[3])};
    std::memset(pixels.data(), 0, pixels.size());
    EXPECT(context.render_outputs(outputs));
    EXPECT(std::memcmp(pixels.data(), frame.bytes().data(), pixels.size()) == 0);
    EXPECT(sky.channel<float>(0, 0, 3) > 0.5f && order.channel<float>(0, 0) == -1.0f);
    EXPECT(context.set_occluder(depth.image()) && context.render(image) && context.set_occluder(std::nullopt));
    bhr::Job beside = context.render_outputs_async(bhr::span<const bhr::Output>(outputs, 3)).value();
    EXPECT(beside.wait());
    EXPECT(!context.render_outputs({}) && bhr::max_outputs == 8);
    EXPECT(context.save_outputs(bhr::span<const bhr::Output>(outputs, 3), folder + "/outputs.exr"));
    EXPECT(context.save_outputs(outputs, folder + "/eight.exr").status() == bhr::StatusCode::unsupported);

    // Without the sky: PNG files of such frames have straight colours.
    const bhr::Frame clear =
        context.render(WIDTH, HEIGHT, bhr::Format::rgba8_srgb, bhr::ImageFlags::transparent).value();
    EXPECT(clear.is_transparent() && !frame.is_transparent() && clear.save(folder + "/clear.png"));

    // Floats, upside down, and a quarter of the frame.
    float light[HEIGHT][WIDTH][4];
    EXPECT(context.render(bhr::Image(light, WIDTH, HEIGHT, bhr::Format::rgba32f)));
    bhr::Image upside = bhr::Image(pixels, WIDTH, HEIGHT);
    upside.flags = bhr::ImageFlags::bottom_up;
    EXPECT(context.render(upside));
    EXPECT(std::memcmp(pixels.data(), frame.bytes().data() + (HEIGHT - 1) * WIDTH * 4, WIDTH * 4) == 0);
    bhr::Region region;
    region.full_width = WIDTH;
    region.full_height = HEIGHT;
    region.x = WIDTH / 2;
    EXPECT(!context.region().value());
    EXPECT(context.set_region(region) && context.region().value()->x == WIDTH / 2);
    const bhr::Frame half = context.render(WIDTH / 2, HEIGHT).value();
    EXPECT(half.channel<std::uint32_t>(0, 20) == frame.channel<std::uint32_t>(WIDTH / 2, 20));
    EXPECT(context.set_region(std::nullopt));
    EXPECT(!context.scene_pictures() && !context.scene_at(1.0));
    const std::string text = context.save_scene().value();
    EXPECT(context.load_scene("time = { keys = [[0, 0], [2, 8]] }\n[render]\nwidth = 7"));
    EXPECT(context.scene_at(1.0) && context.time().value() == 4.0);
    EXPECT(context.scene_pictures().value().width == 7 && context.scene_pictures().value().count == 1);
    EXPECT(!context.load_scene("[hole]\nspin = 2") && context.time().value() == 4.0);
    EXPECT(!context.load_scene_file("nowhere.toml") && !context.set_sky_map_file("nowhere.png"));
    EXPECT(!context.save_sky_map("nowhere.ktx2"));
    EXPECT(!context.save_scene_file("nowhere/scene.toml"));
    const std::vector<float> grey(3 * 2 * 2 * 2, 0.5f);
    EXPECT(!context.set_film_lut_file("nowhere.cube") && !context.set_film_lut(grey, 3));
    EXPECT(context.set_film_lut(grey, 2) && context.set_film_lut({}, 0));
    EXPECT(context.load_scene(text) && context.save_scene().value() == text);
    EXPECT(context.render(WIDTH, 0).status() == bhr::StatusCode::invalid_argument);
    EXPECT(context.render(1u << 21, 1).status() == bhr::StatusCode::invalid_argument);
    EXPECT(context.render(1u << 20, 1u << 20, bhr::Format::rgba32f).status() == bhr::StatusCode::out_of_memory);
    EXPECT(context.set_view(bhr::View::redshift) && context.view().value() == bhr::View::redshift);
    const bhr::Frame shift = context.render(WIDTH, HEIGHT, bhr::Format::r32f).value();
    EXPECT(shift.channel<float>(1, 1) > 0.5f && shift.channel<float>(1, 1) < 1.5f);
    EXPECT(context.set_view(bhr::View::light));

    // Files, and the sky's map.
    const std::string path = folder + "/frame.png";
    EXPECT(frame.save(path));
    bhr::LoadedImage loaded = bhr::LoadedImage::load(path).value();
    EXPECT(loaded.image().width == WIDTH);
    EXPECT(std::memcmp(loaded.image().pixels, frame.bytes().data(), frame.bytes().size()) == 0);
    EXPECT(context.set_sky_map(loaded.image()) && context.set_sky_map(std::nullopt));
    loaded = bhr::LoadedImage::load(path).value();
    EXPECT(bhr::LoadedImage::load(folder + "/absent.png").status() == bhr::StatusCode::io);
    bhr::Frame moved(1, 1);
    bhr::Frame target = std::move(moved);
    EXPECT(target.save(folder + "/dot.ppm") && !moved.save(folder + "/none.ppm"));
}

static void jobs() {
    bhr::Context context = made();
    quick(context);
    const bhr::Frame frame = context.render(WIDTH, HEIGHT).value();
    int calls = 0;
    EXPECT(context.on_progress([&calls, big = std::string(100, 'x')](double fraction) {
        calls += big.size() == 100 && fraction >= 0.0 && fraction <= 1.0;
        return true;
    }));
    bhr::Frame target(WIDTH, HEIGHT);
    bhr::Job job = context.render_async(target.image()).value();
    EXPECT(context.on_progress({})); // the job keeps the functor that it began with
    while (!job.wait_for(std::chrono::milliseconds(50)).value().done) {
    }
    EXPECT(calls > 0 && job.wait() && job.stats().value().rays == WIDTH * HEIGHT);
    EXPECT(job.wait_for(std::chrono::hours::max()).value().fraction == 1.0);
    EXPECT(std::memcmp(target.bytes().data(), frame.bytes().data(), frame.bytes().size()) == 0);

    bhr::Quality slow;
    slow.samples_per_pixel = 256;
    EXPECT(context.set_quality(slow));
    std::vector<std::uint8_t> large(512 * 512 * 4);
    bhr::Job cancelled = context.render_async(bhr::Image(large, 512, 512)).value();
    EXPECT(!cancelled.wait_for(std::chrono::nanoseconds(0)).value().done);
    EXPECT(!cancelled.stats());
    cancelled.cancel();
    EXPECT(cancelled.wait().status() == bhr::StatusCode::cancelled);
    job = std::move(cancelled);
    EXPECT(context.set_quality(bhr::Quality()));
    bhr::Job left = context.render_async(target.image()).value();
    context = made(); // ends the context before its job
    EXPECT(left.wait() && left.stats());
}

/* ---- rays ---- */

static void rays() {
    bhr::Context context = made();
    std::vector<bhr::Ray> all = context.camera_rays(8, 4).value();
    const bhr::Ray one = context.camera_ray(8, 4, 2.5, 1.5).value();
    EXPECT(all.size() == 32 && near(all[8 + 2].direction[1], one.direction[1]));
    const std::vector<bhr::Hit> hits = context.trace(all).value();
    EXPECT(hits.size() == 32 && hits[0].fate == bhr::Fate::escaped);
    bhr::Hit hit;
    bhr::Ray inward;
    inward.position = {0.0, 0.0, 30.0};
    inward.direction = {0.0, 0.0, -1.0};
    EXPECT(context.trace(bhr::span<const bhr::Ray>(&inward, 1), bhr::span<bhr::Hit>(&hit, 1)));
    EXPECT(hit.fate == bhr::Fate::captured && hit.crossing_count == 0);
    EXPECT(!context.trace(all, bhr::span<bhr::Hit>(&hit, 1)) && context.trace(bhr::span<const bhr::Ray>()));
    const bhr::ProjectedPoint label = context.project_point(8, 4, {0.0, 0.0, 0.5}, 9).value_or(bhr::ProjectedPoint());
    EXPECT(label.found == 0);
    const bhr::ProjectedPoint image = context.project_point(8, 4, {1.0, -8.0, 3.0}).value();
    EXPECT(image.found == 1 && image.magnification > 0.0 && image.delay > 0.0 && image.ray.frequency_ratio > 0.0);
    const bhr::Vector places[2] = {{1.0, -8.0, 3.0}, {0.0, 0.0, 0.0}};
    const std::vector<bhr::ProjectedPoint> several = context.project_points(8, 4, places).value();
    EXPECT(several.size() == 2 && several[0].x == image.x && several[0].distance > 0.0 && several[1].found == 0);
    const std::vector<bhr::PathPoint> path = context.trace_path(inward, 100).value();
    EXPECT(path.size() >= 2 && path.size() <= 100 && near(path[0].z, 30.0));
    EXPECT(path.back().z < 2.1 && path.back().t < 0.0);
    bhr::Body faller;
    faller.position = {0.0, 12.0, 0.0};
    faller.chart = bhr::Chart::rain;
    const double times[3] = {0.0, 5.0, 1000.0};
    const std::vector<bhr::Body> fall = context.world_line(faller, times).value();
    EXPECT(fall.size() == 3 && near(fall[0].position[1], 12.0) && near(fall[1].time, 5.0));
    EXPECT(fall[1].proper_time == 5.0 && fall[1].end == bhr::WorldLineEnd::goes_on);
    EXPECT(near(std::pow(fall[1].position[1], 1.5), std::pow(12.0, 1.5) - 7.5 * std::sqrt(2.0)));
    EXPECT(fall[2].end == bhr::WorldLineEnd::inner_horizon && fall[2].proper_time < 20.0);
    faller.velocity = {0.0, 1.0, 0.0};
    EXPECT(!context.world_line(faller, times) && context.world_line(faller, {}).value().empty());
    EXPECT(!context.trace_path(inward, 1) && !context.camera_ray(8, 4, NAN, 0.0) && !context.camera_rays(0, 4));
}

/* ---- functors ---- */

static void functors() {
    std::atomic<int> lines{0};
    bhr::Context context = made([&lines](bhr::LogLevel level, std::string_view message) {
        lines += level == bhr::LogLevel::error && message.find("spin") != std::string_view::npos;
    });
    EXPECT(!context.set_spin(2.0) && lines == 1);
    quick(context);
    EXPECT(context.on_progress([](double) { return false; }));
    EXPECT(context.render(WIDTH, HEIGHT).status() == bhr::StatusCode::cancelled);
    bhr::Context moved = std::move(context); // what C was told of the functors stays where it is
    EXPECT(moved.render(WIDTH, HEIGHT).status() == bhr::StatusCode::cancelled && !moved.set_spin(2.0) && lines >= 2);
    EXPECT(moved.on_progress([&moved](double) {
        EXPECT(moved.set_spin(0.5).status() == bhr::StatusCode::invalid_state);
        EXPECT(moved.on_progress({}).status() == bhr::StatusCode::invalid_state);
        return true;
    }));
    EXPECT(moved.render(WIDTH, HEIGHT) && moved.on_progress({}) && moved.render(WIDTH, HEIGHT));
}

static void windows() {
    bhr::Context context = made();
    int object = 0;
    const bhr::Window window = bhr::Window::wayland(&object, &object);
    EXPECT(window.kind == bhr::WindowKind::wayland && window.c().display == &object);
    EXPECT(bhr::Window::xcb(&object, 7).c().id == 7 && bhr::Window::xlib(&object, 7).kind == bhr::WindowKind::xlib);
    EXPECT(bhr::Window::win32(&object).handle == &object);
    EXPECT(bhr::Window::appkit(&object).kind == bhr::WindowKind::appkit);
    // Real windows are tests/windows' matter; one without a display is refused.
    const bhr::Result<bhr::Surface> none = context.create_surface(bhr::Window::xlib(nullptr, 0), 8, 8);
    EXPECT(!none && none.status() == bhr::StatusCode::invalid_argument);
    static_assert(!std::is_copy_constructible_v<bhr::Surface> && std::is_nothrow_move_constructible_v<bhr::Surface>);
    static_assert(!std::is_copy_constructible_v<bhr::Context> && std::is_nothrow_move_constructible_v<bhr::Context>);
    static_assert(!std::is_copy_constructible_v<bhr::Job> && std::is_nothrow_move_constructible_v<bhr::Job>);
}

#ifndef BHR_NO_EXCEPTIONS
static bool throws(const char *what, const std::function<void()> &call) {
    try {
        call();
    } catch (const std::exception &error) {
        return std::strcmp(error.what(), what) == 0;
    }
    return false;
}

static void exceptions() {
    bhr::Context context = made();
    quick(context);
    try {
        context.set_spin(2.0).value();
        EXPECT(false);
    } catch (const bhr::Error &error) {
        EXPECT(error.status() == bhr::StatusCode::invalid_argument && std::strstr(error.what(), "spin"));
    }
    // The progress functor's exception comes out of the call that it was thrown in, of a job's wait too.
    int calls = 0;
    EXPECT(context.on_progress([&calls](double) -> bool {
        calls++;
        throw std::runtime_error("halt");
    }));
    EXPECT(throws("halt", [&] { static_cast<void>(context.render(WIDTH, HEIGHT)); }) && calls == 1);
    bhr::Frame target(WIDTH, HEIGHT);
    bhr::Job job = context.render_async(target.image()).value();
    EXPECT(throws("halt", [&] { static_cast<void>(job.wait()); }));
    EXPECT(context.on_progress({}) && context.render(target.image()));
    // A log functor's too; a destructor throws nothing.
    bool angry = true;
    bhr::Context logging = made([&angry](bhr::LogLevel, std::string_view) {
        if (angry) {
            throw std::runtime_error("log");
        }
    });
    EXPECT(throws("log", [&] { static_cast<void>(logging.set_spin(2.0)); }));
    EXPECT(throws("log", [&] { static_cast<void>(logging.metric_at({0.0, 0.0, 0.0})); }));
    angry = false;
    EXPECT(!logging.set_spin(2.0) && logging.set_spin(0.5));
}
#endif

int main(int count, char **arguments) {
    if (count == 2 && std::strcmp(arguments[1], "hook") == 0) {
        bhr::failure_hook = [](const bhr::Error &error) {
            std::puts(error.what());
            std::exit(7);
        };
        bhr::adapter_info(1u << 30).value();
        return 1;
    }
    if (count != 2) {
        std::fprintf(stderr, "usage: %s FOLDER | hook\n", arguments[0]);
        return 2;
    }
    library();
    errors_of_threads();
    scene();
    frames(arguments[1]);
    jobs();
    rays();
    functors();
    windows();
#ifndef BHR_NO_EXCEPTIONS
    exceptions();
#endif
    std::printf("%d failed\n", failures.load());
    return failures == 0 ? 0 : 1;
}
