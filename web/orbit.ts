// SPDX-License-Identifier: MIT OR Apache-2.0
// orbit.ts -- where a scene's camera stands, as distance, azimuth and elevation (bhr_camera_orbit), whatever way the
// scene says it. Angles in radians. Knows no page.

import type { Camera, Vector } from "./scene.js";
import { isTable, type CameraPlace, type Settings, type Value } from "./settings.js";

/** A place about the hole. */
export interface Orbit {
    distance: number;
    azimuth: number;
    elevation: number;
}

/** What the elevation keeps below, so that up stays up. */
const STEEPEST = 89.5 * (Math.PI / 180);

/** The angle that a scene says: radians, or text as "45 deg". */
function radians(value: Value | undefined): number {
    const degrees = typeof value === "string" ? /^\s*(\S+)\s*deg\s*$/.exec(value)?.[1] : undefined;
    return degrees === undefined ? Number(value ?? 0) : Number(degrees) * (Math.PI / 180);
}

/** The place of the settings' camera, and of `usual`, its place in a new scene, where they name none. */
export function orbitOf(camera: Settings["camera"], usual: Vector): Orbit {
    const orbit = camera?.orbit as Value | undefined;
    if (isTable(orbit)) {
        const { distance, azimuth, elevation } = orbit;
        return { distance: Number(distance), azimuth: radians(azimuth), elevation: radians(elevation) };
    }
    const [x = 0, y = 0, z = 0] = (camera?.position ?? usual).map(Number);
    const distance = Math.hypot(x, y, z);
    return { distance, azimuth: Math.atan2(y, x), elevation: Math.asin(z / (distance || 1)) };
}

/** A camera that stands there and looks at the hole, in place of what another one says about place and direction. */
export function placed(
    { distance, azimuth, elevation }: Orbit,
    camera: Settings["camera"] = {},
): Partial<Camera & CameraPlace> {
    const { position: _, forward: __, up: ___, proper_time: ____, ...rest } = camera;
    return { ...rest, orbit: { distance, azimuth, elevation } };
}

/** The place after a turn by angles and a change of the distance by a factor. */
export function moved(orbit: Orbit, azimuth: number, elevation: number, factor: number): Orbit {
    const steep = orbit.elevation + elevation;
    return {
        // An angle of one turn at most keeps links short.
        azimuth: Math.atan2(Math.sin(orbit.azimuth + azimuth), Math.cos(orbit.azimuth + azimuth)),
        elevation: Math.min(Math.max(steep, -STEEPEST), STEEPEST),
        distance: orbit.distance * factor,
    };
}
