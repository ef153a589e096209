// SPDX-License-Identifier: MIT OR Apache-2.0
// thumbnails.mjs -- makes the pictures of the page's cards, real frames of their scenes, in headless Chromium. Run it
// after a change in looks.ts:
//
//     node web/demo/thumbnails.mjs PAGE [ID...]
//
// PAGE: the folder that packaging/page makes. Without names all are made; those with depth take a minute each. The
// environment is that of tests/web/browser.mjs.

import { writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { launched, opened, served } from "../../tests/web/browser.mjs";

const [folder, ...only] = process.argv.slice(2);
const [width, height, samples] = [320, 180, 4];
const MOST_BYTES = 8000;
const into = join(dirname(fileURLToPath(import.meta.url)), "thumbnails");

const server = await served({ page: folder });
const browser = await launched();
const { page } = await opened(browser, `${server.address}/page/?pixels=2000`);
await page.waitForFunction(() => Number(document.getElementById("stage").dataset.frames) > 0);
const ids = await page.evaluate(async () => {
    const { LOOKS } = await import("./looks.js");
    return LOOKS.flatMap(({ looks }) => looks.map(({ id }) => id));
});
for (const id of only.length > 0 ? only : ids) {
    const bytes = await page.evaluate(async ([id, width, height, samples, most]) => {
        const { lookOf } = await import("./looks.js");
        const { settings } = lookOf(id);
        const wanted = { ...settings, quality: { samples_per_pixel: samples } };
        const image = await window.demo.session.meanwhile(wanted, (hole) => hole.image(width, height));
        const canvas = new OffscreenCanvas(width, height);
        canvas.getContext("2d").putImageData(image, 0, 0);
        for (let quality = 0.9; ; quality -= 0.04) {
            const blob = await canvas.convertToBlob({ type: "image/webp", quality });
            if (blob.size <= most) {
                return [...new Uint8Array(await blob.arrayBuffer())];
            }
        }
    }, [id, width, height, samples, MOST_BYTES]);
    writeFileSync(join(into, `${id}.webp`), Uint8Array.from(bytes));
    console.log(`${id}.webp: ${bytes.length} bytes`);
}
await browser.close();
server.close();
