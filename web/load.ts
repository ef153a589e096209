// SPDX-License-Identifier: MIT OR Apache-2.0
// load.ts -- the WebAssembly module, loaded once for a page or a worker.

import init, * as wasm from "./wasm/bhr.js";

/** Where the module is: an address, or what fetching it gives. */
export type Source = string | URL | Request | Response | Promise<Response> | BufferSource | WebAssembly.Module;

let loading: Promise<unknown> | undefined;

let end!: (error: Error) => void;

/** Rejects when the module has panicked: what was asked of it is never answered. */
export const ended = new Promise<never>((_, reject) => (end = reject));
// A page that awaits nothing of the module need not hear of it.
ended.catch(() => undefined);

/** What `work` comes to, or the end of the module. */
export function unlessEnded<T>(work: Promise<T>): Promise<T> {
    return Promise.race([work, ended]);
}

/** The functions of the module. The first call says where it is; one that failed is tried again. */
export async function loaded(source?: Source): Promise<typeof wasm> {
    loading ??= init(source === undefined ? undefined : { module_or_path: source }).then(() =>
        wasm.onEnd((message: string) => {
            end(Object.assign(new Error(`${message}; the page must be loaded anew`), { code: "INTERNAL" }));
        }),
    );
    try {
        await loading;
    } catch (error) {
        loading = undefined;
        throw error;
    }
    return wasm;
}
