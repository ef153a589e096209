// SPDX-License-Identifier: MIT OR Apache-2.0
// app.cpp -- see app.h.
#include "app.h"

#include <GLFW/glfw3.h>
#include <cstdio>
#include <cstdlib>

namespace {

constexpr double POLL_SECONDS = 0.002;        // between two looks at frames that are under way
constexpr double REDRAW_SECONDS = 0.1;        // between two looks of the window, when no frames come
constexpr double LIVELY_SECONDS = 1.0;        // so long after an input the window is drawn again and again
constexpr double FASTEST_REDRAW = 1.0 / 90.0; // where the display sets no pace
constexpr double REST_SECONDS = 0.3;          // so long after the last touch the picture is made in full again
constexpr double TOUCHED_FRAME = 1.0 / 30.0;  // the time to aim for of a frame while the scene is touched
constexpr double RUNNING_FRAME = 1.0 / 10.0;  // the same, while only the clock runs
constexpr double COARSEST = 0.15;             // for both
constexpr double STEPS_PAUSE = 0.25;          // between two looks at the integration steps
constexpr double RECOVERY_PAUSE = 1.0;        // between two tries to bring a lost device back
constexpr double COUNTED_FRAME = 1.0 / 30.0;  // of the clock, with --frames: the same pictures on every machine
constexpr double LONGEST_TICK = 0.25;         // of the clock: after a pause of the process the scene does not leap
constexpr double DEGREES_PER_UNIT = 0.25;     // of a drag
constexpr double ZOOM_PER_NOTCH = 0.9;
constexpr double NEAREST = 1.05;              // that zooming goes, in horizon radii

} // namespace

App::App(BhrContext *context, const AppOptions &options)
    : options_(options), context_(context), scene_(context), queue_(context) {
    clock_.running = options.paused == 0;
}

// Frames that are still under way write into the queue's memory, not the window's: it only must go before the context.
App::~App() {
    queue_.clear();
}

std::string App::start() {
    // --frames shows the same pictures on every machine.
    const bool steady = options_.frames != 0 && options_.matter == BHR_PRESET_MATTER_AUTO;
    Result     result = scene_.begin(options_.preset, steady ? BHR_PRESET_MATTER_THIN : options_.matter);
    if (result.ok()) {
        result = inspector_.create();
    }
    if (result.ok()) {
        adapter_ = sized<BhrAdapterInfo>();
        result = result_of(bhr_context_adapter(context_, &adapter_));
    }
    if (!result.ok()) {
        return result.message;
    }
    return window_.open(options_.size[0], options_.size[1], "bhr: panel");
}

int App::run() {
    double last = glfwGetTime(), drawn_at = -1.0, input_at = last;
    bool   stale = true; // the window
    for (;;) {
        const bool input = window_.wait(queue_.in_flight() > 0 || comparison_.in_flight() ? POLL_SECONDS
                                        : stale ? 0.5 * FASTEST_REDRAW
                                                : REDRAW_SECONDS);
        const double now = glfwGetTime();
        input_at = input ? now : input_at;
        if (!counted()) {
            advance_clock(std::min(now - last, LONGEST_TICK));
        }
        last = now;
        collect_frames(now);
        stale |= comparison_.collect();
        submit_frames(now);
        if (finished(now)) {
            return save();
        }
        // ImGui shows what an input did some frames later: menus open, and text cursors blink.
        const bool lively = now - input_at < LIVELY_SECONDS && now - drawn_at >= REDRAW_SECONDS;
        stale |= input || lively || to_show_ >= 0.0;
        if (stale && now - drawn_at >= FASTEST_REDRAW) {
            draw(now, nullptr);
            drawn_at = now;
            stale = false;
        }
    }
}

// ---- frames ----

bool App::touched(double now) const {
    return now - touched_at_ < REST_SECONDS;
}

void App::collect_frames(double now) {
    for (FinishedFrame &frame : queue_.collect()) {
        if (frame.kind == FrameKind::picture) {
            take_picture(std::move(frame), now);
        } else {
            steps_plot_.take(frame);
            queue_.reuse(std::move(frame.pixels));
        }
    }
}

void App::take_picture(FinishedFrame &&frame, double now) {
    if (!frame.result.ok()) {
        failed(frame.result, now);
        queue_.reuse(std::move(frame.pixels));
        return;
    }
    error_.clear();
    measure_speed(frame, now);
    finished_at_ = now;
    auto_ev_ = frame.stats.auto_ev;
    performance_.finished(frame.stats, frame.submitted);
    to_show_ = frame.submitted;
    bar_ = frame.bar;
    queue_.reuse(picture_.take(std::move(frame.pixels)));
    pictures_++;
}

// Seconds per pixel, for the next frames' size. The first frame tells nothing: it waits for the driver's compiler.
void App::measure_speed(const FinishedFrame &frame, double now) {
    if (pictures_ == 0) {
        return;
    }
    // With several frames under way each of them waits for the others: then the time between their ends counts.
    const double seconds = std::min(1e-9 * static_cast<double>(frame.stats.cpu_ns), now - finished_at_);
    const double pixels = static_cast<double>(frame.pixels.image.width) * frame.pixels.image.height;
    const double latest = seconds / pixels;
    seconds_per_pixel_ = seconds_per_pixel_ > 0.0 ? 0.7 * seconds_per_pixel_ + 0.3 * latest : latest;
}

void App::submit_frames(double now) {
    if (lost_) {
        recover(now);
    }
    if (lost_ || picture_.width() == 0) { // a place for the picture comes with the window's first frame
        return;
    }
    // Before the next picture, which would take the room again.
    if (!options_.bare && !touched(now) && now - steps_at_ > STEPS_PAUSE) {
        const Result result = steps_plot_.request(context_, scene_, queue_, picture_.width(), picture_.height(),
                                                  picture_.row(), now);
        if (!result.ok()) {
            failed(result, now);
        }
        if (queue_.has_room()) { // else there was none for all that is missing
            steps_at_ = now;
        }
    }
    submit_picture(now);
}

double App::picture_scale(double now) const {
    const bool running = clock_.running && clock_.speed != 0.0;
    if (counted() || !frame_settings_.adaptive || !(touched(now) || running) || seconds_per_pixel_ <= 0.0) {
        return frame_settings_.scale;
    }
    const double aim = touched(now) ? TOUCHED_FRAME : RUNNING_FRAME;
    const double pixels = static_cast<double>(picture_.width()) * picture_.height();
    const double scale = std::sqrt(aim / (seconds_per_pixel_ * pixels));
    // In steps, lest each frame have another size.
    return std::clamp(std::floor(scale * 16.0) / 16.0, COARSEST, frame_settings_.scale);
}

// Submits pictures as long as there is room, if there is something new to show.
void App::submit_picture(double now) {
    const double scale = picture_scale(now);
    const auto   size = [scale](uint32_t whole) {
        return static_cast<uint32_t>(std::max(1L, std::lround(scale * whole)));
    };
    const Wanted wanted{scene_.version(), size(picture_.width()), size(picture_.height())};
    comparison_.submit(scene_, wanted.width, wanted.height, now);
    while (!lost_ && queue_.has_room() && queue_.in_flight(FrameKind::picture) < frame_settings_.in_flight) {
        const bool changed = wanted.version != submitted_of_.version || wanted.width != submitted_of_.width ||
                             wanted.height != submitted_of_.height;
        const bool counting = counted() && submitted_ < options_.frames;
        // The last counted picture is held on the screen before any further one is made.
        if (counted() && !counting && hold_until_ < 0.0) {
            return;
        }
        if (!changed && !counting && !(frame_settings_.always && error_.empty())) {
            return;
        }
        const Result result =
            queue_.submit(FrameKind::picture, BHR_FORMAT_RGBA8_SRGB, wanted.width, wanted.height, wanted.version, now);
        submitted_of_ = wanted;
        if (!result.ok()) {
            failed(result, now);
            return;
        }
        submitted_++;
        if (counted() && submitted_ < options_.frames) {
            advance_clock(COUNTED_FRAME);
            return;
        }
    }
}

void App::failed(const Result &result, double now) {
    error_ = result.message;
    if (options_.verbose != 0) {
        std::printf("failed %s\n", error_.c_str());
    }
    if (result.status == BHR_ERROR_DEVICE_LOST && !lost_) {
        lost_ = true;
        retry_at_ = now;
    }
}

void App::recover(double now) {
    if (now < retry_at_) {
        return;
    }
    queue_.clear();
    steps_plot_.forget();
    submitted_of_ = Wanted{};
    const Result result = result_of(bhr_context_recover(context_));
    if (!result.ok()) {
        error_ = result.message;
        retry_at_ = now + RECOVERY_PAUSE;
        return;
    }
    lost_ = false;
    recoveries_++;
    error_.clear();
    bhr_context_adapter(context_, &adapter_); // it may be another one
}

void App::advance_clock(double seconds) {
    if (!clock_.running || clock_.speed == 0.0) {
        return;
    }
    const double time = seconds * clock_.speed * scene_.hole().mass;
    const bool   moving = scene_.camera().motion == BHR_MOTION_FREE_FALL || scene_.camera().motion == BHR_MOTION_ORBIT;
    if (clock_.moves_camera && moving) {
        const Result result = scene_.advance_camera(time);
        settings_.report("Time", "camera follows its motion", result.message);
        if (result.ok()) {
            return;
        }
        clock_.moves_camera = false;
    }
    const Result result = scene_.set_time(scene_.time() + time);
    settings_.report("Time", "time", result.message);
}

// ---- the window ----

void App::inspect() {
    if (const Result result = inspector_.follow(context_); !result.ok()) {
        ray_.result = result;
        return;
    }
    const Wanted of{scene_.geometry_version(), picture_.width(), picture_.height()};
    if (of.version == ray_of_.version && of.width == ray_of_.width && of.height == ray_of_.height &&
        ray_column_ == picture_.column() && ray_row_ == picture_.row()) {
        return;
    }
    ray_of_ = of;
    ray_column_ = picture_.column();
    ray_row_ = picture_.row();
    ray_ = inspector_.inspect(of.width, of.height, ray_column_ + 0.5, ray_row_ + 0.5);
}

void App::draw(double now, Pixels *copy) {
    if (!window_.begin_frame()) {
        return;
    }
    const uint64_t version = scene_.version();
    const Layout   layout = arrange(ImGui::GetIO().DisplaySize, ImGui::GetFontSize(), options_.bare != 0);
    Picture::Input input;
    sections_.clear();
    history_.before(scene_, ImGui::IsAnyItemActive() || ImGui::IsAnyMouseDown(), now);
    files_.key(window_.shortcut(), scene_, history_);
    {
        const FixedWindow window(sections_, "Picture", layout.picture, true);
        input = draw_picture();
    }
    move_camera(input);
    if (picture_.width() > 0 && !options_.bare) {
        inspect();
    }
    if (layout.panels) {
        draw_panels(layout);
    }
    history_.after(scene_, now);
    if (scene_.version() != version) {
        touched_at_ = now;
    }
    window_.end_frame(copy);
    if (to_show_ >= 0.0) {
        performance_.shown(to_show_, glfwGetTime());
        to_show_ = -1.0;
    }
    if (options_.verbose != 0) {
        say(input);
    }
}

// The picture, and beneath it the bars of its colours. Their room is there as soon as the scene has false colours; they
// themselves are there once the picture has.
Picture::Input App::draw_picture() {
    const bool      bare = options_.bare != 0, parted = comparison_.shown() && !bare;
    const BhrImage &image = picture_.pixels().image;
    const ImVec2    corner = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
    const double    rate = queue_.in_flight() > 0 ? performance_.frames_per_second() : 0.0; // at rest there is none
    char            news[96];
    std::snprintf(news, sizeof news, rate > 0.0 ? "%u x %u, %.1f frames / s" : "%u x %u", image.width, image.height,
                  rate);
    ColourLegend legend{comparison_.bar(), {}, parted};
    colour_bar_of(scene_.view(), &scene_.film(), &legend.b);
    const float          foot = bare ? 0.0F : legend.height(room);
    const Picture::Input input = picture_.draw(window_.pixel_ratio(), bare, news, error_,
                                               parted ? &comparison_.picture() : nullptr, foot);
    legend.b = bar_;
    legend_ = ColourLegend{};
    if (foot > 0.0F && legend.height(room) == foot) {
        legend.draw({corner.x, corner.y + room.y - foot}, {room.x, foot});
        legend_ = legend;
    }
    return input;
}

void App::draw_panels(const Layout &layout) {
    {
        const FixedWindow window(sections_, "Scene", layout.settings);
        files_.draw(scene_, history_);
        comparison_.draw(scene_, adapter_);
        settings_.draw(scene_, inspector_.numbers(), frame_settings_, clock_, sections_,
                       [&] { light_scope_.draw(picture_.pixels(), pictures_, auto_ev_, scene_.film()); });
    }
    if (layout.wide) {
        draw_instruments(layout);
    } else {
        draw_instrument_tabs(layout);
    }
}

// All side by side, in windows of their own.
void App::draw_instruments(const Layout &layout) {
    {
        const FixedWindow window(sections_, "Ray, from the side", layout.side);
        ray_panel_.draw_side(ray_, inspector_);
    }
    {
        const FixedWindow window(sections_, "Ray, from above", layout.top);
        ray_panel_.draw_top(ray_, inspector_);
    }
    {
        const FixedWindow window(sections_, "g_tt", layout.metric);
        metric_map_.draw(inspector_, scene_.geometry_version());
    }
    {
        const FixedWindow window(sections_, "Performance", layout.performance);
        performance_.draw(adapter_, queue_.in_flight(), recoveries_);
    }
    {
        const FixedWindow window(sections_, "Ray", layout.ray);
        ray_panel_.draw_numbers(ray_, inspector_, ray_column_, ray_row_);
    }
    {
        const FixedWindow window(sections_, "Integration steps", layout.steps);
        steps_plot_.draw(scene_, picture_.column(), picture_.width());
    }
}

// A ray's two views, and its numbers with the rest of the room.
void App::draw_ray_views(ImVec2 room) {
    const float space = ImGui::GetStyle().ItemSpacing.x, view = std::floor(0.32F * room.x);
    {
        const Part part(sections_, "Ray, from the side", {view, room.y});
        ray_panel_.draw_side(ray_, inspector_);
    }
    ImGui::SameLine();
    {
        const Part part(sections_, "Ray, from above", {view, room.y});
        ray_panel_.draw_top(ray_, inspector_);
    }
    ImGui::SameLine();
    const Part part(sections_, "Ray", {room.x - 2.0F * (view + space), room.y});
    ray_panel_.draw_numbers(ray_, inspector_, ray_column_, ray_row_);
}

// They share one window, behind tabs.
void App::draw_instrument_tabs(const Layout &layout) {
    const FixedWindow window(sections_, "Instruments", layout.instruments);
    if (!ImGui::BeginTabBar("instruments")) {
        return;
    }
    const auto tab = [&](const char *name, const std::function<void()> &content) {
        const bool chosen = ImGui::BeginTabItem(name);
        settings_.mark_tab("instruments", name);
        if (chosen) {
            content();
            ImGui::EndTabItem();
        }
    };
    const auto whole = [&](const char *name, const std::function<void()> &content) {
        tab(name, [&] {
            const Part part(sections_, name, {0.0F, 0.0F});
            content();
        });
    };
    tab("Ray", [&] { draw_ray_views(ImGui::GetContentRegionAvail()); });
    whole("g_tt", [&] { metric_map_.draw(inspector_, scene_.geometry_version()); });
    whole("Steps", [&] { steps_plot_.draw(scene_, picture_.column(), picture_.width()); });
    whole("Performance", [&] { performance_.draw(adapter_, queue_.in_flight(), recoveries_); });
    ImGui::EndTabBar();
}

// Dragging moves the camera about the hole as if the hole were turned by the hand; the wheel goes nearer and away.
void App::move_camera(const Picture::Input &input) {
    if (input.drag_x == 0.0F && input.drag_y == 0.0F && input.wheel == 0.0F) {
        return;
    }
    Orbit orbit = scene_.orbit();
    orbit.azimuth -= static_cast<double>(input.drag_x) * DEGREES_PER_UNIT * DEGREE;
    orbit.azimuth = std::remainder(orbit.azimuth, 360.0 * DEGREE);
    orbit.elevation += static_cast<double>(input.drag_y) * DEGREES_PER_UNIT * DEGREE;
    orbit.elevation = std::clamp(orbit.elevation, -90.0 * DEGREE, 90.0 * DEGREE);
    if (input.wheel != 0.0F) {
        // A camera that is inside already, falling, is left there.
        const double nearest = std::min(NEAREST * inspector_.numbers().horizon_radius, orbit.distance);
        orbit.distance = std::max(orbit.distance * std::pow(ZOOM_PER_NOTCH, static_cast<double>(input.wheel)), nearest);
    }
    settings_.report("Camera", "distance", scene_.set_orbit(orbit).message);
}

// ---- the end ----

// Whether all the frames that were asked for by number were shown, with everything about them, or will never be.
bool App::counted_out(double now) const {
    const bool recovers = lost_ && retry_at_ <= now; // it has not been tried yet
    if (!error_.empty() && queue_.in_flight() == 0 && !recovers) {
        return true;
    }
    const bool steps_known = options_.bare != 0 || steps_plot_.settled(scene_.geometry_version(), picture_.width(),
                                                                       picture_.height(), picture_.row());
    return pictures_ >= options_.frames && to_show_ < 0.0 && steps_known;
}

bool App::finished(double now) {
    if (window_.closed()) {
        return true;
    }
    if (counted() ? !counted_out(now) && hold_until_ < 0.0 : options_.hold < 0.0) {
        return false;
    }
    if (hold_until_ < 0.0) {
        hold_until_ = now + std::max(options_.hold, 0.0);
    }
    return now >= hold_until_;
}

int App::save() {
    Pixels window;
    draw(glfwGetTime(), &window);
    if (BhrImage file = picture_.pixels().image; file.pixels != nullptr) {
        colour_bar_put(&file, &bar_); // the window shows no picture any more
    }
    const struct {
        const char     *path;
        const BhrImage *image;
    } files[] = {{options_.screenshot, &window.image}, {options_.picture, &picture_.pixels().image}};
    for (const auto &[path, image] : files) {
        if (path == nullptr) {
            continue;
        }
        if (const Result result = result_of(bhr_image_save(image, path)); !result.ok()) {
            std::fprintf(stderr, "cannot save %s: %s\n", path, result.message.c_str());
            return EXIT_FAILURE;
        }
    }
    if (counted() && pictures_ < options_.frames && !window_.closed()) {
        std::fprintf(stderr, "cannot make %u frames: %s\n", options_.frames, error_.c_str());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}

// ---- what --verbose says: lines for programs that drive this one ----

void App::say(const Picture::Input &input) {
    const ImVec2 corner = picture_.corner();
    const Wanted place{0, picture_.width(), picture_.height()};
    if (place.width != said_place_.width || place.height != said_place_.height) {
        std::printf("picture %.0f %.0f %u %u\n", static_cast<double>(corner.x), static_cast<double>(corner.y),
                    place.width, place.height);
        said_place_ = place;
    }
    if (scene_.geometry_version() != said_geometry_) {
        const Hole  &hole = scene_.hole();
        const Orbit &orbit = scene_.orbit();
        std::printf("scene mass %g spin %g distance %.9g azimuth %.9g elevation %.9g\n", hole.mass, hole.spin,
                    orbit.distance, orbit.azimuth / DEGREE, orbit.elevation / DEGREE);
        said_geometry_ = scene_.geometry_version();
    }
    const size_t volumes = scene_.volumes().size(), spots = scene_.hot_spots().size();
    if (volumes != said_volumes_ || spots != said_spots_) {
        std::printf("matter volumes %zu hot spots %zu\n", volumes, spots);
        said_volumes_ = volumes;
        said_spots_ = spots;
    }
    if (files_.count() != said_files_) {
        std::printf("file %s\n", files_.said().c_str());
        said_files_ = files_.count();
    }
    if (settings_.refusals() != said_refusals_) {
        std::printf("refused %s\n", settings_.last_refusal().c_str());
        said_refusals_ = settings_.refusals();
    }
    if (input.clicked) {
        std::printf("ray %u %u %s deflection %.9g crossings %u steps %u points %zu\n", ray_column_, ray_row_,
                    fate_name(ray_.hit.fate), ray_.deflection / DEGREE, ray_.hit.crossing_count, ray_.hit.steps,
                    ray_.path.size());
    }
    if (comparison_.count() != said_compared_) {
        std::printf("compared %u\n", comparison_.count());
        said_compared_ = comparison_.count();
    }
    if (picture_.wipe() != said_wipe_) {
        std::printf("wipe %.3f\n", static_cast<double>(picture_.wipe()));
        said_wipe_ = picture_.wipe();
    }
    if (light_scope_.number() != said_light_) {
        std::printf("light above %d: %.4f auto %.4f\n", LightCounts::BRIGHT, light_scope_.counts().bright(), auto_ev_);
        said_light_ = light_scope_.number();
    }
    const std::string colours = std::string(legend_.title_of_a()) + " | " + legend_.title_of_b();
    if (colours != said_colours_) {
        std::printf("colours %s\n", colours.c_str());
        said_colours_ = colours;
    }
    say_places();
    if (pictures_ != said_pictures_) {
        std::printf("frames %u\n", pictures_);
        said_pictures_ = pictures_;
    }
}

// The sections, with what of them is hidden, and the widgets that can be seen, where any of them has changed.
void App::say_places() {
    std::string text;
    char        line[160];
    const auto  whole = [](float value) { return static_cast<double>(value); };
    for (const SectionReport &one : sections_) {
        std::snprintf(line, sizeof line, "section %.0f %.0f %.0f %.0f hidden %.0f %.0f bar %d %s\n", whole(one.at.x),
                      whole(one.at.y), whole(one.size.x), whole(one.size.y), whole(one.hidden.x), whole(one.hidden.y),
                      one.bar ? 1 : 0, one.name.c_str());
        text += line;
    }
    for (const auto *places : {&comparison_.places(), &settings_.places()}) {
        for (const auto &[name, place] : *places) {
            std::snprintf(line, sizeof line, "widget %.0f %.0f %s\n", whole(place.x), whole(place.y), name.c_str());
            text += line;
        }
    }
    if (text != said_places_) {
        std::printf("places\n%s", text.c_str());
        said_places_ = text;
    }
}
