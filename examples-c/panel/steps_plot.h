/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// steps_plot.h -- how many integration steps the rays of the picture take: along the row of a pixel, and over the whole
// picture. Asks for small frames in the background and shows the last ones that came.
#ifndef PANEL_STEPS_PLOT_H
#define PANEL_STEPS_PLOT_H

#include "frames.h"
#include "scene.h"

class StepsPlot {
public:
    // Begins the frames that are missing, as far as there is room. The picture is width x height, the pixel in it.
    // Returns the first failure.
    Result request(BhrContext *context, const Scene &scene, FrameQueue &queue, uint32_t width, uint32_t height,
                   uint32_t row, double now);
    void   take(const FinishedFrame &frame);
    // Whether both frames of this version of the light's ways have come.
    bool settled(uint64_t geometry_version, uint32_t width, uint32_t height, uint32_t row) const;
    // The answer that was asked for will not come.
    void forget() { asked_row_ = asked_frame_ = Wanted{}; }

    void draw(const Scene &scene, uint32_t column, uint32_t picture_width) const;

private:
    struct Wanted {
        uint64_t version = UINT64_MAX;
        uint32_t width = 0, height = 0, row = 0;
        bool     operator==(const Wanted &other) const {
            return version == other.version && width == other.width && height == other.height && row == other.row;
        }
    };

    std::vector<float> row_;
    double             highest_ = 0.0, mean_ = 0.0;
    size_t             pending_ = 0;
    Wanted             asked_row_, asked_frame_;
};

#endif
