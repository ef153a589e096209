/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_camera.h -- how the viewer's camera moves: by the user's hand, eased, and by itself, along the world line of a
 * falling or orbiting observer. Moves Scene.camera and Scene.time; knows no window and draws nothing. */
#ifndef EXAMPLES_VIEWER_CAMERA_H
#define EXAMPLES_VIEWER_CAMERA_H

#include "scene.h"

/* Motions that the user's hand has asked for and that are not done yet, and how the observer moves. All zero is a
 * camera at rest. */
typedef struct Pilot {
    double    turn[2];     /* about the hole: azimuth, elevation, radians */
    double    zoom;        /* change of ln(r - r_horizon) */
    double    look[2];     /* of the view: to the right, up, radians */
    double    thrust[3];   /* free flight: right, up, forward, each -1 .. 1 */
    double    boost;       /* free flight: 0, or 1 and more: faster */
    double    velocity[3]; /* free flight: the same axes, in distances to the horizon per second */
    int       flying;      /* free flight instead of orbiting by hand */
    int       centring;    /* the view turns to the hole */
    int       looked_away; /* by hand: a fall leaves the view alone then */
    int       steered;     /* the orbit and the fall begin anew from here: position, mass or spin were changed */
    int       settling;    /* still levelling, or on the way to the plane of an orbit */
    BhrMotion motion;      /* asked for; Scene.camera.motion is what holds */
    BhrCamera orbit_begin; /* the orbit's first event */
    double    orbit_proper, orbit_time; /* since then: the camera's and the scene's, scene lengths */
    double    fall_begin;               /* r where the fall began, scene lengths; 0: not falling */
} Pilot;

/* Moves the camera on by `seconds` of the user's time and `proper_time` of its own (scene lengths), which also moves
 * the scene's time by what goes by there. The context must hold the scene's mass and spin. Errors: the library's; the
 * scene is then half-way: go back to a copy. */
BhrStatus pilot_step(Pilot *pilot, Scene *scene, const BhrContext *context, double seconds, double proper_time);

/* Forgets everything that is not done yet, except for keys that are still held. */
void pilot_stop(Pilot *pilot, BhrMotion motion);

/* Whether the next step moves the camera when no time goes by. */
int pilot_is_moving(const Pilot *pilot);

#endif
