// SPDX-License-Identifier: MIT OR Apache-2.0
// link.ts -- scenes as parts of addresses: "v=1&hole.spin=0.9&camera.position=0,26,2.5". Only what differs from a new
// scene is in it. `v` says which version's defaults are meant: tests/web/defaults-1.txt has those of version 1.

import { LISTS, numberOf, valuesOf } from "./written.js";
import { isTable, type Settings, type Table, type Value } from "./settings.js";

/** The version that is written, and the newest that is read. */
const VERSION = 1;

function isSame(one: Value | undefined, other: Value): boolean {
    if (Array.isArray(one) && Array.isArray(other)) {
        return one.length === other.length && one.every((part: Value, i) => isSame(part, other[i] as Value));
    }
    return Object.is(one, other) || (one !== undefined && typeof one !== "object" && String(one) === String(other));
}

function short(value: Value, name: string): string {
    if (Array.isArray(value)) {
        return value.map((part: Value) => short(part, name)).join(",");
    }
    if (isTable(value)) {
        throw new TypeError(`${name} is a table, which links have not`);
    }
    return encodeURIComponent(String(value));
}

/** The pairs of a table whose names begin with `prefix`. */
function* pairsOf(table: Table, prefix: string): Generator<[string, Value]> {
    for (const [name, value] of Object.entries(table)) {
        if (value === undefined) {
            continue;
        }
        if (LISTS.includes(name) && prefix === "" && Array.isArray(value)) {
            if (value.length === 0) {
                yield [name, ""];
            }
            for (const [i, one] of value.entries()) {
                // A struct as it begins is named all the same.
                const own = [...pairsOf(one as Table, `${name}.${i}.`)];
                yield* own.length > 0 ? own : [[`${name}.${i}`, ""] as [string, Value]];
            }
        } else if (isTable(value)) {
            yield* pairsOf(value, `${prefix}${name}.`);
        } else {
            yield [prefix + name, value];
        }
    }
}

/** A name without the number of its volume or hot spot. */
function general(name: string): string {
    return name.replace(/^(volumes|hot_spots)\.\d+/, "$1");
}

/** The link of a scene. `defaults`: the text of a new one, with every field. */
export function link(settings: Settings, defaults: string): string {
    const usual = valuesOf(defaults);
    const parts = [`v=${VERSION}`];
    for (const [name, value] of pairsOf(settings as Table, "")) {
        // A preset lies between a new scene and what is set; a volume's values are lost where none of it is named.
        // Without a forward the camera looks at the hole, wherever it is.
        const counts = settings.preset !== undefined || /^(volumes|hot_spots)\b|^camera\.forward$/.test(name);
        const before = usual.get(general(name));
        if (counts || before === undefined || !isSame(value, before)) {
            parts.push(`${name}=${short(value, name)}`);
        }
    }
    return parts.join("&");
}

/** A value of a link, of the kind that the same one has in a new scene. */
function readValue(text: string, usual: Value | undefined, isWhole: boolean): Value {
    const one = (part: string, like: Value | undefined): Value => {
        const plain = decodeURIComponent(part);
        if (typeof like === "string") {
            return plain;
        }
        if (plain === "true" || plain === "false") {
            return plain === "true";
        }
        if (plain === "NaN" || (/^[-+]?(\d|\.\d|Infinity$)/.test(plain) && !Number.isNaN(Number(plain)))) {
            // Only what is whole by its nature, as a seed is, keeps digits beyond those of a double.
            return isWhole ? numberOf(plain) : Number(plain);
        }
        return plain;
    };
    if (Array.isArray(usual)) {
        const like = usual[0] as Value | undefined;
        return text === "" ? [] : text.split(",").map((part) => one(part, like));
    }
    const isList = usual === undefined && text.includes(",");
    return isList ? text.split(",").map((part) => one(part, undefined)) : one(text, usual);
}

/** The settings of a link, with or without "#". Throws for one of a later version, and for what is no link. */
export function settingsOf(link: string, defaults: string): Settings {
    const usual = valuesOf(defaults);
    const settings: Record<string, unknown> = {};
    const parts = link.replace(/^#/, "").split("&").filter((part) => part !== "");
    const version = /^v=(\d+)$/.exec(parts.shift() ?? "");
    if (version === null || Number(version[1]) < 1 || Number(version[1]) > VERSION) {
        throw new RangeError(`a link begins with v=1; this is "${link.slice(0, 80)}"`);
    }
    for (const part of parts) {
        const at = part.indexOf("=");
        const [name, text] = at < 0 ? [part, ""] : [part.slice(0, at), part.slice(at + 1)];
        const path = name.split(".");
        // Names that every object has are none of a scene's.
        if (!path.every((word) => /^[a-z0-9_]+$/.test(word) && !(word in {})) || path.length > 4) {
            throw new RangeError(`"${name.slice(0, 80)}" is no name of a scene's`);
        }
        if (path.length === 1 && LISTS.includes(name)) {
            if (text !== "") {
                throw new RangeError(`${name} is a list, of which links name each part: ${name}.0`);
            }
            settings[name] = [];
            continue;
        }
        let place: Record<string, unknown> | unknown[] = settings;
        for (const [depth, word] of path.entries()) {
            const index = Array.isArray(place) ? indexOf(word, place.length, name) : word;
            const into = place as Record<string | number, unknown>;
            const isList = depth === 0 && LISTS.includes(word);
            const isStruct = depth === 1 && LISTS.includes(path[0] as string);
            if (depth === path.length - 1 && !isStruct) {
                into[index] = readValue(text, usual.get(general(name)), word === "seed");
            } else {
                into[index] ??= isList ? [] : {};
                place = into[index] as Record<string, unknown>;
                if (typeof place !== "object") {
                    throw new RangeError(`${name} is set, and so is a part of its name`);
                }
            }
        }
    }
    return settings as Settings;
}

/** Structs of a list are named in order. */
function indexOf(word: string, length: number, name: string): number {
    const index = /^\d+$/.test(word) ? Number(word) : NaN;
    if (!(index <= length)) {
        throw new RangeError(`${name} comes before those of lower numbers`);
    }
    return index;
}
