/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* loading.c -- a plugin's host: bhr.dll is loaded, used and freed, again and again. Links no bhr.
 *
 *     loading BACKEND TIMES BHR.DLL [COPY.DLL]       with a copy, every other time that
 *
 * Between LoadLibrary and FreeLibrary a thread makes a context, renders a frame and destroys the context. The DLL must
 * stay mapped, as threads of its own and of drivers still run in it. A DLL of which no more than the version was asked
 * goes: there is nothing in it yet.
 */
#include <bhr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

static HMODULE    library;
static BhrBackend backend;

/* A function's address, which C keeps apart from that of an object. */
static void find(void *function, const char *name) {
    FARPROC found = GetProcAddress(library, name);
    if (!found) {
        printf("%s is not in the library\n", name);
        exit(2);
    }
    memcpy(function, &found, sizeof found);
}

static DWORD WINAPI uses_it(void *unused) {
    BhrStatus (*init)(BhrContextOptions *, size_t);
    BhrStatus (*create)(uint32_t, const BhrContextOptions *, BhrContext **);
    BhrStatus (*init_image)(BhrImage *, size_t);
    BhrStatus (*render)(BhrContext *, BhrImage *);
    void (*destroy)(BhrContext *);
    const char *(*message)(void);
    static unsigned char pixels[32 * 18 * 4];
    BhrContextOptions    options;
    BhrContext          *context = NULL;
    BhrImage             image;
    (void)unused;
    find(&init, "bhr_context_options_init");
    find(&create, "bhr_context_create");
    find(&init_image, "bhr_image_init");
    find(&render, "bhr_render_image");
    find(&destroy, "bhr_context_destroy");
    find(&message, "bhr_error_message");
    int failed = init(&options, sizeof options) < 0 || init_image(&image, sizeof image) < 0;
    options.backend = backend;
    image.width = 32, image.height = 18, image.pixels = pixels, image.byte_size = sizeof pixels;
    failed = failed || create(BHR_ABI_VERSION, &options, &context) < 0 || render(context, &image) < 0;
    if (failed) printf("%s\n", message());
    destroy(context);
    return (DWORD)failed;
}

static int is_mapped(const void *address) {
    MEMORY_BASIC_INFORMATION about;
    return VirtualQuery(address, &about, sizeof about) == sizeof about && about.State == MEM_COMMIT;
}

static void load(const char *path) {
    library = LoadLibraryA(path);
    if (!library) {
        printf("LoadLibrary: error %lu\n", GetLastError());
        exit(2);
    }
}

int main(int argc, char **argv) {
    if (argc < 4) return 2;
    backend = !strcmp(argv[1], "cpu") ? BHR_BACKEND_CPU : !strcmp(argv[1], "vulkan") ? BHR_BACKEND_VULKAN
                                                                                       : BHR_BACKEND_GL;
    int failed = 0;

    uint32_t (*abi)(void);
    load(argv[3]);
    find(&abi, "bhr_abi_version");
    const void *address = (const void *)library;
    failed |= abi() != BHR_ABI_VERSION || !FreeLibrary(library);
    if (is_mapped(address)) failed = 1, printf("unused, it stays\n");

    int times = atoi(argv[2]);
    for (int i = 0; i < times; i++) {
        load(argv[argc > 4 && i % 2 == 1 ? 4 : 3]);
        address = (const void *)library;
        DWORD  status = 1;
        HANDLE thread = CreateThread(NULL, 0, uses_it, NULL, 0, NULL);
        if (thread && WaitForSingleObject(thread, 120000) == WAIT_OBJECT_0) GetExitCodeThread(thread, &status);
        if (thread) CloseHandle(thread);
        if (status != 0) failed = 1, printf("round %d: the context or its frame failed\n", i);
        if (!FreeLibrary(library)) failed = 1, printf("round %d: FreeLibrary fails\n", i);
        /* Threads that end later would crash here. */
        Sleep(i % 4 == 3 ? 200 : 5);
        if (!is_mapped(address)) failed = 1, printf("round %d: FreeLibrary has unmapped the library\n", i);
        fflush(stdout);
    }
    printf("%s %d of %d rounds\n", argv[1], failed ? 0 : times, times);
    return failed;
}
