// SPDX-License-Identifier: MIT OR Apache-2.0
// panel.ts -- the settings of hole, camera, disk, matter, sky, film and effects, in sections that fold. Values are set
// through the session only.

import type { Settings } from "./bhr/index.js";
import { clamped, poseOf, settingsOf, USUAL, type Pose } from "./camera.js";
import { digits, element, found } from "./dom.js";
import { EFFECTS, filmGroups, HOLE, rowOf, rows, STRENGTHS, VIEW, type Group, type Row } from "./fields.js";
import { attempt } from "./notices.js";
import type { ListName, Session } from "./session.js";
import { numberIn } from "./values.js";
import { facts, flags, slider, toggle, vector, widget, type Access, type Widget } from "./widgets.js";

/** As many as bhr.h allows: BHR_MAX_VOLUMES, BHR_MAX_HOT_SPOTS. */
const MOST: Record<ListName, number> = { volumes: 4, hot_spots: 8 };
const NAMES: Record<ListName, string> = { volumes: "Volume", hot_spots: "Hot spot" };

/** Values that suit a shape, where those of a new volume show little: they stay thin enough to be looked through. */
const SHAPES: Record<string, Record<string, number | string | readonly unknown[]>> = {
    disk: {},
    torus: { radius: 9, width: 2.5, thickness: 0.2, absorption: 0.12, brightness: 0.6, outer_radius: 40 },
    halo: { radius: 6, thickness: 0.5, absorption: 0.05, brightness: 0.6, outer_radius: 40 },
    jet: { flow: "outflow", flags: ["power_law"], inner_radius: 3, outer_radius: 60, thickness: 0.02, opening: 0.35,
        slope: 1.2, absorption: 0.002, spectral_index: 0.7, brightness: 0.15, speed: 0.8, tint: [0.45, 0.65, 1] },
};

export class Panel {
    private readonly place = found("settings");
    private readonly fixed: Widget[] = [];
    private lists: Widget[] = [];
    private readonly matter: HTMLElement;
    private shape = "";
    private isWaiting = false;

    constructor(
        private readonly session: Session,
        /** Has the camera move in another way. */
        private readonly move: (motion: never) => void,
    ) {
        this.section("Hole", true, [...HOLE.map((row) => this.field("hole", row)), this.holeFacts()]);
        this.section("Camera", true, this.camera());
        this.section("View and effects", false, [this.top(VIEW), this.effects(), ...STRENGTHS.map((_, i) =>
            this.strength(i))]);
        this.section("Disk", false, this.disk());
        this.matter = element("div", { class: "rows" });
        this.fold("Matter with depth", false, this.matter);
        this.section("Sky", false, [...rows("sky", ["flags", "stars_brightness", "map_brightness", "seed"])
            .map((row) => this.field("sky", row)), this.skyTurn()]);
        for (const group of filmGroups()) {
            this.film(group);
        }
        session.onChange(() => this.wake());
        this.update();
    }

    /** Brings all rows up to date, once before the next picture of the page; hidden ones wait until they are seen. */
    wake(): void {
        if (!this.isWaiting) {
            this.isWaiting = true;
            requestAnimationFrame(() => {
                this.isWaiting = false;
                if (this.place.offsetParent !== null) {
                    attempt(() => this.update());
                }
            });
        }
    }

    private update(): void {
        this.rebuildLists();
        for (const one of [...this.fixed, ...this.lists]) {
            one.update();
        }
    }

    private fold(title: string, isOpen: boolean, content: HTMLElement): HTMLDetailsElement {
        const fold = element("details", { class: "fold", open: isOpen }, element("summary", {}, title), content);
        this.place.append(fold);
        return fold;
    }

    private section(title: string, isOpen: boolean, widgets: readonly Widget[]): HTMLDetailsElement {
        this.fixed.push(...widgets);
        return this.fold(title, isOpen, element("div", { class: "rows" }, ...widgets.map(({ node }) => node)));
    }

    private access(path: string): Access {
        const { session } = this;
        return { get: () => session.value(path), set: (value) => session.assign(path, value),
            isSet: () => session.isSet(path) };
    }

    private field(section: string, row: Row): Widget {
        return widget(row, this.access(`${section}.${row.name}`));
    }

    private top(row: Row): Widget {
        return widget(row, this.access(row.name));
    }

    private holeFacts(): Widget {
        const info = () => this.session.hole.info();
        const mass = () => numberIn(this.session.values.sections.hole, "mass");
        const inM = (value: number) => (Number.isFinite(value) ? `${digits(value / mass())} M` : "\u2013");
        const shadow = () => {
            const { shadow_angular_radius: radius } = info();
            return Number.isFinite(radius) ? `${digits((radius * 180) / Math.PI)}°` : "\u2013";
        };
        return facts([
            ["Horizon", "horizon_radius", () => inM(info().horizon_radius)],
            ["Ergosphere", "ergosphere_equatorial_radius: the edge of the region where nothing can stay at rest, in "
                + "the equatorial plane", () => inM(info().ergosphere_equatorial_radius)],
            ["Light +", "photon_orbit_prograde: the circular orbit of light with the spin",
                () => inM(info().photon_orbit_prograde)],
            ["Light \u2212", "photon_orbit_retrograde: the circular orbit of light against the spin",
                () => inM(info().photon_orbit_retrograde)],
            ["ISCO +", "isco_prograde: the innermost stable circular orbit of matter with the spin",
                () => inM(info().isco_prograde)],
            ["ISCO \u2212", "isco_retrograde: the innermost stable circular orbit of matter against the spin",
                () => inM(info().isco_retrograde)],
            ["Critical b", "critical_impact_parameter: light that passes nearer is captured; known without spin",
                () => inM(info().critical_impact_parameter)],
            ["Shadow", "shadow_angular_radius, as the camera sees it; known without spin", shadow],
        ]);
    }

    /** A row of the camera's pose; the distance is told in M. */
    private pose(name: keyof Pose, label: string, about: string, least: number, most: number): Widget {
        const isAngle = name !== "distance";
        const row = rowOf("", { name, kind: "number", about, unit: isAngle ? "rad" : "M" });
        const { session } = this;
        const mass = () => numberIn(session.values.sections.hole, "mass");
        const now = () => poseOf(session.settings, session.values)[name] / (isAngle ? 1 : mass());
        const set = (value: number) => {
            const pose = { ...poseOf(session.settings, session.values), [name]: value * (isAngle ? 1 : mass()) };
            session.change(settingsOf(clamped(pose, session.hole.info().horizon_radius, mass())));
        };
        const reach = { least, most, isLog: !isAngle };
        return slider({ ...row, label, reach }, {
            get: now,
            set: (value) => set(Number(value ?? USUAL[name])),
            isSet: () => Math.abs(now() - USUAL[name]) > 1e-6,
        });
    }

    private camera(): Widget[] {
        const { session } = this;
        const [fov, motion, velocity] = rows("camera", ["fov_y", "motion", "velocity"]) as [Row, Row, Row];
        const turn = Math.PI;
        const speed = vector(velocity, this.access("camera.velocity"));
        const moved = widget(motion, {
            get: () => session.value("camera.motion"),
            set: (value) => this.move((value ?? "static") as never),
            isSet: () => session.isSet("camera.motion"),
        });
        const hidden: Widget = { node: speed.node, update: () => {
            speed.node.hidden = session.value("camera.motion") !== "velocity";
            speed.update();
        } };
        const rate = facts([
            ["Radius r", "camera_radius", () => `${digits(session.hole.info().camera_radius
                / numberIn(session.values.sections.hole, "mass"))} M`],
            ["Clock rate dτ/dt", "camera_time_rate: the rate of the camera's clock",
                () => digits(session.hole.info().camera_time_rate)],
        ]);
        return [
            this.pose("distance", "distance", "From the hole's centre.", 1.2, 300),
            this.pose("azimuth", "azimuth", "About the scene's z, from x.", -turn, turn),
            this.pose("elevation", "elevation", "Above the scene's x-y plane, where the disk is.", -turn / 2, turn / 2),
            this.field("camera", { ...fov, reach: { least: 0.05, most: 2.8 } }),
            this.pose("right", "look right", "The look aside from the hole.", -turn, turn),
            this.pose("up", "look up", "The look aside from the hole.", -turn / 2, turn / 2),
            this.pose("roll", "roll", "The camera's turn about its look, clockwise.", -turn, turn),
            moved, hidden, rate,
        ];
    }

    private effects(): Widget {
        return flags(EFFECTS, this.access("effects"), "all");
    }

    private strength(index: number): Widget {
        const { session } = this;
        const now = () => (session.value("effect_strengths") ?? [1, 1, 1]) as readonly number[];
        const row = rowOf("", { name: "strength", kind: "number", range: [0, 1], usual: 1,
            about: "The factor of this effect is raised to this power, as films do it; 1 is physically right." });
        return slider({ ...row, label: `${STRENGTHS[index]}, strength` }, {
            get: () => now()[index],
            set: (value) => {
                const strengths = now().map((one, i) => (i === index ? Number(value ?? 1) : one));
                session.change({ effect_strengths: strengths } as unknown as Settings);
            },
            isSet: () => now()[index] !== 1,
        });
    }

    private disk(): Widget[] {
        const { session } = this;
        const has = toggle("A thin disk of matter", () => session.values.disk, (isOn) =>
            attempt(() => session.change({ disk: isOn ? {} : false })));
        const fields = rows("disk").map((row) => this.field("disk", row));
        return [has, ...fields.map((one) => ({
            node: one.node,
            update: () => {
                one.node.hidden = !session.values.disk;
                if (session.values.disk) {
                    one.update();
                }
            },
        }))];
    }

    /** Of the sky's orientation the turn about the scene's z, which one slider can show. */
    private skyTurn(): Widget {
        const { session } = this;
        const about = "The sky's turn about the scene's z.";
        const row = rowOf("", { name: "turn", kind: "number", unit: "rad", about });
        const path = "sky.orientation";
        return slider({ ...row, reach: { least: -Math.PI, most: Math.PI } }, {
            get: () => {
                const [, , z, w] = (session.value(path) ?? [0, 0, 0, 1]) as readonly number[];
                return 2 * Math.atan2(z ?? 0, w ?? 1);
            },
            set: (value) => session.assign(path, value === undefined ? undefined
                : [0, 0, Math.sin(Number(value) / 2), Math.cos(Number(value) / 2)]),
            isSet: () => session.isSet(path),
        });
    }

    private film(group: Group & { rows: readonly Row[] }): void {
        const { session } = this;
        const fold = this.section(`Film: ${group.title.toLowerCase()}`, false, group.rows.map((row) =>
            this.field("film", row)));
        const { needs } = group;
        if (needs !== undefined) {
            // A group without an effect is not in the way.
            this.fixed.push({ node: fold, update: () => {
                const value = session.value(`film.${needs.name}`);
                fold.hidden = needs.word === undefined ? Number(value) === 0 : value !== needs.word;
            } });
        }
    }

    /** Volumes and hot spots come and go: their rows are made anew when there is another number of them. */
    private rebuildLists(): void {
        const { values } = this.session;
        const shape = `${values.volumes.length} ${values.hot_spots.length}`;
        if (shape === this.shape) {
            return;
        }
        this.shape = shape;
        this.lists = [];
        const folds = (["volumes", "hot_spots"] as const).flatMap((name) => [
            ...values[name].map((_, i) => this.one(name, i)), this.more(name)]);
        this.matter.replaceChildren(
            element("p", { class: "hint" }, "Frames with depth take many times as long as those of a thin disk."),
            ...folds);
    }

    private one(name: ListName, index: number): HTMLElement {
        const { session } = this;
        const widgets = rows(name).map((row) => {
            const path = `${name}.${index}.${row.name}`;
            // Another shape begins with values that suit it.
            const set = (value: unknown) => session.change({ [name]: session.listOf(name).map((old, i) =>
                i === index ? { shape: value, ...SHAPES[String(value)] } : old) } as Settings);
            const access = this.access(path);
            return widget(row, row.name === "shape" ? { ...access, set: (value) => set(value ?? "disk") } : access);
        });
        this.lists.push(...widgets);
        const remove = element("button", { type: "button", class: "button", onclick: () => attempt(() =>
            session.change({ [name]: session.listOf(name).filter((_, i) => i !== index) } as Settings)) }, "Remove");
        return element("details", { class: "fold inner" },
            element("summary", {}, `${NAMES[name]} ${index + 1}`),
            element("div", { class: "rows" }, ...widgets.map(({ node }) => node), remove));
    }

    private more(name: ListName): HTMLElement {
        const { session } = this;
        return element("button", {
            type: "button", class: "button", disabled: session.values[name].length >= MOST[name],
            onclick: () => attempt(() =>
                session.change({ [name]: [...session.listOf(name), {}] } as Settings)),
        }, `Add a ${NAMES[name].toLowerCase()}`);
    }
}
