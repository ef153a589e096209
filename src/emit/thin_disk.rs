// SPDX-License-Identifier: MIT OR Apache-2.0
//! The accretion disk of a scene: where it lies, and its light at a crossing. Mirrored by `shaders/emit/disk.wgsl`.

use super::crossing::{Crossing, Emission, EmissionPoint, Shift};
use super::disk::{Disk, DiskReference, EmissionLaw};
use super::streaks::Streaks;
use super::turbulence::Turbulence;
use crate::error::Result;
use crate::physics::blackbody::BlackbodyTable;
use crate::physics::disk_flux::{PLUNGE_FLUX, TemperatureProfile, page_thorne, page_thorne_maximum};
use crate::physics::limb_darkening::limb_darkening;
use crate::physics::orbit::{horizon_outer, isco};
use crate::physics::trace::innermost_u;
use std::sync::{Mutex, PoisonError};

/// The disk of a scene: where it lies, and whether it has structure.
#[derive(Clone, Copy, Debug)]
pub struct ThinDisk {
    pub disk: Disk,
    /// 1/r of its outer and inner edge.
    pub u: [f64; 2],
    /// Spin as its matter meets it: its own sense of motion is +ph.
    pub matter_spin: f64,
    /// Temperature of the hottest ring of the profile, K.
    pub hottest: f64,
    pub edges: SoftEdges,
    /// 1/r of the hottest ring, and the temperature, in that ring's, below which it does not fall farther in
    /// (`PLUNGE_FLUX`). `None`: no plunging matter shines, and the temperature falls to 0 at the ISCO.
    pub least_profile: Option<[f64; 2]>,
    /// `None`: it is smooth.
    pub turbulence: Option<Turbulence>,
}

/// The part of the fading at the outer edge, from there inwards, that does not count for the median ring: found by
/// trial with disks of outer radius 17 M and softness 0.1 to 0.6, which so are about as luminous whatever the spin is.
const UNCOUNTED_FADING: f64 = 0.25;

/// How the disk fades out at its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SoftEdges {
    /// The outer radius, M, and 1 over the width over which the disk fades out inside it; (0, 0): it is sharp.
    pub outer: [f64; 2],
    /// 1/r of the hottest ring; and 1 over the flux, in that ring's, below which the disk is translucent farther in;
    /// (0, 0): it is sharp.
    pub inner: [f64; 2],
}

impl SoftEdges {
    /// The share of the disk's opacity that is left at 1/r = `u`, where the temperature is `profile`, in that of the
    /// hottest ring.
    pub fn left(&self, u: f64, profile: f64) -> f64 {
        let [outer, per_width] = self.outer;
        let fade = if per_width > 0.0 { ((outer - 1.0 / u) * per_width).clamp(0.0, 1.0) } else { 1.0 };
        let [hottest, per_flux] = self.inner;
        let flux = if per_flux > 0.0 && u > hottest { (profile.powi(4) * per_flux).min(1.0) } else { 1.0 };
        fade * fade * (3.0 - 2.0 * fade) * flux
    }
}

/// The value of `find` at `key`, which `last` holds if it was asked for last: frames of a scene ask again and again.
fn asked_last<K: PartialEq + Copy, V: Copy>(last: &Mutex<Option<(K, V)>>, key: K, find: impl FnOnce(K) -> V) -> V {
    let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
    match *last {
        Some((asked, value)) if asked == key => value,
        _ => last.insert((key, find(key))).1,
    }
}

/// The radius of the profile's hottest ring, and the flux there (`page_thorne`).
fn hottest_ring(matter_spin: f64) -> (f64, f64) {
    static LAST: Mutex<Option<(f64, (f64, f64))>> = Mutex::new(None);
    asked_last(&LAST, matter_spin, page_thorne_maximum)
}

/// The radius, M, from which on the flux is `share` of the hottest ring's, or more.
fn flux_suffices(matter_spin: f64, share: f64) -> f64 {
    let (r, most) = hottest_ring(matter_spin);
    // The flux rises from the ISCO to the hottest ring: bisection finds where it is as large as is needed.
    let (mut faint, mut bright) = (isco(matter_spin), r);
    for _ in 0..30 {
        let middle = 0.5 * (faint + bright);
        if page_thorne(matter_spin, middle) >= share * most { bright = middle } else { faint = middle }
    }
    bright
}

impl ThinDisk {
    /// The smooth disk about a hole of spin `spin`; only plunging matter is inside the ISCO. `None`: all of it lies
    /// where no matter is.
    pub fn new(disk: &Disk, spin: f64) -> Option<Self> {
        let matter_spin = if disk.retrograde { -spin } else { spin };
        let orbiting = disk.inner_radius.max(isco(matter_spin));
        let inner = if disk.plunges { disk.inner_radius.max(1.0 / innermost_u(horizon_outer(spin))) } else { orbiting };
        if inner >= disk.outer_radius {
            return None;
        }
        let plunges = inner < orbiting;
        // The look of the orbiting matter, if there is any, does not depend on whether matter plunges, too.
        let from = if orbiting < disk.outer_radius { orbiting } else { inner };
        let hottest = match disk.reference {
            DiskReference::Hottest => disk.temperature,
            DiskReference::Median => {
                let outer = disk.outer_radius - UNCOUNTED_FADING * disk.edge_softness * (disk.outer_radius - from);
                let median = (0.5 * (from * from + outer * outer)).sqrt();
                let (r, most) = hottest_ring(matter_spin);
                let least = if plunges && median < r { PLUNGE_FLUX * most } else { 0.0 };
                disk.temperature * (most / page_thorne(matter_spin, median).max(least)).powf(0.25)
            }
        };
        let edges = match disk.edge_softness > 0.0 {
            true => SoftEdges {
                outer: [disk.outer_radius, 1.0 / (disk.edge_softness * (disk.outer_radius - from))],
                // Where matter plunges the flux does not go to 0.
                inner: if plunges { [0.0; 2] } else { [1.0 / hottest_ring(matter_spin).0, 1.0 / disk.edge_softness] },
            },
            false => SoftEdges::default(),
        };
        let u = [1.0 / disk.outer_radius, 1.0 / inner];
        let least_profile = plunges.then(|| [1.0 / hottest_ring(matter_spin).0, PLUNGE_FLUX.powf(0.25)]);
        Some(Self { disk: *disk, u, matter_spin, hottest, edges, least_profile, turbulence: None })
    }

    /// The temperature at 1/r = `u`, in that of the hottest ring; `table`: of the matter's spin.
    pub fn profile(&self, table: &TemperatureProfile, u: f64) -> f64 {
        let least = self.least_profile.map_or(0.0, |[hottest, least]| if u > hottest { least } else { 0.0 });
        table.at(1.0 / u).max(least)
    }

    /// The interval of 1/r in which nothing behind it is seen; `None` without one.
    pub fn opaque_u(&self) -> Option<[f64; 2]> {
        if self.disk.opacity != 1.0 {
            return None;
        }
        if self.disk.edge_softness == 0.0 {
            return Some(self.u);
        }
        let outer = self.faded_u() * 1.001;
        if self.least_profile.is_some() {
            return (outer < self.u[1]).then_some([outer, self.u[1]]);
        }
        // A little farther in than where tracers of less precision see the fading begin.
        let inner = (1.0 / (self.flux_suffices() * 1.001)).min(self.u[1]);
        (outer < inner).then_some([outer, inner])
    }

    /// The radius, M, from which on the flux is as large as an opaque disk with soft edges needs.
    fn flux_suffices(&self) -> f64 {
        static LAST: Mutex<Option<([f64; 2], f64)>> = Mutex::new(None);
        asked_last(&LAST, [self.matter_spin, self.disk.edge_softness], |[spin, share]| flux_suffices(spin, share))
    }

    /// The change of 1/r over which the disk fades from nothing to its opacity at its outer and its inner edge; 0 where
    /// it ends sharply, as at an inner radius beyond the ISCO, where its flux is not 0.
    pub fn fading_u(&self) -> [f64; 2] {
        if self.disk.edge_softness == 0.0 {
            return [0.0; 2];
        }
        let [outer, inner] = self.u;
        let fades_inside = self.least_profile.is_none() && self.disk.inner_radius <= isco(self.matter_spin);
        [self.faded_u().min(inner) - outer, if fades_inside { inner - 1.0 / self.flux_suffices() } else { 0.0 }]
    }

    /// 1/r where the fading at the outer edge begins.
    fn faded_u(&self) -> f64 {
        let [outer, per_width] = self.edges.outer;
        1.0 / (outer - 1.0 / per_width).max(1e-30)
    }
}

/// The disk with the tables of its light.
pub struct DiskLight {
    disk: ThinDisk,
    colours: &'static BlackbodyTable,
    profile: TemperatureProfile,
    /// ln Y of the stated temperature.
    log_reference: f64,
    /// For a disk with turbulence.
    streaks: Option<&'static Streaks>,
}

impl DiskLight {
    /// Errors: OUT_OF_MEMORY.
    pub fn new(disk: ThinDisk) -> Result<Self> {
        let colours = BlackbodyTable::shared();
        let log_reference = colours.ln_luminance(disk.disk.temperature);
        let streaks = disk.turbulence.map(|_| Streaks::shared()).transpose()?;
        Ok(Self { disk, colours, profile: TemperatureProfile::new(disk.matter_spin), log_reference, streaks })
    }

    /// The light that a crossing adds to a ray of which the share `open` comes this far, were the disk smooth. `mu`:
    /// |cosine| of the ray's angle to the disk's normal, as the matter sees it.
    pub fn at_crossing(&self, crossing: &Crossing, shift: Shift, mu: f64, open: f64) -> Emission {
        let profile = self.disk.profile(&self.profile, crossing.u);
        let opacity = self.opacity_at(crossing, profile);
        let strength = open * opacity * emission_law(self.disk.disk.emission_law, mu);
        Emission { light: self.light(profile, shift).map(|v| strength * v), opacity }
    }

    /// The factor by which the disk's structure changes the light of a crossing, seen `moment` after the frame's time,
    /// M.
    pub fn structure(&self, crossing: &Crossing, moment: f64) -> f64 {
        let at = EmissionPoint { delay: crossing.place.delay - moment, ..crossing.place };
        match (self.disk.turbulence, self.streaks) {
            (Some(turbulence), Some(streaks)) => turbulence.brightness(streaks, at, crossing.footprint),
            _ => 1.0,
        }
    }

    /// The share of the light from behind that a crossing hides.
    pub fn opacity(&self, crossing: &Crossing) -> f64 {
        self.opacity_at(crossing, self.disk.profile(&self.profile, crossing.u))
    }

    /// The share of the light from behind that a crossing hides, where the disk's temperature is `profile`, in that of
    /// the hottest ring.
    fn opacity_at(&self, crossing: &Crossing, profile: f64) -> f64 {
        self.disk.disk.opacity * crossing.share * self.disk.edges.left(crossing.u, profile)
    }

    /// Linear radiance of the opaque, smooth disk where its temperature is `profile`, in that of the hottest ring.
    pub fn light(&self, profile: f64, shift: Shift) -> [f64; 3] {
        let temperature = self.disk.hottest * profile;
        self.colours
            .shifted_blackbody(temperature, self.log_reference, shift.colour, shift.beaming)
            .map(|v| v * self.disk.disk.brightness)
    }
}

/// The light at the angle of cosine `mu`, over that of an isotropic surface of the same flux.
pub fn emission_law(law: EmissionLaw, mu: f64) -> f64 {
    match law {
        EmissionLaw::Isotropic => 1.0,
        EmissionLaw::LimbDarkened => limb_darkening(mu),
    }
}

/// The row of tables that shading reads on the GPU, `TemperatureProfile::SIZE` entries: T / T_max and the step to the
/// next entry, and I(mu) / F at mu = i / (SIZE - 1) and the step to the next.
pub fn profile_row(profile: &TemperatureProfile) -> impl Iterator<Item = [f32; 4]> {
    let entries = profile.entries();
    let last = (entries.len() - 1) as f64;
    (0..entries.len()).map(move |i| {
        let next = (i + 1).min(entries.len() - 1);
        let [here, there] = [i, next].map(|i| limb_darkening(i as f64 / last));
        [entries[i], entries[next] - entries[i], here, there - here].map(|v| v as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the opaque interval ends something is seen through a soft disk, and nowhere within it.
    #[test]
    fn soft_edges_fade_outside_the_opaque_interval() {
        for (spin, softness, inner_radius) in [(0.0, 0.3, 0.0), (0.998, 0.1, 0.0), (-0.9, 0.7, 0.0), (0.5, 0.2, 12.0)] {
            let disk = Disk { edge_softness: softness, inner_radius, ..Disk::plain() };
            let thin = ThinDisk::new(&disk, spin).unwrap();
            let profile = TemperatureProfile::new(spin);
            let left = |u: f64| thin.edges.left(u, profile.at(1.0 / u));
            let Some([outer, inner]) = thin.opaque_u() else {
                assert!(softness > 0.6, "{spin}: nothing is opaque");
                continue;
            };
            for i in 0..=100 {
                let u = outer + (inner - outer) * f64::from(i) / 100.0;
                assert_eq!(left(u), 1.0, "{spin} at {}", 1.0 / u);
            }
            assert!(left(outer * 0.97) < 1.0 && left(thin.u[0]) == 0.0, "{spin}");
            assert!(inner == thin.u[1] || (left(inner * 1.02) < 1.0 && left(thin.u[1]) < 1e-9), "{spin}");
            assert!(inner_radius == 0.0 || inner == thin.u[1], "a disk cut off farther out has no fading inner edge");
        }
        let sharp = ThinDisk::new(&Disk::plain(), 0.3).unwrap();
        assert_eq!(sharp.opaque_u(), Some(sharp.u));
        assert_eq!(sharp.edges.left(sharp.u[0] * 0.5, 0.0), 1.0);
    }

    /// The disk of plunging matter reaches to the horizon or to its own inner edge and is opaque there; its temperature
    /// goes on evenly through the ISCO; farther out all is as without.
    #[test]
    fn plunging_matter_goes_on_inside_the_isco() {
        let (hottest, median) = (DiskReference::Hottest, DiskReference::Median);
        for (spin, retrograde, reference) in [(0.0, false, median), (0.9, true, hottest), (0.998, false, median)] {
            let disk = Disk { retrograde, reference, edge_softness: 0.2, plunges: true, ..Disk::plain() };
            let without = ThinDisk::new(&Disk { plunges: false, ..disk }, spin).unwrap();
            let thin = ThinDisk::new(&disk, spin).unwrap();
            let (u_horizon, isco) = (1.0 / horizon_outer(spin), isco(thin.matter_spin));
            assert!(thin.u[1] < u_horizon && thin.u[1] > 0.9999 * u_horizon, "{spin}");
            assert_eq!((thin.u[0], thin.hottest), (without.u[0], without.hottest));
            assert_eq!(thin.opaque_u().unwrap()[1], thin.u[1]);
            let table = TemperatureProfile::new(thin.matter_spin);
            let mut last = 0.0;
            for i in 0..=1000 {
                let u = thin.u[0] + (thin.u[1] - thin.u[0]) * f64::from(i) / 1000.0;
                let here = thin.profile(&table, u);
                assert!(i == 0 || (here - last).abs() < 0.05, "{spin} at {}: {last} {here}", 1.0 / u);
                if 1.0 / u > hottest_ring(thin.matter_spin).0 {
                    assert_eq!(here, without.profile(&table, u));
                } else {
                    assert!(here.powi(4) > 0.4999 && thin.edges.left(u, here) == 1.0, "{spin}: {here}");
                }
                last = here;
            }
            let limited = |inner_radius| ThinDisk::new(&Disk { inner_radius, ..disk }, spin).unwrap();
            let between = 0.5 * (isco + 1.0 / u_horizon);
            assert_eq!(limited(between).u[1], 1.0 / between);
            // One that begins outside the ISCO is as it was without the flag.
            assert_eq!(limited(isco * 1.1).least_profile, None);
            assert_eq!(limited(isco * 1.1).edges.inner[1], 1.0 / 0.2);
        }
        assert!(ThinDisk::new(&Disk { outer_radius: 1.9, plunges: true, ..Disk::plain() }, 0.0).is_none());
    }

    /// Across the fading at an edge the disk gets from nothing to all of its opacity; a sharp edge has none.
    #[test]
    fn edges_fade_over_the_stated_change_of_u() {
        let fading = |spin: f64, softness: f64, inner_radius: f64| {
            let thin = ThinDisk::new(&Disk { edge_softness: softness, inner_radius, ..Disk::plain() }, spin).unwrap();
            let profile = TemperatureProfile::new(spin);
            let ([far, near], [outer, inner]) = (thin.u, thin.fading_u());
            let left = |u: f64| thin.edges.left(u, profile.at(1.0 / u));
            ([left(far), left(far + 0.5 * outer), left(far + outer)], [left(near), left(near - inner)], [outer, inner])
        };
        for (spin, softness) in [(0.0, 0.4), (0.9, 0.2), (0.998, 0.1), (-0.9, 0.3)] {
            let ([none, some, all], at_inner, _) = fading(spin, softness, 0.0);
            assert!(none == 0.0 && some > 0.2 && some < 1.0 && (all - 1.0).abs() < 1e-6, "{spin}: {none} {some} {all}");
            assert!(at_inner[0] < 1e-9 && (at_inner[1] - 1.0).abs() < 1e-3, "{spin}: {at_inner:?}");
        }
        assert_eq!(fading(0.5, 0.2, 12.0).2[1], 0.0, "a disk cut off farther out ends sharply");
        assert_eq!(fading(0.5, 0.0, 0.0).2, [0.0; 2]);
    }

    /// Half of the disk's area, less a quarter of its fading, lies within the ring of the stated temperature.
    #[test]
    fn the_median_ring_has_the_stated_temperature() {
        let cases = [(0.0, 0.0, 20.0, 0.0), (0.998, 0.0, 20.0, 0.0), (-0.998, 12.0, 1e6, 0.0), (0.5, 0.0, 17.0, 0.4)];
        for (spin, inner_radius, outer_radius, edge_softness) in cases {
            let reference = DiskReference::Median;
            let disk = Disk { reference, inner_radius, outer_radius, edge_softness, ..Disk::plain() };
            let thin = ThinDisk::new(&disk, spin).unwrap();
            let inner = 1.0 / thin.u[1];
            let outer = outer_radius - 0.25 * edge_softness * (outer_radius - inner);
            let median = (0.5 * (inner.powi(2) + outer.powi(2))).sqrt();
            let there = thin.hottest * TemperatureProfile::new(spin).at(median);
            assert!((there / disk.temperature - 1.0).abs() < 1e-4, "{spin}: {there}");
        }
    }
}
