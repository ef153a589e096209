// SPDX-License-Identifier: MIT OR Apache-2.0
//! The modules of the crate as their sources declare them, and the paths that each file names: in `use`, in types,
//! calls and patterns, and in what macros are given. Knows no rule. Works on tokens, because the text between the
//! brackets of a macro is no syntax tree; comments and strings are none, or single, tokens.

use crate::root;
use proc_macro2::{Delimiter, Group, Spacing, TokenStream, TokenTree};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A module's path below the crate, such as ["gpu", "device", "texture"].
pub type Module = Vec<String>;

/// A file of the crate, without its tests.
#[derive(Default)]
pub struct File {
    pub module: Module,
    /// The modules that have files of their own, in the order in which the file declares them.
    pub children: Vec<Child>,
    /// Names that `use` brings into the file: the name, and the path that it stands for.
    names: BTreeMap<String, Named>,
    pub paths: Vec<Named>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Child {
    pub name: String,
    /// Files that `#[path]` names, beside the declaring file.
    paths: Vec<String>,
    pub only_for_tests: bool,
}

/// A path as written, and the inline modules around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    path: Vec<String>,
    inline: Vec<String>,
}

impl Named {
    pub fn text(&self) -> String {
        self.path.join("::")
    }
}

/// The files of the crate by their paths below src/, without extension; and those that only tests have.
pub struct Crate {
    pub files: BTreeMap<String, File>,
    pub for_tests: Vec<String>,
    /// The file of each module; of one that the target or a feature chooses, the usual one.
    homes: BTreeMap<Module, String>,
}

impl Crate {
    pub fn read() -> Self {
        let mut all = Self { files: BTreeMap::new(), for_tests: Vec::new(), homes: BTreeMap::new() };
        all.add(Path::new("lib.rs"), Vec::new(), false);
        all
    }

    fn add(&mut self, path: &Path, module: Module, for_tests: bool) {
        let name = path.with_extension("").to_str().unwrap().to_owned();
        let full = root().join("src").join(path);
        let text = fs::read_to_string(&full).unwrap_or_else(|error| panic!("{}: {error}", full.display()));
        let mut file = File { module: module.clone(), ..read(&text) };
        let folder = match path.file_name().unwrap().to_str().unwrap() {
            "lib.rs" | "mod.rs" => path.parent().unwrap().to_owned(),
            _ => path.with_extension(""),
        };
        for child in &file.children {
            let module = [module.as_slice(), std::slice::from_ref(&child.name)].concat();
            let for_tests = for_tests || child.only_for_tests;
            let usual = [folder.join(&child.name).with_extension("rs"), folder.join(&child.name).join("mod.rs")];
            let usual = usual.into_iter().find(|path| root().join("src").join(path).is_file());
            let others = child.paths.iter().map(|other| path.parent().unwrap().join(other));
            for path in usual.into_iter().chain(others) {
                self.add(&path, module.clone(), for_tests);
            }
        }
        if for_tests {
            self.for_tests.push(name);
            return;
        }
        file.children.retain(|child| !child.only_for_tests);
        self.homes.entry(module).or_insert_with(|| name.clone());
        self.files.insert(name, file);
    }

    /// The modules within a module, in the order of their declarations.
    pub fn children(&self, module: &[String]) -> &[Child] {
        self.homes.get(module).map_or(&[], |home| &self.files[home].children)
    }

    /// The file in which what a path names is defined; `None`: in no other file of this crate.
    pub fn home(&self, from: &File, named: &Named) -> Option<&str> {
        self.resolved(from, named, 0).and_then(|module| self.homes.get(&module)).map(String::as_str)
    }

    fn resolved(&self, from: &File, named: &Named, depth: u32) -> Option<Module> {
        // A name that stands for itself, as of another crate's path.
        if depth > 8 {
            return None;
        }
        let mut parts = named.path.iter().map(String::as_str).peekable();
        let mut here = [from.module.as_slice(), &named.inline].concat();
        match *parts.peek()? {
            "crate" => {
                here.clear();
                parts.next();
            }
            "self" | "super" => {
                while let Some(part) = parts.next_if(|part| matches!(*part, "self" | "super")) {
                    if part == "super" {
                        here.pop();
                    }
                }
            }
            first => {
                let child = [from.module.as_slice(), &[first.to_owned()]].concat();
                match from.names.get(first) {
                    // A module may have the name of a function in it that the file shows.
                    _ if self.homes.contains_key(&child) => here = from.module.clone(),
                    Some(meant) if meant != named => return self.continued(from, meant, named, depth),
                    _ => return None,
                }
            }
        }
        while let Some(part) = parts.peek() {
            let child = [here.as_slice(), &[(*part).to_owned()]].concat();
            if !self.homes.contains_key(&child) {
                break;
            }
            here = child;
            parts.next();
        }
        while !self.homes.contains_key(&here) {
            here.pop();
        }
        // A name that the module has from another one.
        let file = &self.files[&self.homes[&here]];
        if let Some(meant) = parts.next().and_then(|name| file.names.get(name)) {
            let rest = Named { path: parts.map(str::to_owned).collect(), inline: Vec::new() };
            let path = [meant.path.as_slice(), &rest.path].concat();
            let through = Named { path, inline: meant.inline.clone() };
            if let Some(home) = self.resolved(file, &through, depth + 1) {
                return Some(home);
            }
        }
        Some(here)
    }

    /// The module of a path whose first name stands for the path `meant`.
    fn continued(&self, from: &File, meant: &Named, named: &Named, depth: u32) -> Option<Module> {
        let path = [meant.path.as_slice(), &named.path[1..]].concat();
        self.resolved(from, &Named { path, inline: meant.inline.clone() }, depth + 1)
    }
}

/// A file as its text says; without the module, which lies elsewhere.
fn read(text: &str) -> File {
    let mut file = File::default();
    let tokens = text.parse::<TokenStream>().unwrap_or_else(|error| panic!("{error}: {text}"));
    file.take(tokens, &[]);
    file
}

impl File {
    fn take(&mut self, tokens: TokenStream, inline: &[String]) {
        let trees = tokens.into_iter().collect::<Vec<_>>();
        let mut attributes = Attributes::default();
        let mut at = 0;
        while at < trees.len() {
            if let Some(group) = attribute(&trees[at..]) {
                attributes.take(group);
                at += if is_punct(&trees[at + 1], '!') { 3 } else { 2 };
                continue;
            }
            let taken = std::mem::take(&mut attributes);
            let rest = &trees[at..];
            at += match &rest[0] {
                // A visibility imports nothing.
                TokenTree::Ident(word) if *word == "pub" => {
                    attributes = taken;
                    1 + usize::from(matches!(rest.get(1), Some(TokenTree::Group(group)) if is_place(group)))
                }
                TokenTree::Ident(word) if *word == "mod" && matches!(rest.get(1), Some(TokenTree::Ident(_))) => {
                    self.take_module(&rest[1..], taken, inline)
                }
                _ if taken.only_for_tests => length_of_item(rest),
                TokenTree::Ident(word) if *word == "use" && !rest.get(1).is_some_and(|next| is_punct(next, '<')) => {
                    let length = rest.iter().position(|tree| is_punct(tree, ';')).unwrap_or(rest.len());
                    self.take_use(&rest[1..length], &[], inline);
                    length
                }
                TokenTree::Ident(_) => {
                    let (path, length) = path(rest);
                    if path.len() > 1 {
                        self.paths.push(Named { path, inline: inline.to_vec() });
                    }
                    length
                }
                // Behind `::` without a name before it: of a type in brackets, or of another crate.
                TokenTree::Punct(_) if is_colons(rest) => 2 + path(&rest[2..]).1,
                TokenTree::Group(group) => {
                    self.take(group.stream(), inline);
                    1
                }
                TokenTree::Punct(_) | TokenTree::Literal(_) => 1,
            };
        }
    }

    /// Takes a module from its name on, and says how many tokens are done with the word before.
    fn take_module(&mut self, trees: &[TokenTree], attributes: Attributes, inline: &[String]) -> usize {
        let name = trees[0].to_string();
        let Attributes { only_for_tests, paths } = attributes;
        match trees.get(1) {
            Some(TokenTree::Group(body)) if !only_for_tests => {
                self.take(body.stream(), &[inline, &[name]].concat());
            }
            Some(TokenTree::Punct(_)) => self.children.push(Child { name, paths, only_for_tests }),
            _ => {}
        }
        3
    }

    fn take_use(&mut self, tree: &[TokenTree], before: &[String], inline: &[String]) {
        let mut path = before.to_vec();
        let mut name = None;
        let mut trees = tree.iter();
        while let Some(part) = trees.next() {
            match part {
                TokenTree::Ident(word) if *word == "as" => name = trees.next().map(ToString::to_string),
                TokenTree::Ident(word) if *word == "self" && !path.is_empty() => {}
                TokenTree::Ident(word) => path.push(word.to_string()),
                TokenTree::Punct(punct) if punct.as_char() == '*' => name = Some("*".to_owned()),
                TokenTree::Group(group) => {
                    let trees = group.stream().into_iter().collect::<Vec<_>>();
                    for item in trees.split(|tree| is_punct(tree, ',')).filter(|item| !item.is_empty()) {
                        self.take_use(item, &path, inline);
                    }
                    return;
                }
                TokenTree::Punct(_) | TokenTree::Literal(_) => {}
            }
        }
        let Some(name) = name.or_else(|| path.last().cloned()) else { return };
        let named = Named { path, inline: inline.to_vec() };
        self.paths.push(named.clone());
        self.names.insert(name, named);
    }
}

/// The attributes before an item, as far as they decide where and when it is there.
#[derive(Default)]
struct Attributes {
    only_for_tests: bool,
    paths: Vec<String>,
}

impl Attributes {
    fn take(&mut self, group: &Group) {
        let trees = group.stream().into_iter().collect::<Vec<_>>();
        let words = group.stream().to_string().split_whitespace().collect::<String>();
        self.only_for_tests |= words == "cfg(test)" || words.starts_with("cfg(all(test,");
        let inner = match &trees[..] {
            [TokenTree::Ident(word), TokenTree::Group(inner)] if *word == "cfg_attr" => {
                inner.stream().into_iter().collect()
            }
            _ => trees,
        };
        for three in inner.windows(3) {
            if three[0].to_string() == "path" && is_punct(&three[1], '=') {
                self.paths.push(three[2].to_string().trim_matches('"').to_owned());
            }
        }
    }
}

/// The brackets of the attribute that begins here.
fn attribute(trees: &[TokenTree]) -> Option<&Group> {
    let group = match trees {
        [mark, TokenTree::Group(group), ..] if is_punct(mark, '#') => group,
        [mark, inner, TokenTree::Group(group), ..] if is_punct(mark, '#') && is_punct(inner, '!') => group,
        _ => return None,
    };
    (group.delimiter() == Delimiter::Bracket).then_some(group)
}

/// Whether the brackets say where an item is visible.
fn is_place(group: &Group) -> bool {
    let first = group.stream().into_iter().next().map(|tree| tree.to_string());
    group.delimiter() == Delimiter::Parenthesis
        && first.is_some_and(|word| matches!(word.as_str(), "crate" | "in" | "self" | "super"))
}

/// Tokens of the item, field or arm that begins here.
fn length_of_item(trees: &[TokenTree]) -> usize {
    const ITEMS: [&str; 10] =
        ["const", "enum", "fn", "impl", "macro_rules", "static", "struct", "trait", "type", "unsafe"];
    let is_item = matches!(&trees[0], TokenTree::Ident(word) if ITEMS.iter().any(|item| word == item));
    let ends = |tree: &TokenTree| match tree {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        TokenTree::Punct(punct) => punct.as_char() == ';' || (punct.as_char() == ',' && !is_item),
        TokenTree::Ident(_) | TokenTree::Literal(_) => false,
    };
    trees.iter().position(ends).map_or(trees.len(), |end| end + 1)
}

/// The path that begins here, and its tokens.
fn path(trees: &[TokenTree]) -> (Vec<String>, usize) {
    let (mut path, mut at) = (Vec::new(), 0);
    while let Some(TokenTree::Ident(word)) = trees.get(at) {
        path.push(word.to_string());
        at += 1;
        if !(is_colons(&trees[at..]) && matches!(trees.get(at + 2), Some(TokenTree::Ident(_)))) {
            break;
        }
        at += 2;
    }
    (path, at)
}

fn is_punct(tree: &TokenTree, mark: char) -> bool {
    matches!(tree, TokenTree::Punct(punct) if punct.as_char() == mark)
}

/// Whether `::` begins here.
fn is_colons(trees: &[TokenTree]) -> bool {
    matches!(trees, [TokenTree::Punct(first), second, ..]
        if first.as_char() == ':' && first.spacing() == Spacing::Joint && is_punct(second, ':'))
}

/// Every source file below src/, without extension.
pub fn sources() -> Vec<String> {
    let source = root().join("src");
    let mut found = Vec::<PathBuf>::new();
    crate::files(&source, &mut found);
    let rust = found.into_iter().filter(|path| path.extension().is_some_and(|e| e == "rs"));
    rust.map(|path| path.strip_prefix(&source).unwrap().with_extension("").to_str().unwrap().to_owned()).collect()
}

/// The paths of a text, each once.
fn paths_of(text: &str) -> std::collections::BTreeSet<String> {
    read(text).paths.iter().map(Named::text).collect()
}

#[test]
fn paths_are_found_wherever_they_stand() {
    let found = paths_of(
        r#"
        //! crate::of::a_comment
        use super::imported::{self, inner::{A, B as C}, *};
        pub(in crate::a::visibility) struct S<'a> { field: super::in_a_type::T<super::in_generics::T>, x: &'a u8 }
        /// [`crate::of::a_document`]
        fn f(x: impl crate::of::a_bound) -> Vec<u8> where u8: super::super::of_a_where::W {
            use crate::within_a_function::F;
            let text = "crate::of::a_string";
            if let super::in_a_pattern::P { y: 1 } = self::in_a_call::g(text)?.h::<super::of_a_method::M>() {}
            crate::a_macro!(1, super::in_a_macro::X);
            println!("{:?}", [crate::in_a_nested_macro::Y; 2]);
            <u8 as crate::of_a_trait::T>::of_a_type::no(::other_crate::no);
        }
        macro_rules! m { ($x:expr) => { $crate::in_a_rule::Z($x) } }
        mod inline { use super::super::above::I; }
        #[cfg(test)]
        use crate::for_tests::U;
        #[cfg(test)]
        fn for_tests<A, B>(x: crate::for_tests::T) { crate::for_tests::f() }
        #[cfg(test)]
        mod tests { use crate::for_tests::M; }
        "#,
    );
    let expected = "super::imported super::imported::inner::A super::imported::inner::B super::in_a_type::T
        super::in_generics::T crate::of::a_bound super::super::of_a_where::W crate::within_a_function::F
        super::in_a_pattern::P self::in_a_call::g super::of_a_method::M crate::a_macro super::in_a_macro::X
        crate::in_a_nested_macro::Y crate::of_a_trait::T crate::in_a_rule::Z super::super::above::I";
    assert_eq!(found, expected.split_whitespace().map(str::to_owned).collect());
}

#[test]
fn modules_are_found_as_they_are_declared() {
    let file = read(
        "mod b; pub(in crate::x) mod a; mod inline { fn f() {} } #[cfg(test)] mod tests; \
         #[cfg_attr(not(feature = \"f\"), path = \"other.rs\")] mod c; #[path = \"elsewhere.rs\"] mod d;",
    );
    let child = |name: &str, paths: &[&str], only_for_tests| Child {
        name: name.to_owned(),
        paths: paths.iter().map(ToString::to_string).collect(),
        only_for_tests,
    };
    let expected = [
        child("b", &[], false),
        child("a", &[], false),
        child("tests", &[], true),
        child("c", &["other.rs"], false),
        child("d", &["elsewhere.rs"], false),
    ];
    assert_eq!(file.children, expected);
}

#[test]
fn names_are_followed_to_their_homes() {
    let read_as = |module: &[&str], text: &str| {
        let module = module.iter().map(ToString::to_string).collect::<Vec<_>>();
        (module.join("/"), File { module, ..read(text) })
    };
    let files = BTreeMap::from([
        read_as(&[], "mod a; mod b; mod same; pub use same::{same, Other};"),
        read_as(&["same"], "pub fn same() {} pub struct Other;"),
        read_as(&["a"], "mod deep; pub use deep::Shown; use self::deep as renamed; fn f() { renamed::g() }"),
        read_as(&["a", "deep"], "pub struct Shown;"),
        read_as(
            &["b"],
            "use crate::a; fn f(x: a::Shown, y: super::a::Own, z: super::Other) { a::deep::g(); std::mem::drop(x) }",
        ),
    ]);
    let homes = files.iter().map(|(name, file)| (file.module.clone(), name.clone())).collect();
    let all = Crate { files, for_tests: Vec::new(), homes };
    let homes_from = |name: &str| {
        let file = &all.files[name];
        let found = file.paths.iter().map(|named| format!("{} {}", named.text(), all.home(file, named).unwrap_or("-")));
        found.collect::<Vec<_>>()
    };
    assert_eq!(homes_from("a"), ["deep::Shown a/deep", "self::deep a/deep", "renamed::g a/deep"]);
    let of_b = [
        "crate::a a",
        "a::Shown a/deep",
        "super::a::Own a",
        "super::Other same",
        "a::deep::g a/deep",
        "std::mem::drop -",
    ];
    assert_eq!(homes_from("b"), of_b);
}
