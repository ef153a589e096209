/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// field_look.h -- how the panel shows a field of a struct of the library: its label, and its slider where it is a
// number. Follows from what bhr.h says of the field, but for a few. Knows no widgets.
#ifndef PANEL_FIELD_LOOK_H
#define PANEL_FIELD_LOOK_H

#include "../fields.h"

#include <string>

struct FieldLook {
    std::string label;
    double      low = 0.0, high = 0.0; // the slider's ends, in units of `unit`
    bool        logarithmic = false;
    std::string format;     // of the number
    double      unit = 1.0; // of what is shown
};

// list: the fields that `field` is one of; by_default: its number in a struct that has the library's defaults; value:
// the one that is shown, for 0 may stand for something else.
FieldLook look_of(const Field *list, const Field &field, double by_default, double value);

// The label of a field that is no number, and of one bit.
std::string label_of(const Field *list, const Field &field);

// All that a tip says of a field: its meaning, unit and range, its place in bhr.h, the page that explains it, and where
// it comes from.
std::string tip_of(const Field *list, const Field &field);

// A name of fields.c as a label: blanks for dashes.
std::string as_label(const char *name);

#endif
