// SPDX-License-Identifier: MIT OR Apache-2.0
//! The numbers that shaders share with Rust, by their names in WGSL: the fragment `constants` is printed from them, so
//! that neither side can change alone. What each one means stands where Rust declares it.

use super::choices::FROM_UNIFORM;
use super::sizes;
use super::variant::{MethodCode, MotionCode, PixelKind, ROWS_GROUP, SHAPE_FREE_SPOT, SHAPE_SPOT};
use super::variant::{SKY_SOURCE_FLOAT, SKY_SOURCE_LEVEL};
use crate::emit::free_spot::TABLE_NODES;
use crate::emit::hot_spot::HotSpot;
use crate::emit::volume::{Shape, Volume};
use crate::emit::{
    along, baked, baking, bands, clouds, crossing, filaments, glow, half, layers, matter, medium, shape, streaks,
    turbulence, volumes,
};
use crate::film::bloom::{BEAM_SHARES, GHOST_PAIRS, SPIKE_ELEMENTS, SPIKE_TERMS};
use crate::film::hdr;
use crate::film::{self, colour_map, grade, metering, tone_map};
use crate::image::PixelFormat;
use crate::physics::integrator::{self, Method};
use crate::physics::lens::{critical, kerr, schwarzschild};
use crate::physics::observer::Observer;
use crate::physics::trace::{CROSSINGS_KEPT, Fate};
use crate::physics::{blackbody, flow, geodesic, quadrature};
use crate::scene::cell;
use crate::scene::occluder::{BEYOND_ALL, NO_THING};
use crate::scene::refine::{self, Edge};
use crate::scene::{ColourMap, MAX_CROSSINGS, MOST_OUTPUTS, Projection, RayOutputKind, ToneMap, View};
use crate::sky::{filter, galaxy, grid, index, shift, stars};

/// A value, before it is printed. Printing each where it is named would make a function of 68 KB.
enum Value {
    U32(u32),
    I32(i32),
    F32(f32),
    /// Vectors, arrays and matrices: the type, and its numbers.
    Many(String, Vec<f32>),
}

impl Value {
    /// The type and the value, as WGSL.
    fn wgsl(&self) -> String {
        match self {
            Self::U32(value) => format!("u32 = {value}u"),
            Self::I32(value) => format!("i32 = {value}"),
            // Every compiler reads this as the number: the shortest decimal of the largest is above it, which Chrome's
            // refuses.
            Self::F32(f32::MAX) => "f32 = 0x1.fffffep+127".to_owned(),
            Self::F32(value) => format!("f32 = {value:?}"),
            Self::Many(kind, values) => {
                let list = values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ");
                format!("{kind} = {kind}({list})")
            }
        }
    }
}

/// A value of a kind.
macro_rules! value {
    (u32 $value:expr) => {
        Value::U32($value as u32)
    };
    (i32 $value:expr) => {
        Value::I32($value as i32)
    };
    (f32 $value:expr) => {
        Value::F32($value as f32)
    };
    (vec2 $value:expr) => {
        Value::Many("vec2<f32>".to_owned(), $value.map(|v| v as f32).to_vec())
    };
    (vec3 $value:expr) => {
        Value::Many("vec3<f32>".to_owned(), $value.map(|v| v as f32).to_vec())
    };
    (vec4 $value:expr) => {
        Value::Many("vec4<f32>".to_owned(), $value.map(|v| v as f32).to_vec())
    };
    (array $value:expr) => {
        Value::Many(format!("array<f32, {}>", $value.len()), $value.map(|v| v as f32).to_vec())
    };
    (mat3x2 $value:expr) => {
        Value::Many("mat3x2<f32>".to_owned(), $value.into_iter().flatten().collect())
    };
}

/// Constants by name, kind and value.
macro_rules! constants {
    ($($name:ident: $kind:ident = $value:expr;)*) => { vec![$((stringify!($name), value!($kind $value))),*] };
}

/// The fragment.
pub fn fragment() -> String {
    all().into_iter().map(|(name, value)| format!("const {name}: {};\n", value.wgsl())).collect()
}

/// Each with its name.
fn all() -> Vec<(&'static str, Value)> {
    constants! {
        OUTPUT_DEPTH: u32 = RayOutputKind::Depth;
        OUTPUT_SKY: u32 = RayOutputKind::Sky;
        OUTPUT_TRANSMISSION: u32 = RayOutputKind::Transmission;
        OUTPUT_POSITION: u32 = RayOutputKind::Position;
        OUTPUT_DISK: u32 = RayOutputKind::Disk;
        OUTPUT_REDSHIFT: u32 = RayOutputKind::Redshift;
        OUTPUT_ORDER: u32 = RayOutputKind::Order;
        OUTPUT_DEFLECTION: u32 = RayOutputKind::Deflection;
        MOST_OUTPUTS: u32 = MOST_OUTPUTS;
        BEYOND_ALL: f32 = BEYOND_ALL;
        NO_THING: f32 = NO_THING;
        FATE_CAPTURED: u32 = Fate::Captured;
        FATE_ESCAPED: u32 = Fate::Escaped;
        FATE_UNRESOLVED: u32 = Fate::Unresolved;
        FATE_HIDDEN: u32 = Fate::Hidden;
        CLOCK_COORDINATE: u32 = geodesic::Clock::Coordinate;
        CLOCK_RAIN: u32 = geodesic::Clock::Rain;
        METHOD_RK4: u32 = MethodCode::from(Method::Rk4).0;
        METHOD_DORMAND_PRINCE: u32 = MethodCode::from(Method::DormandPrince).0;
        B1: f32 = integrator::B[0];
        B2: f32 = integrator::B[1];
        B3: f32 = integrator::B[2];
        D1: f32 = integrator::D[0];
        D2: f32 = integrator::D[1];
        D3: f32 = integrator::D[2];
        D4: f32 = integrator::D[3];
        CROSSINGS_KEPT: u32 = CROSSINGS_KEPT;
        RAY_CROSSINGS: u32 = MAX_CROSSINGS;

        LENS_PER_OCTAVE: i32 = sizes::SCHWARZSCHILD_PER_OCTAVE;
        LENS_OCTAVES: f32 = sizes::SCHWARZSCHILD_OCTAVES;
        LENS_INTERVALS: u32 = sizes::SCHWARZSCHILD_INTERVALS;
        LENS_INNER_END: f32 = schwarzschild::CAPTURE_U;
        KERR_COLUMNS: u32 = sizes::KERR_COLUMNS;
        KERR_PER_OCTAVE: u32 = sizes::KERR_PER_OCTAVE;
        KERR_OCTAVES: f32 = kerr::CORE_OCTAVES;
        KERR_ROWS_BELOW: u32 = kerr::ROWS_BELOW;
        KERR_ROWS_ABOVE: u32 = kerr::ROWS_ABOVE;
        KERR_CURVE: u32 = critical::CRITICAL_NODES;
        AT_HORIZON: f32 = critical::AT_HORIZON;
        MARGIN_OF_ALL: u32 = critical::ByMargin::All;
        SWIFT_GAMMA: f32 = Observer::SWIFT;
        KERR_NO_CROSSING: f32 = kerr::NO_CROSSING;
        KERR_NARROW_REACH: f32 = kerr::NARROW_REACH;
        KERR_NARROW_REACH_INWARDS: f32 = kerr::NARROW_REACH_INWARDS;
        KERR_DIRECT: u32 = kerr::DIRECT;
        KERR_TOLERANCE: f32 = kerr::TOLERANCE;
        KERR_BEYOND: f32 = kerr::BEYOND_INFINITY;
        KERR_INWARD: f32 = kerr::INWARD;
        KERR_LEAVES_DORAN: f32 = kerr::LEAVES_DORAN;

        VIEW_REDSHIFT: u32 = View::Redshift;
        VIEW_ORDER: u32 = View::Order;
        VIEW_DEFLECTION: u32 = View::Deflection;
        VIEW_STEPS: u32 = View::Steps;
        VIEW_METRIC: u32 = View::Metric;
        VIEW_OPTICAL_DEPTH: u32 = View::OpticalDepth;
        VIEW_INTENSITY: u32 = View::Intensity;
        PERSPECTIVE: u32 = Projection::Perspective;
        FISHEYE: u32 = Projection::Fisheye;
        EQUIRECT: u32 = Projection::Equirect;
        CUBE: u32 = Projection::Cube;

        EDGE_NONE: u32 = Edge::None;
        EDGE_DISK: u32 = Edge::Disk;
        EDGE_CURVE: u32 = Edge::Curve;
        EDGE_SAMPLES: u32 = refine::EDGE_SAMPLES;
        CURVE_REACH: f32 = refine::CURVE_REACH;
        FAST_TURN: f32 = refine::FAST_TURN;
        TURN: f32 = refine::TURN;
        UNKNOWN_TURN: f32 = refine::UNKNOWN_TURN;
        AROUND_AXIS: f32 = geodesic::AROUND_AXIS;
        CURVE_SAMPLES: u32 = refine::CURVE_SAMPLES;
        NARROWEST: f32 = refine::NARROWEST;
        MATTER_NARROWEST: f32 = refine::MATTER_NARROWEST;
        CAPTURED_DENSITY: f32 = refine::CAPTURED_DENSITY;
        MATTER_CAPTURED_DENSITY: f32 = refine::MATTER_CAPTURED_DENSITY;
        FEWEST_STRIPS: u32 = refine::FEWEST_STRIPS;
        FARTHEST: f32 = refine::FARTHEST;
        BENT: f32 = refine::BENT;
        SEARCH_REACH: f32 = refine::SEARCH_REACH;
        SEARCH_STEPS: u32 = refine::SEARCH_STEPS;
        LEVEL_STEP: f32 = refine::LEVEL_STEP;
        EVEN_LEVEL: f32 = refine::EVEN_LEVEL;
        EDGE_REACH: f32 = refine::EDGE_REACH;
        STEEP_CHANGE: f32 = refine::STEEP_CHANGE;
        DIM_CHANGE: f32 = refine::DIM_CHANGE;
        LEAST_DIM_CHANGE: f32 = refine::LEAST_DIM_CHANGE;
        UNKNOWN_STEP: f32 = crossing::UNKNOWN_STEP;
        EVEN_CHANGE: f32 = refine::EVEN_CHANGE;
        LEAST_SLOPE: f32 = cell::LEAST_SLOPE;
        DIRECT_CHANGE: f32 = refine::DIRECT_CHANGE;
        PARTIAL_REACH: f32 = refine::PARTIAL_REACH;
        DISK_REACH_OUTWARDS: f32 = refine::DISK_REACH[0];
        DISK_REACH_INWARDS: f32 = refine::DISK_REACH[1];

        BLACKBODY_SIZE: u32 = blackbody::BLACKBODY_SIZE;
        MIN_TEMPERATURE: f32 = blackbody::MIN_TEMPERATURE;
        MAX_TEMPERATURE: f32 = blackbody::MAX_TEMPERATURE;
        COORDINATE_TEMPERATURE: f32 = blackbody::COORDINATE_TEMPERATURE;
        WIEN_TEMPERATURE: f32 = blackbody::WIEN_TEMPERATURE;
        FIT_TEMPERATURE: f32 = blackbody::FIT_TEMPERATURE;
        FIT_END: f32 = blackbody::FIT_END;
        FIT_RED: array = blackbody::FIT_RED;
        FIT_BLUE: array = blackbody::FIT_BLUE;
        FIT_LUMINANCE: array = blackbody::FIT_LUMINANCE;
        MAX_RATIO: f32 = blackbody::MAX_RATIO;
        MAX_LN_RATIO: f32 = blackbody::MAX_LN_RATIO;
        MAX_BEAMING: f32 = blackbody::MAX_BEAMING;
        STREAK_COLUMNS: u32 = streaks::STREAK_COLUMNS;
        STREAK_ROWS: u32 = streaks::STREAK_ROWS;
        STREAK_PERIOD: f32 = streaks::STREAK_PERIOD;
        STREAK_LAST: u32 = streaks::STREAK_LAST;
        STREAK_CUMULANTS: vec3 = streaks::STREAK_CUMULANTS;
        STREAK_TAPS: f32 = streaks::STREAK_TAPS;
        LARGE_PIXEL: f32 = turbulence::LARGE_PIXEL;
        TEXELS_AROUND: f32 = turbulence::TEXELS_AROUND;
        TEXELS_ACROSS: f32 = turbulence::TEXELS_ACROSS;
        STREAK_TEXEL: f32 = streaks::STREAK_TEXEL;
        STREAK_WHOLE: f32 = streaks::STREAK_WHOLE;
        SKY_SOURCE_FLOAT: u32 = SKY_SOURCE_FLOAT;
        SKY_SOURCE_LEVEL: u32 = SKY_SOURCE_LEVEL;
        BAND: f32 = bands::BAND;
        BAND_FADE: f32 = bands::BAND_FADE;
        PLUNGE_FADE: f32 = turbulence::PLUNGE_FADE;
        GENERATION_FADE: f32 = bands::GENERATION_FADE;
        MOST_BANDS: u32 = bands::MOST_BANDS;
        OFFSET_PAIRS: u32 = sizes::OFFSET_PAIRS;
        FILAMENT_COLUMNS: f32 = filaments::FILAMENT_SIDES[0];
        FILAMENT_ROWS: f32 = filaments::FILAMENT_SIDES[1];
        FILAMENT_LAYERS: f32 = filaments::FILAMENT_SIDES[2];
        FILAMENT_HEIGHT: f32 = filaments::FILAMENT_HEIGHT;
        FILAMENT_LAST: u32 = filaments::FILAMENT_LAST;
        FILAMENT_LEVELS: u32 = filaments::FILAMENT_LEVELS;
        FILAMENT_SKEW: f32 = filaments::FILAMENT_CUMULANTS[0];
        FILAMENT_KURTOSIS: f32 = filaments::FILAMENT_CUMULANTS[1];
        CLOUD_SHARP: f32 = clouds::CLOUD_SHARP;
        CLOUD_COARSE: f32 = clouds::CLOUD_COARSE;
        LEAST_CARRIED: f32 = clouds::LEAST_CARRIED;
        ROW_GENERATIONS: u32 = baking::ROW_GENERATIONS;
        LEAST_FACTOR: f32 = baked::LEAST_FACTOR;
        MOST_FACTOR: f32 = baked::MOST_FACTOR;
        CLOUD_SPACING: f32 = clouds::CLOUD_SPACING;
        SHEAR: f32 = clouds::SHEAR;
        HALF_SHEARED: f32 = clouds::HALF_SHEARED;
        LEAST_B: f32 = clouds::LEAST_B;
        OPPOSITE: f32 = shape::OPPOSITE;
        MOST_VOLUMES: u32 = Volume::MOST;
        THICK: f32 = medium::THICK;
        GAUSS_NODES: vec3 = quadrature::GAUSS_NODES;
        GAUSS_WEIGHTS: vec3 = quadrature::GAUSS_WEIGHTS;
        GAUSS_BEFORE_0: vec3 = quadrature::GAUSS_BEFORE[0];
        GAUSS_BEFORE_1: vec3 = quadrature::GAUSS_BEFORE[1];
        GAUSS_BEFORE_2: vec3 = quadrature::GAUSS_BEFORE[2];
        BLOCK: i32 = half::BLOCK;
        HALF_LEAST_SHARE: f32 = half::LEAST_SHARE;
        HALF_LEAST_DEPTH: f32 = half::LEAST_DEPTH;
        HALF_CUBIC: vec4 = half::CUBIC;
        HALF_LINE: vec4 = half::LINE;
        OFF_LINE: f32 = half::OFF_LINE;
        PIECE_LN_R: f32 = volumes::PIECE_LN_R;
        PIECE_ANGLE: f32 = volumes::PIECE_ANGLE;
        PIECE_SLACK: f32 = volumes::PIECE_SLACK;
        LEAST_SEEN: f32 = layers::LEAST_SEEN;
        MOST_PIECES: f32 = volumes::MOST_PIECES;
        MOST_CELLS: f32 = volumes::MOST_CELLS;
        MOST_CUTS: f32 = volumes::MOST_CUTS;
        MARGIN_U: f32 = volumes::MARGIN_U;
        MARGIN_COS: f32 = volumes::MARGIN_COS;
        MARGIN_STEP: f32 = volumes::MARGIN_STEP;
        LIMIT_SECANTS: u32 = along::LIMIT_SECANTS;
        CELL_LN_R: f32 = shape::CELL_LN_R;
        CELL_ANGLE: f32 = shape::CELL_ANGLE;
        LEAST_SIN2: f32 = flow::LEAST_SIN2;
        NEAR_AXIS: f32 = matter::NEAR_AXIS;
        DARK: f32 = matter::Accuracy::VIEW.dark;
        DARK_PICTURE: f32 = matter::Accuracy::PICTURE.dark;
        CLUMPED: f32 = matter::CLUMPED;
        LAYERS: f32 = volumes::LAYERS;
        BLOCK_LAYERS: f32 = layers::BLOCK_LAYERS;
        BLOCK_ROUNDING: f32 = layers::BLOCK_ROUNDING;
        ROUND_AXIS: f32 = layers::ROUND_AXIS;
        ROUND_HORIZON: f32 = layers::ROUND_HORIZON;
        MANY_RAYS: u32 = volumes::MANY_RAYS;
        MANY_SHARE: f32 = volumes::MANY_SHARE;
        WORTH: f32 = clouds::WORTH;
        LEAST_WORTH: f32 = clouds::LEAST_WORTH;
        ABSORPTION_INDEX: f32 = glow::ABSORPTION_INDEX;
        INNER_FADE: vec2 = shape::INNER_FADE;
        OUTER_FADE: vec2 = shape::OUTER_FADE;
        SPOT_CUT: f32 = HotSpot::CUT;
        LEAST_BESIDE: f32 = matter::LEAST_BESIDE;
        SHAPE_DISK: u32 = Shape::Disk;
        SHAPE_TORUS: u32 = Shape::Torus;
        SHAPE_HALO: u32 = Shape::Halo;
        SHAPE_JET: u32 = Shape::Jet;
        SHAPE_SPOT: u32 = SHAPE_SPOT;
        SHAPE_FREE_SPOT: u32 = SHAPE_FREE_SPOT;
        PLACES_OF_SPOT: u32 = TABLE_NODES;
        MOTION_KEPLERIAN: u32 = MotionCode::Keplerian;
        MOTION_ANGULAR_MOMENTUM: u32 = MotionCode::AngularMomentum;
        MOTION_OUTFLOW: u32 = MotionCode::Outflow;
        MOTION_RIGID: u32 = MotionCode::Rigid;
        MOST_MATTER: u32 = sizes::MOST_MATTER;

        TABLE_WIDTH: u32 = sizes::TABLE_WIDTH;
        MEAN_SKY_TABLES: u32 = index::MEAN_SKY_TABLES;
        PROFILE_OFFSET: u32 = index::PROFILE_OFFSET;
        PROFILE_SIZE: u32 = index::PROFILE_SIZE;
        MEAN_SKY_OFFSET: u32 = index::MEAN_SKY_OFFSET;
        STARS_OFFSET: u32 = index::STARS_OFFSET;
        STAR_LEVELS: u32 = index::STAR_LEVELS;
        STAR_FINEST: u32 = index::STAR_FINEST;
        STAR_WARP: f32 = index::STAR_WARP;
        STAR_MARGIN: f32 = index::STAR_MARGIN;
        GALACTIC_POLE: vec3 = galaxy::GALACTIC_POLE.to_array();
        STAR_TINY_AREA: f32 = stars::TINY_AREA;
        STAR_RADIUS: f32 = stars::STAR_RADIUS;
        STAR_PEAK: f32 = stars::STAR_PEAK;
        STAR_RIPPLE: vec3 = stars::STAR_RIPPLE;
        MAX_STAR_LIGHT: f32 = stars::MAX_STAR_LIGHT;
        MAX_SPREAD: f32 = filter::MAX_SPREAD;
        MOST_SPREAD: f32 = filter::MOST_SPREAD;
        WIDE_TAP: f32 = filter::WIDE_TAP;
        TAP_SPACING: f32 = filter::TAP_SPACING;
        SHORT_ROW: f32 = filter::SHORT_ROW;
        STRAIGHT: f32 = filter::STRAIGHT;
        WHOLE_SKY: f32 = filter::WHOLE_SKY;
        TINY_AXIS: f32 = filter::TINY_AXIS;
        MAX_MAP_LIGHT: f32 = shift::MAX_MAP_LIGHT;
        COOLEST_COLOUR: f32 = shift::COOLEST_COLOUR;
        HOTTEST_COLOUR: f32 = shift::HOTTEST_COLOUR;
        TINY_LIGHT: f32 = shift::TINY_LIGHT;
        SHIFT_TABLE: u32 = index::SHIFT_TABLE;
        SHIFT_COLOURS: u32 = shift::SHIFT_COLOURS;
        SHIFT_SCALE: f32 = shift::SHIFT_SCALE;
        GRID_SPACING: f32 = grid::GRID_SPACING;
        GRID_RANKS: vec3 = grid::GRID_RANKS;
        GRID_CAP: f32 = grid::GRID_CAP;
        GRID_WIDTH: f32 = grid::GRID_WIDTH;
        GRID_OPEN: f32 = grid::GRID_OPEN;
        GRID_DENSE: f32 = grid::GRID_DENSE;
        GRID_TINT: f32 = grid::GRID_TINT;
        GRID_WHOLE_SKY: f32 = grid::GRID_WHOLE_SKY;
        GRID_COLOUR: vec3 = grid::GRID_COLOUR;
        GRID_ORIGIN_COLOUR: vec3 = grid::GRID_ORIGIN_COLOUR;

        FROM_UNIFORM: u32 = FROM_UNIFORM;
        PIXELS_FLOAT: u32 = PixelKind::Float;
        PIXELS_R32F: u32 = PixelKind::R32F;
        PIXELS_HDR: u32 = PixelKind::Hdr;
        TONE_MAP_ACES: u32 = ToneMap::Aces;
        TONE_MAP_AGX: u32 = ToneMap::Agx;
        TONE_MAP_FILMIC: u32 = ToneMap::Filmic;
        LEAST_BASE: f32 = grade::LEAST_BASE;
        METER_DARKEST: f32 = metering::METER_DARKEST;
        METER_BINS: u32 = metering::METER_BINS;
        METER_BINS_PER_STOP: f32 = metering::METER_BINS_PER_STOP;
        BLOCK_STOPS: u32 = metering::BLOCK_STOPS;
        BLOCK_MIDDLE: f32 = metering::BLOCK_MIDDLE;
        CELL_PARTS: f32 = metering::CELL_PARTS;
        BLOCK_WEIGHT: f32 = metering::BLOCK_WEIGHT;
        OWN_WEIGHT: f32 = metering::OWN_WEIGHT;
        BLOCK_SHARES: vec3 = metering::BLOCK_SHARES;
        STOP_SHARES: vec2 = metering::STOP_SHARES;
        GREY_STOP: f32 = metering::GREY_STOP;
        GRAIN_REACH: f32 = grade::GRAIN_REACH;
        GRAIN_SCALE: f32 = grade::GRAIN_SCALE;
        COLOUR_MAP_NONE: u32 = ColourMap::None;
        LUMINANCE: vec3 = colour_map::LUMINANCE;
        BEAM_QUARTERS: i32 = BEAM_SHARES / 4;
        MOST_GHOSTS: u32 = crate::scene::film::MOST_GHOSTS;
        GHOST_PAIRS: u32 = GHOST_PAIRS;
        SPIKE_TERMS: u32 = SPIKE_TERMS;
        SPIKE_ELEMENTS: u32 = SPIKE_ELEMENTS;
        FORMAT_BGRA8: u32 = PixelFormat::Bgra8Srgb;
        FORMAT_RGB10A2_PQ: u32 = PixelFormat::Rgb10A2Pq;
        PQ_M1: f32 = hdr::PQ_M1;
        PQ_M2: f32 = hdr::PQ_M2;
        PQ_C1: f32 = hdr::PQ_C1;
        PQ_C2: f32 = hdr::PQ_C2;
        PQ_C3: f32 = hdr::PQ_C3;
        HLG_A: f32 = hdr::HLG_A;
        HLG_B: f32 = hdr::HLG_B;
        HLG_C: f32 = hdr::HLG_C;
        FORMAT_RGBA16F: u32 = PixelFormat::Rgba16F;
        FORMAT_RGBA32F: u32 = PixelFormat::Rgba32F;
        FORMAT_R32F: u32 = PixelFormat::R32F;
        MAX_SCENE_LIGHT: f32 = tone_map::MAX_SCENE_LIGHT;
        MAX_F16: f32 = film::MAX_F16;
        MAX_F32: f32 = f32::MAX;
        ACES_EXPOSURE: f32 = tone_map::ACES_EXPOSURE;
        ACES_IN: mat3x2 = tone_map::ACES_IN;
        ACES_OUT: mat3x2 = tone_map::ACES_OUT;
        AGX_IN: mat3x2 = tone_map::AGX_IN;
        AGX_OUT: mat3x2 = tone_map::AGX_OUT;
        AGX_REC709: mat3x2 = tone_map::AGX_REC709;
        AGX_LOW: f32 = tone_map::AGX_LOW;
        AGX_SPAN: f32 = tone_map::AGX_SPAN;
        AGX_PIVOT: f32 = tone_map::AGX_PIVOT;
        AGX_TOE: f32 = tone_map::AGX_TOE;
        AGX_SHOULDER: f32 = tone_map::AGX_SHOULDER;
        ROWS_WIDTH: u32 = ROWS_GROUP[0];
        ROWS_PIXELS: u32 = ROWS_GROUP[0] * ROWS_GROUP[1];
        COUNT_RUN: u32 = sizes::COUNT_RUN;
        LEVEL_COLUMNS: u32 = sizes::LEVEL_COLUMNS;
        EXPORT_CROSSINGS: u32 = sizes::EXPORT_CROSSINGS;
        EXPORT_SIZE: u32 = sizes::EXPORT_VECTORS;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::kernel::fragments::FILES;
    use std::collections::BTreeSet;
    use std::path::Path;

    /// The names of the constants that the lines of a text declare at their begin, whoever may see them.
    fn declared(text: &str) -> impl Iterator<Item = &str> {
        let plain = text.lines().map(|line| {
            line.strip_prefix("pub").map_or(line, |rest| {
                rest.strip_prefix("(").and_then(|rest| rest.split_once(')')).map_or(rest, |(_, rest)| rest).trim_start()
            })
        });
        let names = plain.filter_map(|line| line.strip_prefix("const ")?.split([':', ' ']).next());
        names.filter(|name| !name.is_empty() && !name.starts_with('_'))
    }

    fn rust_files(folder: &Path, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                rust_files(&path, found);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                found.push(std::fs::read_to_string(&path).expect("a text"));
            }
        }
    }

    #[test]
    fn no_shader_repeats_a_constant_of_rust() {
        let mut files = Vec::new();
        rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
        let rust: BTreeSet<_> = files.iter().flat_map(|text| declared(text)).collect();
        let printed: BTreeSet<_> = all().into_iter().map(|(name, _)| name).collect();
        assert!(rust.contains("BLACKBODY_SIZE") && rust.contains("GRID_WIDTH"), "{rust:?}");
        for (file, text) in FILES {
            for name in declared(text) {
                assert!(!rust.contains(name) && !printed.contains(name), "{name} of {file} is Rust's as well");
            }
        }
    }

    /// Constants that shaders have for themselves although Rust has one of the same name without the first word, here
    /// the second. The reason, and what was measured, stands beside the shader's.
    const OTHERWISE: [(&str, &str); 10] = [
        ("HORIZON_ROOM", "ROOM"),
        ("DEFERRED_GROUP", "GROUP"),
        ("OWN_GROUP", "GROUP"),
        ("KERR_RADIUS_TOLERANCE", "TOLERANCE"),
        ("KERR_PATTERN_TOLERANCE", "PATTERN_TOLERANCE"),
        ("KERR_STEP", "STEP"),
        ("KERR_STEPS", "STEPS"),
        ("END_STEP", "STEP"),
        ("END_STEPS", "STEPS"),
        ("MOST_SKY_LIGHT", "LIGHT"),
    ];

    #[test]
    fn shaders_have_other_numbers_for_a_reason_only() {
        let mut files = Vec::new();
        rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
        let rust: BTreeSet<_> = files.iter().flat_map(|text| declared(text)).collect();
        let mut found = BTreeSet::new();
        for name in FILES.iter().flat_map(|(_, text)| declared(text)) {
            let ends = name.match_indices('_').filter_map(|(at, _)| name.get(at + 1..));
            found.extend(ends.clone().find(|end| rust.contains(end)).map(|end| (name, end)));
        }
        assert_eq!(found, BTreeSet::from(OTHERWISE));
    }

    #[test]
    fn every_constant_is_used() {
        let words = |text: &'static str| text.split(|c: char| !c.is_alphanumeric() && c != '_');
        let used: BTreeSet<_> = FILES.iter().flat_map(|(_, text)| words(text)).collect();
        for (name, _) in all() {
            assert!(used.contains(name), "no shader uses {name}");
        }
    }
}
