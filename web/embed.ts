// SPDX-License-Identifier: MIT OR Apache-2.0
// embed.ts -- the script of embed.html, a page for frames: its address says the attributes of the element that fills
// it, "embed.html?spin=0.9&controls", and behind "#" a scene as links have it.

import { isAttribute } from "./attributes.js";
import "./element.js";

const element = document.createElement("bhr-hole");
for (const [name, value] of new URLSearchParams(location.search)) {
    // Whoever makes the address may say what is shown, but no script.
    if (isAttribute(name)) {
        element.setAttribute(name, value);
    }
}
function follow(): void {
    if (location.hash.length > 1) {
        element.setAttribute("scene", location.hash);
    }
}
follow();
addEventListener("hashchange", follow);
const title = element.getAttribute("alt");
if (title !== null) {
    document.title = title;
}
document.body.append(element);
