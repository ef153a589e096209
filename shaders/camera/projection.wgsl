// SPDX-License-Identifier: MIT OR Apache-2.0
// How the camera's projection takes positions of the full frame, in pixels, to look directions. Mirrors
// src/scene/projection.rs, where the formulas and conventions are.

#import constants
#import shared/not_inlined
#import shared/frame
#import shared/math

// The BHR_PROJECTION_* that the kernel is made for, or FROM_UNIFORM where it serves all and the uniform says which.
override PROJECTION: u32 = 0u;

// A point (right, up, forward; PERSPECTIVE: the first two in halves of the image plane's sides) in the direction seen,
// and its changes to the next pixel right and down.
struct FramePoint {
    at: vec3<f32>,
    dx: vec3<f32>,
    dy: vec3<f32>,
}

// A look direction, components in the camera's own frame, and its changes to the next pixel right and down but for
// what they hold along it.
struct CameraView {
    look: vec3<f32>,
    dx: vec3<f32>,
    dy: vec3<f32>,
}

fn is_perspective() -> bool {
    if PROJECTION == FROM_UNIFORM {
        return not_inlined(frame.projection) == PERSPECTIVE;
    }
    return PROJECTION == PERSPECTIVE;
}

fn is_fisheye() -> bool {
    if PROJECTION == FROM_UNIFORM {
        return not_inlined(frame.projection) == FISHEYE;
    }
    return PROJECTION == FISHEYE;
}

fn is_equirect() -> bool {
    if PROJECTION == FROM_UNIFORM {
        return not_inlined(frame.projection) == EQUIRECT;
    }
    return PROJECTION == EQUIRECT;
}

fn is_cube() -> bool {
    if PROJECTION == FROM_UNIFORM {
        return not_inlined(frame.projection) == CUBE;
    }
    return PROJECTION == CUBE;
}

// No early returns here: look_direction is called from loops (Mesa 22.3).
fn camera_point(x: f32, y: f32) -> FramePoint {
    var p: FramePoint;
    if is_fisheye() {
        p = fisheye_point(x, y);
    } else if is_equirect() {
        p = equirect_point(x, y);
    } else if is_cube() {
        p = cube_point(x, y);
    } else {
        p.at = vec3<f32>(2.0 * x / frame.size.x - 1.0, 1.0 - 2.0 * y / frame.size.y, 1.0);
        p.dx = vec3<f32>(2.0 / frame.size.x, 0.0, 0.0);
        p.dy = vec3<f32>(0.0, -2.0 / frame.size.y, 0.0);
    }
    return p;
}

fn in_frame(p: vec3<f32>) -> vec3<f32> {
    return frame.right * p.x + frame.up.xyz * p.y + frame.forward.xyz * p.z;
}

fn look_direction(x: f32, y: f32) -> vec3<f32> {
    return normalize(in_frame(camera_point(x, y).at));
}

fn camera_view(x: f32, y: f32) -> CameraView {
    let p = camera_point(x, y);
    let ray = in_frame(p.at);
    let inverse = inverseSqrt(dot(ray, ray));
    // Most of a perspective frame's components are 0, which no compiler may leave out.
    var dx = frame.right * p.dx.x;
    var dy = frame.up.xyz * p.dy.y;
    if !is_perspective() {
        dx = in_frame(p.dx);
        dy = in_frame(p.dy);
    }
    return CameraView(ray * inverse, dx * inverse, dy * inverse);
}

// Whether something is seen at a position: all but what lies outside a fisheye's circle.
fn has_look_direction(place: vec2<f32>) -> bool {
    let p = place - 0.5 * frame.size;
    let radius = 0.5 * min(frame.size.x, frame.size.y);
    return !is_fisheye() || dot(p, p) <= radius * radius;
}

// Whether no border between two faces of a cube lies between positions of a row.
fn same_face(x0: f32, x1: f32) -> bool {
    return !is_cube() || cube_face(x0) == cube_face(x1);
}

// right.w is the angle of a pixel along the radius.
fn fisheye_point(x: f32, y: f32) -> FramePoint {
    let from_centre = vec2<f32>(x - 0.5 * frame.size.x, 0.5 * frame.size.y - y);
    let radius = length(from_centre);
    let scale = frame.pixel_angle;
    let turn = sincos(scale * radius);
    let centre = radius <= 0.0;
    let outward = select(from_centre / max(radius, 1e-30), vec2<f32>(1.0, 0.0), centre);
    let across = select(turn.x / max(radius, 1e-30), scale, centre);
    // Steps (1, 0) and (0, -1).
    let right = outward * outward.x;
    let down = -outward * outward.y;
    let dx = right * (scale * turn.y) + (vec2<f32>(1.0, 0.0) - right) * across;
    let dy = down * (scale * turn.y) + (vec2<f32>(0.0, -1.0) - down) * across;
    return FramePoint(vec3<f32>(outward * turn.x, turn.y), vec3<f32>(dx, -scale * outward.x * turn.x),
        vec3<f32>(dy, scale * outward.y * turn.x));
}

fn equirect_point(x: f32, y: f32) -> FramePoint {
    let longitude = sincos_turn(x - 0.5 * frame.size.x, frame.size.x);
    let latitude = sincos_turn(0.5 * frame.size.y - y, 2.0 * frame.size.y);
    let around = latitude.y * TAU / frame.size.x;
    let down = PI / frame.size.y;
    return FramePoint(vec3<f32>(latitude.y * longitude.x, latitude.x, latitude.y * longitude.y),
        vec3<f32>(longitude.y, 0.0, -longitude.x) * around,
        vec3<f32>(latitude.x * longitude.x, -latitude.y, latitude.x * longitude.y) * down);
}

fn cube_face(x: f32) -> f32 {
    return clamp(floor((floor(x) + 0.5) / frame.size.y), 0.0, 5.0);
}

fn cube_point(x: f32, y: f32) -> FramePoint {
    let face = cube_face(x);
    let step = 2.0 / frame.size.y;
    let at = vec3<f32>((x - face * frame.size.y) * step - 1.0, 1.0 - y * step, 1.0);
    return FramePoint(turned_to_face(u32(face), at), turned_to_face(u32(face), vec3<f32>(step, 0.0, 0.0)),
        turned_to_face(u32(face), vec3<f32>(0.0, -step, 0.0)));
}

// Turns a point from the forward face to one of the faces right, left, up, down, front, back.
fn turned_to_face(face: u32, p: vec3<f32>) -> vec3<f32> {
    let s = select(1.0, -1.0, (face & 1u) == 1u);
    let ahead = vec3<f32>(s * p.x, p.y, s * p.z);
    let beside = vec3<f32>(ahead.z, p.y, -ahead.x);
    let above = vec3<f32>(p.x, ahead.z, -s * p.y);
    return select(select(ahead, above, face < 4u), beside, face < 2u);
}
