//! Reads the ray records that records/export.wgsl wrote. Knows the layout of one record, nothing of frames.

use crate::physics::trace::Fate;
use crate::scene::record::{DiskCrossing, Record};
use crate::scene::refine::Edge;
use crate::scene::turbulence::Place;
use glam::DVec3;

pub(super) const CROSSINGS: usize = 4;
pub(super) const VECTORS: usize = 4 + 3 * CROSSINGS;
/// Bytes of a record.
pub const EXPORT_BYTES: u64 = 16 * VECTORS as u64;

/// The record in `bytes`, EXPORT_BYTES of them.
pub fn imported(bytes: &[u8]) -> Record {
    let mut v = [[0.0_f64; 4]; VECTORS];
    for (out, word) in v.as_flattened_mut().iter_mut().zip(bytes.chunks_exact(4)) {
        *out = bytemuck::pod_read_unaligned::<f32>(word).into();
    }
    let [[fate, steps, count, plane_u], [x, y, z, redshift], [xx, xy, xz, energy], [yx, yy, yz, momentum], rest @ ..] =
        v;
    let fate = match fate as u32 {
        0 => Fate::Captured,
        1 => Fate::Escaped,
        2 => Fate::Unresolved,
        _ => Fate::Hidden,
    };
    let place = |[ln_r, azimuth, delay, _]: [f64; 4]| Place { ln_r, azimuth, delay };
    let crossing = |[at, dx, dy]: &[[f64; 4]; 3]| DiskCrossing {
        u: dx[3],
        order: at[3] as u32,
        g: dy[3],
        place: place(*at),
        footprint: [place(*dx), place(*dy)],
        share: 1.0,
    };
    Record {
        fate,
        direction: DVec3::new(x, y, z),
        footprint: [DVec3::new(xx, xy, xz), DVec3::new(yx, yy, yz)],
        sky_redshift: if fate == Fate::Escaped { redshift } else { f64::NAN },
        energy,
        angular_momentum: momentum,
        steps: steps as u32,
        plane_u,
        inside: 0,
        edge: Edge::None,
        crossings: rest.as_chunks().0.iter().take(count as usize).map(crossing).collect(),
    }
}
