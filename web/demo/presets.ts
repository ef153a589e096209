// SPDX-License-Identifier: MIT OR Apache-2.0
// presets.ts -- cards with pictures of scenes. Those with depth are offered where the device was measured to manage
// them.

import type { Settings } from "./bhr/index.js";
import { withFittedView } from "./camera.js";
import { element, found } from "./dom.js";
import { lookOf, LOOKS, type Look } from "./looks.js";
import { attempt } from "./notices.js";
import type { Session } from "./session.js";

/** The frame that is measured, as BhrPresetOptions' own measure takes at least. */
const MEASURED = { width: 480, height: 270 };
/** It may take so long; the picture at rest, of many more pixels, is then a matter of seconds. */
const MOST_MS = 350;
/** A thin disk of that size that takes longer spares the device the trial. */
const MOST_THIN_MS = 60;

export class Presets {
    private readonly cards = new Map<string, HTMLButtonElement>();
    private readonly word = element("p", { class: "hint" }, "");
    private measuring: Promise<void> | undefined;

    constructor(
        private readonly session: Session,
        private readonly stage: HTMLElement,
        private readonly chosen: (look: Look) => void,
    ) {
        const place = found("scenes");
        for (const { title, looks } of LOOKS) {
            const cards = element("div", { class: "cards" }, ...looks.map((look) => this.card(look)));
            const isDeep = looks.some((look) => look.isDeep);
            place.append(element("h2", {}, title), ...(isDeep ? [this.word] : []), cards);
        }
        this.offer(false, "Matter with depth takes a quick graphics processor. This device was not measured yet.");
    }

    private card(look: Look): HTMLButtonElement {
        const picture = element("img", { src: `thumbnails/${look.id}.webp`, alt: "", width: 240, height: 135,
            loading: "lazy", decoding: "async" });
        const card = element("button", { type: "button", class: "card", onclick: () => attempt(() => this.pick(look)) },
            picture, element("span", { class: "title" }, look.name), element("span", { class: "about" }, look.about));
        this.cards.set(look.id, card);
        return card;
    }

    pick(look: Look): void {
        this.show(look);
        for (const [id, card] of this.cards) {
            card.toggleAttribute("aria-current", id === look.id);
        }
        this.chosen(look);
    }

    /** Shows the scene of a card, with as much of it in the frame as a wide frame would have. */
    private show(look: Look): void {
        const { session } = this;
        const aspect = this.stage.clientWidth / Math.max(1, this.stage.clientHeight);
        session.replace((hole) => hole.reset().set(look.settings));
        session.change(withFittedView(session.settings, session.values, aspect));
    }

    /** Measures, once, whether the device manages matter with depth. */
    async measure(): Promise<void> {
        this.measuring ??= this.tried().catch((error: unknown) => {
            this.measuring = undefined;
            throw error;
        });
        await this.measuring;
    }

    private async tried(): Promise<void> {
        if (!this.session.isGpu) {
            this.offer(false, "Not offered: without WebGPU a picture with depth takes minutes.");
            return;
        }
        const thin = await this.timed({});
        if (thin > MOST_THIN_MS) {
            this.offer(false, `Not offered: this device takes ${thin} ms for a small frame of a thin disk, and many `
                + "times as long for matter with depth.");
            return;
        }
        const deep = await this.timed(lookOf("soft-disk")?.settings ?? {});
        const isQuick = deep <= MOST_MS;
        const what = `small frame with depth takes ${deep} ms on this device`;
        this.offer(isQuick, isQuick ? `A ${what}.` : `Not offered: a ${what}.`);
    }

    /** Milliseconds of a scene's frame. A first one is not counted: the browser compiles for it. */
    private async timed(settings: Settings): Promise<number> {
        const frame = () => this.session.meanwhile(settings, (hole) => hole.image(MEASURED.width, MEASURED.height));
        await frame();
        // The picture on the page may have had its turn in between.
        let quickest = Infinity;
        for (let i = 0; i < 2; i++) {
            const begin = performance.now();
            await frame();
            quickest = Math.min(quickest, performance.now() - begin);
        }
        return Math.round(quickest);
    }

    private offer(isOffered: boolean, why: string): void {
        this.word.textContent = why;
        for (const { id, isDeep } of LOOKS.flatMap(({ looks }) => looks)) {
            const card = this.cards.get(id);
            if (isDeep && card !== undefined) {
                card.disabled = !isOffered;
            }
        }
    }
}
