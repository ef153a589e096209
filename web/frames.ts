// SPDX-License-Identifier: MIT OR Apache-2.0
// frames.ts -- when an element's black hole is traced, and in how many pixels: only where it is seen, one frame at a
// time, fewer pixels while something moves and all of them at rest; and a new tracer after the device was lost. Knows
// no attributes and no gestures.

import { BlackHole, type Options } from "./index.js";

/** Who is told of frames. Errors that the others throw are passed to `failed`. */
export interface Listener {
    /** A black hole with a tracer is there, and nothing set; `before`: the one whose device was lost. */
    started(hole: BlackHole, before: BlackHole | undefined): Promise<void> | void;
    /** Whether there is something to show; the moment to set what changes with time. */
    begins(hole: BlackHole): boolean;
    rendered(size: { width: number; height: number; still: boolean }): void;
    failed(error: unknown): void;
}

/** Milliseconds that a frame may take while something moves. */
const BUDGET_MS = 33;
/** Part of all pixels that such a frame has at least. */
const LEAST = 1 / 64;
/** Pixels that a frame of the CPU tracer has at most, which takes a second or two. */
const MOST_ON_CPU = 250000;
/** Pixels along a side that every device has. */
const MOST_SIDE = 8192;
/** Milliseconds without a change after which all is at rest. */
const REST_MS = 250;
/** Losses of the device within a minute after which no new one is asked for. */
const MOST_LOSSES = 3;

type Wanted = "still" | "moving" | undefined;

/** The frames of one element. */
export class Frames {
    /** Where they are shown, over one another while a tracer takes another one's place. */
    private canvases: HTMLCanvasElement[] = [];
    private wanted: Wanted;
    private isAtWork = false;
    private isSeen = false;
    private isOver = false;
    private size = { width: 0, height: 0 };
    private made: BlackHole | undefined;
    private before: BlackHole | undefined;
    /** Pixels of a frame while something moves, and how many frames there have been since the tracer is there. */
    private budget = 0;
    private count = 0;
    private losses: number[] = [];
    private underWay: { signal: AbortController; how: Wanted } | undefined;
    private rest: ReturnType<typeof setTimeout> | undefined;
    private lastChange = -Infinity;

    constructor(
        private readonly place: HTMLElement,
        private readonly options: Options | Promise<Options>,
        private readonly listener: Listener,
    ) {}

    /** The black hole, once it is there. */
    get hole(): BlackHole | undefined {
        return this.made;
    }

    /** The pixels that the element has, and whether any of it is to be seen. */
    seen(isSeen: boolean, width: number, height: number): void {
        const other = width !== this.size.width || height !== this.size.height;
        this.size = { width, height };
        this.isSeen = isSeen && width > 0 && height > 0;
        if (other) {
            this.changed();
        } else {
            void this.work();
        }
    }

    /** The scene is another one. `isMoving`: more changes will come soon, as in a drag. */
    changed(isMoving = false): void {
        const now = performance.now();
        const moving = isMoving || now - this.lastChange < REST_MS;
        this.lastChange = now;
        this.wanted = moving ? "moving" : "still";
        clearTimeout(this.rest);
        if (moving) {
            this.rest = setTimeout(() => this.settled(), REST_MS);
            // A frame with all pixels may take long, and would show a scene that is no longer set.
            if (this.underWay?.how === "still" && this.count > 0) {
                this.underWay.signal.abort();
            }
        }
        void this.work();
    }

    /** The next frame has all pixels. */
    settled(): void {
        clearTimeout(this.rest);
        this.lastChange = -Infinity;
        this.wanted = "still";
        void this.work();
    }

    /** Frees the tracer and all that it has. */
    end(): void {
        this.isOver = true;
        clearTimeout(this.rest);
        this.underWay?.signal.abort();
        this.forget(this.made);
        this.made = undefined;
        this.canvases.forEach((canvas) => canvas.remove());
        this.canvases = [];
    }

    private forget(hole: BlackHole | undefined): void {
        // A tracer that has ended cannot be freed any more.
        hole?.destroy().catch(() => undefined);
    }

    private async work(): Promise<void> {
        if (this.isAtWork) {
            return;
        }
        this.isAtWork = true;
        try {
            while (this.wanted !== undefined && this.isSeen && !this.isOver) {
                // No frame is asked for in a tab that is not shown.
                await new Promise((done) => requestAnimationFrame(done));
                if (this.isSeen && !this.isOver) {
                    await this.frame();
                }
            }
        } catch (error) {
            this.wanted = undefined;
            if (!this.isOver) {
                this.listener.failed(error);
            }
        } finally {
            this.isAtWork = false;
        }
    }

    private async frame(): Promise<void> {
        const hole = this.made ?? (await this.start());
        const how = this.wanted;
        this.wanted = undefined;
        if (how === undefined || this.isOver || !this.listener.begins(hole)) {
            return;
        }
        const size = this.pixels(how, hole.adapter.backend === "cpu" ? MOST_ON_CPU : Infinity);
        const signal = new AbortController();
        this.underWay = { signal, how };
        const begin = performance.now();
        try {
            await hole.render({ ...size, signal: signal.signal });
        } catch (error) {
            const { code } = error as { code?: unknown };
            if (code === "DEVICE_LOST") {
                this.wanted ??= how;
                this.lost(hole, error);
                return;
            }
            if (code !== "CANCELLED") {
                throw error;
            }
            // Whoever cancels it wants another one.
            return;
        } finally {
            this.underWay = undefined;
        }
        if (this.isOver) {
            return;
        }
        this.count++;
        // The first frame waits for kernels to be compiled, and tells nothing about the next.
        if (this.count > 1) {
            const fitting = (size.width * size.height * BUDGET_MS) / Math.max(performance.now() - begin, 1);
            this.budget = Math.min(Math.max(fitting, this.budget / 2), this.budget * 2);
        }
        this.canvases.splice(0, this.canvases.length - 1).forEach((canvas) => canvas.remove());
        this.listener.rendered({ ...size, still: how === "still" });
    }

    /** Width and height of a frame, of at most so many pixels. */
    private pixels(how: Wanted, most: number): { width: number; height: number } {
        const all = this.size.width * this.size.height;
        this.budget = Math.min(Math.max(this.budget, all * LEAST), all);
        const part = Math.sqrt(Math.min(how === "still" ? all : this.budget, most) / all);
        const side = (length: number) => Math.min(Math.max(Math.round(length * part), 1), MOST_SIDE);
        return { width: side(this.size.width), height: side(this.size.height) };
    }

    private async start(): Promise<BlackHole> {
        const canvas = document.createElement("canvas");
        this.place.append(canvas);
        this.canvases.push(canvas);
        let hole: BlackHole | undefined;
        try {
            hole = await BlackHole.create(canvas, await this.options);
            if (!this.isOver) {
                await this.listener.started(hole, this.before);
            }
            if (this.isOver) {
                throw new Error("the element was removed");
            }
        } catch (error) {
            canvas.remove();
            this.canvases = this.canvases.filter((one) => one !== canvas);
            this.forget(hole);
            throw error;
        }
        const made = hole;
        [this.made, this.before, this.count] = [made, undefined, 0];
        // Real devices have more than enough for a quarter of the pixels, and software far from enough for all of them.
        this.budget = (this.size.width * this.size.height) / 4;
        void made.lost.then((error) => this.lost(made, error));
        return made;
    }

    private lost(hole: BlackHole, error: unknown): void {
        if (hole !== this.made || this.isOver) {
            return;
        }
        [this.made, this.before] = [undefined, hole];
        this.forget(hole);
        const now = performance.now();
        this.losses = [...this.losses.filter((time) => now - time < 60000), now];
        if (this.losses.length > MOST_LOSSES) {
            this.wanted = undefined;
            this.isOver = true;
            this.listener.failed(error);
        } else {
            this.wanted ??= "still";
            void this.work();
        }
    }
}
