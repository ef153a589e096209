/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gl_host.c -- an OpenGL host whose texture is bhr's picture, in the same memory on the GPU: bhr makes a target, its
 * memory becomes a texture by GL_EXT_memory_object_fd, and, where GL has them, binary semaphores say whose turn it is;
 * else the host waits for bhr's job. The texture is blitted into a framebuffer and read back, as there is no window
 * here: GL comes through EGL without a surface.
 *
 *     cc gl_host.c -lbhr -lEGL -o gl_host && ./gl_host --frames 60 --out hole.ppm */
#include <bhr_interop.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 640
#define HEIGHT 360

/* GL_EXT_memory_object, GL_EXT_memory_object_fd, GL_EXT_semaphore and GL_EXT_semaphore_fd, which no old header has. */
#define GL_TEXTURE_TILING_EXT 0x9580
#define GL_DEDICATED_MEMORY_OBJECT_EXT 0x9581
#define GL_OPTIMAL_TILING_EXT 0x9584
#define GL_HANDLE_TYPE_OPAQUE_FD_EXT 0x9586
#define GL_LAYOUT_GENERAL_EXT 0x958D
#define GL_DEVICE_UUID_EXT 0x9597
#define GL_FUNCTIONS(F)                                                                                                \
    F(const GLubyte *, glGetString, (GLenum))                                                                          \
    F(const GLubyte *, glGetStringi, (GLenum, GLuint))                                                                 \
    F(void, glGetIntegerv, (GLenum, GLint *))                                                                          \
    F(GLenum, glGetError, (void))                                                                                      \
    F(void, glFlush, (void))                                                                                           \
    F(void, glReadPixels, (GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void *))                                    \
    F(void, glCreateTextures, (GLenum, GLsizei, GLuint *))                                                             \
    F(void, glTextureParameteri, (GLuint, GLenum, GLint))                                                              \
    F(void, glCreateFramebuffers, (GLsizei, GLuint *))                                                                 \
    F(void, glNamedFramebufferTexture, (GLuint, GLenum, GLuint, GLint))                                                \
    F(void, glTextureStorage2D, (GLuint, GLsizei, GLenum, GLsizei, GLsizei))                                           \
    F(void, glBindFramebuffer, (GLenum, GLuint))                                                                       \
    F(void, glBlitFramebuffer, (GLint, GLint, GLint, GLint, GLint, GLint, GLint, GLint, GLbitfield, GLenum))           \
    F(void, glGetUnsignedBytei_vEXT, (GLenum, GLuint, GLubyte *))                                                      \
    F(void, glCreateMemoryObjectsEXT, (GLsizei, GLuint *))                                                             \
    F(void, glMemoryObjectParameterivEXT, (GLuint, GLenum, const GLint *))                                             \
    F(void, glImportMemoryFdEXT, (GLuint, GLuint64, GLenum, GLint))                                                    \
    F(void, glTextureStorageMem2DEXT, (GLuint, GLsizei, GLenum, GLsizei, GLsizei, GLuint, GLuint64))                   \
    F(void, glGenSemaphoresEXT, (GLsizei, GLuint *))                                                                   \
    F(void, glImportSemaphoreFdEXT, (GLuint, GLenum, GLint))                                                           \
    F(void, glWaitSemaphoreEXT, (GLuint, GLuint, const GLuint *, GLuint, const GLuint *, const GLenum *))              \
    F(void, glSignalSemaphoreEXT, (GLuint, GLuint, const GLuint *, GLuint, const GLuint *, const GLenum *))
#define DECLARE(result, name, parameters) static result(*my_##name) parameters;
#define LOAD(result, name, parameters) my_##name = (result(*) parameters)eglGetProcAddress(#name);
GL_FUNCTIONS(DECLARE)

static void stop(const char *what, const char *why) {
    fprintf(stderr, "gl_host: %s: %s\n", what, why);
    exit(EXIT_FAILURE);
}

static void bhr(BhrStatus status, const char *what) {
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

/* A GL context on the first GPU that EGL lists, else on Mesa's software. */
static void make_gl(void) {
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

static GLuint import_semaphore(BhrSemaphore *semaphore) {
    BhrHandle handle;
    GLuint    name;
    bhr(bhr_semaphore_export(semaphore, &handle), "exporting a semaphore");
    my_glGenSemaphoresEXT(1, &name);
    my_glImportSemaphoreFdEXT(name, GL_HANDLE_TYPE_OPAQUE_FD_EXT, handle.fd); /* GL's from now on */
    return name;
}

int main(int argc, char **argv) {
    int         frames = 60;
    const char *out = "gl_host.ppm";
    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--frames") == 0)
            frames = atoi(argv[i + 1]);
        else if (strcmp(argv[i], "--out") == 0)
            out = argv[i + 1];
    }
    make_gl();

    /* A context on the GPU that GL is on. */
    BhrContextOptions options;
    BhrContext       *context;
    GLubyte           uuid[16] = {0};
    my_glGetUnsignedBytei_vEXT(GL_DEVICE_UUID_EXT, 0, uuid);
    bhr(bhr_context_options_init(&options, sizeof options), "options");
    options.backend = BHR_BACKEND_VULKAN;
    bhr(bhr_adapter_find(uuid, NULL, &options.adapter_index), "GL's GPU");
    bhr(bhr_context_create(BHR_ABI_VERSION, &options, &context), "a context");
    bhr(bhr_set_spin(context, 0.9), "a spinning hole");

    /* An image of bhr's, whose memory is GL's texture too. */
    BhrInteropInfo   can = {.struct_size = sizeof can};
    BhrTargetOptions shape;
    BhrTargetInfo    info = {.struct_size = sizeof info};
    BhrTarget       *target;
    BhrHandle        handle;
    GLuint           memory, texture;
    bhr(bhr_interop_info(context, &can), "what can be shared");
    bhr(bhr_target_options_init(&shape, sizeof shape), "options");
    shape.width = WIDTH;
    shape.height = HEIGHT;
    shape.handle_type = BHR_HANDLE_OPAQUE_FD;
    bhr(bhr_target_create(context, &shape, &target), "a target");
    bhr(bhr_target_info(target, &info), "the target's memory");
    bhr(bhr_target_export(target, &handle), "exporting the target");
    GLint dedicated = (GLint)info.dedicated;
    my_glCreateMemoryObjectsEXT(1, &memory);
    my_glMemoryObjectParameterivEXT(memory, GL_DEDICATED_MEMORY_OBJECT_EXT, &dedicated);
    my_glImportMemoryFdEXT(memory, info.allocation_size, GL_HANDLE_TYPE_OPAQUE_FD_EXT, handle.fd);
    my_glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    my_glTextureParameteri(texture, GL_TEXTURE_TILING_EXT, GL_OPTIMAL_TILING_EXT);
    my_glTextureStorageMem2DEXT(texture, 1, GL_RGBA8, WIDTH, HEIGHT, memory, info.offset);

    /* Whose turn it is: bhr has rendered, GL has drawn. */
    BhrSemaphore *rendered = NULL, *drawn = NULL;
    GLuint        gl_rendered = 0, gl_drawn = 0;
    GLenum        layout = GL_LAYOUT_GENERAL_EXT; /* info.layout */
    int semaphores = (can.semaphores[BHR_SEMAPHORE_BINARY] & BHR_HANDLE_OPAQUE_FD) && has_gl("GL_EXT_semaphore_fd");
    if (semaphores) {
        bhr(bhr_semaphore_create(context, BHR_SEMAPHORE_BINARY, BHR_HANDLE_OPAQUE_FD, &rendered), "a semaphore");
        bhr(bhr_semaphore_create(context, BHR_SEMAPHORE_BINARY, BHR_HANDLE_OPAQUE_FD, &drawn), "a semaphore");
        gl_rendered = import_semaphore(rendered);
        gl_drawn = import_semaphore(drawn);
    }

    /* The host's own drawing: here a blit that turns the picture over, as GL's first row is the lowest. */
    GLuint framebuffers[2], canvas;
    my_glCreateFramebuffers(2, framebuffers);
    my_glCreateTextures(GL_TEXTURE_2D, 1, &canvas);
    my_glTextureStorage2D(canvas, 1, GL_RGBA8, WIDTH, HEIGHT);
    my_glNamedFramebufferTexture(framebuffers[0], GL_COLOR_ATTACHMENT0, texture, 0);
    my_glNamedFramebufferTexture(framebuffers[1], GL_COLOR_ATTACHMENT0, canvas, 0);
    for (int frame = 0; frame < frames; frame++) {
        BhrCamera camera;
        BhrJob   *job = NULL;
        bhr(bhr_camera_init(&camera, sizeof camera), "a camera");
        bhr(bhr_camera_orbit(&camera, 24, 0.05 * frame, 0.12), "an orbit");
        bhr(bhr_set_camera(context, &camera), "the camera");
        BhrSemaphoreValue wait = {drawn, 0}, signal = {rendered, 0};
        BhrSync           sync = {.struct_size = sizeof sync,
                                  .wait_count = frame > 0,
                                  .signal_count = 1,
                                  .waits = &wait,
                                  .signals = &signal};
        if (semaphores) {
            bhr(bhr_render_target(context, target, &sync, NULL), "a frame");
            my_glWaitSemaphoreEXT(gl_rendered, 0, NULL, 1, &texture, &layout);
        } else {
            bhr(bhr_render_target(context, target, NULL, &job), "a frame");
            bhr(bhr_job_wait(job, UINT64_MAX, NULL), "waiting for a frame");
            bhr_job_destroy(job);
        }
        my_glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers[0]);
        my_glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffers[1]);
        my_glBlitFramebuffer(0, 0, WIDTH, HEIGHT, 0, HEIGHT, WIDTH, 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
        if (semaphores) {
            my_glSignalSemaphoreEXT(gl_drawn, 0, NULL, 1, &texture, &layout);
            my_glFlush();
        }
    }
    static unsigned char pixels[HEIGHT][WIDTH][4];
    FILE                *file = fopen(out, "wb");
    my_glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers[1]);
    my_glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    if (my_glGetError() != GL_NO_ERROR)
        stop("OpenGL", "it reports an error");
    if (!file)
        stop(out, "cannot be written");
    fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
    for (int y = HEIGHT; y-- > 0;)
        for (int x = 0; x < WIDTH; x++)
            fwrite(pixels[y][x], 1, 3, file);
    if (fclose(file) != 0)
        stop(out, "cannot be written");
    printf("%d frames as a texture of %s, %s; the last one is %s\n", frames, my_glGetString(GL_RENDERER),
           semaphores ? "with semaphores" : "waiting on the CPU", out);

    bhr_target_destroy(target);
    bhr_semaphore_destroy(rendered);
    bhr_semaphore_destroy(drawn);
    bhr_context_destroy(context);
    return 0;
}
