// SPDX-License-Identifier: MIT OR Apache-2.0
// dom.ts -- elements and icons of the page. Knows nothing of black holes.

type Attributes = Record<string, string | number | boolean | undefined | ((event: never) => void)>;

/** Sets attributes, and listens where their names begin with "on"; `false` and `undefined` take an attribute away. */
export function decorate(node: Element, attributes: Attributes): void {
    for (const [name, value] of Object.entries(attributes)) {
        if (typeof value === "function") {
            node.addEventListener(name.slice(2), value as EventListener);
        } else if (value === undefined || value === false) {
            node.removeAttribute(name);
        } else {
            node.setAttribute(name, value === true ? "" : String(value));
        }
    }
}

/** A new element of HTML. */
export function element<K extends keyof HTMLElementTagNameMap>(
    tag: K,
    attributes: Attributes = {},
    ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
    const node = document.createElement(tag);
    decorate(node, attributes);
    node.append(...children);
    return node;
}

/** A new element of SVG. */
export function drawn<K extends keyof SVGElementTagNameMap>(
    tag: K,
    attributes: Attributes = {},
    ...children: (Node | string)[]
): SVGElementTagNameMap[K] {
    const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
    decorate(node, attributes);
    node.append(...children);
    return node;
}

/** An element of the page, which must have it. */
export function found<T extends HTMLElement = HTMLElement>(id: string): T {
    const node = document.getElementById(id);
    if (node === null) {
        throw new Error(`the page has no #${id}`);
    }
    return node as T;
}

/** Icons as strokes in a square of 24 by 24. */
const ICONS = {
    scenes: "M4 5h7v6H4zM13 5h7v6h-7zM4 13h7v6H4zM13 13h7v6h-7z",
    settings: "M4 7h9M17 7h3M15 5v4M4 17h3M11 17h9M9 15v4M4 12h12M20 12h0M18 10v4",
    ray: "M3 6h4c7.5 0 12 4 12.5 12.5M11 17m-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0",
    save: "M12 4v10M8 10l4 4 4-4M5 19h14",
    share: "M9 14l6-6M8 11l-2 2a3.5 3.5 0 0 0 5 5l2-2M16 13l2-2a3.5 3.5 0 0 0-5-5l-2 2",
    full: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5",
    help: "M9 9.2a3 3 0 1 1 4.4 2.6c-1 .6-1.4 1.2-1.4 2.2M12 17.5v.3",
    reset: "M5 5v5h5M5.5 10a7 7 0 1 1-.4 4.5",
    close: "M6 6l12 12M18 6L6 18",
    play: "M8 5l11 7-11 7z",
    pause: "M8 5v14M16 5v14",
    info: "M12 11v6M12 7.4v.2M12 12m-9 0a9 9 0 1 0 18 0a9 9 0 1 0 -18 0",
};

export type IconName = keyof typeof ICONS;

export function icon(name: IconName): SVGSVGElement {
    const box = { viewBox: "0 0 24 24", class: "icon", "aria-hidden": "true", focusable: "false" };
    return drawn("svg", box, drawn("path", { d: ICONS[name] }));
}

/** A button that shows an icon alone; its label is what assistive technology reads, and a tooltip. */
export function iconButton(name: IconName, label: string, work: () => void): HTMLButtonElement {
    return element("button", { type: "button", class: "tool", "aria-label": label, title: label, onclick: work },
        icon(name));
}

/** A number in as many digits as tell something. */
export function digits(value: number, count = 4): string {
    if (!Number.isFinite(value)) {
        return "none";
    }
    const size = Math.abs(value);
    if (size !== 0 && (size >= 1e6 || size < 1e-4)) {
        return value.toExponential(count - 2).replace("e+", "e");
    }
    return String(Number(value.toPrecision(count))).replace("-", "\u2212");
}

/** Resolves after some milliseconds. */
export function sleep(milliseconds: number): Promise<void> {
    return new Promise((done) => setTimeout(done, milliseconds));
}
