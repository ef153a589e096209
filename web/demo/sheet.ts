// SPDX-License-Identifier: MIT OR Apache-2.0
// sheet.ts -- the panel as a column beside the picture, and on narrow pages as a sheet that is drawn up from below,
// with tabs. Knows nothing of what is in it.

import { found } from "./dom.js";

export type Tab = "scenes" | "settings" | "ray" | "save";
const TABS: readonly Tab[] = ["scenes", "settings", "ray", "save"];

/** Shares of the page's height that the sheet takes. */
const STOPS = [0.5, 0.66];
const HEADER = 56;

export class Sheet {
    /** Called when another tab is shown, or none. */
    shown: (tab: Tab | undefined) => void = () => undefined;
    private tab: Tab = "scenes";
    private stop = 0;
    private readonly panel = found("panel");
    private readonly narrow = matchMedia("(max-width: 720px)");

    constructor() {
        for (const tab of TABS) {
            const button = found(`tab-${tab}`);
            button.addEventListener("click", () => this.open(tab));
            button.addEventListener("keydown", (event) => this.key(event, tab));
        }
        found("panel-close").addEventListener("click", () => this.close());
        this.drag(found("handle"));
        this.narrow.addEventListener("change", () => this.layout());
        window.addEventListener("resize", () => this.layout());
        this.select(this.tab);
        this.layout();
    }

    get isOpen(): boolean {
        return this.panel.classList.contains("open");
    }

    get current(): Tab | undefined {
        return this.isOpen ? this.tab : undefined;
    }

    /** Shows a tab. */
    open(tab: Tab): void {
        this.select(tab);
        this.panel.classList.add("open");
        this.panel.inert = false;
        this.layout();
        this.shown(tab);
    }

    close(): void {
        if (this.panel.contains(document.activeElement)) {
            found("stage").focus({ preventScroll: true });
        }
        this.panel.classList.remove("open");
        this.panel.inert = true;
        this.layout();
        this.shown(undefined);
    }

    /** Shows a tab, or hides the panel that shows it. */
    toggle(tab: Tab): void {
        if (this.current === tab) {
            this.close();
        } else {
            this.open(tab);
        }
    }

    private select(tab: Tab): void {
        this.tab = tab;
        for (const one of TABS) {
            const button = found(`tab-${one}`);
            button.setAttribute("aria-selected", String(one === tab));
            button.tabIndex = one === tab ? 0 : -1;
            found(one).hidden = one !== tab;
        }
    }

    private key(event: KeyboardEvent, tab: Tab): void {
        const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (step !== undefined) {
            event.preventDefault();
            event.stopPropagation();
            const next = TABS[(TABS.indexOf(tab) + step + TABS.length) % TABS.length] as Tab;
            this.open(next);
            found(`tab-${next}`).focus();
        }
    }

    /** The picture stays visible above the sheet: the page's other parts go by --sheet. */
    private layout(height?: number): void {
        const share = STOPS[this.stop] as number;
        const own = height ?? Math.round(window.innerHeight * share);
        const root = document.documentElement.style;
        root.setProperty("--sheet-height", `${own}px`);
        root.setProperty("--sheet", this.narrow.matches && this.isOpen ? `${own}px` : "0px");
        found("handle").setAttribute("aria-expanded", String(this.stop > 0));
    }

    /** The handle follows the finger, and stays at the nearest stop; far down, the sheet closes. */
    private drag(handle: HTMLElement): void {
        let begin: { y: number; height: number } | undefined;
        let moved = 0;
        handle.addEventListener("pointerdown", (event) => {
            begin = { y: event.clientY, height: this.panel.clientHeight };
            moved = 0;
            handle.setPointerCapture(event.pointerId);
        });
        handle.addEventListener("pointermove", (event) => {
            if (begin !== undefined) {
                const by = begin.y - event.clientY;
                moved = Math.max(moved, Math.abs(by));
                this.layout(Math.min(0.85 * window.innerHeight, Math.max(HEADER, begin.height + by)));
            }
        });
        const end = () => {
            if (begin === undefined) {
                return;
            }
            begin = undefined;
            const share = this.panel.clientHeight / window.innerHeight;
            if (moved > 5 && share < 0.3) {
                this.stop = 0;
                this.close();
                return;
            }
            if (moved > 5) {
                this.stop = STOPS.reduce((best, stop, i) =>
                    Math.abs(stop - share) < Math.abs((STOPS[best] as number) - share) ? i : best, 0);
            }
            this.layout();
        };
        handle.addEventListener("pointerup", end);
        handle.addEventListener("pointercancel", end);
        // By keyboard, and by a touch that does not move.
        handle.addEventListener("click", () => {
            if (moved <= 5) {
                this.stop = (this.stop + 1) % STOPS.length;
                this.layout();
            }
        });
        handle.addEventListener("keydown", () => (moved = 0));
    }
}
