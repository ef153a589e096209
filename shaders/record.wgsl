// The ray record of a pixel: the one interface between lensing and shading. src/scene/record.rs has the same fields. However it was
// made, whoever makes records (traced.wgsl, lens_*.wgsl) defines
//
//     fn ray_record(id: vec2<u32>) -> Record      of the tile's pixel `id`
//     fn next_crossing() -> Crossing              of that record, front to back, within the disk's radii
//     fn defer_pixel(id: vec2<u32>)               leaves a pixel whose record is FATE_PENDING to a later kernel
//
// and whoever uses them
//
//     fn take_record(id: vec2<u32>, record: Record)

// Where and when the light of a crossing left, or the change of it from pixel to pixel.
struct Place {
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
    // Sky direction, chart, and its change to the next pixel right and down; 1e30 where it has none.
    sky: vec3<f32>,
    sky_dx: vec3<f32>,
    sky_dy: vec3<f32>,
}

// A crossing within the disk's radii; u is 0 when there is no further one.
struct Crossing {
    u: f32,
    g: f32,
    order: u32,
    // ln_r; azimuth and delay where shading needs them, else 0.
    place: Place,
    // With FOOTPRINTS: change to the next pixel right and down.
    dx: Place,
    dy: Place,
}

// Whether there is a disk, and whether shading needs the footprint of crossings.
override DISK: bool = true;
override FOOTPRINTS: bool = true;
