/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// history.h -- undo and redo of what the user does to a scene: its texts, as bhr saves them into memory, the last
// hundred of them. Knows no widget.
#ifndef PANEL_HISTORY_H
#define PANEL_HISTORY_H

#include "scene.h"

#include <deque>
#include <string>

class History {
public:
    // Around everything with which the user can change the scene. held: a button or a widget is. Changes that follow
    // each other, or come while something is held, are one.
    void before(const Scene &scene, bool held, double now);
    void after(const Scene &scene, double now);

    bool   can_undo() const { return !past_.empty(); }
    bool   can_redo() const { return !future_.empty(); }
    Result undo(Scene &scene) { return go(scene, past_, future_); }
    Result redo(Scene &scene) { return go(scene, future_, past_); }

private:
    using Texts = std::deque<std::string>;

    Result go(Scene &scene, Texts &from, Texts &to);

    Texts       past_, future_; // the nearest last
    std::string kept_;          // the scene before a change
    uint64_t    kept_version_ = UINT64_MAX, begun_version_ = 0;
    bool        changing_ = false;
    double      changed_at_ = 0.0;
};

#endif
