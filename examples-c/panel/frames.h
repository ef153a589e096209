/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// frames.h -- frames that are traced in the background, each into memory of the program's own. Never waits for one,
// except to end it. Knows no scene and no window.
#ifndef PANEL_FRAMES_H
#define PANEL_FRAMES_H

#include "../colour_bar.h"
#include "handles.h"

#include <array>
#include <cstddef>
#include <vector>

enum class FrameKind {
    picture,       // what the window shows
    steps_of_row,  // integration steps of one row of the picture
    steps_of_frame // integration steps of a small picture of the whole scene
};

// Pixels with what describes them to bhr; `image` points into `bytes`, which move with it.
struct Pixels {
    std::vector<unsigned char> bytes;
    BhrImage                   image{};
};

struct FinishedFrame {
    FrameKind     kind{};
    Pixels        pixels;
    Result        result;             // why there is no picture, when there is none
    BhrFrameStats stats{};
    double        submitted = 0.0;    // on the caller's clock
    uint64_t      scene_version = 0;  // the caller's, as given to submit
    ColourBar     bar{};              // the meaning of its colours, if they are false ones
};

class FrameQueue {
public:
    static constexpr size_t CAPACITY = 3;

    explicit FrameQueue(BhrContext *context) : context_(context) {}

    // Begins a frame of the scene as it is now. There must be room.
    Result submit(FrameKind kind, BhrFormat format, uint32_t width, uint32_t height, uint64_t scene_version,
                  double now);
    // The frames that are done, in the order of their submission.
    std::vector<FinishedFrame> collect();
    // Memory of a frame that is not needed any more; the next submission uses it.
    void reuse(Pixels &&pixels) { spare_.push_back(std::move(pixels.bytes)); }
    // Cancels what is under way and forgets it.
    void clear();

    bool   has_room() const { return in_flight() < CAPACITY; }
    size_t in_flight() const { return frames_.size(); }
    size_t in_flight(FrameKind kind) const;

private:
    // The job is ended before the memory it writes to: members go in the reverse order of their declaration.
    struct Frame {
        FinishedFrame frame;
        Job           job;
    };

    BhrContext                             *context_;
    std::vector<Frame>                      frames_; // oldest first
    std::vector<std::vector<unsigned char>> spare_;
};

#endif
