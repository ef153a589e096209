/* common.c -- see common.h. Asks more of the system than C99, which else only video.c does: a monotonic clock,
 * whether a stream is a terminal, a new folder, the number of cores. */
#if defined(__linux__)
#define _GNU_SOURCE /* sched_getaffinity, and what POSIX has */
#elif !defined(_WIN32)
#define _POSIX_C_SOURCE 199506L /* clock_gettime, isatty, fileno */
#endif

#include "common.h"

#include <ctype.h>
#include <errno.h>
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

const Choice BACKENDS[] = {{"auto", BHR_BACKEND_AUTO},   {"cpu", BHR_BACKEND_CPU},     {"vulkan", BHR_BACKEND_VULKAN},
                           {"metal", BHR_BACKEND_METAL}, {"d3d12", BHR_BACKEND_D3D12}, {"gl", BHR_BACKEND_GL},
                           {NULL, 0}};
const Choice METHODS[] = {
    {"auto", BHR_METHOD_AUTO}, {"rk4", BHR_METHOD_RK4}, {"adaptive", BHR_METHOD_ADAPTIVE}, {NULL, 0}};
const Choice MOTIONS[] = {{"static", BHR_MOTION_STATIC},
                          {"freefall", BHR_MOTION_FREE_FALL},
                          {"orbit", BHR_MOTION_ORBIT},
                          {"velocity", BHR_MOTION_VELOCITY},
                          {NULL, 0}};
const Choice TONE_MAPS[] = {
    {"none", BHR_TONE_MAP_NONE}, {"aces", BHR_TONE_MAP_ACES}, {"agx", BHR_TONE_MAP_AGX}, {NULL, 0}};

const char *choice_name(const Choice *choices, int32_t value) {
    for (; choices->name != NULL; choices++) {
        if (choices->value == value) {
            return choices->name;
        }
    }
    return "?";
}

/* ---- command line ---- */

/* Puts the number that `text` begins with into *out and returns where it ends; NULL when there is none or it overflows.
 * strtod alone would skip leading blanks. */
static const char *read_double(const char *text, double *out) {
    char *end;
    if (isspace((unsigned char)text[0])) {
        return NULL;
    }
    errno = 0;
    double value = strtod(text, &end);
    /* Underflow sets ERANGE too, but gives a usable number. */
    if (end == text || (errno == ERANGE && (value > 1.0 || value < -1.0))) {
        return NULL;
    }
    *out = value;
    return end;
}

/* As read_double, digits only: strtoul alone would take "-1" for a large number. */
static const char *read_uint(const char *text, uint32_t *out) {
    char *end;
    if (!isdigit((unsigned char)text[0])) {
        return NULL;
    }
    errno = 0;
    unsigned long value = strtoul(text, &end, 10);
    if (errno == ERANGE || value > UINT32_MAX) {
        return NULL;
    }
    *out = (uint32_t)value;
    return end;
}

static int read_vector(const char *text, double out[3]) {
    double value[3];
    for (int i = 0; i < 3; i++) {
        text = read_double(text, &value[i]);
        if (text == NULL || *text != (i < 2 ? ',' : '\0')) {
            return 0;
        }
        text++;
    }
    memcpy(out, value, sizeof value);
    return 1;
}

static int read_size(const char *text, uint32_t out[2]) {
    uint32_t value[2];
    text = read_uint(text, &value[0]);
    if (text == NULL || *text != 'x') {
        return 0;
    }
    text = read_uint(text + 1, &value[1]);
    if (text == NULL || *text != '\0') {
        return 0;
    }
    memcpy(out, value, sizeof value);
    return 1;
}

static int read_choice(const char *text, const Choice *choices, int32_t *out) {
    for (; choices->name != NULL; choices++) {
        if (strcmp(text, choices->name) == 0) {
            *out = choices->value;
            return 1;
        }
    }
    return 0;
}

/* 1 when all of `text` is a value of the option's kind; only then is the target written. */
static int read_value(const Option *option, const char *text) {
    const char *end;
    double      number;
    uint32_t    whole;
    switch (option->kind) {
    case OPTION_DOUBLE:
        end = read_double(text, &number);
        if (end == NULL || *end != '\0') {
            return 0;
        }
        *(double *)option->target = number;
        return 1;
    case OPTION_UINT:
        end = read_uint(text, &whole);
        if (end == NULL || *end != '\0') {
            return 0;
        }
        *(uint32_t *)option->target = whole;
        return 1;
    case OPTION_VECTOR:
        return read_vector(text, option->target);
    case OPTION_SIZE:
        return read_size(text, option->target);
    case OPTION_CHOICE:
        return read_choice(text, option->choices, option->target);
    case OPTION_TEXT:
        *(const char **)option->target = text;
        return text[0] != '\0';
    case OPTION_FLAG:
        break;
    }
    return 0;
}

static void print_value_name(FILE *out, const Option *option) {
    if (option->kind == OPTION_FLAG) {
        return;
    }
    if (option->kind != OPTION_CHOICE) {
        fprintf(out, " %s", option->value);
        return;
    }
    for (const Choice *choice = option->choices; choice->name != NULL; choice++) {
        fprintf(out, "%c%s", choice == option->choices ? ' ' : '|', choice->name);
    }
}

static const Option *find_option(const Option *options, size_t count, const char *argument, size_t length) {
    for (size_t i = 0; i < count; i++) {
        if (strlen(options[i].name) == length && strncmp(options[i].name, argument, length) == 0) {
            return &options[i];
        }
    }
    return NULL;
}

int options_parse(const Option *options, size_t count, int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        const char   *value = strchr(argv[i], '=');
        size_t        length = value != NULL ? (size_t)(value - argv[i]) : strlen(argv[i]);
        const Option *option = find_option(options, count, argv[i], length);
        if (option == NULL) {
            fprintf(stderr, "%s: unknown option '%s'; --help lists them\n", argv[0], argv[i]);
            return EXIT_USAGE;
        }
        if (option->kind == OPTION_FLAG) {
            if (value != NULL) {
                fprintf(stderr, "%s: %s takes no value\n", argv[0], option->name);
                return EXIT_USAGE;
            }
            *(int *)option->target = 1;
            continue;
        }
        if (value != NULL) {
            value++;
        } else if (i + 1 < argc) {
            value = argv[++i];
        } else {
            fprintf(stderr, "%s: %s needs a value:", argv[0], option->name);
            print_value_name(stderr, option);
            fputc('\n', stderr);
            return EXIT_USAGE;
        }
        if (!read_value(option, value)) {
            fprintf(stderr, "%s: '%s' is no value for %s, which takes", argv[0], value, option->name);
            print_value_name(stderr, option);
            fputc('\n', stderr);
            return EXIT_USAGE;
        }
    }
    return 0;
}

void options_print(FILE *out, const Option *options, size_t count) {
    for (size_t i = 0; i < count; i++) {
        fprintf(out, "  %s", options[i].name);
        print_value_name(out, &options[i]);
        fprintf(out, "\n        %s\n", options[i].help);
    }
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

/* ---- the process ---- */

int end_output(int result) {
    if (fflush(stdout) != 0 && result == EXIT_SUCCESS) {
        fprintf(stderr, "cannot write to standard output\n");
        return EXIT_FAILURE;
    }
    return result;
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
    return (double)GetTickCount64() * 1e-3;
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

int make_folder(const char *path) {
#ifdef _WIN32
    return _mkdir(path) == 0;
#else
    return mkdir(path, 0777) == 0;
#endif
}
