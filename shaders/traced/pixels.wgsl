// SPDX-License-Identifier: MIT OR Apache-2.0
// Traces a pixel, or a block of pixels, into record textures. Does not know what shading will do with them. The kernels
// that import it say which: traced/each.wgsl, traced/blocks.wgsl and traced/listed.wgsl.

#import constants
#import camera/chart
#import camera/observer
#import camera/projection
#import emit/moment
#import emit/occluder
#import emit/shown_part
#import emit/volumes
#import geodesic/geodesic
#import geodesic/trace
#import shared/not_inlined
#import shared/frame
#import shared/math
#import shared/pass
#import traced/layout

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> pass_: Pass;
@group(0) @binding(2) var record_sky: texture_storage_2d<rgba32float, write>;
@group(0) @binding(3) var record_meta: texture_storage_2d<rgba32uint, write>;
@group(0) @binding(4) var record_disk: texture_storage_2d_array<rgba32float, write>;
// The tables of light, as shade/shade.wgsl has them: matter with depth reads blackbodies there.
@group(0) @binding(5) var light_tables: texture_2d<f32>;
// The structure of matter with depth: emit/clouds.wgsl.
@group(0) @binding(6) var<storage, read> clouds: Clouds;
@group(0) @binding(7) var baked_0: texture_3d<f32>;
@group(0) @binding(8) var baked_1: texture_3d<f32>;
@group(0) @binding(10) var baked_2: texture_3d<f32>;
@group(0) @binding(11) var baked_3: texture_3d<f32>;
@group(0) @binding(12) var baked_sampler: sampler;

// Whether shading needs to know where on the disk a crossing is.
override AZIMUTH: bool = true;
// Whether the whole record is kept, not the media only: those of a record that is there already.
override KEEPS_RECORD: bool = true;

// The ray being traced: its pixel, and what is found on its way.
var<private> pixel: vec2<u32>;
var<private> frequency_ratio: f32;
var<private> disk_orders: u32;
var<private> beside_orders: u32;
var<private> plane_u: f32;

fn light_table(i: u32) -> vec4<f32> {
    return textureLoad(light_tables, vec2<u32>(i % TABLE_WIDTH, i / TABLE_WIDTH), 0);
}

fn baked_factor(index: u32, place: vec3<f32>, level: f32) -> f32 {
    switch index {
        case 1u: { return textureSampleLevel(baked_1, baked_sampler, place, level).x; }
        case 2u: { return textureSampleLevel(baked_2, baked_sampler, place, level).x; }
        case 3u: { return textureSampleLevel(baked_3, baked_sampler, place, level).x; }
        default: { return textureSampleLevel(baked_0, baked_sampler, place, level).x; }
    }
}

fn on_crossing(c: Constants, crossing: PlaneCrossing) {
    if crossing.order == 0u {
        plane_u = crossing.u;
    }
    // Without a disk, whose edges are (1, 0) then, inside all that shines; (1, 0) is nothing's range, too.
    let disk = frame.disk_u.x <= frame.disk_u.y;
    let edge = select(max(frame.plane_u.x, frame.plane_u.y), frame.disk_u.y, disk);
    // Crossings that are kept outside the disk count as well: those on the disk, which are kept, too, differ from them.
    if crossing.u > edge || (disk && crossing.u < frame.disk_u.x && crossing.u >= frame.plane_u.x) {
        beside_orders |= 1u << crossing.order;
    }
    if crossing.u >= frame.plane_u.x && crossing.u <= frame.plane_u.y {
        var azimuth = 0.0;
        var delay = crossing.delay;
        if AZIMUTH {
            let offsets = chart_offsets(c, crossing.u);
            azimuth = wrap_angle(arctan2(crossing.n.y, crossing.n.x) + crossing.drag - offsets.x);
            delay += offsets.y;
        }
        let g = frequency_ratio * redshift_at(c, crossing.u, crossing.du);
        if PARTS {
            keep_medium();
        }
        if KEEPS_RECORD {
            let kept = vec4<f32>(crossing.u, g, azimuth, delay);
            textureStore(record_disk, pixel, countOneBits(disk_orders), kept);
        }
        disk_orders |= 1u << crossing.order;
    }
}

fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32, end: f32) {
    next_part(begin);
    var seen = vec2<f32>(begin, end);
    if OCCLUDED {
        seen = shown_stretch(c, from_state, begin, end);
    }
    if !OCCLUDED || seen.x < seen.y {
        add_part(c, observer, from_state, to_state, h, seen.x, seen.y, frequency_ratio);
    }
}

// Leaves the medium since the crossing before.
fn keep_medium() {
    textureStore(record_disk, pixel, frame.medium_layer + countOneBits(disk_orders), medium);
    medium = NO_MEDIUM;
}

// After a pixel has been traced anew: its record may hold a crossing more than are found now, by rounding, and a medium
// before it.
fn keep_nothing_more() {
    // The medium's layer is also the number of crossings that are kept at most.
    for (var k = countOneBits(disk_orders) + 1u; k <= not_inlined(frame.medium_layer); k += 1u) {
        textureStore(record_disk, pixel, frame.medium_layer + k, NO_MEDIUM);
    }
}

// Traces the ray through `place` of the full frame and leaves its record at the texel `at`.
fn trace_pixel(at: vec2<u32>, place: vec2<f32>) {
    pixel = at;
    let begin = begin_ray(look_direction(place.x, place.y));
    let c = begin.c;
    frequency_ratio = begin.frequency_ratio;
    disk_orders = 0u;
    beside_orders = 0u;
    plane_u = 0.0;
    moment = pass_.moment;
    if PARTS {
        begin_medium(c, begin.state, 1u);
    }
    if OCCLUDED {
        set_occluder(place);
    }
    var sky = vec4<f32>(0.0);
    var m = TracedMeta(FATE_CAPTURED, 0u, 0u, 0u, c.energy / c.nu_local, c.angular_momentum / c.nu_local,
        polar_momentum(begin, frequency_ratio) * frame.observer_u);
    if begin.has_light {
        let settings = Settings(frame.step, frame.tolerance, frame.max_steps, frame.max_crossings,
            frame.capture_u, opaque_u_at());
        let traced = trace(c, begin.state, settings);
        // A crossing that passes through the horizon is in no way beside an edge of the disk.
        beside_orders |= select(0u, traced.inside, frame.disk_u.x <= frame.disk_u.y);
        m.fate = traced.fate;
        m.steps = traced.steps;
        if traced.fate == FATE_ESCAPED {
            let end = escape(c, traced);
            sky = vec4<f32>(chart_direction(end.n, end.drag), frequency_ratio / m.energy);
        }
    }
    if PARTS {
        keep_medium();
    }
    if KEEPS_RECORD {
        textureStore(record_sky, pixel, sky);
        m.orders = disk_orders;
        m.beside_disk = beside_orders;
        if frame.view == VIEW_METRIC {
            m.energy = plane_u;
        }
        textureStore(record_meta, pixel, pack_meta(m));
    }
}
