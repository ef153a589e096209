/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// picture.h -- the picture as the window shows it, and what the mouse does on it. Traces nothing and sets nothing.
#ifndef PANEL_PICTURE_H
#define PANEL_PICTURE_H

#include "draw.h"
#include "frames.h"

#include <string>

class Picture {
public:
    struct Input {
        float  drag_x = 0.0F, drag_y = 0.0F; // since the last frame of the window
        float  wheel = 0.0F;
        bool   clicked = false;              // the pixel has moved
    };

    // Takes the pixels over; gives back those that it had.
    Pixels take(Pixels &&pixels);
    // Into the rest of the current ImGui window. bare: nothing but the picture. other: a picture that is shown left of
    // a line, which the mouse can drag; NULL: none. foot: the height that is left free beneath the picture.
    Input draw(double pixel_ratio, bool bare, const std::string &news, const std::string &error, const Texture *other,
               float foot);

    const Pixels &pixels() const { return pixels_; }
    // Its place in the window, in pixels; 0 before it was first drawn.
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    // The pixel that was last clicked on.
    uint32_t column() const { return std::min(static_cast<uint32_t>(x_ * width_), width_ - 1); }
    uint32_t row() const { return std::min(static_cast<uint32_t>(y_ * height_), height_ - 1); }
    ImVec2   corner() const { return corner_; }
    // The line's place, as a part of the width.
    float    wipe() const { return wipe_; }

private:
    void draw_wipe(const Texture &other, ImVec2 end) const;
    bool on_wipe() const;

    Pixels   pixels_;
    Texture  texture_;
    uint32_t width_ = 0, height_ = 0;
    ImVec2   corner_{};
    float    wipe_ = 0.5F;
    bool     wiping_ = false; // the mouse holds the line
    double   x_ = 0.434, y_ = 0.376; // of the pixel, as parts of the sides: at first one whose ray bends well
};

#endif
