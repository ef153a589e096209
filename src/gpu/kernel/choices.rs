// SPDX-License-Identifier: MIT OR Apache-2.0
//! The table of the choices that kernels are compiled with: an `override` constant of WGSL each, which kernels read it,
//! and where it makes no difference. Keys, constants and the number of kernels that can exist follow from it. Knows no
//! kernel but by the bits in [`readers`]; key/tests.rs holds the table against the joined WGSL.

use readers::*;

/// Sets of kernels, as bits.
pub mod readers {
    /// The kernels of traced/pixels.wgsl, and of these the one that keeps the records that are there.
    pub const PIXELS: u32 = 1 << 16;
    pub const LISTED: u32 = 1 << 17;
    pub const FILL: u32 = 1 << 18;
    pub const RAYS: u32 = 1 << 19;
    /// Kernels that develop (film/film.wgsl) into buffers, and into images of three formats.
    pub const PACKED: u32 = 1 << 20;
    pub const SCREEN: u32 = 1 << 21;
    pub const RGBA32F: u32 = 1 << 22;
    pub const R32F: u32 = 1 << 23;
    pub const FILM: u32 = PACKED | SCREEN | RGBA32F | R32F;
    pub const GLARE: u32 = 1 << 24;
    pub const GATHER: u32 = 1 << 25;
    /// Kernels that make the tables of spin-0 and of Kerr lenses.
    pub const ENDS: u32 = 1 << 26;
    pub const COLUMNS: u32 = 1 << 27;
    pub const NODES: u32 = 1 << 28;
    pub const FLAGS: u32 = 1 << 29;
    /// Kernels that develop light which has been measured.
    pub const METERED: u32 = 1 << 30;
    /// Kernels that go over records, by what they do with them; `RecordMaker` has the bit among the four of each.
    pub const SHADE: u32 = 0xf;
    pub const REFINE: u32 = 0xf0;
    pub const EXPORT: u32 = 0xf00;
    pub const OUTPUTS: u32 = 0xf000;
    /// Kernels that go over records, by the maker of those.
    pub const TRACED: u32 = 0x1111;
    pub const SPIN_0: u32 = 0x2222;
    pub const KERR: u32 = 0x4444;
    pub const DEFERRED: u32 = 0x8888;
    pub const OF_RECORDS: u32 = SHADE | REFINE | EXPORT | OUTPUTS;
    /// Kernels that integrate rays as the scene asks for; other kernels do it as AUTO does.
    pub const TRACING: u32 = PIXELS | RAYS | (REFINE & TRACED);
    /// Kernels that ask matter with depth along rays.
    pub const MATTER: u32 = PIXELS | (REFINE & TRACED);
}

/// A condition for a choice to make a difference. Choices that the kernel does not read meet it.
#[derive(Clone, Copy)]
pub enum Only {
    /// Where one of the choices has the value.
    AnyOf(&'static [(Choice, u32)]),
    /// Where none of the choices has the value.
    NoneOf(&'static [(Choice, u32)]),
}

/// A row of the table.
pub struct Row {
    #[cfg_attr(not(test), allow(dead_code, reason = "tests read it"))]
    pub choice: Choice,
    /// The name of the `override` constant.
    pub constant: &'static str,
    /// The values that scenes ask for, which tests go through.
    #[cfg_attr(not(test), allow(dead_code, reason = "tests read it"))]
    pub values: &'static [u32],
    /// Kernels that read the choice as the scene has it.
    pub read_by: u32,
    /// Kernels that have one value of it, whatever the scene, and the value.
    pub set_by: &'static [(u32, u32)],
    /// The choice makes a difference only where all of these hold.
    pub only: &'static [Only],
}

impl Row {
    /// The value that a kernel sets, whatever the scene.
    pub fn set_for(&self, kernel: u32) -> Option<u32> {
        self.set_by.iter().find(|(set_by, _)| kernel & set_by != 0).map(|(_, value)| *value)
    }
}

macro_rules! or_else {
    ($default:expr $(;)?) => {
        $default
    };
    ($default:expr; $given:expr) => {
        $given
    };
}

macro_rules! table {
    ($($constant:ident: $values:expr, $read_by:expr $(, set $set:expr)? $(, only $($only:expr),+)?;)*) => {
        /// A choice, by the name of its constant.
        #[allow(non_camel_case_types, clippy::upper_case_acronyms, reason = "the names that WGSL has")]
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Choice { $($constant),* }

        const CHOICES: usize = [$(Choice::$constant),*].len();

        /// A row for each [`Choice`], in their order; `only` asks of rows before its own.
        pub const TABLE: [Row; CHOICES] = [$(Row {
            choice: Choice::$constant,
            constant: stringify!($constant),
            values: &$values,
            read_by: $read_by,
            set_by: &or_else!([]; $($set)?),
            only: &[$($($only),+)?],
        }),*];
    };
}

const FLAG: [u32; 2] = [0, 1];
// Conditions, by what holds where they are met.
const LIGHT: Only = Only::AnyOf(&[(Choice::SHOWS_LIGHT, 1)]);
const MAPS: Only = Only::AnyOf(&[(Choice::SHOWS_MILKY_WAY, 1), (Choice::SHOWS_MAP, 1)]);
const VIEWS_OF_LIGHT: Only = Only::NoneOf(&[(Choice::SHOWS_DEPTH, 1)]);
const PLACES_KNOWN: Only = Only::AnyOf(&[(Choice::FOOTPRINTS, 1)]);
const MIXED: Only = Only::AnyOf(&[(Choice::POWER_LAW, 1)]);
const SPINS: Only = Only::AnyOf(&[(Choice::SPINNING, 1)]);
const DEPTH: Only = Only::AnyOf(&[(Choice::PARTS, 1)]);
/// The numbers are those of `PixelKind`.
const EIGHT_BIT: Only = Only::NoneOf(&[(Choice::PIXELS, 1), (Choice::PIXELS, 2), (Choice::PIXELS, 3)]);
const CODES: Only = Only::NoneOf(&[(Choice::PIXELS, 1), (Choice::PIXELS, 2)]);
const TONED: Only = Only::NoneOf(&[(Choice::FALSE_COLOUR, 1)]);

/// 1 to N: sets that are not empty, as bits.
const fn sets<const N: usize>() -> [u32; N] {
    let mut all = [0; N];
    let mut i = 0;
    while i < N {
        all[i] = i as u32 + 1;
        i += 1;
    }
    all
}

// Constant: values that scenes ask for, kernels that read the scene's; values that some kernels set; and where the
// choice makes a difference. Left out are kernels that mention a constant and leave it at WGSL's default, which
// key/tests.rs lists.
table! {
    METHOD: [0, 1, 2], TRACING;
    SPINNING: FLAG, TRACING, set [(SPIN_0 | ENDS | COLUMNS, 0)];
    DELAY: FLAG, TRACING | COLUMNS | NODES | (OF_RECORDS & !TRACED), set [(ENDS, 0)];
    STEP_LIMIT: FLAG, TRACING;
    RAIN: FLAG, TRACING | KERR | DEFERRED | NODES, only SPINS;
    AZIMUTH: FLAG, PIXELS;
    KEEPS_RECORD: [], 0, set [(LISTED, 0)];
    OWN_RECORDS: FLAG, FILL;
    PATTERN: FLAG, KERR | DEFERRED | NODES | FLAGS;
    MOVING: FLAG, OF_RECORDS & !TRACED;
    PARTS: FLAG, MATTER;
    SHAPES: sets::<31>(), MATTER, only DEPTH;
    MOTIONS: sets::<15>(), MATTER, only DEPTH;
    POWER_LAW: FLAG, MATTER, only DEPTH;
    THERMAL: FLAG, MATTER, only DEPTH, MIXED;
    SHOWS_DEPTH: FLAG, PIXELS | FILL, set [(REFINE & TRACED, 0)], only DEPTH;
    STRUCTURE: FLAG, MATTER, only DEPTH;
    ALONE: FLAG, MATTER, only DEPTH;
    PROJECTION: [0, 1, 2, 3, FROM_UNIFORM], PIXELS | FILL | OF_RECORDS;
    SHOWS_LIGHT: FLAG, SHADE, set [(REFINE, 1)];
    SHOWS_STARS: FLAG, SHADE | REFINE, only LIGHT;
    SHOWS_MILKY_WAY: FLAG, SHADE | REFINE, only LIGHT;
    SHOWS_MAP: FLAG, SHADE | REFINE, only LIGHT;
    SHOWS_GRID: FLAG, SHADE | REFINE, only LIGHT;
    MAP_SAMPLER: FLAG, SHADE | REFINE, only MAPS;
    PLANE: FLAG, REFINE | ((SHADE | OUTPUTS) & !DEFERRED);
    OPAQUE: FLAG, SHADE, set [(REFINE, 0)];
    WHOLE_PLANE: [], 0, set [(REFINE, 1)];
    PLACES: [], 0, set [(OUTPUTS & SPIN_0, 1)];
    FOOTPRINTS: FLAG, SHADE | REFINE | EXPORT, set [(OUTPUTS, 0)];
    VOLUMES: FLAG, SHADE | REFINE | OUTPUTS;
    TURBULENT: FLAG, SHADE | REFINE, only LIGHT, PLACES_KNOWN;
    REFINES: FLAG, SHADE;
    ALL_EFFECTS: FLAG, SHADE | REFINE | PIXELS, only LIGHT, VIEWS_OF_LIGHT;
    OCCLUDED: FLAG, SHADE | REFINE | PIXELS;
    PIXELS: [0, 1, 2, 3, FROM_UNIFORM], PACKED, set [(SCREEN, 0), (RGBA32F, 1), (R32F, 2)];
    FALSE_COLOUR: FLAG, FILM, only EIGHT_BIT;
    TONE_MAP: [0, 1, 2, 3, FROM_UNIFORM], FILM, only EIGHT_BIT, TONED;
    COLOUR_MAP: [0, 1, FROM_UNIFORM], FILM, only EIGHT_BIT, TONED;
    GRADE: [0, 1, FROM_UNIFORM], FILM, only CODES, TONED;
    LUT: FLAG, FILM, only EIGHT_BIT, TONED;
    // The bloom's cells, in pixels, of frames up to 16384 x 8192.
    STEP: [2, 4, 6, 8], GATHER | GLARE;
    GRID: FLAG, GATHER;
    LOCAL: FLAG, METERED;
}

/// The value of a choice that the kernel asks the uniform for while it runs.
pub const FROM_UNIFORM: u32 = u32::MAX;
/// The value of a choice that no variant makes: WGSL's default holds.
const NOT_MADE: u32 = u32::MAX - 1;

/// The values of choices, each by its row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Values([u32; CHOICES]);

/// Choices that belong together.
pub trait Variant {
    fn make(&self, values: &mut Values);
}

/// Choices by themselves.
impl<const N: usize> Variant for [(Choice, u32); N] {
    fn make(&self, values: &mut Values) {
        self.iter().for_each(|(choice, value)| values.make(*choice, *value));
    }
}

impl Values {
    /// The values that decide what a kernel is: those of `variants`, of which later ones count first, as far as the
    /// kernel reads them; 0 where they make no difference there. `kernel`: its bits.
    pub fn of(kernel: u32, variants: &[&dyn Variant]) -> Self {
        let mut values = Self([NOT_MADE; CHOICES]);
        variants.iter().for_each(|variant| variant.make(&mut values));
        for (index, row) in TABLE.iter().enumerate() {
            let read = (kernel & row.read_by != 0).then_some(values.0[index]);
            values.0[index] = match row.set_for(kernel).or(read) {
                Some(value) if value == NOT_MADE || values.meet(row.only) => value,
                Some(_) => 0,
                None => NOT_MADE,
            };
        }
        values
    }

    pub fn make(&mut self, choice: Choice, value: u32) {
        self.0[choice as usize] = value;
    }

    fn meet(&self, conditions: &[Only]) -> bool {
        let value = |choice: Choice| self.0[choice as usize];
        conditions.iter().all(|only| match only {
            Only::AnyOf(list) => list.iter().any(|(choice, one)| [*one, NOT_MADE].contains(&value(*choice))),
            Only::NoneOf(list) => !list.iter().any(|(choice, one)| *one == value(*choice)),
        })
    }

    /// The constants that they stand for, by name.
    pub fn constants(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let made = TABLE.iter().zip(&self.0).filter(|(_, value)| **value != NOT_MADE);
        made.map(|(row, value)| (row.constant, f64::from(*value)))
    }
}
