/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// sections.h -- windows and parts of windows that stay in their place and scroll what they cannot hold, with an account
// of what a frame of the program has of them. Knows nothing of what is in them.
#ifndef PANEL_SECTIONS_H
#define PANEL_SECTIONS_H

#include "layout.h"

#include <string>
#include <vector>

// A section, laid out by ImGui: `hidden` is how far its content reaches beyond it, across and down; bar: there is one
// that scrolls it down.
struct SectionReport {
    std::string name;
    ImVec2      at, size, hidden;
    bool        bar = false;
};
using SectionReports = std::vector<SectionReport>;

// A window of ImGui's. bare: without border, title and scroll bar, for a picture that always fits.
class FixedWindow {
public:
    FixedWindow(SectionReports &reports, const char *title, const Place &place, bool bare = false);
    ~FixedWindow();
    FixedWindow(const FixedWindow &) = delete;
    FixedWindow &operator=(const FixedWindow &) = delete;

private:
    SectionReports &reports_;
    std::string     name_;
};

// A part of a window that scrolls by itself. A size of 0: the room that is left.
class Part {
public:
    Part(SectionReports &reports, const char *name, ImVec2 size);
    ~Part();
    Part(const Part &) = delete;
    Part &operator=(const Part &) = delete;

private:
    SectionReports &reports_;
    std::string     name_;
};

#endif
