// SPDX-License-Identifier: MIT OR Apache-2.0
// index.ts -- black holes in a page: the class BlackHole. What a scene is made of stands in scene.d.ts; all that
// computes is WebAssembly.

import { loaded, type Source } from "./load.js";
import { link as linkOf, settingsOf } from "./link.js";
import type { Crossing, HoleInfo, Ray, Vector } from "./scene.js";
import { merged, textOf, type Settings } from "./settings.js";
import { shareOf } from "./shared.js";
import { CpuTracer, GpuTracer, type Adapter, type Image, type Pixels, type Stats, type Traces } from "./tracers.js";
import { settingsOfText } from "./written.js";

export type { Settings } from "./settings.js";
export type { Adapter, Image, Pixels, Stats } from "./tracers.js";
export type * from "./scene.js";
export type * from "./words.js";

/** How a black hole is made. */
export interface Options {
    /** What traces: "webgpu"; "cpu", in double precision and slow; "auto", the default: WebGPU, or the CPU without. */
    backend?: "auto" | "webgpu" | "cpu";
    /** Where bhr_bg.wasm is: by default beside this script. */
    wasm?: Source;
    /** The worker of the CPU tracer: by default made of worker.js beside this script. */
    worker?: () => Worker;
    /** Whether it takes turns with others at one tracer, and so at one device: for pages with many canvases. */
    shared?: boolean;
}

/** How a frame is made. */
export interface FrameOptions {
    /**
     * Ends the frame early: its promise rejects with the `code` CANCELLED. WebGPU ends between two steps of a frame; a
     * frame of the CPU tracer is finished all the same, and not shown.
     */
    signal?: AbortSignal | undefined;
}

/** How a frame in a canvas is made. */
export interface CanvasOptions extends FrameOptions {
    /** The pixels of the canvas from this frame on, until which it keeps its picture; by default `canvas.width`. */
    width?: number | undefined;
    /** Likewise the height; by default `canvas.height`. */
    height?: number | undefined;
}

/** A ray of light, followed back from the observer: bhr.h's BhrRay, what it hits as BhrHit, and its path. */
export interface TracedRay extends Ray {
    /** Where it ends: behind the horizon, on the sky, or nowhere within `quality.max_steps`. */
    fate: "captured" | "escaped" | "unresolved" | "invalid";
    /** Integration steps. */
    steps: number;
    /** Asymptotic, unit, scene axes; 0 unless escaped. */
    sky_direction: Vector;
    /** g = nu(camera) / nu(at infinity); NaN unless escaped. */
    sky_redshift: number;
    /** Spin 0: orbit angle to infinity, or to the horizon, radians; with spin NaN. */
    swept_angle: number;
    /** Those of the equatorial plane, in order along the ray. */
    crossings: Crossing[];
    /** x, y, z, t of each of up to 2048 points, in scene axes and lengths, from the observer on (bhr_trace_path). */
    path: Float64Array;
}

/** A black hole, with what is about it, and a tracer that shows it. */
export class BlackHole {
    /** Resolves with an error when the device is lost: make another one then, with these settings. */
    readonly lost: Promise<Error>;
    private settings: Settings = {};
    /** The options of the next frame in the canvas. */
    private wanted: CanvasOptions = {};
    private last: Promise<unknown> = Promise.resolve();
    private next: Promise<void> | undefined;

    private constructor(
        private readonly traces: Traces,
        /** The canvas that `render` paints, if there is one. */
        readonly canvas: HTMLCanvasElement | undefined,
        private readonly wasm: Awaited<ReturnType<typeof loaded>>,
    ) {
        this.lost = traces.lost;
    }

    /**
     * A black hole for a canvas, which no other context was asked of, or for images alone. Rejects with an error whose
     * `code` is NO_ADAPTER where `backend` is "webgpu" and the browser has none.
     */
    static async create(canvas?: HTMLCanvasElement | null, options: Options = {}): Promise<BlackHole> {
        const { backend = "auto", wasm: source, worker, shared = false } = options;
        if (backend !== "auto" && backend !== "webgpu" && backend !== "cpu") {
            throw new TypeError(`backend is ${String(backend)}; it must be "auto", "webgpu" or "cpu"`);
        }
        const wasm = await loaded(source);
        const onCpu = () => CpuTracer.start(worker, source);
        const onGpu = () => GpuTracer.start(wasm);
        const start: () => Promise<Traces> = () =>
            backend === "cpu" ? onCpu() : backend === "webgpu" ? onGpu() : onGpu().catch(onCpu);
        const traces = await (shared ? shareOf(backend, start) : start());
        return new BlackHole(traces, canvas ?? undefined, wasm);
    }

    /** What was set, as an object of its own. */
    get scene(): Settings {
        return structuredClone(this.settings);
    }

    /** The adapter that traces. */
    get adapter(): Adapter {
        return this.traces.adapter;
    }

    /** Numbers about the last finished frame. */
    get stats(): Stats {
        return this.traces.stats;
    }

    /**
     * Sets what the object names; the rest stays. `undefined` takes back what was set; lists are replaced as a whole.
     * Throws bhr.h's message for a value out of range, and then changes nothing.
     */
    set(settings: Settings): this {
        const wanted = merged(this.settings, settings);
        this.wasm.checkScene(textOf(wanted), 0);
        this.settings = wanted;
        return this;
    }

    /** Takes back all that was set. */
    reset(): this {
        this.settings = {};
        return this;
    }

    /**
     * Shows the scene in the canvas, in as many pixels as the canvas has (`canvas.width`, `canvas.height`) or as the
     * options ask for. Resolves when the frame is there. While a frame is under way, further calls have one more frame
     * made, of the scene as it is when that begins, and with the last call's options.
     */
    async render(options?: CanvasOptions | null): Promise<void> {
        const canvas = this.canvas;
        if (canvas === undefined) {
            throw new TypeError("there is no canvas: create it with one, or ask for an image");
        }
        const asked = checked(options);
        checkSize(asked.width ?? canvas.width, asked.height ?? canvas.height);
        this.wanted = asked;
        this.next ??= this.after(() => {
            this.next = undefined;
            const { width = canvas.width, height = canvas.height, signal } = this.wanted;
            // Two tracers paint a canvas in turn, each of which has to configure it anew.
            if (painters.get(canvas) !== this.traces) {
                painters.set(canvas, this.traces);
                this.traces.forgetCanvas();
            }
            return this.traces.paint(textOf(this.settings), canvas, [width, height], signal);
        });
        return this.next;
    }

    /** The frame in memory, in 8 bits a channel. */
    async image(width: number, height: number, options?: FrameOptions | null): Promise<ImageData> {
        const { pixels } = await this.pixels(width, height, "rgba8", options);
        return new ImageData(pixels as Uint8ClampedArray<ArrayBuffer>, width, height);
    }

    /** The frame's light before the film: linear, premultiplied, in floats; red, green, blue, alpha of each pixel. */
    async light(width: number, height: number, options?: FrameOptions | null): Promise<Float32Array> {
        return (await this.pixels(width, height, "rgba32f", options)).pixels as Float32Array;
    }

    /**
     * Gives the sky's flag "map" its picture: the whole sky, equirectangular, as bhr.h's bhr_set_sky_map has it;
     * `undefined` takes it away. Set `sky: { flags: ["map"] }` to see it. A link does not hold it.
     */
    async setSkyMap(picture: ImageData | ImageBitmap | undefined): Promise<void> {
        if (!(picture === undefined || picture instanceof ImageData || picture instanceof ImageBitmap)) {
            throw new TypeError("a sky map is an ImageData or an ImageBitmap; createImageBitmap makes one of others");
        }
        const pixels = picture instanceof ImageBitmap ? pixelsOf(picture) : picture;
        return this.after(() => this.traces.setSkyMap(pixels));
    }

    /** Gives the film the LUT in the text of a .cube file; `undefined` takes it away. A link does not hold it. */
    async setFilmLut(cube: string | undefined): Promise<void> {
        if (cube !== undefined) {
            checkText(cube, "a LUT");
        }
        return this.after(() => this.traces.setFilmLut(cube));
    }

    /**
     * The ray through a position in pixels of a frame of such a size, traced at once in double precision: (0, 0) is the
     * upper left corner, (0.5, 0.5) the middle of the first pixel. Throws bhr.h's messages.
     */
    ray(x: number, y: number, width: number, height: number): TracedRay {
        checkSize(width, height);
        return this.wasm.tracedRay(textOf(this.settings), 0, Number(x), Number(y), width, height) as TracedRay;
    }

    /** Numbers about the hole and the camera's observer, as they are set: bhr.h's BhrHoleInfo. */
    info(): HoleInfo {
        return this.wasm.holeInfo(textOf(this.settings), 0) as HoleInfo;
    }

    private async pixels(
        width: number,
        height: number,
        format: Pixels,
        options: FrameOptions | null | undefined,
    ): Promise<Image> {
        const { signal } = checked(options);
        checkSize(width, height);
        const text = textOf(this.settings);
        return this.after(() => this.traces.image(text, [width, height], format, signal));
    }

    /** The text of the scene, as scene files have it, with every field (docs/scenes.md). */
    text(): string {
        return this.wasm.wholeScene(textOf(this.settings), 0);
    }

    /**
     * Sets all that a scene file says, in place of what was set; of what moves in it, how it is after so many seconds.
     * Throws for what is no scene, or names files, and changes nothing.
     */
    read(text: string, seconds = 0): this {
        checkText(text, "a scene file");
        if (!Number.isFinite(seconds)) {
            throw new RangeError(`seconds is ${String(seconds)}; it must be finite`);
        }
        this.settings = settingsOfText(this.wasm.wholeScene(text, seconds));
        return this;
    }

    /** What differs from a new scene, as the readable part of an address behind "#". */
    link(): string {
        return linkOf(this.settings, this.wasm.defaultScene());
    }

    /** Sets all that a link says, in place of what was set. Throws for one that says no scene, and changes nothing. */
    load(link: string): this {
        checkText(link, "a link");
        const settings = settingsOf(link, this.wasm.defaultScene());
        this.wasm.checkScene(textOf(settings), 0);
        this.settings = settings;
        return this;
    }

    /** Gives the device back. Calls after this one reject. */
    destroy(): Promise<void> {
        return this.after(() => this.traces.end());
    }

    /** Destroys the device, as a driver may at any time: for tests. */
    loseDevice(): void {
        this.traces.loseDevice();
    }

    /** One call after another: the tracer does one thing at a time. */
    private after<T>(work: () => Promise<T> | T): Promise<T> {
        const done = this.last.then(work, work);
        this.last = done.catch(() => undefined);
        return done;
    }
}

/** The pixels of a picture of the browser's. */
function pixelsOf(picture: ImageBitmap): ImageData {
    const place = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
    if (place === null) {
        throw new Error("the browser gives no place to draw the picture in");
    }
    place.drawImage(picture, 0, 0);
    return place.getImageData(0, 0, picture.width, picture.height);
}

/** Which tracer has painted a canvas last. */
const painters = new WeakMap<HTMLCanvasElement, Traces>();

/** The options of a frame. Throws for a signal that is none: the module would wait for it for ever. */
function checked<T extends FrameOptions>(options: T | null | undefined): T {
    const { signal } = options ?? {};
    if (signal !== undefined && !(signal instanceof AbortSignal)) {
        throw new TypeError("signal is no AbortSignal");
    }
    return (options ?? {}) as T;
}

/** Throws for a size that no frame has. */
function checkSize(width: number, height: number): void {
    for (const [name, side] of Object.entries({ width, height })) {
        if (!Number.isInteger(side) || side < 1 || side > 0xffffffff) {
            throw new RangeError(`${name} is ${String(side)}; it must be a whole number from 1 on`);
        }
    }
}

/** Throws for what is no text, which the module cannot take. */
function checkText(text: unknown, name: string): void {
    if (typeof text !== "string") {
        throw new TypeError(`${name} is text; this is ${text === null ? "null" : `a ${typeof text}`}`);
    }
}
