// SPDX-License-Identifier: MIT OR Apache-2.0
// schema.mjs -- names, ranges, units, defaults and comments of a scene's fields as data for the panel, out of the
// package's own types, which are made from bhr.h. Run by packaging/page:
//
//     node schema.mjs SCENE_D_TS WORDS_D_TS >schema.ts

import { readFileSync } from "node:fs";

const [scene, words] = process.argv.slice(2).map((path) => readFileSync(path, "utf8"));

/** A comment's text in one line, and its tags. */
function read(comment) {
    const lines = comment.split("\n").map((line) => line.replace(/^\s*\*? ?/, "").trim());
    const tags = Object.fromEntries(lines.filter((line) => line.startsWith("@")).map((line) => {
        const [, name, value] = /^@(\w+) (.*)$/.exec(line);
        return [name, value];
    }));
    return { about: lines.filter((line) => line !== "" && !line.startsWith("@")).join(" "), tags };
}

const choices = {};
for (const [, name, body] of words.matchAll(/^export type (\w+) =\n([\s\S]*?);\n/gm)) {
    choices[name] = [...body.matchAll(/\/\*\*([\s\S]*?)\*\/\s*\| "(\w+)"/g)].map(([, comment, word]) => {
        return { word, about: read(comment).about };
    });
}

const structs = {};
for (const [, name, body] of scene.matchAll(/^export interface (\w+) \{\n([\s\S]*?)^\}/gm)) {
    structs[name] = [...body.matchAll(/\/\*\*([\s\S]*?)\*\/\s+(\w+): ([^;]+);/g)].map(([, comment, field, type]) => {
        const { about, tags } = read(comment);
        const flags = /^readonly (\w+)\[\]$/.exec(type)?.[1];
        const list = choices[flags ?? type];
        const kind = list ? (flags ? "flags" : "choice")
            : type === "number" ? "number"
            : type === "number | bigint" ? "seed"
            : type === "Vector" || type.startsWith("readonly [") ? "vector" : undefined;
        if (kind === undefined) {
            throw new Error(`${name}.${field} is of type ${type}, which the panel does not know`);
        }
        const [range, unit] = /^(\S+ \.\. \S+) ?(.*)$/.exec(tags.range ?? "")?.slice(1) ?? [];
        const made = { name: field, kind, about };
        if (range !== undefined) made.range = range.split(" .. ").map(Number);
        if (tags.unit ?? unit) made.unit = tags.unit ?? unit;
        if (tags.default !== undefined) made.usual = JSON.parse(tags.default);
        if (list) made.words = list;
        return made;
    });
}
for (const name of ["Camera", "Disk", "Volume", "HotSpot", "Sky", "Film"]) {
    if (!(structs[name]?.length > 4)) {
        throw new Error(`the types have no ${name}`);
    }
}
const kept = { camera: structs.Camera, disk: structs.Disk, volumes: structs.Volume, hot_spots: structs.HotSpot,
    sky: structs.Sky, film: structs.Film };
console.log(`// Made by schema.mjs from the package's types; do not edit.
import type { Field, Word } from "./fields.js";
export const SCHEMA: Record<${Object.keys(kept).map((name) => `"${name}"`).join(" | ")}, readonly Field[]> =
${JSON.stringify(kept)};
export const WORDS: Record<"view" | "effects", readonly Word[]> =
${JSON.stringify({ view: choices.View, effects: choices.Effect })};`);
