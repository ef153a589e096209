// SPDX-License-Identifier: MIT OR Apache-2.0
// values.ts -- the values of all fields of a scene, presets included, read from the text that BlackHole.text() gives.

import { settingsOfText } from "./bhr/written.js";

export type Value = number | bigint | string | boolean | readonly Value[];
export type Struct = Readonly<Record<string, Value>>;

/** All that a scene says. */
export interface Values {
    readonly top: Struct;
    readonly sections: Readonly<Record<string, Struct>>;
    readonly volumes: readonly Struct[];
    readonly hot_spots: readonly Struct[];
    /** Whether there is a thin disk. */
    readonly disk: boolean;
}

/** Reads a text that the library wrote. */
export function valuesOf(text: string): Values {
    const top: Record<string, Value> = {};
    const sections: Record<string, Struct> = {};
    const lists: Record<string, readonly Struct[]> = {};
    for (const [name, value] of Object.entries(settingsOfText(text))) {
        if (name === "volumes" || name === "hot_spots") {
            lists[name] = value as readonly Struct[];
        } else if (typeof value === "object" && !Array.isArray(value)) {
            sections[name] = value as Struct;
        } else {
            top[name] = value as Value;
        }
    }
    const { volumes = [], hot_spots = [] } = lists;
    return { top, sections, volumes, hot_spots, disk: sections.disk !== undefined };
}

/** A number of a struct, which the text always has. */
export function numberIn(struct: Struct | undefined, name: string): number {
    return Number(struct?.[name] ?? NaN);
}
