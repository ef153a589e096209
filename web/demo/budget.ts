// SPDX-License-Identifier: MIT OR Apache-2.0
// budget.ts -- how many pixels a frame may have while the picture moves, and which frames follow when it rests.
// Counts only: knows neither page nor tracer.

/** One frame: the share of the full picture's pixels, and the samples of each. */
export interface Plan {
    share: number;
    samples: number;
}

/** Plans while moving: each has 0.7 times the pixels of the one before. */
const plans = (steps: number): Plan[] =>
    Array.from({ length: steps + 1 }, (_, step) => ({ share: 2 ** (-step / 2), samples: 1 }));
/** Down to an eighth of the pixels; quick devices have samples to spare. */
const GPU_PLANS: readonly Plan[] = [{ share: 1, samples: 4 }, ...plans(6)];
/** The CPU tracer goes down to a thirty-second. */
const CPU_PLANS: readonly Plan[] = plans(10);

const costOf = ({ share, samples }: Plan) => share * samples;

/** Some 40 frames a second; a finer picture is tried where it would still come in time. */
const AIM_MS = 26;
const FINER_MS = 22;

/** Frames that the user can end are made if they take up to this long; others, those of the CPU, up to that. */
const LONGEST_MS = 45000;
const CPU_LONGEST_MS = 5000;

export class Budget {
    private step: number;
    private readonly plans: readonly Plan[];
    private recent: number[] = [];
    /** Milliseconds for each sample, by the last frame that was larger than some thousand. */
    private perSample = 0;

    constructor(private readonly isGpu: boolean) {
        this.plans = isGpu ? GPU_PLANS : CPU_PLANS;
        this.step = this.plans.length - 1;
    }

    /** The frame to make while the picture moves. */
    get moving(): Plan {
        return this.plans[this.step] ?? { share: 1, samples: 1 };
    }

    /** The frames that sharpen a picture of so many pixels at rest, in order. */
    resting(pixels: number, hasSamples: boolean): Plan[] {
        const longest = this.isGpu ? LONGEST_MS : CPU_LONGEST_MS;
        const fits = ({ share, samples }: Plan) => this.expected(pixels * share * samples) <= longest;
        const full: Plan = { share: 1, samples: 1 };
        if (!this.isGpu) {
            // Whatever a quarter takes, the picture has to come.
            return [{ share: 1 / 4, samples: 1 }, ...[full].filter(fits)];
        }
        // The first frames of a kind take longer, because the browser compiles: only those after them say what is too
        // much.
        const finer = hasSamples ? [4, 16].map((samples) => ({ share: 1, samples })) : [];
        return [full, ...finer.filter((plan) => plan.samples < 16 || fits(plan))];
    }

    /** What so many samples take, in milliseconds; 0 while nothing was measured. */
    expected(samples: number): number {
        return this.perSample * samples;
    }

    /** A frame of so many samples took so long. The first one of a kind, which compiles, is not to count. */
    took(ms: number, samples: number, plan: Plan, isMoving: boolean): void {
        const each = ms / Math.max(1, samples);
        this.perSample = this.perSample === 0 ? each : Math.min(each, 0.7 * this.perSample + 0.3 * each);
        if (!isMoving || costOf(plan) !== costOf(this.moving)) {
            return;
        }
        this.recent = [...this.recent, ms].slice(-3);
        // One late frame says nothing: the quickest of three is what the device manages.
        if (this.recent.length < 3) {
            return;
        }
        const quickest = Math.min(...this.recent);
        const finer = this.plans[this.step - 1];
        if (quickest > AIM_MS && this.step < this.plans.length - 1) {
            const fall = quickest > 2 * AIM_MS ? 2 : 1;
            this.step = Math.min(this.plans.length - 1, this.step + fall);
            this.recent = [];
        } else if (finer !== undefined && (quickest * costOf(finer)) / costOf(plan) < FINER_MS) {
            this.step--;
            this.recent = [];
        }
    }
}
