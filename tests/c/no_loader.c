/* no_loader.c -- a library to preload: in the process that has it, libvulkan and libEGL cannot be loaded, as on a machine where they
 * are not installed. Touches nothing else. */
#define _GNU_SOURCE /* RTLD_NEXT */

#include <dlfcn.h>
#include <stddef.h>
#include <string.h>

void *dlopen(const char *name, int flags) {
    void *(*next)(const char *, int);
    void *symbol = dlsym(RTLD_NEXT, "dlopen");
    if (symbol == NULL || (name != NULL && (strstr(name, "libvulkan") != NULL || strstr(name, "libEGL") != NULL))) {
        /* A name that nothing has, so that dlerror has its usual say. */
        name = "libabsent-on-purpose.so.0";
    }
    if (symbol == NULL) {
        return NULL;
    }
    memcpy(&next, &symbol, sizeof next);
    return next(name, flags);
}
