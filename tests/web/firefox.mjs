// SPDX-License-Identifier: MIT OR Apache-2.0
// firefox.mjs -- the npm package in Firefox, whose WebGPU is wgpu on the machine's Vulkan driver, which runs native bhr
// as well.
//
//     node firefox.mjs PACKAGE BHR SCRATCH
//
// PACKAGE: the folder that packaging/npm --tree makes; BHR: the program; SCRATCH: an empty folder. Prints a line
// for each test, and "N passed, M failed". Environment: FIREFOX, the browser; LAVAPIPE, the manifest of the driver.

import { execFile, spawn } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { promisify } from "node:util";
import { bytesOf, difference, finished, holds, isSame, served, test } from "./browser.mjs";

const [pack, program, scratch] = process.argv.slice(2);
const [width, height] = [128, 72];
const SCENES = {
    "default disk": {},
    "a spinning hole": { hole: { spin: 0.9 } },
    "four samples": { quality: { samples_per_pixel: 4 }, camera: { orbit: { distance: 12, elevation: 0.3 } } },
    "volume with structure": { hole: { spin: 0.6 }, disk: false, volumes: [{ shape: "disk" }] },
    "inside the horizon": {
        camera: { position: [0, 1.2, 0.4], motion: "free_fall", fov_y: 1.6 },
        disk: { inner_radius: 4 },
    },
};
writeFileSync(join(scratch, "scenes.json"), JSON.stringify({ scenes: SCENES, size: [width, height] }));

// WebGPU is off on Linux by default, and software drivers are not on its list.
const profile = join(scratch, "profile");
mkdirSync(profile);
const wishes = { "dom.webgpu.enabled": true, "gfx.webgpu.ignore-blocklist": true, "app.update.enabled": false,
    "browser.shell.checkDefaultBrowser": false, "datareporting.policy.dataSubmissionEnabled": false,
    "toolkit.telemetry.enabled": false, "browser.aboutwelcome.enabled": false };
const lines = Object.entries(wishes).map(([name, value]) => `user_pref(${JSON.stringify(name)}, ${value});\n`);
writeFileSync(join(profile, "user.js"), lines.join(""));

let tell;
const result = new Promise((done) => (tell = done));
const server = await served({ bhr: pack, scratch }, (path, text) => path === "result" && tell(JSON.parse(text)));
const driver = { VK_DRIVER_FILES: process.env.LAVAPIPE, VK_ICD_FILENAMES: process.env.LAVAPIPE };
const options = ["--headless", "--no-remote", "--profile", profile, `${server.address}/firefox.html`];
const firefox = spawn(process.env.FIREFOX, options, {
    stdio: "ignore",
    env: { ...process.env, ...driver, HOME: scratch, MOZ_CRASHREPORTER_DISABLE: "1" },
});
firefox.on("exit", (code) => tell({ error: `Firefox ended with ${code}` }));
firefox.on("error", (error) => tell({ error: String(error) }));
const late = setTimeout(() => tell({ error: "nothing came of it in four minutes" }), 240000);
const made = await result;
clearTimeout(late);
firefox.kill();

const run = promisify(execFile);
/** The pixels of a scene's text by the program. */
async function native(name, text, backend) {
    const [scene, picture, raw] = ["toml", "png", "rgba"].map((end) => join(scratch, `${name}.${end}`));
    writeFileSync(scene, text);
    const words = ["render", scene, "--size", `${width}x${height}`, "--backend", backend, "--progress", "none"];
    await run(program, [...words, "--again", "--out", picture], { env: { ...process.env, ...driver } });
    await run("convert", [picture, "-depth", "8", raw]);
    return new Uint8Array(readFileSync(raw));
}

await test("Firefox renders all scenes, and says nothing in its console", async () => {
    holds(made.error === undefined, made.error);
    holds(made.adapter.backend === "webgpu" && made.said.length === 0, JSON.stringify([made.adapter, made.said]));
});
for (const name of made.error === undefined ? [...Object.keys(SCENES), "cpu"] : []) {
    await test(`${name} is that of native bhr`, async () => {
        const { text, pixels } = made.frames[name];
        const own = bytesOf(pixels);
        holds(new Set(own).size > 20, "the frame shows nothing");
        const found = difference(own, await native(name, text, name === "cpu" ? "cpu" : "vulkan"));
        isSame(found);
    });
}
await test("a canvas shows the image's pixels, and a lost device is told", async () => {
    holds(made.lost === "DEVICE_LOST", made.lost);
    const last = Object.keys(SCENES).at(-1);
    isSame(difference(bytesOf(made.shown), bytesOf(made.frames[last].pixels)));
});
await finished(undefined, server);
