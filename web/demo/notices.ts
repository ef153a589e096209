// SPDX-License-Identifier: MIT OR Apache-2.0
// notices.ts -- short messages over the picture, which assistive technology reads out.

import { element, found, iconButton } from "./dom.js";

const MOST = 3;

/** Errors stay until they are closed; news goes by itself. */
export function notice(text: string, kind: "news" | "error" = "news"): void {
    const place = found("notices");
    const said = text.length > 300 ? `${text.slice(0, 300)} ...` : text;
    for (const other of [...place.children]) {
        if (other.firstChild?.textContent === said) {
            other.remove();
        }
    }
    const line = element("div", { class: `notice ${kind}` }, element("p", {}, said));
    line.append(iconButton("close", "Close this message", () => line.remove()));
    place.append(line);
    while (place.children.length > MOST) {
        place.firstElementChild?.remove();
    }
    if (kind === "news") {
        setTimeout(() => line.remove(), 6000);
    }
}

/** Tells of anything that was thrown. */
export function failure(error: unknown): void {
    notice(error instanceof Error ? error.message : String(error), "error");
}

/** Has work done that nobody awaits, and tells of what it throws. */
export function attempt(work: () => unknown): void {
    try {
        const made = work();
        if (made instanceof Promise) {
            made.catch(failure);
        }
    } catch (error) {
        failure(error);
    }
}
