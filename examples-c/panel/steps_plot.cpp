// SPDX-License-Identifier: MIT OR Apache-2.0
// steps_plot.cpp -- see steps_plot.h.
#include "steps_plot.h"

#include "draw.h"

#include <cmath>
#include <cstring>

namespace {

constexpr uint32_t SMALL_WIDTH = 128; // of the frame that maximum and mean come from

// While it lives, frames of the context show steps; then everything is as before. A job is a snapshot of the scene, so
// what is set here reaches no other frame.
class StepsView {
public:
    StepsView(BhrContext *context, const Scene &scene) : context_(context), scene_(scene) {
        BhrQuality quality = scene.quality();
        quality.samples_per_pixel = 1;
        // A ray that is looked up takes no steps: show those that it would take.
        quality.method = quality.method == BHR_METHOD_AUTO ? BHR_METHOD_RK4 : quality.method;
        bhr_set_quality(context, &quality);
        bhr_set_view(context, BHR_VIEW_STEPS);
    }
    ~StepsView() {
        bhr_set_region(context_, nullptr);
        bhr_set_view(context_, scene_.view());
        bhr_set_quality(context_, &scene_.quality());
    }
    StepsView(const StepsView &) = delete;
    StepsView &operator=(const StepsView &) = delete;

private:
    BhrContext  *context_;
    const Scene &scene_;
};

std::vector<float> values_of(const Pixels &pixels) {
    std::vector<float> values(pixels.bytes.size() / sizeof(float));
    std::memcpy(values.data(), pixels.bytes.data(), values.size() * sizeof(float));
    return values;
}

} // namespace

Result StepsPlot::request(BhrContext *context, const Scene &scene, FrameQueue &queue, uint32_t width, uint32_t height,
                          uint32_t row, double now) {
    const uint64_t version = scene.geometry_version();
    const Wanted   wanted_row{version, width, height, row};
    const uint32_t small_height = std::max(1U, static_cast<uint32_t>(uint64_t{SMALL_WIDTH} * height / width));
    const Wanted   wanted_frame{version, SMALL_WIDTH, small_height, 0};
    Result         result;
    if (!(asked_row_ == wanted_row) && queue.in_flight(FrameKind::steps_of_row) == 0 && queue.has_room()) {
        const StepsView view(context, scene);
        BhrRegion       region = sized<BhrRegion>();
        region.full_width = width;
        region.full_height = height;
        region.y = row;
        result = result_of(bhr_set_region(context, &region));
        if (result.ok()) {
            result = queue.submit(FrameKind::steps_of_row, BHR_FORMAT_R32F, width, 1, version, now);
        }
        // Asked for even if refused: the same question again would be refused again.
        asked_row_ = wanted_row;
        pending_ += result.ok() ? 1 : 0;
    }
    if (result.ok() && !(asked_frame_ == wanted_frame) && queue.in_flight(FrameKind::steps_of_frame) == 0 &&
        queue.has_room()) {
        const StepsView view(context, scene);
        result = queue.submit(FrameKind::steps_of_frame, BHR_FORMAT_R32F, SMALL_WIDTH, small_height, version, now);
        asked_frame_ = wanted_frame;
        pending_ += result.ok() ? 1 : 0;
    }
    return result;
}

void StepsPlot::take(const FinishedFrame &frame) {
    pending_ -= pending_ > 0 ? 1 : 0;
    if (!frame.result.ok()) {
        return;
    }
    if (frame.kind == FrameKind::steps_of_row) {
        row_ = values_of(frame.pixels);
        return;
    }
    double sum = 0.0, count = 0.0;
    highest_ = 0.0;
    for (const float steps : values_of(frame.pixels)) {
        if (std::isfinite(steps)) {
            sum += static_cast<double>(steps);
            count += 1.0;
            highest_ = std::max(highest_, static_cast<double>(steps));
        }
    }
    mean_ = count > 0.0 ? sum / count : 0.0;
}

bool StepsPlot::settled(uint64_t geometry_version, uint32_t width, uint32_t height, uint32_t row) const {
    return pending_ == 0 && asked_row_ == Wanted{geometry_version, width, height, row} &&
           asked_frame_.version == geometry_version;
}

void StepsPlot::draw(const Scene &scene, uint32_t column, uint32_t picture_width) const {
    ImGui::Text("max %.0f   mean %.1f", highest_, mean_);
    ImGui::SameLine();
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim),
                       scene.quality().method == BHR_METHOD_AUTO ? "(without tables: RK4)" : "");
    if (row_.empty() || picture_width == 0) {
        return;
    }
    // The row may still be one of the picture before the window's last change of size.
    const size_t index = std::min(row_.size() - 1, size_t{column} * row_.size() / picture_width);
    ImGui::Text("here %.0f", static_cast<double>(row_[index]));
    ImGui::SameLine();
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim), "of the row through the pixel");
    const ImVec2 room = ImGui::GetContentRegionAvail();
    if (room.y > 8.0F) {
        line_plot("steps", room, {{"steps", row_.data(), colour::ray}}, row_.size(), "%.0f", static_cast<int>(index));
    }
}
