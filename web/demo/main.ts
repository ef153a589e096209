// SPDX-License-Identifier: MIT OR Apache-2.0
// main.ts -- puts the page together: its parts, its buttons and keys, the address with the scene in it. The page's
// address takes `?pixels=N` and `?samples=N`, limits for its picture, and `?backend=cpu`.

import type { Settings } from "./bhr/index.js";
import { withFittedView } from "./camera.js";
import { caption } from "./caption.js";
import { Controls } from "./controls.js";
import { element, found, iconButton } from "./dom.js";
import { Falls } from "./falls.js";
import { Files } from "./files.js";
import { Inspector } from "./inspector.js";
import { Maps } from "./maps.js";
import { attempt, failure, notice } from "./notices.js";
import { Panel } from "./panel.js";
import { Presets } from "./presets.js";
import { Session, type Backend } from "./session.js";
import { Sheet } from "./sheet.js";
import { View, type Progress } from "./view.js";

declare global {
    interface Window {
        /** For tests, and for the curious at the console. */
        demo?: { session: Session };
    }
}

/** Browsers allow some hundred changes of an address in half a minute. */
const LINK_MS = 500;
const MOVING_LINK_MS = 2000;
/** Matter moves by itself on devices that show it at full resolution. */
const QUICK_MS = 20;

const BY_CPU = "The processor traces, as the page's address asks, in double precision.";
const NO_WEBGPU = "This browser gives the page no WebGPU, so the processor traces, in double precision: pictures are "
    + "small and take seconds. Chrome and Edge have WebGPU from version 113 on, Firefox on "
    + "Windows from 141, Safari from 26.";

function backendOf(text: string | null): Backend {
    return text === "cpu" || text === "webgpu" ? text : "auto";
}

/** Keeps the scene in the page's address, and shows what an address says. */
function follow(session: Session, falls: Falls, reset: () => void): void {
    let written = location.hash;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const write = () => {
        timer = undefined;
        attempt(() => {
            const link = `#${session.link}`;
            if (link !== written) {
                written = link;
                history.replaceState(history.state, "", link);
            }
        });
    };
    session.onChange(() => {
        timer ??= setTimeout(write, falls.isPlaying ? MOVING_LINK_MS : LINK_MS);
    });
    addEventListener("hashchange", () => attempt(() => {
        if (location.hash !== written) {
            written = location.hash;
            if (location.hash.length > 1) {
                session.replace((hole) => hole.load(location.hash));
            } else {
                reset();
            }
        }
    }));
}

function docs(): void {
    // Where the documentation is depends on where the page is served: without an address its pages are named only.
    const base = document.querySelector<HTMLMetaElement>('meta[name="bhr-docs"]')?.content ?? "";
    for (const node of document.querySelectorAll<HTMLElement>("[data-docs]")) {
        if (base !== "") {
            const link = element("a", { href: base + (node.dataset.docs ?? ""), target: "_blank", rel: "noopener" });
            link.append(...node.childNodes);
            node.replaceChildren(link);
        }
    }
}

async function fullScreen(): Promise<void> {
    if (document.fullscreenElement !== null) {
        await document.exitFullscreen();
    } else if (typeof document.documentElement.requestFullscreen === "function") {
        await document.documentElement.requestFullscreen();
    } else {
        notice("This browser does not support full screen.");
    }
}

async function start(): Promise<void> {
    const address = new URLSearchParams(location.search);
    const limit = (name: string, least: number) => {
        const value = Number(address.get(name) ?? NaN);
        return value >= least ? value : undefined;
    };
    const limits = { pixels: limit("pixels", 256), samples: limit("samples", 1) };
    const stage = found("stage");
    const session = await Session.start(stage, backendOf(address.get("backend")));
    window.demo = { session };
    const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const aspect = () => stage.clientWidth / Math.max(1, stage.clientHeight);
    const reset = () => {
        session.replace((hole) => hole.reset());
        // The disk of a new scene is wider than the frame that scenes are made for.
        session.change(withFittedView(session.settings, session.values, aspect(), 2.1));
    };
    let isLinked = location.hash.length > 1;
    if (isLinked) {
        try {
            session.replace((hole) => hole.load(location.hash));
        } catch (error) {
            isLinked = false;
            failure(error);
        }
    }
    if (!isLinked) {
        reset();
    }

    const view = new View(session, stage, limits);
    const falls = new Falls(session, () => view.touch());
    view.advance = () => falls.advance();
    const sheet = new Sheet();
    const inspector = new Inspector(session, stage, view);
    const panel = new Panel(session, (motion) => falls.move(motion));
    const presets = new Presets(session, stage, ({ settings }) => {
        falls.pause();
        // A journey begins at its beginning.
        if (settings.camera?.motion !== undefined && !isCalm) {
            session.change({ camera: { proper_time: undefined } } as unknown as Settings);
            falls.start();
        }
    });
    const files = new Files(session, view);
    new Maps(session);
    const controls = new Controls(session, stage, () => falls.isCarried);
    const help = found<HTMLDialogElement>("help");
    const ask = () => (help.open ? help.close() : help.showModal());
    help.addEventListener("click", (event) => event.target === help && help.close());

    const tools = {
        scenes: iconButton("scenes", "Scenes", () => sheet.toggle("scenes")),
        settings: iconButton("settings", "Settings (P)", () => sheet.toggle("settings")),
        ray: iconButton("ray", "Ray inspector (I)", () => sheet.toggle("ray")),
        save: iconButton("save", "Save and open", () => sheet.toggle("save")),
        share: iconButton("share", "Share a link (S)", () => attempt(() => files.share())),
        full: iconButton("full", "Full screen (F)", () => attempt(fullScreen)),
        help: iconButton("help", "Help and about (H)", ask),
    };
    tools.full.classList.add("wide-only");
    found("tools").append(...Object.values(tools));
    found("help-close").addEventListener("click", () => help.close());
    docs();

    // Once the cards are seen, and the picture needs the device no more.
    let isSharp = false;
    const measure = () => {
        if (isSharp && sheet.current === "scenes") {
            attempt(() => presets.measure());
        }
    };
    sheet.shown = (tab) => {
        for (const name of ["scenes", "settings", "ray", "save"] as const) {
            tools[name].setAttribute("aria-pressed", String(tab === name));
        }
        if (tab === "ray") {
            inspector.open();
        } else {
            inspector.close();
        }
        if (tab === "settings") {
            panel.wake();
        }
        measure();
    };
    controls.clicked = (x, y) => {
        sheet.open("ray");
        inspector.open(x, y);
    };
    controls.arrows = (dx, dy) => inspector.step(dx, dy);
    controls.listen({
        " ": () => falls.toggle(),
        f: () => attempt(fullScreen),
        h: ask,
        s: () => attempt(() => files.share()),
        r: () => {
            falls.pause();
            reset();
        },
        i: () => sheet.toggle("ray"),
        p: () => sheet.toggle("settings"),
        escape: () => sheet.close(),
    });
    follow(session, falls, reset);

    const line = found("caption");
    const name = () => attempt(() => {
        const parts = caption(session);
        line.replaceChildren(...parts.map((part) => element("span", {}, part)));
        stage.setAttribute("aria-label", `Picture of a black hole. ${parts.join(". ")}. Arrow keys turn about it.`);
    });
    let named: ReturnType<typeof setTimeout> | undefined;
    session.onChange(() => {
        named ??= setTimeout(() => {
            named = undefined;
            name();
        }, 100);
    });
    name();

    const state = found("state");
    let frames = 0;
    let isFirst = true;
    view.shown = (progress: Progress) => {
        const { width, height, samples, isFinal, isMoving } = progress;
        Object.assign(stage.dataset, { frames: ++frames, samples, final: isFinal, size: `${width}x${height}` });
        state.textContent = `${width} × ${height}${samples > 1 ? `, ${samples} samples` : ""}`
            + (isFinal || isMoving ? "" : " ...");
        if (isFirst) {
            found("start").remove();
            document.body.classList.add("ready");
        }
        if (isFirst && !session.isGpu) {
            notice(address.get("backend") === "cpu" ? BY_CPU : NO_WEBGPU, "error");
        }
        isFirst = false;
        if (isFinal && !isSharp) {
            isSharp = true;
            measure();
        }
        const isQuick = view.expected(width * height) < QUICK_MS && session.isGpu;
        if (isFinal && frames < 12 && isQuick && !isCalm && !isLinked && session.value("view") === "light") {
            isLinked = true;
            falls.start();
        }
    };
    if (matchMedia("(min-width: 1100px)").matches) {
        sheet.open("scenes");
    } else {
        sheet.close();
    }
    view.touch();
}

start().catch((error: unknown) => {
    const { message } = error as { message?: string };
    found("start").replaceChildren(element("p", {}, "The page cannot show a black hole here."),
        element("p", { class: "hint" }, String(message ?? error)));
});
