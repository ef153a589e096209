/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* composite.c -- a program's own world around the hole, in one picture: a ship and moons that a plain rasteriser draws,
 * before the disk, sunk into it, beside and behind the hole; and the program's own sky, bent by the lens map. Vertices
 * are drawn where light shows them (bhr_project_points), by direct light and by that which went half round the hole.
 * bhr makes the light of the disk between them (bhr_set_occluder), and says where each pixel looks
 * (bhr_render_outputs). The film is the program's own as well. Knows no window. */
#include "options.h"
#include "vectors.h"

#include <stdlib.h>

#define SAMPLES 2u /* pixels are halved at the end, so that the program's edges are smooth */

typedef struct Sphere {
    double centre[3], radius, colour[3];
} Sphere;

/* A box of the ship: centre and half sides in the ship's axes. */
typedef struct Box {
    double centre[3], half[3], colour[3];
} Box;

/* A corner of a triangle: where it is, and how its surface looks. */
typedef struct Vertex {
    double place[3], normal[3], colour[3];
} Vertex;

/* The thing that a pixel shows; distance is INFINITY where it shows none. */
typedef struct Seen {
    double distance;
    Vertex at;
} Seen;

/* All things as triangles. */
typedef struct Mesh {
    Vertex            *vertices;
    uint32_t         (*triangles)[3];
    BhrProjectedPoint *images; /* of the vertices */
    size_t             vertex_count, triangle_count;
} Mesh;

typedef struct World {
    BhrContext *context;
    uint32_t    width, height; /* of the frame, SAMPLES times the picture's */
    BhrRay     *rays;
    Mesh        mesh;
    Seen       *things; /* by direct light */
    Seen       *ghosts; /* by light that went half round the hole */
    float      *distances; /* R32F: to the things */
    float      *light;     /* RGBA32F: disk and shadow, without a sky */
    float      *sky;       /* RGBA32F: the lens map */
    float      *depth;     /* R32F: to the disk */
    double      gain;      /* of the disk's light beside that of the program's things */
    BhrProjectedPoint glows[2];
} World;

/* Lengths in M: the disk reaches from 6 to 17, the camera is at (0, 26, 2.5). The first moon is cut by the disk; the
 * second is beside the hole, a little farther than it; the third passes near the camera, the fourth behind the hole. */
static const Sphere MOONS[] = {
    {{-6.3, 10.2, 0.15}, 1.35, {0.62, 0.56, 0.50}},
    {{13.2, -2.5, 1.5}, 1.0, {0.42, 0.52, 0.64}},
    {{5.1, 16.6, 4.2}, 0.62, {0.66, 0.44, 0.32}},
    {{-3.5, -24.0, 4.0}, 2.2, {0.70, 0.58, 0.46}},
};

static const double SHIP[3] = {-1.9, 19.3, 3.05};
static const double SHIP_TURN = 0.5; /* about the vertical */
static const Box    BOXES[] = {
    {{0.0, 0.0, 0.0}, {0.85, 0.16, 0.11}, {0.60, 0.62, 0.66}},
    {{-0.55, 0.0, 0.14}, {0.20, 0.11, 0.08}, {0.70, 0.68, 0.62}},
    {{0.35, 0.0, -0.02}, {0.22, 0.62, 0.03}, {0.36, 0.40, 0.50}},
    {{0.80, 0.30, 0.0}, {0.16, 0.06, 0.06}, {0.30, 0.30, 0.34}},
    {{0.80, -0.30, 0.0}, {0.16, 0.06, 0.06}, {0.30, 0.30, 0.34}},
};
/* The glow of its engines, which hides nothing: centres in the ship's axes. */
static const double GLOWS[][3] = {{1.02, 0.30, 0.0}, {1.02, -0.30, 0.0}};
static const double GLOW_SIZE = 0.13;

/* To the ship's axes and back. */
static void turn(double v[3], double angle) {
    const double up[3] = {0.0, 0.0, 1.0};
    rotate(v, up, angle);
}

/* Squares of a sphere along its equator and from pole to pole, and along each side of a box: small, because the lens
 * bends long edges. */
enum { AROUND = 120, DOWN = 60, SIDE = 8 };
enum { PATCH_MOST = (AROUND + 1) * (DOWN + 1) };

/* Adds a patch of `columns` x `rows` squares; at gives a place of it and its normal from shares 0 .. 1. */
static void add_patch(Mesh *mesh, int columns, int rows, const double colour[3], const void *thing, int side,
                      void (*at)(const void *thing, int side, double x, double y, Vertex *out)) {
    const uint32_t first = (uint32_t)mesh->vertex_count;
    for (int y = 0; y <= rows; y++) {
        for (int x = 0; x <= columns; x++) {
            Vertex *vertex = &mesh->vertices[mesh->vertex_count++];
            memcpy(vertex->colour, colour, sizeof vertex->colour);
            at(thing, side, (double)x / columns, (double)y / rows, vertex);
        }
    }
    for (int i = 0; i < columns * rows; i++) {
        const uint32_t width = (uint32_t)columns + 1, row = (uint32_t)(i / columns);
        const uint32_t a = first + row * width + (uint32_t)(i % columns);
        const uint32_t corners[2][3] = {{a, a + 1, a + width}, {a + 1, a + width + 1, a + width}};
        memcpy(mesh->triangles[mesh->triangle_count], corners, sizeof corners);
        mesh->triangle_count += 2;
    }
}

static void on_sphere(const void *thing, int side, double x, double y, Vertex *out) {
    const Sphere *sphere = thing;
    const double  phi = 2.0 * PI * x, theta = PI * y;
    (void)side;
    out->normal[0] = sin(theta) * cos(phi);
    out->normal[1] = sin(theta) * sin(phi);
    out->normal[2] = cos(theta);
    memcpy(out->place, sphere->centre, sizeof out->place);
    add(out->place, sphere->radius, out->normal);
}

/* side: 0 .. 5, the axis twice and whether it is the far one. */
static void on_box(const void *thing, int side, double x, double y, Vertex *out) {
    const Box   *box = thing;
    const int    axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double out_of = side % 2 == 0 ? 1.0 : -1.0;
    memcpy(out->place, box->centre, sizeof out->place);
    out->place[axis] += out_of * box->half[axis];
    out->place[u] += (2.0 * x - 1.0) * box->half[u];
    out->place[v] += (2.0 * y - 1.0) * box->half[v];
    memset(out->normal, 0, sizeof out->normal);
    out->normal[axis] = out_of;
    turn(out->place, SHIP_TURN);
    turn(out->normal, SHIP_TURN);
    add(out->place, 1.0, SHIP);
}

/* 0, or -1 without memory. */
static int build(Mesh *mesh) {
    const size_t sides = 6 * COUNT_OF(BOXES), most = COUNT_OF(MOONS) * PATCH_MOST + sides * (SIDE + 1) * (SIDE + 1);
    mesh->vertices = calloc(most, sizeof *mesh->vertices);
    mesh->images = calloc(most, sizeof *mesh->images);
    mesh->triangles = calloc(2 * most, sizeof *mesh->triangles);
    if (mesh->vertices == NULL || mesh->images == NULL || mesh->triangles == NULL) {
        return -1;
    }
    for (size_t i = 0; i < COUNT_OF(MOONS); i++) {
        add_patch(mesh, AROUND, DOWN, MOONS[i].colour, &MOONS[i], 0, on_sphere);
    }
    for (size_t i = 0; i < sides; i++) {
        add_patch(mesh, SIDE, SIDE, BOXES[i / 6].colour, &BOXES[i / 6], (int)(i % 6), on_box);
    }
    return 0;
}

/* Where a mesh is seen by light of an order. */
static BhrStatus project(World *world, uint32_t order) {
    Mesh   *mesh = &world->mesh;
    double *places = malloc(mesh->vertex_count * 3 * sizeof *places);
    if (places == NULL) {
        return BHR_ERROR_OUT_OF_MEMORY;
    }
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        memcpy(&places[3 * i], mesh->vertices[i].place, 3 * sizeof *places);
    }
    const BhrStatus status = bhr_project_points(world->context, world->width, world->height, places,
                                                mesh->vertex_count, order, mesh->images, sizeof *mesh->images);
    free(places);
    return status;
}

/* A triangle of the screen into the pixels whose middles it covers, where it is the nearest. */
static void raster(const World *world, const uint32_t triangle[3], Seen *pixels) {
    double x[3], y[3], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        const BhrProjectedPoint *image = &world->mesh.images[triangle[i]];
        if (!image->found || isnan(image->x)) {
            return;
        }
        x[i] = image->x, y[i] = image->y;
        low[0] = fmin(low[0], x[i]), high[0] = fmax(high[0], x[i]);
        low[1] = fmin(low[1], y[i]), high[1] = fmax(high[1], y[i]);
    }
    const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    /* Across the line straight behind the hole images are rings, and a triangle's corners on all sides of them. */
    if (area == 0.0 || high[0] - low[0] > 0.1 * world->width || high[1] - low[1] > 0.1 * world->width) {
        return;
    }
    const double right = fmin(high[0], world->width - 0.5), bottom = fmin(high[1], world->height - 0.5);
    for (double py = fmax(floor(low[1]), 0.0) + 0.5; py <= bottom; py += 1.0) {
        for (double px = fmax(floor(low[0]), 0.0) + 0.5; px <= right; px += 1.0) {
            const double b = ((px - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (py - y[0])) / area;
            const double c = ((x[1] - x[0]) * (py - y[0]) - (px - x[0]) * (y[1] - y[0])) / area;
            const double weights[3] = {1.0 - b - c, b, c};
            if (b < 0.0 || c < 0.0 || b + c > 1.0) {
                continue;
            }
            double distance = 0.0;
            for (int i = 0; i < 3; i++) {
                distance += weights[i] * world->mesh.images[triangle[i]].distance;
            }
            Seen *seen = &pixels[(size_t)py * world->width + (size_t)px];
            if (distance < seen->distance) {
                memset(seen, 0, sizeof *seen);
                seen->distance = distance;
                /* Triangles are a few pixels wide: weights on the screen serve for their surface. */
                for (int i = 0; i < 3; i++) {
                    const Vertex *vertex = &world->mesh.vertices[triangle[i]];
                    add(seen->at.place, weights[i], vertex->place);
                    add(seen->at.normal, weights[i], vertex->normal);
                    add(seen->at.colour, weights[i], vertex->colour);
                }
            }
        }
    }
}

/* The things by light of an order. */
static BhrStatus draw(World *world, uint32_t order, Seen *pixels) {
    const BhrStatus status = project(world, order);
    for (size_t i = 0; i < (size_t)world->width * world->height; i++) {
        pixels[i].distance = INFINITY;
    }
    for (size_t i = 0; status >= 0 && i < world->mesh.triangle_count; i++) {
        raster(world, world->mesh.triangles[i], pixels);
    }
    return status;
}

/* A number in 0 .. 1 for each cell of a lattice: the finish of MurmurHash3 (A. Appleby 2011). */
static double of_cell(int64_t x, int64_t y, int64_t z, uint32_t which) {
    uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u ^ (uint32_t)z * 0xcb1ab31fu;
    h ^= which * 0x9e3779b9u;
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return (h ^ h >> 16) / 4294967296.0;
}

static const int UNITS[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};

/* Value noise: random numbers at the corners of a lattice, and smooth between them. */
static double noise(const double v[3], double scale_of, uint32_t which) {
    double sum = 0.0, share[3];
    int64_t cell[3];
    for (int i = 0; i < 3; i++) {
        const double at = v[i] * scale_of, low = floor(at), x = at - low;
        cell[i] = (int64_t)low;
        share[i] = x * x * (3.0 - 2.0 * x);
    }
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1.0;
        for (int i = 0; i < 3; i++) {
            weight *= UNITS[corner][i] ? share[i] : 1.0 - share[i];
        }
        const int *unit = UNITS[corner];
        sum += weight * of_cell(cell[0] + unit[0], cell[1] + unit[1], cell[2] + unit[2], which);
    }
    return sum;
}

/* The program's own sky in a direction: clouds of gas, a few wide stars, and a planet behind the hole. */
static void own_sky(const double d[3], double out[3]) {
    const double red = noise(d, 2.2, 1) * 0.6 + noise(d, 5.1, 2) * 0.3 + noise(d, 11.3, 3) * 0.1;
    const double blue = noise(d, 1.7, 4) * 0.6 + noise(d, 4.3, 5) * 0.3 + noise(d, 9.7, 6) * 0.1;
    const double r = pow(fmax(red - 0.42, 0.0), 1.5), b = pow(fmax(blue - 0.40, 0.0), 1.5);
    out[0] = 0.004 + 0.60 * r + 0.08 * b;
    out[1] = 0.006 + 0.20 * r + 0.22 * b;
    out[2] = 0.012 + 0.22 * r + 0.60 * b;
    for (int which = 10; which < 12; which++) {
        const double cells = which == 10 ? 26.0 : 55.0, size = which == 10 ? 0.0016 : 0.0010;
        double       star[3];
        int64_t      cell[3];
        for (int i = 0; i < 3; i++) {
            cell[i] = (int64_t)floor(d[i] * cells);
        }
        for (int i = 0; i < 3; i++) {
            const double at = 0.2 + 0.6 * of_cell(cell[0], cell[1], cell[2], (uint32_t)(which * 7 + i));
            star[i] = ((double)cell[i] + at) / cells;
        }
        const double distance = length(star), lit = of_cell(cell[0], cell[1], cell[2], (uint32_t)which * 31u);
        scale(star, 1.0 / distance);
        add(star, -1.0, d);
        const double off = length(star) / size;
        if (lit > 0.75 && off < 5.0) {
            const double warm = of_cell(cell[0], cell[1], cell[2], (uint32_t)which * 53u);
            const double power = pow(4.0 * lit - 3.0, 3.0) * exp(-0.5 * off * off) * (which == 10 ? 2.0 : 1.0);
            out[0] += power * (0.7 + 0.5 * warm);
            out[1] += power * 0.85;
            out[2] += power * (1.2 - 0.5 * warm);
        }
    }
    /* A planet with bands, far behind the hole and a little to its side, lit from the upper right. */
    const double centre[3] = {0.2425, -0.9640, 0.1090}, pole[3] = {0.30, 0.10, 0.9487}, sun[3] = {-0.62, 0.55, 0.56};
    const double radius = 0.12, along = dot(d, centre), off2 = 1.0 - along * along;
    if (along > 0.0 && off2 < radius * radius) {
        /* The normal of the planet's surface in that direction, by parallel rays: the planet is far away. */
        double normal[3] = {-centre[0], -centre[1], -centre[2]}, aside[3];
        memcpy(aside, d, sizeof aside);
        add(aside, -along, centre);
        scale(normal, sqrt(1.0 - off2 / (radius * radius)));
        add(normal, 1.0 / radius, aside);
        const double latitude = dot(normal, pole), lit = 0.02 + fmax(dot(normal, sun), 0.0);
        const double band = 0.5 + 0.5 * sin(17.0 * latitude + 2.0 * noise(normal, 3.0, 20));
        out[0] = lit * (0.34 + 0.30 * band);
        out[1] = lit * (0.30 + 0.18 * band);
        out[2] = lit * (0.38 - 0.06 * band);
    }
}

/* The colour of a thing, lit by the disk's warm light from the hole, and by the sky's. */
static void shade(const Vertex *thing, double out[3]) {
    const double to_hole[3] = {-thing->place[0], -thing->place[1], -thing->place[2]};
    const double distance = length(to_hole), facing = dot(to_hole, thing->normal) / distance;
    const double warm = fmax(0.5 * facing + 0.25, 0.0) * 260.0 / (distance * distance + 60.0);
    const double rim = 0.05 + 0.05 * thing->normal[2];
    const double grain = 0.85 + 0.3 * noise(thing->place, 5.0, 30);
    out[0] = grain * thing->colour[0] * (1.00 * warm + 0.8 * rim);
    out[1] = grain * thing->colour[1] * (0.72 * warm + 0.9 * rim);
    out[2] = grain * thing->colour[2] * (0.45 * warm + 1.3 * rim);
}

/* The share of a ball of light exp(-k r^2) that a line of sight crosses before a thing, which lies `before` its middle
 * (negative) or behind it. A ball that ended at its middle would leave the near end of a nozzle's side dark. */
static double lit_share(double k, double before) {
    return 0.5 * (1.0 + erf(sqrt(k) * before));
}

/* The engines' light along a line of sight, from where they seem to be: what lies behind the disk comes through as far
 * as alpha leaves it. */
static void add_glows(const World *world, size_t i, double alpha, double out[3]) {
    for (size_t k = 0; k < COUNT_OF(GLOWS); k++) {
        const BhrRay *ray = &world->rays[i];
        double        place[3];
        memcpy(place, world->glows[k].apparent, sizeof place);
        add(place, -1.0, ray->position);
        const double t = dot(place, ray->direction), off2 = (dot(place, place) - t * t) / (GLOW_SIZE * GLOW_SIZE);
        if (t > 0.0) {
            const double before = (world->things[i].distance - t) / GLOW_SIZE;
            const double through = t < world->depth[i] ? 1.0 : 1.0 - alpha;
            const double core = 2.4 * exp(-6.0 * off2) * lit_share(6.0, before);
            const double halo = 0.7 * exp(-0.9 * off2) * lit_share(0.9, before);
            const double power = (core + halo) * through;
            out[0] += 0.25 * power;
            out[1] += 0.65 * power;
            out[2] += 1.30 * power;
        }
    }
}

static const Choice MATTERS[] = {{"thin", BHR_PRESET_MATTER_THIN}, {"deep", BHR_PRESET_MATTER_DEEP}, {NULL, 0}};

static BhrImage image_of(const World *world, BhrFormat format, float *pixels) {
    BhrImage image;
    BHR_INIT(image);
    image.format = format;
    image.width = world->width;
    image.height = world->height;
    image.pixels = pixels;
    image.byte_size = (uint64_t)world->width * world->height * (format == BHR_FORMAT_R32F ? 4 : 16);
    return image;
}

/* The program's things, and their distances for bhr. */
static BhrStatus cast(World *world) {
    double    glows[COUNT_OF(GLOWS)][3];
    BhrStatus status = bhr_camera_rays(world->context, world->width, world->height, world->rays);
    for (size_t i = 0; i < COUNT_OF(GLOWS); i++) {
        memcpy(glows[i], GLOWS[i], sizeof glows[i]);
        turn(glows[i], SHIP_TURN);
        add(glows[i], 1.0, SHIP);
    }
    if (status >= 0) {
        status = bhr_project_points(world->context, world->width, world->height, glows[0], COUNT_OF(GLOWS), 0,
                                    world->glows, sizeof *world->glows);
    }
    if (status >= 0) {
        status = draw(world, 1, world->ghosts);
    }
    if (status >= 0) {
        status = draw(world, 0, world->things);
    }
    if (status < 0) {
        return status;
    }
    for (size_t i = 0; i < (size_t)world->width * world->height; i++) {
        world->distances[i] = (float)world->things[i].distance;
    }
    BhrImage distances = image_of(world, BHR_FORMAT_R32F, world->distances);
    distances.flags = BHR_IMAGE_LENSED;
    return bhr_set_occluder(world->context, &distances);
}

/* The disk's light between the things, the lens map, and how far the disk is. */
static BhrStatus trace(World *world) {
    static const BhrOutputKind kinds[] = {BHR_OUTPUT_LIGHT, BHR_OUTPUT_SKY, BHR_OUTPUT_DEPTH};
    float *const               pixels[] = {world->light, world->sky, world->depth};
    BhrImage                   images[COUNT_OF(kinds)];
    BhrOutput                  outputs[COUNT_OF(kinds)];
    for (size_t i = 0; i < COUNT_OF(kinds); i++) {
        images[i] = image_of(world, kinds[i] == BHR_OUTPUT_DEPTH ? BHR_FORMAT_R32F : BHR_FORMAT_RGBA32F, pixels[i]);
        images[i].flags = BHR_IMAGE_TRANSPARENT;
        BHR_INIT(outputs[i]);
        outputs[i].kind = kinds[i];
        outputs[i].image = &images[i];
    }
    return bhr_render_outputs(world->context, outputs, sizeof *outputs, COUNT_OF(outputs), NULL);
}

/* The linear colour of a pixel of the frame. */
static void join(const World *world, size_t i, double out[3]) {
    const float   *light = world->light + 4 * i, *sky = world->sky + 4 * i;
    const Seen    *thing = &world->things[i], *ghost = &world->ghosts[i];
    const double   g = sky[3];
    double         behind[3] = {0.0, 0.0, 0.0};
    if (isfinite(thing->distance)) {
        shade(&thing->at, behind);
    } else if (isfinite(ghost->distance)) {
        shade(&ghost->at, behind);
    } else if (g > 0.0) {
        const double d[3] = {sky[0], sky[1], sky[2]};
        own_sky(d, behind);
        /* Light that falls towards the camera arrives brighter: I ~ g^4. */
        scale(behind, g * g * g * g);
    }
    for (int c = 0; c < 3; c++) {
        out[c] = world->gain * light[c] + (1.0 - light[3]) * behind[c];
    }
    add_glows(world, i, light[3], out);
}

/* Film: K. Narkowicz's fit of ACES (2016), and the sRGB curve. */
static unsigned char develop(double x) {
    const double exposed = 0.85 * fmax(x, 0.0);
    const double toned = exposed * (2.51 * exposed + 0.03) / (exposed * (2.43 * exposed + 0.59) + 0.14);
    const double code = toned <= 0.0031308 ? 12.92 * toned : 1.055 * pow(fmin(toned, 1.0), 1.0 / 2.4) - 0.055;
    return (unsigned char)(255.0 * fmin(code, 1.0) + 0.5);
}

static BhrStatus save(const World *world, const char *path) {
    BhrImage       picture = image_of(world, BHR_FORMAT_RGBA8_SRGB, NULL);
    unsigned char *pixels = malloc((size_t)world->width * world->height * 4 / (SAMPLES * SAMPLES));
    if (pixels == NULL) {
        return BHR_ERROR_OUT_OF_MEMORY;
    }
    picture.width /= SAMPLES;
    picture.height /= SAMPLES;
    picture.pixels = pixels;
    picture.byte_size = (uint64_t)picture.width * picture.height * 4;
    for (size_t i = 0; i < (size_t)picture.width * picture.height; i++) {
        const size_t first = (i / picture.width * world->width + i % picture.width) * SAMPLES;
        double       sum[3] = {0.0, 0.0, 0.0}, sample[3];
        for (size_t k = 0; k < SAMPLES * SAMPLES; k++) {
            join(world, first + k / SAMPLES * world->width + k % SAMPLES, sample);
            add(sum, 1.0 / (SAMPLES * SAMPLES), sample);
        }
        for (int c = 0; c < 3; c++) {
            pixels[4 * i + c] = develop(sum[c]);
        }
        pixels[4 * i + 3] = 255;
    }
    const BhrStatus status = bhr_image_save(&picture, path);
    free(pixels);
    return status;
}

/* A thin disk, translucent, so that what is sunk into it shows through; or one with depth. */
static BhrStatus set_matter(BhrContext *context, int32_t matter) {
    if (matter == BHR_PRESET_MATTER_DEEP) {
        BhrPresetOptions options;
        BHR_INIT(options);
        options.matter = matter;
        return bhr_set_preset_with(context, BHR_PRESET_CINEMATIC, &options, NULL);
    }
    BhrDisk disk;
    BHR_INIT(disk);
    disk.opacity = 0.8;
    return bhr_set_disk(context, &disk);
}

static int compose(World *world, int32_t matter, const char *path) {
    const size_t count = (size_t)world->width * world->height;
    world->rays = calloc(count, sizeof *world->rays);
    world->things = calloc(count, sizeof *world->things);
    world->ghosts = calloc(count, sizeof *world->ghosts);
    world->distances = calloc(count, sizeof(float));
    world->light = calloc(count, 4 * sizeof(float));
    world->sky = calloc(count, 4 * sizeof(float));
    world->depth = calloc(count, sizeof(float));
    if (build(&world->mesh) < 0 || !world->rays || !world->things || !world->ghosts || !world->distances ||
        !world->light || !world->sky || !world->depth) {
        fprintf(stderr, "composite: no memory for a frame of %u x %u\n", (unsigned)world->width,
                (unsigned)world->height);
        return EXIT_FAILURE;
    }
    world->gain = matter == BHR_PRESET_MATTER_DEEP ? 0.35 : 1.0;
    BhrStatus status = set_matter(world->context, matter);
    if (status >= 0) {
        status = cast(world);
    }
    if (status >= 0) {
        status = trace(world);
    }
    if (status >= 0) {
        status = save(world, path);
    }
    return status < 0 ? report_failure("compose the picture", status) : EXIT_SUCCESS;
}

int main(int argc, char **argv) {
    const char  *path = "composite.png";
    uint32_t     size[2] = {1280, 720};
    int32_t      backend = BHR_BACKEND_AUTO, matter = BHR_PRESET_MATTER_THIN;
    int          help = 0;
    const Option options[] = {
        {"--output", OPTION_TEXT, &path, "FILE", "the picture, .png or .ppm", NULL, NULL},
        {"--size", OPTION_SIZE, size, "WxH", "of the picture", NULL, "1 to 8192 a side"},
        {"--matter", OPTION_CHOICE, &matter, NULL, "a thin disk, or one with depth", MATTERS, NULL},
        {"--backend", OPTION_CHOICE, &backend, NULL, "what traces it", BACKENDS, NULL},
        {"--help", OPTION_FLAG, &help, NULL, "this text", NULL, NULL},
    };
    const int parsed = options_parse(options, COUNT_OF(options), argc, argv);
    if (parsed != 0) {
        return parsed;
    }
    if (help) {
        printf("Usage: composite [options]\n"
               "A ship, moons and a sky of the program's own, in one picture with bhr's.\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return end_output(EXIT_SUCCESS);
    }
    if (size[0] < 1 || size[1] < 1 || size[0] > 8192 || size[1] > 8192) {
        fprintf(stderr, "%s: --size is %ux%u; each side must lie in 1 to 8192\n", argv[0], (unsigned)size[0],
                (unsigned)size[1]);
        return EXIT_USAGE;
    }
    World world;
    memset(&world, 0, sizeof world);
    world.width = size[0] * SAMPLES;
    world.height = size[1] * SAMPLES;
    const BhrStatus made = create_context_on(backend, &world.context);
    const int       result = made < 0 ? report_failure("make a context", made) : compose(&world, matter, path);
    bhr_context_destroy(world.context);
    free(world.rays);
    free(world.things);
    free(world.ghosts);
    free(world.mesh.vertices);
    free(world.mesh.triangles);
    free(world.mesh.images);
    free(world.distances);
    free(world.light);
    free(world.sky);
    free(world.depth);
    return end_output(result);
}
