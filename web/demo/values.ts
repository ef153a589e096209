// SPDX-License-Identifier: MIT OR Apache-2.0
// values.ts -- the values of all fields of a scene, presets included, read from the text that BlackHole.text() gives.

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

function valueOf(text: string): Value {
    const special: Record<string, Value> = { nan: NaN, inf: Infinity, "-inf": -Infinity, true: true, false: false };
    if (/^-?\d{16,}$/.test(text)) {
        return BigInt(text);
    }
    return special[text] ?? (JSON.parse(text.replace(/\b(nan|inf)\b/g, "null")) as Value);
}

/** Reads the lines of a text that the library wrote: one value each, without tables in lines. */
export function valuesOf(text: string): Values {
    const top: Record<string, Value> = {};
    const sections: Record<string, Record<string, Value>> = {};
    const lists: Record<string, Record<string, Value>[]> = { volumes: [], hot_spots: [] };
    let place = top;
    for (const line of text.split("\n")) {
        const title = /^(\[+)([a-z_]+)\]+$/.exec(line);
        const pair = /^([a-z_]+) = (.*)$/.exec(line);
        if (title?.[2] !== undefined) {
            place = {};
            if (title[1] === "[[") {
                (lists[title[2]] ??= []).push(place);
            } else {
                sections[title[2]] = place;
            }
        } else if (pair?.[1] !== undefined && pair[2] !== undefined) {
            place[pair[1]] = valueOf(pair[2]);
        }
    }
    const { volumes = [], hot_spots = [] } = lists;
    return { top, sections, volumes, hot_spots, disk: top.disk !== false };
}

/** A number of a struct, which the text always has. */
export function numberIn(struct: Struct | undefined, name: string): number {
    return Number(struct?.[name] ?? NaN);
}
