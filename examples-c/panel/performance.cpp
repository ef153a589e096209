// SPDX-License-Identifier: MIT OR Apache-2.0
// performance.cpp -- see performance.h.
#include "performance.h"

#include "draw.h"

#include <algorithm>
#include <cstdio>

namespace {

constexpr double RATE_MEMORY = 0.9; // of the running mean of the time between frames
constexpr double REST = 2.0;        // seconds between two frames that do not follow on one another

double milliseconds(uint64_t nanoseconds) {
    return 1e-6 * static_cast<double>(nanoseconds);
}

const char *backend_name(BhrBackend backend) {
    constexpr const char *names[] = {"auto", "CPU tracer", "Vulkan", "Metal", "Direct3D 12", "OpenGL"};
    return backend >= 0 && backend <= BHR_BACKEND_GL ? names[backend] : "?";
}

void pair(const char *name, const char *format, double value, bool left) {
    if (!left) {
        ImGui::SameLine(0.5F * ImGui::GetWindowContentRegionMax().x);
    }
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim), "%s", name);
    ImGui::SameLine(0.0F, 0.4F * ImGui::GetFontSize());
    ImGui::Text(format, value);
}

} // namespace

void Performance::Course::append(double value) {
    std::move(values.begin() + 1, values.end(), values.begin());
    values.back() = static_cast<float>(value);
}

// Frames that were begun before the first was shown waited for the driver's compiler: no other would show beside them.
bool Performance::usual(double submitted) const {
    return first_shown_ >= 0.0 && submitted >= first_shown_;
}

void Performance::finished(const BhrFrameStats &stats, double submitted) {
    stats_ = stats;
    if (!usual(submitted)) {
        return;
    }
    cpu_.append(milliseconds(stats.cpu_ns));
    gpu_.append(milliseconds(stats.gpu_ns));
    readback_.append(milliseconds(stats.readback_ns));
}

void Performance::shown(double submitted, double now) {
    latency_ = now - submitted;
    if (usual(submitted)) {
        latencies_.append(1e3 * latency_);
    }
    const double interval = now - last_shown_;
    if (!usual(submitted) || interval > REST) {
        rate_ = 0.0;
    } else if (interval > 0.0) {
        const double mean = rate_ > 0.0 ? RATE_MEMORY / rate_ + (1.0 - RATE_MEMORY) * interval : interval;
        rate_ = 1.0 / mean;
        rates_.append(rate_);
    }
    last_shown_ = now;
    first_shown_ = first_shown_ < 0.0 ? now : first_shown_;
    count_++;
}

void Performance::draw(const BhrAdapterInfo &adapter, size_t in_flight, unsigned recoveries) const {
    ImGui::TextWrapped("%s", adapter.name);
    ImGui::PushStyleColor(ImGuiCol_Text, colour::dim);
    ImGui::TextWrapped("%s%s%s%s", backend_name(adapter.backend),
                       (adapter.flags & BHR_ADAPTER_SOFTWARE) != 0   ? ", software"
                       : (adapter.flags & BHR_ADAPTER_DISCRETE) != 0 ? ", discrete"
                                                                     : "",
                       adapter.driver[0] != '\0' ? ", " : "", adapter.driver);
    ImGui::PopStyleColor();
    ImGui::Separator();

    const double seconds = 1e-9 * static_cast<double>(stats_.gpu_ns != 0 ? stats_.gpu_ns : stats_.cpu_ns);
    const double rays = static_cast<double>(stats_.rays), steps = static_cast<double>(stats_.steps);
    pair("shown", "%.0f", static_cast<double>(count_), true);
    pair("in flight", "%.0f", static_cast<double>(in_flight), false);
    pair("rays", "%.0f", rays, true);
    pair("rays / us", "%.2f", seconds > 0.0 ? 1e-6 * rays / seconds : 0.0, false);
    pair("steps / ray", "%.1f", rays > 0.0 ? steps / rays : 0.0, true);
    pair("steps", "%.3g", steps, false);
    pair("device", "%.1f MiB", static_cast<double>(stats_.device_bytes) / (1024.0 * 1024.0), true);
    pair("recovered", "%.0f", static_cast<double>(recoveries), false);

    const float height = std::max(24.0F, 0.5F * (ImGui::GetContentRegionAvail().y -
                                                 3.4F * ImGui::GetTextLineHeightWithSpacing()));
    char text[64];
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim), "ms:");
    std::snprintf(text, sizeof text, "CPU %.1f", milliseconds(stats_.cpu_ns));
    legend(text, colour::isco);
    std::snprintf(text, sizeof text, "GPU %.2f", milliseconds(stats_.gpu_ns));
    legend(text, colour::photon);
    std::snprintf(text, sizeof text, "readback %.2f", milliseconds(stats_.readback_ns));
    legend(text, colour::ergosphere);
    std::snprintf(text, sizeof text, "to the screen %.1f", 1e3 * latency_);
    legend(text, colour::ray);
    line_plot("milliseconds", {ImGui::GetContentRegionAvail().x, height},
              {{"latency", latencies_.values.data(), colour::ray},
               {"cpu", cpu_.values.data(), colour::isco},
               {"gpu", gpu_.values.data(), colour::photon},
               {"readback", readback_.values.data(), colour::ergosphere}},
              HISTORY, "%g ms", -1);
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim), "frames per second:");
    std::snprintf(text, sizeof text, in_flight > 0 && rate_ > 0.0 ? "%.1f" : "at rest", rate_);
    legend(text, colour::crossing);
    line_plot("rate", {ImGui::GetContentRegionAvail().x, height},
              {{"rate", rates_.values.data(), colour::crossing}}, HISTORY, "%g / s", -1);
}
