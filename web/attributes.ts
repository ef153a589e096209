// SPDX-License-Identifier: MIT OR Apache-2.0
// attributes.ts -- the attributes of <bhr-hole> as a scene, and a scene as a sentence for those who do not see it.
// Checks nothing that the tracer checks; touches no page.

import { settingsOf as settingsOfLink } from "./link.js";
import { orbitOf, placed } from "./orbit.js";
import type { Vector } from "./scene.js";
import { merged, type Settings } from "./settings.js";
import { valuesOf } from "./written.js";

/** Attributes for the common things, with the names that links have for them. */
const SHORT: ReadonlyMap<string, string> = new Map([
    ["spin", "hole.spin"],
    ["distance", "camera.orbit.distance"],
    ["azimuth", "camera.orbit.azimuth"],
    ["elevation", "camera.orbit.elevation"],
    ["fov", "camera.fov_y"],
    ["preset", "preset"],
    ["preset-matter", "preset_matter"],
    ["view", "view"],
    ["effects", "effects"],
    ["disk", "disk"],
    ["time", "time"],
    ["shutter", "shutter"],
]);

/** Attributes that say how the element behaves. */
const BEHAVIOUR: readonly string[] = ["scene", "alt", "controls", "playing", "rate", "backend", "max-pixels"];

/** Names that scene files have besides those of the structs. */
const MORE = ["volumes", "hot_spots", "effect_strengths", "camera.look_at", "camera.proper_time",
    "camera.turn.right", "camera.turn.up", "camera.turn.roll", "camera.orbit.distance", "camera.orbit.azimuth",
    "camera.orbit.elevation", "region.full_width", "region.full_height", "region.x", "region.y"];

const FIELD = /^(hole|camera|disk|volumes|hot[-_]spots|sky|film|quality|region|effect[-_]strengths)([-.][\w.-]*)?$/;

/** Whether the element reads an attribute. */
export function isAttribute(name: string): boolean {
    return SHORT.has(name) || BEHAVIOUR.includes(name) || FIELD.test(name);
}

const dashed = (name: string) => name.replace(/[._]/g, "-");

/** The name in links of an attribute; dashes may stand for the dots and underscores that JSX does not allow. */
function linkName(attribute: string, known: readonly string[]): string {
    const [, list, index, rest = ""] = /^(volumes|hot[-_]spots)[-.](\d+)(?:[-.](.*))?$/.exec(attribute) ?? [];
    const section = list?.replace("-", "_");
    const general = section === undefined ? attribute : [section, rest].filter((part) => part !== "").join(".");
    const name =
        known.find((one) => dashed(one) === dashed(general)) ??
        // A name that no scene has stays readable for the message about it.
        (section === undefined ? general.replace("-", ".") : general).replaceAll("-", "_");
    return section === undefined ? name : name.replace(section, `${section}.${index}`);
}

/** The scene that attributes mean: a link's, with what the others name over it. Throws for what is no name. */
export function settingsOf(attributes: ReadonlyMap<string, string>, defaults: string): Settings {
    const usual = valuesOf(defaults);
    const known = [...usual.keys(), ...MORE];
    const link = attributes.get("scene")?.replace(/^[^#]*#/, "").trim() ?? "";
    const below = link === "" ? {} : settingsOfLink(link, defaults);
    const pairs = ["v=1"];
    for (const [attribute, text] of attributes) {
        const name = SHORT.get(attribute) ?? (FIELD.test(attribute) ? linkName(attribute, known) : undefined);
        if (name !== undefined) {
            const isList = Array.isArray(usual.get(name.replace(/^(volumes|hot_spots)\.\d+/, "$1")));
            const parts = isList || /look_at|strengths/.test(name) ? text.trim().split(/[\s,]+/) : [text.trim()];
            pairs.push(`${name}=${parts.map(encodeURIComponent).join(",")}`);
        }
    }
    const above = settingsOfLink(pairs.join("&"), defaults);
    if (above.camera?.orbit !== undefined) {
        // Whoever says one of the three means the others to stay.
        const orbit = { ...orbitOf(below.camera, placeOf(defaults)), ...above.camera.orbit };
        const base = { ...below, camera: placed(orbit, below.camera) };
        return merged(base, { ...above, camera: { ...above.camera, orbit } });
    }
    if (above.camera?.position !== undefined && below.camera?.orbit !== undefined) {
        const { orbit: _, ...camera } = below.camera;
        return merged({ ...below, camera }, above);
    }
    return merged(below, above);
}

/** Where the camera of a new scene stands. */
export function placeOf(defaults: string): Vector {
    return valuesOf(defaults).get("camera.position") as unknown as Vector;
}

/** A scene in a sentence. */
export function sentenceOf(settings: Settings, defaults: string): string {
    const { spin = 0, mass = 1 } = settings.hole ?? {};
    const list = (words: readonly string[]) => words.join(", ").replace(/, ([^,]*)$/, " and $1");
    const { distance, elevation } = orbitOf(settings.camera, placeOf(defaults));
    const number = (value: number) => String(Number(value.toPrecision(3)));
    const angle = Math.abs(elevation) * (180 / Math.PI);
    const side = elevation < 0 ? "below" : "above";
    const matter = [
        ...(settings.disk === false ? [] : ["an accretion disk"]),
        ...((settings.volumes?.length ?? 0) > 0 ? ["clouds of matter"] : []),
        ...((settings.hot_spots?.length ?? 0) > 0 ? ["hot spots"] : []),
    ];
    return [
        spin === 0 ? "A non-spinning black hole" : `A black hole of spin ${number(Number(spin))}`,
        matter.length === 0 ? ", with no matter around it" : ` with ${list(matter)}`,
        `, seen from ${number(distance / Number(mass))} M away, `,
        angle < 0.05 ? "in its equatorial plane" : `${number(angle)} degrees ${side} its equatorial plane`,
        settings.view === undefined || settings.view === "light"
            ? "."
            : `; colours show the view "${settings.view}".`,
    ].join("");
}
