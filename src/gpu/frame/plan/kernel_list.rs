// SPDX-License-Identifier: MIT OR Apache-2.0
//! The list of kernels that a frame runs, known before any is bound, so that all are made at once.
//! tests/tracers/kernels.rs holds the list against what frames ask for.

use super::setup::Setup;
use crate::film::bloom::Bloom;
use crate::film::metering::MeterParams;
use crate::gpu::kernel::key::{KernelKey, KernelKind};
use crate::gpu::kernel::variant::{FilmVariant, OutputPlaces};

impl Setup {
    /// The kernels that make records, or the tables that they are looked up in, and the structure of matter.
    pub(in crate::gpu) fn record_kernels(&self) -> Vec<KernelKey> {
        let bake = self.clouds.is_some().then(|| KernelKind::Bake.into());
        bake.into_iter().chain(self.record_setup.keys()).collect()
    }

    /// Every kernel of the frame; those that take longest to make come last.
    pub fn kernels(&self) -> Vec<KernelKey> {
        let (record_setup, variants) = (&self.record_setup, &self.variants);
        let mut keys = self.record_kernels();
        let deferred = record_setup.deferred_source();
        let film = (!variants.several_samples).then_some(variants.film);
        let shade = |source| match film {
            Some(film) => KernelKey::shade_only(source, variants.shade, film),
            None => KernelKey::shade_sample(source, variants.shade),
        };
        keys.push(shade(record_setup.source));
        keys.extend(deferred.map(shade));
        if variants.refines {
            let samples = (record_setup.sample_source(), record_setup.variant);
            keys.push(KernelKey::refine(samples, variants.shade, film));
        }
        if film.is_none() {
            keys.push(KernelKey::develop(variants.film));
        }
        if let (Some(bloom), Some(developed)) = (&self.bloom, variants.developed) {
            keys.extend(bloom_kernels(bloom));
            keys.extend(self.meter.iter().flat_map(meter_kernels));
            keys.push(self.develop_key(developed, bloom));
        }
        keys
    }

    /// The kernel that develops light which has spread.
    pub(in crate::gpu) fn develop_key(&self, film: FilmVariant, bloom: &Bloom) -> KernelKey {
        KernelKey::develop_spread(film, bloom.factor, self.meter.as_ref().map(MeterParams::is_local))
    }

    /// Every kernel of outputs.
    pub(in crate::gpu) fn output_kernels(&self, places: OutputPlaces) -> Vec<KernelKey> {
        let mut keys = self.record_kernels();
        let source = self.record_setup.source;
        let deferred = self.record_setup.deferred_source();
        let sources = [source].into_iter().chain(deferred);
        keys.extend(sources.map(|source| KernelKey::outputs(source, self.variants.shade, places)));
        keys
    }
}

/// The kernels that spread light.
fn bloom_kernels(bloom: &Bloom) -> impl Iterator<Item = KernelKey> {
    let count = bloom.levels.len();
    let gather = (0..count).map(|index| gather_key(bloom, index));
    let beam = bloom.beam.as_ref().map(|_| KernelKind::Beam.into());
    let lines = bloom.spikes.iter().flat_map(|_| [KernelKind::SpreadLine, KernelKind::AddLine]).map(KernelKey::from);
    let of_ghosts = [KernelKind::ReflectLight, KernelKind::DrawGhosts, KernelKind::AddGhosts];
    let ghosts = bloom.ghosts.iter().flat_map(move |_| of_ghosts).map(KernelKey::from);
    gather.chain((1 < count).then(|| KernelKind::Upsample.into())).chain(beam).chain(ghosts).chain(lines)
}

/// The kernels that measure light.
fn meter_kernels(meter: &MeterParams) -> impl Iterator<Item = KernelKey> {
    let smooth = meter.is_local().then_some(KernelKind::Smooth);
    [KernelKind::Measure, KernelKind::Expose].into_iter().chain(smooth).map(KernelKey::from)
}

/// The kernel that gathers light into the grid of a level.
pub fn gather_key(bloom: &Bloom, level: usize) -> KernelKey {
    match (level, bloom.factor) {
        (0, 2) => KernelKind::GatherBase.into(),
        (0, factor) => KernelKey::gather(factor, false),
        _ => KernelKey::gather(2, true),
    }
}
