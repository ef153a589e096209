// SPDX-License-Identifier: MIT OR Apache-2.0
// index.ts -- black holes in a page: the class BlackHole. What a scene is made of stands in scene.d.ts; all that
// computes is WebAssembly.

import { loaded, type Source } from "./load.js";
import { link as linkOf, settingsOf } from "./link.js";
import { merged, textOf, type Settings } from "./settings.js";
import { shareOf } from "./shared.js";
import { CpuTracer, GpuTracer, type Adapter, type Image, type Pixels, type Stats, type Traces } from "./tracers.js";

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

/** A black hole, with what is about it, and a tracer that shows it. */
export class BlackHole {
    /** Resolves with an error when the device is lost: make another one then, with these settings. */
    readonly lost: Promise<Error>;
    private settings: Settings = {};
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
     * Shows the scene in the canvas, in as many pixels as the canvas has (`canvas.width`, `canvas.height`). Resolves
     * when the frame is there. While a frame is under way, further calls have one more frame made, of the scene as it
     * is when that begins.
     */
    render(): Promise<void> {
        const canvas = this.canvas;
        if (canvas === undefined) {
            return Promise.reject(new TypeError("there is no canvas: create it with one, or ask for an image"));
        }
        this.next ??= this.after(() => {
            this.next = undefined;
            return this.traces.paint(textOf(this.settings), canvas);
        });
        return this.next;
    }

    /** The frame in memory, in 8 bits a channel. */
    async image(width: number, height: number): Promise<ImageData> {
        const { pixels } = await this.pixels(width, height, "rgba8");
        return new ImageData(pixels as Uint8ClampedArray<ArrayBuffer>, width, height);
    }

    /** The frame's light before the film: linear, premultiplied, in floats; red, green, blue, alpha of each pixel. */
    async light(width: number, height: number): Promise<Float32Array> {
        return (await this.pixels(width, height, "rgba32f")).pixels as Float32Array;
    }

    private pixels(width: number, height: number, format: Pixels): Promise<Image> {
        for (const [name, side] of [["width", width], ["height", height]] as const) {
            if (!Number.isInteger(side) || side < 1 || side > 0xffffffff) {
                return Promise.reject(new RangeError(`${name} is ${side}; it must be a whole number from 1 on`));
            }
        }
        const text = textOf(this.settings);
        return this.after(() => this.traces.image(text, width, height, format));
    }

    /** The text of the scene, as scene files have it, with every field (docs/scenes.md). */
    text(): string {
        return this.wasm.wholeScene(textOf(this.settings), 0);
    }

    /** What differs from a new scene, as the readable part of an address behind "#". */
    link(): string {
        return linkOf(this.settings, this.wasm.defaultScene());
    }

    /** Sets all that a link says, in place of what was set. Throws for one that says no scene, and changes nothing. */
    load(link: string): this {
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
