// SPDX-License-Identifier: MIT OR Apache-2.0
// exr.ts -- light as an OpenEXR file: scan lines, half or float, with ZIP's compression where the browser has deflate,
// by the file layout of openexr.com ("OpenEXR File Layout"). Knows no page.

export type Depth = "half" | "float";

/** Scan lines in a block with ZIP's compression. */
const ZIP_LINES = 16;

/** Channels in the order of the file, by their names, and their places in the pixels that come. */
const CHANNELS = [["A", 3], ["B", 2], ["G", 1], ["R", 0]] as const;

/** The bits of the half nearest to a number, to even where two are as near. */
function halfOf(value: number): number {
    const bits = new DataView(new ArrayBuffer(4));
    bits.setFloat32(0, value);
    const word = bits.getUint32(0);
    const sign = (word >>> 16) & 0x8000;
    const size = word & 0x7fffffff;
    if (size > 0x7f800000) {
        return sign | 0x7e00;
    }
    // From 65520 on: infinity.
    if (size >= 0x477ff000) {
        return sign | 0x7c00;
    }
    if (size < 0x38800000) {
        // Below 2^-14 halves are multiples of 2^-24.
        return sign | roundedToEven(Math.abs(value) * 2 ** 24);
    }
    const kept = size - 0x38000000;
    const rest = kept & 0x1fff;
    const up = rest > 0x1000 || (rest === 0x1000 && (kept & 0x2000) !== 0) ? 1 : 0;
    return sign | ((kept >>> 13) + up);
}

function roundedToEven(value: number): number {
    const below = Math.floor(value);
    const rest = value - below;
    return rest > 0.5 || (rest === 0.5 && below % 2 === 1) ? below + 1 : below;
}

/** Bytes that grow. All numbers of the format are little-endian. */
class Bytes {
    private readonly parts: number[] = [];

    text(text: string): this {
        this.parts.push(...new TextEncoder().encode(text), 0);
        return this;
    }

    int(value: number): this {
        this.parts.push(value & 255, (value >> 8) & 255, (value >> 16) & 255, (value >> 24) & 255);
        return this;
    }

    float(value: number): this {
        const view = new DataView(new ArrayBuffer(4));
        view.setFloat32(0, value, true);
        return this.int(view.getInt32(0, true));
    }

    bytes(...bytes: number[]): this {
        this.parts.push(...bytes);
        return this;
    }

    /** An attribute of the header. */
    attribute(name: string, type: string, value: Bytes): this {
        this.text(name).text(type).int(value.parts.length);
        this.parts.push(...value.parts);
        return this;
    }

    get all(): Uint8Array<ArrayBuffer> {
        return Uint8Array.from(this.parts);
    }
}

function header(width: number, height: number, depth: Depth, isZip: boolean): Uint8Array<ArrayBuffer> {
    const channels = new Bytes();
    for (const [name] of CHANNELS) {
        channels.text(name).int(depth === "half" ? 1 : 2).bytes(0, 0, 0, 0).int(1).int(1);
    }
    const box = () => new Bytes().int(0).int(0).int(width - 1).int(height - 1);
    return new Bytes()
        .int(20000630)
        .int(2)
        .attribute("channels", "chlist", channels.bytes(0))
        .attribute("compression", "compression", new Bytes().bytes(isZip ? 3 : 0))
        .attribute("dataWindow", "box2i", box())
        .attribute("displayWindow", "box2i", box())
        .attribute("lineOrder", "lineOrder", new Bytes().bytes(0))
        .attribute("pixelAspectRatio", "float", new Bytes().float(1))
        .attribute("screenWindowCenter", "v2f", new Bytes().float(0).float(0))
        .attribute("screenWindowWidth", "float", new Bytes().float(1))
        .bytes(0).all;
}

/** Lines of a block: of each line all of one channel, then all of the next. */
function block(light: Float32Array, width: number, lines: readonly number[], depth: Depth): Uint8Array<ArrayBuffer> {
    const size = depth === "half" ? 2 : 4;
    const bytes = new Uint8Array(lines.length * width * CHANNELS.length * size);
    const view = new DataView(bytes.buffer);
    let at = 0;
    for (const line of lines) {
        for (const [, channel] of CHANNELS) {
            for (let x = 0; x < width; x++, at += size) {
                const value = light[4 * (line * width + x) + channel] as number;
                if (size === 2) {
                    view.setUint16(at, halfOf(value), true);
                } else {
                    view.setFloat32(at, value, true);
                }
            }
        }
    }
    return bytes;
}

/** ZIP's preparation: bytes of even places before those of odd ones, then differences. */
function prepared(bytes: Uint8Array<ArrayBuffer>): Uint8Array<ArrayBuffer> {
    const out = new Uint8Array(bytes.length);
    const half = Math.ceil(bytes.length / 2);
    for (let i = 0; i < bytes.length; i++) {
        out[(i & 1 ? half : 0) + (i >> 1)] = bytes[i] as number;
    }
    for (let i = bytes.length - 1; i > 0; i--) {
        out[i] = ((out[i] as number) - (out[i - 1] as number) + 128) & 255;
    }
    return out;
}

async function deflated(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
    const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * The file. `light`: rows of red, green, blue and alpha from the top. `went` is told the share that is done, and may
 * throw to end it.
 */
export async function exrOf(
    light: Float32Array,
    width: number,
    height: number,
    depth: Depth,
    went: (share: number) => void = () => undefined,
): Promise<Blob> {
    const isZip = typeof CompressionStream === "function";
    const head = header(width, height, depth, isZip);
    const step = isZip ? ZIP_LINES : 1;
    const blocks: Uint8Array<ArrayBuffer>[] = [];
    for (let y = 0; y < height; y += step) {
        const lines = Array.from({ length: Math.min(step, height - y) }, (_, i) => y + i);
        const plain = block(light, width, lines, depth);
        const packed = isZip ? await deflated(prepared(plain)) : plain;
        // A block that would not shrink is left as it is.
        const data = packed.length < plain.length ? packed : plain;
        blocks.push(new Bytes().int(y).int(data.length).all, data);
        went((y + lines.length) / height);
    }
    // Before the blocks stand their places in the file, in 64 bits.
    const table = new DataView(new ArrayBuffer(4 * blocks.length));
    let place = head.length + table.byteLength;
    for (let i = 0; i < blocks.length; i += 2) {
        table.setBigUint64(4 * i, BigInt(place), true);
        place += (blocks[i] as Uint8Array).length + (blocks[i + 1] as Uint8Array).length;
    }
    return new Blob([head, table.buffer as ArrayBuffer, ...blocks], { type: "image/x-exr" });
}
