/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gl_share.c -- see gl_share.h. */
#include "gl_share.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFINE(result, name, parameters) result(*my_##name) parameters;
#define LOAD(result, name, parameters) my_##name = (result(*) parameters)eglGetProcAddress(#name);
GL_FUNCTIONS(DEFINE)

void stop(const char *what, const char *why) {
    fprintf(stderr, "%s: %s\n", what, why);
    exit(EXIT_FAILURE);
}

void bhr(BhrStatus status, const char *what) {
    if (status < BHR_OK)
        stop(what, bhr_error_message());
}

static int has_gl(const char *extension) {
    GLint count = 0;
    my_glGetIntegerv(GL_NUM_EXTENSIONS, &count);
    while (count-- > 0)
        if (strcmp((const char *)my_glGetStringi(GL_EXTENSIONS, (GLuint)count), extension) == 0)
            return 1;
    return 0;
}

void make_gl(void) {
    PFNEGLQUERYDEVICESEXTPROC       list = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
    PFNEGLGETPLATFORMDISPLAYEXTPROC get =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    EGLDeviceEXT devices[16];
    EGLDisplay   display = EGL_NO_DISPLAY;
    EGLint       count = 0, configs = 0;
    EGLint       any[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_NONE};
    EGLint       version[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
    EGLConfig    config = NULL;
    if (!get || !list || !list(16, devices, &count))
        stop("EGL", "it lists no devices");
    for (EGLint i = 0; i < count && display == EGL_NO_DISPLAY; i++) {
        EGLDisplay one = get(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL);
        if (one != EGL_NO_DISPLAY && eglInitialize(one, NULL, NULL))
            display = one;
    }
    eglBindAPI(EGL_OPENGL_API);
    if (display == EGL_NO_DISPLAY || !eglChooseConfig(display, any, &config, 1, &configs))
        stop("EGL", "no display");
    EGLContext context = eglCreateContext(display, configs ? config : NULL, EGL_NO_CONTEXT, version);
    if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
        stop("OpenGL", "no context of version 4.5");
    GL_FUNCTIONS(LOAD)
    if (!has_gl("GL_EXT_memory_object_fd"))
        stop((const char *)my_glGetString(GL_RENDERER), "no GL_EXT_memory_object_fd: use bhr_render_image");
}

BhrContext *make_context(void) {
    BhrContextOptions options;
    BhrContext       *context;
    GLubyte           uuid[16] = {0};
    my_glGetUnsignedBytei_vEXT(GL_DEVICE_UUID_EXT, 0, uuid);
    bhr(bhr_context_options_init(&options, sizeof options), "options");
    options.backend = BHR_BACKEND_VULKAN;
    bhr(bhr_adapter_find(uuid, NULL, &options.adapter_index), "GL's GPU");
    bhr(bhr_context_create(BHR_ABI_VERSION, &options, &context), "a context");
    bhr(bhr_set_spin(context, 0.9), "a spinning hole");
    return context;
}

Shared make_shared(BhrContext *context, BhrFormat format, GLenum inside, uint32_t width, uint32_t height,
                   uint32_t flags) {
    BhrTargetOptions shape;
    BhrTargetInfo    info;
    BHR_INIT(info);
    BhrHandle        handle;
    Shared           made;
    GLuint           memory;
    bhr(bhr_target_options_init(&shape, sizeof shape), "options");
    shape.format = format;
    shape.width = width;
    shape.height = height;
    shape.flags = flags;
    shape.handle_type = BHR_HANDLE_OPAQUE_FD; /* the layout stays VK_IMAGE_LAYOUT_GENERAL, as GL wants it */
    bhr(bhr_target_create(context, &shape, &made.target), "a target");
    bhr(bhr_target_info(made.target, &info), "the target's memory");
    bhr(bhr_target_export(made.target, &handle), "exporting the target");
    GLint dedicated = (GLint)info.dedicated;
    my_glCreateMemoryObjectsEXT(1, &memory);
    my_glMemoryObjectParameterivEXT(memory, GL_DEDICATED_MEMORY_OBJECT_EXT, &dedicated);
    /* The descriptor is GL's from now on. */
    my_glImportMemoryFdEXT(memory, info.allocation_size, GL_HANDLE_TYPE_OPAQUE_FD_EXT, handle.fd);
    my_glCreateTextures(GL_TEXTURE_2D, 1, &made.texture);
    my_glTextureParameteri(made.texture, GL_TEXTURE_TILING_EXT, GL_OPTIMAL_TILING_EXT);
    my_glTextureStorageMem2DEXT(made.texture, 1, inside, (GLsizei)width, (GLsizei)height, memory, info.offset);
    return made;
}

static GLuint import_semaphore(BhrSemaphore *semaphore) {
    BhrHandle handle;
    GLuint    name;
    bhr(bhr_semaphore_export(semaphore, &handle), "exporting a semaphore");
    my_glGenSemaphoresEXT(1, &name);
    my_glImportSemaphoreFdEXT(name, GL_HANDLE_TYPE_OPAQUE_FD_EXT, handle.fd); /* GL's from now on */
    return name;
}

Turns make_turns(BhrContext *context) {
    BhrInteropInfo can;
    BHR_INIT(can);
    Turns          turns = {NULL, NULL, 0, 0};
    bhr(bhr_interop_info(context, &can), "what can be shared");
    if ((can.semaphores[BHR_SEMAPHORE_BINARY] & BHR_HANDLE_OPAQUE_FD) && has_gl("GL_EXT_semaphore_fd")) {
        bhr(bhr_semaphore_create(context, BHR_SEMAPHORE_BINARY, BHR_HANDLE_OPAQUE_FD, &turns.rendered), "a semaphore");
        bhr(bhr_semaphore_create(context, BHR_SEMAPHORE_BINARY, BHR_HANDLE_OPAQUE_FD, &turns.drawn), "a semaphore");
        turns.gl_rendered = import_semaphore(turns.rendered);
        turns.gl_drawn = import_semaphore(turns.drawn);
    }
    return turns;
}

static const GLenum GENERAL[8] = {GL_LAYOUT_GENERAL_EXT, GL_LAYOUT_GENERAL_EXT, GL_LAYOUT_GENERAL_EXT,
                                  GL_LAYOUT_GENERAL_EXT, GL_LAYOUT_GENERAL_EXT, GL_LAYOUT_GENERAL_EXT,
                                  GL_LAYOUT_GENERAL_EXT, GL_LAYOUT_GENERAL_EXT};

void give_turn(const Turns *turns, GLuint count, const GLuint *textures) {
    if (!turns->drawn) {
        my_glFinish();
        return;
    }
    my_glSignalSemaphoreEXT(turns->gl_drawn, 0, NULL, count, textures, GENERAL);
    my_glFlush(); /* a signal must have been submitted before bhr waits for it */
}

void take_turn(const Turns *turns, GLuint count, const GLuint *textures) {
    if (turns->rendered)
        my_glWaitSemaphoreEXT(turns->gl_rendered, 0, NULL, count, textures, GENERAL);
}

static void finish(BhrJob *job) {
    bhr(bhr_job_wait(job, UINT64_MAX, NULL), "waiting for a frame");
    bhr_job_destroy(job);
}

void keep_pace(const Turns *turns, BhrJob *job) {
    static BhrJob *before[2];
    if (job && !turns->rendered) {
        finish(job);
        return;
    }
    if (before[0])
        finish(before[0]);
    before[0] = before[1];
    before[1] = job;
    if (!job && before[0])
        keep_pace(turns, NULL);
}

void write_ppm(const char *path, const unsigned char *top_row, long stride) {
    FILE *file = fopen(path, "wb");
    if (my_glGetError() != GL_NO_ERROR)
        stop("OpenGL", "it reports an error");
    if (!file)
        stop(path, "cannot be written");
    fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            fwrite(top_row + y * stride + 4 * x, 1, 3, file);
    if (fclose(file) != 0)
        stop(path, "cannot be written");
}
