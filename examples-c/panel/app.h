/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// app.h -- the program itself: the loop that begins frames, takes those that are done, and draws the window. One
// thread, which never waits for a frame.
#ifndef PANEL_APP_H
#define PANEL_APP_H

#include "colour_legend.h"
#include "comparison.h"
#include "files.h"
#include "inspector.h"
#include "layout.h"
#include "light_scope.h"
#include "metric_map.h"
#include "performance.h"
#include "picture.h"
#include "ray_panel.h"
#include "scene.h"
#include "settings.h"
#include "steps_plot.h"
#include "window.h"

#include <string>

struct AppOptions {
    uint32_t    size[2] = {0, 0}; // 0: what the screen holds of 1600 x 1000
    uint32_t    frames = 0;   // to show before the program ends; 0: no such end
    double      hold = -1.0;  // seconds to stay open, after those frames if there are some; < 0: until closed
    const char *screenshot = nullptr, *picture = nullptr; // files to write at the end
    BhrPreset   preset = NO_PRESET; // the look that it begins with
    int32_t     matter = BHR_PRESET_MATTER_AUTO; // of presets; with --frames THIN instead
    int         bare = 0, paused = 0, verbose = 0;
};

class App {
public:
    // The context must live longer.
    App(BhrContext *context, const AppOptions &options);
    ~App();
    App(const App &) = delete;
    App &operator=(const App &) = delete;

    // "", or what keeps the program from starting.
    std::string start();
    // Until the window is closed or the options say so; the process's exit status.
    int run();

private:
    // A picture of this scene in this size.
    struct Wanted {
        uint64_t version = UINT64_MAX;
        uint32_t width = 0, height = 0;
    };

    bool   counted() const { return options_.frames > 0; }
    bool   touched(double now) const;
    void   collect_frames(double now);
    void   take_picture(FinishedFrame &&frame, double now);
    void   measure_speed(const FinishedFrame &frame, double now);
    void   submit_frames(double now);
    void   submit_picture(double now);
    double picture_scale(double now) const;
    void   advance_clock(double seconds);
    void   failed(const Result &result, double now);
    void   recover(double now);
    void   inspect();
    void   draw(double now, Pixels *copy);
    Picture::Input draw_picture();
    void   draw_panels(const Layout &layout);
    void   draw_instruments(const Layout &layout);
    void   draw_instrument_tabs(const Layout &layout);
    void   draw_ray_views(ImVec2 room);
    void   move_camera(const Picture::Input &input);
    bool   counted_out(double now) const;
    bool   finished(double now);
    int    save();
    void   say(const Picture::Input &input);
    void   say_places();

    AppOptions  options_;
    BhrContext *context_;

    Window         window_;
    Scene          scene_;
    FrameQueue     queue_;
    Inspector      inspector_;
    BhrAdapterInfo adapter_{};
    Picture        picture_;
    Comparison     comparison_;
    ColourBar      bar_{};            // of the picture's colours
    ColourLegend   legend_;           // as the window shows it
    LightScope     light_scope_;
    SettingsPanel  settings_;
    History        history_;
    FilesRow       files_;
    RayPanel       ray_panel_;
    MetricMap      metric_map_;
    StepsPlot      steps_plot_;
    Performance    performance_;
    FrameSettings  frame_settings_;
    Clock          clock_;

    RayReport   ray_;
    Wanted      ray_of_;              // what it belongs to; version is that of the scene's geometry
    uint32_t    ray_column_ = 0, ray_row_ = 0;
    std::string error_;               // of the last frame that could not be
    bool        lost_ = false;        // the device
    double      retry_at_ = 0.0;
    unsigned    recoveries_ = 0;
    Wanted      submitted_of_;
    uint32_t    submitted_ = 0, pictures_ = 0;
    double      to_show_ = -1.0;      // when the picture was submitted that came last, until the window shows it
    double      touched_at_ = -1e9;   // by the user, last
    double      steps_at_ = -1e9;     // last look at the integration steps
    double      finished_at_ = -1e9;  // last picture
    double      seconds_per_pixel_ = 0.0;
    double      hold_until_ = -1.0; // < 0: not yet holding
    double      auto_ev_ = 0.0;     // of the last picture

    SectionReports sections_; // of the window as it was drawn last

    Wanted   said_place_; // what --verbose said last
    uint64_t said_geometry_ = 0;
    size_t   said_refusals_ = 0, said_files_ = 0;
    size_t   said_volumes_ = 0, said_spots_ = 0;
    uint32_t said_pictures_ = 0, said_light_ = 0;
    unsigned said_compared_ = 0;
    float    said_wipe_ = 0.5F;
    std::string said_places_, said_colours_;
};

#endif
