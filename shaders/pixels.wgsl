// Kernel: traces the pixels of a tile's rectangle into ray records. What shading will do with them it does not know.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> pass_: Pass;
@group(0) @binding(2) var<storage, read_write> records: array<u32>;
// Of the ray being traced.
var<private> record: u32;
var<private> frequency_ratio: f32;
var<private> crossing_slot: u32;
var<private> disk_orders: u32;

fn keep(word: u32, value: u32) {
    records[word * pass_.size.x * pass_.size.y + record] = value;
}

fn on_crossing(c: Constants, crossing: PlaneCrossing) {
    if frame.view == VIEW_METRIC && crossing.order == 0u {
        keep(RECORD_PLANE, bitcast<u32>(crossing.u));
    }
    if crossing.u < frame.disk_u.x || crossing.u > frame.disk_u.y {
        return;
    }
    let word = RECORD_CROSSINGS + RECORD_CROSSING_WORDS * crossing_slot;
    keep(word, bitcast<u32>(crossing.u));
    keep(word + 1u, bitcast<u32>(frequency_ratio * redshift_of(c, crossing.u)));
    if DELAY {
        keep(word + 2u, bitcast<u32>(wrap_angle(arctan2(crossing.n.y, crossing.n.x) + crossing.drag)));
        keep(word + 3u, bitcast<u32>(crossing.delay));
    }
    disk_orders |= 0x10000u << crossing.order;
    crossing_slot += 1u;
}

@compute @workgroup_size(16, 8)
fn trace_pixels(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= pass_.size.x || id.y >= pass_.size.y {
        return;
    }
    let place = vec2<f32>(pass_.origin + vec2<i32>(id.xy)) + pass_.offset;
    let begin = begin_ray(camera_look(place.x, place.y));
    record = id.y * pass_.size.x + id.x;
    frequency_ratio = begin.frequency_ratio;
    crossing_slot = 0u;
    disk_orders = 0u;
    if frame.view == VIEW_METRIC {
        keep(RECORD_PLANE, 0u);
    }
    var steps = 0u;
    var fate = FATE_CAPTURED;
    if begin.light {
        let settings = Settings(frame.size.z, frame.size.w, frame.max_steps, frame.max_crossings, frame.capture_u, frame.opaque_u);
        let traced = trace(begin.c, begin.state, settings);
        steps = traced.steps;
        fate = traced.fate;
        if fate == FATE_ESCAPED {
            let end = escape(begin.c, traced);
            let direction = bitcast<vec3<u32>>(chart_direction(end.n, end.drag));
            keep(RECORD_DIRECTION, direction.x);
            keep(RECORD_DIRECTION + 1u, direction.y);
            keep(RECORD_DIRECTION + 2u, direction.z);
            keep(RECORD_SKY_REDSHIFT, bitcast<u32>(frequency_ratio * begin.c.nu_local / begin.c.energy));
        }
        if frame.effects != EFFECT_ALL {
            keep(RECORD_ENERGY, bitcast<u32>(begin.c.energy / begin.c.nu_local));
            keep(RECORD_ANGULAR_MOMENTUM, bitcast<u32>(begin.c.angular_momentum / begin.c.nu_local));
        }
    }
    keep(RECORD_META, fate | disk_orders);
    keep(RECORD_STEPS, steps);
}

// g of the disk's matter for the local frame's observer (physics::orbit::redshift).
fn redshift_of(c: Constants, u: f32) -> f32 {
    let v = sign(frame.hole.w) * u * sqrt(u);
    return c.nu_local * sqrt(max(1.0 - 3.0 * u + 2.0 * c.a * v, 0.0)) / (c.energy * (1.0 + c.a * v) - v * c.angular_momentum);
}
