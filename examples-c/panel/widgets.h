/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// widgets.h -- widgets for single values, each in a row with its label: it shows the value in force and asks for
// another one; a refusal is said in red under the widget and changes nothing. A tip says the value's meaning, unit,
// range and source. Knows no scene.
#ifndef PANEL_WIDGETS_H
#define PANEL_WIDGETS_H

#include "../fields.h"
#include "handles.h"

#include <functional>
#include <imgui.h>
#include <map>
#include <string>

constexpr float LABEL_EMS = 6.6F; // the width of the labels' column

// A tip for the last widget, where the mouse has rested on it for a moment. "": none.
void tell(const std::string &tip);
// Two numbers a row.
void fact(const char *name, double value, const char *format, bool left);

class Widgets {
public:
    // Says what is wrong with a widget; "" takes it back.
    void report(const char *section, const char *widget, const std::string &message);

    size_t             refusals() const { return refusals_; }
    const std::string &last_refusal() const { return last_refusal_; }
    // The middle of each widget that a frame of the program has shown, by "section/label": for programs that drive it.
    const std::map<std::string, ImVec2> &places() const { return places_; }

protected:
    template <class Value> using Set = std::function<Result(Value)>;
    using Shown = std::function<bool(const Field &)>;

    bool section(const char *name, bool open);
    // Values from here on belong to it, without a headline of their own.
    void begin_section(const char *name) { section_ = name; }
    void forget_places() { places_.clear(); }
    // Remembers the last item as one of the current section.
    void mark(const char *label);

    // A label is shown up to its "##"; all of it tells rows of a section apart.
    // low and high bound the slider only: with Ctrl and a click any number can be typed, and the library judges it.
    void number(const char *label, double value, double low, double high, const char *format, bool logarithmic,
                const Set<double> &set, const std::string &tip = "");
    void whole(const char *label, uint32_t value, uint32_t low, uint32_t high, const Set<uint32_t> &set,
               const std::string &tip = "", const char *format = "%u");
    void vector(const char *label, const double value[3], const Set<const double *> &set, const std::string &tip = "");
    // A value that is none of the choices shows nothing.
    void choice(const char *label, int32_t value, const Choice *choices, const Set<int32_t> &set,
                const std::string &tip = "");
    void bits(uint32_t flags, const Choice *choices, const Set<uint32_t> &set, const std::string &tip);
    void seed(const char *label, uint64_t value, const Set<uint64_t> &set, const std::string &tip);
    void flag(const char *label, uint32_t flags, uint32_t bit, const Set<uint32_t> &set, const std::string &tip = "");
    // A text that is asked for when Enter ends it.
    void text(const char *label, const std::string &value, const Set<const char *> &set, const std::string &tip);
    // A widget for each field of a struct that `shown` is true for. defaults: such a struct as the library begins it;
    // set: asks for the struct that has the new value.
    void fields(const Field *list, void *value, const void *defaults, const std::function<Result()> &set,
                const Shown &shown);
    void show_message(const char *label);

private:
    void begin_row(const char *label, const std::string &tip);
    void end_row(const char *label, const std::string &tip);
    void try_number(const char *label, double value, const std::function<Result()> &set);
    void field(const Field *list, const Field &field, char *target, const char *by_default,
               const std::function<Result()> &set);

    const char                        *section_ = "";
    std::map<std::string, std::string> messages_; // by "section/widget"
    std::map<std::string, double>      refused_;  // numbers, while their message stands
    std::map<std::string, ImVec2>      places_;
    std::string                        edited_of_; // the text that is being typed, and its row
    char                               edited_[1024] = "";
    size_t                             refusals_ = 0;
    std::string                        last_refusal_;
};

#endif
