// SPDX-License-Identifier: MIT OR Apache-2.0
// history.cpp -- see history.h.
#include "history.h"

namespace {

constexpr double PAUSE = 0.5; // seconds between two changes by the wheel, say, that are two
constexpr size_t MOST_TEXTS = 100;
constexpr size_t MOST_BYTES = size_t{16} << 20; // a scene has 3000, but may have millions

void add(std::deque<std::string> &texts, const std::string &text) {
    texts.push_back(text);
    size_t bytes = 0;
    for (const std::string &one : texts) {
        bytes += one.size();
    }
    while (texts.size() > MOST_TEXTS || (bytes > MOST_BYTES && texts.size() > 1)) {
        bytes -= texts.front().size();
        texts.pop_front();
    }
}

} // namespace

void History::before(const Scene &scene, bool held, double now) {
    changing_ = changing_ && (held || now - changed_at_ < PAUSE);
    begun_version_ = scene.version();
    // The clock changes the scene, too: kept is how it is when the user's change begins.
    if (!changing_ && scene.version() != kept_version_ && scene.save_text(kept_).ok()) {
        kept_version_ = scene.version();
    }
}

void History::after(const Scene &scene, double now) {
    if (scene.version() == begun_version_) {
        return;
    }
    if (!changing_ && kept_version_ == begun_version_) {
        add(past_, kept_);
        future_.clear();
    }
    changing_ = true;
    changed_at_ = now;
}

Result History::go(Scene &scene, Texts &from, Texts &to) {
    std::string now;
    Result      result = from.empty() ? Result{} : scene.save_text(now);
    if (from.empty() || !result.ok()) {
        return result;
    }
    result = scene.load_text(from.back());
    if (result.ok()) {
        from.pop_back();
        add(to, now);
        changing_ = false;
        begun_version_ = scene.version(); // this is no change to undo
    }
    return result;
}
