// SPDX-License-Identifier: MIT OR Apache-2.0
// view.ts -- the picture: one frame after the other, coarse while the scene changes, then finer and finer. Asks nobody
// what the scene shows.

import { Budget, type Plan } from "./budget.js";
import { sleep } from "./dom.js";
import { failure } from "./notices.js";
import type { Session } from "./session.js";

/** The most pixels of a picture, whatever the display has. */
const MOST_PIXELS = 4e6;
const MOST_CPU_PIXELS = 6e5;
/** For so long after a change the scene counts as moving. */
const REST_MS = 160;

export interface Progress {
    width: number;
    height: number;
    samples: number;
    /** Whether finer frames follow. */
    isFinal: boolean;
    isMoving: boolean;
}

export class View {
    /** Called before each frame of a scene that moves by itself: says whether it still does. */
    advance: () => boolean = () => false;
    /** Called after each frame. */
    shown: (progress: Progress) => void = () => undefined;
    private budget: Budget;
    private budgetOf: unknown;
    private isStale = true;
    private changedAt = 0;
    private isRunning = false;
    private sharpening: AbortController | undefined;
    private frames = 0;
    private last = { width: 0, height: 0 };
    private failedAt: string | undefined;

    constructor(
        private readonly session: Session,
        private readonly stage: HTMLElement,
        /** The most pixels, and samples of each, that the page's address asks for. */
        private readonly limits: { pixels: number | undefined; samples: number | undefined },
    ) {
        this.budget = new Budget(session.isGpu);
        session.onChange(() => this.touch());
        new ResizeObserver(() => this.touch()).observe(stage);
        document.addEventListener("visibilitychange", () => this.touch());
    }

    /** Milliseconds that so many samples take on this device, as far as it was measured. */
    expected(samples: number): number {
        return this.budget.expected(samples);
    }

    /** The pixels of the whole picture: those of the display, within limits. */
    get size(): { width: number; height: number } {
        const { clientWidth, clientHeight } = this.stage;
        const scale = window.devicePixelRatio || 1;
        const most = Math.min(this.limits.pixels ?? Infinity, this.session.isGpu ? MOST_PIXELS : MOST_CPU_PIXELS);
        return this.sized(clientWidth * scale, clientHeight * scale, most);
    }

    /** The scene is another one: a coarse frame soon, finer ones when it rests. */
    touch(): void {
        this.isStale = true;
        this.changedAt = performance.now();
        this.sharpening?.abort();
        if (!this.isRunning && !document.hidden) {
            this.isRunning = true;
            void this.run()
                .catch(failure)
                .finally(() => {
                    this.isRunning = false;
                    if (this.isStale && !document.hidden && this.failedAt === undefined) {
                        this.touch();
                    }
                    this.failedAt = undefined;
                });
        }
    }

    private sized(width: number, height: number, most: number): { width: number; height: number } {
        const by = Math.min(1, Math.sqrt(most / Math.max(1, width * height)));
        return { width: Math.max(16, Math.round(width * by)), height: Math.max(16, Math.round(height * by)) };
    }

    /** Frames until the picture is as fine as it gets. */
    private async run(): Promise<void> {
        let next = 0;
        while (!document.hidden) {
            const moves = this.advance();
            if (this.isStale || moves) {
                this.isStale = false;
                next = 0;
                const { share, samples } = this.budgetNow().moving;
                const plan = { share, samples: Math.min(samples, this.limits.samples ?? Infinity) };
                if (await this.frame(plan, true)) {
                    this.tell(plan, true, false);
                }
                // A frame with all pixels is one of those at rest.
                next = share < 1 ? 0 : samples < 4 ? 1 : 2;
                await untilDrawn();
                continue;
            }
            const rested = performance.now() - this.changedAt;
            if (rested < REST_MS) {
                await sleep(REST_MS - rested);
                continue;
            }
            const plan = this.plans()[next];
            if (plan === undefined) {
                return;
            }
            if (await this.frame(plan, false)) {
                next++;
                // By what this frame took, the next one may be too much.
                this.tell(plan, false, this.plans()[next] === undefined);
            }
        }
    }

    private plans(): Plan[] {
        const { width, height } = this.size;
        const most = this.limits.samples ?? Infinity;
        const hasSamples = this.session.values.top.view === "light";
        return this.budgetNow().resting(width * height, hasSamples).filter(({ samples }) => samples <= most);
    }

    private tell({ samples }: Plan, isMoving: boolean, isFinal: boolean): void {
        this.shown({ ...this.last, samples, isFinal, isMoving });
    }

    /** Makes a frame, and says whether it is there; one that is given up is not. */
    private async frame(plan: Plan, isMoving: boolean): Promise<boolean> {
        const full = this.size;
        const size = this.sized(full.width, full.height, full.width * full.height * plan.share);
        const { session } = this;
        const { hole } = session;
        session.sample(plan.samples);
        const abort = isMoving ? undefined : new AbortController();
        this.sharpening = abort;
        const begin = performance.now();
        try {
            await hole.render({ ...size, ...(abort && { signal: abort.signal }) });
        } catch (error) {
            const { code, message } = error as { code?: string; message: string };
            if (code === "CANCELLED" || hole !== session.hole || code === "DEVICE_LOST") {
                // After a loss the session asks for the picture again.
                await sleep(code === "CANCELLED" ? 0 : 100);
                return false;
            }
            this.failedAt = message;
            throw error;
        } finally {
            this.sharpening = undefined;
        }
        const ms = performance.now() - begin;
        if (this.frames++ > 0) {
            this.budget.took(ms, size.width * size.height * plan.samples, plan, isMoving);
        }
        this.last = size;
        return true;
    }

    /** Another device, another budget. */
    private budgetNow(): Budget {
        if (this.budgetOf !== this.session.hole) {
            this.budgetOf = this.session.hole;
            this.budget = new Budget(this.session.isGpu);
            this.frames = 0;
        }
        return this.budget;
    }
}

/** Until the browser has drawn; a hidden page draws never. */
function untilDrawn(): Promise<void> {
    return Promise.race([new Promise<void>((done) => requestAnimationFrame(() => done())), sleep(100)]);
}
