// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reads include/bhr.h, as tests/header/generated.rs has made it, into what include/bhr.json holds: every declaration
//! with its comment, and the layout that the rules of C give structs on machines with pointers of 64 bits. The test
//! in tests/header/json.rs compares those with what a C compiler says.
//!
//! The header is read rather than cbindgen's own model, which is private for the most part: the header is what hosts
//! get, and each of its declarations has one of six forms. Anything else stops it with a panic.

use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The first release: what says nothing else is as old as that.
const FIRST_RELEASE: &str = "0.1.0";

/// Bits that a parameter holds rather than the field that their comments begin with.
const BITS_OF_PARAMETERS: [(&str, &str); 2] =
    [("BHR_EFFECT_", "bhr_set_effects.effects"), ("BHR_MATRIX_", "bhr_camera_matrices.flags")];

/// A declaration of the header: the section that it stands in, its comment, and its text without comments.
struct Item<'a> {
    section: &'a str,
    comment: String,
    code: String,
}

/// The header's items in order.
fn items(header: &str) -> Vec<Item<'_>> {
    let mut found = Vec::new();
    for part in header.split("\n/* ---- ").skip(1) {
        let (section, text) = part.split_once(" ---- */\n").expect("a section's title ends on its line");
        let mut rest = text.split("\n#ifdef __cplusplus").next().unwrap().trim();
        while !rest.is_empty() {
            let mut comment = String::new();
            if rest.starts_with("/**") {
                let (text, after) = rest.split_once("*/").expect("a comment ends");
                (comment, rest) = (prose(text), after.trim_start());
            }
            let end =
                if rest.starts_with('#') { rest.find('\n').unwrap_or(rest.len()) } else { end_of_declaration(rest) };
            let mut code = rest[..end].to_owned();
            if let Some((define, beside)) = code.clone().split_once("/**<").filter(|_| code.starts_with('#')) {
                comment = prose(beside.trim().trim_end_matches("*/"));
                code = define.to_owned();
            }
            found.push(Item { section, comment, code: code.trim().to_owned() });
            rest = rest[end..].trim_start();
        }
    }
    found
}

/// The place behind the semicolon that ends a declaration; those of a struct's fields do not.
fn end_of_declaration(text: &str) -> usize {
    let (mut depth, mut comment) = (0, false);
    for (at, c) in text.char_indices() {
        match c {
            _ if comment => comment = !text[..=at].ends_with("*/"),
            '*' if text[..at].ends_with('/') => comment = true,
            '{' => depth += 1,
            '}' => depth -= 1,
            ';' if depth == 0 => return at + 1,
            _ => {}
        }
    }
    panic!("no semicolon ends this: {text}");
}

/// A comment as Markdown: paragraphs of one line each; tables and what stands between fences as they are.
fn prose(comment: &str) -> String {
    let lines = comment.lines().map(|line| {
        let line = line.trim_start().trim_start_matches("/**<").trim_start_matches("/**");
        line.strip_prefix("* ").or(line.strip_prefix('*')).unwrap_or(line).trim_end()
    });
    let (mut text, mut fenced, mut kept) = (String::new(), false, true);
    for line in lines {
        let fence = line.starts_with("```");
        let keep = fenced || fence || line.starts_with('|') || line.is_empty();
        if !text.is_empty() {
            text.push(if keep || kept { '\n' } else { ' ' });
        }
        text += if keep { line } else { line.trim() };
        fenced ^= fence;
        kept = keep;
    }
    text.trim().to_owned()
}

/// The version that a comment's tag names, `@since 0.2.0`.
fn since(comment: &str) -> &str {
    comment.rsplit_once("@since ").map_or(FIRST_RELEASE, |(_, version)| version.split_whitespace().next().unwrap())
}

/// A comment without that tag, which `since` of its entry says.
fn untagged(comment: &str) -> String {
    comment.rsplit_once("@since ").map_or(comment, |(text, _)| text.trim_end()).to_owned()
}

/// The later of two versions.
fn later<'a>(a: &'a str, b: &'a str) -> &'a str {
    let number = |version: &str| version.split('.').map(|part| part.parse::<u32>().unwrap()).collect::<Vec<_>>();
    if number(a) < number(b) { b } else { a }
}

/// The size and the alignment of types that C and the header's sections define.
struct Types {
    layouts: BTreeMap<String, (u64, u64)>,
    constants: BTreeMap<String, i64>,
    /// Their names as the header has them one after the other.
    order: Vec<String>,
}

/// A name with its type, as fields and parameters are declared: `const double axis[3]`.
struct Declarator {
    name: String,
    base: String,
    constant: bool,
    pointers: u64,
    array: Option<u64>,
}

impl Types {
    fn new() -> Self {
        let basic = [
            ("char", 1),
            ("int32_t", 4),
            ("uint32_t", 4),
            ("int64_t", 8),
            ("uint64_t", 8),
            ("size_t", 8),
            ("double", 8),
        ];
        let layouts = basic.map(|(name, size)| (name.to_owned(), (size, size))).into();
        Self { layouts, constants: BTreeMap::new(), order: Vec::new() }
    }

    fn number(&self, text: &str) -> i64 {
        let text = text.trim();
        if let Some((left, right)) = text.trim_matches(['(', ')']).split_once(" - ") {
            return self.number(left) - self.number(right);
        }
        self.constants.get(text).copied().unwrap_or_else(|| {
            text.trim_end_matches('u').parse().unwrap_or_else(|_| panic!("{text} is no number that this test knows"))
        })
    }

    fn declarator(&self, text: &str) -> Declarator {
        let (text, array) = match text.split_once('[') {
            Some((text, length)) => (text, Some(self.number(length.trim_end_matches(']')).unsigned_abs())),
            None => (text, None),
        };
        let words = text.replace('*', " * ");
        let mut words: Vec<&str> = words.split_whitespace().collect();
        let name = words.pop().expect("a declarator has a name").to_owned();
        let constant = words.first() == Some(&"const");
        let pointers = words.iter().filter(|word| **word == "*").count() as u64;
        let base = words[usize::from(constant)].to_owned();
        let known = usize::from(constant) + 1 + usize::try_from(pointers).unwrap();
        assert_eq!(words.len(), known, "this test does not know the type of {text}");
        Declarator { name, base, constant, pointers, array }
    }

    fn layout(&self, field: &Declarator) -> (u64, u64) {
        let known = || *self.layouts.get(&field.base).unwrap_or_else(|| panic!("{} is not known", field.base));
        let (size, alignment) = if field.pointers > 0 { (8, 8) } else { known() };
        (size * field.array.unwrap_or(1), alignment)
    }
}

impl Declarator {
    /// The type's parts; `c` is how C spells it in front of a name.
    fn as_json(&self) -> Map<String, Value> {
        let constant = if self.constant { "const " } else { "" };
        let stars = "*".repeat(usize::try_from(self.pointers).unwrap());
        let spelled = format!("{constant}{} {stars}", self.base);
        let mut parts = Map::new();
        parts.insert("type".into(), spelled.trim().into());
        parts.insert("base".into(), self.base.as_str().into());
        parts.insert("pointers".into(), self.pointers.into());
        parts.insert("const".into(), self.constant.into());
        if let Some(length) = self.array {
            parts.insert("array".into(), length.into());
        }
        parts
    }

    fn named(&self) -> Map<String, Value> {
        let mut parts = self.as_json();
        parts.insert("name".into(), self.name.as_str().into());
        parts
    }

    /// How data goes: a constant pointer's target and a value go in, such as the size of what comes out; what a pointer
    /// named out_ leads to comes out; an opaque type is a handle, and anything else is read and written.
    fn direction(&self, opaque: &[String]) -> &'static str {
        let address = self.pointers > 0 || self.array.is_some();
        match () {
            () if !address => "in",
            () if self.name.starts_with("out_") => "out",
            () if self.constant || opaque.contains(&self.base) || self.base == "void" => "in",
            () => "inout",
        }
    }
}

/// `text` on one line, without comments, and with constants for their names, for readers that know no #define.
fn plain(text: &str, types: &Types) -> String {
    let mut code = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("/*") {
        code += before;
        rest = after.split_once("*/").expect("a comment ends").1;
    }
    code += rest;
    let mut code = code.split_whitespace().collect::<Vec<_>>().join(" ").replace("( ", "(");
    for (name, value) in &types.constants {
        code = code.replace(&format!("[{name}]"), &format!("[{value}]"));
    }
    code
}

/// The result and the parameters of a prototype; `name` stands where the function's name does. The *_init functions do
/// not read the struct that they fill in.
fn signature(code: &str, name: &str, types: &Types, opaque: &[String]) -> (Map<String, Value>, Vec<Value>) {
    let (before, after) = code.split_once(name).unwrap();
    let result = types.declarator(&format!("{} result", before.trim_end_matches("(*").trim())).as_json();
    let parameters = after.trim_start_matches(')').trim_start_matches('(').trim_end_matches([';', ')']);
    let parameters = parameters.split(',').map(str::trim).filter(|text| *text != "void" && !text.is_empty());
    let parameter = |text: &str| {
        let declarator = types.declarator(text);
        let mut parts = declarator.named();
        // A parameter of an array's type is a pointer; `array` says how many elements it points to.
        if declarator.array.is_some() {
            let spelled = format!("{} *", parts["type"].as_str().unwrap());
            parts.insert("type".into(), spelled.into());
            parts.insert("pointers".into(), 1.into());
        }
        let direction =
            if name.ends_with("_init") && declarator.pointers > 0 { "out" } else { declarator.direction(opaque) };
        parts.insert("direction".into(), direction.into());
        Value::Object(parts)
    };
    (result, parameters.map(parameter).collect())
}

/// The ways in which comments name units, and the units.
const UNITS: [(&str, &str); 9] = [
    ("radians", "rad"),
    ("in m,", "M"),
    ("per m ", "1/M"),
    ("kelvin", "K"),
    ("scene lengths", "scene length"),
    ("in frame heights", "frame height"),
    ("in units of c", "c"),
    ("stops", "EV"),
    ("pixels", "pixel"),
];

/// The unit that a field's comment names first.
fn unit(comment: &str) -> Option<&'static str> {
    let comment = format!("{} ", comment.to_lowercase());
    let found = UNITS.iter().filter_map(|(words, unit)| Some((comment.find(words)?, *unit)));
    found.min_by_key(|(place, _)| *place).map(|(_, unit)| unit)
}

/// The least and the greatest number that a field's comment names, as `0 .. 1e6` or `within +-1e9`, both of them
/// allowed.
fn range(comment: &str) -> Option<Vec<f64>> {
    let number = |text: &str| match text.trim_matches([',', ';', ':']).trim_end_matches('.') {
        "2^20" => Some(f64::from(1 << 20)),
        digits => digits.parse::<f64>().ok(),
    };
    let words: Vec<&str> = comment.split_whitespace().collect();
    let between = words.windows(3).find_map(|three| match three {
        [low, "..", high] => Some(vec![number(low)?, number(high)?]),
        _ => None,
    });
    let about = || {
        words.iter().find_map(|word| {
            let bound = number(word.strip_prefix("+-")?)?;
            Some(vec![-bound, bound])
        })
    };
    between.or_else(about)
}

/// The fields of a struct with their places, and its size and alignment.
fn fields(body: &str, types: &Types) -> (Vec<Value>, u64, u64) {
    let (mut found, mut end, mut widest) = (Vec::new(), 0_u64, 1);
    let mut rest = body.trim();
    while !rest.is_empty() {
        let mut comment = String::new();
        if rest.starts_with("/**") {
            let (text, after) = rest.split_once("*/").expect("a comment ends");
            (comment, rest) = (prose(text), after.trim_start());
        }
        let (code, mut after) = rest.split_once(';').expect("a field ends with a semicolon");
        if let Some((text, behind)) = after.trim_start().strip_prefix("/**<").and_then(|text| text.split_once("*/")) {
            (comment, after) = (prose(text), behind);
        }
        let declarator = types.declarator(code);
        let (size, alignment) = types.layout(&declarator);
        let offset = end.next_multiple_of(alignment);
        let mut field = declarator.named();
        field.insert("offset".into(), offset.into());
        field.insert("size".into(), size.into());
        if ["double", "uint32_t"].contains(&declarator.base.as_str()) {
            for (name, value) in
                [("unit", unit(&comment).map(Value::from)), ("range", range(&comment).map(Value::from))]
            {
                if let Some(value) = value {
                    field.insert(name.into(), value);
                }
            }
        }
        field.insert("since".into(), since(&comment).into());
        field.insert("documentation".into(), untagged(&comment).into());
        found.push(Value::Object(field));
        (end, widest) = (offset + size, widest.max(alignment));
        rest = after.trim_start();
    }
    (found, end.next_multiple_of(widest), widest)
}

/// The name that stands for the value of a #define, and that value's text.
fn definition(code: &str) -> Option<(&str, &str)> {
    let (name, value) = code.strip_prefix("#define ")?.split_once(char::is_whitespace)?;
    Some((name, value.trim()))
}

/// Makes each field as new as its struct at least, and each constant as new as its type, or what its bits go into,
/// because they have no tags of their own then.
fn since_their_types(lists: &mut BTreeMap<&str, Vec<Value>>) {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let entries = ["structs", "enumerations", "functions"].iter().filter_map(|list| lists.get(list)).flatten();
    let of: BTreeMap<_, _> = entries.map(|entry| (text(&entry["name"]), text(&entry["since"]))).collect();
    let renew = |part: &mut Value, owner: &str| {
        let owners = of.get(owner).map_or(FIRST_RELEASE, String::as_str);
        part["since"] = later(&text(&part["since"]), owners).into();
    };
    for object in lists.get_mut("structs").into_iter().flatten() {
        let name = text(&object["name"]);
        object["fields"].as_array_mut().into_iter().flatten().for_each(|field| renew(field, &name));
    }
    for constant in lists.get_mut("constants").into_iter().flatten() {
        let owner = constant.get("bits_of").unwrap_or(&constant["type"]);
        let owner = text(owner).split('.').next().unwrap_or_default().to_owned();
        renew(constant, &owner);
    }
}

/// The header as include/bhr.json has it. `type_of_constant` says which type a constant has in the Rust sources,
/// because a #define has none; `defaults` what the *_init functions fill in, by "Struct.field".
pub fn of_header(
    header: &str,
    type_of_constant: &BTreeMap<String, String>,
    defaults: &BTreeMap<String, Value>,
) -> Value {
    let mut types = Types::new();
    let mut opaque = Vec::new();
    let mut lists: BTreeMap<&str, Vec<Value>> = BTreeMap::new();
    let mut declarations = Vec::new();
    let mut sections = Vec::new();
    for item in items(header) {
        if sections.last() != Some(&item.section) {
            sections.push(item.section);
        }
        let code = item.code.trim_start_matches("BHR_NODISCARD ");
        let mut entry = Map::new();
        entry.insert("section".into(), item.section.into());
        entry.insert("since".into(), since(&item.comment).into());
        entry.insert("documentation".into(), untagged(&item.comment).into());
        let (list, name) = if let Some((name, value)) = definition(code) {
            let value = types.number(value);
            types.constants.insert(name.to_owned(), value);
            types.order.push(name.to_owned());
            let kind = type_of_constant.get(name).unwrap_or_else(|| panic!("src/capi has no constant {name}"));
            entry.insert("value".into(), value.into());
            entry.insert("type".into(), kind.as_str().into());
            let field = item.comment.split_once(':').map(|(field, _)| field).filter(|field| field.ends_with(".flags"));
            let parameter = BITS_OF_PARAMETERS.iter().find(|(begin, _)| name.starts_with(begin));
            if let Some(bits) = field.or(parameter.map(|(_, place)| *place)) {
                entry.insert("bits_of".into(), bits.into());
            }
            ("constants", name.to_owned())
        } else if let Some((name, body)) = code.strip_prefix("typedef struct ").and_then(|rest| rest.split_once('{')) {
            let name = name.trim().to_owned();
            let (mut fields, size, alignment) = fields(body.rsplit_once('}').unwrap().0, &types);
            for field in &mut fields {
                let place = format!("{name}.{}", field["name"].as_str().unwrap());
                if let Some(default) = defaults.get(&place) {
                    field["default"] = default.clone();
                }
            }
            types.layouts.insert(name.clone(), (size, alignment));
            entry.insert("versioned".into(), (fields[0]["name"] == "struct_size").into());
            entry.insert("fields".into(), fields.into());
            entry.insert("size".into(), size.into());
            entry.insert("alignment".into(), alignment.into());
            ("structs", name)
        } else if let Some(rest) = code.strip_prefix("typedef struct ") {
            let name = rest.trim_end_matches(';').split(' ').next().unwrap().to_owned();
            opaque.push(name.clone());
            ("opaque_types", name)
        } else if let Some((result, name)) = code.strip_prefix("typedef ").and_then(|rest| rest.split_once("(*")) {
            let name = name.split(')').next().unwrap().to_owned();
            let prototype = format!("{result}{}", code.split_once("(*").unwrap().1);
            let (result, parameters) = signature(&plain(&prototype, &types), &name, &types, &opaque);
            entry.insert("result".into(), result.into());
            entry.insert("parameters".into(), parameters.into());
            types.layouts.insert(name.clone(), (8, 8));
            ("callbacks", name)
        } else if let Some(rest) = code.strip_prefix("typedef ") {
            let (kind, name) = rest.trim_end_matches(';').rsplit_once(' ').unwrap();
            types.layouts.insert(name.to_owned(), types.layouts[kind]);
            entry.insert("type".into(), kind.into());
            ("enumerations", name.to_owned())
        } else {
            let (before, _) = code.split_once('(').unwrap_or_else(|| panic!("this test does not know {code}"));
            let name = before.rsplit([' ', '*']).next().unwrap().to_owned();
            let (result, parameters) = signature(&plain(code, &types), &name, &types, &opaque);
            entry.insert("result".into(), result.into());
            entry.insert("parameters".into(), parameters.into());
            ("functions", name)
        };
        entry.insert("name".into(), name.into());
        if list != "constants" {
            let declaration = plain(code, &types);
            entry.insert("declaration".into(), declaration.as_str().into());
            declarations.push(declaration);
        }
        lists.entry(list).or_default().push(Value::Object(entry));
    }
    for enumeration in lists.get_mut("enumerations").into_iter().flatten() {
        let is_its = |name: &&String| type_of_constant[*name] == enumeration["name"].as_str().unwrap();
        enumeration["constants"] = types.order.iter().filter(is_its).cloned().collect();
    }
    since_their_types(&mut lists);
    let number = |name: &str| types.constants[name];
    let version = ["MAJOR", "MINOR", "PATCH"].map(|part| number(&format!("BHR_VERSION_{part}")).to_string()).join(".");
    let preface = header.split("*/").next().unwrap();
    let mut whole = json!({
        "schema": { "version": 1, "documentation": "docs/bhr-json.md" },
        "name": "bhr",
        "version": version,
        "abi_version": number("BHR_ABI_VERSION"),
        "documentation": preface.trim_start_matches("/*").lines().map(|line| {
            line.strip_prefix(" * ").or(line.strip_prefix(" *")).unwrap_or(line).trim_end()
        }).collect::<Vec<_>>().join("\n").trim(),
        "sections": sections,
        "declarations": declarations,
    });
    for (list, entries) in lists {
        whole[list] = entries.into();
    }
    whole
}
