/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* dxc.c -- compiles HLSL with Microsoft's DXC, as wgpu does for Direct3D 12, but that warnings count.
 *
 *     dxc LIBRARY FOLDER SKIP STEP        the files NUMBER.PROFILE.ENTRY.hlsl of a folder, each STEPth after SKIP
 *
 * DXC's interfaces are COM's, whose tables of functions are declared here as far as they are called: its header is not
 * in MinGW. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <wchar.h>
#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

typedef int32_t Status; /* HRESULT */
typedef struct {
    uint32_t      a;
    uint16_t      b, c;
    unsigned char d[8];
} Id;
typedef struct Object Object;

/* In front of every table: QueryInterface, AddRef, Release. */
typedef struct {
    Status (*query)(Object *, const Id *, void **);
    uint32_t (*add)(Object *);
    uint32_t (*release)(Object *);
    union {
        struct { /* IDxcCompiler3 */
            Status (*compile)(Object *, const void *source, const wchar_t *const *arguments, uint32_t count,
                              Object *includes, const Id *, Object **result);
        } compiler;
        struct { /* IDxcVersionInfo */
            Status (*version)(Object *, uint32_t *major, uint32_t *minor);
        } info;
        struct { /* IDxcResult */
            Status (*status)(Object *, Status *);
            Status (*object)(Object *, Object **blob);
            Status (*messages)(Object *, Object **blob);
        } result;
        struct { /* IDxcBlob */
            const char *(*bytes)(Object *);
            size_t (*size)(Object *);
        } blob;
    } as;
} Table;
struct Object {
    const Table *table;
};

static const Id COMPILER = {0x73e22d93, 0xe6ce, 0x47f3, {0xb5, 0xbf, 0xf0, 0x66, 0x4f, 0x39, 0xc1, 0xb0}};
static const Id COMPILER_3 = {0x228b4687, 0x5a6a, 0x4730, {0x90, 0x0c, 0x97, 0x02, 0xb2, 0x20, 0x3f, 0x54}};
static const Id VERSION_INFO = {0xb04f5b50, 0x2059, 0x4f12, {0xa8, 0xff, 0xa1, 0xe0, 0xcd, 0xe1, 0xcc, 0x7e}};
static const Id RESULT = {0x58346cda, 0xdde7, 0x4497, {0x94, 0x61, 0x6f, 0x87, 0xaf, 0x5e, 0x06, 0x59}};

typedef Status (*CreateInstance)(const Id *, const Id *, void **);

static CreateInstance open_library(const char *path) {
    CreateInstance create = NULL;
#ifdef _WIN32
    HMODULE library = LoadLibraryA(path);
    FARPROC found = library != NULL ? GetProcAddress(library, "DxcCreateInstance") : NULL;
#else
    void *library = dlopen(path, RTLD_NOW);
    void *found = library != NULL ? dlsym(library, "DxcCreateInstance") : NULL;
    if (library == NULL) fprintf(stderr, "%s\n", dlerror());
#endif
    memcpy(&create, &found, sizeof create);
    return create;
}

static char *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    if (file != NULL && fseek(file, 0, SEEK_END) == 0) {
        const long end = ftell(file);
        text = end > 0 ? malloc((size_t)end) : NULL;
        *size = (size_t)end;
        if (text != NULL && (fseek(file, 0, SEEK_SET) != 0 || fread(text, 1, *size, file) != *size)) {
            free(text);
            text = NULL;
        }
    }
    if (file != NULL) fclose(file);
    return text;
}

static unsigned long long dxil_bytes;

/* Whether it compiles without a word; the words are printed. */
static int compile(Object *compiler, const char *folder, const char *name) {
    char    path[4096], profile[16] = "", entry[256] = "";
    wchar_t wide_profile[16], wide_entry[256];
    size_t  size = 0;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    char *text = read_file(path, &size);
    if (text == NULL || sscanf(name, "%*[0-9].%15[^.].%255[^.].hlsl", profile, entry) != 2) {
        free(text);
        printf("%s: not read\n", name);
        return 0;
    }
    mbstowcs(wide_profile, profile, 16);
    mbstowcs(wide_entry, entry, 256);
    /* Arguments of wgpu-hal (compile_dxc of its module dx12), but that of its -no-warnings only two are left, of naga's
     * ways to write: parentheses around every comparison, and four numbers for textures of one. */
    const wchar_t *arguments[] = {L"-E", wide_entry, L"-T", wide_profile, L"-HV", L"2018", L"-Ges",
                                  L"-Wno-parentheses-equality", L"-Wno-conversion"};
    const struct {
        const void *bytes;
        size_t      size;
        uint32_t    encoding;
    } source = {text, size, 65001};
    Object *result = NULL, *messages = NULL, *object = NULL;
    const uint32_t count = sizeof arguments / sizeof *arguments;
    Status status = compiler->table->as.compiler.compile(compiler, &source, arguments, count, NULL, &RESULT, &result);
    size_t  words = 0;
    if (status >= 0) result->table->as.result.status(result, &status);
    if (result != NULL && result->table->as.result.messages(result, &messages) >= 0 && messages != NULL) {
        const char *text_of = messages->table->as.blob.bytes(messages);
        words = text_of != NULL ? strlen(text_of) : 0;
        if (words > 0) printf("%s: %.3000s\n", name, text_of);
        messages->table->release(messages);
    }
    size_t made = 0;
    if (status >= 0 && result->table->as.result.object(result, &object) >= 0 && object != NULL) {
        made = object->table->as.blob.size(object);
        object->table->release(object);
    }
    if (made == 0) printf("%s: no code (0x%08x)\n", name, (unsigned)status);
    dxil_bytes += made;
    if (result != NULL) result->table->release(result);
    free(text);
    return made > 0 && words == 0;
}

int main(int argc, char **argv) {
    if (argc != 5) return 2;
    const CreateInstance create = open_library(argv[1]);
    Object              *compiler = NULL, *info = NULL;
    uint32_t             major = 0, minor = 0;
    if (create == NULL || create(&COMPILER, &COMPILER_3, (void **)&compiler) < 0) {
        fprintf(stderr, "no DXC in %s\n", argv[1]);
        return 2;
    }
    if (compiler->table->query(compiler, &VERSION_INFO, (void **)&info) >= 0) {
        info->table->as.info.version(info, &major, &minor);
        info->table->release(info);
    }
    DIR           *folder = opendir(argv[2]);
    struct dirent *file;
    const int      skip = atoi(argv[3]), step = atoi(argv[4]);
    int            compiled = 0, failed = 0, longest = 0, of_longest = 0;
    const time_t   begin = time(NULL);
    while (folder != NULL && step > 0 && (file = readdir(folder)) != NULL) {
        if (strstr(file->d_name, ".hlsl") == NULL || atoi(file->d_name) % step != skip) continue;
        const clock_t from = clock();
        const int     good = compile(compiler, argv[2], file->d_name);
        const int     took = (int)((clock() - from) * 1000 / CLOCKS_PER_SEC);
        compiled += good;
        failed += !good;
        if (took > longest) longest = took, of_longest = atoi(file->d_name);
        fflush(stdout);
    }
    if (folder != NULL) closedir(folder);
    compiler->table->release(compiler);
    printf("DXC %u.%u: %d shaders compiled, %d failed; %llu bytes of DXIL; %d s, the longest %d ms (%04d)\n",
           (unsigned)major, (unsigned)minor, compiled, failed, dxil_bytes, (int)(time(NULL) - begin), longest,
           of_longest);
    return failed > 0 || compiled == 0;
}
