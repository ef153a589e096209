// SPDX-License-Identifier: MIT OR Apache-2.0
// controls.ts -- pointers, wheel and keys over the picture: what they turn, move and look at. Sets the camera only.

import { clamped, poseOf, settingsOf, type Pose } from "./camera.js";
import { attempt } from "./notices.js";
import type { Session } from "./session.js";
import { numberIn } from "./values.js";

/** A turn for a drag over the whole height of the picture. */
const TURN = Math.PI;
/** A pointer that moves less, in CSS pixels, points at something. */
const CLICK = 6;

export interface Keys {
    /** Keys that are not the camera's, by `KeyboardEvent.key` in lower case. */
    [key: string]: () => void;
}

export class Controls {
    /** A place in the picture was clicked, in shares of its width and height. */
    clicked: (x: number, y: number) => void = () => undefined;
    /** Arrows that something else takes: says whether it did. */
    arrows: (dx: number, dy: number) => boolean = () => false;
    private readonly pointers = new Map<number, { x: number; y: number }>();
    private moved = 0;
    private most = 0;

    constructor(
        private readonly session: Session,
        private readonly stage: HTMLElement,
        /** Whether the camera moves by itself, so that only its look can be turned. */
        private readonly isCarried: () => boolean,
    ) {
        stage.addEventListener("pointerdown", (event) => this.down(event));
        stage.addEventListener("pointermove", (event) => this.move(event));
        stage.addEventListener("pointerup", (event) => this.up(event, true));
        stage.addEventListener("pointercancel", (event) => this.up(event, false));
        stage.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
        stage.addEventListener("contextmenu", (event) => event.preventDefault());
    }

    /** Takes the keys of the whole page, but for those that a field or a button needs. */
    listen(keys: Keys): void {
        window.addEventListener("keydown", (event) => {
            delete this.stage.dataset.by;
            const target = event.target as HTMLElement;
            const isTyping = target.closest("input[type=text], select, textarea, dialog") !== null;
            const isPressing = target.closest("button, a, summary, input, [role^=tab]") !== null;
            if (event.ctrlKey || event.metaKey || event.altKey || isTyping) {
                return;
            }
            const key = event.key.toLowerCase();
            const arrow = { arrowleft: [-1, 0], arrowright: [1, 0], arrowup: [0, -1], arrowdown: [0, 1] }[key];
            if (arrow !== undefined && !isPressing) {
                event.preventDefault();
                attempt(() => this.arrow(arrow[0] as number, arrow[1] as number, event.shiftKey));
            } else if (key === "+" || key === "=" || key === "-") {
                attempt(() => this.nearer(key === "-" ? 1 / 0.93 : 0.93));
            } else if (keys[key] !== undefined && !(isPressing && (key === " " || key === "enter"))) {
                event.preventDefault();
                attempt(keys[key]);
            }
        });
    }

    private arrow(dx: number, dy: number, isShift: boolean): void {
        if (!this.arrows(dx, dy)) {
            const step = this.stage.clientHeight / 45;
            // Keys move the camera; a drag moves the picture.
            this.turn(-dx * step, -dy * step, isShift || this.isCarried());
        }
    }

    private down(event: PointerEvent): void {
        if (event.button > 2) {
            return;
        }
        // The ring of focus is for those who came by keys.
        this.stage.dataset.by = "pointer";
        this.stage.focus({ preventScroll: true });
        try {
            this.stage.setPointerCapture(event.pointerId);
        } catch {
            // A pointer that is gone already: its end comes all the same.
        }
        if (this.pointers.size === 0) {
            [this.moved, this.most] = [0, 0];
        }
        this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        this.most = Math.max(this.most, this.pointers.size);
    }

    private move(event: PointerEvent): void {
        const last = this.pointers.get(event.pointerId);
        if (last === undefined) {
            return;
        }
        const before = this.spread();
        const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
        this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        this.moved += Math.abs(dx) + Math.abs(dy);
        if (this.moved < CLICK) {
            return;
        }
        attempt(() => {
            if (this.pointers.size === 2) {
                const after = this.spread();
                if (before > 0 && after > 0) {
                    this.nearer(before / after);
                }
                // Each of two fingers carries half of what they do together.
                this.turn(dx / 2, dy / 2, true);
            } else if (this.pointers.size === 1) {
                this.turn(dx, dy, event.shiftKey || event.buttons === 2 || this.isCarried());
            }
        });
    }

    private up(event: PointerEvent, isDone: boolean): void {
        if (!this.pointers.delete(event.pointerId) || this.pointers.size > 0) {
            return;
        }
        if (isDone && this.most === 1 && this.moved < CLICK && event.button === 0) {
            const box = this.stage.getBoundingClientRect();
            const [x, y] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
            attempt(() => this.clicked(x, y));
        }
    }

    /** The distance of two fingers. */
    private spread(): number {
        const [one, other] = [...this.pointers.values()];
        return one && other ? Math.hypot(one.x - other.x, one.y - other.y) : 0;
    }

    private wheel(event: WheelEvent): void {
        event.preventDefault();
        const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : event.deltaMode === 2 ? 400 : 1;
        // A trackpad's pinch comes as a wheel with ctrl, in smaller numbers.
        const by = Math.min(240, Math.max(-240, event.deltaY * lines)) * (event.ctrlKey ? 0.01 : 0.0012);
        attempt(() => this.nearer(Math.exp(by)));
    }

    /** The distance times a factor; a camera that is carried has its field of view changed. */
    private nearer(factor: number): void {
        if (this.isCarried()) {
            const fov = numberIn(this.session.values.sections.camera, "fov_y");
            const fov_y = Number(Math.min(2.8, Math.max(0.02, fov * factor)).toPrecision(5));
            this.session.change({ camera: { fov_y } });
            return;
        }
        this.place((pose) => ({ ...pose, distance: pose.distance * factor }));
    }

    /** A drag by so many CSS pixels: about the hole, or of the look alone. */
    private turn(dx: number, dy: number, isLook: boolean): void {
        const height = Math.max(1, this.stage.clientHeight);
        if (isLook) {
            // The sky follows the finger.
            const fov = Math.min(2.5, numberIn(this.session.values.sections.camera, "fov_y"));
            this.place((pose) => ({ ...pose, right: pose.right - (dx / height) * fov,
                up: Math.min(1.55, Math.max(-1.55, pose.up + (dy / height) * fov)) }));
        } else {
            this.place((pose) => ({ ...pose, azimuth: pose.azimuth - (dx / height) * TURN,
                elevation: pose.elevation + (dy / height) * TURN }));
        }
    }

    /** Changes the camera's place. */
    place(change: (pose: Pose) => Pose): void {
        const { session } = this;
        const { settings, values } = session;
        const pose = change(poseOf(settings, values));
        if (this.isCarried()) {
            session.change(settingsOf(pose));
            return;
        }
        const mass = numberIn(values.sections.hole, "mass");
        session.change(settingsOf(clamped(pose, session.hole.info().horizon_radius, mass)));
    }
}
