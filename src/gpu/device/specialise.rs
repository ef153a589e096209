// SPDX-License-Identifier: MIT OR Apache-2.0
//! Shaders without what their constants switch off. naga puts the values of `override` constants into a shader, and
//! leaves both sides of every `if` to the driver, which takes in all functions that either side calls before it finds
//! that one never runs: in the kernels of this tracer up to three quarters of the code. Without that code lavapipe
//! makes a pipeline in a third to a half of the time. Knows no kernel.

use crate::deferred::hold;
use crate::error::{Error, Result};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::naga::back::pipeline_constants::process_overrides;
use wgpu::naga::compact::{KeepUnused, compact};
use wgpu::naga::front::wgsl;
use wgpu::naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use wgpu::naga::{
    BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable, Module, ShaderStage, Statement,
    SwitchCase, UnaryOperator,
};

/// The shaders of a device by their WGSL, so that pipelines which differ in constants share the reading of it. Each
/// has a lock of its own, so that several are read at a time.
#[derive(Default)]
pub(in crate::gpu) struct Shaders(Mutex<HashMap<String, Place>>);

/// The place of a shader, which is empty until it was read.
type Place = Arc<Mutex<Option<Arc<Parsed>>>>;

impl Shaders {
    /// A shader for wgpu, and the values of constants that are left to it: none. Errors: INTERNAL as [`Parsed::new`]
    /// and [`Parsed::specialised`].
    pub fn translated<'a>(
        &self,
        label: &str,
        source: String,
        entry_point: &str,
        constants: &'a [(&'a str, f64)],
    ) -> Result<(wgpu::ShaderSource<'static>, &'a [(&'a str, f64)])> {
        let specialised = self.parsed(label, source)?.specialised(label, entry_point, constants)?;
        Ok((wgpu::ShaderSource::Naga(Cow::Owned(specialised)), &[]))
    }

    fn parsed(&self, label: &str, source: String) -> Result<Arc<Parsed>> {
        // Messages wait until the shader's place is free.
        let _holding = hold();
        let place = self.0.lock().unwrap_or_else(PoisonError::into_inner).entry(source.clone()).or_default().clone();
        let mut place = place.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(parsed) = &*place {
            return Ok(parsed.clone());
        }
        let parsed = Arc::new(Parsed::new(label, &source)?);
        *place = Some(parsed.clone());
        Ok(parsed)
    }
}

/// WGSL that was read once, for any values of its constants.
#[derive(Debug)]
pub struct Parsed {
    module: Module,
    info: ModuleInfo,
}

impl Parsed {
    /// Errors: INTERNAL with naga's message, which begins with `label`, for WGSL that is not valid.
    pub fn new(label: &str, source: &str) -> Result<Self> {
        let module = wgsl::parse_str(source)
            .map_err(|error| Error::internal(format!("{label}: {}", error.emit_to_string(source))))?;
        // wgpu will find whether this device lacks a capability.
        let info = Validator::new(ValidationFlags::all(), Capabilities::all())
            .validate(&module)
            .map_err(|error| Error::internal(format!("{label}: {}", error.emit_to_string(source))))?;
        Ok(Self { module, info })
    }

    /// The shader of one entry point, with the values of its constants. Errors: INTERNAL with naga's message, for
    /// constants that it does not have, or that lack a value.
    pub fn specialised(&self, label: &str, entry_point: &str, constants: &[(&str, f64)]) -> Result<Module> {
        let values = constants.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        let (module, _) =
            process_overrides(&self.module, &self.info, Some((ShaderStage::Compute, entry_point)), &values)
                .map_err(|error| Error::internal(format!("{label}: {error}")))?;
        let mut module = module.into_owned();
        remove_dead_code(&mut module);
        Ok(module)
    }
}

fn remove_dead_code(module: &mut Module) {
    let mut constant_functions = ConstantFunctions::new();
    let mut functions = std::mem::take(&mut module.functions);
    // Naga's functions stand in an order in which callees come before their callers.
    for (handle, function) in functions.iter_mut() {
        if let Some(constant_result) = Pruner::prune(module, function, &constant_functions) {
            constant_functions.insert(handle, constant_result);
        }
    }
    module.functions = functions;
    let mut entry_points = std::mem::take(&mut module.entry_points);
    for entry in &mut entry_points {
        Pruner::prune(module, &mut entry.function, &constant_functions);
    }
    module.entry_points = entry_points;
    // This also leaves out the functions that nothing calls any more.
    compact(module, KeepUnused::No);
}

/// Functions that do nothing but return a value that is known.
type ConstantFunctions = HashMap<Handle<Function>, Literal>;

/// A function whose constant conditions are being decided.
struct Pruner<'a> {
    module: &'a Module,
    function: &'a Function,
    constant_functions: &'a ConstantFunctions,
    /// Variables that hold one value throughout: naga makes one for each `&&` and `||`.
    known: HashMap<Handle<LocalVariable>, Literal>,
}

impl<'a> Pruner<'a> {
    /// Leaves out of `function` what never runs; the value that is all it returns, if that is known.
    fn prune(
        module: &'a Module,
        function: &mut Function,
        constant_functions: &'a ConstantFunctions,
    ) -> Option<Literal> {
        let mut known = HashMap::new();
        let constant_result = loop {
            let body = std::mem::take(&mut function.body);
            let pruned = Pruner { module, function, constant_functions, known };
            let body = pruned.block(body);
            let found = pruned.constant_variables(&body);
            let constant_result = pruned.constant_result(&body);
            let more = found.len() > pruned.known.len();
            known = found;
            function.body = body;
            // A variable that turned out constant may decide more.
            if !more {
                break constant_result;
            }
        };
        let mut evaluated = HashSet::new();
        visit(&function.body, &mut |statement| match statement {
            Statement::Emit(range) => evaluated.extend(range.clone()),
            Statement::Call { result: Some(result), .. }
            | Statement::Atomic { result: Some(result), .. }
            | Statement::WorkGroupUniformLoad { result, .. } => {
                evaluated.insert(*result);
            }
            _ => {}
        });
        // The names of what was left out go too, as naga takes whatever has a name for used.
        let expressions = &function.expressions;
        function
            .named_expressions
            .retain(|handle, _| evaluated.contains(handle) || expressions[*handle].needs_pre_emit());
        constant_result
    }

    /// The value that `body` returns, if it is known and the body does nothing else.
    fn constant_result(&self, body: &Block) -> Option<Literal> {
        let (mut results, mut acts) = (Vec::new(), false);
        visit(body, &mut |statement| match statement {
            Statement::Emit(_) | Statement::Block(_) => {}
            Statement::Return { value: Some(value) } => results.push(self.value(*value)),
            _ => acts = true,
        });
        match results[..] {
            [constant_result] if !acts => constant_result,
            _ => None,
        }
    }

    fn block(&self, block: Block) -> Block {
        let mut kept = Block::with_capacity(block.len());
        for (statement, span) in block.span_into_iter() {
            // The branch that is left of an `if` stands in its place, without a block of its own.
            match self.statement(statement) {
                Statement::Block(inner) => inner.span_into_iter().for_each(|(inner, span)| kept.push(inner, span)),
                other => kept.push(other, span),
            }
            // Statements behind one that leaves the block never run.
            if kept.last().is_some_and(ends_block) {
                break;
            }
        }
        kept
    }

    fn statement(&self, statement: Statement) -> Statement {
        match statement {
            Statement::If { condition, accept, reject } => match self.value(condition) {
                Some(Literal::Bool(true)) => Statement::Block(self.block(accept)),
                Some(Literal::Bool(false)) => Statement::Block(self.block(reject)),
                _ => Statement::If { condition, accept: self.block(accept), reject: self.block(reject) },
            },
            Statement::Block(block) => Statement::Block(self.block(block)),
            Statement::Loop { body, continuing, break_if } => {
                let body = self.block(body);
                // Where nothing goes on to it, it may use what is no longer evaluated.
                if body.last().is_some_and(ends_block) && !continues(&body) {
                    return Statement::Loop { body, continuing: Block::new(), break_if: None };
                }
                Statement::Loop { body, continuing: self.block(continuing), break_if }
            }
            Statement::Switch { selector, cases } => {
                let cases = cases.into_iter().map(|case| SwitchCase { body: self.block(case.body), ..case });
                Statement::Switch { selector, cases: cases.collect() }
            }
            other => other,
        }
    }

    /// Value of an expression if it is known without running the shader.
    fn value(&self, expression: Handle<Expression>) -> Option<Literal> {
        match self.function.expressions[expression] {
            Expression::Literal(literal) => Some(literal),
            Expression::Constant(constant) => {
                match self.module.global_expressions[self.module.constants[constant].init] {
                    Expression::Literal(literal) => Some(literal),
                    _ => None,
                }
            }
            Expression::CallResult(function) => self.constant_functions.get(&function).copied(),
            Expression::Select { condition, accept, reject } => match self.value(condition)? {
                Literal::Bool(on) => self.value(if on { accept } else { reject }),
                _ => None,
            },
            Expression::Load { pointer } => self.known.get(&self.variable(pointer)?).copied(),
            Expression::Unary { op: UnaryOperator::LogicalNot, expr } => match self.value(expr)? {
                Literal::Bool(on) => Some(Literal::Bool(!on)),
                _ => None,
            },
            Expression::Binary { op, left, right } => {
                let value = match (op, self.value(left)?, self.value(right)?) {
                    (BinaryOperator::LogicalAnd, Literal::Bool(a), Literal::Bool(b)) => a && b,
                    (BinaryOperator::LogicalOr, Literal::Bool(a), Literal::Bool(b)) => a || b,
                    (BinaryOperator::Equal, Literal::U32(a), Literal::U32(b)) => a == b,
                    (BinaryOperator::NotEqual, Literal::U32(a), Literal::U32(b)) => a != b,
                    _ => return None,
                };
                Some(Literal::Bool(value))
            }
            _ => None,
        }
    }

    fn variable(&self, pointer: Handle<Expression>) -> Option<Handle<LocalVariable>> {
        match self.function.expressions[pointer] {
            Expression::LocalVariable(variable) => Some(variable),
            _ => None,
        }
    }

    /// Variables without a name, which naga makes for `&&` and `||` and writes just before it reads them, all of whose
    /// writes in `body` are of one known value.
    fn constant_variables(&self, body: &Block) -> HashMap<Handle<LocalVariable>, Literal> {
        let mut written = HashMap::<Handle<LocalVariable>, Option<Literal>>::new();
        visit(body, &mut |statement| {
            if let Statement::Call { arguments, .. } = statement {
                // The function may write it.
                let lent = arguments.iter().filter_map(|argument| self.variable(*argument));
                written.extend(lent.map(|variable| (variable, None)));
            }
            let Statement::Store { pointer, value } = statement else { return };
            let Some(variable) = self.variable(*pointer) else { return };
            let local = &self.function.local_variables[variable];
            if local.name.is_none() && local.init.is_none() {
                let value = self.value(*value);
                let same = written.entry(variable).or_insert(value);
                *same = same.filter(|same| Some(*same) == value);
            }
        });
        written.into_iter().filter_map(|(variable, value)| Some((variable, value?))).collect()
    }
}

/// Whether nothing that follows the statement in its block runs.
fn ends_block(statement: &Statement) -> bool {
    matches!(statement, Statement::Return { .. } | Statement::Kill | Statement::Break | Statement::Continue)
}

/// Whether a `continue` in a loop's body, but not in a loop within it, goes on to the next turn.
fn continues(body: &Block) -> bool {
    body.iter().any(|statement| match statement {
        Statement::Continue => true,
        Statement::Block(block) => continues(block),
        Statement::If { accept, reject, .. } => continues(accept) || continues(reject),
        Statement::Switch { cases, .. } => cases.iter().any(|case| continues(&case.body)),
        _ => false,
    })
}

/// Calls `each` for every statement of a block, those within others too.
fn visit(block: &Block, each: &mut dyn FnMut(&Statement)) {
    for statement in block.iter() {
        each(statement);
        match statement {
            Statement::Block(block) => visit(block, each),
            Statement::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|block| visit(block, each)),
            Statement::Loop { body, continuing, .. } => {
                [body, continuing].into_iter().for_each(|block| visit(block, each));
            }
            Statement::Switch { cases, .. } => cases.iter().for_each(|case| visit(&case.body, each)),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::naga::back::wgsl::{WriterFlags, write_string};

    /// The WGSL of a specialised shader, after naga found it valid.
    fn specialised(source: &str, constants: &[(&str, f64)]) -> String {
        let module = Parsed::new("test", source).unwrap().specialised("test", "main", constants).unwrap();
        let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module).unwrap();
        write_string(&module, &info, WriterFlags::empty()).unwrap()
    }

    const SOURCE: &str = "
        override ON: bool = false;
        override KIND: u32 = 0u;
        override ASKED: u32 = 7u;
        @group(0) @binding(0) var<storage, read_write> out: array<f32>;
        fn left_out(x: f32) -> f32 { return sinh(x); }
        fn kept(x: f32) -> f32 { return cosh(x); }
        fn early(x: f32) -> f32 {
            if KIND == 2u { return x; }
            let y = left_out(x);
            return y + 1.0;
        }
        fn sometimes() -> bool {
            if !ON { if out[1] > 0.0 { return true; } }
            return false;
        }
        fn kind() -> u32 { return select(ASKED, u32(out[0]), ASKED == 9u); }
        fn is_kind(wanted: u32) -> bool {
            if ASKED == 9u { return u32(out[0]) == wanted; }
            return ASKED == 7u;
        }
        @compute @workgroup_size(1)
        fn main(@builtin(global_invocation_id) id: vec3<u32>) {
            var x = out[id.x];
            if kind() != 7u || !is_kind(id.y) { x = atanh(x); }
            if sometimes() { x = sqrt(x); }
            if ON && x > 1.0 { x = left_out(x); } else { x = kept(x); }
            for (var i = 0u; i < id.y; i += 1u) {
                if !ON || KIND != 2u { x += 1.0; } else { let z = left_out(x); x = z; }
            }
            out[id.x] = early(x);
        }";

    #[test]
    fn what_a_constant_switches_off_is_left_out() {
        let off = specialised(SOURCE, &[("ON", 0.0), ("KIND", 2.0)]);
        assert!(off.contains("cosh") && !off.contains("sinh"), "{off}");
        assert!(!off.contains("atanh") && off.contains("sqrt"), "{off}");
        assert!(!specialised(SOURCE, &[("ON", 1.0)]).contains("sqrt"));
        assert!(specialised(SOURCE, &[("ASKED", 9.0)]).contains("atanh"));
        assert!(specialised(SOURCE, &[("ASKED", 8.0)]).contains("atanh"));
        // Each of the three calls stays where a constant leaves it on.
        for (on, kind) in [(1.0, 2.0), (0.0, 0.0)] {
            let text = specialised(SOURCE, &[("ON", on), ("KIND", kind)]);
            assert!(text.contains("sinh") && text.contains("cosh"), "{on} {kind}: {text}");
        }
    }

    #[test]
    fn what_is_left_of_a_loop_is_valid() {
        let source = "
            override ON: bool = true;
            @group(0) @binding(0) var<storage, read_write> out: array<f32>;
            fn grown(x: f32) -> f32 { return x * 2.0; }
            fn flipped(p: ptr<function, bool>) -> bool { *p = !*p; return *p; }
            @compute @workgroup_size(1)
            fn main() {
                loop {
                    if ON { break; }
                    let y = grown(out[0]);
                    out[0] = y;
                    continuing { break if y > 100.0; }
                }
                var both = ON && out[1] > 0.0;
                if flipped(&both) { out[1] = sinh(grown(out[2])); }
            }";
        for on in [0.0, 1.0] {
            assert!(specialised(source, &[("ON", on)]).contains("sinh"));
        }
    }

    #[test]
    fn what_the_input_decides_stays() {
        let source = "
            @group(0) @binding(0) var<storage, read_write> out: array<f32>;
            @compute @workgroup_size(1)
            fn main() {
                if out[0] > 1.0 && out[1] > 2.0 { out[2] = sinh(out[0]); }
                switch u32(out[3]) { case 1u: { out[4] = cosh(out[3]); } default: { return; } }
                out[5] = tanh(out[5]);
            }";
        let text = specialised(source, &[]);
        assert!(["sinh", "cosh", "tanh"].iter().all(|name| text.contains(name)), "{text}");
    }

    #[test]
    fn a_shader_or_constant_that_is_wrong_is_an_error_with_its_label() {
        let error = Parsed::new("broken", "fn f( {").unwrap_err();
        assert!(error.message.starts_with("broken: "), "{error}");
        let error = Parsed::new("broken", "fn f() -> f32 { return 1u; }").unwrap_err();
        assert!(error.message.starts_with("broken: "), "{error}");
        let error = Parsed::new("test", SOURCE).unwrap().specialised("test", "main", &[("NONE", 1.0)]).unwrap_err();
        assert!(error.message.starts_with("test: ") && error.message.contains("NONE"), "{error}");
    }
}
