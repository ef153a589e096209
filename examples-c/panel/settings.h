/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// settings.h -- the panel of settings: each widget shows the value in force and asks the library for another one; what
// it refuses is said in red under the widget and changes nothing. Makes no frames.
#ifndef PANEL_SETTINGS_H
#define PANEL_SETTINGS_H

#include "../fields.h"
#include "frames.h"
#include "scene.h"

#include <map>
#include <string>

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

class SettingsPanel {
public:
    // numbers: of the scene as it is.
    void draw(Scene &scene, const BhrHoleInfo &numbers, FrameSettings &frames, Clock &clock);
    // Says what is wrong with a widget; "" takes it back.
    void report(const char *section, const char *widget, const std::string &message);

    size_t             refusals() const { return refusals_; }
    const std::string &last_refusal() const { return last_refusal_; }

private:
    void hole(Scene &scene, const BhrHoleInfo &numbers);
    void camera(Scene &scene, const BhrHoleInfo &numbers);
    void disk(Scene &scene);
    void matter(Scene &scene);
    void volume(Scene &scene, size_t index);
    void hot_spot(Scene &scene, size_t index);
    void sky(Scene &scene);
    void film(Scene &scene);
    void quality(Scene &scene, FrameSettings &frames);
    void view(Scene &scene);
    void time(Scene &scene, Clock &clock);

    bool section(const char *name, bool open);
    template <class Set>
    void number(const char *label, double value, double low, double high, const char *format, bool logarithmic,
                Set set, const char *about = nullptr);
    template <class Set>
    void whole(const char *label, uint32_t value, uint32_t low, uint32_t high, Set set, const char *about = nullptr);
    template <class Set>
    void vector(const char *label, const double value[3], Set set, const char *about = nullptr);
    template <class Set>
    void choice(const char *label, int32_t value, const Choice *choices, Set set, const char *about = nullptr);
    template <class Set> void bits(uint32_t flags, const Choice *choices, Set set);
    template <class Set> void seed(const char *label, uint64_t value, Set set, const char *about);
    template <class Struct, class Set, class Shown>
    void fields(const Field *list, Struct &value, const Struct &defaults, Set set, Shown shown);
    template <class Set>
    void field(const Field *list, const Field &field, char *target, const char *by_default, Set set);
    template <class Set> void flag(const char *label, uint32_t flags, uint32_t bit, Set set);
    template <class Set> void try_number(const char *label, double value, Set set);
    void                      show_message(const char *label);

    const char                        *section_ = "";
    std::map<std::string, std::string> messages_; // by "section/widget"
    std::map<std::string, double>      refused_;  // numbers, while their message stands
    size_t                             refusals_ = 0;
    std::string                        last_refusal_;
};

#endif
