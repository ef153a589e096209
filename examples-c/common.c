/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* common.c -- see common.h. Asks more of the system than C99, which else only video.c and film_folder.c do: a
 * monotonic clock, whether a stream is a terminal, a new folder, the program's own, the number of cores. */
#if defined(__linux__)
#define _GNU_SOURCE /* sched_getaffinity, and what POSIX has */
#elif !defined(_WIN32)
#define _POSIX_C_SOURCE 199506L /* clock_gettime, isatty, fileno */
#ifdef __APPLE__
#define _DARWIN_C_SOURCE /* _NSGetExecutablePath */
#endif
#endif

#include "common.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef _WIN32
#include <direct.h>
#include <io.h>
#include <windows.h>
#else
#include <sys/stat.h>
#include <unistd.h>
#endif
#ifdef __linux__
#include <sched.h>
#endif
#ifdef __APPLE__
#include <mach-o/dyld.h>
#endif

const char *choice_name(const Choice *choices, int32_t value) {
    for (; choices->name != NULL; choices++) {
        if (choices->value == value) {
            return choices->name;
        }
    }
    return "?";
}

/* ---- reports ---- */

int report_failure(const char *what, BhrStatus status) {
    fprintf(stderr, "cannot %s: %s (%s)\n", what, bhr_error_message(), bhr_status_name(status));
    return EXIT_FAILURE;
}

void log_to_stderr(void *user, BhrLogLevel level, const char *message) {
    static const char *const names[] = {"off", "error", "warn", "info", "debug", "trace"};
    (void)user;
    fprintf(stderr, "[%s] %s\n", level >= 0 && level < (BhrLogLevel)COUNT_OF(names) ? names[level] : "?", message);
}

void print_adapter(FILE *out, const BhrAdapterInfo *info) {
    fprintf(out, "%s [%s%s%s]", info->name, choice_name(BACKENDS, info->backend), info->driver[0] != '\0' ? ", " : "",
            info->driver);
    if (info->flags & BHR_ADAPTER_SOFTWARE) {
        fputs(", software", out);
    } else if (info->flags & BHR_ADAPTER_DISCRETE) {
        fputs(", discrete", out);
    }
}

void print_driver_advice(FILE *out, const BhrAdapterInfo *info, const char *indent) {
    if (!(info->flags & BHR_ADAPTER_SOFTWARE)) {
        return;
    }
    const char *tracer = info->backend == BHR_BACKEND_CPU ? "the CPU" : "a software driver";
    fprintf(out, "%sNo GPU driver was usable, so %s traces the light; --verbose says why.\n", indent, tracer);
    fprintf(out, "%sA GPU is many times as fast. Its driver: Debian's and Ubuntu's mesa-vulkan-drivers for AMD\n",
            indent);
    fprintf(out, "%sand Intel, NVIDIA's own for NVIDIA.\n", indent);
}

BhrStatus create_context_on(BhrBackend backend, BhrContext **out) {
    BhrContextOptions options;
    BhrStatus         status = bhr_context_options_init(&options, sizeof options);
    if (status < 0) {
        return status;
    }
    options.backend = backend;
    return bhr_context_create(BHR_ABI_VERSION, &options, out);
}

BhrStatus create_context_beside(const BhrAdapterInfo *adapter, BhrContext **out) {
    BhrContextOptions options;
    uint32_t          count = 0;
    BHR_INIT(options);
    options.backend = adapter->backend;
    if (bhr_adapter_count(&count) < 0) {
        count = 0; /* the first one of this kind will do */
    }
    for (uint32_t i = 0; i < count; i++) {
        BhrAdapterInfo listed;
        BHR_INIT(listed);
        if (bhr_adapter_info(i, &listed) >= 0 && listed.backend == adapter->backend &&
            strcmp(listed.name, adapter->name) == 0) {
            options.adapter_index = (int32_t)i;
            break;
        }
    }
    return bhr_context_create(BHR_ABI_VERSION, &options, out);
}

/* ---- a bar ---- */

#define PROGRESS_AFTER_SECONDS 0.5 /* what is done sooner needs no bar */
#define PROGRESS_EVERY_SECONDS 0.1
#define PROGRESS_CELLS 40
#define PROGRESS_CELLS_OF_FRAMES 20 /* with the words behind it the line fits into 80 columns */

Progress progress_begin(int shown) {
    const Progress progress = {shown, -1, wall_seconds(), 0.0, 0};
    return progress;
}

/* Over what was drawn before, which may have been longer. */
static void draw_line(Progress *progress, int cells, double fraction, const char *words) {
    char bar[PROGRESS_CELLS + 1];
    for (int i = 0; i < cells; i++) {
        bar[i] = i < (int)(fraction * cells) ? '#' : '.';
    }
    bar[cells] = '\0';
    const int width = cells + 3 + (int)strlen(words);
    fprintf(stderr, "\r[%s] %s%*s", bar, words, progress->width > width ? progress->width - width : 0, "");
    fflush(stderr);
    progress->width = width;
}

void progress_draw(Progress *progress, double fraction) {
    const int percent = (int)(100.0 * fraction);
    if (!progress->shown || percent == progress->percent ||
        wall_seconds() - progress->begin < PROGRESS_AFTER_SECONDS) {
        return;
    }
    progress->percent = percent;
    char words[16];
    snprintf(words, sizeof words, "%3d %%", percent);
    draw_line(progress, PROGRESS_CELLS, fraction, words);
}

void progress_draw_frames(Progress *progress, double made, uint32_t before, uint32_t all) {
    const double now = wall_seconds(), elapsed = now - progress->begin, done = before + made;
    if (!progress->shown || elapsed < PROGRESS_AFTER_SECONDS || now - progress->drawn < PROGRESS_EVERY_SECONDS) {
        return;
    }
    progress->drawn = now;
    char words[96];
    int  length = snprintf(words, sizeof words, "%u of %u frames", (unsigned)done, (unsigned)all);
    if (made > 0.0) {
        const double   rate = made / elapsed;
        const double   left = (all - done) / rate;
        const uint32_t seconds = left < 3.6e6 ? (uint32_t)(left + 0.5) : 3600000u; /* 1000 hours */
        length += snprintf(words + length, sizeof words - (size_t)length, ", %.3g a second, ", rate);
        if (seconds >= 3600) {
            length += snprintf(words + length, sizeof words - (size_t)length, "%u:%02u:%02u left",
                               (unsigned)(seconds / 3600), (unsigned)(seconds / 60 % 60), (unsigned)(seconds % 60));
        } else {
            length += snprintf(words + length, sizeof words - (size_t)length, "%u:%02u left",
                               (unsigned)(seconds / 60), (unsigned)(seconds % 60));
        }
    }
    draw_line(progress, PROGRESS_CELLS_OF_FRAMES, done / all, words);
}

void progress_clear(Progress *progress) {
    if (progress->width > 0) {
        fprintf(stderr, "\r%*s\r", progress->width, "");
        fflush(stderr);
        progress->percent = -1;
        progress->width = 0;
    }
}

/* ---- the process ---- */

int end_output(int result) {
    if (fflush(stdout) != 0 && result == EXIT_SUCCESS) {
        fprintf(stderr, "cannot write to standard output\n");
        return EXIT_FAILURE;
    }
    return result;
}

#define TWICE_MILLISECONDS 300 /* programs around this one may send a signal on that the terminal sent already */

static volatile sig_atomic_t noted, noted_at;

static void note(int number) {
    const sig_atomic_t now = (sig_atomic_t)((uint64_t)(1000.0 * wall_seconds()) % 1000000000u);
    signal(number, note); /* some systems forget it */
    if (noted == 0) {
        noted_at = now;
        noted = number;
    } else if (number == SIGINT && (now < noted_at || now - noted_at > TWICE_MILLISECONDS)) {
        signal(SIGINT, SIG_DFL);
        raise(SIGINT);
    }
}

void note_signals(void) {
    const int numbers[] = {SIGINT, SIGTERM};
    for (size_t i = 0; i < COUNT_OF(numbers); i++) {
        if (signal(numbers[i], note) == SIG_IGN) {
            signal(numbers[i], SIG_IGN);
        }
    }
}

int noted_signal(void) {
    return noted;
}

void say_at_once(void) {
#ifdef _WIN32
    setvbuf(stdout, NULL, _IONBF, 0); /* Windows has no buffering by lines */
#else
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
#endif
}

uint32_t cores(void) {
#ifdef _WIN32
    SYSTEM_INFO info;
    GetSystemInfo(&info);
    return info.dwNumberOfProcessors > 0 ? (uint32_t)info.dwNumberOfProcessors : 1;
#elif defined(__linux__)
    cpu_set_t allowed; /* to this process, which taskset and containers may give fewer than the machine has */
    return sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? (uint32_t)CPU_COUNT(&allowed) : 1;
#elif defined(_SC_NPROCESSORS_ONLN)
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? (uint32_t)count : 1;
#else
    return 4;
#endif
}

double wall_seconds(void) {
#ifdef _WIN32
    LARGE_INTEGER now, a_second; /* GetTickCount64 is coarser than a frame; these calls cannot fail */
    QueryPerformanceCounter(&now);
    QueryPerformanceFrequency(&a_second);
    return (double)now.QuadPart / (double)a_second.QuadPart;
#else
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
#endif
}

int is_terminal(FILE *stream) {
#ifdef _WIN32
    return _isatty(_fileno(stream));
#else
    return isatty(fileno(stream));
#endif
}

void program_folder(char *out, size_t size) {
#ifdef _WIN32
    DWORD length = GetModuleFileNameA(NULL, out, (DWORD)size);
    int   found = length > 0 && length < size;
#elif defined(__linux__)
    ssize_t length = readlink("/proc/self/exe", out, size);
    int     found = length > 0 && (size_t)length < size;
    out[found ? length : 0] = '\0';
#elif defined(__APPLE__)
    uint32_t length = (uint32_t)size;
    int      found = _NSGetExecutablePath(out, &length) == 0;
#else
    int found = 0;
#endif
    char *end = NULL;
    for (char *at = out; found && *at != '\0'; at++) {
        end = *at == '/' || *at == '\\' ? at : end;
    }
    if (end != NULL) {
        *end = '\0';
    } else {
        snprintf(out, size, ".");
    }
}

char *read_text(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return NULL;
    }
    char  *text = NULL;
    size_t size = 0, room = 0;
    int    held = 1;
    do {
        room = 2 * room + 4096;
        char *more = realloc(text, room);
        held = more != NULL;
        text = held ? more : text;
        size += held ? fread(text + size, 1, room - 1 - size, file) : 0;
    } while (held && !feof(file) && !ferror(file));
    const int whole = held && !ferror(file), error = errno;
    fclose(file);
    if (!whole) {
        free(text);
        errno = error;
        return NULL;
    }
    text[size] = '\0';
    return text;
}

int make_folder(const char *path) {
#ifdef _WIN32
    return _mkdir(path) == 0;
#else
    return mkdir(path, 0777) == 0;
#endif
}
