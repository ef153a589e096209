/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* no_driver.c -- a machine without a usable Vulkan driver: AUTO still gives a context that renders, VULKAN says
 * NO_ADAPTER, and the log says why. The runner makes such a machine: "no-vulkan" hides the drivers' manifests
 * (another interface, GL, may be there), "cpu-only" makes libvulkan and libEGL impossible to load, so that the CPU
 * tracer is all there is. */
#include "check.h"

#include <stdio.h>
#include <string.h>

static char said[4096];

static void remember(void *user, BhrLogLevel level, const char *message) {
    const size_t used = strlen(said);
    (void)user;
    (void)level;
    snprintf(said + used, sizeof said - used, "%s\n", message);
}

static void adapters(int cpu_only) {
    uint32_t count = 0;
    CHECK_OK(bhr_adapter_count(&count));
    CHECK(count >= 1 && (!cpu_only || count == 1), "%u adapters", (unsigned)count);
    for (uint32_t i = 0; i < count; i++) {
        BhrAdapterInfo info = {.struct_size = sizeof info};
        CHECK_OK(bhr_adapter_info(i, &info));
        CHECK(info.backend != BHR_BACKEND_VULKAN, "adapter %u, %s, is a Vulkan one", (unsigned)i, info.name);
    }
}

static void automatic(int cpu_only) {
    static unsigned char pixels[48 * 32 * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, 48, 32, pixels, sizeof pixels);
    BhrContextOptions    options = check_options(BHR_BACKEND_AUTO);
    BhrAdapterInfo       info = {.struct_size = sizeof info};
    options.log_level = BHR_LOG_INFO;
    options.log_fn = remember;
    BhrContext *context = check_context_with(&options);
    CHECK_OK(bhr_context_adapter(context, &info));
    CHECK(info.backend != BHR_BACKEND_VULKAN && (!cpu_only || info.backend == BHR_BACKEND_CPU), "backend %d, %s",
          (int)info.backend, info.name);
    CHECK(info.backend != BHR_BACKEND_GL || !(info.flags & BHR_ADAPTER_SOFTWARE), "AUTO took %s", info.name);
    CHECK(info.backend != BHR_BACKEND_CPU || said[0] != '\0', "the log does not say why the CPU traces");
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(pixels[3] == 255, "no frame was written");
    bhr_context_destroy(context);
}

static void vulkan(int cpu_only) {
    BhrContextOptions options;
    BhrContext       *context = (BhrContext *)&options;
    CHECK_OK(bhr_context_options_init(&options, sizeof options));
    options.backend = BHR_BACKEND_VULKAN;
    const char *words = cpu_only ? "Debian and Ubuntu: libvulkan1" : "mesa-vulkan-drivers|is no Vulkan loader";
    CHECK_FAILS(BHR_ERROR_NO_ADAPTER, words, bhr_context_create(BHR_ABI_VERSION, &options, &context));
    CHECK(context == NULL, "a context without an adapter");
}

int main(int argc, char **argv) {
    (void)check_begin(argc, argv);
    const int cpu_only = argc > 2 && strcmp(argv[2], "cpu-only") == 0;
    if (!cpu_only && (argc < 3 || strcmp(argv[2], "no-vulkan") != 0)) {
        fprintf(stderr, "usage: %s auto cpu-only|no-vulkan\n", argv[0]);
        return 2;
    }
    adapters(cpu_only);
    automatic(cpu_only);
    vulkan(cpu_only);
    return check_end();
}
