// SPDX-License-Identifier: MIT OR Apache-2.0
// The ray record of a pixel: the one interface between lensing and shading. Its counterpart is src/scene/record.rs,
// where crossings and media are members; here the functions below give them one by one. A file of traced/, lens/ or
// refine/ makes the records of a kernel, and declares those of these functions that the kernel calls:
//
//     fn ray_record(id: vec2<u32>) -> Record   gives the record of the tile's pixel `id`;
//     fn with_sky(record: Record) -> Record    gives that record, whose ray escapes, with the sky's direction and
//                                              footprint: many a pixel shows no sky, and need not find them;
//     fn next_crossing() -> Crossing           gives its next crossing of the plane at which something shines, nearest
//                                              to the observer first;
//     fn more_crossings() -> bool              says whether next_crossing may give one more;
//     fn medium_before(k: u32) -> vec4<f32>    gives the medium (emit/medium.wgsl) before crossing k of those given,
//                                              counted from 0, or behind the last of them; only with VOLUMES;
//     fn rewind_crossings()                    makes next_crossing begin again with the first (refine/ reads twice);
//     fn defer_pixel(id: vec2<u32>)            leaves a pixel whose record is FATE_PENDING to a later kernel;
//     fn edges_of_pixel(through: f32, turn: f32) -> u32
//                                              says which edge, EDGE_*, runs through the pixel of the record, once its
//                                              crossings have been given as far as they are seen; `through` is the
//                                              share of the light from behind that matter lets pass, `turn` is turn_of
//                                              of the record where its sky is seen, else 0.
//
// The fragment that uses records declares take_record, and shading declares seen_crossing, seen_emission
// and seen_sky.

#import constants
#import shared/fate
#import shared/frame
#import shared/math

// Where and when the light of a crossing left, or the change of it from pixel to pixel.
struct EmissionPoint {
    ln_r: f32,
    azimuth: f32,
    delay: f32,
}

struct Record {
    // FATE_*.
    fate: u32,
    // Integration steps spent on the pixel.
    steps: u32,
    // E, and L_z in M, scaled so that the observer of the local frame measures frequency 1.
    energy: f32,
    angular_momentum: f32,
    // |p_theta| at the plane, which is sqrt(Q), M, of light that has frequency 1 at the camera (src/scene/record.rs).
    polar_momentum: f32,
    // 1/r of the first crossing of the plane, even where nothing shines; 0 without one. Set for VIEW_METRIC only.
    plane_u: f32,
    // nu(camera) / nu(at infinity), whether the ray goes there or not; 0 of captured rays in traced/record.wgsl.
    sky_redshift: f32,
    // The direction in which the ray escapes, a unit vector in chart axes (z along the spin), and its footprint;
    // with_sky sets both.
    sky: vec3<f32>,
    footprint: Footprint,
}

// A direction's change from a pixel to its neighbour on the right (dx) and below (dy), rad, as components along p and
// q; these and the direction are unit vectors at right angles to each other. 1e30 where the change is not known.
struct Footprint {
    p: vec3<f32>,
    q: vec3<f32>,
    dx: vec2<f32>,
    dy: vec2<f32>,
}

const UNKNOWN_FOOTPRINT: Footprint = Footprint(vec3<f32>(0.0), vec3<f32>(0.0), vec2<f32>(1e30), vec2<f32>(1e30));

// The footprint of changes at right angles to the unit vector `d`. (The basis is that of Duff et al. 2017.)
fn footprint_of(d: vec3<f32>, dx: vec3<f32>, dy: vec3<f32>) -> Footprint {
    let sense = select(-1.0, 1.0, d.z >= 0.0);
    let a = -1.0 / (sense + d.z);
    let b = d.x * d.y * a;
    let p = vec3<f32>(1.0 + sense * d.x * d.x * a, sense * b, -sense * d.x);
    let q = vec3<f32>(b, sense + d.y * d.y * a, -d.y);
    return Footprint(p, q, vec2<f32>(dot(dx, p), dot(dx, q)), vec2<f32>(dot(dy, p), dot(dy, q)));
}

// A crossing of the equatorial plane where something shines.
struct Crossing {
    // 1/r, in 1/M; 0 when there is no further crossing.
    u: f32,
    // nu(camera) / nu(the matter there).
    g: f32,
    // The number of the crossing along the ray, from 0.
    order: u32,
    // The place and time at which the light left; azimuth and delay are 0 where shading does not need them.
    place: EmissionPoint,
    // With FOOTPRINTS: change to the next pixel right and down.
    dx: EmissionPoint,
    dy: EmissionPoint,
    // How much of the pixel, or of a sample's cell of it, the disk covers here, 0 .. 1; shading sets it.
    share: f32,
}

// The place of a crossing whose azimuth is known, chart.
fn crossing_place(crossing: Crossing) -> vec3<f32> {
    let turn = sincos(crossing.place.azimuth);
    return vec3<f32>(turn.y, turn.x, 0.0) / crossing.u;
}

// The crossing with place and footprint of the light that leaves about 1/r = u (Crossing::lit_about of
// src/emit/crossing.rs).
fn lit_about(crossing: Crossing, u: f32, extent: f32) -> Crossing {
    let dx = crossing.dx;
    let dy = crossing.dy;
    let ln_r = -log(u);
    // Where either side is unknown (1e30), only ln r of the place is set. The cap keeps its square finite in f32.
    let steps = min(abs(vec2<f32>(dx.ln_r, dy.ln_r)), vec2<f32>(UNKNOWN_STEP));
    let steepness = dot(steps, steps);
    let known = steepness > 0.0 && max(steps.x, steps.y) < UNKNOWN_STEP;
    if !known {
        var there = crossing;
        there.place.ln_r = ln_r;
        return there;
    }
    let per_step = 1.0 / steepness;
    let way = per_step * (ln_r - crossing.place.ln_r);
    let less = per_step * (extent - 1.0);
    let azimuth = dx.ln_r * dx.azimuth + dy.ln_r * dy.azimuth;
    let delay = dx.ln_r * dx.delay + dy.ln_r * dy.delay;
    var lit = crossing;
    lit.place = EmissionPoint(ln_r, crossing.place.azimuth + way * azimuth, crossing.place.delay + way * delay);
    lit.dx = EmissionPoint(extent * dx.ln_r, dx.azimuth + less * azimuth * dx.ln_r, dx.delay + less * delay * dx.ln_r);
    lit.dy = EmissionPoint(extent * dy.ln_r, dy.azimuth + less * azimuth * dy.ln_r, dy.delay + less * delay * dy.ln_r);
    return lit;
}

// Its straight distance from the camera, M.
fn crossing_distance(crossing: Crossing) -> f32 {
    return length(crossing_place(crossing) - frame.eye.xyz);
}

// Whether an edge of the disk that shows runs through a pixel whose ray crosses the plane at 1/r = u, or u changes so
// steeply there that one ray is not enough. `change` is the change of u to the next pixel right and below.
fn near_disk_edge(u: f32, change: vec2<f32>) -> bool {
    let far = frame.disk_u.x;
    let near = frame.disk_u.y;
    // Without a disk, whose edges are (1, 0) then, there are none.
    let sum = select(0.0, abs(change.x) + abs(change.y), far <= near);
    let steep = u >= far && u <= near && sum > steep_change(u);
    let through = abs(vec2<f32>(u) - frame.disk_u) < vec2<f32>(EDGE_REACH * sum);
    return steep || any(through & (vec2<f32>(sum) >= frame.shown_edges));
}

// The change of u to the next pixels above which the light of a crossing is not that at the pixel's centre (is_steep).
fn steep_change(u: f32) -> f32 {
    let dark_u = 1.0 / abs(frame.signed_isco);
    let dim = max(DIM_CHANGE * (dark_u - u), LEAST_DIM_CHANGE * dark_u);
    return min(STEEP_CHANGE * u, select(1e30, dim, u < dark_u && frame.plunge_isco <= 0.0));
}

// Lookups take sin d / (change of d per pixel) for the distance from the critical curve in pixels, d being the angle
// from the curve. Beyond 90 degrees sin d falls again, as if the curve were near; this factor, 1 / sin d there and 1
// elsewhere, undoes that. t = tan(d / 2).
fn beyond_right_angle(t: f32) -> f32 {
    let most = max(abs(t), 1.0);
    return 0.5 * (most + 1.0 / most);
}

// The edge, EDGE_*, that runs through a looked-up pixel `curve` pixels from the critical curve; `turn` is turn_of.
fn looked_up_edge(on_edge: bool, turn: f32, curve: f32, through: f32) -> u32 {
    let kind = max(select(EDGE_NONE, EDGE_DISK, on_edge), select(EDGE_NONE, turning_edge(turn), through > 0.0));
    return select(kind, EDGE_CURVE, through > 0.0 && curve < CURVE_REACH);
}

// The edge of a pixel whose sky direction turns by so much to the next pixels.
fn turning_edge(turn: f32) -> u32 {
    return select(select(EDGE_NONE, EDGE_DISK, turn > TURN), EDGE_CURVE, turn > FAST_TURN);
}

// The turn of the sky direction to the next pixels, rad; 0 where the ray does not escape.
fn turn_of(record: Record) -> f32 {
    // A turn that is not known counts as a fast one.
    let dx = min(abs(record.footprint.dx), vec2<f32>(1e6));
    let dy = min(abs(record.footprint.dy), vec2<f32>(1e6));
    return select(0.0, sqrt(dot(dx, dx) + dot(dy, dy)), record.fate == FATE_ESCAPED);
}

// Whether anything shines in the plane, whether shading needs the footprint of crossings, and whether emitters with
// depth lie between crossings.
override PLANE: bool = true;
override FOOTPRINTS: bool = true;
// Whether their places are needed, without that.
override PLACES: bool = false;
override VOLUMES: bool = false;
// WHOLE_PLANE: the kernel can make next_crossing give crossings where nothing shines, too; it does while whole_plane.
override WHOLE_PLANE: bool = false;
var<private> whole_plane: bool;

// Whether next_crossing gives one at u.
fn is_wanted(u: f32) -> bool {
    return (WHOLE_PLANE && whole_plane && u > 0.0) || (u >= frame.plane_u.x && u <= frame.plane_u.y);
}
