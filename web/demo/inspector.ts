// SPDX-License-Identifier: MIT OR Apache-2.0
// inspector.ts -- the ray of one pixel: its way about the hole, drawn from above and from the side, and its numbers
// under the names of bhr.h. Changes nothing of the scene.

import type { TracedRay } from "./bhr/index.js";
import { digits, drawn, element, found } from "./dom.js";
import { failure } from "./notices.js";
import type { Session } from "./session.js";
import { numberIn } from "./values.js";
import type { View } from "./view.js";

type Triple = readonly [number, number, number];

const dot = (a: Triple, b: Triple) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const scaled = (a: Triple, by: number): Triple => [a[0] * by, a[1] * by, a[2] * by];
const less = (a: Triple, b: Triple): Triple => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a: Triple, b: Triple): Triple =>
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a: Triple): Triple => scaled(a, 1 / (Math.hypot(...a) || 1));

/** Half of a drawing's side, in its own units. */
const HALF = 100;

const FATES: Record<string, string> = {
    captured: "captured: it comes from the horizon, and is black",
    escaped: "escaped: it comes from the sky",
    unresolved: "unresolved: not finished within the step limit",
    invalid: "invalid: no light comes this way",
};

export class Inspector {
    isOpen = false;
    /** The pixel, in shares of the picture's width and height. */
    private at = { x: 0.5, y: 0.5 };
    private readonly numbers = element("dl", { class: "facts wide" });
    private readonly views = element("div", { class: "drawings" });
    private readonly mark: SVGSVGElement;

    constructor(
        private readonly session: Session,
        private readonly stage: HTMLElement,
        private readonly view: View,
    ) {
        this.mark = drawn("svg", { class: "mark", viewBox: "-12 -12 24 24", "aria-hidden": "true" },
            drawn("circle", { r: 6 }), drawn("path", { d: "M-11 0h7M4 0h7M0-11v7M0 4v7" }));
        stage.append(this.mark);
        found("ray").append(
            element("p", { class: "hint" }, "Click into the picture, or move the mark by the arrow keys: this is the "
                + "way that the light of that pixel has come, followed back from the camera."),
            this.views, this.numbers);
        this.close();
        session.onChange(() => this.isOpen && this.update());
    }

    open(x = this.at.x, y = this.at.y): void {
        this.isOpen = true;
        this.at = { x: Math.min(1, Math.max(0, x)), y: Math.min(1, Math.max(0, y)) };
        this.mark.style.display = "";
        this.update();
    }

    close(): void {
        this.isOpen = false;
        this.mark.style.display = "none";
    }

    /** Moves the mark by arrow keys, a hundredth of the picture's height each; says whether it is there to be moved. */
    step(dx: number, dy: number): boolean {
        if (this.isOpen) {
            const { clientWidth, clientHeight } = this.stage;
            const by = Math.max(2, clientHeight / 100);
            this.open(this.at.x + (dx * by) / clientWidth, this.at.y + (dy * by) / clientHeight);
        }
        return this.isOpen;
    }

    private update(): void {
        this.mark.style.left = `${100 * this.at.x}%`;
        this.mark.style.top = `${100 * this.at.y}%`;
        const { width, height } = this.view.size;
        const [x, y] = [this.at.x * width, this.at.y * height];
        let ray: TracedRay;
        try {
            ray = this.session.hole.ray(x, y, width, height);
        } catch (error) {
            // A lens that has no ray there, such as outside a dome's circle.
            this.views.replaceChildren();
            this.numbers.replaceChildren(element("div", {}, element("dt", {}, "No ray"),
                element("dd", {}, error instanceof Error ? error.message : String(error))));
            return;
        }
        try {
            this.tell(ray, x, y);
            this.draw(ray);
        } catch (error) {
            failure(error);
        }
    }

    private tell(ray: TracedRay, x: number, y: number): void {
        const mass = numberIn(this.session.values.sections.hole, "mass");
        const degrees = (angle: number) => `${digits((angle * 180) / Math.PI, 4)}°`;
        const lines: [string, string, string][] = [
            ["pixel", `${x.toFixed(1)}, ${y.toFixed(1)}`, "From the picture's upper left corner"],
            ["fate", FATES[ray.fate] ?? ray.fate, "BhrHit.fate"],
        ];
        if (ray.fate === "escaped") {
            const bend = Math.acos(Math.min(1, Math.max(-1, dot(unit(ray.direction), unit(ray.sky_direction)))));
            lines.push(["sky_redshift g", digits(ray.sky_redshift, 4), "nu(camera) / nu(at infinity)"],
                ["deflection", degrees(bend), "Between the look and the sky that is seen there"]);
        }
        if (Number.isFinite(ray.swept_angle)) {
            lines.push(["swept_angle", degrees(ray.swept_angle), "The angle that the ray goes round the hole"]);
        }
        ray.crossings.forEach(({ radius, azimuth, redshift, delay }, i) => {
            lines.push([`crossing ${i + 1}`,
                `r ${digits(radius / mass, 4)} M, φ ${degrees(azimuth)}, g ${digits(redshift, 4)}, `
                + `delay ${digits(delay / mass, 4)} M`,
                "BhrCrossing: where the ray crosses the equatorial plane, the redshift of matter that orbits there, "
                + "and how long ago its light left"]);
        });
        lines.push(["steps", String(ray.steps), "Integration steps"]);
        this.numbers.replaceChildren(...lines.map(([name, value, about]) =>
            element("div", { title: about }, element("dt", {}, name), element("dd", {}, value))));
    }

    /** The path from above the disk, and from the side, with the camera on the right. */
    private draw(ray: TracedRay): void {
        const info = this.session.hole.info();
        const { values } = this.session;
        const mass = numberIn(values.sections.hole, "mass");
        const axis = unit((values.sections.hole?.axis ?? [0, 0, 1]) as Triple);
        const camera = ray.position;
        const level = less(camera, scaled(axis, dot(camera, axis)));
        const side = Math.hypot(...level) > 1e-6 * Math.hypot(...camera) ? unit(level)
            : unit(cross(axis, Math.abs(axis[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]));
        const across = cross(axis, side);
        const away = Math.hypot(...camera) / mass;
        // Near the hole there is the most to see: a camera far away is beyond the drawing.
        const reach = Math.max(7, Math.min(away * 1.08, 15));
        const scale = HALF / (reach * mass);
        const { path } = ray;
        const points: Triple[] = [];
        for (let i = 0; i + 3 < path.length; i += 4) {
            points.push([path[i] as number, path[i + 1] as number, path[i + 2] as number]);
        }
        const disk = values.disk ? values.sections.disk : undefined;
        const inner = Math.max(numberIn(disk, "inner_radius"), info.isco_prograde / mass);
        const ring = { inner, outer: numberIn(disk, "outer_radius") };
        const drawing = (title: string, right: Triple, up: Triple, isTop: boolean) => {
            const line = points.map((point) =>
                `${(dot(point, right) * scale).toFixed(2)},${(-dot(point, up) * scale).toFixed(2)}`).join(" ");
            const horizon = info.horizon_radius * scale;
            const orbits = [info.photon_orbit_prograde, info.photon_orbit_retrograde].filter((one, i, all) =>
                Number.isFinite(one) && all.indexOf(one) === i);
            const marks = ray.crossings.map(({ radius, azimuth }) => {
                const flat = this.crossing(radius, azimuth, axis);
                return drawn("circle", { class: "cross", r: 2.4, cx: dot(flat, right) * scale,
                    cy: -dot(flat, up) * scale });
            });
            const matter = disk === undefined || !(ring.outer > ring.inner) ? [] : isTop
                ? [drawn("path", { class: "disk", "fill-rule": "evenodd",
                    d: circle(ring.outer * mass * scale) + circle(ring.inner * mass * scale) })]
                : [-1, 1].map((sign) => drawn("line", { class: "disk", x1: sign * ring.inner * mass * scale, y1: 0,
                    x2: sign * ring.outer * mass * scale, y2: 0 }));
            const picture = drawn("svg", { viewBox: `${-HALF} ${-HALF} ${2 * HALF} ${2 * HALF}`, role: "img",
                "aria-label": `The ray's path ${title}: ${ray.fate}` },
                ...matter,
                drawn("circle", { class: "horizon", r: horizon }),
                ...orbits.map((radius) => drawn("circle", { class: "photon", r: radius * scale })),
                drawn("polyline", { class: "path", points: line }),
                ...marks,
                drawn("circle", { class: "camera", r: 3, cx: dot(camera, right) * scale,
                    cy: -dot(camera, up) * scale }));
            return element("figure", {}, picture, element("figcaption", {}, title));
        };
        const legend = element("p", { class: "legend" },
            `Black: the horizon. Dashed: circular orbits of light. The square is ${digits(2 * reach, 3)} M wide.`);
        this.views.replaceChildren(drawing("from above", side, across, true),
            drawing("from the side", side, axis, false), legend);
    }

    /** A place in the equatorial plane by its azimuth, which is told from scene x, or what of it lies in the plane. */
    private crossing(radius: number, azimuth: number, axis: Triple): Triple {
        const x: Triple = Math.abs(axis[0]) < 0.999 ? [1, 0, 0] : [0, 1, 0];
        const first = unit(less(x, scaled(axis, dot(x, axis))));
        const second = cross(axis, first);
        const [cos, sin] = [radius * Math.cos(azimuth), radius * Math.sin(azimuth)];
        return [0, 1, 2].map((i) => cos * (first[i] as number) + sin * (second[i] as number)) as unknown as Triple;
    }
}

const circle = (radius: number) => `M${-radius} 0a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 `
    + `${-2 * radius} 0z`;
