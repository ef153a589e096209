// SPDX-License-Identifier: MIT OR Apache-2.0
// settings.ts -- a scene as a plain object: what it may hold, how one is laid over another, and its text for the
// tracer (docs/scenes.md). scene.d.ts has its parts, made from bhr.h. Checks nothing that the tracer checks.

import type { Camera, Disk, Film, HotSpot, Quality, Region, Sky, Vector, Volume } from "./scene.js";
import type { Effect, Preset, PresetMatter, View } from "./words.js";

/** The hole: bhr_set_mass, bhr_set_spin, bhr_set_axis. */
export interface Hole {
    /** The length that M is, 1e-100 .. 1e100. Default 1. */
    mass: number;
    /** a / M, -0.9999 .. 0.9999 for frames. Default 0. */
    spin: number;
    /** Any non-zero length. Default +z. */
    axis: Vector;
}

/** A camera's place and look by other means than position and forward. Angles in radians. */
export interface CameraPlace {
    /** bhr_camera_orbit. */
    orbit: { distance: number; azimuth?: number; elevation?: number };
    look_at: Vector;
    turn: { right?: number; up?: number; roll?: number };
    /** bhr_camera_advance. */
    proper_time: number;
}

/** All that a scene may be set to. */
export interface Settings {
    /** A named look, under everything else. */
    preset?: Preset | undefined;
    preset_matter?: Exclude<PresetMatter, "auto"> | undefined;
    /** bhr_set_time. */
    time?: number | undefined;
    /** bhr_set_shutter. */
    shutter?: number | undefined;
    effects?: readonly Effect[] | undefined;
    /** Of the Doppler shift, gravity's shift and beaming, 0 .. 1. */
    effect_strengths?: Vector | undefined;
    view?: View | undefined;
    hole?: Partial<Hole> | undefined;
    camera?: Partial<Camera & CameraPlace> | undefined;
    /** `false`: there is none. */
    disk?: Partial<Disk> | false | undefined;
    volumes?: readonly Partial<Volume>[] | undefined;
    hot_spots?: readonly Partial<HotSpot>[] | undefined;
    sky?: Partial<Sky> | undefined;
    film?: Partial<Film & { grain_moves: boolean }> | undefined;
    quality?: Partial<Quality> | undefined;
    region?: Region | undefined;
}

/** A value of a scene. */
export type Value = number | bigint | string | boolean | readonly Value[] | Table;
/** Values by their names. */
export interface Table {
    readonly [name: string]: Value | undefined;
}

export function isTable(value: Value | undefined): value is Table {
    return typeof value === "object" && value !== null && !Array.isArray(value);
}

/** An object of a script's as settings: arrays of numbers as lists. Throws for objects that are no plain ones. */
function plain(value: unknown, name: string): Value {
    if (ArrayBuffer.isView(value) && !(value instanceof DataView)) {
        return [...(value as unknown as Iterable<number | bigint>)];
    }
    if (Array.isArray(value)) {
        return value.map((part: unknown) => plain(part, name));
    }
    if (typeof value !== "object" || value === null) {
        return value as Value;
    }
    const prototype: unknown = Object.getPrototypeOf(value);
    if (prototype !== null && Object.getPrototypeOf(prototype) !== null) {
        throw new TypeError(`${name} is a ${value.constructor?.name ?? "class"}; settings are plain objects`);
    }
    const pairs = Object.entries(value).map(([name, part]): [string, Value] => [name, plain(part, name)]);
    if (pairs.some(([name]) => name === "__proto__")) {
        throw new TypeError('"__proto__" is no name of a scene\'s');
    }
    return Object.fromEntries(pairs);
}

function laidOver(below: Table, above: Table): Table {
    const all: Record<string, Value> = {};
    for (const [name, value] of Object.entries(below)) {
        if (value !== undefined) {
            all[name] = value;
        }
    }
    for (const [name, value] of Object.entries(above)) {
        const before = all[name];
        if (value === undefined) {
            delete all[name];
        } else if (isTable(value)) {
            all[name] = laidOver(isTable(before) ? before : {}, value);
        } else {
            all[name] = value;
        }
    }
    return all;
}

/** What was set, with what is set now; both stay as they are. */
export function merged(before: Settings, now: Settings): Settings {
    return laidOver(before as Table, plain(now, "the scene") as Table) as Settings;
}

function written(value: Value, name: string): string {
    switch (typeof value) {
        case "number":
            return Number.isNaN(value) ? "nan" : Number.isFinite(value) ? String(value) : value < 0 ? "-inf" : "inf";
        case "bigint":
        case "boolean":
            return String(value);
        case "string":
            // A string of JSON is one of TOML, but for a character that JSON leaves as it is.
            return JSON.stringify(value).replaceAll("\u007f", "\\u007f");
        case "object":
            if (value !== null) {
                return Array.isArray(value)
                    ? `[${value.map((part: Value) => written(part, name)).join(", ")}]`
                    : `{ ${pairs(value as Table).join(", ")} }`;
            }
    }
    throw new TypeError(`${name} is ${value === null ? "null" : `a ${typeof value}`}, which no scene has`);
}

function pairs(table: Table): string[] {
    const there = Object.entries(table).filter((pair): pair is [string, Value] => pair[1] !== undefined);
    return there.map(([name, value]) => `${key(name)} = ${written(value, name)}`);
}

/** A name as TOML has it; one that is none of a scene's stays readable for the message about it. */
function key(name: string): string {
    return /^[A-Za-z0-9_-]+$/.test(name) ? name : written(name, name);
}

/** The text of a scene, in lines that hold one value each. */
export function textOf(settings: Settings): string {
    const lines = Object.entries(settings as Table).flatMap(([name, value]) => {
        if (value === undefined) {
            return [];
        }
        return isTable(value)
            ? pairs(value).map((pair) => `${key(name)}.${pair}`)
            : [`${key(name)} = ${written(value, name)}`];
    });
    return `${lines.join("\n")}\n`;
}
