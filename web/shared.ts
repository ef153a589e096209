// SPDX-License-Identifier: MIT OR Apache-2.0
// shared.ts -- one tracer for many black holes of a page, each with a canvas of its own: browsers give a page few
// devices, and each keeps buffers and compiled kernels. Knows no scene.

import { destroyed, type Stats, type Traces } from "./tracers.js";

/** A tracer, with those that take turns at it. */
interface Pool {
    readonly traces: Promise<Traces>;
    holders: number;
    last: Promise<unknown>;
    /** The sky map and the LUT that the tracer has. */
    map?: ImageData | undefined;
    cube?: string | undefined;
}

const pools = new Map<string, Pool>();

function leave(pool: Pool, kind: string): void {
    if (pools.get(kind) === pool) {
        pools.delete(kind);
    }
}

/** A share in the page's tracer of a kind, which `start` makes for the first who asks, and anew after it was lost. */
export async function shareOf(kind: string, start: () => Promise<Traces>): Promise<Traces> {
    let pool = pools.get(kind);
    if (pool === undefined) {
        const made: Pool = { traces: start(), holders: 0, last: Promise.resolve() };
        const gone = () => leave(made, kind);
        made.traces.then(({ lost }) => lost.then(gone)).catch(gone);
        pools.set(kind, made);
        pool = made;
    }
    pool.holders++;
    try {
        return new Share(await pool.traces, pool, kind);
    } catch (error) {
        pool.holders--;
        throw error;
    }
}

/** A tracer as one of its holders sees it. */
class Share implements Traces {
    /** Those of this holder's own frames. */
    stats: Stats;
    private isOver = false;
    /** The sky map and the LUT of this holder's frames. */
    private map: ImageData | undefined;
    private cube: string | undefined;

    constructor(
        private readonly traces: Traces,
        private readonly pool: Pool,
        private readonly kind: string,
    ) {
        this.stats = traces.stats;
    }

    get adapter(): Traces["adapter"] {
        return this.traces.adapter;
    }

    get lost(): Promise<Error> {
        return this.traces.lost;
    }

    paint(...frame: Parameters<Traces["paint"]>): Promise<void> {
        return this.inTurn(async () => {
            await this.bring();
            return this.traces.paint(...frame);
        });
    }

    image(...frame: Parameters<Traces["image"]>): ReturnType<Traces["image"]> {
        return this.inTurn(async () => {
            await this.bring();
            return this.traces.image(...frame);
        });
    }

    forgetCanvas(): void {
        this.pool.last = this.pool.last.then(() => this.traces.forgetCanvas()).catch(() => undefined);
    }

    setSkyMap(picture: ImageData | undefined): Promise<void> {
        return this.inTurn(async () => {
            await this.traces.setSkyMap(picture);
            // A copy: after another holder's turn it is read again, and the page may have changed its own by then.
            const { data, width, height } = picture ?? {};
            const kept = data && new ImageData(new Uint8ClampedArray(data), width as number, height);
            this.map = this.pool.map = kept;
        });
    }

    setFilmLut(cube: string | undefined): Promise<void> {
        return this.inTurn(async () => {
            await this.traces.setFilmLut(cube);
            this.cube = this.pool.cube = cube;
        });
    }

    loseDevice(): void {
        if (this.isOver) {
            throw destroyed();
        }
        this.traces.loseDevice();
    }

    end(): void {
        if (this.isOver) {
            return;
        }
        this.isOver = true;
        this.pool.holders--;
        if (this.pool.holders === 0) {
            leave(this.pool, this.kind);
            const end = () => this.traces.end();
            // A tracer that cannot be freed any more has ended by itself.
            this.pool.last.then(end, end).catch(() => undefined);
        }
    }

    /** Gives the tracer this holder's map and LUT, where another one's are there. */
    private async bring(): Promise<void> {
        if (this.pool.map !== this.map) {
            await this.traces.setSkyMap(this.map);
            this.pool.map = this.map;
        }
        if (this.pool.cube !== this.cube) {
            await this.traces.setFilmLut(this.cube);
            this.pool.cube = this.cube;
        }
    }

    private inTurn<T>(work: () => Promise<T>): Promise<T> {
        const done = this.pool.last.then(async () => {
            if (this.isOver) {
                throw destroyed();
            }
            const made = await work();
            this.stats = this.traces.stats;
            return made;
        });
        this.pool.last = done.catch(() => undefined);
        return done;
    }
}
