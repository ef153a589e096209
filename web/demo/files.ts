// SPDX-License-Identifier: MIT OR Apache-2.0
// files.ts -- what leaves the page and comes into it: links, pictures, light, scene files. Changes the scene only where
// a file is opened.

import { element, found } from "./dom.js";
import { exrOf, type Depth } from "./exr.js";
import { attempt, notice } from "./notices.js";
import type { Session } from "./session.js";
import type { View } from "./view.js";

/** Samples of each pixel of saved pictures, on a tracer that is quick enough for it. */
const SAMPLES = 4;
/** A scene file has at most 4 MiB (docs/scenes.md). */
const MOST_BYTES = 4 * 1024 * 1024;

type Size = "1x" | "2x" | "4k";
const SIZES: readonly (readonly [Size, string])[] = [
    ["1x", "As on this screen"], ["2x", "Twice as wide and high"], ["4k", "4K, 3840 pixels along the longer side"],
];

export class Files {
    private readonly size = element("select", { class: "choice", id: "save-size" },
        ...SIZES.map(([value, name]) => element("option", { value }, name)));
    private readonly depth = element("select", { class: "choice", id: "save-depth" },
        element("option", { value: "half" }, "Half floats, 16 bits"), element("option", { value: "float" },
            "Floats, 32 bits"));
    private readonly bar = element("progress", { max: 1, "aria-label": "The file's progress" });
    private readonly word = element("p", { class: "hint", role: "status" });
    private readonly cancel = element("button", { type: "button", class: "button", onclick: () => this.abort?.abort() },
        "Cancel");
    private readonly work = element("div", { class: "work", hidden: true }, this.bar, this.word, this.cancel);
    private abort: AbortController | undefined;

    constructor(
        private readonly session: Session,
        private readonly view: View,
    ) {
        const button = (name: string, work: () => unknown, title: string) =>
            element("button", { type: "button", class: "button", title, onclick: () => attempt(work) }, name);
        const opened = element("input", { type: "file", accept: ".toml,.txt,text/plain", hidden: true,
            "aria-label": "A scene file" });
        opened.addEventListener("change", () => attempt(async () => {
            const file = opened.files?.[0];
            opened.value = "";
            await this.open(file);
        }));
        found("save").append(
            element("h2", {}, "Link"),
            element("p", { class: "hint" }, "The address of this page has the whole scene in it."),
            element("div", { class: "buttons" },
                button("Copy link", () => this.copy(), "Puts the page's address on the clipboard"),
                ...(typeof navigator.share === "function"
                    ? [button("Share ...", () => this.share(), "By the device's own menu")] : [])),
            element("h2", {}, "Picture"),
            element("div", { class: "row" }, element("label", { class: "name", for: "save-size" }, "Size"), this.size),
            element("div", { class: "row" },
                element("label", { class: "name", for: "save-depth" }, "Numbers of EXR"), this.depth),
            element("div", { class: "buttons" },
                button("Save PNG", () => this.png(), "The picture, in 8 bits a channel"),
                button("Save EXR", () => this.exr(), "Light before the film: linear, Rec. 709 primaries, for grading")),
            this.work,
            element("h2", {}, "Scene file"),
            element("p", { class: "hint" }, "Text that the program bhr renders, in any size, as a film too."),
            element("div", { class: "buttons" },
                button("Save scene", () => saved(new Blob([this.session.text], { type: "text/plain" }), "scene.toml"),
                    "All fields of the scene"),
                button("Open scene ...", () => opened.click(), "One from here, or one of docs/scenes.md"), opened));
    }

    /** Puts the link on the clipboard. */
    async copy(): Promise<void> {
        const address = this.address();
        try {
            await navigator.clipboard.writeText(address);
            notice("The link is on the clipboard.");
        } catch {
            // Pages without HTTPS and some browsers have no clipboard: the address bar has the link as well.
            notice("The clipboard is not available: copy the page's address, which is the link.");
        }
    }

    /** Shares by the device's menu, else copies. */
    async share(): Promise<void> {
        if (typeof navigator.share !== "function") {
            return this.copy();
        }
        try {
            await navigator.share({ title: "A black hole", url: this.address() });
        } catch (error) {
            if ((error as Error).name !== "AbortError") {
                await this.copy();
            }
        }
    }

    /** The page's address with the scene as it is now. */
    private address(): string {
        history.replaceState(history.state, "", `#${this.session.link}`);
        return location.href;
    }

    private pixels(): { width: number; height: number } {
        const { width, height } = this.view.size;
        const longer = Math.max(width, height);
        const by = { "1x": 1, "2x": 2, "4k": 3840 / longer }[this.size.value as Size];
        return { width: Math.round(width * by), height: Math.round(height * by) };
    }

    private get samples(): number {
        return this.session.isGpu ? SAMPLES : 1;
    }

    private png(): Promise<void> {
        return this.working("PNG", async (signal) => {
            const { width, height } = this.pixels();
            const image = await this.frame((hole) => hole.image(width, height, { signal }));
            const canvas = new OffscreenCanvas(width, height);
            const context = canvas.getContext("2d");
            if (context === null) {
                throw new Error(`the browser has no canvas of ${width} x ${height} pixels`);
            }
            context.putImageData(image, 0, 0);
            const blob = await canvas.convertToBlob({ type: "image/png" });
            signal.throwIfAborted();
            saved(blob, `black-hole-${width}x${height}.png`);
        });
    }

    private exr(): Promise<void> {
        return this.working("EXR", async (signal) => {
            if (this.session.values.top.view !== "light") {
                throw new Error("an EXR file holds light: choose the view \"light\" first");
            }
            const { width, height } = this.pixels();
            const light = await this.frame((hole) => hole.light(width, height, { signal }));
            const blob = await exrOf(light, width, height, this.depth.value as Depth, (share) => {
                signal.throwIfAborted();
                this.bar.value = share;
            });
            saved(blob, `black-hole-${width}x${height}.exr`);
        });
    }

    /** A frame of the scene as it is now. */
    private frame<T>(make: (hole: Session["hole"]) => Promise<T>): Promise<T> {
        const { settings } = this.session;
        const samples_per_pixel = this.samples;
        return this.session.meanwhile({ ...settings, quality: { ...settings.quality, samples_per_pixel } }, make);
    }

    /** Shows that a file is made, and lets the user end it. */
    private async working(name: string, make: (signal: AbortSignal) => Promise<void>): Promise<void> {
        if (this.abort !== undefined) {
            notice("A file is being made already.");
            return;
        }
        const abort = new AbortController();
        this.abort = abort;
        const { width, height } = this.pixels();
        const expected = this.view.expected(width * height * this.samples);
        const about = expected > 0 ? `, about ${Math.max(1, Math.round(expected / 1000))} s` : "";
        const begin = performance.now();
        const tick = setInterval(() => {
            const passed = performance.now() - begin;
            // Frames say nothing on their way: the bar goes by what frames took before, and never arrives by itself.
            this.bar.value = expected > 0 ? 0.95 * (1 - Math.exp((-1.5 * passed) / expected)) : 0;
        }, 200);
        this.word.textContent = `${name}, ${width} x ${height} pixels${about}`;
        this.work.hidden = false;
        try {
            await make(abort.signal);
        } catch (error) {
            if (!abort.signal.aborted) {
                throw error;
            }
        } finally {
            clearInterval(tick);
            this.work.hidden = true;
            this.abort = undefined;
        }
    }

    /** Opens a scene file in place of the scene. */
    async open(file: File | undefined): Promise<void> {
        if (file === undefined) {
            return;
        }
        if (file.size > MOST_BYTES) {
            throw new RangeError(`${file.name} has ${file.size} bytes; a scene file has at most ${MOST_BYTES}`);
        }
        const text = await file.text();
        this.session.replace((hole) => hole.read(text));
        notice(`${file.name} was opened.`);
    }
}

/** Has the browser save a file. */
function saved(blob: Blob, name: string): void {
    const url = URL.createObjectURL(blob);
    element("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 60000);
}
