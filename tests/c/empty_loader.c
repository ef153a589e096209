/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* empty_loader.c -- a libvulkan that knows no function, as stubs of development kits do. */
#include <stddef.h>

void *vkGetInstanceProcAddr(void *instance, const char *name);

void *vkGetInstanceProcAddr(void *instance, const char *name) {
    (void)instance;
    (void)name;
    return NULL;
}
