/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// files.h -- the row that saves and loads the scene, and goes back and forth in its history.
#ifndef PANEL_FILES_H
#define PANEL_FILES_H

#include "history.h"

#include <string>

class FilesRow {
public:
    void draw(Scene &scene, History &history);
    // Undoes for 'z', redoes for 'y'.
    void key(char key, Scene &scene, History &history);

    // Both grow with what was done, and say what that was.
    size_t             count() const { return count_; }
    const std::string &said() const { return said_; }

private:
    void say(const Result &result, const std::string &done);

    char        path_[1024] = "panel.toml";
    std::string said_;
    bool        refused_ = false;
    size_t      count_ = 0;
};

#endif
