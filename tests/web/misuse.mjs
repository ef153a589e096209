// SPDX-License-Identifier: MIT OR Apache-2.0
// misuse.mjs -- the npm package used as careless and hostile pages use it: calls after the end, at once and in any
// order, arguments of wrong kinds, two tracers on one canvas, elements that come and go.
//
//     node misuse.mjs PACKAGE
//
// PACKAGE: the folder that packaging/npm --tree makes. Prints a line for each test, and "N passed, M failed".
// Environment: that of browser.mjs.

import { difference, finished, holds, isSame, bytesOf, launched, opened, served, test } from "./browser.mjs";

const server = await served({ bhr: process.argv[2] });
const browser = await launched();
const { page, said } = await opened(browser, `${server.address}/page.html`);
await page.waitForFunction(() => window.ready === true);
await page.evaluate(() => {
    // What becomes of work: its error's kind, code and message, or "done"; "never" if nothing does.
    window.outcome = async (work) => {
        const late = new Promise((done) => setTimeout(() => done("never"), 60000));
        const end = async () => work();
        const told = (error) => `${error.constructor.name} ${error.code ?? ""}: ${error.message}`;
        return Promise.race([late, end().then(() => "done", told)]);
    };
});

/** Whether each outcome is as its pattern says. */
function all(found, expected) {
    holds(found.length === expected.length, `${found.length} outcomes of ${expected.length}`);
    found.forEach((one, i) => holds(expected[i].test(one), `${i}: ${one} is not ${expected[i]}`));
}

await test("calls after the end are refused, whatever traces", async () => {
    const found = await page.evaluate(async () => {
        const all = [];
        for (const options of [{ backend: "cpu" }, { backend: "webgpu" }, { backend: "cpu", shared: true }]) {
            const one = await bhr.BlackHole.create(null, options);
            await one.destroy();
            for (const work of [() => one.image(4, 4), () => one.setFilmLut(undefined), () => one.loseDevice(),
                () => one.setSkyMap(new ImageData(2, 1))]) {
                all.push(await outcome(work));
            }
            all.push(await outcome(() => one.destroy()));
        }
        return all;
    });
    found.forEach((one, i) => {
        const expected = i % 5 === 4 ? /^done$/ : /^Error INVALID_STATE: the black hole was destroyed$/;
        holds(expected.test(one), `${i}: ${one}`);
    });
});

await test("a device that is lost in the middle of a frame ends it, and calls after it", async () => {
    const found = await page.evaluate(async () => {
        const all = [];
        for (const backend of ["cpu", "webgpu"]) {
            const one = await bhr.BlackHole.create(null, { backend });
            const under = outcome(() => one.image(64, 36));
            await new Promise((done) => setTimeout(done, 20));
            one.loseDevice();
            all.push(await under, (await one.lost).code, await outcome(() => one.image(4, 4)));
        }
        return all;
    });
    const lost = /^Error DEVICE_LOST: /;
    all(found, [lost, /^DEVICE_LOST$/, lost, lost, /^DEVICE_LOST$/, lost]);
});

await test("what is no text, no picture and no signal is told, and harms nothing", async () => {
    const found = await page.evaluate(async () => {
        const one = await bhr.BlackHole.create(null, { backend: "cpu" });
        const forged = { get aborted() { throw new Error("no"); } };
        const works = [() => one.read({}), () => one.read(Promise.resolve("")), () => one.load(5),
            () => one.read("", NaN), () => one.setFilmLut(new ArrayBuffer(8)), () => one.setSkyMap(new Image()),
            () => one.image(4, 4, { signal: 5 }), () => one.image(4, 4, { signal: forged }), () => one.render(null),
            () => one.set({ hole: new Map([["spin", 1]]) }), () => one.set(JSON.parse('{"__proto__": {"time": 5}}')),
            () => one.set({ hole: new Date() }), () => one.load("v=1&volumes=5"),
            () => one.load("v=1&volumes.0x0.seed=1"), () => one.ray({}, "x", 4, 4), () => one.image(4, 4, null)];
        const all = [];
        for (const work of works) {
            all.push(await outcome(work));
        }
        one.set({ camera: { position: new Float64Array([9, 9, 9]) } });
        all.push(JSON.stringify(one.scene), one.link());
        const seed = one.load("v=1&disk.seed=12345678901234567890&hole.mass=9007199254740993&time=5").scene;
        all.push(`${typeof seed.disk.seed} ${typeof seed.hole.mass}`);
        await one.destroy();
        return all;
    });
    const text = /^TypeError : .* is text; this is a /;
    const signal = /^TypeError : signal is no AbortSignal$/;
    all(found, [text, text, text, /^RangeError : seconds is NaN/, text, /^TypeError : a sky map is an ImageData/,
        signal, signal, /^TypeError : there is no canvas/,
        /^TypeError : hole is a Map; /, /^TypeError : "__proto__" is no name/, /^TypeError : hole is a Date; /,
        /^RangeError : volumes is a list/, /^RangeError : .*comes before/, /INVALID_ARGUMENT/, /^done$/,
        /^\{"camera":\{"position":\[9,9,9\]\}\}$/, /^v=1&camera.position=9,9,9$/, /^bigint number$/]);
});

await test("two tracers take turns on one canvas; too large sizes and aborted signals are told", async () => {
    const found = await page.evaluate(async () => {
        const place = document.createElement("canvas");
        const [one, other] = [await bhr.BlackHole.create(place, { backend: "webgpu" }),
            await bhr.BlackHole.create(place, { backend: "webgpu" })];
        other.set({ hole: { spin: 0.5 } });
        const size = { width: 32, height: 18 };
        const all = [];
        for (const hole of [one, other, one, other]) {
            all.push(await outcome(() => hole.render(size)));
        }
        const shown = new OffscreenCanvas(32, 18).getContext("2d");
        shown.drawImage(place, 0, 0);
        const [drawn, made] = [shown.getImageData(0, 0, 32, 18), await other.image(32, 18)];
        all.push(await outcome(() => one.render({ width: 1 << 20, height: 1 })),
            await outcome(() => one.render({ ...size, signal: AbortSignal.abort() })),
            await outcome(() => one.render(size)));
        await Promise.all([one.destroy(), other.destroy()]);
        return { all, drawn: base64(drawn.data), made: base64(made.data) };
    });
    const done = /^done$/;
    all(found.all, [done, done, done, done, /INVALID_ARGUMENT: width is 1048576; /, /CANCELLED/, done]);
    isSame(difference(bytesOf(found.drawn), bytesOf(found.made)));
});

await test("an element that is removed and put back while its hole is made keeps its attributes", async () => {
    const found = await page.evaluate(async () => {
        await import("./bhr/element.js");
        const scenes = [];
        const later = (work) => new Promise((done) => setTimeout(() => done(work()), 1));
        const changes = [(one) => (one.remove(), later(() => document.body.append(one))),
            (one) => one.setAttribute("backend", "cpu"), () => undefined];
        for (const change of changes) {
            const one = document.createElement("bhr-hole");
            one.style.cssText = "display: block; width: 32px; height: 18px";
            const attributes = { backend: "cpu", spin: "0.5", disk: "false", constructor: "1" };
            Object.entries(attributes).forEach(([name, value]) => one.setAttribute(name, value));
            document.body.append(one);
            while (one.shadowRoot.querySelector("canvas") === null) {
                await new Promise((done) => setTimeout(done, 1));
            }
            await change(one);
            await new Promise((done, failed) => {
                one.addEventListener("render", done, { once: true });
                one.addEventListener("error", ({ message }) => failed(new Error(message)), { once: true });
            });
            const { hole, disk } = one.hole.scene;
            const label = one.shadowRoot.querySelector("[aria-label]").getAttribute("aria-label");
            scenes.push(`${JSON.stringify({ hole, disk })} ${label}`);
            one.remove();
        }
        return scenes;
    });
    const expected = /^\{"hole":\{"spin":0.5\},"disk":false\} A black hole of spin 0.5, with no matter around it, /;
    all(found, [expected, expected, expected]);
});

await test("a page for frames with odd names in its address shows its hole all the same", async () => {
    const query = "hole.%20x=1&constructor=1&__proto__=2&onclick=3&backend=cpu&spin=0.25";
    const { page: other, said: wrong } = await opened(browser, `${server.address}/bhr/embed.html?${query}`);
    const spin = () => document.querySelector("bhr-hole")?.hole?.scene.hole?.spin;
    await other.waitForFunction(`(${spin})() === 0.25`);
    const names = await other.evaluate(() => document.querySelector("bhr-hole").getAttributeNames().join());
    holds(names === "backend,spin", names);
    holds(wrong.length === 0, wrong.join("\n"));
    await other.close();
});

await test("nothing was said in the console", async () => holds(said.length === 0, said.join("\n")));

await finished(browser, server);
