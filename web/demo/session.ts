// SPDX-License-Identifier: MIT OR Apache-2.0
// session.ts -- the page's black hole: what is set, who is told when that changes, and another device when one is
// lost. Draws nothing.

import { BlackHole, type Settings } from "./bhr/index.js";
import { element } from "./dom.js";
import { failure, notice } from "./notices.js";
import { valuesOf, type Struct, type Value, type Values } from "./values.js";

export type Backend = "auto" | "webgpu" | "cpu";
export type ListName = "volumes" | "hot_spots";

/** A device that is lost more often than this in a minute stays lost. */
const MOST_LOSSES = 4;

export class Session {
    /** Gives another device what no scene holds. */
    renewed: () => Promise<void> = () => Promise.resolve();
    /** Settings that only the view makes: more samples of each pixel as the picture sharpens. */
    private samples = 1;
    private known: Values | undefined;
    private set: Settings | undefined;
    private readonly listeners: (() => void)[] = [];
    private losses: number[] = [];
    /** The samples that a scene itself asked for: they stay in its file and link. */
    private ownSamples: number | undefined;

    private constructor(
        private readonly stage: HTMLElement,
        private readonly backend: Backend,
        private current: BlackHole,
    ) {
        this.watch();
    }

    /** Makes a canvas in `stage`, and a black hole for it. */
    static async start(stage: HTMLElement, backend: Backend): Promise<Session> {
        const hole = await BlackHole.create(canvasIn(stage), { backend });
        return new Session(stage, backend, hole);
    }

    get hole(): BlackHole {
        return this.current;
    }

    get isGpu(): boolean {
        return this.current.adapter.backend === "webgpu";
    }

    /** All values of the scene, presets included. */
    get values(): Values {
        this.known ??= valuesOf(this.own(() => this.current.text()));
        return this.known;
    }

    /** What was set, without the view's samples. */
    get settings(): Settings {
        this.set ??= this.own(() => this.current.scene);
        return this.set;
    }

    get link(): string {
        return this.own(() => this.current.link());
    }

    get text(): string {
        return this.own(() => this.current.text());
    }

    onChange(listener: () => void): void {
        this.listeners.push(listener);
    }

    /** Lays settings over those there are. Throws bhr.h's message, and then changes nothing. */
    change(settings: Settings): void {
        this.current.set(settings);
        this.told();
    }

    /** Has another scene in place of this one. `set`: such as `(hole) => hole.load(link)`. */
    replace(set: (hole: BlackHole) => unknown): void {
        const before = this.settings;
        try {
            set(this.current);
        } catch (error) {
            this.current.reset().set(before);
            this.sample(this.samples);
            throw error;
        }
        this.ownSamples = this.current.scene.quality?.samples_per_pixel;
        this.sample(this.samples);
        this.told();
    }

    /** Whether the scene would be one with these settings as well; changes nothing. */
    accepts(settings: Settings): boolean {
        const before = this.current.scene;
        try {
            this.current.set(settings);
        } catch {
            return false;
        }
        this.current.reset().set(before);
        return true;
    }

    /** Has work done with other settings, of which neither listeners nor the picture learn. Not for promises' ends. */
    meanwhile<T>(settings: Settings, work: (hole: BlackHole) => T): T {
        const before = this.current.scene;
        try {
            return work(this.current.reset().set(settings));
        } finally {
            this.current.reset().set(before);
        }
    }

    /** How many samples the next frame has of each pixel. */
    sample(count: number): void {
        this.samples = count;
        this.current.set({ quality: { samples_per_pixel: count === 1 ? undefined : count } } as unknown as Settings);
    }

    /** The value of a field, such as "film.bloom" or "volumes.0.radius". */
    value(path: string): Value | undefined {
        const [section, name, third] = path.split(".") as [string, string | undefined, string | undefined];
        if (section === "volumes" || section === "hot_spots") {
            return this.values[section][Number(name)]?.[third ?? ""];
        }
        return name === undefined ? this.values.top[section] : this.values.sections[section]?.[name];
    }

    /** Whether a field was set, rather than being as in a new scene or a preset. */
    isSet(path: string): boolean {
        let place: unknown = this.settings;
        for (const word of path.split(".")) {
            place = (place as Record<string, unknown> | undefined)?.[word];
        }
        return place !== undefined;
    }

    /** Sets a field, or takes it back. Throws bhr.h's message. */
    assign(path: string, value: Value | undefined): void {
        const [section, name, third] = path.split(".") as [string, string | undefined, string | undefined];
        if ((section === "volumes" || section === "hot_spots") && third !== undefined) {
            const list = this.listOf(section);
            const one = { ...list[Number(name)], [third]: value } as Struct;
            this.change({ [section]: list.with(Number(name), one) } as Settings);
        } else {
            this.change((name === undefined ? { [section]: value } : { [section]: { [name]: value } }) as Settings);
        }
    }

    /** The structs of a list as they were set, or as a preset has them. */
    listOf(section: ListName): Struct[] {
        return ((this.settings[section] ?? this.values[section]) as Struct[]).map((one) => ({ ...one }));
    }

    /** Has the device lost, as a driver may at any time: for tests. */
    loseDevice(): void {
        this.current.loseDevice();
    }

    /** Has work done while the scene has the samples that it asked for itself. */
    private own<T>(work: () => T): T {
        const set = (count: number | undefined) =>
            this.current.set({ quality: { samples_per_pixel: count } } as unknown as Settings);
        set(this.ownSamples);
        try {
            const made = work();
            // A table without values is as good as none.
            if (typeof made === "object" && made !== null && "quality" in made) {
                const { quality } = made as { quality: object };
                if (Object.keys(quality).length === 0) {
                    delete (made as { quality?: object }).quality;
                }
            }
            return made;
        } finally {
            set(this.samples === 1 ? undefined : this.samples);
        }
    }

    private told(): void {
        [this.known, this.set] = [undefined, undefined];
        for (const listener of this.listeners) {
            listener();
        }
    }

    private watch(): void {
        const watched = this.current;
        void watched.lost.then((error) => {
            if (watched === this.current) {
                this.recover(error).catch(failure);
            }
        });
    }

    /** Another device, with the same scene. The canvas is another one as well: an old one keeps its kind of context. */
    private async recover(error: Error): Promise<void> {
        const now = Date.now();
        this.losses = [...this.losses.filter((at) => now - at < 60000), now];
        if (this.losses.length > MOST_LOSSES) {
            notice(`${error.message}. It was lost again and again: reload the page.`, "error");
            return;
        }
        const { scene } = this.current;
        notice("The graphics device was lost. The picture is being restored.");
        this.current.destroy().catch(() => undefined);
        const hole = await BlackHole.create(canvasIn(this.stage), { backend: this.backend });
        this.current = hole.set(scene);
        this.watch();
        await this.renewed();
        this.told();
        if (!this.isGpu) {
            notice("WebGPU did not come back: the processor goes on, slowly.");
        }
    }
}

/** A canvas in place of the one that was there. */
function canvasIn(stage: HTMLElement): HTMLCanvasElement {
    const canvas = element("canvas", { class: "picture" });
    stage.querySelector("canvas")?.remove();
    stage.prepend(canvas);
    return canvas;
}
