// Kernel: ray records of a tile to linear radiance (or a view's value), one sample added to the sum. Mirrors src/cpu/shade.rs. How the
// records were made it does not know.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> pass_: Pass;
@group(0) @binding(2) var record_sky: texture_2d<f32>;
@group(0) @binding(3) var record_meta: texture_2d<u32>;
@group(0) @binding(4) var record_disk: texture_2d_array<f32>;
// Tables as textures, TABLE_WIDTH entries a row: software drivers reach into buffers lane by lane.
@group(0) @binding(5) var light_tables: texture_2d<f32>;
@group(0) @binding(6) var star_cells: texture_2d<u32>;
// Of the tile without its margin: the sum of the samples before, and with this one.
@group(0) @binding(7) var radiance_before: texture_2d<f32>;
@group(0) @binding(8) var radiance: texture_storage_2d<rgba32float, write>;

// What a pipeline is made for; the host compiles one for each combination it needs: lavapipe runs both sides of every `if`.
override SHOWS_LIGHT: bool = true;
override SHOWS_STARS: bool = true;
override TURBULENT: bool = true;

const TABLE_WIDTH: u32 = 2048u;

fn light_table(i: u32) -> vec4<f32> {
    return textureLoad(light_tables, vec2<u32>(i % TABLE_WIDTH, i / TABLE_WIDTH), 0);
}

fn star_cell(i: u32) -> u32 {
    return textureLoad(star_cells, vec2<u32>(i % TABLE_WIDTH, i / TABLE_WIDTH), 0).x;
}

const FATE_CAPTURED: u32 = 0u;
const FATE_ESCAPED: u32 = 1u;

@compute @workgroup_size(16, 8)
fn shade(@builtin(global_invocation_id) id: vec3<u32>) {
    let tile = pass_.size - 2u;
    if id.x >= tile.x || id.y >= tile.y {
        return;
    }
    let pixel = id.xy + 1u;
    let here = unpack_meta(textureLoad(record_meta, pixel, 0));
    if !SHOWS_LIGHT {
        textureStore(radiance, id.xy, vec4<f32>(view_value(here, pixel), 0.0, 0.0, 1.0));
        return;
    }
    var sum = pixel_light(here, pixel) * pass_.weight;
    if pass_.first == 0u {
        sum += textureLoad(radiance_before, id.xy, 0);
    }
    textureStore(radiance, id.xy, sum);
}

// d(sky direction) / d(pixel) along the neighbours at -+ step: central where both escaped, else one-sided; infinite where
// neither did, which only the mean sky can stand for.
fn derivative_of_direction(pixel: vec2<u32>, here: vec3<f32>, step: vec2<u32>) -> vec3<f32> {
    let before = textureLoad(record_sky, pixel - step, 0);
    let after = textureLoad(record_sky, pixel + step, 0);
    let has_before = before.w != 0.0;
    let has_after = after.w != 0.0;
    let first = select(here, before.xyz, has_before);
    let last = select(here, after.xyz, has_after);
    let difference = (last - first) * select(1.0, 0.5, has_before && has_after);
    return select(vec3<f32>(1e30), difference, has_before || has_after);
}

fn place(crossing: vec4<f32>) -> Place {
    return Place(-log(crossing.x), crossing.z, crossing.w);
}

// The crossing of the plane of this order, if it is the disk's; else 0.
fn crossing_of_order(pixel: vec2<u32>, order: u32) -> vec4<f32> {
    let orders = unpack_meta(textureLoad(record_meta, pixel, 0)).orders;
    if (orders & (1u << order)) == 0u {
        return vec4<f32>(0.0);
    }
    return textureLoad(record_disk, pixel, countOneBits(orders & ((1u << order) - 1u)), 0);
}

// d(place) / d(pixel) of a crossing, from the crossings of its order at -+ step, as derivative_of_direction.
fn derivative_of_place(pixel: vec2<u32>, here: vec4<f32>, order: u32, step: vec2<u32>) -> Place {
    let before = crossing_of_order(pixel - step, order);
    let after = crossing_of_order(pixel + step, order);
    let has_before = before.x > 0.0;
    let has_after = after.x > 0.0;
    if !has_before && !has_after {
        return Place(1e30, 0.0, 0.0);
    }
    let share = select(1.0, 0.5, has_before && has_after);
    let first = place(select(here, before, has_before));
    let last = place(select(here, after, has_after));
    let turn = wrap_angle(last.azimuth - first.azimuth);
    return Place(share * (last.ln_r - first.ln_r), share * turn, share * (last.delay - first.delay));
}

fn to_sky(d: vec3<f32>) -> vec3<f32> {
    return frame.sky_x.xyz * d.x + frame.sky_y.xyz * d.y + frame.sky_z.xyz * d.z;
}

fn pixel_light(here: RecordMeta, pixel: vec2<u32>) -> vec4<f32> {
    var light = vec3<f32>(0.0);
    var open = 1.0;
    let crossings = countOneBits(here.orders);
    var orders = here.orders;
    for (var slot = 0u; slot < crossings && open > 0.0; slot += 1u) {
        let crossing = textureLoad(record_disk, pixel, slot, 0);
        let u = crossing.x;
        var shift = Shift(crossing.y, crossing.y);
        if !ALL_EFFECTS {
            let gravity = nu_static_eye(here.energy) / nu_zamo_in_plane(u, here.energy, here.angular_momentum);
            shift = visible_shift(crossing.y, gravity);
        }
        var structure = 1.0;
        if TURBULENT {
            let order = firstTrailingBit(orders);
            orders &= orders - 1u;
            let dx = derivative_of_place(pixel, crossing, order, vec2<u32>(1u, 0u));
            let dy = derivative_of_place(pixel, crossing, order, vec2<u32>(0u, 1u));
            structure = turbulent_brightness(place(crossing), dx, dy);
        }
        light += open * frame.disk.z * structure * disk_light(u, shift);
        open *= 1.0 - frame.disk.z;
    }
    if SHOWS_STARS && here.fate == FATE_ESCAPED && open > 0.0 {
        light += open * sky_light(here, pixel);
    }
    return vec4<f32>(light, select(1.0, 1.0 - open, here.fate == FATE_ESCAPED));
}

fn sky_light(here: RecordMeta, pixel: vec2<u32>) -> vec3<f32> {
    let sky = textureLoad(record_sky, pixel, 0);
    let d = sky.xyz;
    let dx = derivative_of_direction(pixel, d, vec2<u32>(1u, 0u));
    let dy = derivative_of_direction(pixel, d, vec2<u32>(0u, 1u));
    var shift = Shift(sky.w, sky.w);
    if !ALL_EFFECTS {
        shift = visible_shift(sky.w, nu_static_eye(here.energy) / here.energy);
    }
    return star_light(to_sky(d), to_sky(dx), to_sky(dy), shift.colour, shift.beaming) * frame.sky_x.w;
}

// What BHR_VIEW_* shows; NaN where there is nothing.
fn view_value(here: RecordMeta, pixel: vec2<u32>) -> f32 {
    // NaN may not be written as a constant.
    let nothing = bitcast<f32>(0x7fc00000u | frame.view);
    let on_disk = here.orders != 0u;
    let sky = textureLoad(record_sky, pixel, 0);
    let in_sky = here.fate == FATE_ESCAPED;
    switch frame.view {
        case VIEW_REDSHIFT: {
            return select(select(nothing, sky.w, in_sky), textureLoad(record_disk, pixel, 0u, 0).y, on_disk);
        }
        case VIEW_ORDER: {
            let elsewhere = select(select(nothing, -2.0, here.fate == FATE_CAPTURED), -1.0, in_sky);
            return select(elsewhere, f32(firstTrailingBit(here.orders)), on_disk);
        }
        case VIEW_DEFLECTION: {
            let place = vec2<f32>(pass_.origin + vec2<i32>(pixel)) + pass_.offset;
            let n = camera_look(place.x, place.y);
            let look = frame.e_r.xyz * n.x + frame.e_theta.xyz * n.y + frame.e_phi.xyz * n.z;
            return select(nothing, arctan2(length(cross(look, sky.xyz)), dot(look, sky.xyz)), in_sky);
        }
        case VIEW_STEPS: {
            return f32(here.steps);
        }
        default: {
            // METRIC: -g_tt = 1 - 2/r in the plane.
            return select(nothing, 1.0 - 2.0 * here.energy, here.energy > 0.0);
        }
    }
}
