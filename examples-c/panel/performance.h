/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// performance.h -- how fast frames come: numbers of each finished frame, and their course over the last ones.
#ifndef PANEL_PERFORMANCE_H
#define PANEL_PERFORMANCE_H

#include <array>
#include <bhr.h>
#include <cstddef>
#include <limits>

class Performance {
public:
    // A picture came into the program's memory. Times are on the program's clock.
    void finished(const BhrFrameStats &stats, double submitted);
    // A picture was shown.
    void shown(double submitted, double now);

    void draw(const BhrAdapterInfo &adapter, size_t in_flight, unsigned recoveries) const;

    double frames_per_second() const { return rate_; }

private:
    static constexpr size_t HISTORY = 160;
    struct Course {
        Course() { values.fill(std::numeric_limits<float>::quiet_NaN()); }
        void append(double value);

        std::array<float, HISTORY> values; // the oldest first
    };

    bool usual(double submitted) const;

    BhrFrameStats stats_{};
    Course        cpu_, gpu_, readback_, latencies_, rates_;
    double        latency_ = 0.0; // of the last picture, seconds
    double        rate_ = 0.0;    // 0: not known
    double        first_shown_ = -1.0, last_shown_ = -1.0; // < 0: not yet
    uint64_t      count_ = 0;
};

#endif
