/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* thread_state.c -- hosts whose threads are not as the C library makes them: they trap floating-point exceptions,
 * round upward, take subnormal numbers as 0; they are cancelled inside a call; they have a stack of 64 KiB, or are
 * fibers. Whatever it is, frames are those of a plain host, callbacks see the host's own settings, and after each call
 * these are as they were, the flags of exceptions too. Settings of floating point are set as fenv.h has it, and in the
 * machine's own register: MXCSR on x86-64, FPCR on AArch64. */
#define _GNU_SOURCE

#include "check.h"

#include <errno.h>
#include <fenv.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <ucontext.h>
#include <unistd.h>

#if defined __x86_64__
#include <xmmintrin.h>
#endif

/* The machine's own register of settings, and what makes it take subnormal numbers as 0 (on AArch64 FPCR.FZ, for NEON's
 * registers too). */
#if defined __x86_64__
#define FLUSH 0x8040u
static unsigned control(void) { return _mm_getcsr(); }
static void     set_control(unsigned word) { _mm_setcsr(word); }
#elif defined __aarch64__
#define FLUSH (1u << 24)
static unsigned control(void) {
    unsigned long word;
    __asm__ volatile("mrs %0, fpcr" : "=r"(word));
    return (unsigned)word;
}
static void set_control(unsigned word) { __asm__ volatile("msr fpcr, %0" : : "r"((unsigned long)word)); }
#else
#define FLUSH 0u
static unsigned control(void) { return 0; }
static void     set_control(unsigned word) { (void)word; }
#endif

#define WIDTH 48u
#define HEIGHT 32u
#define BYTES (WIDTH * HEIGHT * 4u)
#define RAYS 8u
#define STACK (64u << 10)

static BhrBackend backend;
static char       folder[64] = "/tmp/bhr-thread-state-XXXXXX";

/* ---- the state of floating point ---- */

typedef struct Words {
    int      rounding, traps, flags;
    unsigned control;
} Words;

static Words words(void) {
    Words now;
    memset(&now, 0, sizeof now);
    now.rounding = fegetround();
    now.flags = fetestexcept(FE_ALL_EXCEPT);
#if defined __GLIBC__
    now.traps = fegetexcept();
#endif
    now.control = control();
    return now;
}

static void plain(void) { fesetenv(FE_DFL_ENV); }

static void trapping(void) {
    plain();
#if defined __GLIBC__
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
#endif
}

static void upward(void) {
    plain();
    fesetround(FE_UPWARD);
}

/* A flag is set; subnormal numbers are 0 on the way in and out. */
static void flushing(void) {
    plain();
    feraiseexcept(FE_INEXACT);
    set_control(control() | FLUSH);
}

static void all_at_once(void) {
    flushing();
    feclearexcept(FE_ALL_EXCEPT);
    fesetround(FE_DOWNWARD);
#if defined __GLIBC__
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW);
#endif
}

/* The library's calls are made through this: the state before is the state after. */
static Words expected_words;
static void  unchanged(int line, const char *call) {
    const Words now = words();
    plain(); /* for printf */
    check_that(memcmp(&now, &expected_words, sizeof now) == 0, __FILE__, line, call,
               "rounding %d, traps %x, flags %x, control %x; before: %d, %x, %x, %x", now.rounding, now.traps,
               now.flags, now.control, expected_words.rounding, expected_words.traps, expected_words.flags,
               expected_words.control);
}

/* ---- one use of the whole library ---- */

typedef struct Result {
    unsigned char frame[BYTES], job_frame[BYTES], read[BYTES];
    float         depth[WIDTH * HEIGHT];
    BhrHit        hits[RAYS];
    BhrHoleInfo   hole;
    BhrCamera     camera;
} Result;

static void (*setting)(void);
static int progress_calls, log_calls, wrong_words;

static void see_words(void) {
    const Words now = words();
    wrong_words += memcmp(&now, &expected_words, sizeof now) != 0;
}

static int32_t on_progress(void *user, double fraction) {
    (void)user, (void)fraction;
    progress_calls++;
    see_words();
    (void)bhr_status_name(BHR_OK);
    BhrFilm film;
    (void)bhr_film_init(&film, sizeof film); /* a call from within a callback */
    see_words();
    return 1;
}

static pthread_t caller;

static void on_log(void *user, BhrLogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
    if (pthread_equal(pthread_self(), caller)) {
        log_calls++;
        see_words();
    }
}

#define STEP(call)                                                                         \
    do {                                                                                   \
        setting();                                                                         \
        const BhrStatus status_ = (call);                                                  \
        unchanged(__LINE__, #call);                                                        \
        check_that(status_ == BHR_OK, __FILE__, __LINE__, #call, "%s: %s", bhr_status_name(status_), \
                   bhr_error_message());                                                   \
    } while (0)

static void use(Result *result) {
    char              path[96];
    BhrContextOptions options = check_options(backend);
    BhrContext       *context = NULL;
    BhrJob           *job = NULL;
    BhrRay            rays[RAYS];
    BhrDisk           disk;
    BhrFilm           film;
    BhrOutput         output;
    uint32_t          count = 0;
    BhrImage          image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, result->frame, BYTES);
    caller = pthread_self();
    setting();
    expected_words = words();
    plain();
    options.log_fn = on_log;
    options.log_level = BHR_LOG_INFO;
    snprintf(path, sizeof path, "%s/frame.png", folder);
    for (uint32_t i = 0; i < RAYS; i++) {
        const BhrRay ray = {{30.0, 0.0, 4.0}, {-1.0, 0.05 * (double)i, -0.1}, 1.0};
        rays[i] = ray;
    }
    STEP(bhr_adapter_count(&count));
    STEP(bhr_context_create(BHR_ABI_VERSION, &options, &context));
    if (context == NULL) {
        return;
    }
    STEP(bhr_set_progress(context, on_progress, NULL));
    STEP(bhr_set_spin(context, 0.6));
    STEP(bhr_camera_init(&result->camera, sizeof result->camera));
    STEP(bhr_camera_orbit(&result->camera, 25.0, 0.4, 0.2));
    STEP(bhr_set_camera(context, &result->camera));
    STEP(bhr_disk_init(&disk, sizeof disk));
    STEP(bhr_set_disk(context, &disk));
    STEP(bhr_film_init(&film, sizeof film));
    STEP(bhr_set_film(context, &film));
    STEP(bhr_render_image(context, &image));
    STEP(bhr_trace_rays(context, rays, sizeof rays[0], RAYS, result->hits, sizeof result->hits[0]));
    result->hole.struct_size = sizeof result->hole;
    STEP(bhr_hole_info(context, &result->hole));
    image.pixels = result->job_frame;
    STEP(bhr_render_image_async(context, &image, &job));
    STEP(bhr_job_wait(job, UINT64_MAX, NULL));
    setting();
    bhr_job_cancel(job);
    unchanged(__LINE__, "bhr_job_cancel");
    setting();
    bhr_job_destroy(job);
    unchanged(__LINE__, "bhr_job_destroy");
    STEP(bhr_output_init(&output, sizeof output));
    output.kind = BHR_OUTPUT_DEPTH;
    const BhrImage depth = image_of(BHR_FORMAT_R32F, WIDTH, HEIGHT, result->depth, sizeof result->depth);
    output.image = &depth;
    STEP(bhr_render_outputs(context, &output, sizeof output, 1, NULL));
    STEP(bhr_image_save(&image, path));
    memset(&image, 0, sizeof image);
    image.struct_size = sizeof image;
    STEP(bhr_image_load(path, &image));
    if (image.pixels != NULL && CHECK(image.width == WIDTH, "a picture %u wide", (unsigned)image.width)) {
        memcpy(result->read, image.pixels, BYTES);
    }
    STEP(bhr_image_release(&image));
    setting();
    const BhrStatus refused = bhr_set_mass(context, -1.0);
    unchanged(__LINE__, "bhr_set_mass");
    CHECK(refused == BHR_ERROR_INVALID_ARGUMENT, "%s", bhr_status_name(refused));
    setting();
    bhr_context_destroy(context);
    unchanged(__LINE__, "bhr_context_destroy");
    plain();
}

static Result reference, result;

static void same_as_reference(const char *host) {
    CHECK(memcmp(result.frame, reference.frame, BYTES) == 0, "%s: another frame", host);
    CHECK(memcmp(result.job_frame, reference.frame, BYTES) == 0, "%s: another frame of a job", host);
    CHECK(memcmp(result.read, reference.frame, BYTES) == 0, "%s: another frame in the file", host);
    CHECK(memcmp(result.depth, reference.depth, sizeof result.depth) == 0, "%s: another output", host);
    CHECK(memcmp(result.hits, reference.hits, sizeof result.hits) == 0, "%s: other rays", host);
    CHECK(memcmp(&result.hole, &reference.hole, sizeof result.hole) == 0, "%s: another hole", host);
    CHECK(memcmp(&result.camera, &reference.camera, sizeof result.camera) == 0, "%s: another camera", host);
    memset(&result, 0, sizeof result);
}

static void hosts_with(const char *host, void (*set)(void)) {
    setting = set;
    progress_calls = log_calls = wrong_words = 0;
    use(&result);
    CHECK(progress_calls > 2 && log_calls > 0, "%d progress and %d log callbacks", progress_calls, log_calls);
    CHECK(wrong_words == 0, "%s: %d times a callback saw other control words", host, wrong_words);
    same_as_reference(host);
}

/* ---- stacks ---- */

static void *use_on_thread(void *argument) {
    (void)argument;
    use(&result);
    return NULL;
}

/* Memory for a stack with a page before it that ends whoever needs more. */
static void *stack_memory(size_t size) {
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    char        *memory = mmap(NULL, page + size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED || mprotect(memory, page, PROT_NONE) != 0) {
        CHECK(0, "no memory for a stack");
        exit(check_end());
    }
    return memory + page;
}

/* The C library gives no thread less than this; on AArch64 that is twice as much. Fibers have 64 KiB there, too. */
static size_t thread_stack(void) {
    const long least = sysconf(_SC_THREAD_STACK_MIN);
    return least > (long)STACK ? (size_t)least : STACK;
}

static void thread_with_little_stack(void) {
    const size_t   size = thread_stack();
    pthread_attr_t attributes;
    pthread_t      thread;
    setting = plain;
    pthread_attr_init(&attributes);
    CHECK(pthread_attr_setstack(&attributes, stack_memory(size), size) == 0, "no such stack");
    CHECK(pthread_create(&thread, &attributes, use_on_thread, NULL) == 0, "no such thread");
    pthread_join(thread, NULL);
    pthread_attr_destroy(&attributes);
    same_as_reference("a thread with a stack of 64 KiB");
}

static ucontext_t thread_context, fiber_context;
static void       fiber_body(void) { use(&result); }

/* On a thread whose stack is large; that of the fiber lies below it, or above. */
static void *thread_with_fiber(void *stack) {
    getcontext(&fiber_context);
    fiber_context.uc_stack.ss_sp = stack;
    fiber_context.uc_stack.ss_size = STACK;
    fiber_context.uc_link = &thread_context;
    makecontext(&fiber_context, fiber_body, 0);
    swapcontext(&thread_context, &fiber_context);
    return NULL;
}

static void fiber_with_little_stack(void) {
    pthread_t thread;
    setting = plain;
    void *above = stack_memory(STACK);
    thread_with_fiber(stack_memory(STACK));
    same_as_reference("a fiber of the main thread");
    /* The system puts a new stack below what is there. */
    CHECK(pthread_create(&thread, NULL, thread_with_fiber, above) == 0, "no such thread");
    pthread_join(thread, NULL);
    same_as_reference("a fiber of another thread");
}

/* ---- cancellation ---- */

static int     cancel_requested, reached_the_end;
static int32_t cancel_own_thread(void *user, double fraction) {
    (void)user, (void)fraction;
    if (!cancel_requested) {
        cancel_requested = 1;
        pthread_cancel(pthread_self());
    }
    usleep(1000); /* where a thread is cancelled */
    return 1;
}

static void *cancelled_thread(void *argument) {
    char           path[96];
    BhrContext    *context = argument;
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, result.frame, BYTES);
    snprintf(path, sizeof path, "%s/cancelled.png", folder);
    CHECK_OK(bhr_set_progress(context, cancel_own_thread, NULL));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK_OK(bhr_image_save(&image, path));
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
    reached_the_end = 1;
    pthread_testcancel();
    reached_the_end = 2;
    return NULL;
}

/* A request to cancel a thread inside a call waits for the call's end, and for the host's next cancellation point. */
static void cancelled_inside_a_call(void) {
    char        path[96];
    pthread_t   thread;
    void       *ended = NULL;
    BhrContext *context = check_context(backend);
    CHECK(pthread_create(&thread, NULL, cancelled_thread, context) == 0, "no thread");
    pthread_join(thread, &ended);
    CHECK(cancel_requested && reached_the_end == 1 && ended == PTHREAD_CANCELED, "requested %d, reached %d",
          cancel_requested, reached_the_end);
    /* The context is as good as before. */
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, result.job_frame, BYTES);
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(memcmp(result.frame, result.job_frame, BYTES) == 0, "a frame of a cancelled thread differs");
    snprintf(path, sizeof path, "%s/cancelled.png", folder);
    CHECK(unlink(path) == 0, "no file of a cancelled thread");
    bhr_context_destroy(context);
    memset(&result, 0, sizeof result);
}

int main(int argc, char **argv) {
    char path[96];
    backend = check_begin(argc, argv);
    if (mkdtemp(folder) == NULL) {
        CHECK(0, "no folder: %s", strerror(errno));
        return check_end();
    }
    setting = plain;
    use(&reference);
    CHECK(memcmp(reference.frame, reference.job_frame, BYTES) == 0, "a job makes another frame");
    hosts_with("a host that rounds upward", upward);
    if (check_runs_all()) { /* everyday the last one traps and flushes, too */
        hosts_with("a host that traps", trapping);
        hosts_with("a host that flushes subnormal numbers", flushing);
    }
    hosts_with("a host that does it all", all_at_once);
    thread_with_little_stack();
    fiber_with_little_stack();
    cancelled_inside_a_call();
    snprintf(path, sizeof path, "%s/frame.png", folder);
    CHECK(unlink(path) == 0 && rmdir(folder) == 0, "something was left in %s", folder);
    return check_end();
}
