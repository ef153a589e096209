// SPDX-License-Identifier: MIT OR Apache-2.0
//! The table of choices against the WGSL that kernels are made of, and the number of kernels that can exist.

use super::super::choices::{Choice, Only, Row, TABLE, Values, Variant, readers::*};
use super::super::variant::{DevelopedLight, OutputPlaces, PixelTarget, RecordMaker, StoredFormat};
use super::super::wgsl::shader_sources;
use super::KernelKind;
use crate::gpu::device::specialise::Parsed;
use crate::random::{mix, runs_all};
use crate::scene::Projection;
use std::collections::{BTreeMap, BTreeSet};
use wgpu::naga::Expression;
use wgpu::naga::compact::{KeepUnused, compact};
use wgpu::naga::front::wgsl::parse_str;

/// More kernels than these cannot exist, for one choice of outputs. Each choice multiplies the number, so that one more
/// has to raise this on purpose.
const MOST_KERNELS: u64 = 400_000_000_000;

/// Constants that kernels mention and leave at WGSL's default: those of rays that tables are made of and of samples
/// that tables do not hold, which are integrated as AUTO does, without matter.
const LEFT: [(Choice, u32); 17] = [
    (Choice::METHOD, NODES | TABLE_RAYS),
    (Choice::SPINNING, NODES | KERR | DEFERRED),
    (Choice::STEP_LIMIT, TABLE_RAYS | NODES),
    (Choice::RAIN, SPIN_0 | ENDS | COLUMNS),
    (Choice::KEEPS_RECORD, PIXELS),
    (Choice::MOVING, PIXELS | (TRACED & !EXPORT)),
    (Choice::PARTS, RAYS | TABLE_RAYS),
    (Choice::SHAPES, TABLE_SAMPLES),
    (Choice::MOTIONS, TABLE_SAMPLES),
    (Choice::THERMAL, TABLE_SAMPLES),
    (Choice::POWER_LAW, TABLE_SAMPLES),
    (Choice::SHOWS_DEPTH, TABLE_SAMPLES),
    (Choice::STRUCTURE, TABLE_SAMPLES),
    (Choice::ALONE, TABLE_SAMPLES),
    (Choice::PLANE, EXPORT & !DEFERRED),
    (Choice::WHOLE_PLANE, SPIN_0 | KERR),
    (Choice::PLACES, SPIN_0),
];
const TABLE_SAMPLES: u32 = REFINE & (KERR | DEFERRED);
const TABLE_RAYS: u32 = DEFERRED | TABLE_SAMPLES;

pub(super) fn kinds() -> Vec<KernelKind> {
    use KernelKind::*;
    let makers = [RecordMaker::Traced, RecordMaker::Schwarzschild, RecordMaker::Kerr, RecordMaker::KerrDeferred];
    let images = [StoredFormat::Rgba8, StoredFormat::Rgba16F, StoredFormat::Rgba32F, StoredFormat::R32F];
    let others = [PixelTarget::Packed, PixelTarget::Rows, PixelTarget::Light];
    let targets = images.map(PixelTarget::Image).into_iter().chain(others).collect::<Vec<_>>();
    let scattered = |target: &PixelTarget| *target != PixelTarget::Rows;
    let mut kinds =
        vec![Pixels, Blocks, Listed, Fill, Rays, Count, Gather, GatherBase, Upsample, Beam, SpreadLine, AddLine];
    kinds.extend([ReflectLight, DrawGhosts, AddGhosts]);
    kinds.extend([SkyLevel(false), SkyLevel(true), OccluderRows, SchwarzschildEnds, SchwarzschildColumns]);
    kinds.extend([KerrNodes, KerrFlags]);
    for maker in makers {
        kinds.extend([ShadeSample(maker), Refine(maker, None), Export(maker), Outputs(maker, OutputPlaces::default())]);
        let refined = maker != RecordMaker::Kerr;
        for target in &targets {
            let rows = scattered(target) || maker != RecordMaker::KerrDeferred;
            kinds.extend(rows.then_some(ShadeOnly(maker, *target)));
            kinds.extend((refined && scattered(target)).then_some(Refine(maker, Some(*target))));
        }
    }
    kinds.extend(targets.iter().map(|target| Develop(*target, DevelopedLight::Summed)));
    for light in [DevelopedLight::Glare, DevelopedLight::Metered] {
        kinds.extend(targets.iter().filter(|t| **t != PixelTarget::Light).map(|target| Develop(*target, light)));
    }
    kinds
}

/// The constants that a kernel's code uses.
fn mentioned(kind: KernelKind) -> BTreeSet<String> {
    let mut module = parse_str(&kind.wgsl().unwrap()).unwrap();
    module.entry_points.retain(|point| point.name == kind.entry_point());
    compact(&mut module, KeepUnused::No);
    module.overrides.iter().filter_map(|(_, constant)| constant.name.clone()).collect()
}

/// The table has every `override` constant of every kernel, and no other.
#[test]
fn every_constant_of_wgsl_is_a_choice() {
    let mut declared = BTreeSet::new();
    // The pipeline that fills windows is none of these kernels.
    for (_, source) in shader_sources().unwrap().iter().filter(|(name, _)| *name != "present") {
        declared.extend(parse_str(source).unwrap().overrides.iter().filter_map(|(_, constant)| constant.name.clone()));
    }
    assert_eq!(declared, TABLE.iter().map(|row| row.constant.to_owned()).collect());
}

/// Kernels use the constants that the table says they read or set, and besides only those of `LEFT`.
#[test]
fn kernels_read_what_the_table_says() {
    let mut wrong = Vec::new();
    for kind in kinds() {
        let bits = kind.readers();
        let has = |row: &&Row| {
            let left = LEFT.iter().filter(|(choice, _)| *choice == row.choice).fold(0, |all, (_, left)| all | left);
            bits & (row.read_by | left) != 0 || row.set_for(bits).is_some()
        };
        let stated = TABLE.iter().filter(has).map(|row| row.constant.to_owned()).collect::<BTreeSet<_>>();
        let found = mentioned(kind);
        if stated != found {
            let (more, less) =
                (stated.difference(&found).collect::<Vec<_>>(), found.difference(&stated).collect::<Vec<_>>());
            wrong.push(format!("{kind:?}: has not {more:?}, has {less:?} besides"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

pub(super) struct Random(pub u32);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 += 1;
        mix(self.0) as usize % n
    }
}

pub(super) struct Given(Vec<(Choice, u32)>);

impl Variant for Given {
    fn make(&self, values: &mut Values) {
        self.0.iter().for_each(|(choice, value)| values.make(*choice, *value));
    }
}

impl Given {
    /// A value for every choice that scenes make.
    pub(super) fn random(random: &mut Random) -> Self {
        let rows = TABLE.iter().filter(|row| !row.values.is_empty());
        Self(rows.map(|row| (row.choice, row.values[random.below(row.values.len())])).collect())
    }

    /// The constants of a kernel before those that make no difference are folded.
    fn constants(&self, kind: KernelKind) -> Vec<(&'static str, f64)> {
        let bits = kind.readers();
        let made = |row: &Row| self.0.iter().find(|(choice, _)| *choice == row.choice).map(|(_, value)| *value);
        let read = |row: &Row| made(row).filter(|_| bits & row.read_by != 0);
        let all = TABLE.iter().map(|row| (row.constant, row.set_for(bits).or_else(|| read(row))));
        all.filter_map(|(constant, value)| Some((constant, f64::from(value?)))).collect()
    }
}

fn code(parsed: &Parsed, kind: KernelKind, constants: &[(&str, f64)]) -> String {
    let module = parsed.specialised("test", kind.entry_point(), constants).unwrap();
    let functions = module.functions.iter().map(|(_, function)| function);
    let functions = functions.chain(module.entry_points.iter().map(|point| &point.function)).collect::<Vec<_>>();
    // Constants that nothing uses any more stay in the module.
    let used = functions.iter().flat_map(|function| function.expressions.iter()).filter_map(|(_, used)| match used {
        Expression::Constant(constant) => Some(&module.global_expressions[module.constants[*constant].init]),
        _ => None,
    });
    format!("{:?} {:?} {functions:?} {:?}", module.types, module.global_variables, used.collect::<Vec<_>>())
}

/// Folding changes no kernel's code.
#[test]
fn choices_that_are_folded_make_no_difference() {
    let (mut random, mut wrong) = (Random(1), Vec::new());
    for kind in kinds() {
        let parsed = Parsed::new("test", &kind.wgsl().unwrap()).unwrap();
        // Everyday one key of each kind, which is another one for each.
        for _ in 0..if runs_all() { 2 } else { 1 } {
            let given = Given::random(&mut random);
            let folded = Values::of(kind.readers(), &[&given]).constants().collect::<Vec<_>>();
            let whole = given.constants(kind);
            if folded != whole && code(&parsed, kind, &folded) != code(&parsed, kind, &whole) {
                let differ = |(one, other): &(&(_, _), &(_, _))| one != other;
                wrong.push(format!("{kind:?}: {:?}", whole.iter().zip(&folded).filter(differ).collect::<Vec<_>>()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Whether a kind stands for others that read the same choices.
fn is_example(kind: KernelKind) -> bool {
    use KernelKind::*;
    match kind {
        ShadeOnly(RecordMaker::Schwarzschild, PixelTarget::Packed) | ShadeSample(RecordMaker::KerrDeferred) => true,
        Refine(RecordMaker::Traced, Some(PixelTarget::SCREEN))
        | Develop(PixelTarget::Packed, DevelopedLight::Metered) => true,
        Export(maker) | Outputs(maker, _) => maker == RecordMaker::Schwarzschild,
        ShadeSample(_) | ShadeOnly(..) | Refine(..) | Develop(..) | Blocks | Listed => false,
        _ => true,
    }
}

/// Two keys of a kind that differ in one choice are two kernels, where light, a disk and more than one volume are
/// shown. (Elsewhere some choices are kept apart that make no difference to every kernel that reads them.)
#[test]
fn choices_that_are_not_folded_make_a_difference() {
    let mut random = Random(2);
    let mut same = BTreeMap::<&str, Vec<String>>::new();
    for kind in kinds().into_iter().filter(|kind| is_example(*kind)) {
        let parsed = Parsed::new("test", &kind.wgsl().unwrap()).unwrap();
        let mut given = Given::random(&mut random);
        for (choice, value) in &mut given.0 {
            *value = match choice {
                Choice::SHOWS_LIGHT | Choice::PLANE | Choice::FOOTPRINTS | Choice::PARTS => 1,
                Choice::SHOWS_DEPTH | Choice::ALONE => 0,
                // Some kernels ask of projections only where they end.
                Choice::PROJECTION => Projection::Fisheye as u32,
                _ => *value,
            };
        }
        let key = |given: &Given| Values::of(kind.readers(), &[given]);
        let here = code(&parsed, kind, &key(&given).constants().collect::<Vec<_>>());
        for index in 0..given.0.len() {
            let row = &TABLE[given.0[index].0 as usize];
            for value in row.values {
                let mut other = Given(given.0.clone());
                other.0[index].1 = *value;
                if key(&other) != key(&given) {
                    let there = code(&parsed, kind, &key(&other).constants().collect::<Vec<_>>());
                    if here == there {
                        same.entry(row.constant)
                            .or_default()
                            .push(format!("{kind:?} {value} {:?}", given.constants(kind)));
                    }
                }
            }
        }
    }
    assert!(same.is_empty(), "{same:#?}");
}

/// The number of keys of a kind, where the rows before `index` have the choices `given`.
fn count(bits: u32, index: usize, given: &Given) -> u64 {
    let Some(row) = TABLE.get(index) else { return 1 };
    let with = |value: u32| Given([&given.0[..], &[(row.choice, value)]].concat());
    let differs = row.values.len() > 1 && {
        let [one, other] = [0, 1].map(|k| Values::of(bits, &[&with(row.values[k])]));
        one != other
    };
    let conditions = TABLE.iter().flat_map(|row| row.only).flat_map(|only| match only {
        Only::AnyOf(list) | Only::NoneOf(list) => list.iter(),
    });
    let decides = conditions.into_iter().any(|(choice, _)| *choice == row.choice);
    match (differs, decides) {
        (false, _) => count(bits, index + 1, &with(0)),
        (true, false) => row.values.len() as u64 * count(bits, index + 1, &with(0)),
        (true, true) => row.values.iter().map(|value| count(bits, index + 1, &with(*value))).sum(),
    }
}

#[test]
fn kernels_can_be_counted() {
    let counts =
        kinds().into_iter().map(|kind| (kind, count(kind.readers(), 0, &Given(Vec::new())))).collect::<Vec<_>>();
    for (kind, count) in &counts {
        println!("{count:>12} {kind:?}");
    }
    let all = counts.iter().map(|(_, count)| count).sum::<u64>();
    println!("{all} kernels of {} kinds can exist, for one choice of outputs", counts.len());
    assert!(all <= MOST_KERNELS, "{all} kernels can exist, more than {MOST_KERNELS}");
}
