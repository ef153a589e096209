// SPDX-License-Identifier: MIT OR Apache-2.0
// inspector.cpp -- see inspector.h.
#include "inspector.h"

#include <limits>

namespace {

constexpr uint32_t PATH_CAPACITY = 4096; // points of a curve: smooth after many turns about the hole

} // namespace

Result Inspector::create() {
    BhrContextOptions options = with_defaults(bhr_context_options_init);
    options.backend = BHR_BACKEND_CPU;
    options.cpu_threads = 1; // single rays have no use for more
    BhrContext  *context = nullptr;
    const Result result = result_of(bhr_context_create(BHR_ABI_VERSION, &options, &context));
    context_.reset(context);
    return result;
}

Result Inspector::follow(const BhrContext *source) {
    double     axis[3];
    BhrCamera  camera = sized<BhrCamera>();
    BhrQuality quality = sized<BhrQuality>();
    int32_t    present = 0;
    disk_ = sized<BhrDisk>();
    // Whatever one context holds another one takes: a failure of any of these is the library's.
    for (const BhrStatus status : {bhr_get_hole(source, &mass_, &spin_, axis), bhr_get_camera(source, &camera),
                                   bhr_get_disk(source, &disk_, &present), bhr_get_quality(source, &quality)}) {
        if (status < 0) {
            return result_of(status);
        }
    }
    BhrContext *target = context_.get();
    for (const BhrStatus status :
         {bhr_set_mass(target, mass_), bhr_set_spin(target, spin_), bhr_set_axis(target, axis),
          bhr_set_camera(target, &camera), bhr_set_disk(target, present != 0 ? &disk_ : nullptr),
          bhr_set_quality(target, &quality)}) {
        if (status < 0) {
            return result_of(status);
        }
    }
    has_disk_ = present != 0;
    chart_ = Chart(axis);
    numbers_ = sized<BhrHoleInfo>();
    return result_of(bhr_hole_info(target, &numbers_));
}

double Inspector::disk_inner() const {
    if (disk_.inner_radius > 0.0) {
        return disk_.inner_radius * mass_;
    }
    if (plunges()) {
        return numbers_.horizon_radius;
    }
    return retrograde() ? numbers_.isco_retrograde : numbers_.isco_prograde;
}

RayReport Inspector::inspect(uint32_t width, uint32_t height, double x, double y) const {
    RayReport report;
    report.deflection = std::numeric_limits<double>::quiet_NaN();
    BhrContext *context = context_.get();
    report.result = result_of(bhr_camera_ray(context, width, height, x, y, &report.ray));
    if (report.result.ok()) {
        report.result =
            result_of(bhr_trace_rays(context, &report.ray, sizeof report.ray, 1, &report.hit, sizeof report.hit));
    }
    std::vector<double> points(size_t{4} * PATH_CAPACITY);
    uint32_t            count = 0;
    if (report.result.ok()) {
        report.result = result_of(bhr_trace_path(context, &report.ray, PATH_CAPACITY, points.data(), &count));
    }
    for (size_t i = 0; i < count; i++) {
        const double *p = &points[4 * i];
        report.path.push_back({chart_.from_scene({p[0], p[1], p[2]}), p[3]});
    }
    if (report.result.ok() && report.hit.fate == BHR_FATE_ESCAPED) {
        const double *look = report.ray.direction, *sky = report.hit.sky_direction;
        report.deflection = angle_between({look[0], look[1], look[2]}, {sky[0], sky[1], sky[2]});
    }
    return report;
}

double Inspector::g_tt(const Vec3 &place) const {
    const Vec3   scene = chart_.to_scene(place);
    const double position[3] = {scene.x, scene.y, scene.z};
    double       metric[16];
    if (bhr_metric_at(context_.get(), position, metric) < 0) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    return metric[0];
}
