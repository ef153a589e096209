// SPDX-License-Identifier: MIT OR Apache-2.0
//! The star index: finds the stars near a direction with one lookup. A pyramid of cube maps; every cell lists the
//! stars within the cell enlarged by half its size on every side. Flat arrays, the same ones on the GPU.
//! `shaders/sky/stars.wgsl` has `cell_of` and `level_for` too.

use super::catalogue::Star;
use super::galaxy::{GALACTIC_POLE, crowded_density};
use super::shift::{SHIFT_SIZE, ShiftTable};
use crate::emit::free_spot::TABLE_NODES;
use crate::emit::hot_spot::HotSpot;
use crate::physics::blackbody::{BLACKBODY_SIZE, BlackbodyTable};
use glam::DVec3;
use std::f64::consts::PI;

/// Levels of the pyramid, finest first; each halves the cells of a cube side.
pub const STAR_LEVELS: u32 = 6;
/// Cells along a cube side at level 0.
pub const STAR_FINEST: u32 = 256;
/// Bend of the map from the plane of a cube side, u in [-1, 1], to cells, w = u (1 + k - k |u|): with (sqrt 3 - 1) /
/// (sqrt 3 + 1) the smallest search radius inside a side is as large as that in its corner.
pub const STAR_WARP: f64 = 0.268;
/// Search radius times the cells along a side: 1 / (1.268 sqrt 2) = 0.5577 for small cells, 0.5457 on the coarsest
/// level, less a little for rounding in f32.
pub const STAR_MARGIN: f64 = 0.545;

/// Display convention: a star of V = 0 has this radiance when its light is spread over REFERENCE_SOLID_ANGLE.
pub const STAR_REFERENCE_RADIANCE: f64 = 30.0;
/// (2 tan(30 degrees) / 720)^2 sr: the central pixel of a frame of 720 rows and 60 degrees.
pub const REFERENCE_SOLID_ANGLE: f64 =
    (2.0 * 0.577_350_269_189_625_8 / 720.0) * (2.0 * 0.577_350_269_189_625_8 / 720.0);

/// V of the faintest stars that the lists of each level hold. Beyond the last level there are none: wide pixels hold so
/// many faint stars that their mean light stands for them. With the number of stars in the real sky no list is long:
/// about 10 on average, with a million stars too.
pub(super) const FAINTEST: [f64; STAR_LEVELS as usize + 1] =
    [f64::INFINITY, 9.6, 8.3, 7.0, 5.5, 4.0, f64::NEG_INFINITY];

/// `light_tables` of the GPU begin with the blackbodies; then come, at these places, the mean skies' tables, room for
/// `PROFILE_SIZE` entries of the disk's and for the places of hot spots in free fall, the shifts of maps, the mean
/// skies, and the stars.
pub(crate) const MEAN_SKY_TABLES: usize = BLACKBODY_SIZE;
pub const PROFILE_OFFSET: usize = MEAN_SKY_TABLES + (STAR_LEVELS as usize + 1) * BLACKBODY_SIZE;
pub const PROFILE_SIZE: usize = 2048;
pub const PLACES_OFFSET: usize = PROFILE_OFFSET + PROFILE_SIZE;
/// Entries of a hot spot in free fall: two for each of its places.
pub const SPOT_PLACES: usize = 2 * TABLE_NODES;
pub const PLACES_SIZE: usize = HotSpot::MOST * SPOT_PLACES;
pub(crate) const SHIFT_TABLE: usize = PLACES_OFFSET + PLACES_SIZE;
pub(crate) const MEAN_SKY_OFFSET: usize = SHIFT_TABLE + SHIFT_SIZE;
pub(crate) const STARS_OFFSET: usize = MEAN_SKY_OFFSET + STAR_LEVELS as usize;

/// Blackbodies that stand for the stars that a level leaves out, before their light is put into one table.
const MEAN_SKY_PARTS: usize = 6;
/// The upper ends, K, of the temperatures that all these blackbodies but the last gather.
const MEAN_SKY_BOUNDS: [f64; MEAN_SKY_PARTS - 1] = [3900.0, 4800.0, 6500.0, 9000.0, 12500.0];

/// Cells along a cube side.
pub fn side(level: u32) -> u32 {
    STAR_FINEST >> level
}

/// Every star whose distance from a direction has a sine of at most this is in the list of the direction's cell.
pub fn margin(level: u32) -> f64 {
    STAR_MARGIN / f64::from(side(level))
}

/// The finest level whose margin is at least `radius`; `None` if even the coarsest one's is not, and for NaN.
pub fn level_for(radius: f64) -> Option<u32> {
    (0..STAR_LEVELS).find(|&level| margin(level) >= radius)
}

/// Cells of the levels finer than this one: 6 side^2 each, summed.
pub(super) fn cells_before(level: u32) -> u32 {
    8 * (STAR_FINEST * STAR_FINEST - side(level) * side(level))
}

/// Cells of all levels.
pub(super) const CELL_COUNT: usize = {
    let last = STAR_FINEST >> STAR_LEVELS;
    (8 * (STAR_FINEST * STAR_FINEST - last * last)) as usize
};

pub(super) fn warp(u: f64) -> f64 {
    u * (1.0 + STAR_WARP - STAR_WARP * u.abs())
}

/// The cell of `level` that holds the direction: sides +x, -x, +y, -y, +z, -z; columns and rows along the axes that
/// follow the side's own, cyclically. Any vector gives a cell that exists.
pub fn cell_of(direction: DVec3, level: u32) -> u32 {
    let a = direction.abs();
    let (axis, along, u, v) = if a.x >= a.y && a.x >= a.z {
        (0, direction.x, direction.y, direction.z)
    } else if a.y >= a.z {
        (1, direction.y, direction.z, direction.x)
    } else {
        (2, direction.z, direction.x, direction.y)
    };
    let face = 2 * axis + u32::from(along < 0.0);
    let n = side(level);
    // Saturating conversions: NaN becomes 0.
    let cell = |u: f64| (((warp(u / along.abs()) + 1.0) * 0.5 * f64::from(n)).max(0.0) as u32).min(n - 1);
    cells_before(level) + (face * n + cell(v)) * n + cell(u)
}

/// A blackbody of the mean sky.
#[derive(Clone, Copy, Debug, Default)]
struct MeanSkyPart {
    /// K.
    temperature: f64,
    /// ln Y of the blackbody (`BlackbodyTable::ln_luminance`).
    log_reference: f64,
    /// Luminance at rest, spread over the whole sky.
    radiance: f64,
}

/// The mean light of faint stars.
pub struct MeanSky {
    /// Luminance at rest, mean over the sky.
    pub radiance: f64,
    /// Flux, as in `StarIndex::stars`, of the faintest star that is not part of it; infinite if all are.
    pub flux_limit: f32,
    /// The light under any shift, and the temperature that it is looked up at; `None` for no light.
    light: Option<(f64, BlackbodyTable)>,
}

/// Stars, cells and mean light, ready to draw.
pub struct StarIndex {
    /// Two entries per star: direction and flux (radiance x solid angle at rest); temperature (K), its ln Y, 0, 0. They
    /// are in f32, as the GPU has them, so that both tracers see the same sky.
    pub stars: Vec<[f32; 4]>,
    /// For every cell, where its list begins in `star_lists`, times 256, plus its length.
    pub star_cells: Vec<u32>,
    /// Direction and number of the stars in the lists: a search reads one place after the other.
    pub star_lists: Vec<[f32; 4]>,
    /// For each level, and one beyond, the mean light of the stars that its lists leave out.
    pub mean_sky: Vec<MeanSky>,
    /// The share of the stars that crowd towards the Milky Way (`galaxy::crowding`); so does their mean light.
    pub crowding: f32,
}

impl std::fmt::Debug for StarIndex {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StarIndex").field("stars", &(self.stars.len() / 2)).finish_non_exhaustive()
    }
}

impl StarIndex {
    /// `light_tables` of the GPU, at the offsets above: blackbodies; the mean skies' tables; room for the disk's
    /// profile and the places of hot spots; the shifts of maps; of each level the temperatures that its table and the
    /// next one are looked up at (0: no light), the next one's flux limit, and the crowding; of every star flux,
    /// temperature, its ln Y, 0; the lists.
    pub fn light_tables(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        let of_mean = |mean: &MeanSky| match &mean.light {
            Some((_, table)) => table.gpu_table(),
            None => vec![[0.0; 4]; BLACKBODY_SIZE],
        };
        let temperature = |mean: &MeanSky| mean.light.as_ref().map_or(0.0, |(temperature, _)| *temperature as f32);
        let pair =
            move |pair: &[MeanSky]| [temperature(&pair[0]), temperature(&pair[1]), pair[1].flux_limit, self.crowding];
        let tables = BlackbodyTable::shared().gpu_table().into_iter().chain(self.mean_sky.iter().flat_map(of_mean));
        let stars = self.stars.as_chunks().0.iter().map(|[star, kind]| [star[3], kind[0], kind[1], 0.0]);
        tables
            .chain(std::iter::repeat_n([0.0; 4], PROFILE_SIZE + PLACES_SIZE))
            .chain(ShiftTable::shared().nodes().iter().copied())
            .chain(self.mean_sky.windows(2).map(pair))
            .chain(stars)
            .chain(self.star_lists.iter().copied())
    }

    /// Entries of `light_tables`.
    pub fn light_table_size(&self) -> usize {
        self.lists_offset() + self.star_lists.len()
    }

    /// `star_cells` of the GPU: lists by their place in `light_tables`.
    pub fn cell_tables(&self) -> impl Iterator<Item = u32> + '_ {
        let first = (self.lists_offset() as u32) << 8;
        self.star_cells.iter().map(move |list| list.wrapping_add(first))
    }

    fn lists_offset(&self) -> usize {
        STARS_OFFSET + self.stars.len() / 2
    }

    /// The mean sky's brightness in a direction (a unit vector), relative to its mean over the sky.
    pub fn mean_sky_density(&self, direction: DVec3) -> f64 {
        let crowding = f64::from(self.crowding);
        1.0 + crowding * (crowded_density(direction.dot(GALACTIC_POLE).abs()) - 1.0)
    }

    /// The list of a cell: direction and number of each of its stars.
    pub fn cell_stars(&self, cell: u32) -> &[[f32; 4]] {
        let list = self.star_cells.get(cell as usize).copied().unwrap_or(0);
        let (begin, length) = ((list >> 8) as usize, (list & 255) as usize);
        self.star_lists.get(begin..begin + length).unwrap_or(&[])
    }

    /// Flux, temperature (K) and ln Y of a star in a list.
    pub fn kind_of(&self, listed: [f32; 4]) -> [f64; 3] {
        match self.stars.as_chunks().0.get(listed[3] as usize) {
            Some([star, kind]) => [star[3], kind[0], kind[1]].map(f64::from),
            None => [0.0; 3],
        }
    }
}

impl MeanSky {
    /// Linear Rec. 709 radiance; shifts as for `BlackbodyTable::shifted_blackbody`.
    pub fn light(&self, g_colour: f64, g_beaming: f64) -> [f64; 3] {
        match &self.light {
            Some((temperature, table)) => table.shifted_blackbody(*temperature, 0.0, g_colour, g_beaming),
            None => [0.0; 3],
        }
    }

    pub fn is_dark(&self) -> bool {
        self.light.is_none()
    }
}

/// Radiance x solid angle: `Star::flux` on the display scale.
pub(super) fn scaled_flux(star: &Star) -> f64 {
    star.flux() * STAR_REFERENCE_RADIANCE * REFERENCE_SOLID_ANGLE
}

/// Light and light / temperature of stars, by temperature.
type MeanSkySums = [(f64, f64); MEAN_SKY_PARTS];

/// `StarIndex::mean_sky`. A part's 1 / T is the mean of its stars', weighted by light: to first order the shifted
/// spectra, whose exponents are in 1 / T, then sum to the part's.
pub(super) fn mean_skies(stars: &[Star]) -> Vec<MeanSky> {
    // The sums of the stars that a level leaves out and the level before it does not.
    let mut sums = [MeanSkySums::default(); FAINTEST.len()];
    let mut flux_limits = [f32::INFINITY; FAINTEST.len()];
    for star in stars {
        // Brighter than the last level's limit, minus infinity, is none.
        let level = FAINTEST.iter().take_while(|&&faintest| star.magnitude <= faintest).count().min(FAINTEST.len() - 1);
        let (flux, temperature) = (scaled_flux(star), star.temperature());
        let part = MEAN_SKY_BOUNDS.iter().take_while(|&&bound| temperature > bound).count();
        sums[level][part].0 += flux;
        sums[level][part].1 += flux / temperature;
        flux_limits[level] = flux_limits[level].min(flux as f32);
    }
    let mut left_out = MeanSkySums::default();
    let of_level = |(level, sums): (usize, &MeanSkySums)| {
        for (sum, add) in left_out.iter_mut().zip(sums) {
            sum.0 += add.0;
            sum.1 += add.1;
        }
        mean_sky(&left_out, flux_limits[level + 1..].iter().copied().fold(f32::INFINITY, f32::min))
    };
    sums.iter().enumerate().map(of_level).collect()
}

fn mean_sky(sums: &MeanSkySums, flux_limit: f32) -> MeanSky {
    let parts = sums.map(|(flux, flux_by_temperature)| {
        if flux == 0.0 {
            return MeanSkyPart::default();
        }
        let temperature = flux / flux_by_temperature;
        let log_reference = BlackbodyTable::shared().ln_luminance(temperature);
        MeanSkyPart { temperature, log_reference, radiance: flux / (4.0 * PI) }
    });
    let parts = parts.iter().filter(|part| part.radiance > 0.0);
    let coolest = parts.clone().map(|part| part.temperature).reduce(f64::min);
    let light = coolest.map(|coolest| (coolest, BlackbodyTable::of_light(coolest, |g| mixed(parts.clone(), g))));
    MeanSky { radiance: parts.map(|part| part.radiance).sum(), flux_limit, light }
}

/// Light of all `parts` under the shift g.
fn mixed<'a>(parts: impl Iterator<Item = &'a MeanSkyPart>, g: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for part in parts {
        let rgb = BlackbodyTable::shared().shifted_blackbody(part.temperature, part.log_reference, g, g);
        (0..3).for_each(|c| sum[c] += part.radiance * rgb[c]);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sky::StarField;

    /// Directions spread evenly over the sphere (golden spiral), among them ones close to cube edges.
    fn directions(count: u32) -> impl Iterator<Item = DVec3> {
        (0..count).map(move |i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let angle = 2.399_963_229_728_653 * f64::from(i);
            let s = (1.0 - z * z).sqrt();
            DVec3::new(s * angle.cos(), s * angle.sin(), z)
        })
    }

    #[test]
    fn one_lookup_finds_every_star_within_the_margin() {
        let index = StarField::catalogue().expect("an index");
        let corner = DVec3::splat(1.0).normalize();
        let edge = DVec3::new(1.0, 1.0 - 1e-12, 0.01).normalize();
        for direction in directions(300).chain([corner, -corner, edge, DVec3::X, DVec3::NEG_Z]) {
            for level in 0..STAR_LEVELS {
                let listed = index.cell_stars(cell_of(direction, level));
                let limit = index.mean_sky[level as usize].flux_limit;
                for star in index.stars.iter().step_by(2).filter(|star| star[3] >= limit) {
                    let place = DVec3::new(star[0].into(), star[1].into(), star[2].into());
                    if place.dot(direction) > 0.0 && place.cross(direction).length() <= margin(level) {
                        let found =
                            listed.iter().any(|s| s[..3] == star[..3] && index.kind_of(*s)[0] as f32 == star[3]);
                        assert!(found, "{star:?} near {direction} at level {level}");
                    }
                }
            }
        }
    }

    #[test]
    fn margin_is_the_smallest_distance_across_half_a_cell() {
        for level in 0..STAR_LEVELS {
            let half = 1.0 / f64::from(side(level));
            let mut least = f64::INFINITY;
            for i in -1000..=1000 {
                let u = f64::from(i) / 1000.0;
                // u0 half a cell further in w, by bisection.
                let (mut low, mut high) = (u, 1.5);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if warp(middle) - warp(u) < half { low = middle } else { high = middle }
                }
                // Sine of the distance from (1, u, 1) to the plane of the great circle u = u0.
                least = least.min((low - u) / ((1.0 + low * low).sqrt() * (2.0 + u * u).sqrt()));
            }
            assert!(margin(level) < least && margin(level) > 0.9 * least, "level {level}: {least}");
        }
    }

    #[test]
    fn cells_number_the_whole_sphere_and_anything_else() {
        let mut seen = vec![false; CELL_COUNT];
        for direction in directions(400_000) {
            seen[cell_of(direction, 3) as usize] = true;
        }
        let (begin, end) = (cells_before(3) as usize, cells_before(4) as usize);
        assert_eq!(end - begin, 6 * 32 * 32);
        assert!(seen[begin..end].iter().all(|&s| s));
        assert!(seen[..begin].iter().chain(&seen[end..]).all(|&s| !s));
        for odd in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::new(0.0, f64::NAN, 1.0)] {
            for level in 0..STAR_LEVELS {
                assert!((cell_of(odd, level) as usize) < CELL_COUNT);
            }
        }
    }

    #[test]
    fn levels_are_chosen_by_margin() {
        assert_eq!(level_for(0.0), Some(0));
        assert_eq!(level_for(margin(0)), Some(0));
        assert_eq!(level_for(margin(0) * 1.01), Some(1));
        assert_eq!(level_for(margin(STAR_LEVELS - 1)), Some(STAR_LEVELS - 1));
        assert_eq!(level_for(margin(STAR_LEVELS - 1) * 1.01), None);
        assert_eq!(level_for(f64::NAN), None);
    }

    #[test]
    fn memory_stays_small_and_lists_are_in_order() {
        let random = StarField::Procedural(1).index().expect("an index");
        for (index, megabytes, longest) in [(StarField::catalogue().expect("an index"), 14, 64), (random, 105, 160)] {
            let entries = index.light_table_size();
            assert!(entries * 16 + index.star_cells.len() * 4 < megabytes * 1_000_000, "{entries} entries");
            assert_eq!(index.star_cells.len(), CELL_COUNT);
            let mut end = 0;
            for (cell, packed) in (0..).zip(&index.star_cells) {
                let list = index.cell_stars(cell);
                assert_eq!(packed >> 8, end, "lists without gaps");
                end += list.len() as u32;
                assert!(list.windows(2).all(|w| w[0][3] < w[1][3]));
                assert!(list.len() < longest, "cell {cell}: {}", list.len());
            }
            assert_eq!(end as usize, index.star_lists.len());
            // The places of lists have 24 bits.
            assert!(index.light_table_size() < 1 << 24);
            for level in 0..STAR_LEVELS {
                let cells = cells_before(level)..cells_before(level + 1);
                let mean =
                    cells.clone().map(|cell| index.cell_stars(cell).len()).sum::<usize>() as f64 / cells.len() as f64;
                assert!(mean < 10.5, "level {level}: {mean} stars a list");
            }
        }
    }

    /// The GPU's tables hold what the shaders look for where they look for it.
    #[test]
    fn tables_are_where_the_shaders_look() {
        let index = StarField::catalogue().expect("an index");
        let tables: Vec<[f32; 4]> = index.light_tables().collect();
        assert_eq!(tables.len(), index.light_table_size());
        let last = tables[MEAN_SKY_OFFSET + STAR_LEVELS as usize - 1];
        assert_eq!(last[2], f32::INFINITY, "beyond the last level no star is left");
        for (cell, packed) in (0..).zip(index.cell_tables()) {
            let list = index.cell_stars(cell);
            let begin = (packed >> 8) as usize;
            assert_eq!(&tables[begin..begin + (packed & 255) as usize], list);
            for star in list {
                assert_eq!(f64::from(tables[STARS_OFFSET + star[3] as usize][0]), index.kind_of(*star)[0]);
            }
        }
    }

    /// The stars that a level lists and those in its mean sky are together all the light.
    #[test]
    fn every_level_has_the_light_of_all_stars() {
        every_level_has_the_light_of(&StarField::catalogue().expect("an index"));
        every_level_has_the_light_of(&StarField::Continued(2).index().expect("an index"));
    }

    fn every_level_has_the_light_of(index: &StarIndex) {
        let sum = |mean: &MeanSky| mean.radiance * 4.0 * PI;
        let all = index.stars.iter().step_by(2).map(|star| f64::from(star[3])).sum::<f64>();
        for mean in &index.mean_sky {
            let bright = index.stars.iter().step_by(2).filter(|star| star[3] >= mean.flux_limit);
            let listed = bright.map(|star| f64::from(star[3])).sum::<f64>();
            assert!(((listed + sum(mean)) / all - 1.0).abs() < 1e-5, "{listed} + {} of {all}", sum(mean));
        }
    }

    #[test]
    fn mean_sky_beyond_the_levels_has_the_light_of_all_stars_under_any_shift() {
        let index = StarField::catalogue().expect("an index");
        let table = BlackbodyTable::shared();
        for (g, tolerance) in [(0.5, 0.05), (1.0, 0.01), (2.0, 0.05)] {
            let mut exact = [0.0; 3];
            for star in index.stars.chunks(2) {
                let light = table.shifted_blackbody(star[1][0].into(), star[1][1].into(), g, g);
                (0..3).for_each(|c| exact[c] += f64::from(star[0][3]) * light[c] / (4.0 * PI));
            }
            let mean = index.mean_sky[STAR_LEVELS as usize].light(g, g);
            for c in 0..3 {
                assert!((mean[c] / exact[c] - 1.0).abs() < tolerance, "g {g}: {mean:?} for {exact:?}");
            }
        }
    }
}
