// SPDX-License-Identifier: MIT OR Apache-2.0
// comparison.cpp -- see comparison.h.
#include "comparison.h"

#include "../common.h"

bool Comparison::Wanted::operator==(const Wanted &other) const {
    return kept == other.kept && version == other.version && width == other.width && height == other.height &&
           own_camera == other.own_camera;
}

Result Comparison::load(const std::string &text) {
    Result result = result_of(bhr_scene_load(context_.get(), text.data(), text.size()));
    if (result.ok()) {
        // A still picture has the exposure that adaptation ends at.
        BhrFilm film = sized<BhrFilm>();
        bhr_get_film(context_.get(), &film);
        film.auto_adaptation = 1.0;
        result = result_of(bhr_set_film(context_.get(), &film));
        text_ = text;
        camera_ = sized<BhrCamera>();
        bhr_get_camera(context_.get(), &camera_);
        kept_++;
    }
    return result;
}

Result Comparison::keep(const Scene &scene, const BhrAdapterInfo &adapter) {
    std::string text;
    Result      result = scene.save_text(text);
    if (result.ok() && context_ == nullptr) {
        BhrContext *made = nullptr;
        result = result_of(create_context_beside(&adapter, &made));
        context_.reset(made);
        queue_ = result.ok() ? std::make_unique<FrameQueue>(made) : nullptr;
    }
    return result.ok() ? load(text) : result;
}

// A becomes B, which can be edited, and B becomes A.
Result Comparison::exchange(Scene &scene) {
    const std::string a = text_;
    std::string       b;
    Result            result = scene.save_text(b);
    if (result.ok()) {
        result = scene.load_text(a);
    }
    return result.ok() ? load(b) : result;
}

void Comparison::draw(Scene &scene, const BhrAdapterInfo &adapter) {
    forget_places();
    begin_section("A and B");
    if (ImGui::Button("keep as A")) {
        const Result result = keep(scene, adapter);
        report("A and B", "keep", result.message);
        shows_ |= result.ok();
    }
    mark("keep as A");
    tell("keeps this setting as A, with all of the scene; what you go on to change is B");
    ImGui::BeginDisabled(!kept());
    ImGui::SameLine();
    ImGui::Checkbox("A | B", &shows_);
    mark("A | B");
    tell("shows A left of a line through the picture, which you can drag, and B right of it; both at B's time");
    ImGui::SameLine();
    ImGui::Checkbox("A's camera", &own_camera_);
    mark("A's camera");
    tell("A as its own camera saw it when it was kept; else both are seen by B's camera");
    ImGui::SameLine();
    if (ImGui::Button("swap")) {
        report("A and B", "keep", exchange(scene).message);
    }
    mark("swap");
    tell("A becomes the setting to edit, and B the one that is kept");
    ImGui::EndDisabled();
    show_message("keep");
}

void Comparison::submit(const Scene &scene, uint32_t width, uint32_t height, double now) {
    const Wanted wanted{kept_, scene.version(), width, height, own_camera_};
    if (!shows_ || !kept() || width == 0 || queue_->in_flight() > 0 || wanted == submitted_) {
        return;
    }
    submitted_ = wanted;
    Result result = result_of(bhr_set_camera(context_.get(), own_camera_ ? &camera_ : &scene.camera()));
    if (result.ok()) {
        result = result_of(bhr_set_time(context_.get(), scene.time()));
    }
    if (result.ok()) {
        result = queue_->submit(FrameKind::picture, BHR_FORMAT_RGBA8_SRGB, width, height, wanted.version, now);
    }
    report("A and B", "keep", result.message);
}

bool Comparison::collect() {
    if (queue_ == nullptr) {
        return false;
    }
    bool any = false;
    for (FinishedFrame &frame : queue_->collect()) {
        report("A and B", "keep", frame.result.message);
        if (frame.result.ok()) {
            const BhrImage &image = frame.pixels.image;
            picture_.upload(image.pixels, image.width, image.height, true);
            bar_ = frame.bar;
            count_++;
        }
        any = true;
        queue_->reuse(std::move(frame.pixels));
    }
    return any;
}
