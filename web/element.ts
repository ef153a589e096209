// SPDX-License-Identifier: MIT OR Apache-2.0
// element.ts -- <bhr-hole>, a black hole as an element of a page: importing this file defines it. docs/web.md says what
// its attributes are. Attributes become a scene in attributes.ts, frames are made by frames.ts, gestures read by
// controls.ts.

import { isAttribute, placeOf, sentenceOf, settingsOf } from "./attributes.js";
import { Controls } from "./controls.js";
import { Frames } from "./frames.js";
import type { BlackHole, Options, Settings } from "./index.js";
import { loaded } from "./load.js";
import { moved, orbitOf, placed } from "./orbit.js";
import { textOf } from "./settings.js";

declare global {
    interface HTMLElementTagNameMap {
        "bhr-hole": BhrHole;
    }
}

/** Pixels of a picture at most, unless max-pixels says otherwise. */
const MOST_PIXELS = 2e6;
/** Scene time that goes by in a second, unless rate says otherwise. */
const RATE = 10;
/** Milliseconds after which readers are told that the first picture takes time. */
const LONG_MS = 1000;

const STYLE = `
:host { display: block; position: relative; aspect-ratio: 16 / 9; background: #000; color: #ddd; overflow: hidden; }
:host([hidden]) { display: none; }
[part=picture] { position: absolute; inset: 0; }
canvas { position: absolute; inset: 0; width: 100%; height: 100%; pointer-events: none; }
:host([controls]) [part=picture] { cursor: grab; touch-action: pan-y; user-select: none; -webkit-user-select: none; }
:host([controls]) [part=picture]:focus { touch-action: none; }
:host([controls]) [part=picture]:active { cursor: grabbing; }
[part=picture]:focus { outline: none; }
[part=picture]:focus-visible { outline: 2px solid #7ab8ff; outline-offset: -2px; }
[part=notice] { position: absolute; inset: auto 0 0 0; margin: 0 auto 0.75em; width: fit-content; box-sizing: border-box;
    max-width: calc(100% - 1.5em); max-height: calc(100% - 1.5em); overflow: auto; padding: 0.5em 0.9em;
    border-radius: 0.5em; background: rgb(20 22 28 / 88%); font: 0.875rem/1.4 system-ui, sans-serif;
    overflow-wrap: anywhere; }
[part=notice]:empty { display: none; }
#help { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
`;

const HELP = "Drag or press the arrow keys to turn, plus and minus to come closer or go away, Home to go back, " +
    "the space bar to let time run or stand still.";

// Where pages are made on a server there are no elements: the file can be imported there all the same.
const Base = globalThis.HTMLElement ?? (class {} as typeof HTMLElement);

/**
 * A black hole in a page. Events: `render` after each picture, `detail` {width, height, still}; `input` while a reader
 * moves the camera and `change` when that is over; `error`, an ErrorEvent.
 */
export class BhrHole extends Base {
    /** How elements that are made from now on make their black holes. */
    static options: Options = {};

    private readonly picture: HTMLDivElement | undefined;
    private readonly notice: HTMLParagraphElement | undefined;
    private frames: Frames | undefined;
    private over = new AbortController();
    private defaults = "";
    /** The settings that the attributes mean, as they were set last. */
    private told: Settings | undefined;
    private isPlaying = false;
    private lastTime: number | undefined;
    private isLoud = false;

    constructor() {
        super();
        const root = this.attachShadow({ mode: "open", delegatesFocus: true });
        const style = document.createElement("style");
        style.textContent = STYLE;
        const picture = document.createElement("div");
        picture.setAttribute("part", "picture");
        picture.setAttribute("role", "img");
        const notice = document.createElement("p");
        notice.setAttribute("part", "notice");
        notice.setAttribute("role", "status");
        const help = document.createElement("div");
        help.id = "help";
        help.textContent = HELP;
        root.append(style, picture, notice, help);
        [this.picture, this.notice] = [picture, notice];
    }

    /** The black hole, once there is one; a script that sets something asks for a picture by `refresh`. */
    get hole(): BlackHole | undefined {
        return this.frames?.hole;
    }

    /** Whether time runs. */
    get playing(): boolean {
        return this.isPlaying;
    }

    set playing(is: boolean) {
        this.isPlaying = is;
        this.lastTime = undefined;
        is ? this.frames?.changed(true) : this.frames?.settled();
    }

    /** Shows what a script has set in `hole`. */
    refresh(): void {
        this.frames?.changed();
        this.describe();
    }

    connectedCallback(): void {
        // One that is moved within the page stays as it is.
        if (this.frames !== undefined || this.picture === undefined) {
            return;
        }
        this.over = new AbortController();
        const { signal } = this.over;
        const own = (this.constructor as typeof BhrHole).options;
        const backend = this.getAttribute("backend") as Options["backend"];
        const options = { shared: true, ...own, ...(backend === null ? {} : { backend }) } as Options;
        const frames = new Frames(this.picture, options, {
            started: (hole, before) => this.started(hole, before, options),
            begins: (hole) => this.begins(hole),
            rendered: (size) => this.rendered(size),
            failed: (error) => this.fail(error),
        });
        this.frames = frames;
        this.watch(frames, signal);
        this.behave();
        this.picture.ariaBusy = "true";
        const timer = setTimeout(() => this.say("The first picture is being traced."), LONG_MS);
        signal.addEventListener("abort", () => clearTimeout(timer));
        this.addEventListener("render", () => clearTimeout(timer), { once: true, signal });
        this.addEventListener("error", () => clearTimeout(timer), { once: true, signal });
    }

    disconnectedCallback(): void {
        queueMicrotask(() => {
            if (!this.isConnected) {
                this.end();
            }
        });
    }

    private end(): void {
        this.over.abort();
        this.frames?.end();
        [this.frames, this.told, this.lastTime] = [undefined, undefined, undefined];
        this.say("");
    }

    /** Follows the size, whether it is to be seen, attributes, and gestures. */
    private watch(frames: Frames, signal: AbortSignal): void {
        const picture = this.picture as HTMLDivElement;
        let [isSeen, width, height] = [false, 0, 0];
        const tell = () => {
            const most = Number(this.getAttribute("max-pixels") ?? MOST_PIXELS);
            const part = Math.min(1, Math.sqrt((most >= 1 ? most : MOST_PIXELS) / Math.max(width * height, 1)));
            frames.seen(isSeen, Math.round(width * part), Math.round(height * part));
        };
        const sizes = new ResizeObserver(([entry]) => {
            const [box] = entry?.devicePixelContentBoxSize ?? [];
            const [css] = entry?.contentBoxSize ?? [];
            width = box?.inlineSize ?? (css?.inlineSize ?? 0) * devicePixelRatio;
            height = box?.blockSize ?? (css?.blockSize ?? 0) * devicePixelRatio;
            tell();
        });
        try {
            sizes.observe(picture, { box: "device-pixel-content-box" });
        } catch {
            // Safari has no such box.
            sizes.observe(picture);
        }
        const sight = new IntersectionObserver((entries) => {
            isSeen = entries.at(-1)?.isIntersecting ?? false;
            this.lastTime = undefined;
            tell();
        });
        sight.observe(picture);
        const attributes = new MutationObserver((changes) => {
            const names = new Set(changes.map(({ attributeName }) => attributeName ?? ""));
            if (names.has("max-pixels")) {
                tell();
            }
            if (names.has("backend")) {
                this.end();
                this.connectedCallback();
            } else if ([...names].some(isAttribute)) {
                this.follow(names);
            }
        });
        attributes.observe(this, { attributes: true });
        const controls = new Controls(picture, {
            move: ({ azimuth, elevation, factor }) => this.move(azimuth, elevation, factor),
            rest: () => this.rest(),
            key: (key) => this.key(key),
        });
        const calm = matchMedia("(prefers-reduced-motion: reduce)");
        calm.addEventListener("change", () => this.behave(), { signal });
        signal.addEventListener("abort", () => {
            [sizes, sight, attributes].forEach((observer) => observer.disconnect());
            controls.end();
        });
    }

    /** What the attributes say besides the scene. Time does not run by itself for readers who want little motion. */
    private behave(): void {
        const picture = this.picture as HTMLDivElement;
        this.playing = this.hasAttribute("playing") && !matchMedia("(prefers-reduced-motion: reduce)").matches;
        if (this.hasAttribute("controls")) {
            picture.tabIndex = 0;
            picture.setAttribute("aria-describedby", "help");
        } else {
            picture.removeAttribute("tabindex");
            picture.removeAttribute("aria-describedby");
        }
        this.describe();
    }

    private follow(names: ReadonlySet<string>): void {
        if (names.has("playing") || names.has("controls")) {
            this.behave();
        }
        const hole = this.hole;
        if (hole !== undefined) {
            try {
                this.apply(hole);
                this.frames?.changed();
            } catch (error) {
                this.fail(error);
            }
        }
        this.describe();
    }

    /** Sets the sections whose attributes have changed since the last time; a reader's camera stays as long as it may. */
    private apply(hole: BlackHole): void {
        const named = [...this.attributes].map(({ name, value }): [string, string] => [name, value]);
        const wanted = settingsOf(new Map(named), this.defaults);
        const told = this.told ?? {};
        const next: Settings = hole.scene;
        for (const name of new Set([...Object.keys(told), ...Object.keys(wanted)]) as Set<keyof Settings>) {
            if (textOf({ [name]: told[name] }) !== textOf({ [name]: wanted[name] })) {
                Object.assign(next, { [name]: wanted[name] });
            }
        }
        replace(hole, next);
        this.told = wanted;
        this.clear();
    }

    private async started(hole: BlackHole, before: BlackHole | undefined, { wasm }: Options): Promise<void> {
        this.defaults = (await loaded(wasm)).defaultScene();
        if (before !== undefined) {
            replace(hole, before.scene);
        }
        this.apply(hole);
        this.describe(hole);
    }

    private begins(hole: BlackHole): boolean {
        if (this.isPlaying) {
            const now = performance.now();
            // After a pause of the frames, as in a tab behind others, time goes on from where it was.
            const seconds = Math.min(now - (this.lastTime ?? now), 1000) / 1000;
            const rate = Number(this.getAttribute("rate") ?? RATE);
            hole.set({ time: (hole.scene.time ?? 0) + seconds * (Number.isFinite(rate) ? rate : RATE) });
            this.lastTime = now;
        }
        return true;
    }

    private rendered(size: { width: number; height: number; still: boolean }): void {
        (this.picture as HTMLDivElement).ariaBusy = "false";
        if (!this.isLoud) {
            this.say("");
        }
        this.dispatchEvent(new CustomEvent("render", { detail: size }));
        if (this.isPlaying) {
            this.frames?.changed(true);
        }
    }

    private move(azimuth: number, elevation: number, factor: number): void {
        const hole = this.hole;
        if (hole === undefined || !this.hasAttribute("controls")) {
            return;
        }
        const { camera } = hole.scene;
        const orbit = moved(orbitOf(camera, placeOf(this.defaults)), azimuth, elevation, factor);
        this.set(hole, { ...hole.scene, camera: placed(orbit, camera) });
        this.frames?.changed(true);
        this.dispatchEvent(new Event("input"));
    }

    private rest(): void {
        if (this.hasAttribute("controls") && !this.isPlaying) {
            this.frames?.settled();
        }
        this.describe();
        this.dispatchEvent(new Event("change"));
    }

    private key(key: string): boolean {
        const hole = this.hole;
        if (hole === undefined || !this.hasAttribute("controls")) {
            return false;
        }
        if (key === " ") {
            this.playing = !this.isPlaying;
        } else if (key === "Home") {
            this.set(hole, { ...hole.scene, camera: this.told?.camera });
            this.frames?.changed();
            this.rest();
        } else if (key === "Escape") {
            // The wheel and fingers are the page's again.
            this.picture?.blur();
        } else {
            return false;
        }
        return true;
    }

    private set(hole: BlackHole, settings: Settings): void {
        try {
            replace(hole, settings);
            this.clear();
        } catch (error) {
            this.fail(error);
        }
    }

    private describe(hole = this.hole): void {
        const sentence = this.defaults === "" ? "A black hole." : sentenceOf(hole?.scene ?? {}, this.defaults);
        this.picture?.setAttribute("aria-label", this.getAttribute("alt") ?? sentence);
    }

    private say(text: string): void {
        if (this.notice !== undefined && this.notice.textContent !== text) {
            this.notice.textContent = text;
        }
    }

    private clear(): void {
        this.isLoud = false;
        this.say("");
    }

    private fail(error: unknown): void {
        const message = error instanceof Error ? error.message : String(error);
        this.isLoud = true;
        this.say(message);
        if (this.picture !== undefined) {
            this.picture.ariaBusy = "false";
        }
        this.dispatchEvent(new ErrorEvent("error", { message, error }));
    }
}

/** Sets settings in place of what was set, or throws, and sets nothing. */
function replace(hole: BlackHole, settings: Settings): void {
    const before = hole.scene;
    try {
        hole.reset().set(settings);
    } catch (error) {
        hole.reset().set(before);
        throw error;
    }
}

if (globalThis.customElements !== undefined && customElements.get("bhr-hole") === undefined) {
    customElements.define("bhr-hole", BhrHole);
}
