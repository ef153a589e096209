// SPDX-License-Identifier: MIT OR Apache-2.0
// Looks rays up in the tables of lens/kerr.wgsl. Mirrors src/physics/lens/kerr/ and src/cpu/lens.rs.

#import constants
#import camera/observer
#import camera/projection
#import geodesic/geodesic
#import lens/axis
#import lens/kerr
#import records/record
#import shared/fate
#import shared/frame
#import shared/math
#import shared/pass

// Binding 0 is that of lens/media.wgsl.
@group(1) @binding(1) var<uniform> lens: KerrLens;
// First row: T = tan(R / 2) and dT/dchi at a node, and at the next, evenly in chi.
@group(1) @binding(2) var kerr_curve: texture_2d<f32>;
@group(1) @binding(3) var kerr_sky: texture_2d<f32>;
@group(1) @binding(4) var kerr_crossings: texture_2d_array<f32>;
@group(1) @binding(5) var kerr_flags: texture_2d<u32>;
@group(1) @binding(6) var<storage, read_write> deferred: Deferred;

// Pixels whose rays are to be integrated.
struct Deferred {
    // Steps of all rays integrated so far.
    steps: atomic<u32>,
    // The number of pixels of each sample of the submission.
    counts: array<atomic<u32>, 16>,
    // x in the low half, y in the high half.
    pixels: array<u32>,
}

// The record at hand: what its crossings need.
struct Lookup {
    seen: LookDirection,
    cell: vec2<u32>,
    // The flags without those of crossings that were given already.
    flags: u32,
    all_flags: u32,
    // Whether an edge of the disk runs through the pixel at a crossing given so far.
    on_edge: bool,
    // beyond_right_angle(t).
    beyond: f32,
    // The place in the cell, as shares of the way to the next column and to the next row. Weights of interpolation are
    // worked out anew for each layer: kept, they would take registers while a crossing is shaded.
    shares: vec2<f32>,
    // d(column), d(row) from this pixel to the next right and down.
    dx: vec2<f32>,
    dy: vec2<f32>,
}

var<private> lookup: Lookup;

// FATE_PENDING: not in the tables; what they hold is nearly right all the same.
fn look_up(id: vec2<u32>) -> Record {
    let at = pixel_place(id);
    let view = camera_view(at.x, at.y);
    let seen = aberrate(view.look);
    let n = seen.n;
    let begin = begin_local(n);
    let energy = begin.c.energy / begin.c.nu_local;

    let cosine = dot(n, lens.k.xyz);
    let across = vec2<f32>(dot(n, lens.e1.xyz), dot(n, lens.e2.xyz));
    let sine2 = dot(across, across);
    let sine = sqrt(sine2);
    let chi = select(vec2<f32>(0.0, 1.0), across / sine, sine > 0.0);
    let epsilon = lens.k.w;
    let angle = arctan2(chi.x, chi.y);
    let half_tangent = critical_tangent(select(angle, angle + TAU, angle < 0.0) * (f32(KERR_CURVE) / TAU));
    let w = 0.5 * (angle + arctan2(chi.x, epsilon * chi.y));
    let w_slope = 0.5 + 0.5 * epsilon / (epsilon * epsilon * chi.y * chi.y + chi.x * chi.x);
    let around = select(w, w + TAU, w < 0.0) * (f32(KERR_COLUMNS) / TAU);
    let column = min(u32(around), KERR_COLUMNS - 1u);
    let t = lens_tangent(cosine, sine2, half_tangent.x);
    let inner = t <= 0.0;
    let t_hat = abs(t) / half_tangent.x;
    let rows = select(lens.outer_rows, lens.inner_rows, inner);
    let last = rows - 2u * KERR_ROWS_ABOVE;
    let place = axis_position(t_hat, KERR_OCTAVES, f32(KERR_PER_OCTAVE), last);

    lookup.seen = seen;
    lookup.cell = vec2<u32>(column, kerr_first_row(inner) + place.node + KERR_ROWS_BELOW);
    lookup.all_flags = textureLoad(kerr_flags, lookup.cell, 0).x;
    lookup.flags = lookup.all_flags;
    lookup.on_edge = false;
    lookup.beyond = beyond_right_angle(t);
    lookup.shares = vec2<f32>(around - f32(column), place.share);

    // d psi and d chi; dt = (1 + t^2) / 2 (d psi - dR), dR = 2 dT / (1 + T^2), d(row) = n / ln 2 (dt / t - dT / T).
    let outward = kerr_radial(chi.x, chi.y) * cosine - lens.k.xyz * sine;
    let along = (lens.e1.xyz * chi.y - lens.e2.xyz * chi.x) / max(sine, 1e-6);
    let slope_t = 0.5 * (1.0 + t * t) / select(-max(-t, 1e-12), max(t, 1e-12), t > 0.0);
    let slope_r = half_tangent.y * (slope_t * 2.0 / (1.0 + half_tangent.x * half_tangent.x) + 1.0 / half_tangent.x);
    const ROWS: f32 = f32(KERR_PER_OCTAVE) * 1.4426950408889634;
    // The components of these changes along n turn nothing.
    let grid_x = aberrate_change(seen, view.dx);
    let grid_y = aberrate_change(seen, view.dy);
    let chi_change = vec2<f32>(dot(along, grid_x), dot(along, grid_y));
    let row_change = ROWS * (slope_t * vec2<f32>(dot(outward, grid_x), dot(outward, grid_y)) - slope_r * chi_change);
    let column_change = chi_change * (w_slope * f32(KERR_COLUMNS) / TAU);
    lookup.dx = vec2<f32>(column_change.x, row_change.x);
    lookup.dy = vec2<f32>(column_change.y, row_change.y);

    var record = Record(FATE_CAPTURED, 0u, energy, begin.c.angular_momentum / begin.c.nu_local,
        polar_momentum(begin, seen.frequency_ratio), 0.0, seen.frequency_ratio / energy, vec3<f32>(0.0),
        UNKNOWN_FOOTPRINT);
    if !inner {
        record.fate = FATE_ESCAPED;
    }
    if t_hat < exp2(-KERR_OCTAVES) || (lookup.flags & KERR_DIRECT) != 0u {
        record.fate = FATE_PENDING;
    }
    return record;
}

// The record at hand, which lies outside the critical curve, with its sky as the tables have it.
fn with_looked_up_sky(record: Record) -> Record {
    let sky = interpolate(KERR_SKY_LAYER);
    let inverse = inverseSqrt(dot(sky.value.xyz, sky.value.xyz));
    let dx = (sky.by_column.xyz * lookup.dx.x + sky.by_row.xyz * lookup.dx.y) * inverse;
    let dy = (sky.by_column.xyz * lookup.dy.x + sky.by_row.xyz * lookup.dy.y) * inverse;
    var whole = record;
    whole.sky = sky.value.xyz * inverse;
    whole.footprint = footprint_of(whole.sky, dx, dy);
    return whole;
}

// tan(R / 2) and its derivative by chi at a place of the curve's own table: cubic Hermite.
fn critical_tangent(position: f32) -> vec2<f32> {
    let node = min(u32(position), KERR_CURVE - 1u);
    let x = position - f32(node);
    let ends = textureLoad(kerr_curve, vec2<u32>(node, 0u), 0);
    const H: f32 = TAU / f32(KERR_CURVE);
    let rise = ends.z - ends.x;
    let c2 = 3.0 * rise - H * (2.0 * ends.y + ends.w);
    let c3 = H * (ends.y + ends.w) - 2.0 * rise;
    return vec2<f32>(ends.x + x * (H * ends.y + x * (c2 + x * c3)), ends.y + x * (2.0 * c2 + 3.0 * x * c3) / H);
}

struct Interpolated {
    value: vec4<f32>,
    by_column: vec4<f32>,
    by_row: vec4<f32>,
}

const KERR_SKY_LAYER: u32 = 0xffffu;

// The value and the slopes of a layer of the crossings, or of the sky, at the record's place.
fn interpolate(layer: u32) -> Interpolated {
    let columns = lagrange(lookup.shares.x);
    let columns_slope = lagrange_slope(lookup.shares.x);
    let rows = lagrange(lookup.shares.y);
    let rows_slope = lagrange_slope(lookup.shares.y);
    var sum: Interpolated;
    for (var j = 0u; j < 4u; j += 1u) {
        let row = lookup.cell.y + j - 1u;
        var value = vec4<f32>(0.0);
        var slope = vec4<f32>(0.0);
        for (var i = 0u; i < 4u; i += 1u) {
            let place = vec2<u32>((lookup.cell.x + KERR_COLUMNS + i - 1u) % KERR_COLUMNS, row);
            var at: vec4<f32>;
            if layer == KERR_SKY_LAYER {
                at = textureLoad(kerr_sky, place, 0);
            } else {
                at = textureLoad(kerr_crossings, place, layer, 0);
            }
            value += at * columns[i];
            slope += at * columns_slope[i];
        }
        sum.value += value * rows[j];
        sum.by_row += value * rows_slope[j];
        sum.by_column += slope * rows[j];
    }
    return sum;
}

// The change of component `lane` to the next pixel right and down.
fn looked_up_change(at: Interpolated, lane: u32) -> vec2<f32> {
    let by = vec2<f32>(at.by_column[lane], at.by_row[lane]);
    return vec2<f32>(dot(by, lookup.dx), dot(by, lookup.dy));
}

fn edges_of_pixel(through: f32, turn: f32) -> u32 {
    // d(row) = KERR_PER_OCTAVE / ln 2 dt / t.
    let rows = length(vec2<f32>(lookup.dx.y, lookup.dy.y));
    let curve = lookup.beyond * f32(KERR_PER_OCTAVE) * 1.4426950408889634 / max(rows, 1e-30);
    return looked_up_edge(lookup.on_edge, turn, curve, through);
}

// The next crossing of the disk in the tables.
fn next_looked_up() -> Crossing {
    var crossing: Crossing;
    if !PLANE {
        return crossing;
    }
    var orders = lookup.flags & 0xffffu;
    var at: Interpolated;
    while orders != 0u && crossing.u <= 0.0 {
        let order = firstTrailingBit(orders);
        orders &= orders - 1u;
        at = interpolate(select(order / 4u, order, PATTERN));
        let lane = select(order % 4u, 0u, PATTERN);
        let u = at.value[lane];
        lookup.on_edge = lookup.on_edge || near_disk_edge(u, looked_up_change(at, lane));
        if is_wanted(u) && u <= kerr_reach_inwards(frame.plane_u.y * DISK_REACH_INWARDS) {
            crossing.u = u;
            crossing.order = order;
        }
    }
    lookup.flags = orders;
    if crossing.u > 0.0 {
        let c = begin_local(lookup.seen.n).c;
        crossing.g = lookup.seen.frequency_ratio * redshift_of(c, crossing.u);
    }
    if PATTERN && crossing.u > 0.0 {
        add_pattern(&crossing, at);
    }
    return crossing;
}

fn add_pattern(crossing: ptr<function, Crossing>, at: Interpolated) {
    let u = at.value.x;
    let delay = at.value.w + divergent_delay(u, frame.observer_u);
    (*crossing).place = EmissionPoint(-log(u), arctan2(at.value.z, at.value.y), select(0.0, delay, DELAY));
    if FOOTPRINTS {
        (*crossing).dx = place_change((*crossing).u, at, lookup.dx);
        (*crossing).dy = place_change((*crossing).u, at, lookup.dy);
    }
}

fn place_change(u: f32, at: Interpolated, change: vec2<f32>) -> EmissionPoint {
    let d = at.by_column * change.x + at.by_row * change.y;
    let turn = (at.value.y * d.z - at.value.z * d.y) / max(dot(at.value.yz, at.value.yz), 1e-6);
    return EmissionPoint(-d.x / u, turn, select(0.0, d.w - (1.0 / u + 2.0) * d.x / u, DELAY));
}
