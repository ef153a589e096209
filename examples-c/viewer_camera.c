/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_camera.c -- see viewer_camera.h. */
#include "viewer_camera.h"

#include "vectors.h"

#include <math.h>
#include <string.h>

/* Time constants in seconds: what is asked for is done by the share 1 - exp(-dt / constant). */
#define EASE_HAND 0.07 /* short: the picture must hang on the mouse */
#define EASE_ZOOM 0.12
#define EASE_THRUST 0.25 /* long: a ship has weight */
#define EASE_VIEW 0.35   /* turning to the hole, levelling */

/* A motion that is asked for is done when less than this is left: */
#define SETTLED 1e-5  /* radians, and of ln r: far below a pixel */
#define IN_PLANE 1e-3 /* radians, about a pixel: the way into the plane of an orbit */
#define STOPPED 3e-4  /* of free flight's speed */

/* Free flight, in distances to the horizon per second. */
#define FLIGHT 0.4
#define FAST_FLIGHT 1.6

/* Where a camera may be. */
#define NEAREST 1.02                /* of the radius where standing or orbiting ends */
#define FARTHEST 2000.0             /* M */
#define HIGHEST (89.0 * PI / 180.0) /* elevation: at the poles up has no direction */
#define SINGULARITY 0.01            /* M: where a fall into a spin-0 hole ends */
#define ABOVE_INNER 0.01            /* of r+ - r-, above r-: where a fall into a spinning hole ends */
#define AT_HORIZON 1.00001          /* of r+: outside it azimuths of both charts are known */
#define CHART_STEPS 200             /* of the integrals between the charts; even */

/* How a fall is shown. */
#define SECONDS_PER_E_FOLD 1.5 /* slowed down where it is faster than this */
#define EDGE_AT_REST 0.3       /* of the view's height: how far the shadow reaches before the gaze rises */
#define GAZE_PER_SHADOW 1.3

/* ---- directions ---- */

/* Towards growing azimuth at a place; on the axis +y, as the library has it. */
static void east(const double position[3], double out[3]) {
    double rho = hypot(position[0], position[1]);
    out[0] = rho > 0.0 ? -position[1] / rho : 0.0;
    out[1] = rho > 0.0 ? position[0] / rho : 1.0;
    out[2] = 0.0;
}

/* ---- the camera's axes ---- */

static void camera_right(const BhrCamera *camera, double out[3]) { cross(camera->forward, camera->up, out); }

/* The whole camera about an axis through the hole: what is in the view stays where it is in the view. */
static void turn_about_hole(BhrCamera *camera, const double axis[3], double angle) {
    rotate(camera->position, axis, angle);
    rotate(camera->forward, axis, angle);
    rotate(camera->up, axis, angle);
}

/* ---- the user's hand ---- */

static double share(double seconds, double constant) { return 1.0 - exp(-seconds / constant); }

/* Takes from *pending what is done in this step. */
static double take(double *pending, double part) {
    double done = fabs(*pending) < SETTLED ? *pending : part * *pending;
    *pending -= done;
    return done;
}

static void turn_by_hand(Pilot *pilot, BhrCamera *camera, double part) {
    const double z[3] = {0.0, 0.0, 1.0};
    double       azimuth = take(&pilot->turn[0], part), climb = take(&pilot->turn[1], part);
    if (azimuth == 0.0 && climb == 0.0) {
        return;
    }
    turn_about_hole(camera, z, azimuth);
    double elevation = asin(camera->position[2] / length(camera->position));
    climb = fmax(-HIGHEST, fmin(HIGHEST, elevation + climb)) - elevation;
    double axis[3];
    east(camera->position, axis);
    turn_about_hole(camera, axis, -climb);
    pilot->steered = 1;
}

static void zoom_by_hand(Pilot *pilot, BhrCamera *camera, const BhrHoleInfo *info, double part) {
    double step = take(&pilot->zoom, part), height = info->camera_radius - info->horizon_radius;
    if (step == 0.0 || height <= 0.0) {
        return;
    }
    scale(camera->position, (info->horizon_radius + height * exp(step)) / info->camera_radius);
    pilot->steered = 1;
}

static void look_by_hand(Pilot *pilot, BhrCamera *camera, double part) {
    double yaw = take(&pilot->look[0], part), pitch = take(&pilot->look[1], part);
    if (yaw != 0.0 || pitch != 0.0) {
        pilot->looked_away = 1;
        pilot->centring = 0;
    }
    camera_turn(camera, yaw, pitch);
}

/* The speed goes with the distance to the horizon, so that a flight is as fine near it as it is swift far away. */
static void fly(Pilot *pilot, BhrCamera *camera, const BhrHoleInfo *info, double seconds) {
    const double part = share(seconds, EASE_THRUST), height = info->camera_radius - info->horizon_radius;
    const double speed = !pilot->flying ? 0.0 : pilot->boost > 0.0 ? FAST_FLIGHT : FLIGHT;
    double       right[3];
    for (int i = 0; i < 3; i++) {
        double missing = speed * pilot->thrust[i] - pilot->velocity[i];
        pilot->velocity[i] += take(&missing, part);
    }
    if (length(pilot->thrust) == 0.0 && length(pilot->velocity) < STOPPED) {
        memset(pilot->velocity, 0, sizeof pilot->velocity);
    }
    if (length(pilot->velocity) == 0.0 || height <= 0.0) {
        return;
    }
    camera_right(camera, right);
    add(camera->position, pilot->velocity[0] * height * seconds, right);
    add(camera->position, pilot->velocity[1] * height * seconds, camera->up);
    add(camera->position, pilot->velocity[2] * height * seconds, camera->forward);
    pilot->steered = 1;
}

/* Where the middle of the view looks, in the frame in which places and directions are given: an orbiting observer sees
 * the hole where aberration has shifted it to, not where it lies. (A falling one moves along the line to the hole.) */
static void seen_ahead(const BhrContext *context, const BhrCamera *camera, double out[3]) {
    BhrRay middle;
    int    shifted = camera->motion == BHR_MOTION_ORBIT || camera->motion == BHR_MOTION_VELOCITY;
    memcpy(out, camera->forward, sizeof middle.direction);
    if (shifted && bhr_camera_ray(context, 2, 2, 1.0, 1.0, &middle) >= 0) {
        memcpy(out, middle.direction, sizeof middle.direction);
    }
    scale(out, 1.0 / length(out));
}

/* Angular radius of the shadow that an observer falling from rest at infinity sees, spin 0, at any r: the look angle x
 * from the hole with b(x) = r sin x / (1 - sqrt(2 M / r) cos x) = 3 sqrt(3) M, in Painleve-Gullstrand coordinates. With
 * spin it is near enough to aim a view. */
static double falling_shadow(double r) { /* M = 1 */
    const double sine = 3.0 * sqrt(3.0) / r, cosine = sine * sqrt(2.0 / r);
    const double peak = asin(fmin(1.0, sine / hypot(1.0, cosine)));
    return (r > 3.0 ? peak : PI - peak) - atan(cosine);
}

/* How far above the hole's middle to look: close to the hole a fall would show nothing but black, so the gaze rises
 * with the shadow's edge, and in the end above it. */
static double gaze_above_hole(const Scene *scene) {
    if (scene->camera.motion != BHR_MOTION_FREE_FALL) {
        return 0.0;
    }
    double shadow = falling_shadow(length(scene->camera.position) / scene->mass);
    return fmax(0.0, GAZE_PER_SHADOW * (shadow - EDGE_AT_REST * scene->camera.fov_y));
}

static void turn_to_hole(Pilot *pilot, Scene *scene, const BhrContext *context, double part) {
    BhrCamera *camera = &scene->camera;
    double     ahead[3], towards[3], right[3], axis[3];
    seen_ahead(context, camera, ahead);
    memcpy(towards, camera->position, sizeof towards);
    scale(towards, -1.0 / length(towards));
    camera_right(camera, right);
    rotate(towards, right, gaze_above_hole(scene));
    cross(ahead, towards, axis);
    double angle = atan2(length(axis), dot(ahead, towards));
    if (angle < SETTLED) {
        pilot->centring = 0;
        return;
    }
    if (length(axis) < 1e-9) { /* straight away from it: any way round is as good */
        memcpy(axis, camera->up, sizeof axis);
    }
    scale(axis, 1.0 / length(axis));
    rotate(camera->forward, axis, part * angle);
    rotate(camera->up, axis, part * angle);
}

/* Rolls the camera until `vertical` stands upright in the picture; does less the less upright it can stand. 1 while it
 * rolls. */
static int level(BhrCamera *camera, const double vertical[3], double part) {
    double right[3];
    camera_right(camera, right);
    double across = dot(vertical, right), upright = dot(vertical, camera->up);
    double roll = atan2(across, upright) * fmin(1.0, 4.0 * (across * across + upright * upright));
    int    settled = fabs(roll) < SETTLED;
    rotate(camera->up, camera->forward, settled ? roll : part * roll);
    return !settled;
}

/* ---- where an observer can be ---- */

static void set_radius(BhrCamera *camera, double radius) { scale(camera->position, radius / length(camera->position)); }

/* r- of a hole, M = 1. */
static double inner_horizon(double spin) { return spin * spin / (1.0 + sqrt((1.0 - spin) * (1.0 + spin))); }

static double smallest_radius(const Scene *scene, const BhrHoleInfo *info) {
    switch (scene->camera.motion) {
    case BHR_MOTION_FREE_FALL:
        if (scene->spin != 0.0) {
            const double inner = inner_horizon(scene->spin);
            return scene->mass * (inner + ABOVE_INNER * (2.0 - 2.0 * inner)); /* r+ + r- = 2 M */
        }
        return SINGULARITY * scene->mass;
    case BHR_MOTION_ORBIT:
        return NEAREST * info->photon_orbit_prograde;
    default:
        return NEAREST * info->horizon_radius;
    }
}

/* A change of mass, spin or motion, and flying on, can lead to where the observer cannot be: it is held outside. */
static void keep_outside(Pilot *pilot, Scene *scene, const BhrHoleInfo *info) {
    double radius = length(scene->camera.position);
    double nearest = smallest_radius(scene, info), farthest = FARTHEST * scene->mass;
    if (radius < nearest || radius > farthest) {
        set_radius(&scene->camera, radius < nearest ? nearest : farthest);
        pilot->steered = 1;
    }
}

/* ---- charts (docs/cameras.md) ---- */

/* Azimuth and time of the chart RAIN less those of STATIC at a radius outside the horizon, M = 1. With v = r^(-1/2),
 * u = v^2, D = 1 - 2 u + a^2 u^2 and q = sqrt(1 + a^2 u^2) they are
 *     -2 sqrt(2) integral of a u / (q D) dv
 *     2 sqrt(2) / v - 2 sqrt(2) integral of (2 - a^2 u + a^2 u / (1 + q)) / D dv
 * from 0 to v: by Simpson's rule in s, v = v+ (1 - e^-s), in which the horizon is far away. */
static void chart_offsets(double spin, double radius, double *azimuth, double *time) {
    const double a2 = spin * spin, v_horizon = 1.0 / sqrt(2.0 - inner_horizon(spin)), v_end = 1.0 / sqrt(radius);
    const double step = -log(1.0 - v_end / v_horizon) / CHART_STEPS, root = sqrt(8.0);
    *azimuth = 0.0;
    *time = root / v_end;
    for (int i = 0; i <= CHART_STEPS; i++) {
        const double left = exp(-i * step), v = v_horizon * (1.0 - left), u = v * v, q = sqrt(1.0 + a2 * u * u);
        const double weight = (i == 0 || i == CHART_STEPS ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * step / 3.0;
        const double part = -root * weight * v_horizon * left / (1.0 - 2.0 * u + a2 * u * u);
        *azimuth += part * spin * u / q;
        *time += part * (2.0 - a2 * u + a2 * u / (1.0 + q));
    }
}

/* An observer who falls into a spinning hole is told in the chart RAIN, in which nothing winds up at the horizon, all
 * others in STATIC. Whatever the chart, the picture is the same: the camera turns about the axis, its clock is set. */
static void choose_chart(Scene *scene) {
    BhrCamera     *camera = &scene->camera;
    const int      falls = camera->motion == BHR_MOTION_FREE_FALL && scene->spin != 0.0;
    const BhrChart chart = falls ? BHR_CHART_RAIN : BHR_CHART_STATIC;
    const double   radius = length(camera->position) / scene->mass, sign = falls ? 1.0 : -1.0;
    if (camera->chart == chart) {
        return;
    }
    camera->chart = chart;
    if (radius > AT_HORIZON * (2.0 - inner_horizon(scene->spin))) { /* inside, spin is 0, and there is no difference */
        double azimuth, time, axis[3];
        chart_offsets(scene->spin, radius, &azimuth, &time);
        memcpy(axis, scene->axis, sizeof axis);
        scale(axis, 1.0 / length(axis));
        turn_about_hole(camera, axis, sign * azimuth);
        scene->time += sign * time * scene->mass;
    }
}

/* ---- the observer's own motion ---- */

static BhrStatus stand(Scene *scene, const BhrContext *context, double proper_time) {
    double    time;
    BhrStatus status = bhr_camera_advance(context, &scene->camera, proper_time, &time);
    scene->time += time;
    return status;
}

/* The height above the fall's end shrinks by no more than a factor e in SECONDS_PER_E_FOLD: at the horizon and in the
 * last moments proper time is shown in slow motion. The speed of a fall from rest at infinity is sqrt(2 M / r). */
static double slow_motion(const Scene *scene, double seconds, double proper_time) {
    double end = scene->mass * inner_horizon(scene->spin), radius = length(scene->camera.position);
    double most = seconds / SECONDS_PER_E_FOLD * (radius - end) * sqrt(radius / (2.0 * scene->mass));
    return fmax(-most, fmin(most, proper_time));
}

static BhrStatus fall(Pilot *pilot, Scene *scene, const BhrContext *context, const BhrHoleInfo *info, double seconds,
                      double proper_time) {
    double radius = length(scene->camera.position), time;
    if (pilot->fall_begin == 0.0 || (pilot->steered && radius > info->horizon_radius)) {
        pilot->fall_begin = fmax(radius, 6.0 * scene->mass);
    }
    if (radius <= 1.001 * smallest_radius(scene, info) && proper_time > 0.0) {
        printf(scene->spin == 0.0 ? "the singularity is reached; the fall begins again outside\n"
                                  : "the inner horizon is reached; the fall begins again outside\n");
        set_radius(&scene->camera, pilot->fall_begin);
    } else if (radius >= 0.999 * FARTHEST * scene->mass && proper_time < 0.0) {
        return BHR_OK; /* time runs backward, and the fall came from infinity */
    }
    proper_time = slow_motion(scene, seconds, proper_time);
    BhrStatus status = bhr_camera_advance(context, &scene->camera, proper_time, &time);
    scene->time += time;
    return status;
}

/* With spin only orbits in the equatorial plane are circles: the camera is led there. 1 when it is there. */
static int is_on_circle(Pilot *pilot, const Scene *scene, BhrCamera *camera, double part) {
    double elevation = asin(camera->position[2] / length(camera->position)), axis[3];
    if (scene->spin == 0.0 || elevation == 0.0) {
        return 1;
    }
    int arrived = fabs(elevation) < IN_PLANE;
    east(camera->position, axis);
    turn_about_hole(camera, axis, arrived ? elevation : part * elevation);
    if (arrived) {
        camera->position[2] = 0.0; /* exactly: what rounding leaves would be off the plane */
    }
    pilot->steered = 1;
    return arrived;
}

/* The normal of the orbit's plane: radially outward x along the orbit. */
static void orbit_normal(const Pilot *pilot, double out[3]) {
    double ahead[3];
    east(pilot->orbit_begin.position, ahead);
    cross(pilot->orbit_begin.position, ahead, out);
    scale(out, 1.0 / length(out));
}

/* bhr's ORBIT leaves every place towards +ph. Advanced frame by frame from where it is, an inclined orbit would thus
 * set out again in every frame and follow no geodesic: so it is advanced from its first event, and in between the
 * camera moves with VELOCITY, along the great circle. */
static BhrStatus orbit(Pilot *pilot, Scene *scene, const BhrContext *context, double proper_time) {
    BhrCamera *camera = &scene->camera;
    if (pilot->steered) {
        pilot->orbit_begin = *camera;
        pilot->orbit_begin.motion = BHR_MOTION_ORBIT;
        pilot->orbit_proper = pilot->orbit_time = 0.0;
    }
    BhrCamera now = pilot->orbit_begin;
    double    time;
    pilot->orbit_proper += proper_time;
    BhrStatus status = bhr_camera_advance(context, &now, pilot->orbit_proper, &time);
    if (status < 0) {
        return status;
    }
    scene->time += time - pilot->orbit_time;
    pilot->orbit_time = time;

    double normal[3], ahead[3];
    orbit_normal(pilot, normal);
    cross(normal, camera->position, ahead);
    turn_about_hole(camera, normal, atan2(dot(now.position, ahead), dot(now.position, camera->position)));
    memcpy(camera->position, now.position, sizeof camera->position);
    camera->motion = BHR_MOTION_ORBIT;
    if (pilot->orbit_begin.position[2] != 0.0) { /* inclined: spin is 0 */
        camera->motion = BHR_MOTION_VELOCITY;
        cross(normal, camera->position, camera->velocity);
        double radius = length(camera->position);
        scale(camera->velocity, 1.0 / (radius * sqrt(radius / scene->mass - 2.0)));
    }
    return BHR_OK;
}

/* ---- a step ---- */

static void steer(Pilot *pilot, Scene *scene, const BhrContext *context, const BhrHoleInfo *info, double seconds) {
    BhrCamera *camera = &scene->camera;
    turn_by_hand(pilot, camera, share(seconds, EASE_HAND));
    zoom_by_hand(pilot, camera, info, share(seconds, EASE_ZOOM));
    look_by_hand(pilot, camera, share(seconds, EASE_HAND));
    fly(pilot, camera, info, seconds);
    if (scene->camera.motion == BHR_MOTION_FREE_FALL && !pilot->looked_away) {
        pilot->centring = 1; /* the gaze goes with the shadow */
    }
    if (pilot->centring) {
        turn_to_hole(pilot, scene, context, share(seconds, EASE_VIEW));
    }
}

static void upright(Pilot *pilot, Scene *scene, double seconds) {
    double vertical[3] = {0.0, 0.0, 1.0};
    if (scene->camera.motion == BHR_MOTION_VELOCITY) {
        orbit_normal(pilot, vertical);
    }
    pilot->settling |= level(&scene->camera, vertical, share(seconds, EASE_VIEW));
    camera_make_orthonormal(&scene->camera);
}

BhrStatus pilot_step(Pilot *pilot, Scene *scene, const BhrContext *context, double seconds, double proper_time) {
    BhrHoleInfo info;
    BHR_INIT(info);
    BhrStatus   status = bhr_hole_info(context, &info);
    if (status < 0) {
        return status;
    }
    const BhrMotion before = scene->camera.motion;
    pilot->settling = 0;
    steer(pilot, scene, context, &info, seconds);
    scene->camera.motion = pilot->motion;
    if (pilot->motion == BHR_MOTION_ORBIT && !is_on_circle(pilot, scene, &scene->camera, share(seconds, EASE_VIEW))) {
        scene->camera.motion = BHR_MOTION_STATIC;
        pilot->settling = 1;
    }
    if (pilot->motion != BHR_MOTION_FREE_FALL) {
        pilot->fall_begin = 0.0;
    }
    keep_outside(pilot, scene, &info);
    choose_chart(scene);
    switch (scene->camera.motion) {
    case BHR_MOTION_FREE_FALL:
        status = fall(pilot, scene, context, &info, seconds, proper_time);
        break;
    case BHR_MOTION_ORBIT:
        status = orbit(pilot, scene, context, proper_time);
        break;
    default:
        status = stand(scene, context, proper_time);
        break;
    }
    if (scene->camera.motion != before && !pilot->looked_away && !pilot->flying) {
        pilot->centring = 1; /* aberration has moved the hole aside */
    }
    upright(pilot, scene, seconds);
    pilot->steered = 0;
    return status;
}

void pilot_stop(Pilot *pilot, BhrMotion motion) {
    Pilot idle = {.motion = motion, .steered = 1, .boost = pilot->boost};
    memcpy(idle.thrust, pilot->thrust, sizeof idle.thrust);
    *pilot = idle;
}

int pilot_is_moving(const Pilot *pilot) {
    return pilot->turn[0] != 0.0 || pilot->turn[1] != 0.0 || pilot->zoom != 0.0 || pilot->look[0] != 0.0 ||
           pilot->look[1] != 0.0 || pilot->centring || pilot->settling || length(pilot->velocity) != 0.0 ||
           (pilot->flying && length(pilot->thrust) != 0.0);
}
