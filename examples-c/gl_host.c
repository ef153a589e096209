/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gl_host.c -- an OpenGL host whose texture is bhr's picture, in the same memory on the GPU: bhr makes a target, its
 * memory becomes a texture by GL_EXT_memory_object_fd, and, where GL has them, binary semaphores say whose turn it is;
 * else the host waits for bhr's job. The texture is blitted into a framebuffer and read back, as there is no window
 * here: GL comes through EGL without a surface. gl_share.c is how the two come together.
 *
 *     cc gl_host.c gl_share.c -lbhr -lEGL -o gl_host && ./gl_host --frames 60 --out hole.ppm */
#include "gl_share.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    BhrContext *context = make_context();
    Shared      picture = make_shared(context, BHR_FORMAT_RGBA8_SRGB, GL_RGBA8, WIDTH, HEIGHT, 0);
    Turns       turns = make_turns(context);

    /* The host's own drawing: here a blit that turns the picture over, as GL's first row is the lowest. */
    GLuint framebuffers[2], canvas;
    my_glCreateFramebuffers(2, framebuffers);
    my_glCreateTextures(GL_TEXTURE_2D, 1, &canvas);
    my_glTextureStorage2D(canvas, 1, GL_RGBA8, WIDTH, HEIGHT);
    my_glNamedFramebufferTexture(framebuffers[0], GL_COLOR_ATTACHMENT0, picture.texture, 0);
    my_glNamedFramebufferTexture(framebuffers[1], GL_COLOR_ATTACHMENT0, canvas, 0);
    for (int frame = 0; frame < frames; frame++) {
        BhrCamera camera;
        BhrJob   *job = NULL;
        bhr(bhr_camera_init(&camera, sizeof camera), "a camera");
        bhr(bhr_camera_orbit(&camera, 24, 0.05 * frame, 0.12), "an orbit");
        bhr(bhr_set_camera(context, &camera), "the camera");
        BhrSemaphoreValue wait = {turns.drawn, 0}, signal = {turns.rendered, 0};
        BhrSync           sync = {.struct_size = sizeof sync,
                                  .wait_count = frame > 0,
                                  .signal_count = 1,
                                  .waits = &wait,
                                  .signals = &signal};
        bhr(bhr_render_target(context, picture.target, turns.rendered ? &sync : NULL, &job), "a frame");
        keep_pace(&turns, job);
        take_turn(&turns, 1, &picture.texture);
        my_glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers[0]);
        my_glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffers[1]);
        my_glBlitFramebuffer(0, 0, WIDTH, HEIGHT, 0, HEIGHT, WIDTH, 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
        give_turn(&turns, 1, &picture.texture);
    }
    static unsigned char pixels[HEIGHT][WIDTH][4];
    my_glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers[1]);
    my_glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    write_ppm(out, pixels[HEIGHT - 1][0], -WIDTH * 4L); /* GL's first row is the lowest */
    printf("%d frames as a texture of %s, %s; the last one is %s\n", frames, my_glGetString(GL_RENDERER),
           turns.rendered ? "with semaphores" : "waiting on the CPU", out);

    keep_pace(&turns, NULL);
    bhr_target_destroy(picture.target);
    bhr_semaphore_destroy(turns.rendered);
    bhr_semaphore_destroy(turns.drawn);
    bhr_context_destroy(context);
    return 0;
}
