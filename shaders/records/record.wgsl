// The ray record of a pixel: the one interface between lensing and shading. src/scene/record.rs has the same fields.
// However records are made, the fragment that makes them (one of traced/, lens/ or refine/) declares
//
//     fn ray_record(id: vec2<u32>) -> Record   gives the record of the tile's pixel `id`;
//     fn next_crossing() -> Crossing           gives its crossings one by one, front to back, where emitters shine;
//     fn more_crossings() -> bool              says whether next_crossing may give one more;
//     fn medium_before(k: u32) -> vec4<f32>    gives, with VOLUMES, the medium (emit/medium.wgsl) before the crossing
//                                              given as number k, or behind the last if k is their count;
//     fn rewind_crossings()                    begins with the first crossing again (for samples);
//     fn defer_pixel(id: vec2<u32>)            leaves a pixel whose record is FATE_PENDING to a later kernel;
//     fn edges_of_pixel(through: f32) -> u32   says which edge, EDGE_*, runs through the pixel, once its crossings have
//                                              been given; `through` is the share of the light behind the disk
//                                              that the disk lets pass.
//
// The fragment that uses records declares take_record, and shading declares seen_crossing.

#import constants
#import shared/frame

// Where and when the light of a crossing left, or the change of it from pixel to pixel.
struct EmissionPoint {
    ln_r: f32,
    azimuth: f32,
    delay: f32,
}

struct Record {
    fate: u32,
    // Integration steps spent on the pixel.
    steps: u32,
    // E and L, scaled so that the local frame's observer measures 1.
    energy: f32,
    angular_momentum: f32,
    // 1/r of the first crossing of the plane wherever it is, 0 without one; in the METRIC view only.
    plane_u: f32,
    // nu(camera) / nu(at infinity); 0 unless escaped.
    sky_redshift: f32,
    // Sky direction, chart, and its footprint.
    sky: vec3<f32>,
    footprint: Footprint,
}

// Changes of a unit vector to the next pixel right and down, in two unit vectors at right angles to it and to each
// other; 1e30 where nothing is known.
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

// A crossing where emitters shine; u is 0 when there is no further one.
struct Crossing {
    u: f32,
    g: f32,
    order: u32,
    // ln_r; azimuth and delay where shading needs them, else 0.
    place: EmissionPoint,
    // With FOOTPRINTS: change to the next pixel right and down.
    dx: EmissionPoint,
    dy: EmissionPoint,
    // How much of the pixel, or of a sample's cell of it, the disk covers here, 0 .. 1; shading sets it.
    share: f32,
}

// Whether an edge of the disk runs through the pixel whose crossing lies at u, or u changes steeply there; `change`:
// of u to the next pixel right and down.
fn near_disk_edge(u: f32, change: vec2<f32>) -> bool {
    let far = frame.disk_u.x;
    let near = frame.disk_u.y;
    // Without a disk, whose edges are (1, 0) then, there are none.
    let sum = select(0.0, abs(change.x) + abs(change.y), far <= near);
    let steep = u >= far && u <= near && sum > STEEP_CHANGE * u;
    return steep || abs(u - far) < EDGE_REACH * sum || abs(u - near) < EDGE_REACH * sum;
}

// The factor by which d ln |t| by pixel, t = tan of half the angle from the critical curve, is too large beyond 90
// degrees from the curve, whose antipode is not near it.
fn beyond_right_angle(t: f32) -> f32 {
    let most = max(abs(t), 1.0);
    return 0.5 * (most + 1.0 / most);
}

// EDGE_* of a looked-up pixel that lies `curve` pixels from the critical curve; the rings lie outside it.
fn looked_up_edge(on_edge: bool, curve: f32, outside: bool, through: f32) -> u32 {
    let near_ring = PLANE && outside && through > 0.0 && curve < RINGS_REACH;
    let kind = select(EDGE_NONE, EDGE_DISK, on_edge || near_ring);
    return select(kind, EDGE_CURVE, through > 0.0 && curve < CURVE_REACH);
}

// Whether anything shines in the plane, whether shading needs the footprint of crossings, and whether emitters with
// depth lie between crossings.
override PLANE: bool = true;
override FOOTPRINTS: bool = true;
override VOLUMES: bool = false;
// Whether next_crossing can give crossings of the plane where nothing shines as well, and whether it is to.
override WHOLE_PLANE: bool = false;
var<private> whole_plane: bool;

// Whether next_crossing gives one at u.
fn is_wanted(u: f32) -> bool {
    return (WHOLE_PLANE && whole_plane && u > 0.0) || (u >= frame.plane_u.x && u <= frame.plane_u.y);
}
