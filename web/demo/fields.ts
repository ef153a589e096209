// SPDX-License-Identifier: MIT OR Apache-2.0
// fields.ts -- what the panel shows, in which order, and how far its sliders reach. Names, units, ranges, defaults and
// comments are those of the package's types (schema.ts, made by schema.mjs); this file adds what they do not say.

import { SCHEMA, WORDS } from "./schema.js";

/** A value of a choice, or a flag. */
export interface Word {
    word: string;
    about: string;
}

/** A field of a scene, as the package's types have it. */
export interface Field {
    name: string;
    kind: "number" | "choice" | "flags" | "vector" | "seed";
    about: string;
    range?: readonly number[];
    unit?: string;
    usual?: unknown;
    words?: readonly Word[];
}

/** A slider's ends. A logarithmic one begins above 0. */
export interface Reach {
    least: number;
    most: number;
    isLog?: boolean;
}

/** A row of the panel. */
export interface Row extends Field {
    label: string;
    reach: Reach;
    /** Shown numbers are the scene's times this: angles are shown in degrees. */
    scale: number;
    shownUnit: string;
}

const DEGREES = 180 / Math.PI;

const log = (least: number, most: number): Reach => ({ least, most, isLog: true });
const even = (least: number, most: number): Reach => ({ least, most });

/**
 * The useful part of ranges that reach further, in the scene's units. A log scale's lowest end stands for 0 where 0
 * means something by itself.
 */
const REACHES: Record<string, Reach> = {
    "hole.spin": even(-0.999, 0.999),
    "hole.mass": log(0.05, 20),
    "camera.fov_y": even(0.05, 2.8),
    "disk.inner_radius": even(0, 20),
    "disk.outer_radius": even(2, 60),
    "disk.temperature": log(1000, 40000),
    "disk.brightness": log(0.01, 10),
    "disk.seed": even(0, 99),
    "volumes.inner_radius": even(0, 20),
    "volumes.outer_radius": log(2, 200),
    "volumes.radius": log(1, 50),
    "volumes.width": log(0.2, 20),
    "volumes.thickness": log(0.01, 2),
    "volumes.absorption": log(0.001, 30),
    "volumes.temperature": log(1000, 40000),
    "volumes.brightness": log(0.01, 30),
    "volumes.seed": even(0, 99),
    "hot_spots.radius": log(1, 40),
    "hot_spots.size": log(0.05, 5),
    "hot_spots.azimuth": even(-Math.PI, Math.PI),
    "hot_spots.absorption": log(0.001, 30),
    "hot_spots.temperature": log(1000, 40000),
    "hot_spots.brightness": log(0.01, 100),
    "hot_spots.time": even(-200, 200),
    "sky.stars_brightness": log(0.01, 10),
    "sky.map_brightness": log(0.01, 10),
    "sky.seed": even(0, 99),
    "film.exposure_ev": even(-8, 8),
    "film.white_balance": even(0, 15000),
    "film.auto_target": log(0.01, 4),
    "film.auto_adaptation": even(0.01, 1),
    "film.shoulder_strength": even(0, 10),
    "film.grain_seed": even(0, 99),
    "film.spike_angle": even(-Math.PI, Math.PI),
    "film.beam_fwhm": even(0, 0.5),
};

const UNITS: Record<string, string> = { rad: "°", "scene length": "len", "frame height": "h", pixel: "px" };

type Section = keyof typeof SCHEMA;

/** A field as a row. */
export function rowOf(section: string, field: Field): Row {
    const isAngle = field.unit === "rad";
    const [low, high] = field.range ?? [];
    const reach = REACHES[`${section}.${field.name}`] ?? even(low ?? -10, high ?? 10);
    const name = field.name.replace(/_ev$/, "").replace("fov_y", "field of view").replace("fwhm", "FWHM");
    const label = name.replaceAll("_", " ");
    const shownUnit = UNITS[field.unit ?? ""] ?? field.unit ?? "";
    return { ...field, label, reach, scale: isAngle ? DEGREES : 1, shownUnit };
}

/** Rows of a section by name; without names, all but those. */
export function rows(section: Section, names?: readonly string[], isRest = false): Row[] {
    const fields = SCHEMA[section].filter(({ name }) => names === undefined || names.includes(name) !== isRest);
    if (names !== undefined && !isRest) {
        const order = (field: Field) => names.indexOf(field.name);
        return [...fields].sort((one, other) => order(one) - order(other)).map((field) => rowOf(section, field));
    }
    return fields.map((field) => rowOf(section, field));
}

/** Rows of the hole, which bhr.h sets by functions of their own. */
export const HOLE: readonly Row[] = [
    rowOf("hole", {
        name: "spin", kind: "number", unit: "a / M", range: [-0.9999, 0.9999], usual: 0,
        about: "The angular momentum a of the hole, over its mass M. At 0 space-time is Schwarzschild's, else Kerr's. "
            + "A disk's own light keeps it at 0.998 or below (Thorne 1974).",
    }),
    rowOf("hole", {
        name: "mass", kind: "number", unit: "len", range: [1e-100, 1e100], usual: 1,
        about: "The length that M = G m / c² is in the scene. All else that is told in M grows with it.",
    }),
    rowOf("hole", {
        name: "axis", kind: "vector", usual: [0, 0, 1],
        about: "The direction of the spin, and the disk's axis, of any length.",
    }),
];

/** Scene values that stand in no section. */
export const VIEW: Row = rowOf("", {
    name: "view", kind: "choice", words: WORDS.view, usual: "light",
    about: "The quantity that pixels show. All but light are in false colour, without the film.",
});
export const EFFECTS: Row = rowOf("", {
    name: "effects", kind: "flags", words: WORDS.effects.filter(({ word }) => word !== "all"), usual: ["all"],
    about: "Effects of relativity on the light of matter. Turned off, they show what each of them does.",
});
export const STRENGTHS: readonly string[] = ["Doppler shift", "gravity shift", "beaming"];

/** Film rows in groups, and the field that must be other than 0, or a word, for a group to have an effect. */
export interface Group {
    title: string;
    names: readonly string[];
    needs?: { name: string; word?: string };
}

const LIMITS = ["auto_percentile", "auto_target", "auto_least_ev", "auto_most_ev", "auto_adaptation"];
const FILM: readonly Group[] = [
    { title: "Exposure", names: ["exposure_ev", "auto_exposure"] },
    { title: "Light meter", names: LIMITS, needs: { name: "auto_exposure" } },
    { title: "Curve", names: ["tone_map", "highlights", "shadows"] },
    {
        title: "Filmic curve",
        names: ["toe_strength", "toe_length", "shoulder_strength", "shoulder_length", "shoulder_angle"],
        needs: { name: "tone_map", word: "filmic" },
    },
    { title: "Grade", names: ["white_balance", "tint", "contrast", "saturation", "colour_map", "lut_strength"] },
    { title: "Lens", names: ["bloom", "beam_fwhm", "vignette", "spikes", "streak", "flare"] },
    { title: "Spikes", names: ["spike_blades", "spike_angle", "spike_length"], needs: { name: "spikes" } },
    { title: "Streak", names: ["streak_length", "streak_tint"], needs: { name: "streak" } },
    { title: "Flare", names: ["flare_ghosts"], needs: { name: "flare" } },
    { title: "Grain", names: ["grain", "grain_seed"] },
];

/** Fields that do nothing in a page, whose canvas has no high dynamic range. */
const LEFT_OUT = ["paper_white", "peak"];

/** Groups with their rows; fields that no group has come last, so that none is missing. */
export function filmGroups(): (Group & { rows: Row[] })[] {
    const named = [...FILM.flatMap(({ names }) => names), ...LEFT_OUT];
    const rest = rows("film", named, true);
    const groups = FILM.map((group) => ({ ...group, rows: rows("film", group.names) }));
    return rest.length > 0 ? [...groups, { title: "More", names: [], rows: rest }] : groups;
}
