/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_news.c -- see viewer_news.h. */
#include "viewer_news.h"

#include <string.h>

#define TITLE_PERIOD 0.25 /* seconds */
#define NEWS_FOR 4.0      /* seconds that the end of a picture or a film stands in the title */

int viewer_is_busy(const Viewer *v) {
    return v->picture.job != NULL || v->recorder.context != NULL;
}

/* The end of something, in the title for a while. */
static void tell(Viewer *v, const char *what, const char *name) {
    snprintf(v->news, sizeof v->news, "   %s %s", what, name);
    v->news_until = wall_seconds() + NEWS_FOR;
    v->titled_at = 0.0; /* at once */
}

void viewer_watch(Viewer *v) {
    char       folder[FOLDER_NAME];
    PictureEnd end = picture_poll(&v->picture);
    if (end == PICTURE_SAVED) {
        tell(v, "saved", v->picture.path);
    } else if (end == PICTURE_FAILED) {
        tell(v, "no picture:", "see the terminal");
    }
    memcpy(folder, v->recorder.folder, sizeof folder); /* it is gone with the film */
    end = recorder_poll(&v->recorder);
    if (end == PICTURE_SAVED) {
        tell(v, "saved", folder);
    } else if (end == PICTURE_FAILED) {
        tell(v, "broken off:", folder);
    }
    if (v->quitting && !viewer_is_busy(v)) {
        glfwSetWindowShouldClose(v->window, GLFW_TRUE);
    }
}

void viewer_quit(Viewer *v) {
    if (!viewer_is_busy(v)) {
        glfwSetWindowShouldClose(v->window, GLFW_TRUE);
    } else if (v->quitting) {
        picture_cancel(&v->picture);
        recorder_cancel(&v->recorder);
        glfwSetWindowShouldClose(v->window, GLFW_TRUE);
    } else {
        recorder_stop(&v->recorder);
        v->quitting = 1;
        v->titled_at = 0.0;
        printf("ends when %s is saved; Esc again breaks it off\n",
               v->recorder.context != NULL ? v->recorder.folder : v->picture.path);
    }
}

/* How far the background is. */
static void news_of_work(Viewer *v) {
    char film[FOLDER_NAME + 48] = "", picture[PICTURE_NAME + 16] = "";
    if (!viewer_is_busy(v)) {
        return;
    }
    if (v->recorder.context != NULL) {
        snprintf(film, sizeof film, "   %s %s %u of %u", v->recorder.taking ? "recording" : "film", v->recorder.folder,
                 v->recorder.saved, v->recorder.taken);
    }
    if (v->picture.job != NULL) {
        snprintf(picture, sizeof picture, "   %s %.0f %%", v->picture.path, 100.0 * v->picture.fraction);
    }
    snprintf(v->news, sizeof v->news, "%s%s%s", v->quitting ? "   Esc again ends without" : "", picture, film);
    v->news_until = wall_seconds() + NEWS_FOR;
}

void viewer_update_title(Viewer *v, int moving) {
    const double  now = wall_seconds(), elapsed = now - v->titled_at;
    BhrHoleInfo   info;
    BHR_INIT(info);
    if (elapsed < TITLE_PERIOD || v->frames == 0 || scene_apply(&v->scene, v->tester) < 0 ||
        bhr_hole_info(v->tester, &info) < 0) {
        return;
    }
    char title[400], rate[32], gpu[32], scale[32] = "", look[32] = "";
    snprintf(rate, sizeof rate, v->frames_untitled > 0 ? "%.0f fps" : "at rest", v->frames_untitled / elapsed);
    const uint64_t gpu_ns = v->frame.stats.gpu_ns;
    snprintf(gpu, sizeof gpu, gpu_ns != 0 ? "GPU %.2f ms" : "GPU -", (double)gpu_ns * 1e-6);
    if (moving && v->governor.enabled && v->governor.scale < 1.0) {
        snprintf(scale, sizeof scale, "   traced at %.0f %%", 100.0 * v->governor.scale);
    }
    if (v->preset != NO_PRESET) {
        snprintf(look, sizeof look, "   %s, %s", choice_name(PRESETS, v->preset),
                 choice_name(PRESET_MATTERS, v->preset_matter));
    }
    news_of_work(v);
    const char *late = v->late_count > 0 ? "   after this frame .." : "";
    const char *news = now < v->news_until ? v->news : "";
    snprintf(title, sizeof title, "bhr%s%s   %s   %s   M %.4g   a %+.3f M   r %.4g M   d\xcf\x84/dt %.4f%s%s", late,
             news, rate, gpu, v->scene.mass, v->scene.spin, info.camera_radius / v->scene.mass, info.camera_time_rate,
             look, scale);
    glfwSetWindowTitle(v->window, title);
    v->titled_at = now;
    v->frames_untitled = 0;
}
