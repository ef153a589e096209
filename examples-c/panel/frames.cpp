// SPDX-License-Identifier: MIT OR Apache-2.0
// frames.cpp -- see frames.h.
#include "frames.h"

#include <algorithm>
#include <utility>

Result FrameQueue::submit(FrameKind kind, BhrFormat format, uint32_t width, uint32_t height, uint64_t scene_version,
                          double now) {
    Frame next;
    next.frame.kind = kind;
    next.frame.scene_version = scene_version;
    next.frame.submitted = now;
    Pixels &pixels = next.frame.pixels;
    if (!spare_.empty()) {
        pixels.bytes = std::move(spare_.back());
        spare_.pop_back();
    }
    // Four bytes a pixel, whether four channels of 8 bits or one float.
    pixels.bytes.resize(size_t{4} * width * height);
    pixels.image = with_defaults(bhr_image_init);
    pixels.image.format = format;
    pixels.image.width = width;
    pixels.image.height = height;
    pixels.image.pixels = pixels.bytes.data();
    pixels.image.byte_size = pixels.bytes.size();

    BhrJob *job = nullptr;
    Result  result = result_of(colour_bar_of_frames(context_, &next.frame.bar));
    if (result.ok()) {
        result = result_of(bhr_render_image_async(context_, &pixels.image, &job));
    }
    if (result.ok()) {
        next.job.reset(job);
        // Moving a vector leaves its elements where they are, so the job's target stays valid.
        frames_.push_back(std::move(next));
    } else {
        reuse(std::move(pixels));
    }
    return result;
}

std::vector<FinishedFrame> FrameQueue::collect() {
    std::vector<FinishedFrame> finished;
    while (!frames_.empty()) {
        Frame     &oldest = frames_.front();
        const Result result = result_of(bhr_job_wait(oldest.job.get(), 0, nullptr));
        if (result.status == BHR_NOT_READY) {
            break;
        }
        oldest.frame.result = result;
        oldest.frame.stats = sized<BhrFrameStats>();
        if (result.ok()) {
            oldest.frame.result = result_of(bhr_job_stats(oldest.job.get(), &oldest.frame.stats));
        }
        oldest.job.reset();
        finished.push_back(std::move(oldest.frame));
        frames_.erase(frames_.begin());
    }
    return finished;
}

void FrameQueue::clear() {
    // All are asked to stop before the first is waited for.
    for (Frame &frame : frames_) {
        bhr_job_cancel(frame.job.get());
    }
    frames_.clear();
}

size_t FrameQueue::in_flight(FrameKind kind) const {
    return static_cast<size_t>(std::count_if(frames_.begin(), frames_.end(),
                                             [kind](const Frame &frame) { return frame.frame.kind == kind; }));
}
