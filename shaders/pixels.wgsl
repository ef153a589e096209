// Kernel: traces the pixels of a tile's rectangle into ray records. What shading will do with them it does not know.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> pass_: Pass;
@group(0) @binding(2) var<storage, read_write> records: array<u32>;
// Steps of all rays: low and high word, the low one as wide as a submission's steps.
@group(0) @binding(3) var<storage, read_write> step_sum: atomic<u32>;

var<workgroup> group_steps: atomic<u32>;

@compute @workgroup_size(16, 8)
fn trace_pixels(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    if local == 0u {
        atomicStore(&group_steps, 0u);
    }
    workgroupBarrier();
    if id.x < pass_.size.x && id.y < pass_.size.y {
        atomicAdd(&group_steps, trace_pixel(id.xy));
    }
    workgroupBarrier();
    if local == 0u {
        atomicAdd(&step_sum, atomicLoad(&group_steps));
    }
}

fn trace_pixel(pixel: vec2<u32>) -> u32 {
    let place = vec2<f32>(pass_.origin + vec2<i32>(pixel)) + pass_.offset;
    let look = camera_look(place.x, place.y);
    let begin = begin_ray(look);
    let pixels = pass_.size.x * pass_.size.y;
    let i = pixel.y * pass_.size.x + pixel.x;
    if !begin.light {
        records[RECORD_META * pixels + i] = FATE_CAPTURED;
        records[RECORD_PLANE * pixels + i] = 0u;
        records[RECORD_STEPS * pixels + i] = 0u;
        return 0u;
    }
    let settings = Settings(frame.size.z, frame.size.w, frame.max_steps, frame.max_crossings, frame.capture_u);
    let traced = trace(begin.c, begin.state, settings);
    write_record(i, pixels, begin, traced);
    return traced.steps;
}

fn write_record(i: u32, pixels: u32, begin: RayBegin, traced: RayTrace) {
    let c = begin.c;
    var meta_word = traced.fate;
    if traced.fate == FATE_ESCAPED {
        let direction = bitcast<vec3<u32>>(chart_direction(traced.n, traced.drag));
        records[RECORD_DIRECTION * pixels + i] = direction.x;
        records[(RECORD_DIRECTION + 1u) * pixels + i] = direction.y;
        records[(RECORD_DIRECTION + 2u) * pixels + i] = direction.z;
        let redshift = begin.frequency_ratio * c.nu_local / c.energy;
        records[RECORD_SKY_REDSHIFT * pixels + i] = bitcast<u32>(redshift);
    }
    var slot = 0u;
    for (var k = 0u; k < traced.crossing_count; k++) {
        let crossing = traced.crossings[k];
        let r = 1.0 / crossing.u;
        if frame.has_disk != 0u && r >= frame.disk.x && r <= frame.disk.y {
            let g = begin.frequency_ratio * redshift_of(c, crossing.u);
            let base = (RECORD_CROSSINGS + RECORD_CROSSING_WORDS * slot) * pixels + i;
            records[base] = bitcast<u32>(crossing.u);
            records[base + 2u * pixels] = bitcast<u32>(g);
            if DELAY {
                let azimuth = wrap_angle(arctan2(crossing.n.y, crossing.n.x) + crossing.drag);
                records[base + pixels] = bitcast<u32>(azimuth);
                records[base + 3u * pixels] = bitcast<u32>(crossing.delay);
            }
            meta_word |= 0x10000u << crossing.order;
            slot += 1u;
        }
    }
    records[RECORD_META * pixels + i] = meta_word;
    // What only some frames look at.
    if frame.effects != EFFECT_ALL {
        records[RECORD_ENERGY * pixels + i] = bitcast<u32>(c.energy / c.nu_local);
        records[RECORD_ANGULAR_MOMENTUM * pixels + i] = bitcast<u32>(c.angular_momentum / c.nu_local);
    }
    if frame.view == VIEW_STEPS {
        records[RECORD_STEPS * pixels + i] = traced.steps;
    }
    if frame.view == VIEW_METRIC {
        var plane = 0.0;
        if traced.crossing_count > 0u {
            plane = traced.crossings[0].u;
        }
        records[RECORD_PLANE * pixels + i] = bitcast<u32>(plane);
    }
}

// g of the disk's matter for the local frame's observer (physics::orbit::redshift).
fn redshift_of(c: Constants, u: f32) -> f32 {
    let v = frame.disk_light.w * u * sqrt(u);
    return c.nu_local * sqrt(max(1.0 - 3.0 * u + 2.0 * c.a * v, 0.0)) / (c.energy * (1.0 + c.a * v) - v * c.angular_momentum);
}
