// SPDX-License-Identifier: MIT OR Apache-2.0
// embed.mjs -- <bhr-hole>, its page for frames and the notebook's half of bhr.widget, in headless Chromium.
//
//     node embed.mjs PACKAGE SCRATCH
//
// PACKAGE: the folder that packaging/npm --tree makes; SCRATCH: a folder for pictures, unless BHR_TESTS_PICTURES names
// one. Prints a line for each test, and "N passed, M failed". Environment: that of browser.mjs.

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { bytesOf, difference, finished, here, holds, launched, opened, served, test } from "./browser.mjs";

const [pack, scratch] = process.argv.slice(2);
const pictures = process.env.BHR_TESTS_PICTURES ?? scratch;
const server = await served({ bhr: pack, scratch: pictures });
const browser = await launched();

const VIEWPORT = { width: 320, height: 180 };
const alt = "A hole for a test";
const query = new URLSearchParams({ spin: "0.3", distance: "24", controls: "", "max-pixels": "20000", alt,
    onclick: "window.wrong = 1", style: "width: 1px" });
const { page, said } = await opened(browser, "about:blank", { viewport: VIEWPORT });
await page.addInitScript(() => {
    // Devices that the page was given, and what its element says.
    window.devices = [];
    const { requestDevice } = GPUAdapter.prototype;
    GPUAdapter.prototype.requestDevice = async function (...given) {
        const device = await requestDevice.apply(this, given);
        devices.push(device);
        return device;
    };
    window.log = [];
    for (const kind of ["render", "input", "change", "error"]) {
        addEventListener(kind, (event) => {
            if (event.target instanceof HTMLElement && event.target.localName === "bhr-hole") {
                log.push({ kind, id: event.target.id, message: event.message, ...event.detail });
            }
        }, true);
    }
    window.first = () => document.querySelector("bhr-hole");
    window.notice = (element = first()) => element.shadowRoot.querySelector("[part=notice]");
    window.base64 = (bytes) => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
    window.decoded = async (url) => {
        const bitmap = await createImageBitmap(await (await fetch(url)).blob(), { colorSpaceConversion: "none" });
        const place = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
        place.drawImage(bitmap, 0, 0);
        return place.getImageData(0, 0, bitmap.width, bitmap.height).data;
    };
});
await page.goto(`${server.address}/bhr/embed.html?${query}#v=1&preset=teaching`);

/** What the page shows. */
async function seen(name, where = page) {
    await where.screenshot({ path: join(pictures, `embed-${name}.png`) });
    return bytesOf(await where.evaluate(async (url) => base64(await decoded(url)), `/scratch/embed-${name}.png`));
}

/** Begins to listen, does something, and waits for the event, and those until then. */
async function until(work, kind, detail = {}) {
    await page.evaluate(() => (log.length = 0));
    await work();
    await page.waitForFunction(([kind, detail]) => log.some((event) => event.kind === kind &&
        Object.entries(detail).every(([name, value]) => event[name] === value)), [kind, detail], { timeout: 60000 });
    return page.evaluate(() => log.slice());
}

const set = (name, value) => page.evaluate(([name, value]) => first().setAttribute(name, value), [name, value]);
const link = () => page.evaluate(() => first().hole.link());
const STILL = { still: true };

await test("the page for frames shows what its address says, and follows it", async () => {
    const isShown = () => log.some(({ kind, still }) => kind === "render" && still);
    await page.waitForFunction(isShown, null, { timeout: 60000 });
    const expected = /^v=1&preset=teaching&camera\.orbit\.distance=24&.*&hole\.spin=0\.3$/;
    holds(expected.test(await link()), await link());
    const found = await page.evaluate(() => {
        const { width, height } = first().hole.canvas;
        const names = first().getAttributeNames();
        return { width, height, names, title: document.title };
    });
    holds(found.width * found.height <= 20000 && found.width > 180, JSON.stringify(found));
    holds(!found.names.includes("onclick") && !found.names.includes("style"), "an address may set a script");
    holds(found.title === alt && await page.getByRole("img", { name: alt }).count() === 1, "nothing has the alt text");
    holds(new Set(await seen("page")).size > 20, "the page shows nothing");
    const other = "#v=1&preset=teaching&film.exposure_ev=-1";
    await until(() => page.evaluate((other) => (location.hash = other), other), "render", STILL);
    holds(/film\.exposure_ev=-1/.test(await link()) && /hole\.spin=0\.3/.test(await link()), await link());
});

await test("attributes have the names of links, and dashes for what markup does not allow", async () => {
    const cases = [
        [{ spin: "0.5", disk: "false" }, "v=1&hole.spin=0.5&disk=false"],
        [{ "film.exposure_ev": "-1" }, "v=1&film.exposure_ev=-1"],
        [{ "film-exposure-ev": "-1" }, "v=1&film.exposure_ev=-1"],
        [{ "volumes-0-inner-radius": "4", "hot-spots-0-radius": "9" },
            "v=1&volumes.0.inner_radius=4&hot_spots.0.radius=9"],
        [{ "camera-look-at": "1, 2 3" }, "v=1&camera.look_at=1,2,3"],
        [{ effects: "doppler_shift beaming" }, "v=1&effects=doppler_shift,beaming"],
        [{ fov: "50 deg", view: "redshift", time: "7" }, "v=1&camera.fov_y=50%20deg&view=redshift&time=7"],
        [{ scene: "https://a.example/b#v=1&hole.spin=0.9&time=2", spin: "0.1" }, "v=1&hole.spin=0.1&time=2"],
        [{ scene: "v=1&camera.position=0,3,4", elevation: "0" },
            `v=1&camera.orbit.distance=5&camera.orbit.azimuth=${Math.PI / 2}&camera.orbit.elevation=0`],
        [{ scene: "v=1&camera.orbit.distance=9", "camera-position": "0 3 4" }, "v=1&camera.position=0,3,4"],
        [{ class: "wide", title: "x", "data-spin": "7", "max-pixels": "9" }, "v=1"],
    ];
    const found = await page.evaluate(async (cases) => {
        const { settingsOf } = await import("/bhr/attributes.js");
        const { link } = await import("/bhr/link.js");
        const defaults = (await import("/bhr/wasm/bhr.js")).defaultScene();
        return cases.map(([attributes]) => link(settingsOf(new Map(Object.entries(attributes)), defaults), defaults));
    }, cases);
    found.forEach((link, i) => holds(link === cases[i][1], `${JSON.stringify(cases[i][0])} is ${link}`));
});

await test("attributes are followed; of a bad one the message is shown, and the last picture stays", async () => {
    await until(() => set("scene", "v=1&preset=teaching"), "render", STILL);
    const before = await seen("before");
    const [error] = await until(() => set("spin", "1.5"), "error");
    holds(error.message === "[hole]: spin is 1.5; it must lie in [-1, 1]", error.message);
    const shown = await page.evaluate(() => [notice().textContent, notice().role, notice().checkVisibility()]);
    holds(shown[0] === error.message && shown[2] === true, JSON.stringify(shown));
    await page.evaluate(() => (notice().style.opacity = 0));
    const after = await seen("mistake");
    await page.evaluate(() => (notice().style.opacity = ""));
    await seen("notice");
    holds(difference(before, after).over === 0, "the picture is another one");
    await until(() => set("spin", "-0.3"), "render", STILL);
    holds(!await page.evaluate(() => notice().checkVisibility()), "the notice stays");
    holds(difference(before, await seen("spin")).over > 300, "another spin shows the same");
    const [unknown] = await until(() => set("film-blom", "1"), "error");
    holds(/^\[film\] has no "blom"/.test(unknown.message), unknown.message);
    await page.evaluate(() => first().removeAttribute("film-blom"));
});

await test("a drag turns the hole, in fewer pixels until it is over, and tells of it", async () => {
    const before = await seen("still");
    // A budget that this machine does not hold.
    const events = await until(async () => {
        await page.mouse.move(100, 80);
        await page.mouse.down();
        for (let step = 1; step <= 8; step++) {
            await page.mouse.move(100 + step * 6, 80 + step * 2);
            await page.waitForTimeout(50);
        }
        await page.mouse.up();
    }, "render", STILL);
    const kinds = events.map(({ kind }) => kind);
    holds(kinds.filter((kind) => kind === "input").length >= 4 && kinds.includes("change"), kinds.join(" "));
    const moving = events.filter(({ kind, still }) => kind === "render" && !still);
    const last = events.at(-1);
    holds(moving.length > 0 && moving.every(({ width }) => width <= last.width), JSON.stringify(events));
    holds(moving.some(({ width }) => width < last.width), "every frame had all pixels");
    holds(difference(before, await seen("dragged")).over > 300, "a drag shows the same");
    const azimuth = Number(/azimuth=([-\d.e]+)/.exec(await link())[1]);
    holds(azimuth < 1.5 && azimuth > 0.5, `azimuth is ${azimuth}`);
    // Attributes that are no camera's leave it.
    await until(() => set("time", "5"), "render", STILL);
    holds((await link()).includes(`azimuth=${azimuth}`), await link());
});

const distance = async () => Number(/distance=([-\d.e]+)/.exec(await link())[1]);

await test("the wheel is the page's, but with ctrl or the focus; keys and pinches turn and come closer", async () => {
    await page.evaluate(() => {
        window.wheels = [];
        addEventListener("wheel", (event) => wheels.push(event.defaultPrevented));
        first().shadowRoot.querySelector("[part=picture]").blur();
    });
    const before = await distance();
    await page.mouse.wheel(0, 100);
    await page.waitForFunction(() => wheels.length === 1);
    holds(await distance() === before, "the wheel is stolen");
    await page.keyboard.down("Control");
    await until(() => page.mouse.wheel(0, -50), "change");
    await page.keyboard.up("Control");
    const nearer = await distance();
    holds(nearer < before, `${nearer} is not nearer`);
    await page.evaluate(() => first().focus());
    await until(() => page.mouse.wheel(0, 100), "change");
    holds(await distance() > nearer, "the focus does not count");
    holds((await page.evaluate(() => wheels)).join() === "false,true,true", "another event is the page's");
    const elevation = async () => Number(/elevation=([-\d.e]+)/.exec(await link())[1]);
    const low = await elevation();
    await until(() => page.keyboard.press("ArrowUp"), "change");
    holds(await elevation() > low, "the arrow does not turn");
    const far = await distance();
    await until(() => page.evaluate(() => {
        const picture = first().shadowRoot.querySelector("[part=picture]");
        const tell = (kind, pointerId, clientX) =>
            picture.dispatchEvent(new PointerEvent(kind, { pointerId, clientX, clientY: 90, button: 0 }));
        tell("pointerdown", 11, 140);
        tell("pointerdown", 12, 180);
        tell("pointermove", 11, 120);
        tell("pointermove", 12, 200);
        tell("pointerup", 11, 120);
        tell("pointerup", 12, 200);
    }), "change");
    holds(Math.abs(await distance() / far - 0.5) < 1e-9, `${await distance()} is not half of ${far}`);
    await until(() => page.keyboard.press("Home"), "render", STILL);
    holds(await distance() === 24, `Home goes to ${await distance()}`);
});

await test("the picture has the pixels of its place, within its limit", async () => {
    const shaped = (shape) => page.waitForFunction((shape) => {
        const { still, width, height } = log.at(-1) ?? {};
        return still && Math.abs(width / height - shape) < 0.05 && width * height <= first().getAttribute("max-pixels");
    }, shape, { timeout: 20000 });
    await page.setViewportSize({ width: 160, height: 120 });
    await shaped(4 / 3);
    const { width } = await page.evaluate(() => log.at(-1));
    await set("max-pixels", "9999");
    await shaped(4 / 3);
    const less = await page.evaluate(() => log.at(-1));
    holds(less.width < width && less.width > width / 2, JSON.stringify(less));
    await page.setViewportSize(VIEWPORT);
    await shaped(16 / 9);
});

await test("time runs where it is asked to, but not by itself for readers who want little motion", async () => {
    const time = () => page.evaluate(() => first().hole.scene.time);
    await page.emulateMedia({ reducedMotion: "reduce" });
    await set("playing", "");
    await page.waitForTimeout(300);
    holds(await time() === 5 && await page.evaluate(() => first().paused), "time runs");
    await until(() => page.emulateMedia({ reducedMotion: "no-preference" }), "render");
    await page.waitForFunction(() => first().hole.scene.time > 5);
    await page.evaluate(() => first().focus());
    await page.keyboard.press("Space");
    holds(await page.evaluate(() => first().paused), "the space bar does not stop it");
    await until(() => page.evaluate(() => first().removeAttribute("playing")), "render", STILL);
});

await test("elements share a device, trace where they are seen, and free it when they are gone", async () => {
    await until(() => page.evaluate(() => {
        document.body.insertAdjacentHTML("beforeend", `
            <bhr-hole id="second" scene="v=1&amp;preset=teaching" spin="-0.3" max-pixels="4000"
                style="position: absolute; inset: 0 50% 50% 0; width: auto; height: auto"></bhr-hole>
            <bhr-hole id="below" scene="v=1&amp;preset=teaching" style="position: absolute; top: 2500px"></bhr-hole>`);
    }), "render", { id: "second", still: true });
    await page.waitForTimeout(300);
    const found = await page.evaluate(async () => {
        const [one, second, below] = document.querySelectorAll("bhr-hole");
        window.gone = [one.hole, second.hole];
        return { devices: devices.length, below: below.hole === undefined, other: one.hole !== second.hole,
            name: second.shadowRoot.querySelector("[role=img]").ariaLabel };
    });
    holds(found.devices === 1 && found.below && found.other, JSON.stringify(found));
    const sentence = "A black hole of spin -0.3 with an accretion disk, seen from 26.1 M away, 5.49 degrees";
    holds(found.name.startsWith(sentence), found.name);
    await seen("two");
    const after = await page.evaluate(async () => {
        document.querySelectorAll("bhr-hole").forEach((element) => element.id && element.remove());
        await new Promise((done) => setTimeout(done));
        const state = (hole) => hole.image(8, 8).then(() => "there", () => "gone");
        return [await state(gone[0]), await state(gone[1])].join();
    });
    holds(after === "there,gone", after);
    const last = await page.evaluate(async () => {
        const element = first();
        element.remove();
        await new Promise((done) => setTimeout(done));
        const state = await gone[0].image(8, 8).then(() => "there", () => "gone");
        document.body.append(element);
        return [state, element.shadowRoot.querySelectorAll("canvas").length].join();
    });
    holds(last === "gone,0", last);
    await until(() => undefined, "render", STILL);
    holds(await page.evaluate(() => devices.length) === 2, "no device was asked for anew");
});

await test("after the device was lost another one shows the same", async () => {
    const before = await link();
    const picture = await seen("kept");
    await until(() => page.evaluate(() => {
        window.lost = first().hole;
        lost.loseDevice();
    }), "render", STILL);
    holds(await page.evaluate(() => first().hole !== lost && devices.length === 3), "it is the same device");
    holds(await link() === before && difference(picture, await seen("again")).over === 0, "it shows something else");
    holds(await page.evaluate(() => first().shadowRoot.querySelectorAll("canvas").length) === 1, "canvases pile up");
});

await test("nothing was said in the console", async () => holds(said.length === 0, said.join("\n")));
await page.close();

await test("the notebook's half shows a model, and tells it what readers do", async () => {
    const { page: notebook, said } = await opened(browser, `${server.address}/defaults-1.txt`, { viewport: VIEWPORT });
    await notebook.setContent('<div id="cell" style="width: 160px"></div>');
    const call = (work, given) => notebook.evaluate(work, given);
    await call(async () => {
        const packed = await new Response((await fetch("/bhr/wasm/bhr_bg.wasm")).body
            .pipeThrough(new CompressionStream("gzip"))).arrayBuffer();
        const listeners = [];
        const tell = (event, ...values) =>
            listeners.filter(([name]) => name === event).forEach(([, listener]) => listener(...values));
        window.asked = 0;
        window.model = {
            state: { scene: {}, spin: 0.5, preset: "teaching", distance: null, azimuth: null, elevation: "10 deg",
                fov: null, view: null, time: null, alt: "", controls: true, playing: false, rate: null, backend: "cpu",
                max_pixels: 3000, error: "" },
            saved: 0,
            listeners,
            get: (name) => model.state[name],
            set(name, value) {
                const is = JSON.stringify(model.state[name]) === JSON.stringify(value);
                model.state[name] = value;
                is || tell(`change:${name}`);
            },
            save_changes: () => model.saved++,
            on: (name, listener) => listeners.push([name, listener]),
            off(name, listener) {
                listeners.splice(listeners.findIndex(([n, f]) => n === name && f === listener), 1);
            },
            send(content) {
                asked += content.kind === "module" ? 1 : 0;
                tell("msg:custom", { kind: "module" }, [new DataView(packed)]);
            },
        };
        const { default: { render } } = await import("/bhr/notebook.js");
        window.end = render({ model, el: document.getElementById("cell") });
    });
    const state = () => call(() => ({ ...model.state, saved: model.saved }));
    await notebook.waitForFunction(() => model.saved > 0, null, { timeout: 30000 });
    const first = await state();
    const { orbit } = first.scene.camera;
    holds(first.scene.hole.spin === 0.5 && first.scene.preset === "teaching" && orbit.elevation === "10 deg" &&
        first.elevation === "10 deg" && first.distance === orbit.distance && first.error === "", JSON.stringify(first));
    const adapter = await call(() => document.querySelector("bhr-hole").hole.adapter.backend);
    holds(adapter === "cpu", `${adapter} traces`);
    await notebook.mouse.move(80, 40);
    await notebook.mouse.down();
    await notebook.mouse.move(110, 40);
    await notebook.mouse.up();
    await notebook.waitForFunction((before) => model.state.azimuth !== before, first.azimuth, { timeout: 20000 });
    const turned = await state();
    const { azimuth } = turned.scene.camera.orbit;
    holds(turned.azimuth < first.azimuth && azimuth === turned.azimuth, JSON.stringify(turned));
    // Back to where it was, as Python would do it; then a value, and then a link.
    await call((azimuth) => model.set("azimuth", azimuth), first.azimuth);
    await notebook.waitForFunction((azimuth) => model.state.scene.camera.orbit.azimuth === azimuth, first.azimuth);
    await call(() => model.set("spin", null));
    await notebook.waitForFunction(() => model.state.scene.hole === undefined);
    await call(() => model.set("scene", "v=1&hole.spin=0.25"));
    await notebook.waitForFunction(() => model.state.spin === 0.25 && model.state.preset === null);
    holds((await state()).scene === "v=1&hole.spin=0.25", (await state()).scene);
    await call(() => model.set("spin", 2));
    await notebook.waitForFunction(() => model.state.error !== "");
    holds(/^\[hole\]: spin is 2; /.test((await state()).error), (await state()).error);
    await notebook.screenshot({ path: join(pictures, "embed-notebook.png") });
    const over = await call(() => {
        end();
        return [asked, model.listeners.length, document.querySelectorAll("bhr-hole").length].join();
    });
    holds(over === "1,0,0", over);
    holds(said.length === 0, said.join("\n"));
});

await test("the element in docs/web.md shows a hole, and sharing a tracer shares no sky map", async () => {
    const samples = readFileSync(join(here, "../../docs/web.md"), "utf8").matchAll(/```html\n(.*?)```/gs);
    const [sample] = [...samples].map(([, text]) => text).filter((text) => text.includes("<bhr-hole"));
    // Few pixels of the tracer that compiles nothing are enough.
    const small = sample.replace("./bhr/", "/bhr/").replace(" controls", ' controls backend="cpu" max-pixels="2000"');
    writeFileSync(join(pictures, "element.html"), small);
    const { page: plain, said } = await opened(browser, `${server.address}/scratch/element.html`);
    await plain.waitForFunction(() => document.querySelector("bhr-hole").hole?.stats.frame_index > 0);
    const found = await plain.evaluate(async () => {
        const { BlackHole } = await import("/bhr/index.js");
        const make = async () => (await BlackHole.create(null, { backend: "cpu", shared: true }))
            .set({ disk: false, sky: { flags: ["map"] }, camera: { position: [0, 900, 0], forward: [0, 1, 0] } });
        const [one, other] = [await make(), await make()];
        const white = new ImageData(new Uint8ClampedArray(16 * 8 * 4).fill(255), 16, 8);
        await one.setSkyMap(white);
        const light = async (hole) => (await hole.image(2, 2)).data[0];
        const seen = [await light(one), await light(other), await light(one)];
        return { link: document.querySelector("bhr-hole").hole.link(), seen };
    });
    holds(/distance=26&.*elevation=6%20deg.*hole\.spin=0\.9/.test(found.link), found.link);
    holds(found.seen[0] > 100 && found.seen[1] === 0 && found.seen[2] === found.seen[0], found.seen.join());
    holds(said.length === 0, said.join("\n"));
});

await finished(browser, server);
