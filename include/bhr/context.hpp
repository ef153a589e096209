// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/context.hpp -- contexts of bhr.h as C++ objects that end themselves. Include bhr.hpp. */
#ifndef BHR_CONTEXT_HPP
#define BHR_CONTEXT_HPP

#include "camera.hpp"
#include "handles.hpp"
#include "image.hpp"
#include "output.hpp"

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace bhr {

/// BhrContextOptions, with the defaults of bhr_context_options_init.
struct ContextOptions {
    std::uint32_t struct_size;
    ContextFlags flags;
    Backend backend;
    std::int32_t adapter_index;
    std::uint32_t cpu_threads;
    LogLevel log_level;
    BhrLogFn log_fn;
    void *log_user;
    const BhrWindow *compatible_window;

    ContextOptions() noexcept { detail::defaults(*this, bhr_context_options_init); }
    explicit ContextOptions(Backend wanted) noexcept : ContextOptions() { backend = wanted; }
    BhrContextOptions c() const noexcept { return detail::as_c<BhrContextOptions>(*this); }
};

/// A scene and what traces it (BhrContext).
class Context {
  public:
    /// bhr_context_create. `log` takes the place of the options' log_fn and log_user, where it is not empty.
    static Result<Context> create(const ContextOptions &options = {}, LogFunction log = {}) {
        return made(options, std::move(log), [](const BhrContextOptions &raw, BhrContext **handle) {
            return bhr_context_create(BHR_ABI_VERSION, &raw, handle);
        });
    }

    Context(Context &&) noexcept = default;
    /// Ends the context that it was, if any.
    Context &operator=(Context &&other) noexcept {
        if (this != &other) {
            handle_ = std::move(other.handle_);
            progress_ = std::move(other.progress_);
            log_ = std::move(other.log_);
        }
        return *this;
    }

    BhrContext *get() const noexcept { return handle_.get(); }

    /// bhr_context_adapter.
    Result<AdapterInfo> adapter() const {
        return filled<AdapterInfo, BhrAdapterInfo>(bhr_context_adapter);
    }

    /// bhr_context_recover.
    Result<void> recover() {
        return detail::call([&] { return bhr_context_recover(get()); });
    }

    /* ---- the hole ---- */

    Result<void> set_mass(double mass) {
        return detail::call([&] { return bhr_set_mass(get(), mass); });
    }
    Result<void> set_spin(double spin) {
        return detail::call([&] { return bhr_set_spin(get(), spin); });
    }
    Result<void> set_axis(const Vector &axis) {
        return detail::call([&] { return bhr_set_axis(get(), axis.data()); });
    }
    /// bhr_get_hole.
    Result<Hole> hole() const {
        return detail::ask(Hole(), [&](Hole &hole) {
            return bhr_get_hole(get(), &hole.mass, &hole.spin, hole.axis.data());
        });
    }
    /// bhr_hole_info.
    Result<HoleInfo> hole_info() const { return filled<HoleInfo, BhrHoleInfo>(bhr_hole_info); }
    /// bhr_metric_at: g_ab at 4 a + b.
    Result<std::array<double, 16>> metric_at(const Vector &position) const {
        using Numbers = std::array<double, 16>;
        return detail::ask(Numbers(), [&](Numbers &metric) {
            return bhr_metric_at(get(), position.data(), metric.data());
        });
    }
    /// bhr_christoffel_at: Gamma^a_bc at 16 a + 4 b + c.
    Result<std::array<double, 64>> christoffel_at(const Vector &position) const {
        using Numbers = std::array<double, 64>;
        return detail::ask(Numbers(), [&](Numbers &gamma) {
            return bhr_christoffel_at(get(), position.data(), gamma.data());
        });
    }

    /* ---- camera, disk, sky, film, and what else a scene has; without a value: none ---- */

    Result<void> set_camera(const Camera &camera) { return set(bhr_set_camera, camera.c()); }
    /// bhr_get_camera.
    Result<Camera> camera() const { return filled<Camera, BhrCamera>(bhr_get_camera); }
    /// bhr_camera_advance: moves `camera`, not the context's own; the scene time that went by.
    Result<double> advance(Camera &camera, double proper_time) const {
        BhrCamera copy = camera.c();
        return detail::ask(0.0, [&](double &time) {
            const BhrStatus status = bhr_camera_advance(get(), &copy, proper_time, &time);
            if (status >= 0) {
                detail::take(camera, copy);
            }
            return status;
        });
    }

    Result<void> set_disk(const std::optional<Disk> &disk) { return set_or_none(bhr_set_disk, disk); }
    /// bhr_get_disk.
    Result<std::optional<Disk>> disk() const { return filled_or_none<Disk, BhrDisk>(bhr_get_disk); }

    /// bhr_set_volumes: all of them; an empty list for none.
    Result<void> set_volumes(span<const Volume> volumes) {
        return set_list<BhrVolume>(bhr_set_volumes, volumes);
    }
    /// bhr_get_volumes.
    Result<std::vector<Volume>> volumes() const {
        return ask_list<Volume, BhrVolume, max_volumes>(bhr_get_volumes);
    }
    /// bhr_set_hot_spots: all of them; an empty list for none.
    Result<void> set_hot_spots(span<const HotSpot> hot_spots) {
        return set_list<BhrHotSpot>(bhr_set_hot_spots, hot_spots);
    }
    /// bhr_get_hot_spots.
    Result<std::vector<HotSpot>> hot_spots() const {
        return ask_list<HotSpot, BhrHotSpot, max_hot_spots>(bhr_get_hot_spots);
    }

    Result<void> set_sky(const std::optional<Sky> &sky) { return set_or_none(bhr_set_sky, sky); }
    /// bhr_get_sky.
    Result<Sky> sky() const { return filled<Sky, BhrSky>(bhr_get_sky); }
    Result<void> set_sky_map(const std::optional<Image> &equirect) { return set_or_none(bhr_set_sky_map, equirect); }
    Result<void> set_sky_map_file(const std::string &path) {
        return detail::call([&] { return bhr_set_sky_map_file(get(), path.c_str()); });
    }
    Result<void> save_sky_map(const std::string &path) const {
        return detail::call([&] { return bhr_save_sky_map(get(), path.c_str()); });
    }

    Result<void> set_film(const Film &film) { return set(bhr_set_film, film.c()); }
    /// bhr_get_film.
    Result<Film> film() const { return filled<Film, BhrFilm>(bhr_get_film); }
    /// bhr_set_film_lut: side * side * side nodes; an empty list for none.
    Result<void> set_film_lut(span<const float> nodes, std::uint32_t side) {
        return detail::call([&] { return bhr_set_film_lut(get(), nodes.data(), nodes.size(), side); });
    }
    Result<void> set_film_lut_file(const std::string &path) {
        return detail::call([&] { return bhr_set_film_lut_file(get(), path.c_str()); });
    }

    Result<void> set_effects(Effects effects) {
        return detail::call([&] { return bhr_set_effects(get(), static_cast<std::uint32_t>(effects)); });
    }
    /// bhr_get_effects.
    Result<Effects> effects() const { return constant<Effects>(bhr_get_effects); }

    Result<void> set_effect_strength(Effects effects, double strength) {
        return detail::call(
            [&] { return bhr_set_effect_strength(get(), static_cast<std::uint32_t>(effects), strength); });
    }
    /// bhr_get_effect_strength.
    Result<double> effect_strength(Effects effect) const {
        return detail::ask(0.0, [&](double &to) {
            return bhr_get_effect_strength(get(), static_cast<std::uint32_t>(effect), &to);
        });
    }

    /// bhr_set_time: in scene lengths, which no clock counts.
    Result<void> set_time(double time) {
        return detail::call([&] { return bhr_set_time(get(), time); });
    }
    /// bhr_get_time.
    Result<double> time() const { return detail::ask(0.0, [&](double &to) { return bhr_get_time(get(), &to); }); }
    /// bhr_set_shutter: in scene lengths of time.
    Result<void> set_shutter(double shutter) {
        return detail::call([&] { return bhr_set_shutter(get(), shutter); });
    }
    /// bhr_get_shutter.
    Result<double> shutter() const {
        return detail::ask(0.0, [&](double &to) { return bhr_get_shutter(get(), &to); });
    }
    Result<void> set_preset(Preset preset) {
        return detail::call([&] { return bhr_set_preset(get(), static_cast<BhrPreset>(preset)); });
    }
    /// bhr_set_preset_with: the matter that the scene has now, thin or deep.
    Result<PresetMatter> set_preset_with(Preset preset, const PresetOptions &options) {
        return detail::ask(PresetMatter::thin, [&](PresetMatter &matter) {
            const BhrPresetOptions given = options.c();
            BhrPresetMatter chosen = BHR_PRESET_MATTER_THIN;
            const BhrStatus status = bhr_set_preset_with(get(), static_cast<BhrPreset>(preset), &given, &chosen);
            matter = static_cast<PresetMatter>(chosen);
            return status;
        });
    }
    Result<void> set_quality(const Quality &quality) { return set(bhr_set_quality, quality.c()); }
    /// bhr_get_quality.
    Result<Quality> quality() const { return filled<Quality, BhrQuality>(bhr_get_quality); }
    Result<void> set_view(View view) {
        return detail::call([&] { return bhr_set_view(get(), static_cast<BhrView>(view)); });
    }
    /// bhr_get_view.
    Result<View> view() const { return constant<View>(bhr_get_view); }
    Result<void> set_region(const std::optional<Region> &region) { return set_or_none(bhr_set_region, region); }
    /// bhr_get_region.
    Result<std::optional<Region>> region() const { return filled_or_none<Region, BhrRegion>(bhr_get_region); }

    /* ---- scenes as text ---- */

    /// bhr_scene_load: the whole scene.
    Result<void> load_scene(std::string_view text) {
        return detail::call([&] { return bhr_scene_load(get(), text.data() ? text.data() : "", text.size()); });
    }
    /// bhr_scene_load_file.
    Result<void> load_scene_file(const std::string &path) {
        return detail::call([&] { return bhr_scene_load_file(get(), path.c_str()); });
    }
    /// bhr_scene_at: what moves in the scene that was loaded, at a time in seconds.
    Result<void> scene_at(double seconds) {
        return detail::call([&] { return bhr_scene_at(get(), seconds); });
    }
    /// bhr_scene_pictures.
    Result<ScenePictures> scene_pictures() const {
        return detail::ask(ScenePictures(), [&](ScenePictures &to) {
            return bhr_scene_pictures(get(), &to.width, &to.height, &to.count, &to.rate);
        });
    }
    /// bhr_scene_save: the scene's text.
    Result<std::string> save_scene() const {
        return detail::ask(std::string(), [&](std::string &text) {
            for (;;) {
                std::size_t size = 0;
                BhrStatus status = bhr_scene_save(get(), nullptr, 0, &size);
                if (status < 0) {
                    return status;
                }
                text.resize(size);
                status = bhr_scene_save(get(), &text[0], size + 1, &size);
                // Another thread may have set a scene in between whose text is longer: again.
                if (status != BHR_ERROR_INVALID_ARGUMENT) {
                    text.resize(size);
                    return status;
                }
            }
        });
    }
    /// bhr_scene_save_file.
    Result<void> save_scene_file(const std::string &path) const {
        return detail::call([&] { return bhr_scene_save_file(get(), path.c_str()); });
    }

    /* ---- frames ---- */

    /// bhr_set_progress; an empty functor: none. The one before lives on as long as a job that began with it.
    Result<void> on_progress(ProgressFunction progress) {
        std::shared_ptr<ProgressFunction> next;
        if (progress) {
            next.reset(new ProgressFunction(std::move(progress)), detail::EndFunctor());
        }
        const BhrProgressFn function = next ? detail::on_progress : nullptr;
        Result<void> done = detail::call([&] { return bhr_set_progress(get(), function, next.get()); });
        if (done) {
            progress_.swap(next);
        }
        return done;
    }

    /// bhr_render_image.
    Result<void> render(const Image &target) { return set(bhr_render_image, target.c()); }
    /// A frame in memory of its own.
    Result<Frame> render(std::uint32_t width, std::uint32_t height, Format format = Format::rgba8_srgb,
                         ImageFlags flags = ImageFlags::none) {
        Frame frame(width, height, format);
        Image image = frame.image();
        image.flags = flags;
        frame.set_transparent(has(flags, ImageFlags::transparent));
        const bool right = width > 0 && width <= 1u << 20 && height > 0 && height <= 1u << 20;
        if (image.pixels == nullptr && right && bytes_per_pixel(format) > 0) {
            return Error(StatusCode::out_of_memory, "bhr::Context::render: there is no memory for the frame");
        }
        const Result<void> done = render(image);
        if (!done) {
            return done.error();
        }
        return frame;
    }
    /// bhr_context_error_message: of the last call that failed on this context, on whichever thread.
    [[nodiscard]] std::string error_message() const {
        return detail::message_of(bhr_context_error_message, handle_.get());
    }
    /// bhr_prepare; without a value: windows of 1920 x 1080.
    Result<void> prepare(const std::optional<Image> &target = {}) { return set_or_none(bhr_prepare, target); }

    /// bhr_begin_accumulation.
    Result<void> begin_accumulation(std::uint32_t width, std::uint32_t height, ImageFlags flags = ImageFlags::none) {
        return detail::call(
            [&] { return bhr_begin_accumulation(get(), width, height, static_cast<std::uint32_t>(flags)); });
    }
    /// bhr_accumulate.
    Result<void> accumulate(double weight = 1.0) {
        return detail::call([&] { return bhr_accumulate(get(), weight); });
    }
    /// bhr_end_accumulation; without a value: forgets the frames.
    Result<void> end_accumulation(const std::optional<Image> &target = {}) {
        return set_or_none(bhr_end_accumulation, target);
    }

    /// bhr_render_image_async.
    Result<Job> render_async(const Image &target) {
        const BhrImage image = target.c();
        return new_job([&](BhrJob **handle) { return bhr_render_image_async(get(), &image, handle); });
    }

    /// bhr_set_occluder; without a value: none.
    Result<void> set_occluder(const std::optional<Image> &distances) {
        return set_or_none(bhr_set_occluder, distances);
    }
    /// bhr_render_outputs.
    Result<void> render_outputs(span<const Output> outputs) {
        const std::vector<BhrOutput> copies = copied<BhrOutput>(outputs);
        return detail::call([&] {
            return bhr_render_outputs(get(), copies.data(), sizeof(BhrOutput), std::uint32_t(copies.size()), nullptr);
        });
    }
    /// bhr_render_outputs with a job.
    Result<Job> render_outputs_async(span<const Output> outputs) {
        const std::vector<BhrOutput> copies = copied<BhrOutput>(outputs);
        return new_job([&](BhrJob **handle) {
            const std::uint32_t count = std::uint32_t(copies.size());
            return bhr_render_outputs(get(), copies.data(), sizeof(BhrOutput), count, handle);
        });
    }
    /// bhr_save_outputs.
    Result<void> save_outputs(span<const Output> outputs, const std::string &path) const {
        const std::vector<BhrOutput> copies = copied<BhrOutput>(outputs);
        return detail::call([&] {
            const std::uint32_t count = std::uint32_t(copies.size());
            return bhr_save_outputs(get(), copies.data(), sizeof(BhrOutput), count, path.c_str());
        });
    }

    /// bhr_surface_create.
    Result<Surface> create_surface(const Window &window, std::uint32_t width, std::uint32_t height,
                                   PresentMode mode = PresentMode::vsync) {
        const BhrWindow raw = window.c();
        const auto create = [&](BhrSurface **handle) {
            return bhr_surface_create(get(), &raw, width, height, static_cast<BhrPresentMode>(mode), handle);
        };
        return detail::made<BhrSurface>(create, [](BhrSurface *handle) { return Surface(handle); });
    }

    /// bhr_render_surface.
    Result<Presented> render(Surface &surface) {
        return detail::ask(Presented::yes, [&](Presented &presented) {
            const BhrStatus status = bhr_render_surface(get(), surface.get());
            presented = status == BHR_FRAME_SKIPPED ? Presented::skipped : Presented::yes;
            return status;
        });
    }

    /// bhr_frame_stats.
    Result<FrameStats> frame_stats() const { return filled<FrameStats, BhrFrameStats>(bhr_frame_stats); }

    /* ---- rays ---- */

    /// bhr_camera_rays: row by row.
    Result<std::vector<Ray>> camera_rays(std::uint32_t width, std::uint32_t height) const {
        // The library refuses larger sides before it writes; memory is not asked for in vain.
        const bool fits = width <= (1u << 20) && height <= (1u << 20);
        std::vector<Ray> rays(fits ? static_cast<std::size_t>(width) * height + 1 : 1);
        return detail::ask(std::move(rays), [&](std::vector<Ray> &filled_in) {
            const BhrStatus status = bhr_camera_rays(get(), width, height, c_rays(filled_in.data()));
            filled_in.pop_back();
            return status;
        });
    }

    /// bhr_camera_ray.
    Result<Ray> camera_ray(std::uint32_t width, std::uint32_t height, double x, double y) const {
        return detail::ask(Ray(), [&](Ray &ray) {
            return bhr_camera_ray(get(), width, height, x, y, c_rays(&ray));
        });
    }

    /// bhr_trace_rays: what becomes of each ray, in the same order.
    Result<std::vector<Hit>> trace(span<const Ray> rays) {
        std::vector<Hit> hits(rays.size());
        Result<void> done = trace(rays, hits);
        if (!done) {
            return done.error();
        }
        return hits;
    }
    /// Traces rays into memory of the caller's, which has room for as many hits as there are rays.
    Result<void> trace(span<const Ray> rays, span<Hit> hits) {
        static_assert(sizeof(Ray) == sizeof(BhrRay) && sizeof(Hit) == sizeof(BhrHit));
        if (hits.size() < rays.size()) {
            return Error(StatusCode::invalid_argument, "bhr::Context::trace: there are fewer hits than rays");
        }
        return detail::call([&] {
            return rays.size() == 0 ? BHR_OK
                                    : bhr_trace_rays(get(), c_rays(rays.data()), sizeof(Ray), rays.size(),
                                                     reinterpret_cast<BhrHit *>(hits.data()), sizeof(Hit));
        });
    }

    /// bhr_transfer_rays: the matter with depth along each ray, in the same order.
    Result<std::vector<Transfer>> transfer(span<const Ray> rays) {
        static_assert(sizeof(Ray) == sizeof(BhrRay) && sizeof(Transfer) == sizeof(BhrTransfer));
        return detail::ask(std::vector<Transfer>(rays.size()), [&](std::vector<Transfer> &found) {
            return rays.size() == 0
                       ? BHR_OK
                       : bhr_transfer_rays(get(), c_rays(rays.data()), sizeof(Ray), rays.size(),
                                           reinterpret_cast<BhrTransfer *>(found.data()), sizeof(Transfer));
        });
    }

    /// bhr_project_point.
    Result<ProjectedPoint> project_point(std::uint32_t width, std::uint32_t height, const Vector &point,
                                         std::uint32_t order = 0) const {
        return detail::ask_struct<ProjectedPoint, BhrProjectedPoint>(
            [&](BhrProjectedPoint *to) { return bhr_project_point(get(), width, height, point.data(), order, to); });
    }
    /// bhr_project_points.
    Result<std::vector<ProjectedPoint>> project_points(std::uint32_t w, std::uint32_t h, span<const Vector> from,
                                                       std::uint32_t order = 0) const {
        return detail::ask(std::vector<ProjectedPoint>(from.size()), [&](std::vector<ProjectedPoint> &to) {
            return bhr_project_points(get(), w, h, reinterpret_cast<const double *>(from.data()), from.size(), order,
                                      reinterpret_cast<BhrProjectedPoint *>(to.data()), sizeof(ProjectedPoint)); });
    }
    /// bhr_world_line: the body in free fall after each of the proper times, in the same order.
    Result<std::vector<Body>> world_line(const Body &body, span<const double> proper_times) const {
        const BhrBody from = detail::as_c<BhrBody>(body);
        return detail::ask(std::vector<Body>(proper_times.size()), [&](std::vector<Body> &to) {
            return bhr_world_line(get(), &from, proper_times.data(), proper_times.size(),
                                  reinterpret_cast<BhrBody *>(to.data()), sizeof(Body));
        });
    }
    /// bhr_trace_path: at most `capacity` points.
    Result<std::vector<PathPoint>> trace_path(const Ray &ray, std::uint32_t capacity = 4096) {
        const std::uint32_t most = capacity < 65536 ? capacity : 65536; // it never has more
        static_assert(sizeof(PathPoint) == 4 * sizeof(double));
        return detail::ask(std::vector<PathPoint>(most + std::size_t(1)), [&](std::vector<PathPoint> &points) {
            std::uint32_t count = 0;
            const BhrStatus status = bhr_trace_path(get(), c_rays(&ray), most, &points.front().x, &count);
            points.resize(count);
            return status;
        });
    }

  private:
    friend detail::Access;
    Context(BhrContext *handle, detail::Functor<LogFunction> log) noexcept : log_(std::move(log)), handle_(handle) {}

    /// A context that `create` makes with these options and this log.
    template <class Create>
    static Result<Context> made(const ContextOptions &options, LogFunction log, Create &&create) {
        detail::Functor<LogFunction> kept;
        BhrContextOptions raw = options.c();
        if (log) {
            kept.reset(new LogFunction(std::move(log)));
            raw.log_fn = detail::on_log;
            raw.log_user = kept.get();
        }
        return detail::made<BhrContext>([&](BhrContext **handle) { return create(raw, handle); },
                                        [&](BhrContext *handle) { return Context(handle, std::move(kept)); });
    }
    /// A job that `create` begins.
    template <class Create> Result<Job> new_job(Create &&create) {
        return detail::made<BhrJob>(create, [&](BhrJob *handle) { return Job(handle, progress_); });
    }

    static BhrRay *c_rays(Ray *rays) noexcept { return reinterpret_cast<BhrRay *>(rays); }
    static const BhrRay *c_rays(const Ray *rays) noexcept { return reinterpret_cast<const BhrRay *>(rays); }

    template <class C, class T> static std::vector<C> copied(span<const T> list) {
        std::vector<C> copies;
        for (std::size_t i = 0; i < list.size(); i++) {
            copies.push_back(list.data()[i].c());
        }
        return copies;
    }

    template <class C, class T>
    Result<void> set_list(BhrStatus (*setter)(BhrContext *, const C *, std::size_t, std::uint32_t),
                          span<const T> list) {
        const std::vector<C> copies = copied<C>(list);
        return detail::call([&] {
            return setter(get(), copies.data(), sizeof(C), static_cast<std::uint32_t>(copies.size()));
        });
    }

    template <class T, class C, std::size_t Most, class Getter> Result<std::vector<T>> ask_list(Getter getter) const {
        return detail::ask(std::vector<T>(), [&](std::vector<T> &list) {
            std::array<C, Most> copies = {};
            std::uint32_t count = 0;
            const BhrStatus status = getter(get(), copies.data(), sizeof(C), std::uint32_t(Most), &count);
            for (std::uint32_t i = 0; i < count; i++) {
                detail::take(list.emplace_back(), copies[i]);
            }
            return status;
        });
    }

    template <class C> Result<void> set(BhrStatus (*setter)(BhrContext *, const C *), const C &value) {
        return detail::call([&] { return setter(get(), &value); });
    }
    template <class C, class T>
    Result<void> set_or_none(BhrStatus (*setter)(BhrContext *, const C *), const std::optional<T> &value) {
        return value ? set(setter, value->c()) : detail::call([&] { return setter(get(), nullptr); });
    }
    template <class T, class C>
    Result<std::optional<T>> filled_or_none(BhrStatus (*getter)(const BhrContext *, C *, std::int32_t *)) const {
        return detail::ask_or_none<T, C>([&](C *it, std::int32_t *present) { return getter(get(), it, present); });
    }
    template <class T, class C> Result<T> constant(BhrStatus (*getter)(const BhrContext *, C *)) const {
        const Result<C> number = detail::ask(C(0), [&](C &to) { return getter(get(), &to); });
        return number ? Result<T>(static_cast<T>(*number)) : Result<T>(number.error());
    }
    template <class T, class C> Result<T> filled(BhrStatus (*getter)(const BhrContext *, C *)) const {
        return detail::ask_struct<T, C>([&](C *it) { return getter(get(), it); });
    }

    // The functors end after the context, which calls them until it has ended.
    detail::Functor<LogFunction> log_;
    std::shared_ptr<ProgressFunction> progress_;
    detail::Handle<BhrContext, bhr_context_destroy> handle_;
};

} // namespace bhr

#endif
