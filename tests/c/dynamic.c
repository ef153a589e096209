/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* dynamic.c -- a plug-in's life: loads the library named by its second argument on a second thread, renders, unloads
 * it, and lets the thread end; twice. Not linked with the library, so it counts by itself. */
#define _POSIX_C_SOURCE 200809L

#include <bhr.h>
#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static BhrBackend  backend;
static const char *library;
static unsigned    passed, failed;

static int check(int ok, const char *what, const char *message) {
    if (ok) {
        passed++;
    } else {
        failed++;
        printf("dynamic.c: not so: %s: %s\n", what, message);
    }
    return ok;
}

/* dlsym gives an object pointer; ISO C lets a function pointer be made from it only through memory. */
static int find(void *handle, const char *name, void *function, size_t size) {
    void *symbol = dlsym(handle, name);
    if (check(symbol != NULL && size == sizeof symbol, name, "no such symbol")) {
        memcpy(function, &symbol, size);
        return 1;
    }
    return 0;
}
#define FIND(handle, function) find(handle, #function, &function, sizeof function)

static void use(void *handle) {
    BhrStatus (*bhr_context_options_init)(BhrContextOptions *, size_t);
    BhrStatus (*bhr_context_create)(uint32_t, const BhrContextOptions *, BhrContext **);
    void (*bhr_context_destroy)(BhrContext *);
    BhrStatus (*bhr_render_image)(BhrContext *, const BhrImage *);
    BhrStatus (*bhr_image_init)(BhrImage *, size_t);
    BhrStatus (*bhr_set_mass)(BhrContext *, double);
    const char *(*bhr_error_message)(void);
    if (!(FIND(handle, bhr_context_options_init) && FIND(handle, bhr_context_create) &&
          FIND(handle, bhr_context_destroy) && FIND(handle, bhr_render_image) && FIND(handle, bhr_image_init) &&
          FIND(handle, bhr_set_mass) && FIND(handle, bhr_error_message))) {
        return;
    }
    BhrContextOptions options;
    BhrContext       *context = NULL;
    check(bhr_context_options_init(&options, sizeof options) == BHR_OK, "options", bhr_error_message());
    options.backend = backend;
    if (!check(bhr_context_create(BHR_ABI_VERSION, &options, &context) == BHR_OK, "context", bhr_error_message())) {
        return;
    }
    static unsigned char pixels[48 * 32 * 4];
    BhrImage             image;
    check(bhr_image_init(&image, sizeof image) == BHR_OK, "image", bhr_error_message());
    image.format = BHR_FORMAT_RGBA8_SRGB;
    image.width = 48;
    image.height = 32;
    image.pixels = pixels;
    image.byte_size = sizeof pixels;
    check(bhr_render_image(context, &image) == BHR_OK, "render", bhr_error_message());
    check(pixels[3] == 255, "alpha", "the frame was not written");
    check(bhr_set_mass(context, -1.0) == BHR_ERROR_INVALID_ARGUMENT, "a failure with its message", "none");
    bhr_context_destroy(context);
}

static void *load_use_unload(void *argument) {
    (void)argument;
    void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (check(handle != NULL, library, "cannot be loaded")) {
        use(handle);
        check(dlclose(handle) == 0, library, "cannot be unloaded");
    }
    return NULL;
}

int main(int argc, char **argv) {
    if (argc < 3) {
        fprintf(stderr, "usage: %s cpu|vulkan LIBRARY\n", argv[0]);
        return 2;
    }
    backend = strcmp(argv[1], "cpu") == 0 ? BHR_BACKEND_CPU : BHR_BACKEND_VULKAN;
    library = argv[2];
    for (int round = 0; round < 2; round++) {
        pthread_t thread;
        if (!check(pthread_create(&thread, NULL, load_use_unload, NULL) == 0, "a second thread", "cannot start it")) {
            break;
        }
        pthread_join(thread, NULL);
    }
    printf("dynamic %s: %u checks passed, %u failed\n", argv[1], passed, failed);
    return failed == 0 && passed > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
