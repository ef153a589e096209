/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_frame.c -- see viewer_frame.h. */
#ifndef _WIN32
#define _POSIX_C_SOURCE 200112L /* threads */
#endif

#include "viewer_frame.h"

#include <stdlib.h>

static void render(FrameThread *thread) {
    thread->status = scene_apply(&thread->scene, thread->context);
    if (thread->status >= 0) {
        thread->status = bhr_render_surface(thread->context, thread->surface);
    }
    if (thread->status < 0) {
        report_failure("render the frame", thread->status); /* here: messages belong to the thread that called */
    } else if (thread->status == BHR_OK) {
        BHR_INIT(thread->stats);
        if (bhr_frame_stats(thread->context, &thread->stats) < 0) {
            BHR_INIT(thread->stats);
        }
    }
}

/* A system has: start and end; give (a frame, or the wish to end) and wait_for (either) on the thread; finish, which
 * says that the frame is done; is_done, and wait until it is. */
#if defined(__APPLE__)

struct FrameSystem {
    int done;
};

static int start(FrameThread *thread) {
    thread->system->done = 1;
    return 1;
}

static void end(FrameThread *thread) { (void)thread; }
static void give(FrameThread *thread) { render(thread); }
static int  is_done(FrameThread *thread, int wait) { return (void)wait, thread->system->done; }

#elif defined(_WIN32)

#include <windows.h>

struct FrameSystem {
    HANDLE thread, given, done; /* events that reset by themselves, when one has waited for them */
    int    ends;
};

static DWORD WINAPI work(void *argument) {
    FrameThread *thread = argument;
    FrameSystem *system = thread->system;
    for (;;) {
        WaitForSingleObject(system->given, INFINITE);
        if (system->ends) {
            return 0;
        }
        render(thread);
        SetEvent(system->done);
        if (thread->on_done != NULL) {
            thread->on_done();
        }
    }
}

static int start(FrameThread *thread) {
    FrameSystem *system = thread->system;
    system->given = CreateEventW(NULL, FALSE, FALSE, NULL);
    system->done = CreateEventW(NULL, FALSE, FALSE, NULL);
    if (system->given != NULL && system->done != NULL) {
        system->thread = CreateThread(NULL, 0, work, thread, 0, NULL);
    }
    return system->thread != NULL;
}

static void end(FrameThread *thread) {
    FrameSystem *system = thread->system;
    if (system->thread != NULL) {
        system->ends = 1;
        SetEvent(system->given);
        WaitForSingleObject(system->thread, INFINITE);
        CloseHandle(system->thread);
    }
    if (system->given != NULL) {
        CloseHandle(system->given);
    }
    if (system->done != NULL) {
        CloseHandle(system->done);
    }
}

static void give(FrameThread *thread) { SetEvent(thread->system->given); }

static int is_done(FrameThread *thread, int wait) {
    return WaitForSingleObject(thread->system->done, wait ? INFINITE : 0) == WAIT_OBJECT_0;
}

#else

#include <pthread.h>

struct FrameSystem {
    pthread_t       thread;
    pthread_mutex_t lock;
    pthread_cond_t  changed;
    int             given, done, ends; /* under the lock */
    int             runs;
};

static void *work(void *argument) {
    FrameThread *thread = argument;
    FrameSystem *system = thread->system;
    pthread_mutex_lock(&system->lock);
    for (;;) {
        while (!system->given && !system->ends) {
            pthread_cond_wait(&system->changed, &system->lock);
        }
        if (system->ends) {
            break;
        }
        system->given = 0;
        pthread_mutex_unlock(&system->lock);
        render(thread);
        pthread_mutex_lock(&system->lock);
        system->done = 1;
        pthread_cond_broadcast(&system->changed);
        if (thread->on_done != NULL) {
            pthread_mutex_unlock(&system->lock);
            thread->on_done();
            pthread_mutex_lock(&system->lock);
        }
    }
    pthread_mutex_unlock(&system->lock);
    return NULL;
}

static int start(FrameThread *thread) {
    FrameSystem *system = thread->system;
    pthread_mutex_init(&system->lock, NULL);
    pthread_cond_init(&system->changed, NULL);
    system->runs = pthread_create(&system->thread, NULL, work, thread) == 0;
    return system->runs;
}

static void end(FrameThread *thread) {
    FrameSystem *system = thread->system;
    if (system->runs) {
        pthread_mutex_lock(&system->lock);
        system->ends = 1;
        pthread_cond_broadcast(&system->changed);
        pthread_mutex_unlock(&system->lock);
        pthread_join(system->thread, NULL);
    }
    pthread_cond_destroy(&system->changed);
    pthread_mutex_destroy(&system->lock);
}

static void give(FrameThread *thread) {
    FrameSystem *system = thread->system;
    pthread_mutex_lock(&system->lock);
    system->given = 1;
    pthread_cond_broadcast(&system->changed);
    pthread_mutex_unlock(&system->lock);
}

static int is_done(FrameThread *thread, int wait) {
    FrameSystem *system = thread->system;
    pthread_mutex_lock(&system->lock);
    while (wait && !system->done) {
        pthread_cond_wait(&system->changed, &system->lock);
    }
    const int done = system->done;
    system->done = 0;
    pthread_mutex_unlock(&system->lock);
    return done;
}

#endif

int frame_thread_start(FrameThread *thread, void (*on_done)(void)) {
    thread->on_done = on_done;
    BHR_INIT(thread->stats);
    thread->system = calloc(1, sizeof *thread->system);
    if (thread->system == NULL || !start(thread)) {
        fprintf(stderr, "cannot start a thread for frames\n");
        frame_thread_end(thread);
        return 0;
    }
    return 1;
}

void frame_thread_begin(FrameThread *thread, BhrContext *context, BhrSurface *surface, const Scene *scene) {
    thread->context = context;
    thread->surface = surface;
    thread->scene = *scene;
    thread->busy = 1;
    give(thread);
}

int frame_thread_take(FrameThread *thread, int wait) {
    if (!thread->busy || !is_done(thread, wait)) {
        return 0;
    }
    thread->busy = 0;
    return 1;
}

void frame_thread_end(FrameThread *thread) {
    if (thread->system != NULL) {
        frame_thread_take(thread, 1);
        end(thread);
        free(thread->system);
        thread->system = NULL;
    }
}
