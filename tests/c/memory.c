/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* memory.c -- address space and threads that run out: whatever is left, each call on the CPU backend ends with a
 * status, and the process lives. Every limit has a process of its own, forked before the library is used.
 *
 *     memory cpu [all]            all: many more limits
 *     memory cpu MOMENT KIB       one limit, in this process: for a debugger. MOMENT: 0 .. 2, as below
 */
#define _DEFAULT_SOURCE

#include "check.h"

#include <fcntl.h>
#include <grp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#define MIB ((size_t)1 << 20)
#define KIB ((size_t)1 << 10)
#define WIDE 1024u
#define HIGH 512u
#define RAYS 20000u
#define JOBS 3

/* The frames and rays of a child: WIDE x HIGH and RAYS in `tests/run all`. Everyday as few as take the same ways: a
 * frame of 512 x 288 is still looked up in tables with spin. */
static uint32_t wide = 512, high = 288, ray_count = 5000;

/* Calls write to and read from these, which are there before any limit is set. */
static unsigned char pixels[JOBS][WIDE * HIGH * 16];
static BhrRay        rays[RAYS];
static BhrHit        hits[RAYS];
static double        path[4 * 65536];
static BhrBody       bodies[RAYS];

/* Whether the sky has its Milky Way, which takes half a second: everyday where the limit is set in a new context. */
static int has_milky_way = 1;

/* When the limit is set: before the library is used, in a context that is new, in one that has rendered. */
typedef enum Moment { BEFORE, NEW, USED, MOMENTS } Moment;
static const char *const MOMENT_NAMES[MOMENTS] = {"before the context", "in a new context", "in a used context"};

/* ---- in a child ---- */

enum { WITHOUT_MEMORY = 1, REFUSED_OTHERWISE = 2 };
static int outcome; /* bits of what happened: the child's exit status */

/* Whether the call succeeded. It may fail for lack of memory, and for no other reason. */
static int took(BhrStatus status, const char *call) {
    if (status == BHR_ERROR_OUT_OF_MEMORY) {
        outcome |= WITHOUT_MEMORY;
        if (bhr_error_message()[0] == '\0') {
            outcome |= REFUSED_OTHERWISE;
        }
    } else if (status < 0) {
        outcome |= REFUSED_OTHERWISE;
        fprintf(stderr, "%s: %s: %s\n", call, bhr_status_name(status), bhr_error_message());
    }
    return status >= 0;
}
#define TOOK(call) took((call), #call)

/* Pages that this process has mapped, as RLIMIT_AS counts them; allocates nothing. */
static size_t address_space(void) {
    char          text[64] = "";
    const int     file = open("/proc/self/statm", O_RDONLY);
    const ssize_t length = file >= 0 ? read(file, text, sizeof text - 1) : -1;
    if (file >= 0) {
        close(file);
    }
    return length > 0 ? (size_t)strtoull(text, NULL, 10) * (size_t)sysconf(_SC_PAGESIZE) : 0;
}

static void limit_memory(size_t more) {
    const size_t        now = address_space();
    const struct rlimit limit = {now + more, now + more};
    if (now == 0 || setrlimit(RLIMIT_AS, &limit) != 0) {
        outcome |= REFUSED_OTHERWISE;
    }
}

/* Allows this user no further thread. Limits do not bind root, who therefore becomes a user that nobody else is. */
static void limit_threads(size_t unused) {
    const struct rlimit limit = {0, 0};
    (void)unused;
    if ((geteuid() == 0 && (setgroups(0, NULL) != 0 || setgid(61234) != 0 || setuid(61234) != 0)) ||
        setrlimit(RLIMIT_NPROC, &limit) != 0) {
        outcome |= REFUSED_OTHERWISE;
    }
}

static void frame(BhrContext *context, BhrFormat format, uint32_t width, uint32_t height) {
    const BhrImage image = image_of(format, width, height, pixels[0], sizeof pixels[0]);
    TOOK(bhr_render_image(context, &image));
}

static void jobs(BhrContext *context) {
    BhrJob *begun[JOBS] = {NULL};
    for (int i = 0; i < JOBS; i++) {
        const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, 200, 100, pixels[i], sizeof pixels[i]);
        TOOK(bhr_render_image_async(context, &image, &begun[i]));
    }
    for (int i = 0; i < JOBS; i++) {
        if (begun[i] != NULL) {
            TOOK(bhr_job_wait(begun[i], UINT64_MAX, NULL));
        }
        bhr_job_destroy(begun[i]);
    }
}

static void outputs(BhrContext *context) {
    const BhrImage images[] = {image_of(BHR_FORMAT_RGBA32F, 200, 100, pixels[0], sizeof pixels[0]),
                               image_of(BHR_FORMAT_R32F, 200, 100, pixels[1], sizeof pixels[1])};
    BhrOutput      both[2];
    for (int i = 0; i < 2; i++) {
        if (!TOOK(bhr_output_init(&both[i], sizeof both[i]))) {
            return;
        }
        both[i].kind = i == 0 ? BHR_OUTPUT_SKY : BHR_OUTPUT_DEPTH;
        both[i].image = &images[i];
    }
    if (TOOK(bhr_render_outputs(context, both, sizeof both[0], 2, NULL)) &&
        TOOK(bhr_set_occluder(context, &images[1]))) {
        frame(context, BHR_FORMAT_RGBA8_SRGB, 200, 100);
        TOOK(bhr_set_occluder(context, NULL));
    }
}

static void skies(BhrContext *context) {
    BhrImage map = image_of(BHR_FORMAT_RGBA8_SRGB, wide, high, pixels[1], sizeof pixels[1]);
    BhrSky   sky;
    if (TOOK(bhr_sky_init(&sky, sizeof sky))) {
        sky.flags = has_milky_way ? sky.flags | BHR_SKY_MAP : BHR_SKY_MAP;
        TOOK(bhr_set_sky_map(context, &map));
        map.width = 64, map.height = 32;
        TOOK(bhr_set_sky_map(context, &map));
        TOOK(bhr_set_sky(context, &sky));
        frame(context, BHR_FORMAT_RGBA8_SRGB, 64, 36);
        TOOK(bhr_set_sky_map(context, NULL));
        static const float nodes[24];
        TOOK(bhr_set_film_lut(context, nodes, 24, 2));
        frame(context, BHR_FORMAT_RGBA8_SRGB, 64, 36);
        TOOK(bhr_set_film_lut(context, NULL, 0, 0));
        sky.flags = BHR_SKY_STARS | BHR_SKY_PROCEDURAL;
        TOOK(bhr_set_sky(context, &sky));
        frame(context, BHR_FORMAT_RGBA8_SRGB, 64, 36);
        TOOK(bhr_sky_init(&sky, sizeof sky));
        TOOK(bhr_set_sky(context, &sky));
    }
}

static void set_sky(BhrContext *context) {
    BhrSky sky;
    if (!has_milky_way && TOOK(bhr_sky_init(&sky, sizeof sky))) {
        sky.flags &= ~(uint32_t)BHR_SKY_MILKY_WAY;
        TOOK(bhr_set_sky(context, &sky));
    }
}

static void trace(BhrContext *context) {
    uint32_t count;
    if (TOOK(bhr_camera_rays(context, 200, ray_count / 200, rays))) {
        TOOK(bhr_trace_rays(context, rays, sizeof rays[0], 1, hits, sizeof hits[0]));
        TOOK(bhr_trace_rays(context, rays, sizeof rays[0], ray_count, hits, sizeof hits[0]));
        TOOK(bhr_trace_path(context, &rays[ray_count / 2 + 100], 65536, path, &count));
    }
}

static void follow(BhrContext *context) {
    BhrBody body;
    if (TOOK(bhr_body_init(&body, sizeof body))) {
        body.position[0] = 12.0;
        body.velocity[1] = 0.3;
        for (uint32_t i = 0; i < ray_count; i++) {
            path[i] = 0.01 * i;
        }
        TOOK(bhr_world_line(context, &body, path, ray_count, bodies, sizeof bodies[0]));
    }
}

/* Makes all calls that take memory. Frames of wide x high are looked up in tables. */
static void use(BhrContext *context) {
    BhrFilm film;
    frame(context, BHR_FORMAT_RGBA8_SRGB, 16, 9);
    frame(context, BHR_FORMAT_RGBA32F, 200, 100);
    jobs(context);
    outputs(context);
    trace(context);
    follow(context);
    if (TOOK(bhr_film_init(&film, sizeof film))) {
        film.bloom = 0.5;
        TOOK(bhr_set_film(context, &film));
        frame(context, BHR_FORMAT_RGBA8_SRGB, 200, 100);
        film.bloom = 0.0;
        TOOK(bhr_set_film(context, &film));
    }
    frame(context, BHR_FORMAT_RGBA8_SRGB, wide, high);
    TOOK(bhr_set_spin(context, 0.9));
    frame(context, BHR_FORMAT_RGBA32F, 100, 50);
    frame(context, BHR_FORMAT_RGBA8_SRGB, wide, high);
    TOOK(bhr_set_spin(context, 0.0));
    skies(context);
}

static BhrContext *make(void) {
    BhrContextOptions options;
    BhrContext       *context = NULL;
    if (TOOK(bhr_context_options_init(&options, sizeof options))) {
        options.backend = BHR_BACKEND_CPU;
        options.cpu_threads = 4;
        TOOK(bhr_context_create(BHR_ABI_VERSION, &options, &context));
    }
    if (context != NULL) {
        set_sky(context);
    }
    return context;
}

static void child(Moment moment, void (*limit)(size_t), size_t more) {
    BhrContext *context = NULL;
    if (moment == BEFORE) {
        limit(more);
    }
    context = make();
    if (moment == USED && context != NULL) {
        frame(context, BHR_FORMAT_RGBA8_SRGB, 64, 36);
    }
    if (moment != BEFORE) {
        limit(more);
    }
    if (context != NULL) {
        use(context);
        BhrContext *second = make();
        if (second != NULL) {
            frame(second, BHR_FORMAT_RGBA8_SRGB, 64, 36);
        }
        bhr_context_destroy(second);
    }
    bhr_context_destroy(context);
    _exit(outcome);
}

/* ---- the parent ---- */

/* The child's exit status, -1 when it died. SIGALRM ends a child that runs out of time. */
static int run(Moment moment, void (*limit)(size_t), size_t more, const char *what) {
    int         status = 0;
    const pid_t pid = fork();
    if (pid == 0) {
        alarm(300);
        has_milky_way = check_runs_all() || moment == NEW;
        child(moment, limit, more);
    }
    if (!CHECK(pid > 0 && waitpid(pid, &status, 0) == pid, "no child")) {
        return -1;
    }
    const int lives = CHECK(WIFEXITED(status), "%s, %s + %u KiB: killed by signal %d", MOMENT_NAMES[moment], what,
                            (unsigned)(more / KIB), WTERMSIG(status));
    const int said = lives ? WEXITSTATUS(status) : -1;
    CHECK(!lives || !(said & REFUSED_OTHERWISE), "%s, %s + %u KiB: a call failed for another reason",
          MOMENT_NAMES[moment], what, (unsigned)(more / KIB));
    return said;
}

static void memory(Moment moment, int all) {
    static const size_t some[] = {0, MIB, 4 * MIB, 16 * MIB};
    unsigned            without = 0;
    for (size_t i = 0; !all && i < COUNT_OF(some); i++) {
        const int said = run(moment, limit_memory, some[i], "memory");
        without += said > 0 && (said & WITHOUT_MEMORY);
    }
    /* Each limit is a quarter above the one before, from 16 KiB on. */
    for (size_t more = 0; all && more <= 64 * MIB; more = more == 0 ? 16 * KIB : more + more / 4) {
        const int said = run(moment, limit_memory, more, "memory");
        without += said > 0 && (said & WITHOUT_MEMORY);
    }
    CHECK(without > 0, "%s: no limit was ever met", MOMENT_NAMES[moment]);
}

int main(int argc, char **argv) {
    const int all = argc > 2 && strcmp(argv[2], "all") == 0;
    if (check_begin(argc, argv) != BHR_BACKEND_CPU) {
        fprintf(stderr, "%s: drivers end the process when memory runs out; cpu only\n", argv[0]);
        return 2;
    }
    if (check_runs_all()) {
        wide = WIDE, high = HIGH, ray_count = RAYS;
    }
    if (argc > 3) {
        child((Moment)atoi(argv[2]), limit_memory, strtoul(argv[3], NULL, 10) * KIB);
    }
    CHECK(run(BEFORE, limit_memory, (size_t)8 << 30, "memory") == 0, "with much memory something fails");
    for (Moment moment = BEFORE; moment < MOMENTS; moment++) {
        memory(moment, all);
        CHECK(run(moment, limit_threads, 0, "threads") == WITHOUT_MEMORY, "%s: threads were not limited",
              MOMENT_NAMES[moment]);
    }
    return check_end();
}
