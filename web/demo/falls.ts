// SPDX-License-Identifier: MIT OR Apache-2.0
// falls.ts -- time: matter that orbits, and a camera that falls or orbits, by the clock that it carries. Play, pause
// and a scrubber. Sets `time`, the camera's motion, and in a fall the film's light meter.

import type { Motion, Settings } from "./bhr/index.js";
import { poseOf, settingsOf } from "./camera.js";
import { digits, element, found, icon } from "./dom.js";
import { attempt, notice } from "./notices.js";
import type { Session } from "./session.js";
import { numberIn } from "./values.js";

/** M a second while matter alone moves. */
const MATTER_SPEED = 6;
/** A whole orbit of the camera lasts so many seconds. */
const ORBIT_SECONDS = 24;
/** A fall would last so long at the speed that it begins with; it slows down, for the last M has the most to see. */
const FALL_SECONDS = 9;
/** M in seconds for the hole in the middle of the Milky Way, of 4.3 million solar masses. */
const SGR_A_SECONDS = 4.9255e-6 * 4.3e6;
/** Ahead of an observer who falls all light grows brighter without limit: the film's light meter follows it so far. */
const METER = 0.7;
/** The scrubber's steps. */
const STEPS = 2000;
/** A slow device shows a slower film rather than one that jumps. */
const LONGEST_STEP = 0.25;

const MODES: readonly (readonly [Motion, string, string])[] = [
    ["static", "Hold", "The camera rests where it is; matter orbits"],
    ["orbit", "Orbit", "The camera goes round on a circle, as a planet would"],
    ["free_fall", "Fall", "The camera falls freely, as if from rest far away"],
];

export class Falls {
    isPlaying = false;
    private last: number | undefined;
    private end: number | undefined;
    private endOf = "";
    private isMetered = false;
    private readonly play = element("button", { type: "button", class: "tool play", onclick: () => this.toggle() });
    private readonly scrubber = element("input", { type: "range", class: "slider", min: 0, max: STEPS, step: 1,
        "aria-label": "Time" });
    private readonly readout = element("output", { class: "readout" });
    private readonly modes: HTMLButtonElement[];

    constructor(
        private readonly session: Session,
        /** Has the picture follow. */
        private readonly wake: () => void,
    ) {
        this.modes = MODES.map(([motion, name, about]) => element("button", { type: "button", class: "mode",
            title: about, onclick: () => attempt(() => this.move(motion)) }, name));
        const group = element("div", { class: "modes", role: "group", "aria-label": "How the camera moves" },
            ...this.modes);
        found("clock").append(this.play, this.scrubber, this.readout, group);
        this.scrubber.addEventListener("input", () => {
            this.pause();
            attempt(() => this.go((Number(this.scrubber.value) / STEPS) * this.span));
        });
        session.onChange(() => this.update());
        this.update();
    }

    private get motion(): Motion {
        return this.session.value("camera.motion") as Motion;
    }

    /** Whether the camera goes its own way, so that drags turn its look alone. */
    get isCarried(): boolean {
        return this.isTravel;
    }

    /** The clock: the camera's own where it moves, else the scene's time; in scene lengths. */
    private get now(): number {
        const { settings } = this.session;
        return this.isTravel ? (settings.camera?.proper_time ?? 0) : (settings.time ?? 0);
    }

    private get isTravel(): boolean {
        return this.motion === "free_fall" || this.motion === "orbit";
    }

    private get mass(): number {
        return numberIn(this.session.values.sections.hole, "mass");
    }

    /** How far the scrubber reaches. */
    private get span(): number {
        return this.motion === "free_fall" ? this.fallEnd() : this.motion === "orbit" ? this.period()
            : Math.max(200 * this.mass, this.now);
    }

    /** One turn about the hole by the camera's clock: 2 pi (r^(3/2) + a) M of coordinate time, by its rate. */
    private period(): number {
        const { camera_radius, camera_time_rate } = this.session.hole.info();
        const radius = camera_radius / this.mass;
        const spin = numberIn(this.session.values.sections.hole, "spin");
        const period = 2 * Math.PI * (radius ** 1.5 + spin) * this.mass * camera_time_rate;
        return Number.isFinite(period) && period > 0 ? period : 200 * this.mass;
    }

    /** The end of a fall by the camera's clock, found by halving: scenes beyond it are refused. */
    private fallEnd(): number {
        const { settings } = this.session;
        const of = JSON.stringify([settings.hole, { ...settings.camera, proper_time: 0, turn: 0, fov_y: 0 }]);
        if (this.end === undefined || this.endOf !== of) {
            const can = (proper_time: number) => this.session.accepts({ camera: { proper_time } });
            let [low, high] = [0, 10 * this.mass];
            while (high < 1e7 * this.mass && can(high)) {
                [low, high] = [high, 2 * high];
            }
            for (let i = 0; i < 34; i++) {
                const middle = (low + high) / 2;
                [low, high] = can(middle) ? [middle, high] : [low, middle];
            }
            [this.end, this.endOf] = [low, of];
        }
        return this.end;
    }

    /** Another motion of the camera, from its present place on. */
    move(motion: Motion): void {
        const { session } = this;
        const spin = numberIn(session.values.sections.hole, "spin");
        const pose = poseOf(session.settings, session.values);
        if (motion === "orbit" && spin !== 0 && pose.elevation !== 0) {
            notice("About a spinning hole, circles lie in the plane of the disk: the camera was put there.");
            pose.elevation = 0;
        }
        // A spinning hole's horizon is crossed in the chart of falling observers.
        const chart = motion === "free_fall" && spin !== 0 ? "rain" : undefined;
        const camera = { ...settingsOf(pose).camera, motion: motion === "static" ? undefined : motion, chart,
            proper_time: undefined } as unknown as Settings["camera"];
        session.change({ camera, ...this.meter(motion) });
        if (motion === "free_fall" || motion === "orbit") {
            this.start();
        }
    }

    /** The light meter is on during a fall, unless the film has it otherwise, and off again after that. */
    private meter(motion: Motion): Settings {
        const now = this.session.value("film.auto_exposure");
        if (motion === "free_fall" && now === 0 && !this.isMetered) {
            this.isMetered = true;
            notice("Light grows brighter in a fall: the film's light meter follows it (Settings, Film: exposure).");
            return { film: { auto_exposure: METER } };
        }
        const isOver = motion !== "free_fall" && this.isMetered;
        this.isMetered = this.isMetered && !isOver;
        return isOver && now === METER ? ({ film: { auto_exposure: undefined } } as unknown as Settings) : {};
    }

    toggle(): void {
        if (this.isPlaying) {
            this.pause();
        } else {
            this.start();
        }
    }

    start(): void {
        attempt(() => {
            if (this.isTravel && this.now >= this.lastMoment()) {
                this.go(0);
            }
            [this.isPlaying, this.last] = [true, undefined];
            this.update();
            this.wake();
        });
    }

    pause(): void {
        this.isPlaying = false;
        this.update();
    }

    /** A fall is shown until shortly before its end, where no frame can be. */
    private lastMoment(): number {
        return this.motion === "free_fall" ? this.fallEnd() * 0.9995 : Infinity;
    }

    /** Sets the clock. */
    private go(moment: number): void {
        const now = Number(Math.min(moment, this.lastMoment()).toPrecision(8));
        this.session.change((this.isTravel ? { camera: { proper_time: now } } : { time: now }) as Settings);
    }

    /** Moves on to the time of the next frame, and says whether anything moves. */
    advance(): boolean {
        if (!this.isPlaying) {
            return false;
        }
        const at = performance.now();
        const seconds = this.last === undefined ? 0 : Math.min(LONGEST_STEP, (at - this.last) / 1000);
        this.last = at;
        try {
            const now = this.now;
            const end = this.lastMoment();
            if (this.motion === "free_fall") {
                const left = end - now;
                this.go(now + seconds * Math.max(left / FALL_SECONDS, end / 3000));
            } else {
                const period = this.motion === "orbit" ? this.period() : 0;
                const speed = this.motion === "orbit" ? period / ORBIT_SECONDS : MATTER_SPEED * this.mass;
                this.go(now + seconds * speed);
            }
            if (now >= end) {
                this.pause();
            }
        } catch (error) {
            this.pause();
            throw error;
        }
        return this.isPlaying;
    }

    private update(): void {
        const { isPlaying } = this;
        this.play.replaceChildren(icon(isPlaying ? "pause" : "play"));
        this.play.setAttribute("aria-label", isPlaying ? "Pause time" : "Let time run");
        this.play.title = isPlaying ? "Pause (space)" : "Play (space)";
        MODES.forEach(([motion], i) => this.modes[i]?.setAttribute("aria-pressed", String(motion === this.motion)));
        let span = 1;
        try {
            span = this.span;
        } catch {
            // A scene that the library refuses has told so already.
        }
        const now = this.now;
        const place = span > 0 ? ((this.motion === "orbit" ? now % span : now) / span) * STEPS : 0;
        if (document.activeElement !== this.scrubber || this.isPlaying) {
            this.scrubber.value = String(Math.round(place));
        }
        this.scrubber.style.setProperty("--share", `${place / (STEPS / 100)}%`);
        const inM = now / this.mass;
        const name = this.isTravel ? "\u03c4" : "t";
        const text = `${name} = ${digits(inM, 4)} M`;
        const clock = `${duration(inM * SGR_A_SECONDS)} at Sgr A*`;
        this.scrubber.setAttribute("aria-valuetext", `${text}, ${clock}`);
        this.readout.replaceChildren(element("strong", {}, text), element("span", {}, clock));
        this.readout.title = this.isTravel
            ? "The camera's own clock, in M and as it would read near the hole in the middle of the Milky Way"
            : "The scene's time, in M and as it would pass near the hole in the middle of the Milky Way";
    }
}

/** Seconds as people say them. */
function duration(seconds: number): string {
    const size = Math.abs(seconds);
    if (size < 60) {
        return `${digits(seconds, 3)} s`;
    }
    if (size < 3600) {
        return `${Math.floor(seconds / 60)} min ${Math.floor(size % 60)} s`;
    }
    return `${digits(seconds / 3600, 3)} h`;
}
