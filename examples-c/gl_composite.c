/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gl_composite.c -- an OpenGL host that puts its own world and bhr's hole together on the GPU. GL draws the distances
 * of a moon, which bhr reads as the occluder; bhr renders its light and the lens map into textures, in one frame; GL
 * looks its own sky up along the lens map, shades the moon, and puts bhr's light over both. With --sky target bhr bends
 * the sky itself: GL draws that into a picture all round, which bhr reads for each frame, and there is no moon.
 *
 *     cc gl_composite.c gl_share.c -lbhr -lEGL -lm -o gl_composite && ./gl_composite --frames 60 --out composite.ppm */
#include "gl_share.h"
#include "vectors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAP_WIDTH 1024
#define MAP_HEIGHT 512
#define TAN_HALF 0.35

/* The camera and the moon, for shaders: eye; right and up, which reach to the picture's borders, and ahead; the moon's
 * middle and radius. Lengths in M. */
typedef struct World {
    float eye[4], right[4], up[4], ahead[4], moon[4];
} World;

/* Groups of 8 x 8 reach over the borders of pictures whose sides are no multiples of that. */
#define BEGIN                                                                                                          \
    "#version 450\nlayout(local_size_x = 8, local_size_y = 8) in;\n"                                                   \
    "bool outside(ivec2 pixel, ivec2 size) { return any(greaterThanEqual(pixel, size)); }\n"
static const char WORLD[] =
    "layout(location = 0) uniform vec4 world[5];\n"
    "vec3 look(ivec2 pixel, ivec2 size) {\n"
    "    vec2 s = (2.0 * vec2(pixel) + 1.0) / vec2(size) - 1.0;\n"
    "    return normalize(world[3].xyz + s.x * world[1].xyz - s.y * world[2].xyz);\n"
    "}\n";
/* The distance along the line of sight, as bhr wants it; not the depth along the forward axis. */
static const char DISTANCES[] =
    "layout(binding = 0, r32f) uniform writeonly image2D distances;\n"
    "void main() {\n"
    "    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);\n"
    "    if (outside(pixel, imageSize(distances)))\n"
    "        return;\n"
    "    vec3 d = look(pixel, imageSize(distances)), m = world[4].xyz - world[0].xyz;\n"
    "    float along = dot(m, d), inside = along * along - dot(m, m) + world[4].w * world[4].w;\n"
    "    float nothing = uintBitsToFloat(0x7f800000u);\n"
    "    float far = inside > 0.0 && along > 0.0 ? along - sqrt(inside) : nothing;\n"
    "    imageStore(distances, pixel, vec4(far, 0, 0, 0));\n"
    "}\n";
/* The host's sky: a grid of 15 degrees, which the hole bends, before a glow that turns. */
static const char SKY[] =
    "layout(location = 5) uniform float time;\n"
    "vec3 own_sky(vec3 d) {\n"
    "    vec2 at = vec2(atan(d.y, d.x), asin(clamp(d.z, -1.0, 1.0))) * 3.8197186;\n"
    "    vec2 off = abs(fract(at + 0.5) - 0.5) * vec2(length(d.xy), 1.0);\n"
    "    float line = smoothstep(0.04, 0.01, min(off.x, off.y));\n"
    "    float glow = 0.5 + 0.5 * dot(d, vec3(cos(time), sin(time), 0.0));\n"
    "    return mix(vec3(0.01, 0.03, 0.07), vec3(0.20, 0.05, 0.09), glow * glow) + line * vec3(0.10, 0.16, 0.20);\n"
    "}\n";
/* Right ascension 0 is in the middle and grows to the left; the north pole is at the top, and the first row. */
static const char MAP[] =
    "layout(binding = 0, rgba16f) uniform writeonly image2D map;\n"
    "void main() {\n"
    "    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);\n"
    "    if (outside(texel, imageSize(map)))\n"
    "        return;\n"
    "    vec2 at = (vec2(texel) + 0.5) / vec2(imageSize(map));\n"
    "    float ra = 6.2831853 * (0.5 - at.x), dec = 3.1415927 * (0.5 - at.y);\n"
    "    imageStore(map, texel, vec4(own_sky(vec3(cos(dec) * vec2(cos(ra), sin(ra)), sin(dec))), 1.0));\n"
    "}\n";
/* bhr's light over the moon, or over the sky in the direction from which the pixel's light comes; then the film. */
static const char COMPOSE[] =
    "layout(binding = 0, rgba8) uniform writeonly image2D canvas;\n"
    "layout(binding = 1, rgba16f) uniform readonly image2D light;\n"
    "layout(binding = 2, rgba32f) uniform readonly image2D lens;\n"
    "layout(binding = 3, r32f) uniform readonly image2D distances;\n"
    "void main() {\n"
    "    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);\n"
    "    if (outside(pixel, imageSize(canvas)))\n"
    "        return;\n"
    "    vec4 frame = imageLoad(light, pixel), from = imageLoad(lens, pixel);\n"
    "    float far = imageLoad(distances, pixel).x, g2 = from.w * from.w;\n"
    "    vec3 behind = from.w > 0.0 ? g2 * g2 * own_sky(from.xyz) : vec3(0.0);\n"
    "    if (!isinf(far)) {\n"
    "        vec3 place = world[0].xyz + far * look(pixel, imageSize(canvas));\n"
    "        float lit = max(dot(place - world[4].xyz, -normalize(place)) / world[4].w, 0.0);\n"
    "        behind = vec3(0.05, 0.05, 0.07) + lit * vec3(0.60, 0.42, 0.28);\n"
    "    }\n"
    "    vec3 sum = frame.rgb + (1.0 - frame.a) * behind;\n"
    "    imageStore(canvas, pixel, vec4(pow(1.0 - exp(-1.5 * sum), vec3(1.0 / 2.2)), 1.0));\n"
    "}\n";
/* bhr has put the sky in. */
static const char DEVELOP[] =
    "layout(binding = 0, rgba8) uniform writeonly image2D canvas;\n"
    "layout(binding = 1, rgba16f) uniform readonly image2D light;\n"
    "void main() {\n"
    "    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);\n"
    "    if (outside(pixel, imageSize(canvas)))\n"
    "        return;\n"
    "    vec3 sum = imageLoad(light, pixel).rgb;\n"
    "    imageStore(canvas, pixel, vec4(pow(1.0 - exp(-1.5 * sum), vec3(1.0 / 2.2)), 1.0));\n"
    "}\n";

static GLuint make_program(const char *first, const char *second, const char *third) {
    const char *texts[] = {BEGIN, first, second, third};
    char        said[2000] = "";
    GLint       linked = 0;
    GLuint      program = my_glCreateShaderProgramv(GL_COMPUTE_SHADER, 4, texts);
    my_glGetProgramiv(program, GL_LINK_STATUS, &linked);
    my_glGetProgramInfoLog(program, sizeof said, NULL, said);
    if (!linked)
        stop("a shader", said);
    return program;
}

/* Runs a program over images of these textures, the first of which it writes. */
static void run(GLuint program, const World *world, float time, const GLuint *textures, const GLenum *formats,
                GLuint count, GLuint width, GLuint height) {
    my_glUseProgram(program);
    if (world)
        my_glUniform4fv(0, sizeof *world / sizeof world->eye, (const float *)world);
    if (time >= 0)
        my_glUniform1f(5, time);
    for (GLuint i = 0; i < count; i++)
        my_glBindImageTexture(i, textures[i], 0, GL_FALSE, 0, i ? GL_READ_ONLY : GL_WRITE_ONLY, formats[i]);
    my_glDispatchCompute((width + 7) / 8, (height + 7) / 8, 1);
    my_glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

static void set_vector(float out[4], const double v[3], double scale, float last) {
    for (int i = 0; i < 3; i++)
        out[i] = (float)(scale * v[i]);
    out[3] = last;
}

/* Sets bhr's camera, and says the same to shaders. The moon goes round the hole, half sunk into the disk. */
static World set_world(BhrContext *context, int frame) {
    const double wide = TAN_HALF * WIDTH / HEIGHT, turn = 1.1 + 0.05 * frame;
    const double moon[3] = {11.0 * cos(turn), 11.0 * sin(turn), 0.5};
    double       right[3], up[3];
    BhrCamera    camera;
    World        world;
    bhr(bhr_camera_init(&camera, sizeof camera), "a camera");
    camera.fov_y = 2 * atan(TAN_HALF);
    bhr(bhr_camera_orbit(&camera, 60, 0.6, 0.16), "an orbit");
    bhr(bhr_set_camera(context, &camera), "the camera");
    scale(camera.forward, 1 / length(camera.forward));
    cross(camera.forward, camera.up, right);
    scale(right, 1 / length(right));
    cross(right, camera.forward, up);
    set_vector(world.eye, camera.position, 1, 0);
    set_vector(world.right, right, wide, 0);
    set_vector(world.up, up, TAN_HALF, 0);
    set_vector(world.ahead, camera.forward, 1, 0);
    set_vector(world.moon, moon, 1, 2.0f);
    return world;
}

/* Outputs of one frame, each into a target of its own, after what GL has drawn; GL then waits for them. */
static void render(BhrContext *context, const BhrOutput *outputs, uint32_t count, const Turns *turns) {
    BhrSemaphoreValue wait = {turns->drawn, 0}, signal = {turns->rendered, 0};
    BhrSync           sync = {.struct_size = sizeof sync,
                              .wait_count = 1,
                              .signal_count = 1,
                              .waits = &wait,
                              .signals = &signal};
    BhrJob           *job = NULL;
    bhr(bhr_render_outputs_shared(context, outputs, sizeof *outputs, count, turns->rendered ? &sync : NULL, &job),
        "a frame");
    keep_pace(turns, job);
}

int main(int argc, char **argv) {
    int         frames = 60, bends = 0;
    const char *path = "gl_composite.ppm";
    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--frames") == 0)
            frames = atoi(argv[i + 1]);
        else if (strcmp(argv[i], "--out") == 0)
            path = argv[i + 1];
        else if (strcmp(argv[i], "--sky") == 0)
            bends = strcmp(argv[i + 1], "target") == 0;
    }
    make_gl();
    BhrContext *context = make_context();
    Turns       turns = make_turns(context);
    /* Linear light, without bhr's film: the host has its own. */
    uint32_t  flags = bends ? 0 : BHR_IMAGE_TRANSPARENT;
    Shared    light = make_shared(context, BHR_FORMAT_RGBA16F, GL_RGBA16F, WIDTH, HEIGHT, flags);
    Shared    lens = make_shared(context, BHR_FORMAT_RGBA32F, GL_RGBA32F, WIDTH, HEIGHT, 0);
    Shared    drawn = bends ? make_shared(context, BHR_FORMAT_RGBA16F, GL_RGBA16F, MAP_WIDTH, MAP_HEIGHT, 0)
                            : make_shared(context, BHR_FORMAT_R32F, GL_R32F, WIDTH, HEIGHT, 0);
    GLuint    draw = bends ? make_program(SKY, MAP, "") : make_program(WORLD, DISTANCES, "");
    GLuint    compose = bends ? make_program(DEVELOP, "", "") : make_program(WORLD, SKY, COMPOSE);
    GLuint    canvas;
    BhrOutput outputs[2];
    my_glCreateTextures(GL_TEXTURE_2D, 1, &canvas);
    my_glTextureStorage2D(canvas, 1, GL_RGBA8, WIDTH, HEIGHT);
    for (int i = 0; i < 2; i++)
        bhr(bhr_output_init(&outputs[i], sizeof outputs[i]), "an output");
    outputs[0].kind = BHR_OUTPUT_LIGHT;
    outputs[0].target = light.target;
    outputs[1].kind = BHR_OUTPUT_SKY;
    outputs[1].target = lens.target;
    if (bends) {
        BhrSky sky;
        bhr(bhr_sky_init(&sky, sizeof sky), "a sky");
        sky.flags = BHR_SKY_MAP;
        bhr(bhr_set_sky(context, &sky), "the sky");
        bhr(bhr_set_sky_target(context, drawn.target), "the host's sky");
    } else {
        bhr(bhr_set_occluder_target(context, drawn.target, 0), "the host's things");
    }

    const GLuint read[] = {canvas, light.texture, lens.texture, drawn.texture};
    /* bhr has the texture that GL draws into as well, until it signals. */
    const GLuint back[] = {light.texture, drawn.texture, lens.texture};
    const GLenum formats[] = {GL_RGBA8, GL_RGBA16F, GL_RGBA32F, GL_R32F};
    for (int frame = 0; frame < frames; frame++) {
        const World  world = set_world(context, frame);
        const float  time = 0.02f * (float)frame;
        const GLuint width = bends ? MAP_WIDTH : WIDTH, height = bends ? MAP_HEIGHT : HEIGHT;
        run(draw, bends ? NULL : &world, bends ? time : -1, &drawn.texture, bends ? &formats[1] : &formats[3], 1, width,
            height);
        give_turn(&turns, 1, &drawn.texture);
        render(context, outputs, bends ? 1 : 2, &turns);
        take_turn(&turns, bends ? 2 : 3, back);
        run(compose, bends ? NULL : &world, bends ? -1 : time, read, formats, bends ? 2 : 4, WIDTH, HEIGHT);
    }
    static unsigned char pixels[HEIGHT][WIDTH][4];
    my_glGetTextureImage(canvas, 0, GL_RGBA, GL_UNSIGNED_BYTE, sizeof pixels, pixels);
    write_ppm(path, pixels[0][0], WIDTH * 4L);
    printf("%d frames put together by %s, %s; the last one is %s\n", frames, my_glGetString(GL_RENDERER),
           turns.rendered ? "with semaphores" : "waiting on the CPU", path);

    keep_pace(&turns, NULL);
    bhr_target_destroy(light.target);
    bhr_target_destroy(lens.target);
    bhr_target_destroy(drawn.target);
    bhr_semaphore_destroy(turns.rendered);
    bhr_semaphore_destroy(turns.drawn);
    bhr_context_destroy(context);
    return 0;
}
