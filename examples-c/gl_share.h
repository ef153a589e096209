/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gl_share.h -- OpenGL hosts that share memory with bhr: a GL context without a window, bhr's context on its GPU,
 * targets of bhr's as textures, and whose turn it is. GL comes through EGL, its functions by name. Ends the program
 * with a message where something is missing. For gl_host and gl_composite. */
#ifndef EXAMPLES_GL_SHARE_H
#define EXAMPLES_GL_SHARE_H

#include <bhr_interop.h>

#include <GL/glcorearb.h>

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
    F(void, glFinish, (void))                                                                                          \
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
    F(void, glSignalSemaphoreEXT, (GLuint, GLuint, const GLuint *, GLuint, const GLuint *, const GLenum *))            \
    F(void, glGetTextureImage, (GLuint, GLint, GLenum, GLenum, GLsizei, void *))                                       \
    F(GLuint, glCreateShaderProgramv, (GLenum, GLsizei, const GLchar *const *))                                        \
    F(void, glGetProgramiv, (GLuint, GLenum, GLint *))                                                                 \
    F(void, glGetProgramInfoLog, (GLuint, GLsizei, GLsizei *, GLchar *))                                               \
    F(void, glUseProgram, (GLuint))                                                                                    \
    F(void, glUniform1f, (GLint, GLfloat))                                                                             \
    F(void, glUniform4fv, (GLint, GLsizei, const GLfloat *))                                                           \
    F(void, glBindImageTexture, (GLuint, GLuint, GLint, GLboolean, GLint, GLenum, GLenum))                             \
    F(void, glDispatchCompute, (GLuint, GLuint, GLuint))                                                               \
    F(void, glMemoryBarrier, (GLbitfield))
#define DECLARE(result, name, parameters) extern result(*my_##name) parameters;
GL_FUNCTIONS(DECLARE)

void stop(const char *what, const char *why);
/* Ends the program if a call of bhr's has failed. */
void bhr(BhrStatus status, const char *what);

/* A GL context on the first GPU that EGL lists, else on Mesa's software. */
void make_gl(void);
/* A context of bhr's on the same GPU, with a spinning hole. */
BhrContext *make_context(void);

/* A target of bhr's, and the texture in the same memory. `inside`: the texture's internal format. */
typedef struct Shared {
    BhrTarget *target;
    GLuint     texture;
} Shared;
Shared make_shared(BhrContext *context, BhrFormat format, GLenum inside, uint32_t width, uint32_t height,
                   uint32_t flags);

/* Whose turn it is: bhr has rendered, GL has drawn. NULL and 0 where bhr or GL shares no binary semaphores: then the
 * program waits on the CPU. */
typedef struct Turns {
    BhrSemaphore *rendered, *drawn;
    GLuint        gl_rendered, gl_drawn;
} Turns;
Turns make_turns(BhrContext *context);
/* GL gives bhr what it has drawn so far, and waits for what bhr has rendered; textures of each. */
void give_turn(const Turns *turns, GLuint count, const GLuint *textures);
void take_turn(const Turns *turns, GLuint count, const GLuint *textures);

/* A frame of bhr's has been submitted: waits for it where there are no semaphores; else for the frame two before it, as
 * a program without a display could get ahead of the GPU by more frames than a context takes, 64. Destroys the job that
 * it has waited for. With NULL, at the end: waits for all. */
void keep_pace(const Turns *turns, BhrJob *job);

/* Rows of WIDTH pixels of 4 bytes, `stride` bytes from one to the next below. */
void write_ppm(const char *path, const unsigned char *top_row, long stride);

#endif
