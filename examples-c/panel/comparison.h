/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// comparison.h -- two settings in one picture: A is kept, B is the scene that is being edited, and a line that the hand
// draws through the picture parts them. A's pictures come from a context of its own on the same adapter.
#ifndef PANEL_COMPARISON_H
#define PANEL_COMPARISON_H

#include "draw.h"
#include "frames.h"
#include "scene.h"
#include "widgets.h"

class Comparison : public Widgets {
public:
    // Beneath the row of files: keep, show, A's camera, exchange.
    void draw(Scene &scene, const BhrAdapterInfo &adapter);
    // Begins A's picture where there is a new one to show: of A's setting at B's time, seen by B's camera or its own.
    void submit(const Scene &scene, uint32_t width, uint32_t height, double now);
    // Takes A's picture that is done. True: the window has something new to show.
    bool collect();

    bool           shown() const { return shows_ && !picture_.empty(); }
    const Texture &picture() const { return picture_; }
    // The meaning of its colours.
    const ColourBar &bar() const { return bar_; }
    bool           in_flight() const { return queue_ != nullptr && queue_->in_flight() > 0; }
    // All of A's pictures that were taken.
    unsigned       count() const { return count_; }
    bool           kept() const { return !text_.empty(); }

private:
    Result keep(const Scene &scene, const BhrAdapterInfo &adapter);
    Result load(const std::string &text);
    Result exchange(Scene &scene);

    // The queue's jobs end before their context.
    Context                     context_;
    std::unique_ptr<FrameQueue> queue_;
    std::string                 text_; // A
    BhrCamera                   camera_{}; // A's
    bool                        shows_ = false, own_camera_ = false;
    uint64_t                    kept_ = 0; // times that A was another one
    struct Wanted {
        uint64_t kept = 0, version = 0;
        uint32_t width = 0, height = 0;
        bool     own_camera = false;
        bool     operator==(const Wanted &other) const;
    };
    Wanted   submitted_;
    double   time_ = -1.0;
    Texture  picture_;
    ColourBar bar_{};
    unsigned count_ = 0;
};

#endif
