// SPDX-License-Identifier: MIT OR Apache-2.0
// Ray records about a hole without spin, looked up in the tables of lens/schwarzschild.wgsl. Mirrors
// src/physics/lens/schwarzschild.rs, src/physics/lens/plane.rs and src/cpu/lens.rs.

#import constants
#import camera/observer
#import camera/projection
#import geodesic/geodesic
#import lens/axis
#import lens/media
#import lens/schwarzschild
#import records/record
#import shared/frame
#import shared/math
#import shared/pass

// Binding 0 is that of lens/media.wgsl.
@group(1) @binding(1) var<uniform> lens: SchwarzschildLens;
// Filled by lens/schwarzschild_columns.wgsl, which has the layouts: the swept angle by (node, branch); u and the
// delay's integral by (node, interval, branch).
@group(1) @binding(2) var lens_swept: texture_2d<f32>;
@group(1) @binding(3) var lens_u: texture_2d_array<f32>;
@group(1) @binding(4) var lens_delay: texture_2d_array<f32>;

// The results of ray_record that the later calls for the same pixel use.
struct Lookup {
    // Look direction in the local frame, and nu(camera) / nu(local frame).
    seen: LookDirection,
    branch: u32,
    place: AxisPosition,
    // The angle about the hole from the observer to the end of the ray, rad.
    swept: f32,
    // The angle from the observer to the ray's first crossing of the plane, rad.
    first: f32,
    // The number of the next crossing.
    order: u32,
    // d(swept) / d(place), place being the coordinate in nodes, and d(place) / d(psi).
    swept_slope: f32,
    slope: f32,
    // From this pixel to the next right and below: the change of place, and the angle by which the ray's plane turns
    // about e_r, rad.
    change: vec2<f32>,
    turn: vec2<f32>,
    // d(first crossing's angle) / d(turn): the same for every crossing.
    first_slope: f32,
    // Whether an edge of the disk runs through the pixel at a crossing given so far.
    on_edge: bool,
    // The factor beyond_right_angle of records/record.wgsl.
    beyond: f32,
    // The tangential unit vector in the ray's plane, (e_theta, e_phi). Vectors in the chart are worked out of it where
    // they are used: kept, they would take registers while a crossing is shaded.
    tangent: vec2<f32>,
}

var<private> lookup: Lookup;

// The unit vector that spans the ray's plane together with e_r, chart.
fn along_plane() -> vec3<f32> {
    return frame.e_theta.xyz * lookup.tangent.x + frame.e_phi.xyz * lookup.tangent.y;
}

// The unit vector across the ray's plane, chart.
fn across_plane() -> vec3<f32> {
    return frame.e_phi.xyz * lookup.tangent.x - frame.e_theta.xyz * lookup.tangent.y;
}

fn ray_record(id: vec2<u32>) -> Record {
    set_media_pixel(id);
    let at = pixel_place(id);
    let view = camera_view(at.x, at.y);
    let seen = aberrate(view.look);
    let n = seen.n;
    let energy = local_energy(n);
    // Below, only the components of these changes at right angles to n count.
    let dx = aberrate_change(seen, view.dx);
    let dy = aberrate_change(seen, view.dy);

    // n is (n_r, n_theta, n_phi), and the hole lies towards -e_r: cos psi = -n.x; s is sin psi.
    let s2 = dot(n.yz, n.yz);
    let s = sqrt(s2);
    let t = lens_tangent(-n.x, s2, lens.critical.x);
    let escaped = t > 0.0;
    let t_hat = max(abs(t) / lens.critical.w, exp2(-LENS_OCTAVES));
    let branch = select(1u, 0u, escaped);
    let nodes = select(lens.inner_nodes, lens.outer_nodes, escaped);
    let has_column = nodes > 2u && energy > 0.0;
    let place = axis_position(t_hat, LENS_OCTAVES, f32(LENS_PER_OCTAVE), max(nodes, 3u) - 3u);
    let ends = textureLoad(lens_swept, vec2<u32>(place.node, branch), 0);
    let swept = select(0.0, dot(lagrange(place.share), ends), has_column);
    let swept_slope = dot(lagrange_slope(place.share), ends);
    // d(place) / d(psi); 1 / ln 2 = 1.4427.
    let slope = f32(LENS_PER_OCTAVE) * 0.7213475204444817 * (1.0 + t * t)
        / (select(-t_hat, t_hat, escaped) * lens.critical.w);

    let tangent = select(vec2<f32>(1.0, 0.0), n.yz / s, s > 0.0);
    let d_psi = vec2<f32>(s * dx.x - n.x * dot(tangent, dx.yz), s * dy.x - n.x * dot(tangent, dy.yz));
    let d_across = vec2<f32>(tangent.x * dx.z - tangent.y * dx.y, tangent.x * dy.z - tangent.y * dy.y);
    lookup.seen = seen;
    lookup.branch = branch;
    lookup.place = place;
    lookup.swept = swept;
    lookup.order = 0u;
    lookup.swept_slope = swept_slope;
    lookup.slope = slope;
    lookup.change = slope * d_psi;
    lookup.turn = d_across / max(s, 1e-6);
    lookup.tangent = tangent;
    lookup.first = first_crossing_angle(tangent.x);
    lookup.on_edge = false;
    lookup.beyond = beyond_right_angle(t);
    if PLANE {
        // The crossing moves so that N_z stays 0: dphi = -sin(phi) dT_z / N_z' (OrbitPlane::phi_change). That is the
        // same for every crossing, because sin(phi) and N_z' change sign together from one to the next.
        let turn = sincos(min(lookup.first, PI));
        let rise = along_plane().z * turn.y - frame.e_r.z * turn.x;
        lookup.first_slope = -across_plane().z * turn.x / rise;
    }

    // L = r sin(theta) p_phi, p = -n.
    let momentum = -frame.observer_sine * n.z / frame.observer_u;
    let polar = polar_momentum(begin_local(n), seen.frequency_ratio);
    let fate = select(FATE_CAPTURED, FATE_ESCAPED, escaped);
    let g = seen.frequency_ratio / energy;
    return Record(fate, 0u, energy, momentum, polar, 0.0, g, vec3<f32>(0.0), UNKNOWN_FOOTPRINT);
}

fn with_sky(record: Record) -> Record {
    let turn = sincos(lookup.swept);
    let e_r = frame.e_r.xyz;
    var whole = record;
    let plane = along_plane();
    whole.sky = e_r * turn.y + plane * turn.x;
    // The sky direction changes by d(swept) in the ray's plane, and across it by sin(swept) / sin(psi) times the change
    // of look direction, which is sin(swept) times the turn of the plane. For rays that leave radially both sines
    // vanish: the limit of their ratio is -d(swept) / d(psi).
    let sine = length(lookup.seen.n.yz);
    let radial = sine < 1e-3 && lookup.seen.n.x > 0.0;
    let across = select(turn.x, -lookup.swept_slope * lookup.slope * max(sine, 1e-6), radial) * lookup.turn;
    let along = lookup.swept_slope * lookup.change;
    whole.footprint = Footprint(plane * turn.y - e_r * turn.x, across_plane(), vec2<f32>(along.x, across.x),
        vec2<f32>(along.y, across.y));
    return whole;
}

// E of light along the look direction n that the local frame's observer measures at frequency 1: the lapse; in the
// rain frame 1 - sqrt(2 u) cos psi. If it is not above 0, no light comes from there.
fn local_energy(n: vec3<f32>) -> f32 {
    return select(frame.lapse, 1.0 + frame.lapse * n.x, frame.rain != 0u);
}

// The angle phi in (0, pi] at which the ray first crosses the plane: the first zero of N_z = cos(theta) cos(phi) -
// sin(theta) n_theta sin(phi), n_theta being of the unit tangent. 1e30 for a ray that lies in the plane.
fn first_crossing_angle(n_theta: f32) -> f32 {
    let sine = frame.observer_sine;
    let cosine = frame.observer_cosine;
    let angle = arctan2(abs(cosine), sine * n_theta * sign(cosine));
    let in_plane = select(PI, 1e30, n_theta == 0.0);
    return select(angle, in_plane, cosine == 0.0);
}

fn next_crossing() -> Crossing {
    var crossing: Crossing;
    if !PLANE {
        return crossing;
    }
    if lookup.first >= lookup.swept {
        return crossing;
    }
    var phi = lookup.first + PI * f32(lookup.order);
    // The table of u at the crossing.
    var there = vec3<f32>(0.0);
    // The loop tests at its end: with a test at its start, Mesa's lavapipe runs the body once more than it should.
    // Lanes that have left go on writing there, too, so nothing is written once a crossing has been found.
    loop {
        let at = column_at(lens_u, phi / max(lookup.swept, 1e-6));
        let u = at.x;
        let comes = phi < lookup.swept && lookup.order < frame.max_crossings;
        if comes && crossing.u <= 0.0 {
            lookup.on_edge = lookup.on_edge || near_disk_edge(u, u_change(at, phi));
        }
        if comes && is_wanted(u) && crossing.u <= 0.0 {
            crossing.u = u;
            crossing.order = lookup.order;
            there = at;
        }
        lookup.order += 1u;
        phi += PI;

        continuing {
            break if crossing.u > 0.0 || phi >= lookup.swept || lookup.order >= frame.max_crossings;
        }
    }
    if crossing.u > 0.0 {
        complete(&crossing, lookup.first + PI * f32(crossing.order), there);
    }
    return crossing;
}

// Always true: whether there is a further crossing is known only after next_crossing has looked for it.
fn more_crossings() -> bool {
    return true;
}

// The change of u to the next pixel right and down, where the table of u has `at` at the crossing `phi`.
fn u_change(at: vec3<f32>, phi: f32) -> vec2<f32> {
    let y = phi / lookup.swept;
    return at.y * lookup.change
        + at.z * ((lookup.turn * lookup.first_slope - y * lookup.swept_slope * lookup.change) / lookup.swept);
}

// A table's value at the record's place and y = phi / swept, 0 .. 1, then d/d(place) and d/dy. Interpolation is cubic:
// Lagrange over nodes, Hermite over y.
fn column_at(columns: texture_2d_array<f32>, y: f32) -> vec3<f32> {
    let scaled = clamp(y, 0.0, 1.0) * f32(LENS_INTERVALS);
    let j = min(u32(scaled), LENS_INTERVALS - 1u);
    let x = scaled - f32(j);
    let weights = lagrange(lookup.place.share);
    let slopes = lagrange_slope(lookup.place.share);
    var value = vec4<f32>(0.0);
    var change = vec4<f32>(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        let node = max(lookup.place.node + i, 1u) - 1u;
        let ends = textureLoad(columns, vec2<u32>(node, j), lookup.branch, 0);
        value += ends * weights[i];
        change += ends * slopes[i];
    }
    // Hermite's base at x; slopes are by y, intervals 1 / LENS_INTERVALS long.
    const H: f32 = 1.0 / f32(LENS_INTERVALS);
    let x1 = 1.0 - x;
    let base = vec4<f32>(x1 * x1 * (1.0 + 2.0 * x), x * x1 * x1 * H, x * x * (3.0 - 2.0 * x), -x * x * x1 * H);
    let base_slope = vec4<f32>(-6.0 * x * x1 / H, x1 * (1.0 - 3.0 * x), 6.0 * x * x1 / H, x * (3.0 * x - 2.0));
    return vec3<f32>(dot(value, base), dot(change, base), dot(value, base_slope));
}

// `at`: the table of u at the crossing.
fn complete(crossing: ptr<function, Crossing>, phi: f32, at: vec3<f32>) {
    let begin = begin_local(lookup.seen.n);
    let c = begin.c;
    let u = (*crossing).u;
    (*crossing).g = lookup.seen.frequency_ratio * redshift_of(c, u);
    if !FOOTPRINTS && !PLACES {
        return;
    }
    let turn = sincos(phi);
    let along = along_plane();
    let n = frame.e_r.xyz * turn.y + along * turn.x;
    let tangent = along * turn.y - frame.e_r.xyz * turn.x;
    // du/dtau.
    let kappa = sqrt(c.k);
    let du = at.z / lookup.swept * kappa;
    (*crossing).place = EmissionPoint(-log(u), arctan2(n.y, n.x), 0.0);
    if DELAY {
        let integral = column_at(lens_delay, phi / lookup.swept).x;
        (*crossing).place.delay = retardation(c, frame.observer_u, begin.state.du, u, du, integral);
    }
    if !FOOTPRINTS {
        return;
    }
    // How far a turn of the ray's plane moves the crossing around the disk, and how far the next pixel moves it.
    let across = across_plane();
    let swing = (n.x * across.y - n.y * across.x) * turn.x;
    let around = n.x * tangent.y - n.y * tangent.x;
    let rho2 = n.x * n.x + n.y * n.y;
    let phi_change = lookup.turn * lookup.first_slope;
    let azimuth_change = (lookup.turn * swing + phi_change * around) / rho2;
    let du_change = u_change(at, phi);
    // The gradient of the travel time at the emission point is the photon's momentum over E (Hamilton-Jacobi):
    // sqrt(K) / E along phi, and du/dtau / (u^2 (1 - 2 u) E) along u.
    var delay_change = vec2<f32>(0.0);
    if DELAY {
        delay_change = (kappa * phi_change + du / (u * u * (1.0 - 2.0 * u)) * du_change) / c.energy;
    }
    (*crossing).dx = EmissionPoint(-du_change.x / u, azimuth_change.x, delay_change.x);
    (*crossing).dy = EmissionPoint(-du_change.y / u, azimuth_change.y, delay_change.y);
}

fn edges_of_pixel(through: f32, turn: f32) -> u32 {
    // The distance from the critical curve in pixels, as d(place) = LENS_PER_OCTAVE / ln 2 (dt / t).
    let curve = lookup.beyond * f32(LENS_PER_OCTAVE) * 1.4426950408889634 / max(length(lookup.change), 1e-30);
    return looked_up_edge(lookup.on_edge, turn, curve, through);
}

// Makes next_crossing begin again with the first crossing.
fn rewind_crossings() {
    lookup.order = 0u;
}

// Without spin the difference of two samples' directions tells by how much they turn.
fn sample_turn() -> f32 {
    return UNKNOWN_TURN;
}

// No record is pending here.
fn defer_pixel(id: vec2<u32>) {
}
