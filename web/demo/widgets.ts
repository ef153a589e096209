// SPDX-License-Identifier: MIT OR Apache-2.0
// widgets.ts -- rows of the panel: sliders with number fields, choices, flags, vectors. They read and set a value by
// two functions, and know no scene.

import { digits, element, icon } from "./dom.js";
import type { Reach, Row } from "./fields.js";
import type { Value } from "./values.js";

/** How a row reads and sets its value. */
export interface Access {
    get(): Value | undefined;
    /** `undefined` takes the value back. Throws for one that is not allowed. */
    set(value: Value | undefined): void;
    /** Whether there is something to take back. */
    isSet(): boolean;
}

/** A row, and what brings it up to date. */
export interface Widget {
    node: HTMLElement;
    update(): void;
}

const STEPS = 1000;

function placeOf(value: number, { least, most, isLog }: Reach): number {
    const share = isLog ? Math.log(value / least) / Math.log(most / least) : (value - least) / (most - least);
    return Math.round(STEPS * Math.min(1, Math.max(0, Number.isFinite(share) ? share : 0)));
}

function valueAt(place: number, { least, most, isLog }: Reach): number {
    const share = place / STEPS;
    return isLog ? least * (most / least) ** share : least + (most - least) * share;
}

let count = 0;
const newId = () => `row-${++count}`;

const sentence = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);

/** A row's frame: its name, its message, its comment behind a button, and its reset. */
class Frame {
    readonly id = newId();
    readonly node: HTMLElement;
    private readonly message: HTMLElement;
    private readonly reset: HTMLButtonElement;

    constructor(
        row: { label: string; about: string },
        private readonly access: Access,
        content: HTMLElement[],
        isGroup: boolean,
    ) {
        const about = element("p", { class: "about", id: `${this.id}-about`, hidden: true }, row.about);
        const info = element("button", {
            type: "button", class: "mini", "aria-label": `About ${row.label}`, "aria-expanded": "false",
            "aria-controls": about.id,
            onclick: () => {
                about.hidden = !about.hidden;
                info.setAttribute("aria-expanded", String(!about.hidden));
            },
        }, icon("info"));
        this.reset = element("button", {
            type: "button", class: "mini", "aria-label": `Reset ${row.label}`, title: "Reset",
            onclick: () => this.assign(undefined),
        }, icon("reset"));
        this.message = element("p", { class: "message", role: "alert", hidden: true });
        const name = isGroup
            ? element("span", { class: "name", id: `${this.id}-name`, title: row.about }, sentence(row.label))
            : element("label", { class: "name", for: this.id, title: row.about }, sentence(row.label));
        this.node = element("div", { class: "row", ...(isGroup && { role: "group", "aria-labelledby": name.id }) },
            element("div", { class: "head" }, name, info, this.reset), ...content, this.message, about);
    }

    /** Sets a value; a message about a bad one stands in the row until there is a good one. */
    assign(value: Value | undefined): void {
        try {
            this.access.set(value);
            this.message.hidden = true;
        } catch (error) {
            this.message.textContent = error instanceof Error ? error.message : String(error);
            this.message.hidden = false;
        }
    }

    update(): void {
        // A button that is gone would lose the focus: it stays, and is dimmed.
        this.reset.disabled = !this.access.isSet();
    }
}

/** A number in a field that is typed in, told when it is left or confirmed. */
function numberField(id: string, label: string, tell: (value: number) => void): HTMLInputElement {
    const field = element("input", { id, type: "text", inputmode: "decimal", class: "number", "aria-label": label,
        autocomplete: "off", spellcheck: "false" });
    field.addEventListener("change", () => {
        const value = Number(field.value.replace("\u2212", "-").replace(",", ".").replace(/[^-+.\deE]/g, ""));
        if (field.value.trim() !== "" && Number.isFinite(value)) {
            tell(value);
        }
    });
    field.addEventListener("focus", () => field.select());
    return field;
}

function showIn(field: HTMLInputElement, text: string): void {
    // A number stays while it is typed.
    if (document.activeElement !== field || field.dataset.shown === undefined) {
        field.value = text;
    }
    field.dataset.shown = text;
}

export function slider(row: Row, access: Access): Widget {
    const { label, reach, scale, shownUnit } = row;
    const isWhole = row.kind === "seed" || /^(spike_blades|flare_ghosts)$/.test(row.name);
    const range = element("input", { type: "range", min: 0, max: STEPS, step: 1, class: "slider" });
    const unit = element("span", { class: "unit", title: row.unit ?? "" }, shownUnit);
    const number = numberField("", `${label}, as a number`, (shown) => {
        frame.assign(shown / scale);
        range.value = String(placeOf(shown / scale, reach));
    });
    const frame = new Frame(row, access, [element("div", { class: "line" }, range, number, unit)], false);
    range.id = frame.id;
    number.removeAttribute("id");
    const rounded = (value: number) => Number(value.toPrecision(4));
    range.addEventListener("input", () => {
        const raw = valueAt(Number(range.value), reach);
        // At its lower end a log slider means 0 where 0 is allowed.
        const isZero = reach.isLog && range.value === "0" && (row.range?.[0] ?? 1) <= 0;
        const span = (reach.most - reach.least) / STEPS;
        const value = isZero ? 0 : isWhole ? Math.round(raw)
            : reach.isLog ? rounded(raw) : Math.abs(raw) < span / 2 ? 0 : rounded(raw);
        frame.assign(value);
    });
    const update = () => {
        const value = Number(access.get() ?? NaN);
        const text = digits(value * scale, isWhole ? 16 : scale === 1 ? 5 : 4);
        if (document.activeElement !== range || placeOf(value, reach) !== Number(range.value)) {
            range.value = String(placeOf(value, reach));
        }
        range.setAttribute("aria-valuetext", `${text} ${shownUnit}`);
        range.style.setProperty("--share", `${Number(range.value) / (STEPS / 100)}%`);
        showIn(number, text);
        frame.update();
    };
    return { node: frame.node, update };
}

export function choice(row: Row, access: Access): Widget {
    const words = row.words ?? [];
    const select = element("select", { class: "choice" }, ...words.map(({ word, about }) =>
        element("option", { value: word, title: about }, sentence(word.replaceAll("_", " ")))));
    const about = `${row.about} ${words.map((one) => `${one.word}: ${one.about}`).join(" ")}`;
    const frame = new Frame({ label: row.label, about }, access, [element("div", { class: "line" }, select)], false);
    select.id = frame.id;
    select.addEventListener("change", () => frame.assign(select.value));
    const update = () => {
        select.value = String(access.get());
        frame.update();
    };
    return { node: frame.node, update };
}

/** Boxes to tick. `all`: a word that stands for all of them. */
export function flags(row: Row, access: Access, all?: string): Widget {
    const words = row.words ?? [];
    const boxes = words.map(({ word, about }) => {
        const box = element("input", { type: "checkbox", class: "switch" });
        box.addEventListener("change", () => {
            const chosen = words.filter((_, i) => boxes[i]?.box.checked).map((one) => one.word);
            frame.assign(all !== undefined && chosen.length === words.length ? [all] : chosen);
        });
        const label = element("label", { class: "tick", title: about }, box, sentence(word.replaceAll("_", " ")));
        return { box, label, word };
    });
    const list = element("div", { class: "ticks" }, ...boxes.map(({ label }) => label));
    const about = `${row.about} ${words.map((one) => `${one.word}: ${one.about}`).join(" ")}`;
    const frame = new Frame({ label: row.label, about }, access, [list], true);
    const update = () => {
        const now = (access.get() ?? []) as readonly string[];
        for (const { box, word } of boxes) {
            box.checked = now.includes(word) || (all !== undefined && now.includes(all));
        }
        frame.update();
    };
    return { node: frame.node, update };
}

export function vector(row: Row, access: Access, names: readonly string[] = ["x", "y", "z"]): Widget {
    const fields = names.map((name, i) => numberField("", `${row.label}, ${name}`, (value) => {
        const now = [...((access.get() ?? []) as readonly number[])];
        now[i] = value;
        frame.assign(now);
    }));
    fields.forEach((field, i) => {
        field.removeAttribute("id");
        field.title = names[i] ?? "";
    });
    const unit = row.shownUnit === "" ? [] : [element("span", { class: "unit" }, row.shownUnit)];
    const frame = new Frame(row, access, [element("div", { class: "line" }, ...fields, ...unit)], true);
    const update = () => {
        const now = (access.get() ?? []) as readonly number[];
        fields.forEach((field, i) => showIn(field, digits(Number(now[i]), 5)));
        frame.update();
    };
    return { node: frame.node, update };
}

/** The widget that a field's kind asks for. */
export function widget(row: Row, access: Access): Widget {
    switch (row.kind) {
        case "choice":
            return choice(row, access);
        case "flags":
            return flags(row, access);
        case "vector":
            return vector(row, access, row.name === "tint" ? ["red", "green", "blue"]
                : row.name === "jitter" ? ["x", "y"] : undefined);
        default:
            return slider(row, access);
    }
}

/** A switch with a name. */
export function toggle(label: string, get: () => boolean, set: (isOn: boolean) => void): Widget {
    const box = element("input", { type: "checkbox", class: "switch", onchange: () => set(box.checked) });
    const node = element("label", { class: "tick row" }, box, label);
    return { node, update: () => (box.checked = get()) };
}

/** Numbers under their names, which are not set. */
export function facts(entries: readonly (readonly [string, string, () => string])[]): Widget {
    const values = entries.map(() => element("dd"));
    const node = element("dl", { class: "facts" }, ...entries.flatMap(([name, about], i) =>
        [element("div", { title: about }, element("dt", {}, name), values[i] as HTMLElement)]));
    const update = () => entries.forEach(([, , read], i) => ((values[i] as HTMLElement).textContent = read()));
    return { node, update };
}
