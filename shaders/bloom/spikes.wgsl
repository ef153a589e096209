// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: spreads the finest grid's light along a line, in a workgroup for each row of the grid as it is sheared. A
// thread has a few elements, and what comes from those of others it finds in steps that reach twice as far each.
// Mirrors src/film/bloom/spikes.rs.

#import bloom/line
#import bloom/tail
#import constants

@group(0) @binding(0) var<uniform> line: SpikeLine;
@group(0) @binding(1) var gathered: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> sheared: array<vec4<f32>>;

const THREADS: u32 = 256u;
const OWN_ELEMENTS: u32 = SPIKE_ELEMENTS / THREADS;
// Factors below it are of no account.
const LEAST_POWER: f32 = 1e-9;

// Sums of the elements up to a thread's last, and from its first on, each by how far away it is.
var<workgroup> before: array<vec4<f32>, THREADS>;
var<workgroup> behind: array<vec4<f32>, THREADS>;

// The light of a cell, and how much of a cell it is; 0 beyond the grid.
fn cell_light(j: u32, i: i32) -> vec4<f32> {
    let steep = line.steep == 1u;
    let there = (i >= 0) & (i < i32(line.across));
    let across = clamp(i, 0, i32(line.across) - 1);
    let place = select(vec2<i32>(i32(j), across), vec2<i32>(across, i32(j)), steep);
    let tail_along = select(line.tail_x, line.tail_y, steep);
    let tail_across = select(line.tail_y, line.tail_x, steep);
    let part = covered(i32(line.along) - 1 - i32(j), tail_along)
        * covered(i32(line.across) - 1 - across, tail_across);
    return select(0.0, part, there) * vec4<f32>(textureLoad(gathered, place, 0).xyz, 1.0);
}

fn element_light(element: u32, row: i32) -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    let first = min(element * line.step, line.along);
    let end = min(first + line.step, line.along);
    for (var j = first; j < end; j += 1u) {
        let i = row + whole_rows(j);
        let shares = row_shares(j);
        sum += shares.x * cell_light(j, i - 1) + shares.y * cell_light(j, i) + shares.z * cell_light(j, i + 1);
    }
    return sum;
}

// Keeps what an element has after the line: what reached it, and of its own light what would leave the frame.
fn keep(element: u32, row: i32, light: vec4<f32>, spread: vec3<f32>, kept: vec3<f32>) {
    let across = row_kept(element, row);
    if element < line.elements && across >= 0 && across < stored_rows() {
        let staying = select(vec3<f32>(0.0), (line.share - kept) * light.xyz / light.w, light.w > 0.0);
        sheared[element * line.next_along + u32(across) * line.next_across] = vec4<f32>(spread + staying, 0.0);
    }
}

@compute @workgroup_size(THREADS)
fn spread_line(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let row = line.first_row + i32(group.x);
    let first = OWN_ELEMENTS * thread;
    let x0 = element_light(first, row);
    let x1 = element_light(first + 1u, row);
    let x2 = element_light(first + 2u, row);
    let x3 = element_light(first + 3u, row);
    var spread: array<vec3<f32>, OWN_ELEMENTS>;
    var kept: array<vec3<f32>, OWN_ELEMENTS>;
    for (var term = 0u; term < SPIKE_TERMS; term += 1u) {
        let decay = line.decays[term];
        let weights = line.weights[term].xyz;
        workgroupBarrier();
        before[thread] = x3 + decay * (x2 + decay * (x1 + decay * x0));
        behind[thread] = x0 + decay * (x1 + decay * (x2 + decay * x3));
        workgroupBarrier();
        var power = decay * decay * decay * decay;
        for (var away = 1u; away < THREADS && power > LEAST_POWER; away *= 2u) {
            var up = before[thread];
            var down = behind[thread];
            if thread >= away {
                up += power * before[thread - away];
            }
            if thread + away < THREADS {
                down += power * behind[thread + away];
            }
            workgroupBarrier();
            before[thread] = up;
            behind[thread] = down;
            workgroupBarrier();
            power *= power;
        }
        let nearest = max(thread, 1u) - 1u;
        let next = min(thread + 1u, THREADS - 1u);
        let up0 = x0 + select(0.0, decay, thread > 0u) * before[nearest];
        let up1 = x1 + decay * up0;
        let up2 = x2 + decay * up1;
        let up3 = x3 + decay * up2;
        let down3 = select(0.0, decay, thread + 1u < THREADS) * behind[next];
        let down2 = decay * (x3 + down3);
        let down1 = decay * (x2 + down2);
        let down0 = decay * (x1 + down1);
        spread[0] += weights * (up0 + down0).xyz;
        spread[1] += weights * (up1 + down1).xyz;
        spread[2] += weights * (up2 + down2).xyz;
        spread[3] += weights * (up3 + down3).xyz;
        kept[0] += weights * (up0 + down0).w;
        kept[1] += weights * (up1 + down1).w;
        kept[2] += weights * (up2 + down2).w;
        kept[3] += weights * (up3 + down3).w;
    }
    keep(first, row, x0, spread[0], kept[0]);
    keep(first + 1u, row, x1, spread[1], kept[1]);
    keep(first + 2u, row, x2, spread[2], kept[2]);
    keep(first + 3u, row, x3, spread[3], kept[3]);
}
