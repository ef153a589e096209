// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes the ray records of a tile into a buffer, for tests: src/gpu/frame/ray_records.rs reads them.

#import constants
#import records/record
#import shared/frame
#import shared/pass
#requires fn next_crossing() -> Crossing
#requires fn with_sky(record: Record) -> Record

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> pass_: Pass;
@group(2) @binding(0) var<storage, read_write> exported: array<vec4<f32>>;

// A record takes EXPORT_SIZE vectors: four for the ray, three for each of EXPORT_CROSSINGS crossings.

fn export_place(p: EmissionPoint, w: f32) -> vec4<f32> {
    return vec4<f32>(p.ln_r, p.azimuth, p.delay, w);
}

fn take_record(id: vec2<u32>, record: Record) {
    let at = (id.y * (pass_.size.x - 2u) + id.x) * EXPORT_SIZE;
    var count = 0u;
    for (var k = 0u; k < EXPORT_CROSSINGS; k += 1u) {
        let crossing = next_crossing();
        if crossing.u <= 0.0 {
            break;
        }
        let slot = at + 4u + 3u * k;
        exported[slot] = export_place(crossing.place, f32(crossing.order));
        exported[slot + 1u] = export_place(crossing.dx, crossing.u);
        exported[slot + 2u] = export_place(crossing.dy, crossing.g);
        count += 1u;
    }
    exported[at] = vec4<f32>(f32(record.fate), f32(record.steps), f32(count), record.plane_u);
    var whole = record;
    if record.fate == FATE_ESCAPED {
        whole = with_sky(record);
    }
    exported[at + 1u] = vec4<f32>(whole.sky, record.sky_redshift);
    let f = whole.footprint;
    exported[at + 2u] = vec4<f32>(f.p * f.dx.x + f.q * f.dx.y, record.energy);
    exported[at + 3u] = vec4<f32>(f.p * f.dy.x + f.q * f.dy.y, record.angular_momentum);
}
