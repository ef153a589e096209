// SPDX-License-Identifier: MIT OR Apache-2.0
// written.ts -- reads the text of a scene as the tracer writes it, with every field, one in a line: sections, and
// values in the notation that JSON and TOML share. Reads no other TOML.

import type { Settings, Value } from "./settings.js";

/** The names of lists of structs. */
export const LISTS: readonly string[] = ["volumes", "hot_spots"];

/** The values of a new scene, by their names in links. */
export type Defaults = Map<string, Value>;

/** Titles of sections, `begins`, and values with their names and the section that they are in. */
function* linesOf(text: string): Generator<{ section: string; begins: boolean; name?: string; value?: Value }> {
    let section = "";
    for (const line of text.split("\n")) {
        const title = /^\[+([a-z_.]+)\]+$/.exec(line);
        const pair = /^([a-z_]+) = (.*)$/.exec(line);
        if (title?.[1] !== undefined) {
            section = title[1];
            yield { section, begins: true };
        } else if (pair?.[1] !== undefined && pair[2] !== undefined) {
            yield { section, begins: false, name: pair[1], value: valueOf(pair[2]) };
        }
    }
}

/**
 * The values of a text with every field, by names as links have them: "hole.spin", and "volumes.shape" for those of any
 * volume.
 */
export function valuesOf(text: string): Defaults {
    const found: Defaults = new Map();
    for (const { section, name, value } of linesOf(text)) {
        if (name !== undefined && value !== undefined) {
            found.set(section === "" ? name : `${section}.${name}`, value);
        }
    }
    return found;
}

/** The settings that a text says. */
export function settingsOfText(text: string): Settings {
    const settings: Record<string, unknown> = {};
    let place = settings;
    for (const { section, begins, name, value } of linesOf(text)) {
        if (begins) {
            place = {};
            if (LISTS.includes(section)) {
                settings[section] = [...((settings[section] as unknown[] | undefined) ?? []), place];
            } else {
                settings[section] = place;
            }
        } else if (name !== undefined) {
            place[name] = value;
        }
    }
    return settings as Settings;
}

/** A value of the text that the tracer writes. */
function valueOf(text: string): Value {
    const special: Record<string, number> = { nan: NaN, inf: Infinity, "-inf": -Infinity };
    if (text.startsWith("[") || text.startsWith('"')) {
        return JSON.parse(text.replace(/\b(nan|inf)\b/g, "null")) as Value;
    }
    if (text === "true" || text === "false") {
        return text === "true";
    }
    return special[text] ?? numberOf(text);
}

/** Integers beyond those of doubles keep all their digits. */
export function numberOf(text: string): number | bigint {
    const number = Number(text);
    return /^-?\d+$/.test(text) && !Number.isSafeInteger(number) ? BigInt(text) : number;
}
