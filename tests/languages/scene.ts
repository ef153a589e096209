// SPDX-License-Identifier: MIT OR Apache-2.0
// scene.ts -- a page's scene in the types of web/scene.d.ts. Each line below "expect" is a mistake that tsc must find:
// it complains of those that it takes.
import type { Camera, Disk, Film, HotSpot, Quality, Region, Sky, Vector, Volume } from "../../web/scene";
import type { Effect, Preset, View } from "../../web/words";

interface Scene {
    preset?: Preset;
    view?: View;
    effects?: readonly Effect[];
    camera?: Partial<Camera>;
    disk?: Partial<Disk> | false;
    volumes?: readonly Partial<Volume>[];
    hot_spots?: readonly Partial<HotSpot>[];
    sky?: Partial<Sky>;
    film?: Partial<Film>;
    quality?: Partial<Quality>;
    region?: Region;
}

const up: Vector = [0, 0, 1];
export const scene: Scene = {
    preset: "cinematic",
    view: "optical_depth",
    effects: ["beaming", "light_delay"],
    camera: { up, motion: "free_fall", projection: "fisheye", jitter: [0.5, 0] },
    disk: { flags: ["retrograde", "plunges"], reference: "at_median", seed: 18446744073709551615n },
    volumes: [{ shape: "torus", tint: [1, 0.5, 0.2], flags: ["power_law"] }],
    hot_spots: [{ radius: 7, flags: ["thermal"] }],
    sky: { flags: ["stars", "milky_way"], orientation: [0, 0, 0, 1] },
    film: { tone_map: "agx", exposure_ev: -1.5 },
    quality: { method: "rk4", volume_resolution: "half" },
    region: { full_width: 8192, full_height: 8192, x: 0, y: 4096 },
};

export const mistakes: Scene[] = [
    // @ts-expect-error
    { view: "heat" },
    // @ts-expect-error
    { camera: { motion: "falling" } },
    // @ts-expect-error
    { camera: { position: [1, 2] } },
    // @ts-expect-error
    { disk: { flags: "plunges" } },
    // @ts-expect-error
    { film: { exposure: 1 } },
    // @ts-expect-error
    { region: { full_width: 8192 } },
];
