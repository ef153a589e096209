/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* process_end.c -- hosts that end by exit() while bhr works: right after a context was made, for which kernels are
 * being compiled; while jobs are on their way, also from another thread; with a handler that destroys the context,
 * after which its log callback is not called; with one that joins a thread which has used bhr; in a forked child.
 * Each ends with the status that it gave, soon, and, with a driver, when no thread of bhr's is at work in it any
 * more, because drivers unload parts of themselves then. Linux alone shows threads by name. (NVIDIA's driver itself
 * ends forked children by a signal.) */
#define _GNU_SOURCE

#include "check.h"

#include <dirent.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define WIDTH 640u
#define HEIGHT 360u
#define STATUS 3
#define AT_WORK 4
#define JOBS 3

static BhrBackend    backend;
static BhrContext   *context;
static BhrJob       *jobs[JOBS];
static unsigned char pixels[JOBS][WIDTH * HEIGHT * 4];

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

/* Threads of bhr's that run, and do not wait: those that compile kernels, as others do more than call drivers. */
static int at_work(void) {
    int            count = 0;
    DIR           *tasks = opendir("/proc/self/task");
    struct dirent *task;
    while (tasks && (task = readdir(tasks)) != NULL) {
        char  path[300], name[64] = "", state = 0;
        FILE *file;
        snprintf(path, sizeof path, "/proc/self/task/%s/stat", task->d_name);
        file = fopen(path, "r");
        if (file && fscanf(file, "%*d (%63[^)]) %c", name, &state) == 2 && strcmp(name, "bhr-kernels") == 0)
            count += state == 'R';
        if (file)
            fclose(file);
    }
    if (tasks)
        closedir(tasks);
    return count;
}

/* Registered before bhr has loaded a driver, so that it runs after bhr's handler. Threads may take a moment to come to
 * their next call of a driver. */
static void look(void) {
    const struct timespec grace = {0, 300000000}, moment = {0, 10000000};
    int                   busy = 0;
    nanosleep(&grace, NULL);
    for (int i = 0; i < 10; i++) {
        nanosleep(&moment, NULL);
        busy += at_work();
    }
    if (busy > 1)
        _exit(AT_WORK);
}

static void begin_jobs(void) {
    for (int i = 0; i < JOBS; i++) {
        const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels[i], sizeof pixels[i]);
        if (bhr_render_image_async(context, &image, &jobs[i]) < 0)
            _exit(5);
    }
}

/* A callback that the host has freed all of once the context is destroyed. */
static int gone, late;

static void hear(void *user, BhrLogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
    late += gone;
}

static void destroy(void) {
    const struct timespec while_threads_go_on = {3, 0};
    BhrStatus             status = bhr_set_mass(context, 2);
    if (status != (backend == BHR_BACKEND_CPU ? BHR_OK : BHR_ERROR_INVALID_STATE))
        _exit(7);
    for (int i = 0; i < JOBS; i++)
        bhr_job_cancel(jobs[i]);
    bhr_context_destroy(context);
    gone = 1;
    for (int i = 0; i < JOBS; i++)
        bhr_job_destroy(jobs[i]);
    memset(pixels, 7, sizeof pixels);
    nanosleep(&while_threads_go_on, NULL);
    for (size_t i = 0; i < sizeof pixels; i++)
        if (((unsigned char *)pixels)[i] != 7)
            _exit(8);
    if (late > 0)
        _exit(9);
}

static void *ending(void *unused) {
    (void)unused;
    exit(STATUS);
}

/* Hosts, each in a process of its own. */
static void right_after_a_context(void) {
    atexit(look);
    context = check_context(backend);
    exit(STATUS);
}

static void with_jobs(void) {
    atexit(look);
    context = check_context(backend);
    begin_jobs();
    exit(STATUS);
}

static void from_another_thread(void) {
    pthread_t thread;
    atexit(look);
    context = check_context(backend);
    begin_jobs();
    if (pthread_create(&thread, NULL, ending, NULL) != 0)
        _exit(5);
    for (;;)
        pause();
}

static void with_a_handler_that_destroys(void) {
    BhrContextOptions options = check_options(backend);
    options.log_fn = hear;
    options.log_level = BHR_LOG_TRACE;
    atexit(destroy);
    context = check_context_with(&options);
    begin_jobs();
    exit(STATUS);
}

/* A pool's thread, which has used bhr, and waits for more to do. */
static pthread_t       pool;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t  changed = PTHREAD_COND_INITIALIZER;
static int             has_rendered, ends;

static void *render_and_wait(void *unused) {
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels[0], sizeof pixels[0]);
    (void)unused;
    if (bhr_render_image(context, &image) < 0)
        _exit(5);
    pthread_mutex_lock(&lock);
    has_rendered = 1;
    pthread_cond_broadcast(&changed);
    while (!ends)
        pthread_cond_wait(&changed, &lock);
    pthread_mutex_unlock(&lock);
    return NULL;
}

static void join(void) {
    pthread_mutex_lock(&lock);
    ends = 1;
    pthread_cond_broadcast(&changed);
    pthread_mutex_unlock(&lock);
    pthread_join(pool, NULL);
}

static void with_a_handler_that_joins(void) {
    atexit(join);
    context = check_context(backend);
    if (pthread_create(&pool, NULL, render_and_wait, NULL) != 0)
        _exit(5);
    pthread_mutex_lock(&lock);
    while (!has_rendered)
        pthread_cond_wait(&changed, &lock);
    pthread_mutex_unlock(&lock);
    exit(STATUS);
}

static void in_a_forked_child(void) {
    int    status = 0;
    double begun;
    context = check_context(backend);
    begin_jobs();
    begun = now();
    pid_t child = fork();
    if (child == 0)
        exit(STATUS);
    if (waitpid(child, &status, 0) != child || !WIFEXITED(status))
        _exit(5);
    if (now() - begun > 8)
        _exit(6);
    for (int i = 0; i < JOBS; i++)
        bhr_job_destroy(jobs[i]);
    bhr_context_destroy(context);
    exit(WEXITSTATUS(status));
}

static void in_process(const char *name, void (*body)(void)) {
    int    status = 0;
    double begun = now(), took;
    pid_t  child = fork();
    if (child == 0) {
        body();
        _exit(5);
    }
    if (child < 0 || waitpid(child, &status, 0) != child) {
        CHECK(0, "%s: no process", name);
        return;
    }
    took = now() - begun;
    CHECK(WIFEXITED(status), "%s: killed by signal %d", name, WTERMSIG(status));
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == STATUS, "%s: status %d", name, WEXITSTATUS(status));
    CHECK(took < 120, "%s: it took %.1f s", name, took);
}

int main(int argc, char **argv) {
    backend = check_begin(argc, argv);
    in_process("exit right after a context", right_after_a_context);
    in_process("exit with jobs", with_jobs);
    in_process("exit from another thread", from_another_thread);
    in_process("exit with a handler that destroys the context", with_a_handler_that_destroys);
    in_process("exit with a handler that joins a thread", with_a_handler_that_joins);
    in_process("exit in a forked child", in_a_forked_child);
    return check_end();
}
