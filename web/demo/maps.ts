// SPDX-License-Identifier: MIT OR Apache-2.0
// maps.ts -- a sky map and a LUT of the reader's own, from files. They stay in this page: neither links nor scene files
// hold them. Sets the sky's flags, and nothing else of the scene.

import type { SkyFlag } from "./bhr/index.js";
import { element, found } from "./dom.js";
import { attempt, notice } from "./notices.js";
import type { Session } from "./session.js";

/** Larger pictures are drawn smaller: four bytes for each of these pixels are 128 MiB. */
const WIDEST = 8192;
/** The largest LUT, of 256 nodes a side, has some 500 MB of text; usual ones, of 65, have 8. */
const MOST_CUBE_BYTES = 64e6;

export class Maps {
    private sky: File | undefined;
    private cube: string | undefined;
    private readonly said = element("p", { class: "hint" });

    constructor(private readonly session: Session) {
        const file = (accept: string, label: string, open: (file: File) => Promise<void>) => {
            const input = element("input", { type: "file", accept, hidden: true, "aria-label": label });
            input.addEventListener("change", () => attempt(async () => {
                const chosen = input.files?.[0];
                input.value = "";
                if (chosen !== undefined) {
                    await open(chosen);
                }
            }));
            return input;
        };
        const button = (name: string, title: string, work: () => unknown) =>
            element("button", { type: "button", class: "button", title, onclick: () => attempt(work) }, name);
        const sky = file("image/*", "A sky map", (chosen) => this.openSky(chosen));
        const cube = file(".cube", "A LUT", (chosen) => this.openCube(chosen));
        found("save").append(
            element("h2", {}, "Sky and LUT of your own"),
            this.said,
            element("div", { class: "buttons" },
                button("Open sky ...", "A picture of the whole sky, twice as wide as high", () => sky.click()),
                button("Open LUT ...", "A .cube file, a table of colours", () => cube.click()),
                button("Remove both", "The stars and colours of the scene alone", () => this.remove())),
            sky, cube);
        session.renewed = () => this.give();
        this.tell();
    }

    private async openSky(file: File): Promise<void> {
        await this.giveSky(file);
        this.sky = file;
        this.session.change({ sky: { flags: ["map"] } });
        this.tell();
        notice(`${file.name} is the sky now.`);
    }

    private async openCube(file: File): Promise<void> {
        if (file.size > MOST_CUBE_BYTES) {
            throw new RangeError(`${file.name} has ${file.size} bytes; a LUT has at most ${MOST_CUBE_BYTES} here`);
        }
        const text = await file.text();
        await this.session.hole.setFilmLut(text);
        this.cube = text;
        this.session.change({});
        this.tell();
        notice(`${file.name} colours the picture now.`);
    }

    private async remove(): Promise<void> {
        [this.sky, this.cube] = [undefined, undefined];
        await this.session.hole.setSkyMap(undefined);
        await this.session.hole.setFilmLut(undefined);
        const flags = (this.session.value("sky.flags") ?? []) as readonly SkyFlag[];
        this.session.assign("sky.flags", flags.length === 1 && flags[0] === "map" ? undefined
            : flags.filter((flag) => flag !== "map"));
        this.tell();
    }

    /** Gives a new device what the last one had. */
    private async give(): Promise<void> {
        if (this.sky !== undefined) {
            await this.giveSky(this.sky);
        }
        await this.session.hole.setFilmLut(this.cube);
    }

    private async giveSky(file: File): Promise<void> {
        let bitmap = await createImageBitmap(file);
        try {
            if (bitmap.width > WIDEST) {
                const whole = bitmap;
                const resizeHeight = Math.max(1, Math.round((whole.height * WIDEST) / whole.width));
                bitmap = await createImageBitmap(whole, { resizeWidth: WIDEST, resizeHeight, resizeQuality: "high" });
                whole.close();
            }
            await this.session.hole.setSkyMap(bitmap);
        } finally {
            bitmap.close();
        }
    }

    private tell(): void {
        const have = [this.sky && `a sky, ${this.sky.name}`, this.cube && "a LUT"].filter(Boolean);
        this.said.textContent = have.length > 0 ? `The picture has ${have.join(" and ")}. Links do not hold them.`
            : "They stay in this page: links and scene files do not hold them.";
    }
}
