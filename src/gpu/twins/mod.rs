// SPDX-License-Identifier: MIT OR Apache-2.0
//! Compiled for tests only: every function of shaders/ that has a counterpart in Rust, f32 against f64 over random
//! input. `TABLES` lists these twins, `excused` the functions that have none, and the tests fail for a function that is
//! on neither list, for one that is gone, and for twins that differ.
//!
//! A twin is called by a kernel of its own, on whatever Vulkan adapter there is. Its numbers may differ from what Rust
//! gives by `tolerance` of their size and, unless it says otherwise, by what rounding its inputs to f32 once more would
//! change: no f32 function can be better than that.

mod camera;
mod clouds;
mod cube;
mod excused;
mod film;
mod free_spot;
mod geodesic;
mod half;
mod inputs;
mod integrator;
mod kerr;
mod lens;
mod light;
mod matter;
mod records;
mod refine;
mod run;
mod scenes;
mod shade;
mod sky;

use super::kernel::fragments::{FILES, join_wgsl};
use super::kernel::wgsl::shader_sources;
use crate::random::runs_all;
use excused::{EXCUSED, Why};
use inputs::{INPUTS, Inputs, OUTPUTS, Outputs, Random};
use run::{Gpu, Image, Job, Source, Table};
use std::collections::{BTreeMap, BTreeSet};
use wgpu::naga::{Block, Function, Handle, Module, Span, Statement, front::wgsl};

/// Items of random input for each twin, in `tests/run all` and everyday.
const ITEMS: [usize; 2] = [2048, 512];

fn items() -> usize {
    ITEMS[usize::from(!runs_all())]
}

/// Roundings of the inputs that show how far a twin is conditioned, and the factor on what they change.
const SHIFTS: usize = 4;
const CONDITIONING: f64 = 4.0;
/// Items whose conditioning allows more than this of their size (of flags and indices: anything) say nothing; a twin
/// may have one in `VAGUE_SHARE` of them.
const VAGUE: f64 = 3e-3;
const VAGUE_SHARE: usize = 4;

/// A function of WGSL and its counterpart.
struct Twin {
    /// Fragment, and the functions there that the kernel calls and that are compared with that: one, or a few of which
    /// the first calls the others.
    fragment: &'static str,
    functions: &'static str,
    /// WGSL that calls it with `in1(k)`, `in2(k)`, `in3(k)`, `in4(k)`, `word(k)`, which begin at input k, and hands
    /// what it gives to `out1`, `out2`, `out3`, `out4`, `out_word` and `out_flag`.
    call: &'static str,
    inputs: fn(&mut Inputs),
    expected: fn(&Inputs, &mut Outputs),
    tolerance: f64,
    constants: Vec<(&'static str, f64)>,
    conditioned: bool,
}

impl Twin {
    /// Pipeline constants.
    fn with(mut self, constants: &[(&'static str, f64)]) -> Self {
        self.constants.extend(constants);
        self
    }

    /// The function is to be as exact as its tolerance says whatever its inputs are.
    fn exactly(mut self) -> Self {
        self.conditioned = false;
        self
    }
}

/// A few roundings of f32, 6e-8 each.
const ROUNDING: f64 = 6e-7;
/// A value that both twins compute in f32 and by the same steps, or no number at all but a flag, an index or bits.
const SAME: f64 = 0.0;
/// The errors that drivers' exp, log and pow may have: 3 + 2 |x| roundings for exp, 3 for log2 (Vulkan's table).
const TRANSCENDENTAL: f64 = 4e-6;

fn twin(
    fragment: &'static str,
    functions: &'static str,
    call: &'static str,
    inputs: fn(&mut Inputs),
    expected: fn(&Inputs, &mut Outputs),
    tolerance: f64,
) -> Twin {
    Twin { fragment, functions, call, inputs, expected, tolerance, constants: Vec::new(), conditioned: true }
}

/// Twins whose fragments make one module.
struct Group {
    name: &'static str,
    /// WGSL that imports the fragments and declares what they require.
    head: String,
    twins: Vec<Twin>,
    images: fn() -> Vec<Image>,
    tables: fn() -> Vec<Table>,
}

const TABLES: &[fn() -> Group] = &[
    geodesic::group,
    integrator::group,
    camera::group,
    lens::group,
    kerr::group,
    kerr::nodes,
    light::group,
    matter::group,
    free_spot::group,
    half::group,
    clouds::group,
    sky::group,
    cube::group,
    shade::group,
    refine::group,
    records::group,
    film::group,
];

const ACCESS: &str = "
@group(0) @binding(0) var<storage, read> inputs: array<u32>;
@group(0) @binding(1) var<storage, read_write> outputs: array<f32>;
var<private> input_begin: u32;
var<private> output_end: u32;
fn word(k: u32) -> u32 { return inputs[input_begin + k]; }
fn in1(k: u32) -> f32 { return bitcast<f32>(word(k)); }
fn in2(k: u32) -> vec2<f32> { return vec2<f32>(in1(k), in1(k + 1u)); }
fn in3(k: u32) -> vec3<f32> { return vec3<f32>(in2(k), in1(k + 2u)); }
fn in4(k: u32) -> vec4<f32> { return vec4<f32>(in3(k), in1(k + 3u)); }
fn out1(v: f32) { outputs[output_end] = v; output_end += 1u; }
fn out2(v: vec2<f32>) { out1(v.x); out1(v.y); }
fn out3(v: vec3<f32>) { out2(v.xy); out1(v.z); }
fn out4(v: vec4<f32>) { out2(v.xy); out2(v.zw); }
fn out_word(v: u32) { out1(f32(v & 0xffffu)); out1(f32(v >> 16u)); }
fn out_flag(v: bool) { out1(select(0.0, 1.0, v)); }
";

/// A fragment's variables, so that a test may set uniforms and bind textures: uniforms become private variables, as do
/// a workgroup's arrays, which each item then has for itself, and other resources move one group on.
fn rebound(text: &str) -> String {
    let line = |line: &str| {
        if let Some(variable) = line.strip_prefix("var<workgroup>").filter(|variable| variable.contains(": array<")) {
            return format!("var<private>{variable}\n");
        }
        let bound = line.strip_prefix("@group(").and_then(|rest| rest.split_once(')'));
        let Some((group, rest)) = bound.filter(|_| !line.contains("inputs") && !line.contains("outputs")) else {
            return format!("{line}\n");
        };
        match rest.split_once("var<uniform>") {
            Some((_, variable)) => format!("var<private>{variable}\n"),
            None => format!("@group({}){rest}\n", group.parse::<u32>().expect("a group") + 1),
        }
    };
    text.lines().map(line).collect()
}

fn entry(index: usize) -> String {
    format!("twin_{index}")
}

impl Group {
    fn source(&self) -> Source {
        let mut text = rebound(
            &join_wgsl(&[self.head.as_str(), ACCESS].concat()).unwrap_or_else(|e| panic!("{}: {e}", self.name)),
        );
        for (twin, index) in self.twins.iter().zip(0..) {
            text += &format!(
                "@compute @workgroup_size(64) fn {}(@builtin(global_invocation_id) thread: vec3<u32>) {{\n\
                 input_begin = thread.x * {INPUTS}u;\noutput_end = thread.x * {OUTPUTS}u;\n{}\n}}\n",
                entry(index),
                twin.call
            );
        }
        Source::new(text)
    }

    /// Twins that differ, and the worst of each.
    fn compare(&self, gpu: &Gpu) -> Vec<String> {
        let source = self.source();
        let inputs_of = |seed: usize, twin: &Twin| {
            let make = |item: usize| {
                let mut inputs = Inputs::new((seed * ITEMS[0] + item) as u64);
                (twin.inputs)(&mut inputs);
                inputs
            };
            (0..items()).map(make).collect::<Vec<_>>()
        };
        let all = self.twins.iter().enumerate().map(|(seed, twin)| inputs_of(seed, twin)).collect::<Vec<_>>();
        let jobs = self.twins.iter().zip(&all).enumerate().map(|(index, (twin, items))| {
            let padded = |item: &Inputs| {
                let mut words = item.words.clone();
                assert!(words.len() <= INPUTS, "{}", twin.functions);
                words.resize(INPUTS, 0);
                words
            };
            // A scene's constants serve all groups, of which some have fewer.
            let overrides = || source.module.overrides.iter().filter_map(|(_, known)| known.name.as_deref());
            let constants = twin.constants.iter().filter(|(name, _)| overrides().any(|known| known == *name));
            Job {
                entry: entry(index),
                constants: constants.copied().collect(),
                inputs: items.iter().flat_map(padded).collect(),
            }
        });
        let given = gpu.run(&source, &(self.images)(), &(self.tables)(), &jobs.collect::<Vec<_>>());
        let twins = self.twins.iter().zip(all).zip(given);
        twins.filter_map(|((twin, items), given)| twin.compare(items, &given)).collect()
    }
}

impl Twin {
    fn expect(&self, inputs: &Inputs) -> Vec<(f64, f64)> {
        let mut outputs = Outputs::default();
        (self.expected)(inputs, &mut outputs);
        assert!(!outputs.values.is_empty() && outputs.values.len() <= OUTPUTS, "{}", self.functions);
        outputs.values
    }

    /// The worst item, if it differs by more than it may.
    fn compare(&self, inputs: Vec<Inputs>, given: &[f32]) -> Option<String> {
        let name = format!("{} {}", self.fragment, self.functions);
        let (mut worst, mut message, mut largest, mut wrong, mut vague) = (0.0_f64, String::new(), 0.0_f64, 0, 0);
        let mut random = Random(7);
        for (mut inputs, given) in inputs.into_iter().zip(given.chunks(OUTPUTS)) {
            let expected = self.expect(&inputs);
            let mut spread = vec![0.0_f64; expected.len()];
            for _ in 0..if self.conditioned { SHIFTS } else { 0 } {
                inputs.shift(&mut random);
                for ((spread, (value, _)), (shifted, _)) in spread.iter_mut().zip(&expected).zip(self.expect(&inputs)) {
                    *spread = spread.max((shifted - value).abs());
                }
            }
            inputs.unshift();
            let (mut item_is_wrong, mut item_is_vague) = (false, false);
            for (k, ((&(value, scale), spread), got)) in expected.iter().zip(&spread).zip(given).enumerate() {
                let got = f64::from(*got);
                let error = if got == value || (got.is_nan() && value.is_nan()) { 0.0 } else { (got - value).abs() };
                let allowed = self.tolerance * scale + CONDITIONING * spread;
                let share = if error == 0.0 { 0.0 } else { error / allowed };
                let share = if share.is_nan() { f64::INFINITY } else { share };
                let beyond = (error - CONDITIONING * spread).max(0.0) / scale.max(1e-300);
                largest = largest.max(if error > 0.0 { beyond } else { 0.0 });
                item_is_wrong |= share > 1.0;
                item_is_vague |= CONDITIONING * spread > VAGUE * scale;
                if share > worst {
                    worst = share;
                    message = format!("output {k} is {got:e}, expected {value:e}, of ({})", inputs.shown());
                }
            }
            wrong += u32::from(item_is_wrong);
            vague += usize::from(item_is_vague);
        }
        println!("{name}: {worst:.2} of what is allowed, {largest:.1e} beyond conditioning; {vague} items are vague");
        let items = items();
        if vague * VAGUE_SHARE > items {
            return Some(format!("{name}: {vague} of {items} items are so ill conditioned that they say nothing"));
        }
        (worst > 1.0).then(|| format!("{name}: {wrong} of {items} items differ; {message}"))
    }
}

#[test]
fn twins_agree() {
    let gpu = Gpu::new();
    let wrong = TABLES.iter().flat_map(|table| table().compare(&gpu)).collect::<Vec<_>>();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

type Named = (String, String);

/// The fragment in which a place of a joined source lies.
fn fragment_at(source: &str, span: Span) -> Option<&str> {
    let place = span.to_range()?;
    let before = source.get(..place.start)?.rsplit("// ");
    let begins = before.filter_map(|text| text.lines().next()?.strip_suffix(".wgsl"));
    begins.into_iter().find(|name| FILES.iter().any(|(file, _)| file == name))
}

fn first_span(function: &Function) -> Span {
    function.body.span_iter().next().map_or(Span::UNDEFINED, |(_, span)| *span)
}

/// Every function of every fragment, from the modules that kernels are made of.
fn all_functions() -> BTreeSet<Named> {
    let mut found = BTreeSet::new();
    for (_, source) in shader_sources().expect("WGSL that can be joined") {
        let module = wgsl::parse_str(&source).expect("WGSL");
        let plain = module.functions.iter().map(|(handle, function)| (module.functions.get_span(handle), function));
        let entries = module.entry_points.iter().map(|entry| (first_span(&entry.function), &entry.function));
        for (span, function) in plain.chain(entries) {
            let fragment = fragment_at(&source, span).expect("a fragment");
            found.insert((fragment.to_owned(), function.name.clone().expect("a name")));
        }
    }
    found
}

fn calls(block: &Block, found: &mut Vec<Handle<Function>>) {
    for statement in block.iter() {
        match statement {
            Statement::Call { function, .. } => found.push(*function),
            Statement::Block(block) => calls(block, found),
            Statement::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|block| calls(block, found)),
            Statement::Switch { cases, .. } => cases.iter().for_each(|case| calls(&case.body, found)),
            Statement::Loop { body, continuing, .. } => {
                [body, continuing].into_iter().for_each(|block| calls(block, found));
            }
            _ => (),
        }
    }
}

/// The functions that an entry point calls, by fragment and name.
fn called(source: &Source, entry: &str) -> BTreeSet<Named> {
    let module: &Module = &source.module;
    let point = module.entry_points.iter().find(|point| point.name == entry).expect("an entry point");
    let (mut left, mut found) = (Vec::new(), BTreeSet::new());
    calls(&point.function.body, &mut left);
    while let Some(handle) = left.pop() {
        let function = &module.functions[handle];
        let Some(fragment) = fragment_at(&source.text, module.functions.get_span(handle)) else { continue };
        if found.insert((fragment.to_owned(), function.name.clone().expect("a name"))) {
            calls(&function.body, &mut left);
        }
    }
    found
}

fn named(fragment: &str, functions: &str) -> Vec<Named> {
    functions.split_whitespace().map(|function| (fragment.to_owned(), function.to_owned())).collect()
}

#[test]
fn every_function_has_a_twin_or_a_reason() {
    let functions = all_functions();
    let (mut compared, mut wrong) = (BTreeSet::new(), Vec::new());
    for group in TABLES.iter().map(|table| table()) {
        let source = group.source();
        for (twin, index) in group.twins.iter().zip(0..) {
            for (name, _) in &twin.constants {
                let known = FILES.iter().any(|(_, text)| text.contains(&format!("override {name}: ")));
                assert!(known, "{}: no shader has the pipeline constant {name}", twin.functions);
            }
            let called = called(&source, &entry(index));
            for name in named(twin.fragment, twin.functions) {
                if !called.contains(&name) {
                    wrong.push(format!("{}: the kernel of this twin calls no {name:?}", twin.functions));
                }
                compared.insert(name);
            }
        }
    }
    let mut excused = BTreeMap::new();
    for (fragment, functions_there, why) in EXCUSED {
        for name in named(fragment, functions_there) {
            if !functions.contains(&name) || compared.contains(&name) {
                wrong.push(format!("{name:?} is excused, but no shader has it, or it has a twin"));
            }
            assert!(excused.insert(name.clone(), why).is_none(), "{name:?} is excused twice");
        }
        if let Why::Tested(file, test, _) = why {
            let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
            let text = std::fs::read_to_string(root.join(file)).unwrap_or_else(|_| panic!("there is no {file}"));
            assert!(text.contains(&format!("fn {test}(")), "{file} has no test {test}");
        }
    }
    let neither = functions.iter().filter(|name| !compared.contains(*name) && !excused.contains_key(*name));
    wrong.extend(neither.map(|name| format!("{name:?} has neither a twin nor an excuse")));
    let count = |tested: bool| excused.values().filter(|why| matches!(why, Why::Tested(..)) == tested).count();
    println!(
        "{} functions: {} compared, {} tested elsewhere, {} without a counterpart",
        functions.len(),
        compared.len(),
        count(true),
        count(false)
    );
    assert!(wrong.is_empty(), "{wrong:#?}");
}
