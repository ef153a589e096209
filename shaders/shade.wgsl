// Kernel: ray records of a tile to linear radiance (or a view's value), one sample added to the sum. Mirrors src/cpu/shade.rs. How the
// records were made it does not know.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> pass_: Pass;
@group(0) @binding(2) var<storage, read> records: array<u32>;
@group(0) @binding(3) var<storage, read> light_tables: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> star_cells: array<u32>;
// Of the tile without its margin.
@group(0) @binding(5) var<storage, read_write> radiance: array<vec4<f32>>;

const FATE_MASK: u32 = 3u;
const FATE_CAPTURED: u32 = 0u;
const FATE_ESCAPED: u32 = 1u;

@compute @workgroup_size(16, 8)
fn shade(@builtin(global_invocation_id) id: vec3<u32>) {
    let tile = pass_.size - 2u;
    if id.x >= tile.x || id.y >= tile.y {
        return;
    }
    let pixel = id.xy + 1u;
    let i = pixel.y * pass_.size.x + pixel.x;
    let out = id.y * tile.x + id.x;
    if frame.view != VIEW_LIGHT {
        radiance[out] = vec4<f32>(view_value(i, pixel), 0.0, 0.0, 1.0);
        return;
    }
    var sum = pixel_light(i) * pass_.weight;
    if pass_.first == 0u {
        sum += radiance[out];
    }
    radiance[out] = sum;
}

fn word(k: u32, i: u32) -> u32 {
    return records[k * pass_.size.x * pass_.size.y + i];
}

fn number(k: u32, i: u32) -> f32 {
    return bitcast<f32>(word(k, i));
}

fn escaped(i: u32) -> bool {
    return (word(RECORD_META, i) & FATE_MASK) == FATE_ESCAPED;
}

fn direction(i: u32) -> vec3<f32> {
    return vec3<f32>(number(RECORD_DIRECTION, i), number(RECORD_DIRECTION + 1u, i), number(RECORD_DIRECTION + 2u, i));
}

// d(sky direction) / d(pixel) along the neighbours at -+ stride: central where both escaped, else one-sided; infinite where
// neither did, which only the mean sky can stand for.
fn derivative_of_direction(i: u32, here: vec3<f32>, stride: u32) -> vec3<f32> {
    let before = escaped(i - stride);
    let after = escaped(i + stride);
    if before && after {
        return 0.5 * (direction(i + stride) - direction(i - stride));
    }
    if after {
        return direction(i + stride) - here;
    }
    if before {
        return here - direction(i - stride);
    }
    return vec3<f32>(1e30);
}

fn to_sky(d: vec3<f32>) -> vec3<f32> {
    return frame.sky_x.xyz * d.x + frame.sky_y.xyz * d.y + frame.sky_z.xyz * d.z;
}

fn pixel_light(i: u32) -> vec4<f32> {
    let meta_word = word(RECORD_META, i);
    let partial = frame.effects != EFFECT_ALL;
    var energy = 1.0;
    var angular_momentum = 0.0;
    if partial {
        energy = number(RECORD_ENERGY, i);
        angular_momentum = number(RECORD_ANGULAR_MOMENTUM, i);
    }
    var light = vec3<f32>(0.0);
    var open = 1.0;
    var orders = meta_word >> 16u;
    for (var slot = 0u; orders != 0u && open > 0.0; slot += 1u) {
        orders &= orders - 1u;
        let base = RECORD_CROSSINGS + RECORD_CROSSING_WORDS * slot;
        let u = number(base, i);
        let g = number(base + 1u, i);
        var shift = Shift(g, g);
        if partial {
            shift = visible_shift(g, nu_static_eye(energy) / nu_zamo_in_plane(u, energy, angular_momentum));
        }
        light += open * frame.disk.z * disk_light(u, shift);
        open *= 1.0 - frame.disk.z;
    }
    if (meta_word & FATE_MASK) != FATE_ESCAPED {
        return vec4<f32>(light, 1.0);
    }
    if frame.sky_x.w != 0.0 && frame.transparent == 0u && open > 0.0 {
        light += open * sky_light(i, energy, partial);
    }
    return vec4<f32>(light, 1.0 - open);
}

fn sky_light(i: u32, energy: f32, partial: bool) -> vec3<f32> {
    let d = direction(i);
    let dx = derivative_of_direction(i, d, 1u);
    let dy = derivative_of_direction(i, d, pass_.size.x);
    let g = number(RECORD_SKY_REDSHIFT, i);
    var shift = Shift(g, g);
    if partial {
        shift = visible_shift(g, nu_static_eye(energy) / energy);
    }
    return star_light(to_sky(d), to_sky(dx), to_sky(dy), shift.colour, shift.beaming) * frame.sky_y.w;
}

// What BHR_VIEW_* shows; NaN where there is nothing.
fn view_value(i: u32, pixel: vec2<u32>) -> f32 {
    // NaN may not be written as a constant.
    let nothing = bitcast<f32>(0x7fc00000u | frame.view);
    let meta_word = word(RECORD_META, i);
    let fate = meta_word & FATE_MASK;
    let orders = meta_word >> 16u;
    switch frame.view {
        case VIEW_REDSHIFT: {
            if orders != 0u {
                return number(RECORD_CROSSINGS + 1u, i);
            }
            if fate == FATE_ESCAPED {
                return number(RECORD_SKY_REDSHIFT, i);
            }
            return nothing;
        }
        case VIEW_ORDER: {
            if orders != 0u {
                return f32(firstTrailingBit(orders));
            }
            if fate == FATE_ESCAPED {
                return -1.0;
            }
            if fate == FATE_CAPTURED {
                return -2.0;
            }
            return nothing;
        }
        case VIEW_DEFLECTION: {
            if fate != FATE_ESCAPED {
                return nothing;
            }
            let place = vec2<f32>(pass_.origin + vec2<i32>(pixel)) + pass_.offset;
            let n = camera_look(place.x, place.y);
            let look = frame.e_r.xyz * n.x + frame.e_theta.xyz * n.y + frame.e_phi.xyz * n.z;
            let d = direction(i);
            return arctan2(length(cross(look, d)), dot(look, d));
        }
        case VIEW_STEPS: {
            return f32(word(RECORD_STEPS, i));
        }
        default: {
            let u = number(RECORD_PLANE, i);
            if u == 0.0 {
                return nothing;
            }
            return 1.0 - 2.0 * u;
        }
    }
}
