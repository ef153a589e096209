// SPDX-License-Identifier: MIT OR Apache-2.0
// widget.ts -- the half of bhr.widget (python/src/bhr/widget.py) that runs in a notebook's page: <bhr-hole> for a model
// of anywidget. Bundled into one file, with the CPU tracer's worker in it as text; Python sends the WebAssembly module
// when a page asks for it, so that no notebook file holds it.

import "../element.js";
import type { BhrHole } from "../element.js";
import { link as linkOf } from "../link.js";
import type { Options, Settings } from "../index.js";
import worker from "./worker.txt";

/** The model as anywidget gives it. */
interface Model {
    get(name: string): unknown;
    set(name: string, value: unknown): void;
    save_changes(): void;
    send(content: unknown): void;
    on(event: string, listener: (...values: never[]) => void): void;
    off(event: string, listener: (...values: never[]) => void): void;
}

/** Traits that are a value of the scene, with its place in one. */
const VALUES: Readonly<Record<string, readonly string[]>> = {
    preset: ["preset"],
    view: ["view"],
    spin: ["hole", "spin"],
    distance: ["camera", "orbit", "distance"],
    azimuth: ["camera", "orbit", "azimuth"],
    elevation: ["camera", "orbit", "elevation"],
    fov: ["camera", "fov_y"],
    time: ["time"],
};

/** Traits that are attributes of the element and no part of the scene. */
const ATTRIBUTES = ["alt", "controls", "playing", "rate", "backend", "max_pixels"];

/** Seconds that the kernel has to send the module. */
const PATIENCE = 30;

/** Asks Python for the WebAssembly module, and makes addresses of it and of the worker. */
function asked(model: Model): Promise<Options> {
    return new Promise((resolve, reject) => {
        const over = () => {
            clearTimeout(timer);
            model.off("msg:custom", listener);
        };
        const listener = (content: { kind?: unknown }, [packed]: DataView<ArrayBuffer>[]) => {
            if (content.kind !== "module" || packed === undefined) {
                return;
            }
            over();
            const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
            const type = "application/wasm";
            new Response(plain, { headers: { "content-type": type } }).blob().then((module) => {
                const script = URL.createObjectURL(new Blob([worker], { type: "text/javascript" }));
                resolve({ wasm: URL.createObjectURL(module), worker: () => new Worker(script) });
            }, reject);
        };
        const timer = setTimeout(() => {
            over();
            reject(new Error("the kernel has not sent the black hole's module: run the cell"));
        }, PATIENCE * 1000);
        model.on("msg:custom", listener);
        model.send({ kind: "module" });
    });
}

/** The class of the page's elements, which all widgets share, with the module on its way. */
function elements(model: Model): void {
    const shared = customElements.get("bhr-hole") as typeof BhrHole;
    if (!(shared.options instanceof Promise) && shared.options.wasm === undefined) {
        const options = asked(model);
        shared.options = options;
        // Without a kernel the next widget tries anew; the element tells what is amiss.
        options.catch(() => shared.options === options && (shared.options = {}));
    }
}

/** A scene of Python's as a link. */
function linkTo(scene: unknown): string {
    return typeof scene === "string" ? scene : linkOf(scene as Settings, "");
}

/** A scene as Python takes it. */
function plain(value: unknown): unknown {
    if (Array.isArray(value)) {
        return value.map(plain);
    }
    if (typeof value === "object" && value !== null) {
        return Object.fromEntries(Object.entries(value).map(([name, part]) => [name, plain(part)]));
    }
    return typeof value === "bigint" ? Number(value) : value;
}

function valueAt(scene: unknown, path: readonly string[]): unknown {
    return path.reduce((place, name) => (place as Record<string, unknown> | undefined)?.[name], scene) ?? null;
}

/** A link without what it says of a value. */
function without(link: string, path: readonly string[]): string {
    const name = path.join(".");
    return link.split("&").filter((pair) => pair.split("=")[0] !== name).join("&");
}

/** Shows a model in an element of the notebook's, until the function that is returned is called. */
function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
    elements(model);
    const element = document.createElement("bhr-hole");
    let isReporting = false;
    let last: string | undefined;

    const given = (names: readonly string[]) =>
        names.flatMap((name): [string, string][] => {
            const value = model.get(name);
            return value === null || value === undefined ? [] : [[name, String(value)]];
        });
    const behave = () => {
        for (const name of ATTRIBUTES) {
            const value = model.get(name);
            const attribute = name.replace("_", "-");
            if (value === null || value === undefined || value === false || value === "") {
                element.removeAttribute(attribute);
            } else {
                element.setAttribute(attribute, value === true ? "" : String(value));
            }
        }
    };
    const showAll = () => {
        const all = given(Object.keys(VALUES));
        element.show({ ...Object.fromEntries(all), scene: linkTo(model.get("scene")) });
    };
    const showScene = () => {
        if (!isReporting) {
            element.show({ scene: linkTo(model.get("scene")) });
        }
    };
    const showValue = (name: string, path: readonly string[]) => {
        const { hole } = element;
        if (isReporting) {
            return;
        }
        if (hole === undefined) {
            showAll();
        } else if (model.get(name) === null && path[1] === "orbit") {
            // One of the three alone cannot be taken back.
            element.show({ scene: hole.link().replace(/&camera\.orbit\.[^&]*/g, "") });
        } else {
            element.show({ scene: without(hole.link(), path), ...Object.fromEntries(given([name])) });
        }
    };
    /** Tells Python what is shown. */
    const report = () => {
        const { hole } = element;
        const link = hole?.link();
        if (hole === undefined || link === last) {
            return;
        }
        last = link;
        isReporting = true;
        const scene = plain(hole.scene);
        model.set("scene", typeof model.get("scene") === "string" ? link : scene);
        for (const [name, path] of Object.entries(VALUES)) {
            model.set(name, valueAt(scene, path));
        }
        model.set("error", "");
        model.save_changes();
        isReporting = false;
    };
    const rendered = (event: Event) => {
        if ((event as CustomEvent<{ still: boolean }>).detail.still) {
            report();
        }
    };
    const failed = (event: Event) => {
        model.set("error", (event as ErrorEvent).message);
        model.save_changes();
    };

    const listeners: [string, () => void][] = [
        ["change:scene", showScene],
        ...Object.entries(VALUES).map(([name, path]): [string, () => void] =>
            [`change:${name}`, () => showValue(name, path)]),
        ...ATTRIBUTES.map((name): [string, () => void] => [`change:${name}`, behave]),
    ];
    listeners.forEach(([event, listener]) => model.on(event, listener));
    element.addEventListener("render", rendered);
    element.addEventListener("error", failed);
    behave();
    showAll();
    element.style.cssText = "width: 100%; height: 100%";
    // JupyterLab has shortcuts of its own for the arrow keys.
    el.dataset["lmSuppressShortcuts"] = "true";
    el.append(element);
    return () => {
        listeners.forEach(([event, listener]) => model.off(event, listener));
        element.remove();
    };
}

export default { render };
