// SPDX-License-Identifier: MIT OR Apache-2.0
// tracers.ts -- the two tracers of a page behind one face: WebGPU on the page's thread, and the CPU tracer in a worker.
// Each call is awaited before the next.

import { ended, unlessEnded, type loaded, type Source } from "./load.js";
import type { Answer, Order } from "./worker.js";
import type { DeviceHandle, Tracer } from "./wasm/bhr.js";

/** Formats of images in memory. */
export type Pixels = "rgba8" | "rgba32f";

/** Packed rows of red, green, blue and alpha. */
export interface Image {
    pixels: Uint8ClampedArray | Float32Array;
}

/** What traces. */
export interface Adapter {
    backend: "webgpu" | "cpu";
    name: string;
    driver: string;
    discrete: boolean;
    /** Whether no hardware is behind it. */
    software: boolean;
}

/** Numbers about a frame, as BhrFrameStats; times in nanoseconds. */
export interface Stats {
    frame_index: number;
    rays: number;
    steps: number;
    cpu_ns: number;
    gpu_ns: number;
    readback_ns: number;
    device_bytes: number;
    lens_tables: number;
    auto_ev: number;
}

/** Width and height, in pixels. */
export type Size = readonly [number, number];

/** A tracer. A frame that its signal ends rejects with the `code` CANCELLED. */
export interface Traces {
    readonly adapter: Adapter;
    readonly stats: Stats;
    readonly lost: Promise<Error>;
    paint(scene: string, canvas: HTMLCanvasElement, size: Size, signal?: AbortSignal): Promise<void>;
    image(scene: string, size: Size, format: Pixels, signal?: AbortSignal): Promise<Image>;
    setSkyMap(picture: ImageData | undefined): Promise<void>;
    setFilmLut(cube: string | undefined): Promise<void>;
    /** Another tracer has painted in the canvas of the next frame. */
    forgetCanvas(): void;
    loseDevice(): void;
    end(): void;
}

/** The pixels of bytes. */
export function pixelsOf(bytes: Uint8Array, format: Pixels): Image {
    const { buffer, byteOffset, byteLength } = bytes;
    const pixels =
        format === "rgba8"
            ? new Uint8ClampedArray(buffer, byteOffset, byteLength)
            : new Float32Array(buffer, byteOffset, byteLength / 4);
    return { pixels };
}

/** The bytes of a picture, which are not copied. */
function bytesOf(picture: ImageData | undefined): Uint8Array | undefined {
    return picture && new Uint8Array(picture.data.buffer, picture.data.byteOffset, picture.data.byteLength);
}

/** A promise with what settles it. */
function promised<T>(): { promise: Promise<T>; resolve: (value: T) => void } {
    let resolve!: (value: T) => void;
    const promise = new Promise<T>((done) => (resolve = done));
    return { promise, resolve };
}

/** WebGPU. */
export class GpuTracer implements Traces {
    readonly adapter: Adapter;
    readonly lost: Promise<Error>;
    /** Kept here: the module lends a tracer that has a frame under way to nobody. */
    stats: Stats;
    private readonly tell: (error: Error) => void;
    /** Apart from the tracer, so that it can be lost while a frame is under way. */
    private readonly device: DeviceHandle;
    private isOver = false;

    private constructor(private readonly tracer: Tracer) {
        this.adapter = tracer.adapter() as Adapter;
        this.stats = tracer.stats() as Stats;
        this.device = tracer.device();
        const { promise, resolve } = promised<Error>();
        [this.lost, this.tell] = [promise, resolve];
    }

    static async start(wasm: Awaited<ReturnType<typeof loaded>>): Promise<GpuTracer> {
        const tracer = await unlessEnded(wasm.Tracer.onWebGpu());
        const gpu = new GpuTracer(tracer);
        void tracer.lost().then(gpu.tell);
        ended.catch(gpu.tell);
        return gpu;
    }

    async paint(scene: string, canvas: HTMLCanvasElement, [width, height]: Size, signal?: AbortSignal): Promise<void> {
        this.check();
        await unlessEnded(this.tracer.paint(scene, 0, canvas, width, height, signal));
        this.stats = this.tracer.stats() as Stats;
    }

    async image(scene: string, [width, height]: Size, format: Pixels, signal?: AbortSignal): Promise<Image> {
        this.check();
        const bytes = await unlessEnded(this.tracer.image(scene, 0, width, height, format === "rgba32f", signal));
        this.stats = this.tracer.stats() as Stats;
        return pixelsOf(bytes, format);
    }

    async setSkyMap(picture: ImageData | undefined): Promise<void> {
        this.check();
        const { width = 0, height = 0 } = picture ?? {};
        await unlessEnded(this.tracer.setSkyMap(bytesOf(picture), width, height));
    }

    async setFilmLut(cube: string | undefined): Promise<void> {
        this.check();
        this.tracer.setFilmLut(cube);
    }

    forgetCanvas(): void {
        this.check();
        this.tracer.forgetCanvas();
    }

    loseDevice(): void {
        this.check();
        this.device.lose();
    }

    end(): void {
        if (!this.isOver) {
            this.isOver = true;
            this.device.free();
            this.tracer.free();
        }
    }

    /** Throws once it has ended. */
    private check(): void {
        if (this.isOver) {
            throw destroyed();
        }
    }
}

/** The CPU tracer, in a worker. */
export class CpuTracer implements Traces {
    readonly lost: Promise<Error>;
    stats: Stats;
    private waiting: { done: (answer: Answer) => void; failed: (error: Error) => void } | undefined;
    /** Why the worker answers no more. */
    private over: Error | undefined;

    private constructor(
        private readonly worker: Worker,
        readonly adapter: Adapter,
        first: Stats,
    ) {
        this.stats = first;
        const { promise, resolve } = promised<Error>();
        this.lost = promise;
        worker.onmessage = ({ data }: MessageEvent<Answer>) => this.settle(({ done }) => done(data));
        worker.onerror = (event) => {
            const message = `the worker of the CPU tracer ended: ${event.message}`;
            const error = Object.assign(new Error(message), { code: "DEVICE_LOST" });
            this.over ??= error;
            worker.terminate();
            resolve(error);
            this.settle(({ failed }) => failed(error));
        };
    }

    static async start(make: (() => Worker) | undefined, source: Source | undefined): Promise<CpuTracer> {
        const worker = make?.() ?? new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
        const answer = await new Promise<Answer>((resolve, reject) => {
            worker.onmessage = ({ data }: MessageEvent<Answer>) => resolve(data);
            worker.onerror = (event) => reject(new Error(`the worker of the CPU tracer: ${event.message}`));
            // A response cannot be sent to a worker, which fetches the module by itself.
            const plain = source instanceof URL ? source.href : typeof source === "string" ? source : undefined;
            const absolute = plain === undefined ? undefined : new URL(plain, location.href).href;
            worker.postMessage({ kind: "start", wasm: absolute } satisfies Order);
        });
        if (answer.kind !== "started") {
            worker.terminate();
            throw failure(answer);
        }
        return new CpuTracer(worker, answer.adapter, answer.stats);
    }

    async paint(scene: string, canvas: HTMLCanvasElement, size: Size, signal?: AbortSignal): Promise<void> {
        const [width, height] = size;
        const { pixels } = await this.image(scene, size, "rgba8", signal);
        const context = canvas.getContext("2d");
        if (context === null) {
            throw new Error("the canvas has another context than the CPU tracer's, which is 2d");
        }
        if (canvas.width !== width || canvas.height !== height) {
            [canvas.width, canvas.height] = [width, height];
        }
        context.putImageData(new ImageData(pixels as Uint8ClampedArray<ArrayBuffer>, width, height), 0, 0);
    }

    async image(scene: string, [width, height]: Size, format: Pixels, signal?: AbortSignal): Promise<Image> {
        check(signal);
        const answer = await this.ask({ kind: "image", scene, width, height, format });
        if (answer.kind !== "image") {
            throw failure(answer);
        }
        check(signal);
        this.stats = answer.stats;
        return pixelsOf(answer.bytes, format);
    }

    async setSkyMap(picture: ImageData | undefined): Promise<void> {
        const { width = 0, height = 0 } = picture ?? {};
        await this.take({ kind: "map", pixels: bytesOf(picture), width, height });
    }

    setFilmLut(cube: string | undefined): Promise<void> {
        return this.take({ kind: "lut", cube });
    }

    forgetCanvas(): void {
        // A canvas' 2d context is the page's, whoever draws.
    }

    private ask(order: Order): Promise<Answer> {
        if (this.over !== undefined) {
            return Promise.reject(this.over);
        }
        return new Promise((done, failed) => {
            this.waiting = { done, failed };
            this.worker.postMessage(order);
        });
    }

    private async take(order: Order): Promise<void> {
        const answer = await this.ask(order);
        if (answer.kind !== "taken") {
            throw failure(answer);
        }
    }

    loseDevice(): void {
        if (this.over !== undefined) {
            throw this.over;
        }
        this.worker.onerror?.(new ErrorEvent("error", { message: "a test asked" }));
    }

    end(): void {
        this.worker.terminate();
        const error = destroyed();
        this.over ??= error;
        this.settle(({ failed }) => failed(error));
    }

    private settle(how: (waiting: NonNullable<typeof this.waiting>) => void): void {
        const waiting = this.waiting;
        this.waiting = undefined;
        if (waiting !== undefined) {
            how(waiting);
        }
    }
}

/** The error of calls after the end. */
export function destroyed(): Error {
    return Object.assign(new Error("the black hole was destroyed"), { code: "INVALID_STATE" });
}

/** Throws once the signal is aborted, as the module does. */
function check(signal: AbortSignal | undefined): void {
    if (signal?.aborted) {
        throw Object.assign(new Error("the page's AbortSignal cancelled the frame"), { code: "CANCELLED" });
    }
}

/** The error that a worker tells of. */
function failure(answer: Answer): Error {
    if (answer.kind !== "failed") {
        return new Error("the worker of the CPU tracer answers something else");
    }
    return Object.assign(new Error(answer.message), { code: answer.code });
}
