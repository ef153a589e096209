// SPDX-License-Identifier: MIT OR Apache-2.0
// worker.ts -- the CPU tracer on a thread of its own: takes one order at a time, and answers each.

import { loaded, unlessEnded } from "./load.js";
import type { Adapter, Pixels, Stats } from "./tracers.js";
import type { Tracer } from "./wasm/bhr.js";

/** What the page asks for. */
export type Order =
    | { kind: "start"; wasm: string | undefined }
    | { kind: "map"; pixels: Uint8Array | undefined; width: number; height: number }
    | { kind: "lut"; cube: string | undefined }
    | { kind: "image"; scene: string; width: number; height: number; format: Pixels };

/** What comes of it. */
export type Answer =
    | { kind: "started"; adapter: Adapter; stats: Stats }
    | { kind: "taken" }
    | { kind: "image"; bytes: Uint8Array; stats: Stats }
    | { kind: "failed"; message: string; code: unknown };

let tracer: Tracer | undefined;

async function answer(order: Order): Promise<Answer> {
    if (order.kind === "start") {
        const { Tracer } = await loaded(order.wasm);
        tracer = Tracer.onCpu();
        return { kind: "started", adapter: tracer.adapter() as Adapter, stats: tracer.stats() as Stats };
    }
    if (tracer === undefined) {
        throw new Error("no tracer was started");
    }
    if (order.kind === "map") {
        await unlessEnded(tracer.setSkyMap(order.pixels, order.width, order.height));
        return { kind: "taken" };
    }
    if (order.kind === "lut") {
        tracer.setFilmLut(order.cube);
        return { kind: "taken" };
    }
    const { scene, width, height, format } = order;
    const bytes = await unlessEnded(tracer.image(scene, 0, width, height, format === "rgba32f", undefined));
    return { kind: "image", bytes, stats: tracer.stats() as Stats };
}

// The types of a page's scripts are those of a window, and a worker's postMessage is another one.
const post = postMessage as (message: Answer, transfer: Transferable[]) => void;

onmessage = ({ data }: MessageEvent<Order>) => {
    void answer(data)
        .catch((error: unknown): Answer => {
            const { message, code } = error as { message?: unknown; code?: unknown };
            return { kind: "failed", message: String(message ?? error), code };
        })
        .then((made) => post(made, made.kind === "image" ? [made.bytes.buffer] : []));
};
