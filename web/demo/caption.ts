// SPDX-License-Identifier: MIT OR Apache-2.0
// caption.ts -- a line that names what the picture shows: spin, distance, motion, colours.

import { digits } from "./dom.js";
import type { Session } from "./session.js";
import { numberIn } from "./values.js";

/** The colours of views that show a number. */
const VIEWS: Record<string, string> = {
    redshift: "redshift g of the light, in false colour",
    order: "the number of the image of the disk, in false colour",
    deflection: "the angle by which light is bent, in false colour",
    steps: "integration steps of each ray, in false colour",
    metric: "\u2212g\u209c\u209c where the ray meets the plane, in false colour",
    optical_depth: "optical depth of matter, in false colour",
    intensity: "intensity of matter with a power law, in false colour",
};

const CURVES: Record<string, string> = {
    none: "without a tone curve", aces: "by the tone curve ACES", agx: "by the tone curve AgX",
    filmic: "by a filmic curve",
};

/** How the colours came to be. */
function colours({ values }: Session): string {
    const view = String(values.top.view);
    if (view !== "light") {
        return VIEWS[view] ?? view;
    }
    const film = values.sections.film ?? {};
    if (film.colour_map !== "none") {
        return "brightness alone, in a map of colours";
    }
    return `light as the camera sees it, ${CURVES[String(film.tone_map)] ?? ""}`;
}

const MOTIONS: Record<string, string> = { static: "at rest", free_fall: "falling freely", orbit: "in orbit",
    velocity: "moving" };

/** The line, in parts. */
export function caption(session: Session): string[] {
    const { sections } = session.values;
    const info = session.hole.info();
    const spin = numberIn(sections.hole, "spin");
    const radius = info.camera_radius / numberIn(sections.hole, "mass");
    const motion = MOTIONS[String(sections.camera?.motion)] ?? "";
    const inside = info.camera_radius < info.horizon_radius ? ", inside the horizon" : "";
    return [
        spin === 0 ? "No spin" : `Spin ${digits(spin, 4)}`,
        `${digits(radius, 4)} M from the centre, ${motion}${inside}`,
        `Colours: ${colours(session)}`,
    ];
}
