// SPDX-License-Identifier: MIT OR Apache-2.0
// demo.mjs -- the page of web/demo in headless Chromium, driven as people drive it: by mouse, fingers and keys.
//
//     node demo.mjs PAGE SCRATCH
//
// PAGE: the folder that packaging/page makes; SCRATCH: a folder for files. Prints a line for each test, and "N passed,
// M failed". Environment: as browser.mjs has it; PYTHON, one that has the module OpenEXR, if it is to read EXR files as
// well; BHR_TESTS_PICTURES, a folder for screenshots.

import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync, inflateSync } from "node:zlib";
import { finished, holds, launched, opened, served, test } from "./browser.mjs";

const [folder, scratch] = process.argv.slice(2);
const pictures = process.env.BHR_TESTS_PICTURES;
if (pictures) {
    mkdirSync(pictures, { recursive: true });
}
const server = await served({ demo: folder });
const browser = await launched();
const address = `${server.address}/demo/?pixels=6000&samples=4`;
const DESKTOP = { viewport: { width: 1440, height: 900 } };
const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 };

const pages = [];
/** A page of the demo. All that its console says has to be expected. */
async function demo(options, hash = "") {
    const made = await opened(browser, address + hash, options);
    made.page.setDefaultTimeout(180000);
    pages.push(made);
    return made.page;
}

const shot = async (page, name) => pictures && page.screenshot({ path: join(pictures, `demo-${name}.png`) });
const frames = (page) => page.evaluate(() => Number(document.getElementById("stage").dataset.frames ?? 0));
const shown = (page, least = 1) => page.waitForFunction((least) =>
    Number(document.getElementById("stage").dataset.frames ?? 0) >= least, least);
/** Until the picture is as fine as it gets. */
const sharp = (page) => page.waitForFunction(() => document.getElementById("stage").dataset.final === "true");
const scene = (page) => page.evaluate(() => window.demo.session.settings);
/** The link in the page's address, once it is that of the scene. */
const hash = async (page) => {
    await page.waitForFunction(() => location.hash === `#${window.demo.session.link}`);
    return new URL(page.url()).hash;
};
/** The bytes of a file that a click has the browser save. */
async function download(page, name) {
    const [file] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name }).click()]);
    const path = join(scratch, file.suggestedFilename());
    await file.saveAs(path);
    return { path, bytes: readFileSync(path) };
}

/** Reads an EXR file of four channels with ZIP's compression: the first line of each channel, and the sizes. */
function readExr(bytes) {
    let at = 8;
    const text = () => {
        const end = bytes.indexOf(0, at);
        const read = bytes.toString("latin1", at, end);
        at = end + 1;
        return read;
    };
    const attributes = {};
    for (let name = text(); name !== ""; name = text()) {
        text();
        const size = bytes.readInt32LE(at);
        attributes[name] = bytes.subarray(at + 4, at + 4 + size);
        at += 4 + size;
    }
    const [width, height] = [8, 12].map((place) => attributes.dataWindow.readInt32LE(place) + 1);
    const count = Math.ceil(height / 16);
    const lines = [];
    for (let i = 0; i < count; i++) {
        const place = Number(bytes.readBigUInt64LE(at + 8 * i));
        const size = bytes.readInt32LE(place + 4);
        const rows = Math.min(16, height - 16 * i);
        const plain = rows * width * 8;
        let data = bytes.subarray(place + 8, place + 8 + size);
        if (size < plain) {
            const packed = inflateSync(data);
            for (let j = 1; j < packed.length; j++) {
                packed[j] = (packed[j] + packed[j - 1] - 128) & 255;
            }
            const half = Math.ceil(packed.length / 2);
            data = Buffer.from(packed.map((_, j) => packed[(j & 1 ? half : 0) + (j >> 1)]));
        }
        holds(bytes.readInt32LE(place) === 16 * i && data.length === plain, `block ${i} has ${data.length} bytes`);
        lines.push(data);
    }
    return { width, height, compression: attributes.compression[0], channels: attributes.channels, data: lines };
}

const numberOf = (half) => {
    const [sign, exponent, rest] = [half & 0x8000 ? -1 : 1, (half >> 10) & 31, half & 1023];
    const size = exponent === 0 ? rest * 2 ** -24 : exponent === 31 ? Infinity : (1024 + rest) * 2 ** (exponent - 25);
    return sign * size;
};

await test("the frame budget follows a device, up and down", async () => {
    // The page's scripts are modules without a package.json that says so.
    const source = readFileSync(join(folder, "budget.js"), "utf8");
    const { Budget } = await import(`data:text/javascript,${encodeURIComponent(source)}`);
    const pixels = 2e6;
    for (const [each, share, samples] of [[2e-6, 1, 4], [9e-6, 1, 1], [4e-5, 0.25, 1], [1e-3, 0.125, 1]]) {
        const budget = new Budget(true);
        const frame = () => {
            const plan = budget.moving;
            budget.took(pixels * plan.share * plan.samples * each, pixels * plan.share * plan.samples, plan, true);
        };
        Array.from({ length: 60 }, frame);
        const { moving } = budget;
        holds(Math.abs(moving.share / share - 1) < 0.01 && moving.samples === samples,
            `${each} ms for each pixel: ${JSON.stringify(moving)}`);
    }
    // Views of numbers have one sample; 16 that take ten minutes are too many.
    const slow = new Budget(true);
    slow.took(2e4, 1e6, slow.moving, false);
    holds(slow.resting(pixels, true).length === 2 && slow.resting(pixels, false).length === 1, "too much at rest");
    const cpu = new Budget(false);
    cpu.took(1e4, 1e6, cpu.moving, false);
    holds(JSON.stringify(cpu.resting(pixels, true)) === '[{"share":0.25,"samples":1}]', "too much for the CPU");
});

const page = await demo(DESKTOP);
let first;

await test("a picture comes, and sharpens", async () => {
    await shown(page);
    await sharp(page);
    holds((await page.getAttribute("#stage", "data-samples")) === "4", "the picture has another number of samples");
    holds(/^No spin.*26\.12 M.*ACES/.test(await page.textContent("#caption")), "the line says something else");
    first = await page.locator("canvas").screenshot();
    await shot(page, "scenes");
});

await test("all that a visitor loads is less than 2,000,000 bytes by gzip", async () => {
    const names = await page.evaluate(() => performance.getEntriesByType("resource").map(({ name }) => name));
    const files = new Set([...names.map((name) => new URL(name).pathname.replace(/^\/demo\//, "")), "index.html"]);
    const sizes = [...files].map((file) => gzipSync(readFileSync(join(folder, file)), { level: 9 }).length);
    const sum = sizes.reduce((all, one) => all + one, 0);
    holds(files.has("bhr/wasm/bhr_bg.wasm") && files.size > 30, [...files].join(" "));
    holds(sum > 5e5 && sum < 2e6, `${sum} bytes in ${files.size} files`);
});

await test("a drag turns about the hole, and the address follows", async () => {
    const before = await frames(page);
    await page.mouse.move(500, 400);
    await page.mouse.down();
    await page.mouse.move(650, 460, { steps: 3 });
    await page.mouse.up();
    await shown(page, before + 1);
    const { orbit, turn } = (await scene(page)).camera;
    // 150 and 60 of 900 pixels, half a turn for all of them.
    const [azimuth, elevation] = [Math.PI / 2 - Math.PI / 6, Math.atan(2.5 / 26) + Math.PI / 15];
    holds(Math.abs(orbit.azimuth - azimuth) < 0.03 && Math.abs(orbit.elevation - elevation) < 0.03,
        JSON.stringify(orbit));
    holds(turn === undefined, "the look was turned as well");
    holds(/^#v=1&.*camera\.orbit\.azimuth=1\.0/.test(await hash(page)), await hash(page));
    holds(!(await page.locator("canvas").screenshot()).equals(first), "the picture is as before");
    holds(await page.locator("#ray").isHidden(), "a drag is no click");
});

await test("wheel, keys and shift-drag move as the help says", async () => {
    const { orbit } = (await scene(page)).camera;
    await page.mouse.wheel(0, -400);
    await page.waitForFunction((before) => window.demo.session.settings.camera.orbit.distance < 0.8 * before,
        orbit.distance);
    await page.locator("#stage").focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("-");
    await page.keyboard.down("Shift");
    await page.mouse.down();
    await page.mouse.move(600, 400);
    await page.mouse.up();
    await page.keyboard.up("Shift");
    const after = (await scene(page)).camera;
    holds(after.orbit.azimuth > orbit.azimuth && after.turn.right !== undefined, JSON.stringify(after));
});

await test("a slider sets a field, a bad number is told in its row, and reset takes the field back", async () => {
    await page.keyboard.press("p");
    const slider = page.getByLabel("Elevation", { exact: true });
    await slider.focus();
    await page.keyboard.press("End");
    await page.waitForFunction(() => window.demo.session.settings.camera.orbit.elevation > 1.56);
    await page.getByRole("button", { name: "Reset elevation" }).click();
    await page.waitForFunction(() => Math.abs(window.demo.session.settings.camera.orbit.elevation - 0.0958) < 1e-3);
    await shot(page, "panel");
    const number = page.getByLabel("spin, as a number");
    await number.fill("1.5");
    await number.press("Enter");
    await page.getByText("spin is 1.5; it must lie in").waitFor();
    holds((await scene(page)).hole === undefined, "a bad number was set");
    await page.getByText("View and effects").click();
    await page.getByLabel("View", { exact: true }).selectOption("redshift");
    await page.getByText("redshift g of the light").waitFor();
});

await test("every field that bhr.h has of these structs is in the panel", async () => {
    const json = JSON.parse(readFileSync(new URL("../../include/bhr.json", import.meta.url), "utf8"));
    await page.evaluate(() => window.demo.session.change({ volumes: [{}], hot_spots: [{}] }));
    await page.getByText("Hot spot 1", { exact: true }).waitFor({ state: "attached" });
    const names = await page.locator("#settings .name").evaluateAll((all) =>
        all.map((node) => node.textContent.toLowerCase()));
    const left = /^(struct_size|reserved\d*|orientation|paper_white|peak)$/;
    for (const struct of ["BhrDisk", "BhrSky", "BhrFilm", "BhrVolume", "BhrHotSpot"]) {
        const { fields } = json.structs.find(({ name }) => name === struct);
        for (const { name } of fields.filter(({ name }) => !left.test(name))) {
            holds(names.includes(name.replace(/_ev$/, "").replaceAll("_", " ")), `${struct}.${name} is missing`);
        }
    }
    await page.evaluate(() => window.demo.session.change({ volumes: undefined, hot_spots: undefined }));
});

await test("a card shows its scene, and those with depth are measured first", async () => {
    await page.getByRole("tab", { name: "Scenes" }).click();
    await page.getByRole("button", { name: /^Teaching/ }).click();
    holds((await scene(page)).preset === "teaching" && (await scene(page)).view === undefined, "it is another scene");
    await page.locator("#caption", { hasText: "without a tone curve" }).waitFor();
    const broken = await page.locator(".card img").evaluateAll((all) => all.filter((one) => {
        one.loading = "eager";
        return one.complete && one.naturalWidth === 0;
    }).length);
    holds(broken === 0, `${broken} cards have no picture`);
    // SwiftShader is never quick enough.
    await page.getByText(/Not offered: this device takes \d+ ms/).waitFor();
    holds(await page.getByRole("button", { name: /^Jets/ }).isDisabled(), "depth is offered");
});

await test("a link in a second page shows the same scene", async () => {
    await page.locator("#stage").focus();
    await page.keyboard.press("ArrowLeft");
    const link = await hash(page);
    const other = await demo({ viewport: { width: 800, height: 500 } }, link);
    await other.waitForFunction(() => window.demo !== undefined);
    const [one, two] = [await page.evaluate(() => window.demo.session.text),
        await other.evaluate(() => window.demo.session.text)];
    holds(one === two && /"grid"/.test(two), "another scene");
    await other.evaluate(() => (location.hash = "#v=1&hole.spin=7"));
    await other.getByText("spin is 7; it must lie in").waitFor();
    holds((await other.evaluate(() => window.demo.session.text)) === two, "a bad link changed the scene");
    await other.close();
});

await test("a camera told by position and forward stays where it is, in orbit and turn", async () => {
    const worst = await page.evaluate(async () => {
        const { valuesOf } = await import("./values.js");
        const { poseOf, settingsOf } = await import("./camera.js");
        const { session } = window.demo;
        const cameraOf = (camera) => session.meanwhile({ camera }, (hole) => valuesOf(hole.text())).sections.camera;
        let worst = 0;
        for (let i = 0; i < 40; i++) {
            const [a, b, c] = [1, 2, 3].map((k) => Math.sin(k * (i + 0.5) * 1.7));
            const { position, forward, up } = cameraOf({ orbit: { distance: 20 + 9 * a, azimuth: 3 * b, elevation: c },
                turn: { right: 3 * c, up: 1.4 * a, roll: 3 * b } });
            const told = { position, forward, up };
            const values = session.meanwhile({ camera: told }, (hole) => valuesOf(hole.text()));
            const again = cameraOf(settingsOf(poseOf({ camera: told }, values)).camera);
            for (const name of ["position", "forward", "up"]) {
                told[name].forEach((one, k) => (worst = Math.max(worst, Math.abs(one - again[name][k]))));
            }
        }
        return worst;
    });
    holds(worst < 2e-5, `they differ by ${worst}`);
});

await test("a click shows the ray of its pixel", async () => {
    await page.evaluate(() => window.demo.session.replace((hole) => hole.reset()));
    await page.mouse.click(720, 430);
    await page.getByText("captured: it comes from the horizon").waitFor();
    const told = await page.textContent("#ray");
    holds(/swept_angle[\d.]+°/.test(told) && /steps\d+/.test(told), told);
    const points = await page.locator("#ray .path").first().getAttribute("points");
    holds(points.split(" ").length > 20, "the path has too few points");
    await shot(page, "ray");
    // By keys to the sky.
    for (let i = 0; i < 45; i++) {
        await page.keyboard.press("ArrowUp");
    }
    await page.getByText("escaped: it comes from the sky").waitFor();
    await page.keyboard.press("Escape");
    await page.locator("#panel").waitFor({ state: "hidden" });
});

await test("a PNG file is a picture of the size asked for, and an EXR file reads back", async () => {
    await page.getByRole("button", { name: "Save and open" }).click();
    await page.locator("#save-size").selectOption("2x");
    const { bytes } = await download(page, "Save PNG");
    const size = (await page.getAttribute("#stage", "data-size")).split("x").map(Number);
    holds(bytes.toString("latin1", 1, 4) === "PNG", "no PNG file");
    holds(bytes.readUInt32BE(16) === 2 * size[0] && bytes.readUInt32BE(20) === 2 * size[1],
        `${bytes.readUInt32BE(16)} x ${bytes.readUInt32BE(20)}`);
    holds(bytes.length > 2000, "the picture is empty");
    // One that takes long can be ended.
    await page.locator("#save-size").selectOption("4k");
    await page.getByRole("button", { name: "Save PNG" }).click();
    await page.getByText(/^PNG, 3840 x \d+ pixels/).waitFor();
    await page.getByRole("button", { name: "Cancel" }).click();
    await page.getByRole("button", { name: "Cancel" }).waitFor({ state: "hidden" });
    await page.locator("#save-size").selectOption("1x");
    const exr = await download(page, "Save EXR");
    const read = readExr(exr.bytes);
    holds(read.width === size[0] && read.height === size[1] && read.compression === 3, `${read.width} ${read.height}`);
    // Of the first line: A, B, G, R of half floats.
    const halves = Array.from({ length: 4 * read.width }, (_, i) => numberOf(read.data[0].readUInt16LE(2 * i)));
    const light = await page.evaluate(async ([width, height]) => {
        const { session } = window.demo;
        const { settings } = session;
        const wanted = { ...settings, quality: { samples_per_pixel: 4 } };
        return [...(await session.meanwhile(wanted, (hole) => hole.light(width, height))).slice(0, 4 * width)];
    }, size);
    for (let x = 0; x < read.width; x++) {
        for (const [channel, place] of [[3, 0], [2, 1], [1, 2], [0, 3]]) {
            const [one, other] = [halves[place * read.width + x], light[4 * x + channel]];
            holds(Math.abs(one - other) <= Math.abs(other) / 2000 + 6e-8, `pixel ${x}: ${one} is not ${other}`);
        }
    }
    if (process.env.PYTHON) {
        const program = "import sys, OpenEXR, numpy as n\nf = OpenEXR.File(sys.argv[1])\n"
            + "c = f.channels()['RGBA'].pixels\nprint(c.shape[1], c.shape[0], float(n.mean(c[..., 0])))";
        const [width, height, mean] = execFileSync(process.env.PYTHON, ["-c", program, exr.path]).toString().split(" ");
        const isSame = Number(width) === size[0] && Number(height) === size[1];
        holds(isSame && Number(mean) > 0, `${width} ${height} ${mean}`);
    }
});

await test("a scene file that is saved opens again", async () => {
    await page.evaluate(() => window.demo.session.change({ hole: { spin: 0.25 } }));
    const { path, bytes } = await download(page, "Save scene");
    holds(/spin = 0\.25/.test(bytes.toString()), "the file says another spin");
    await page.evaluate(() => window.demo.session.replace((hole) => hole.reset()));
    await page.getByLabel("A scene file").setInputFiles(path);
    await page.getByText("scene.toml was opened").waitFor();
    // Zeros lose their signs.
    const [one, two] = [await page.evaluate(() => window.demo.session.text), bytes.toString()].map((text) =>
        text.replaceAll("-0.0,", "0.0,"));
    holds(one === two, "another scene was opened");
    await page.getByLabel("A scene file").setInputFiles({ name: "bad.toml", mimeType: "text/plain",
        buffer: Buffer.from("hole.spin = 9\n") });
    await page.getByText(/spin is 9; it must lie in/).waitFor();
});

await test("a sky and a LUT of one's own are in the picture, and go again", async () => {
    await page.evaluate(() => window.demo.session.replace((hole) => hole.reset().set({ disk: false })));
    /** Until one channel of a small frame is bright, and another is not. */
    const has = (places) => page.waitForFunction(async ([most, least]) => {
        const { session } = window.demo;
        const { data } = await session.meanwhile(session.settings, (hole) => hole.image(48, 30));
        const mean = [0, 1, 2].map((i) => data.reduce((all, one, at) => all + (at % 4 === i ? one : 0), 0) / 1440);
        return mean[most] > 60 && mean[least] < mean[most] / 4;
    }, places);
    // All of the sky is red.
    const red = await page.evaluate(async () => {
        const canvas = new OffscreenCanvas(64, 32);
        const context = canvas.getContext("2d");
        context.fillStyle = "#f00000";
        context.fillRect(0, 0, 64, 32);
        return [...new Uint8Array(await (await canvas.convertToBlob()).arrayBuffer())];
    });
    const file = { name: "red.png", mimeType: "image/png", buffer: Buffer.from(red) };
    await page.getByLabel("A sky map").setInputFiles(file);
    await page.getByText("red.png is the sky now").waitFor();
    await has([0, 2]);
    // Red and blue change places.
    const nodes = [0, 1].flatMap((b) => [0, 1].flatMap((g) => [0, 1].map((r) => `${b} ${g} ${r}`)));
    const cube = { name: "swap.cube", mimeType: "text/plain",
        buffer: Buffer.from(["LUT_3D_SIZE 2", ...nodes, ""].join("\n")) };
    await page.getByLabel("A LUT").setInputFiles(cube);
    await page.getByText("swap.cube colours the picture now").waitFor();
    await has([2, 0]);
    await page.getByRole("button", { name: "Remove both" }).click();
    await page.waitForFunction(() => window.demo.session.settings.sky?.flags === undefined);
});

await test("a fall goes on by the camera's clock, and the scrubber goes to its end", async () => {
    await page.evaluate(() => window.demo.session.replace((hole) => hole.reset().set(
        { hole: { spin: 0.9 }, camera: { orbit: { distance: 10, elevation: 0.3 }, fov_y: 1.4 } })));
    await page.getByRole("button", { name: "Settings (P)" }).click();
    await page.waitForFunction(() => document.querySelector(".facts").textContent.includes("Horizon1.436 M"));
    await page.getByRole("button", { name: "Fall", exact: true }).click();
    await page.waitForFunction(() => window.demo.session.settings.camera.proper_time > 0.2);
    holds((await scene(page)).film.auto_exposure === 0.7, "the light meter is off");
    await page.keyboard.press("Escape");
    await page.getByRole("button", { name: "Pause time" }).click();
    await page.getByLabel("Time", { exact: true }).focus();
    await page.keyboard.press("End");
    await page.locator("#caption", { hasText: "inside the horizon" }).waitFor();
    const { proper_time, chart } = (await scene(page)).camera;
    // docs/falls.md: 14.36 M down to the inner horizon from here.
    holds(Math.abs(proper_time - 14.35) < 0.02 && chart === "rain", `${proper_time}, ${chart}`);
    const before = await frames(page);
    await shown(page, before + 1);
    await shot(page, "fall");
    await page.getByRole("button", { name: "Hold" }).click();
    const after = await scene(page);
    holds(after.camera.motion === undefined && !after.film?.auto_exposure, "the camera goes on, or the meter");
    await page.getByRole("button", { name: "Orbit" }).click();
    await page.getByText("circles lie in the plane").waitFor();
    await page.waitForFunction(() => window.demo.session.settings.camera.proper_time > 0.1);
    await page.getByRole("button", { name: "Pause time" }).click();
    // A journey's card begins it.
    await page.getByRole("button", { name: "Scenes", exact: true }).click();
    await page.getByRole("button", { name: /^A fall/ }).click();
    await page.waitForFunction(() => {
        const { motion, proper_time } = window.demo.session.settings.camera;
        return motion === "free_fall" && proper_time > 0.1 && proper_time < 12;
    });
    await page.getByRole("button", { name: "Pause time" }).click();
    await page.keyboard.press("Escape");
    await page.getByRole("button", { name: "Hold" }).click();
});

await test("a lost device comes back, with the scene that was", async () => {
    await page.evaluate(() => window.demo.session.replace((hole) => hole.reset().set({ hole: { spin: 0.4 } })));
    const before = await page.evaluate(async () => {
        const { session } = window.demo;
        window.lostHole = session.hole;
        // The device is lent to a frame that is under way.
        while (!(() => {
            try {
                session.loseDevice();
                return true;
            } catch {
                return false;
            }
        })()) {
            await new Promise((done) => setTimeout(done, 5));
        }
        return session.link;
    });
    await page.getByText("The graphics device was lost").waitFor();
    await page.waitForFunction(() => window.demo.session.hole !== window.lostHole);
    await shown(page, (await frames(page)) + 1);
    holds((await page.evaluate(() => window.demo.session.link)) === before, "another scene");
    const picture = await page.locator("canvas").screenshot();
    holds(picture.length > 5000, "the picture is empty");
});

await test("help opens by a key, and closes", async () => {
    await page.locator("#stage").focus();
    await page.keyboard.press("h");
    await page.getByText("How it is computed").waitFor();
    await shot(page, "help");
    await page.keyboard.press("Escape");
    holds(await page.locator("#help").isHidden(), "it stays");
});

await test("on a phone a sheet comes up below the picture, and two fingers move the camera", async () => {
    const phone = await demo({ ...PHONE, reducedMotion: "reduce" });
    await shown(phone);
    await shot(phone, "phone");
    const wide = await phone.evaluate(() => document.documentElement.scrollWidth);
    holds(wide === 390, `the page is ${wide} pixels wide`);
    const { distance } = await phone.evaluate(() => window.demo.session.settings.camera?.orbit ?? { distance: 26.12 });
    const client = await phone.context().newCDPSession(phone);
    const touch = (type, ...points) => client.send("Input.dispatchTouchEvent", { type,
        touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    await touch("touchStart", [150, 400], [240, 400]);
    await touch("touchMove", [120, 400], [270, 400]);
    await touch("touchMove", [90, 400], [300, 400]);
    await touch("touchEnd");
    await phone.waitForFunction((before) => window.demo.session.settings.camera?.orbit?.distance < 0.7 * before,
        distance);
    await phone.getByRole("button", { name: "Scenes", exact: true }).tap();
    await phone.getByRole("tab", { name: "Settings" }).tap();
    const [sheet, stage] = [await phone.locator("#panel").boundingBox(), await phone.locator("#stage").boundingBox()];
    holds(sheet.y + 1 >= stage.height && stage.height > 300 && sheet.width === 390, JSON.stringify([sheet, stage]));
    await shot(phone, "phone-sheet");
    await phone.locator("#handle").tap();
    await phone.waitForFunction((y) => document.getElementById("panel").getBoundingClientRect().y < y - 50, sheet.y);
    await shot(phone, "phone-sheet-high");
    // Every target is large enough for a finger, at least in one of its directions.
    const small = await phone.locator("button:visible, select:visible, input[type=range]:visible").evaluateAll((all) =>
        all.map((node) => [node.getAttribute("aria-label") ?? node.textContent, node.getBoundingClientRect()])
            .filter(([, { width, height }]) => Math.max(width, height) < 44 || Math.min(width, height) < 28)
            .map(([name, { width, height }]) => `${name}: ${width} x ${height}`));
    holds(small.length === 0, small.join("\n"));
    // A drag far down closes it.
    const box = await phone.locator("#handle").boundingBox();
    await touch("touchStart", [195, box.y + 14]);
    await touch("touchMove", [195, 600]);
    await touch("touchMove", [195, 800]);
    await touch("touchEnd");
    await phone.locator("#panel").waitFor({ state: "hidden" });
    // Reduced motion was asked for: nothing moves by itself.
    const moves = await phone.evaluate(() => [window.demo.session.settings.time, document.getAnimations().length]);
    holds(moves[0] === undefined && moves[1] === 0, JSON.stringify(moves));
});

await test("without WebGPU the processor makes small pictures, and the page says so", async () => {
    const slow = await browser.newPage({ viewport: { width: 400, height: 300 } });
    await slow.addInitScript(() => Object.defineProperty(navigator, "gpu", { value: undefined }));
    await slow.goto(address.replace("6000", "2000"));
    await slow.getByText("gives the page no WebGPU").waitFor();
    await shown(slow);
    const picture = await slow.locator("canvas").screenshot();
    holds(picture.length > 3000, "the picture is empty");
    await slow.close();
});

await test("nothing was said in the consoles, and no rejection was left alone", async () => {
    const said = pages.flatMap((one) => one.said);
    holds(said.length === 0, said.join("\n"));
});

await finished(browser, server);
