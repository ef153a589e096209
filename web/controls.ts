// SPDX-License-Identifier: MIT OR Apache-2.0
// controls.ts -- a reader's hand on a picture: drag, pinch, wheel and keys become turns about the hole and changes of
// the distance. Leaves the page its own gestures: one finger scrolls it up and down, and the wheel does, until the
// picture has the focus. Knows no scene and no tracer.

/** What a gesture asks for: angles in radians, and a factor of the distance. */
export interface Move {
    azimuth: number;
    elevation: number;
    factor: number;
}

/** Radians that a drag over the height of the picture turns by. */
const TURN = 2.5;
/** Radians that a key turns by, and the factor of the distance of one. */
const KEY_TURN = 0.06;
const KEY_FACTOR = 1.08;
/** Pixels that a line and a page of a wheel are. */
const WHEEL_UNITS = [1, 16, 400];

/** Keys with what they ask for. */
const KEYS: Readonly<Record<string, Partial<Move>>> = {
    ArrowLeft: { azimuth: -KEY_TURN },
    ArrowRight: { azimuth: KEY_TURN },
    ArrowUp: { elevation: KEY_TURN },
    ArrowDown: { elevation: -KEY_TURN },
    "+": { factor: 1 / KEY_FACTOR },
    "=": { factor: 1 / KEY_FACTOR },
    "-": { factor: KEY_FACTOR },
};

/** Who is told of gestures. */
export interface Listener {
    move(move: Move): void;
    /** No finger and no button is down any more. */
    rest(): void;
    /** A key that is none of the moves; whether it was of use. */
    key(key: string): boolean;
}

/** Listens to gestures on an element until `end` is called. */
export class Controls {
    private readonly over = new AbortController();
    private readonly pointers = new Map<number, { x: number; y: number }>();

    constructor(
        private readonly element: HTMLElement,
        private readonly listener: Listener,
    ) {
        const { signal } = this.over;
        element.addEventListener("pointerdown", (event) => this.down(event), { signal });
        element.addEventListener("pointermove", (event) => this.dragged(event), { signal });
        for (const kind of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
            element.addEventListener(kind, (event) => this.up(event), { signal });
        }
        element.addEventListener("wheel", (event) => this.wheel(event), { signal, passive: false });
        element.addEventListener("keydown", (event) => this.key(event), { signal });
    }

    end(): void {
        this.over.abort();
        this.pointers.clear();
    }

    private down(event: PointerEvent): void {
        if (event.button !== 0 || this.pointers.size >= 2) {
            return;
        }
        this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        // Events of scripts have pointers that no element can capture.
        if (event.isTrusted) {
            this.element.setPointerCapture(event.pointerId);
        }
    }

    private dragged({ pointerId, clientX: x, clientY: y }: PointerEvent): void {
        const before = this.pointers.get(pointerId);
        if (before === undefined) {
            return;
        }
        const [other] = [...this.pointers].filter(([id]) => id !== pointerId).map(([, place]) => place);
        const scale = TURN / Math.max(this.element.clientHeight, 1);
        const apart = (place: { x: number; y: number }) =>
            other === undefined ? 1 : Math.max(Math.hypot(place.x - other.x, place.y - other.y), 1);
        // Each of two fingers turns by half: both together turn as one does.
        const share = other === undefined ? scale : scale / 2;
        this.pointers.set(pointerId, { x, y });
        this.listener.move({
            azimuth: (before.x - x) * share,
            elevation: (y - before.y) * share,
            factor: apart(before) / apart({ x, y }),
        });
    }

    private up({ pointerId }: PointerEvent): void {
        if (this.pointers.delete(pointerId) && this.pointers.size === 0) {
            this.listener.rest();
        }
    }

    private wheel(event: WheelEvent): void {
        // Browsers tell a pinch on a touchpad as a wheel with ctrl.
        if (!event.ctrlKey && !this.element.matches(":focus")) {
            return;
        }
        event.preventDefault();
        const pixels = event.deltaY * (WHEEL_UNITS[event.deltaMode] ?? 1);
        const speed = event.ctrlKey ? 0.005 : 0.001;
        const factor = Math.exp(Math.min(Math.max(pixels, -300), 300) * speed);
        this.listener.move({ azimuth: 0, elevation: 0, factor });
    }

    private key(event: KeyboardEvent): void {
        if (event.ctrlKey || event.altKey || event.metaKey) {
            return;
        }
        const move = KEYS[event.key];
        if (move !== undefined) {
            this.listener.move({ azimuth: 0, elevation: 0, factor: 1, ...move });
        } else if (!this.listener.key(event.key)) {
            return;
        }
        event.preventDefault();
    }
}
