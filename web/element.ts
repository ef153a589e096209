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
/** Milliseconds without a key or a turn of the wheel after which a reader has stopped moving. */
const REST_MS = 300;
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
[part=notice] { position: absolute; inset: auto 0 0 0; margin: 0 auto 0.75em; width: fit-content;
    box-sizing: border-box; max-width: calc(100% - 1.5em); padding: 0.5em 0.9em; border-radius: 0.5em;
    background: rgb(20 22 28 / 88%); font: 0.875rem/1.4 system-ui, sans-serif; overflow-wrap: anywhere;
    pointer-events: none; }
[part=notice] > span { display: -webkit-box; -webkit-box-orient: vertical; -webkit-line-clamp: 3; overflow: hidden; }
[part=notice][hidden] { display: none; }
#help { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
`;

const HELP = "Drag or press the arrow keys to turn, plus and minus to come closer or go away, Home to go back, " +
    "the space bar to start or pause time.";

// Where pages are made on a server there are no elements: the file can be imported there all the same.
const Base = globalThis.HTMLElement ?? (class {} as typeof HTMLElement);

/**
 * A black hole in a page. Events: `render` after each picture, `detail` {width, height, still}; `input` while a reader
 * moves the camera and `change` when that is over; `error`, an ErrorEvent.
 */
export class BhrHole extends Base {
    /** How elements that come into the page from now on make their black holes. */
    static options: Options | Promise<Options> = {};

    private readonly picture: HTMLDivElement | undefined;
    private readonly notice: HTMLParagraphElement | undefined;
    private frames: Frames | undefined;
    private over = new AbortController();
    private defaults = "";
    /** The settings that the attributes mean, as they were set last. */
    private told: Settings | undefined;
    /** Attributes that `show` was given before there was a black hole. */
    private awaited: Readonly<Record<string, string>> | undefined;
    /** The camera that the key Home goes back to. */
    private home: Settings["camera"];
    private isPlaying = false;
    private lastTime: number | undefined;
    private isLoud = false;
    /** Runs while a reader moves the camera. */
    private moving: ReturnType<typeof setTimeout> | undefined;

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
        // Lists of names in a message may be long: the event has all of it.
        notice.append(document.createElement("span"));
        notice.hidden = true;
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

    /** Whether time stands still. No property is called `playing`: React would set that in place of the attribute. */
    get paused(): boolean {
        return !this.isPlaying;
    }

    /** Lets time run. */
    play(): void {
        this.isPlaying = true;
        this.lastTime = undefined;
        this.frames?.changed(true);
    }

    /** Lets time stand still. */
    pause(): void {
        this.isPlaying = false;
        this.frames?.settled();
    }

    /** Shows what a script has set in `hole`. */
    refresh(): void {
        this.frames?.changed();
        this.describe();
    }

    /** Shows what attributes would mean, in place of all that was set; those of the element stay as they are. */
    show(attributes: Readonly<Record<string, string>>): void {
        const hole = this.hole;
        this.awaited = hole === undefined ? attributes : undefined;
        if (hole !== undefined) {
            this.attempt(hole, () => this.replaceBy(hole, attributes));
        }
    }

    connectedCallback(): void {
        // One that is moved within the page stays as it is.
        if (this.frames !== undefined || this.picture === undefined) {
            return;
        }
        this.over = new AbortController();
        const { signal } = this.over;
        const options = this.options();
        const frames: Frames = new Frames(this.picture, options, {
            started: async (hole, before) => this.started(frames, hole, before, await options),
            begins: (hole) => this.begins(hole),
            rendered: (size) => this.rendered(size),
            failed: (error) => this.fail(error),
        });
        this.frames = frames;
        this.watch(frames, signal);
        this.setTime();
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

    private async options(): Promise<Options> {
        const backend = this.getAttribute("backend");
        const own = backend === null ? {} : { backend: backend as NonNullable<Options["backend"]> };
        return { shared: true, ...(await (this.constructor as typeof BhrHole).options), ...own };
    }

    private end(): void {
        this.over.abort();
        clearTimeout(this.moving);
        this.moving = undefined;
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
            frames.seen(isSeen, Math.floor(width * part), Math.floor(height * part));
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
        calm.addEventListener("change", () => this.setTime(), { signal });
        signal.addEventListener("abort", () => {
            [sizes, sight, attributes].forEach((observer) => observer.disconnect());
            controls.end();
        });
    }

    /** Lets time run or stand still, as `playing` says; for readers who want little motion it stands still at first. */
    private setTime(): void {
        const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
        this.hasAttribute("playing") && !isCalm ? this.play() : this.pause();
    }

    /** What the attributes say besides scene and time. */
    private behave(): void {
        const picture = this.picture as HTMLDivElement;
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
        if (names.has("playing")) {
            this.setTime();
        }
        if (names.has("controls")) {
            this.behave();
        }
        const hole = this.hole;
        if (hole !== undefined) {
            this.attempt(hole, () => this.apply(hole));
        } else {
            this.describe();
        }
    }

    /** Sets something, and shows it if it is something else; or says what is wrong with it. */
    private attempt(hole: BlackHole, set: () => void, isMoving = false): void {
        const before = textOf(hole.scene);
        try {
            set();
            this.clear();
            if (textOf(hole.scene) !== before) {
                this.frames?.changed(isMoving);
            }
        } catch (error) {
            this.fail(error);
        }
        if (!isMoving) {
            this.describe();
        }
    }

    /** Sets the sections whose attributes have changed since the last time; the rest stays as a reader has moved it. */
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
        [this.told, this.home] = [wanted, wanted.camera];
    }

    private replaceBy(hole: BlackHole, attributes: Readonly<Record<string, string>>): void {
        const settings = settingsOf(new Map(Object.entries(attributes)), this.defaults);
        replace(hole, settings);
        this.home = settings.camera;
    }

    private async started(
        frames: Frames,
        hole: BlackHole,
        before: BlackHole | undefined,
        { wasm }: Options,
    ): Promise<void> {
        const defaults = (await loaded(wasm)).defaultScene();
        if (frames !== this.frames) {
            // The element was removed meanwhile, and may have other frames already.
            return;
        }
        this.defaults = defaults;
        if (before !== undefined) {
            replace(hole, before.scene);
        }
        this.apply(hole);
        if (this.awaited !== undefined) {
            this.replaceBy(hole, this.awaited);
            this.awaited = undefined;
        }
        this.clear();
        this.describe(hole);
    }

    private begins(hole: BlackHole): boolean {
        if (this.isPlaying) {
            const now = performance.now();
            // After a pause of the frames, as in a tab behind others, time goes on from where it was.
            const seconds = Math.min(now - (this.lastTime ?? now), 1000) / 1000;
            const rate = Number(this.getAttribute("rate") ?? RATE);
            hole.set({ time: Number(hole.scene.time ?? 0) + seconds * (Number.isFinite(rate) ? rate : RATE) });
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
        this.attempt(hole, () => replace(hole, { ...hole.scene, camera: placed(orbit, camera) }), true);
        this.dispatchEvent(new Event("input"));
        clearTimeout(this.moving);
        this.moving = setTimeout(() => this.rest(), REST_MS);
    }

    /** A reader has stopped moving the camera. */
    private rest(): void {
        clearTimeout(this.moving);
        if (this.moving === undefined) {
            return;
        }
        this.moving = undefined;
        if (!this.isPlaying) {
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
            this.isPlaying ? this.pause() : this.play();
        } else if (key === "Home") {
            this.attempt(hole, () => replace(hole, { ...hole.scene, camera: this.home }));
            this.dispatchEvent(new Event("change"));
        } else if (key === "Escape") {
            // The wheel and fingers are the page's again.
            this.picture?.blur();
        } else {
            return false;
        }
        return true;
    }

    private describe(hole = this.hole): void {
        const sentence = this.defaults === "" ? "A black hole." : sentenceOf(hole?.scene ?? {}, this.defaults);
        this.picture?.setAttribute("aria-label", this.getAttribute("alt") ?? sentence);
    }

    private say(text: string): void {
        const place = this.notice?.firstElementChild;
        if (this.notice && place && place.textContent !== text) {
            place.textContent = text;
            this.notice.hidden = text === "";
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
