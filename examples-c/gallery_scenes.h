/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gallery_scenes.h -- the gallery's scenes: what the renderer can show, each in a few lines. Makes no frame. */
#ifndef EXAMPLES_GALLERY_SCENES_H
#define EXAMPLES_GALLERY_SCENES_H

#include "scene.h"

typedef struct Exhibit {
    const char *name;
    const char *about;
    uint32_t    shape[2]; /* width : height */
    BhrPreset   look;     /* that the scene begins with */
    BhrStatus (*describe)(Scene *scene);
} Exhibit;

extern const Exhibit EXHIBITS[];
extern const size_t  EXHIBIT_COUNT;

/* The scenes begin with this. */
extern const SceneOptions GALLERY_BEGINNING;

#endif
