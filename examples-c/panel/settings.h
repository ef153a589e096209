/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// settings.h -- the panel of settings, behind four tabs that each scroll by themselves: scene, film, effects, frames.
// Every value goes through the library's own checks (widgets.h). Makes no frames.
#ifndef PANEL_SETTINGS_H
#define PANEL_SETTINGS_H

#include "frames.h"
#include "scene.h"
#include "sections.h"
#include "widgets.h"

// How the program makes frames of the scene.
struct FrameSettings {
    double   scale = 1.0;     // of the traced picture against its place in the window
    bool     adaptive = true; // a coarser picture while the scene is moved by hand
    bool     always = false;  // goes on tracing when nothing has changed
    uint32_t in_flight = static_cast<uint32_t>(FrameQueue::CAPACITY);
};

struct Clock {
    bool   running = true;
    double speed = 8.0;        // of the scene, in M per second
    bool   moves_camera = false; // along its world line, when it falls or orbits
};

class SettingsPanel : public Widgets {
public:
    // numbers: of the scene as it is; light: draws what stands above the film's settings, and stays there.
    void draw(Scene &scene, const BhrHoleInfo &numbers, FrameSettings &frames, Clock &clock, SectionReports &reports,
              const std::function<void()> &light);

    // Remembers the last item, a tab of the window's, for programs that drive it. After draw.
    void mark_tab(const char *bar, const char *name);

private:
    void hole(Scene &scene, const BhrHoleInfo &numbers);
    void camera(Scene &scene, const BhrHoleInfo &numbers);
    void disk(Scene &scene);
    void matter(Scene &scene);
    void volume(Scene &scene, size_t index);
    void hot_spot(Scene &scene, size_t index);
    void sky(Scene &scene);
    void film(Scene &scene);
    void preset(Scene &scene);
    void film_fields(Scene &scene, const Shown &shown);
    void quality(Scene &scene, FrameSettings &frames);
    void view(Scene &scene);
    void effects(Scene &scene);
    void time(Scene &scene, Clock &clock);
};

#endif
