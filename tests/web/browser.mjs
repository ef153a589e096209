// SPDX-License-Identifier: MIT OR Apache-2.0
// browser.mjs -- what the tests of web pages share: a server of folders, headless Chromium on its software driver
// SwiftShader, tests that are counted, pictures that are compared. Knows nothing of the package.
//
// Environment: CHROMIUM, the browser; MODULES, the folder of node_modules that has playwright-core.

import { createReadStream, existsSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

/** The folder of the tests. */
export const here = dirname(fileURLToPath(import.meta.url));

const types = { ".css": "text/css", ".html": "text/html", ".jpg": "image/jpeg", ".js": "text/javascript",
    ".json": "application/json", ".png": "image/png", ".svg": "image/svg+xml", ".txt": "text/plain",
    ".wasm": "application/wasm", ".webp": "image/webp" };

/**
 * Serves folders under their names, `{ bhr: "/folder" }` as `/bhr/`, and this folder under "/", so that a page finds
 * the package beside it. `posted(path, text)` hears of what pages send.
 */
export async function served(folders, posted) {
    const server = createServer((request, response) => {
        const path = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname)).slice(1);
        if (request.method === "POST") {
            const parts = [];
            request.on("data", (part) => parts.push(part)).on("end", () => {
                response.writeHead(204).end();
                posted?.(path, Buffer.concat(parts).toString());
            });
            return;
        }
        const [first, ...rest] = path.split("/");
        const found = folders[first] && rest.length ? join(folders[first], ...rest) : join(here, path);
        const file = extname(found) ? found : join(found, "index.html");
        if (!existsSync(file)) {
            // Browsers ask for an icon by themselves.
            response.writeHead(path === "favicon.ico" ? 204 : 404).end();
            return;
        }
        response.writeHead(200, { "content-type": types[extname(file)] ?? "application/octet-stream" });
        createReadStream(file).pipe(response);
    });
    await new Promise((done) => server.listen(0, "127.0.0.1", done));
    const address = `http://127.0.0.1:${server.address().port}`;
    return { address, close: () => (server.close(), server.closeAllConnections()) };
}

/** The browser, whose WebGPU and whose canvases are SwiftShader's. */
export function launched() {
    const { chromium } = createRequire(join(process.env.MODULES, "x.js"))("playwright-core");
    const args = ["--no-sandbox", "--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--use-angle=vulkan",
        "--enable-features=Vulkan", "--use-vulkan=swiftshader", "--force-color-profile=srgb"];
    return chromium.launch({ executablePath: process.env.CHROMIUM, headless: true, args });
}

/**
 * A new page at an address, and what its console said that nobody expected. `options`: those of a context of
 * playwright's, such as `viewport`, `hasTouch` and `reducedMotion`.
 */
export async function opened(browser, address, options = {}) {
    const page = await browser.newPage({ viewport: { width: 400, height: 300 }, ...options });
    const said = [];
    page.on("console", (message) => ["error", "warning"].includes(message.type()) && said.push(message.text()));
    // Rejections that nobody handles are among them.
    page.on("pageerror", (error) => said.push(String(error)));
    page.setDefaultTimeout(240000);
    await page.goto(address);
    return { page, said };
}

let [passed, failed] = [0, 0];

/** Runs a test, and prints its line. */
export async function test(name, work) {
    const begin = Date.now();
    let why, timer;
    const late = new Promise((_, reject) => {
        timer = setTimeout(() => reject(new Error("it takes longer than five minutes")), 300000);
    });
    try {
        await Promise.race([work(), late]);
    } catch (error) {
        why = String(error.stack ?? error);
    }
    clearTimeout(timer);
    why === undefined ? passed++ : failed++;
    console.log(`${why === undefined ? "ok  " : "FAIL"}  ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s)`);
    if (why !== undefined) {
        console.log(why.replace(/^/gm, "      "));
    }
}

export function holds(is, what) {
    if (!is) {
        throw new Error(what);
    }
}

/** Ends the program, after its last line: "N passed, M failed". */
export async function finished(browser, server) {
    await browser?.close();
    server.close();
    console.log(`${passed} passed, ${failed} failed`);
    process.exit(failed === 0 && passed > 0 ? 0 : 1);
}

export const bytesOf = (text) => new Uint8Array(Buffer.from(text, "base64"));

/** How many pixels of four bytes differ, and by how much at most. */
export function difference(one, other) {
    holds(one.length === other.length && one.length > 0, `sizes differ: ${one.length} and ${other.length} bytes`);
    let [most, over] = [0, 0];
    for (let i = 0; i < one.length; i += 4) {
        const by = Math.max(...[0, 1, 2, 3].map((c) => Math.abs(one[i + c] - other[i + c])));
        most = Math.max(most, by);
        over += by > 1 ? 1 : 0;
    }
    return { most, over, pixels: one.length / 4 };
}

/** At most one pixel in 10,000 differs by more than a step. */
export function isSame({ over, pixels, most }) {
    holds(over <= pixels / 1e4, `${over} of ${pixels} pixels differ, by up to ${most}`);
}
