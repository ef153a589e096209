// SPDX-License-Identifier: MIT OR Apache-2.0
// drive.mjs -- the npm package in headless Chromium, on its software driver SwiftShader, which runs native bhr as well.
//
//     node drive.mjs PACKAGE BHR SCRATCH
//
// PACKAGE: the folder that packaging/npm --tree makes; BHR: the program; SCRATCH: a folder for pictures. Prints a line
// for each test, and "N passed, M failed". Environment: that of browser.mjs; SWIFTSHADER, the manifest of the driver;
// BHR_TESTS_ALL, 1 for every scene.

import { execFile } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { promisify } from "node:util";
import { bytesOf, difference, finished, here, holds, isSame, launched, opened as openedAt, served, test }
    from "./browser.mjs";

const [pack, program, scratch] = process.argv.slice(2);
const json = JSON.parse(readFileSync(join(here, "../../include/bhr.json"), "utf8"));
const server = await served({ bhr: pack, scratch });
const browser = await launched();

/** A new page with the package, and what its console said that nobody expected. */
async function opened() {
    const { page, said } = await openedAt(browser, `${server.address}/page.html`);
    await page.waitForFunction(() => window.ready === true);
    return { page, said };
}

const run = promisify(execFile);
/** Renders the frame of a scene's text by the program. */
async function rendered(name, text, [width, height], backend, tile) {
    const [scene, picture] = [join(scratch, `${name}.toml`), join(scratch, `${name}.png`)];
    writeFileSync(scene, text);
    const manifest = process.env.SWIFTSHADER;
    const environment = { ...process.env, VK_DRIVER_FILES: manifest, VK_ICD_FILENAMES: manifest };
    const [fullWidth, fullHeight, ...place] = tile ?? [width, height];
    const part = tile === undefined ? [] : ["--tile", [...place, width, height].join(",")];
    const options = ["render", scene, "--size", `${fullWidth}x${fullHeight}`, ...part, "--backend", backend,
        "--progress", "none", "--again", "--out", picture];
    await run(program, options, { env: environment });
}

/** The pixels of that. */
async function pixelsOf(name) {
    return bytesOf(await page.evaluate(async (url) => base64((await decoded(url)).data), `/scratch/${name}.png`));
}

const SIZE = [160, 90];
const SCENES = {
    "default disk": { settings: {} },
    // Rays of large frames are looked up, and so are those of a part.
    "spin by tables": { settings: { hole: { spin: 0.9 } }, size: [192, 108], tile: [1920, 1080, 864, 160] },
    "rays by RK4": { settings: { quality: { method: "rk4" } } },
    "four samples": { settings: { quality: { samples_per_pixel: 4 } } },
    "volume with structure": {
        settings: {
            hole: { spin: 0.6 },
            disk: false,
            volumes: [{ shape: "disk" }],
            camera: { orbit: { distance: 28, elevation: 0.15 } },
        },
        size: [64, 36],
    },
    "hot spot": { settings: { hot_spots: [{ radius: 8 }] }, size: [96, 54] },
    equirect: { settings: { camera: { projection: "equirect" } }, size: [192, 96] },
    "inside the horizon": {
        settings: { camera: { position: [0, 1.2, 0.4], motion: "free_fall", fov_y: 1.6 }, disk: { inner_radius: 4 } },
    },
};

// Everyday the browser checks all kernels, but renders only some scenes, as SwiftShader is slow; tests of the library
// render the others on lavapipe. BHR_TESTS_ALL=1: all of them.
for (const name of process.env.BHR_TESTS_ALL === "1" ? [] : ["rays by RK4", "hot spot", "equirect"]) {
    delete SCENES[name];
}

const { page, said } = await opened();

// The program makes its frames beside the page, one after the other.
const natives = new Map();
let before = Promise.resolve();
for (const [name, { settings, size = SIZE, tile }] of Object.entries(SCENES)) {
    const text = await page.evaluate((settings) => wasm.wholeScene(settingsModule.textOf(settings), 0), settings);
    before = before.catch(() => undefined).then(() => rendered(name, text, size, "vulkan", tile));
    before.catch(() => undefined);
    natives.set(name, before);
}

await test("every kernel compiles in the browser without a message", async () => {
    const found = await page.evaluate(async () => {
        const adapter = await navigator.gpu.requestAdapter();
        const { maxStorageBuffersPerShaderStage, maxStorageTexturesPerShaderStage } = adapter.limits;
        const device = await adapter.requestDevice({
            requiredLimits: { maxStorageBuffersPerShaderStage, maxStorageTexturesPerShaderStage },
        });
        const list = wasm.kernels();
        const bad = [];
        for (let i = 0; i < list.length; i += 2) {
            device.pushErrorScope("validation");
            const shader = device.createShaderModule({ code: list[i + 1] });
            const { messages } = await shader.getCompilationInfo();
            const error = await device.popErrorScope();
            for (const { lineNum, message } of messages) {
                bad.push(`${list[i]}: ${message} | ${list[i + 1].split("\n")[lineNum - 1] ?? ""}`);
            }
            if (error !== null && messages.length === 0) {
                bad.push(`${list[i]}: ${error.message}`);
            }
        }
        device.destroy();
        return { count: list.length / 2, bad };
    });
    holds(found.count > 30, `only ${found.count} kernels`);
    holds(found.bad.length === 0, found.bad.join("\n"));
});

for (const [name, { settings, size = SIZE, tile }] of Object.entries(SCENES)) {
    await test(`${name} is that of native bhr`, async () => {
        const made = await page.evaluate(async ([settings, [width, height], tile]) => {
            window.hole ??= await bhr.BlackHole.create(null, { backend: "webgpu" });
            hole.reset().set(settings);
            if (tile !== null) {
                const [full_width, full_height, x, y] = tile;
                hole.set({ region: { full_width, full_height, x, y } });
            }
            const { data } = await hole.image(width, height);
            return { pixels: base64(data), stats: hole.stats };
        }, [settings, size, tile ?? null]);
        holds(made.stats.rays >= size[0] * size[1], `only ${made.stats.rays} rays`);
        holds(tile === undefined || made.stats.lens_tables > 0, "no table was made");
        await natives.get(name);
        const own = bytesOf(made.pixels);
        holds(new Set(own).size > 20, "the frame shows nothing");
        const found = difference(own, await pixelsOf(name));
        isSame(found);
    });
}

await test("the CPU tracer's frame, of a worker, is the native one", async () => {
    const made = await page.evaluate(async () => {
        const cpu = await bhr.BlackHole.create(null, { backend: "cpu" });
        const { data } = await cpu.set({ hole: { spin: 0.5 } }).image(64, 36);
        const light = await cpu.light(8, 4);
        const found = { pixels: base64(data), text: cpu.text(), adapter: cpu.adapter, light: light.length };
        await cpu.destroy();
        return found;
    });
    holds(made.adapter.backend === "cpu" && made.light === 128, JSON.stringify(made.adapter));
    await rendered("cpu", made.text, [64, 36], "cpu");
    const found = difference(bytesOf(made.pixels), await pixelsOf("cpu"));
    isSame(found);
});

await test("a canvas shows the image's pixels", async () => {
    const image = await page.evaluate(async () => {
        window.shown = await bhr.BlackHole.create(canvas);
        shown.set({ hole: { spin: 0.4 } });
        // Later calls share one more frame.
        const all = [shown.render(), shown.render(), shown.render()];
        await Promise.all(all);
        if (shown.stats.frame_index > 2) {
            throw new Error(`${shown.stats.frame_index} frames were made`);
        }
        const { data } = await shown.image(canvas.width, canvas.height);
        await shown.render();
        return base64(data);
    });
    const picture = await page.locator("#picture").screenshot({ path: join(scratch, "canvas.png") });
    holds(picture.length > 0, "no screenshot");
    const seen = bytesOf(await page.evaluate(async () => base64((await decoded("/scratch/canvas.png")).data)));
    const found = difference(seen, bytesOf(image));
    holds(found.over === 0, `${found.over} of ${found.pixels} pixels differ, by up to ${found.most}`);
});

await test("a canvas takes the size and the signal of a frame, and keeps its picture until the next one", async () => {
    const found = await page.evaluate(async () => {
        const place = document.createElement("canvas");
        [place.width, place.height] = [40, 30];
        const one = await bhr.BlackHole.create(place);
        one.set({ hole: { spin: 0.4 } });
        // The first frame comes before its edges are refined, and then again.
        await one.render({ width: 64, height: 36 });
        const sizes = [[place.width, place.height]];
        await one.render();
        sizes.push([place.width, place.height]);
        const code = async (work) => work().then(() => "done", (error) => error.code ?? error.message);
        const many = { quality: { samples_per_pixel: 256 } };
        const stop = new AbortController();
        const long = code(() => one.set(many).render({ width: 96, height: 54, signal: stop.signal }));
        const cut = code(() => one.image(96, 54, { signal: stop.signal }));
        setTimeout(() => stop.abort(), 50);
        const codes = [await long, await cut];
        sizes.push([place.width, place.height]);
        // In steps, and at once: one picture.
        one.set({ quality: { samples_per_pixel: 9 } });
        await one.render({ width: 96, height: 54 });
        const shown = new OffscreenCanvas(96, 54).getContext("2d");
        shown.drawImage(place, 0, 0);
        const [drawn, made] = [shown.getImageData(0, 0, 96, 54), await one.image(96, 54)];
        codes.push(await code(() => one.render({ width: 0.5 })), await code(() => one.light(-1, 4)));
        const cpu = await bhr.BlackHole.create(null, { backend: "cpu" });
        const late = new AbortController();
        const slow = code(() => cpu.image(96, 54, { signal: late.signal }));
        late.abort();
        codes.push(await slow);
        await Promise.all([cpu.destroy(), one.destroy()]);
        return { sizes, codes, drawn: base64(drawn.data), made: base64(made.data) };
    });
    const { sizes, codes } = found;
    holds(JSON.stringify(sizes) === "[[64,36],[64,36],[64,36]]", JSON.stringify(sizes));
    holds(codes[0] === "CANCELLED" && codes[1] === "CANCELLED" && codes[4] === "CANCELLED", JSON.stringify(codes));
    holds(/^width is 0\.5; /.test(codes[2]) && /^width is -1; /.test(codes[3]), JSON.stringify(codes));
    isSame(difference(bytesOf(found.drawn), bytesOf(found.made)));
});

await test("a first frame leaves the page its thread, and is shown before its edges are refined", async () => {
    const { page: other, said } = await opened();
    const found = await other.evaluate(async () => {
        const one = await bhr.BlackHole.create(canvas);
        const tasks = [];
        const watch = new PerformanceObserver((list) => {
            tasks.push(...list.getEntries().map((entry) => Math.round(entry.duration)));
        });
        watch.observe({ entryTypes: ["longtask"] });
        const make = GPUDevice.prototype.createComputePipeline;
        const order = [];
        GPUDevice.prototype.createComputePipeline = function (descriptor) {
            order.push(descriptor.compute.entryPoint);
            return make.call(this, descriptor);
        };
        const submit = GPUQueue.prototype.submit;
        GPUQueue.prototype.submit = function (commands) {
            order.push("submit");
            return submit.call(this, commands);
        };
        await one.render();
        const first = one.stats.frame_index;
        await one.render();
        const second = one.stats.frame_index;
        // A frame for which everything is there gives the page's thread away only while the GPU works.
        const timer = window.setTimeout;
        const waits = [];
        for (let i = 0; i < 4; i++) {
            let count = 0;
            window.setTimeout = (...given) => (count++, timer(...given));
            await one.render();
            waits.push(count);
        }
        window.setTimeout = timer;
        await new Promise((done) => setTimeout(done, 100));
        await one.destroy();
        return { order, frames: second - first, tasks, waits };
    });
    await other.close();
    const [shown, refined] = [found.order.indexOf("submit"), found.order.indexOf("refine")];
    holds(shown > 0 && refined > shown && found.order.indexOf("submit", refined) > 0, found.order.join(" "));
    holds(found.frames === 1, `${found.frames} frames for one call`);
    // On a busy machine what is there may seem to take long now and then.
    holds(Math.min(...found.waits) === 0, `a frame waits for ${found.waits.join(", ")} timers`);
    // 0.15 s on an idle machine. Tests run beside others, which may stop a task for longer: then it must be no large
    // part of the whole. All of it in one task took 1.6 s.
    const [longest, whole] = [Math.max(0, ...found.tasks), found.tasks.reduce((sum, task) => sum + task, 0)];
    holds(longest < 600 || longest < 0.4 * whole, `the page stood still for ${found.tasks.join(", ")} ms`);
    holds(said.length === 0, said.join("\n"));
});

await test("a sky map and a LUT show what native bhr shows of them", async () => {
    const cube = "LUT_3D_SIZE 2\n" + [0, 1, 2, 3, 4, 5, 6, 7].map((i) => {
        const [red, green, blue] = [i & 1, i >> 1 & 1, i >> 2];
        return `${0.2 + 0.6 * green} ${red} ${0.9 * blue}`;
    }).join("\n") + "\n";
    const settings = { sky: { flags: ["map"] }, disk: { outer_radius: 12 }, film: { bloom: 0.1 } };
    const made = await page.evaluate(async ([cube, settings]) => {
        const place = new OffscreenCanvas(96, 48);
        const context = place.getContext("2d");
        const picture = context.createImageData(96, 48);
        picture.data.forEach((_, i, all) => {
            const [x, y, channel] = [(i >> 2) % 96, Math.floor(i / 384), i & 3];
            all[i] = channel === 3 ? 255 : (x * [5, 2, 7][channel] + y * [3, 9, 1][channel]) % 256;
        });
        context.putImageData(picture, 0, 0);
        const blob = await place.convertToBlob({ type: "image/png" });
        const found = { map: base64(new Uint8Array(await blob.arrayBuffer())), text: "", frames: [], wrong: [] };
        for (const backend of ["webgpu", "cpu"]) {
            const one = await bhr.BlackHole.create(null, { backend });
            one.set(settings);
            await one.setSkyMap(backend === "cpu" ? await createImageBitmap(blob) : picture);
            await one.setFilmLut(cube);
            found.text = one.text();
            found.frames.push(base64((await one.image(64, 36)).data));
            found.wrong.push(await one.setFilmLut("LUT_3D_SIZE 1\n").then(() => "taken", (error) => error.message));
            await one.setSkyMap(undefined);
            await one.setFilmLut(undefined);
            found.frames.push(base64((await one.image(64, 36)).data));
            await one.destroy();
        }
        return found;
    }, [cube, settings]);
    writeFileSync(join(scratch, "map.png"), bytesOf(made.map));
    writeFileSync(join(scratch, "look.cube"), cube);
    const text = made.text.replace("[sky]\n", '[sky]\nmap = "map.png"\n')
        .replace("[film]\n", '[film]\nlut = "look.cube"\n');
    for (const [i, backend] of ["vulkan", "cpu"].entries()) {
        await rendered(`map ${backend}`, text, [64, 36], backend);
        isSame(difference(bytesOf(made.frames[2 * i]), await pixelsOf(`map ${backend}`)));
        const without = difference(bytesOf(made.frames[2 * i]), bytesOf(made.frames[2 * i + 1]));
        holds(without.over > without.pixels / 2, "the map and the LUT show nothing");
        holds(/^line 1: LUT_3D_SIZE is "1"; /.test(made.wrong[i]), made.wrong[i]);
    }
});

await test("a ray and the hole's numbers are those of bhr.h", async () => {
    const found = await page.evaluate(() => {
        hole.reset();
        const [middle, beside] = [hole.ray(80, 45, 160, 90), hole.ray(1, 1, 160, 90)];
        const { path, ...plain } = middle;
        const info = hole.info();
        const far = hole.set({ hole: { spin: 0.5 } }).info();
        let message;
        try {
            hole.ray(NaN, 1, 160, 90);
        } catch (error) {
            message = error.message;
        }
        const names = [info, plain].map((one) => Object.keys(one));
        const ends = [...path.slice(0, 4), ...path.slice(-4)];
        const points = path.length / 4;
        return { plain, path: ends, beside: { ...beside, path: [] }, info, far, names, message, points };
    });
    const fields = (name) => json.structs.find((one) => one.name === name).fields.map((field) => field.name)
        .filter((name) => !/^(struct_size|reserved\d*|crossing_count)$/.test(name)).sort().join();
    const [info, ray] = found.names.map((names) => names.sort().join());
    holds(info === fields("BhrHoleInfo"), info);
    const expected = [...fields("BhrRay").split(","), ...fields("BhrHit").split(",")].sort().join();
    holds(ray === expected, ray);
    holds(found.plain.fate === "captured" && found.beside.fate === "escaped", JSON.stringify(found.plain));
    // At spin 0 the photon orbit is at 3 M, the ISCO at 6, and the shadow sqrt(27) M wide (Bardeen 1973).
    const { photon_orbit_prograde: photons, isco_prograde: isco, critical_impact_parameter: critical } = found.info;
    holds(photons === 3 && isco === 6 && Math.abs(critical - Math.sqrt(27)) < 1e-12, JSON.stringify(found.info));
    holds(Math.abs(found.far.isco_prograde - 4.233002530) < 1e-8, `ISCO ${found.far.isco_prograde}`);
    // From the observer to just outside the horizon.
    const [x, y, z, t, ...last] = found.path;
    holds(Math.hypot(x, y - 26, z - 2.5) < 1e-12 && t === 0, found.path.join());
    const radius = Math.hypot(...last.slice(0, 3));
    holds(found.points > 10 && radius > 1.99 && radius < 2.2 && last[3] < 0, `${found.points} points: ${found.path}`);
    holds(Math.abs(Math.hypot(...found.beside.sky_direction) - 1) < 1e-12, JSON.stringify(found.beside));
    holds(/must be finite|must lie within/.test(found.message), found.message);
});

await test("a scene file is read, in place of what was set", async () => {
    const found = await page.evaluate(() => {
        const scene = { hole: { spin: -0.3, axis: [0, 1, 0] }, preset: "physical", camera: { position: [9, 9, 9] },
            volumes: [{ seed: 5n ** 27n }, { shape: "torus" }], hot_spots: [{}], effects: ["beaming"] };
        const text = hole.reset().set(scene).text();
        const same = hole.reset().set({ time: 5, film: { bloom: 0.1 } }).read(text).text() === text;
        const linked = hole.load(hole.link()).text() === text;
        const file = 'preset = "teaching"\n[hole]\nspin = 0.25\n[disk]\nouter_radius = 9\n';
        const moves = hole.read("[camera]\nfov_y = { keys = [[0, 0.5], [2, 1.5]] }\n", 1);
        const halfway = moves.scene.camera.fov_y;
        const part = hole.read(file).scene;
        const before = hole.text();
        const wrong = ["[hole]\nspin = 2\n", "[sky]\nmap = \"a.png\"\n", "spin = [", "disk = false\n"].map((text) => {
            try {
                hole.read(text);
                return "";
            } catch (error) {
                return error.message;
            }
        });
        const none = hole.scene.disk;
        return { same, linked, spin: part.hole.spin, outer: part.disk.outer_radius, wrong, none, halfway,
            changed: before === hole.text() };
    });
    holds(found.same && found.linked, "the text is another one");
    holds(found.spin === 0.25 && found.outer === 9 && found.none === false && !found.changed, JSON.stringify(found));
    holds(Math.abs(found.halfway - 1) < 1e-9, `halfway between two keys fov_y is ${found.halfway}`);
    const expected = [/spin is 2; /, /a page has no files/, /./, /^$/];
    found.wrong.forEach((message, i) => holds(expected[i].test(message), message));
});

await test("bad input gives the C API's message, and changes nothing", async () => {
    const found = await page.evaluate(async () => {
        const thrown = async (work) => {
            try {
                await work();
                return { message: "nothing was thrown" };
            } catch (error) {
                return { message: error.message, code: error.code, kind: error.constructor.name };
            }
        };
        hole.reset().set({ hole: { spin: 0.3 } });
        const before = hole.text();
        const all = [
            await thrown(() => hole.set({ hole: { spin: 1.5 } })),
            await thrown(() => hole.set({ film: { bloom: -1 } })),
            await thrown(() => hole.set({ camera: { positron: [0, 1, 2] } })),
            await thrown(() => hole.set({ disk: { outer_radius: "wide" } })),
            await thrown(() => hole.set({ sky: { map: "sky.png" } })),
            await thrown(() => hole.set({ time: null })),
            await thrown(() => hole.image(0, 10)),
            await thrown(() => hole.image(2000000, 1)),
            await thrown(() => hole.load("v=2")),
            await thrown(() => hole.load("#v=1&hole.spin=7")),
            await thrown(() => hole.load("v=1&__proto__.x=7")),
            await thrown(() => hole.load("v=1&volumes.3.shape=torus")),
            await thrown(() => bhr.BlackHole.create(null, { backend: "gl" })),
        ];
        return { all, same: before === hole.text() };
    });
    const expected = [/^\[hole\]: spin is 1\.5; it must lie in \[-1, 1\]$/, /^\[film\]: film bloom is -1; /,
        /positron/, /outer_radius is text; it must be/, /a page has no files/, /time is null/, /width is 0; /,
        /2000000/, /begins with v=1/, /spin is 7; /, /is no name/, /comes before/, /backend is gl; /];
    holds(found.all.length === expected.length, "another number of mistakes");
    found.all.forEach(({ message }, i) => holds(expected[i].test(message), `${message} is not ${expected[i]}`));
    holds(found.all[0].code === "INVALID_ARGUMENT" && found.all[4].code === "UNSUPPORTED", JSON.stringify(found.all));
    holds(found.same, "a mistake changed the scene");
});

/** A value of a field other than its default. */
function another(field) {
    const enumeration = json.enumerations.find(({ name }) => name === field.type);
    if (enumeration !== undefined) {
        return enumeration.constants.at(field.default === 0 ? -1 : 0).toLowerCase();
    }
    if (field.name === "flags") {
        return ["one", "other"];
    }
    const number = (usual, i) => (usual ?? 0) + 1 + (field.type === "double" ? 0.1 * (i + 1) : 0);
    const { array, default: usual } = field;
    return array ? Array.from({ length: array }, (_, i) => number(usual?.[i], i)) : number(usual, 0);
}

await test("every field comes back from a link", async () => {
    const structs = { camera: "BhrCamera", disk: "BhrDisk", sky: "BhrSky", film: "BhrFilm", quality: "BhrQuality",
        volumes: "BhrVolume", hot_spots: "BhrHotSpot", region: "BhrRegion" };
    const all = Object.entries(structs).flatMap(([section, name]) => {
        const { fields } = json.structs.find((one) => one.name === name);
        return fields.filter(({ name }) => !/^(struct_size|reserved\d*)$/.test(name)).map((field) => {
            const one = { [field.name]: another(field) };
            return [section, field.name, /s$/.test(section) ? { [section]: [one] } : { [section]: one }];
        });
    });
    const more = [{ preset: "teaching", film: { bloom: 0 } }, { disk: false }, { volumes: [] },
        { volumes: [{}, { seed: 3 }] },
        { hole: { spin: -0.25, axis: [0, 1, 0] }, time: -1e21, view: "redshift" }, { effects: [] },
        { camera: { position: [5, 5, 5], forward: [0, -26, -2.5] } },
        { camera: { orbit: { distance: 20, azimuth: 1e-7 }, look_at: [1, 2, 3], turn: { up: 0.5 } } },
        { volumes: [{ seed: 5 }, { shape: "torus", tint: [1, 0.5, 0.25] }], hot_spots: [{ radius: 9 }] }];
    const found = await page.evaluate(([all, more]) => {
        const usual = wasm.defaultScene();
        const bad = [];
        const plain = (settings) => JSON.stringify(settings);
        for (const settings of [...all.map((one) => one[2]), ...more]) {
            const address = links.link(settings, usual);
            const after = plain(links.settingsOf(`#${address}`, usual));
            if (after !== plain(settings)) {
                bad.push(`${address}: ${after} is not ${plain(settings)}`);
            }
        }
        for (const [section, name] of all) {
            const known = new RegExp(`^\\[+${section}\\]+\\n(?:[a-z].*\\n)*?${name} = `, "m").test(usual);
            if (!known && section !== "region") {
                bad.push(`the tracer knows no ${section}.${name}`);
            }
        }
        // Through the tracer, and what is as in a new scene is in no link.
        const seed = 12345678901234567890n;
        hole.reset().set({ hole: { spin: 0.75 }, disk: { seed, opacity: 1 }, camera: { up: [0, 0, 1] } });
        const [address, text] = [hole.link(), hole.text()];
        const expected = `v=1&hole.spin=0.75&disk.seed=${seed}`;
        if (address !== expected || hole.reset().load(address).text() !== text) {
            bad.push(address);
        }
        return bad;
    }, [all, more]);
    holds(all.length > 100, `only ${all.length} fields`);
    holds(found.length === 0, found.slice(0, 20).join("\n"));
});

await test("the defaults that links of version 1 mean are as they were", async () => {
    const text = await page.evaluate(() => wasm.defaultScene());
    const fields = text.split("\n").slice(1).join("\n");
    const file = join(here, "defaults-1.txt");
    if (process.env.BHR_UPDATE_LINKS === "1") {
        writeFileSync(file, fields);
    }
    // Fields may be added, in their places: what is not named keeps its meaning.
    const usual = readFileSync(file, "utf8").split("\n");
    let next = 0;
    for (const line of fields.split("\n")) {
        next += line === usual[next] ? 1 : 0;
    }
    holds(next === usual.length, `"${usual[next]}" changed: links of version 1 need that default in web/link.ts`);
});

await test("set lays objects over one another, and undefined takes back", async () => {
    const found = await page.evaluate(() => {
        hole.reset().set({ camera: { fov_y: 1 }, hole: { spin: 0.5 } }).set({ camera: { jitter: [0.1, 0.2] } });
        hole.set({ hole: undefined });
        return [hole.scene, hole.link()];
    });
    const expected = [{ camera: { fov_y: 1, jitter: [0.1, 0.2] } }, "v=1&camera.fov_y=1&camera.jitter=0.1,0.2"];
    holds(JSON.stringify(found) === JSON.stringify(expected), JSON.stringify(found));
});

await test("the page in docs/web.md shows a hole, and turns it where it is dragged", async () => {
    const [, sample] = /```html\n(.*?)```/s.exec(readFileSync(join(here, "../../docs/web.md"), "utf8"));
    // Fewer pixels are enough.
    const small = sample.replace('width="960" height="540"', 'width="96" height="54"').replace("./bhr/", "/bhr/");
    holds(small !== sample, "the sample's canvas has another size");
    writeFileSync(join(scratch, "sample.html"), small);
    const other = await browser.newPage({ viewport: { width: 192, height: 120 } });
    const wrong = [];
    other.on("pageerror", (error) => wrong.push(String(error)));
    await other.goto(`${server.address}/scratch/sample.html`);
    const seen = async () => {
        await other.locator("canvas").screenshot({ path: join(scratch, "sample.png") });
        return bytesOf(await page.evaluate(async () => base64((await decoded("/scratch/sample.png")).data)));
    };
    /** The picture, once it is as it should be. */
    const until = async (is) => {
        for (let last; ;) {
            last = await seen();
            if (is(last) || wrong.length > 0) {
                return last;
            }
            await new Promise((done) => setTimeout(done, 300));
        }
    };
    const first = await until((pixels) => new Set(pixels).size > 20);
    await other.mouse.move(60, 60);
    await other.mouse.down();
    await other.mouse.move(150, 40);
    await other.mouse.up();
    await until((pixels) => difference(pixels, first).over > 100);
    holds(wrong.length === 0, wrong.join("\n"));
    const { hash } = new URL(other.url());
    holds(/^#v=1&hole\.spin=0\.9&camera\.orbit\.distance=26&/.test(hash), hash);
    await other.close();
});

await test("nothing was said in the console", async () => holds(said.length === 0, said.join("\n")));

await test("a lost device is told, and another one shows the same", async () => {
    const found = await page.evaluate(async () => {
        hole.reset();
        const before = base64((await hole.image(48, 27)).data);
        hole.loseDevice();
        const error = await hole.lost;
        const after = await hole.image(48, 27).then(() => "an image", (error) => error.code);
        const again = await bhr.BlackHole.create(null, { backend: "webgpu" });
        const same = base64((await again.image(48, 27)).data) === before;
        await again.destroy();
        return { message: error.message, code: error.code, after, same };
    });
    holds(found.code === "DEVICE_LOST" && found.after === "DEVICE_LOST" && found.same, JSON.stringify(found));
    holds(/the GPU device was lost/.test(found.message), found.message);
});

await finished(browser, server);
