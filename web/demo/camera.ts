// SPDX-License-Identifier: MIT OR Apache-2.0
// camera.ts -- the camera as a place in orbit about the hole and a look aside from it, as bhr_camera_orbit has it and
// the `turn` of scene files (docs/scenes.md). Angles in radians. Knows no page.

import type { Settings } from "./bhr/index.js";
import { numberIn, type Values } from "./values.js";

export interface Pose {
    distance: number;
    azimuth: number;
    elevation: number;
    /** The look aside: first to the right, then up, then rolled clockwise. */
    right: number;
    up: number;
    roll: number;
}

type Triple = readonly [number, number, number];

const dot = (a: Triple, b: Triple): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Triple, b: Triple): Triple => [
    a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0],
];
const scaled = (a: Triple, by: number): Triple => [a[0] * by, a[1] * by, a[2] * by];
const unit = (a: Triple): Triple => scaled(a, 1 / Math.hypot(...a));

/** Poles are left out: there the picture would turn about at a touch. */
const STEEPEST = (89.9 * Math.PI) / 180;

/** The pose of a camera that was set by position and forward, as scene files and links may. */
function poseOfPlace(position: Triple, forward: Triple, up: Triple): Pose {
    const distance = Math.hypot(...position);
    const azimuth = Math.atan2(position[1], position[0]);
    const elevation = Math.asin(Math.min(1, Math.max(-1, position[2] / distance)));
    // The camera that only orbits: it looks at the hole, with z upwards in the picture.
    const ahead = scaled(position, -1 / distance);
    const side = unit([-Math.sin(azimuth), Math.cos(azimuth), 0]);
    const above = cross(side, ahead);
    const look = unit(forward);
    const right = Math.atan2(dot(look, side), dot(look, ahead));
    const height = Math.asin(Math.min(1, Math.max(-1, dot(look, above))));
    // A camera that is not rolled has its right in the plane of `side` and `ahead`.
    const level: Triple = unit([0, 1, 2].map((i) =>
        Math.cos(right) * (side[i] as number) - Math.sin(right) * (ahead[i] as number)) as unknown as Triple);
    const own = unit(cross(look, up));
    const roll = Math.atan2(-dot(own, cross(level, look)), dot(own, level));
    const tidy = (angle: number) => (Math.abs(angle) < 1e-9 ? 0 : angle);
    return { distance, azimuth, elevation, right: tidy(right), up: tidy(height), roll: tidy(roll) };
}

/** The camera of a new scene, at (0, 26, 2.5). */
export const USUAL: Pose = poseOfPlace([0, 26, 2.5], [0, -26, -2.5], [0, 0, 1]);

/** Where the camera is without the way that it has moved by itself. `values`: of the whole scene. */
export function poseOf(settings: Settings, values: Values): Pose {
    const camera = settings.camera ?? {};
    const turn = camera.turn ?? {};
    if (camera.orbit !== undefined) {
        const { distance, azimuth = 0, elevation = 0 } = camera.orbit;
        return { distance, azimuth, elevation, right: turn.right ?? 0, up: turn.up ?? 0, roll: turn.roll ?? 0 };
    }
    const whole = values.sections.camera ?? {};
    const position = (camera.position ?? whole.position) as Triple;
    const aim = camera.look_at ?? [0, 0, 0];
    const inward: Triple = [aim[0] - position[0], aim[1] - position[1], aim[2] - position[2]];
    // The text's forward has the turn in it, and the way that was fallen.
    const forward = camera.forward ?? inward;
    const pose = poseOfPlace(position, forward, camera.up ?? [0, 0, 1]);
    return { ...pose, right: pose.right + (turn.right ?? 0), up: pose.up + (turn.up ?? 0),
        roll: pose.roll + (turn.roll ?? 0) };
}

const wrapped = (angle: number): number => Math.atan2(Math.sin(angle), Math.cos(angle));
/** Links stay short: a ten-millionth of a radian is less than a pixel of any picture. */
const short = (value: number): number => Number(value.toPrecision(7));

/** What sets a pose, and takes back other names of the same. */
export function settingsOf(pose: Pose): Settings {
    const { distance, azimuth, elevation, right, up, roll } = pose;
    const turn = Object.fromEntries(
        Object.entries({ right, up, roll })
            .map(([name, angle]) => [name, short(wrapped(angle))] as const)
            .filter(([, angle]) => angle !== 0),
    );
    const orbit = { distance: short(distance), azimuth: short(wrapped(azimuth)), elevation: short(elevation) };
    const none = { position: undefined, forward: undefined, up: undefined, look_at: undefined };
    return {
        camera: { ...none, orbit, turn: Object.keys(turn).length > 0 ? turn : undefined },
    } as unknown as Settings;
}

/** How far the camera may go. At rest it stays outside the horizon. */
export function clamped(pose: Pose, horizon: number, mass: number): Pose {
    const distance = Math.min(5000 * mass, Math.max(1.02 * horizon, pose.distance));
    const elevation = Math.min(STEEPEST, Math.max(-STEEPEST, pose.elevation));
    return { ...pose, distance, elevation };
}

/** The vertical field of view that shows, in a frame of one shape, what a wider one has from side to side. */
function fitted(fovY: number, aspect: number, made: number): number {
    // Upright frames cut the outer disk: a wider view would make the hole small, and stretch what is at the border.
    const widest = Math.min(2.2, Math.max(1, made / aspect));
    return Math.min(2.6, 2 * Math.atan(Math.tan(fovY / 2) * widest));
}

/** The same for a whole scene, of which only flat pictures depend on the frame's shape. */
export function withFittedView(settings: Settings, values: Values, aspect: number, made = 1.6): Settings {
    const camera = values.sections.camera;
    if (camera?.projection !== "perspective") {
        return settings;
    }
    const fov_y = short(fitted(numberIn(camera, "fov_y"), aspect, made));
    return { ...settings, camera: { ...settings.camera, fov_y } };
}
