// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of film, and of the sRGB curve of window/present: from light to pixels. Both sides are f32 here.

use super::inputs::{Inputs, Outputs, Random};
use super::run::Image;
use super::{Group, ROUNDING, SAME, TRANSCENDENTAL, twin};
use crate::film::metering::{self, MeterParams};
use crate::film::{
    FilmParams, colour_map, develop, develop_through, dither, false_colour, filmic, grade, hdr, limited, lut,
    srgb_encode, tone_map,
};
use crate::gpu::kernel::choices::FROM_UNIFORM;
use crate::gpu::kernel::slots::LUT;
use crate::image::file::srgb_to_linear;
use crate::image::{Lut, PixelFormat};
use crate::scene::{ColourMap, Film, Filmic, Grade, ToneMap, View};
use bytemuck::Zeroable;
use std::sync::OnceLock;

const HEAD: &str = "
#import film/film
#import film/colour_map
#import film/encode
#import film/false_colour
#import film/filmic
#import film/grade
#import film/hdr
#import film/lut
#import film/params
#import metering/params
#import metering/stops
#import window/present
var<private> film: FilmParams;
var<private> meter: MeterParams;
fn enter_film() {
    film = FilmParams(in1(0u), word(1u), word(2u), word(3u), in1(4u), in1(5u), word(6u), word(7u), word(8u), in1(9u),
        in1(10u), in1(11u), in2(12u), in1(14u), in1(15u), mat3x3<f32>(in3(16u), in3(20u), in3(24u)), in1(28u),
        in1(29u), word(30u), word(31u), in4(32u), in4(36u), in4(40u),
        in3(44u), word(47u), in3(48u), in1(51u), in4(52u), in4(56u), in4(60u), in1(64u), in1(65u), in1(66u), in1(67u),
        in1(68u), 0u, 0u, 0u);
}
fn enter_meter() {
    let one = vec2<u32>(1u);
    meter = MeterParams(one, one, 1u, 1.0, 0.0, in1(0u), in1(1u), in1(2u), in1(3u), in1(4u), in1(5u), in1(6u), in1(7u),
        1.0);
}
fn out_bytes(words: vec4<u32>, count: u32) {
    for (var k = 0u; k < count; k += 1u) {
        for (var b = 0u; b < 4u; b += 1u) { out1(f32((words[k] >> (8u * b)) & 255u)); }
    }
}
";

/// Words of `FilmParams`, behind which light comes.
const LIGHT: usize = 72;
/// Powers of 79 make much of the rounding of logarithms.
const HALF_A_CODE: f64 = 0.5;

fn push_film(i: &mut Inputs, view: View, format: PixelFormat) {
    let tone_map = [ToneMap::None, ToneMap::Aces, ToneMap::Agx, ToneMap::Filmic][i.random.below(4) as usize];
    let colour_map = [ColourMap::None, ColourMap::Afmhot][i.random.below(2) as usize];
    let on = i.random.below(2) == 0;
    let grade = Grade {
        white_balance: if i.random.below(4) == 0 { 0.0 } else { i.random.log(1667.0, 25_000.0) },
        tint: i.random.even(-1.0, 1.0),
        contrast: i.random.log(0.25, 4.0),
        saturation: i.random.even(0.0, 4.0),
        vignette: i.random.even(0.0, 1.0),
        grain: i.random.even(0.0, 1.0),
        grain_seed: i.random.even(-10.0, 10.0),
    };
    let filmic = Filmic {
        toe_strength: i.random.even(0.0, 1.0),
        toe_length: i.random.even(0.0, 1.0),
        shoulder_strength: i.random.even(0.0, 16.0),
        shoulder_length: i.random.even(0.0, 1.0),
        shoulder_angle: i.random.even(0.0, 1.0),
    };
    let film = Film {
        tone_map,
        colour_map,
        exposure_ev: i.random.even(-2.0, 2.0),
        grade: if on { grade } else { Grade::default() },
        filmic,
        paper_white: i.random.log(10.0, 1000.0),
        peak: i.random.log(100.0, 10000.0),
        lut_strength: if i.random.below(2) == 0 { 1.0 } else { i.random.even(0.0, 1.0) },
        ..Film::plain()
    };
    let params = FilmParams::new(&film, view, format, i.random.below(2) == 0).over_frame(8192, 6000);
    let params = params.with_lut(Some(table()), &film);
    bytemuck::cast::<_, [u32; LIGHT]>(params).into_iter().for_each(|word| {
        i.push_word(word);
    });
}

fn params(i: &Inputs) -> FilmParams {
    let words: [u32; LIGHT] = std::array::from_fn(|k| i.word(k));
    bytemuck::cast(words)
}

fn push_light(i: &mut Inputs) {
    (0..3).for_each(|_| {
        i.log(6e-5, 1e3);
    });
    let odd = [f64::NAN, -1.0, 0.0, f64::INFINITY, 1.0, 65504.0, 70000.0, 6.1e-5, 1e-7, 3e-8];
    if i.random.below(8) == 0 {
        i.truncate(i.words.len() - 1);
        let value = odd[i.random.below(odd.len() as u32) as usize];
        i.push(value);
    }
    i.even(0.0, 1.1);
    let [x, y] = [i.random.below(8192), i.random.below(8192)];
    [x, y].into_iter().for_each(|word| {
        i.push_word(word);
    });
}

/// Random colours, beyond 0 and 1 as well, over a domain that no colour reaches all of.
fn table() -> &'static Lut {
    static TABLE: OnceLock<Lut> = OnceLock::new();
    TABLE.get_or_init(|| {
        let mut random = Random(17);
        let side = 17;
        let mut node = || [0, 1, 2].map(|_| random.even(-0.2, 1.2) as f32);
        let nodes = (0..Lut::node_count(side)).map(|_| node()).map(|[r, g, b]| [r, g, b, 0.0]).collect();
        Lut::over(side, [[0.0, -0.5, 0.25], [1.0, 1.5, 0.75]], nodes)
    })
}

fn images() -> Vec<Image> {
    vec![Image {
        name: "film_lut",
        format: LUT.format,
        size: [table().side(); 3],
        levels: 1,
        solid: true,
        bytes: bytemuck::cast_slice(table().nodes()).to_vec(),
    }]
}

/// `steps`: by how many codes bytes may differ.
fn write_pixel(i: &Inputs, o: &mut Outputs, steps: f64) {
    let light = [0, 1, 2, 3].map(|k| i.f(LIGHT + k));
    let bytes = develop(&params(i), light, i.word(LIGHT + 4), i.word(LIGHT + 5));
    bytes.iter().for_each(|byte| o.values.push((f64::from(*byte), steps)));
}

fn rgb(i: &mut Inputs) {
    (0..3).for_each(|_| {
        i.log(1e-5, 1e3);
    });
}

fn f3(i: &Inputs) -> [f32; 3] {
    [0, 1, 2].map(|k| i.f(k))
}

fn put3(o: &mut Outputs, rgb: [f32; 3]) {
    o.all(rgb.map(f64::from), 1.0);
}

fn push_value(i: &mut Inputs) {
    let views = [View::Redshift, View::Order, View::Deflection, View::Steps, View::Metric, View::Intensity];
    let view = views[i.random.below(6) as usize];
    push_film(i, view, PixelFormat::Rgba8Srgb);
    let value = match view {
        View::Order => f64::from(i.random.below(8)) - 2.0,
        View::Metric => i.random.even(-1.0, 1.0),
        View::Steps => i.random.log(4.0, 1000.0),
        _ => i.random.log(0.05, 5.0),
    };
    let is_nan = i.random.below(50) == 0;
    i.push(if is_nan { f64::NAN } else { value });
}

fn meter_of(i: &Inputs) -> MeterParams {
    let [strength, percentile, aim, least, most, adaptation, highlights, shadows] = std::array::from_fn(|k| i.f(k));
    MeterParams { strength, percentile, aim, least, most, adaptation, highlights, shadows, ..MeterParams::zeroed() }
}

pub fn group() -> Group {
    let any = f64::from(FROM_UNIFORM);
    let all = [("PIXELS", any), ("TONE_MAP", any), ("COLOUR_MAP", any), ("GRADE", any)];
    let (film, encode, colours) = ("film/film", "film/encode", "film/false_colour");
    const DEVELOP: &str = "enter_film(); out_bytes(develop(in4(72u), word(76u), word(77u)), pixel_words());";
    let twins = vec![
        twin(
            film,
            "develop develop_8bit with_grade shown_colour is_graded has_colour_map tone_map dither alpha_of is_float \
             is_r32f is_aces is_agx is_filmic pixel_words has_several_words",
            DEVELOP,
            |i| {
                push_film(i, View::Light, PixelFormat::Rgba8Srgb);
                push_light(i);
            },
            |i, o| write_pixel(i, o, 1.0),
            // Codes of 8 bits, which a rounding decides.
            1.0,
        )
        .with(&all)
        .exactly(),
        // Through a table of random colours, but for films with a colour map.
        twin(
            film,
            "develop develop_8bit shown_colour",
            DEVELOP,
            |i| {
                push_film(i, View::Light, PixelFormat::Rgba8Srgb);
                push_light(i);
            },
            |i, o| {
                let light = [0, 1, 2, 3].map(|k| i.f(LIGHT + k));
                let bytes = develop_through(&params(i), Some(table()), light, i.word(LIGHT + 4), i.word(LIGHT + 5));
                bytes.iter().for_each(|byte| o.values.push((f64::from(*byte), 1.0)));
            },
            1.0,
        )
        .with(&all)
        .with(&[("LUT", 1.0)])
        .exactly(),
        twin(
            "film/lut",
            "through_lut lut_node",
            "enter_film(); out3(through_lut(in3(72u)));",
            |i| {
                push_film(i, View::Light, PixelFormat::Rgba8Srgb);
                (0..3).for_each(|_| {
                    i.even(0.0, 1.0);
                });
            },
            |i, o| put3(o, lut::through_lut(&params(i).lut, table().nodes(), [0, 1, 2].map(|k| i.f(LIGHT + k)))),
            ROUNDING,
        ),
        twin(
            "film/hdr",
            "pq_codes pq_encode pq_decode rolled_off display_light",
            "enter_film(); out3(1023.0 * pq_codes(in3(72u)));",
            |i| {
                push_film(i, View::Light, PixelFormat::Rgb10A2Pq);
                rgb(i);
            },
            |i, o| put3(o, hdr::pq_codes(&params(i).hdr, [0, 1, 2].map(|k| i.f(LIGHT + k))).map(|code| 1023.0 * code)),
            HALF_A_CODE,
        ),
        twin(
            "film/hdr",
            "hlg_codes hlg_encode",
            "enter_film(); out3(1023.0 * hlg_codes(in3(72u)));",
            |i| {
                push_film(i, View::Light, PixelFormat::Rgb10A2Hlg);
                rgb(i);
            },
            |i, o| put3(o, hdr::hlg_codes(&params(i).hdr, [0, 1, 2].map(|k| i.f(LIGHT + k))).map(|code| 1023.0 * code)),
            HALF_A_CODE,
        ),
        twin(
            film,
            "develop_10bit is_hdr",
            "enter_film(); let word_ = develop(in4(72u), word(76u), word(77u)).x;
            for (var k = 0u; k < 32u; k += 10u) { out1(f32((word_ >> k) & 1023u)); }",
            |i| {
                push_film(i, View::Light, PixelFormat::Rgb10A2Pq);
                push_light(i);
            },
            |i, o| {
                let light = [0, 1, 2, 3].map(|k| i.f(LIGHT + k));
                let bytes = develop(&params(i), light, i.word(LIGHT + 4), i.word(LIGHT + 5));
                let word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                o.values.extend([0, 10, 20, 30].map(|k| (f64::from(word >> k & 1023), 1.0)));
            },
            1.0,
        )
        .with(&[("PIXELS", any), ("GRADE", any)])
        .exactly(),
        twin(
            film,
            "develop is_rgba32f",
            DEVELOP,
            |i| {
                push_film(i, View::Light, PixelFormat::Bgra8Srgb);
                push_light(i);
            },
            |i, o| write_pixel(i, o, 1.0),
            1.0,
        )
        .with(&all)
        .exactly(),
        twin(
            film,
            "develop_rgba16f f16_bits",
            DEVELOP,
            |i| {
                push_film(i, View::Light, PixelFormat::Rgba16F);
                push_light(i);
            },
            |i, o| write_pixel(i, o, 0.0),
            SAME,
        )
        .with(&all)
        .exactly(),
        twin(
            film,
            "develop_rgba32f",
            DEVELOP,
            |i| {
                push_film(i, View::Light, PixelFormat::Rgba32F);
                push_light(i);
            },
            |i, o| write_pixel(i, o, 0.0),
            SAME,
        )
        .with(&all)
        .exactly(),
        twin(
            encode,
            "limited is_nan",
            "out3(limited(in3(72u), 100.0));",
            |i| {
                push_film(i, View::Light, PixelFormat::Rgba8Srgb);
                push_light(i);
            },
            |i, o| o.all([LIGHT, LIGHT + 1, LIGHT + 2].map(|k| f64::from(limited(i.f(k), 100.0))), 0.0),
            SAME,
        )
        .exactly(),
        twin(
            encode,
            "srgb_encode",
            "out3(srgb_encode(in3(0u)));",
            |i| {
                (0..3).for_each(|_| {
                    i.log(1e-5, 1.0);
                })
            },
            |i, o| put3(o, f3(i).map(srgb_encode)),
            ROUNDING,
        ),
        twin(film, "aces balanced", "out3(aces(in3(0u)));", rgb, |i, o| put3(o, tone_map::aces(f3(i))), ROUNDING),
        twin(film, "agx agx_sigmoid", "out3(agx(in3(0u)));", rgb, |i, o| put3(o, tone_map::agx(f3(i))), TRANSCENDENTAL),
        twin(
            "film/filmic",
            "filmic log_rest",
            "enter_film(); out3(filmic(in3(72u)));",
            |i| {
                push_film(i, View::Light, PixelFormat::Rgba8Srgb);
                rgb(i);
            },
            |i, o| put3(o, filmic::filmic(&params(i).filmic, [0, 1, 2].map(|k| i.f(LIGHT + k)))),
            // Under the greatest shoulder the driver's exp gets hundreds; drivers may round its exponent.
            1e-4,
        ),
        twin(
            "film/grade",
            "graded grain_noise grain_cell hash",
            "enter_film(); out3(graded(in3(72u), word(75u), word(76u)));",
            |i| {
                push_film(i, View::Light, PixelFormat::Rgba8Srgb);
                rgb(i);
                i.pick(8192);
                i.pick(6000);
            },
            |i, o| {
                let light = [0, 1, 2].map(|k| i.f(LIGHT + k));
                put3(o, grade::graded(&params(i).grade, light, i.word(LIGHT + 3), i.word(LIGHT + 4)));
            },
            // exp2 of up to 80 in pow, 3 + 2 * 80 roundings, which saturation may double.
            5e-5,
        ),
        twin(
            "film/colour_map",
            "afmhot luminance",
            "out3(afmhot(luminance(in3(0u))));",
            |i| {
                (0..3).for_each(|_| {
                    i.log(1e-5, 1.0);
                })
            },
            |i, o| put3(o, colour_map::afmhot(colour_map::luminance(f3(i)))),
            ROUNDING,
        ),
        twin(
            film,
            "dither",
            "out1(dither(word(0u), word(1u)));",
            |i| {
                i.bits();
                i.bits();
            },
            |i, o| o.near(dither(i.word(0), i.word(1)).into(), 0.0),
            SAME,
        ),
        twin(
            colours,
            "false_colour scaled sequential diverging lab_encoded",
            "enter_film(); out3(false_colour(in1(72u)));",
            push_value,
            |i, o| {
                let film = params(i);
                put3(o, false_colour::false_colour(film.view(), (film.view_low, film.view_scale), i.f(LIGHT)));
            },
            // A twentieth of a step of 8 bits: sin and cos are the driver's.
            2e-4,
        ),
        twin(
            "metering/stops",
            "stop_of",
            "out1(stop_of(in3(0u)));",
            rgb,
            |i, o| o.all([f64::from(metering::stop_of(f3(i)))], 16.0),
            TRANSCENDENTAL,
        ),
        twin(
            "metering/stops",
            "wanted_stops local_stops smooth_above",
            "enter_meter(); out3(vec3<f32>(wanted_stops(in1(8u)), local_stops(in1(9u)), smooth_above(in1(9u))));",
            |i| {
                let ranges = [(0.0, 1.0), (0.0, 1.0), (-10.0, 10.0), (-20.0, 0.0), (0.0, 20.0), (0.0, 1.0), (0.0, 1.0)];
                for (low, high) in ranges.into_iter().chain([(0.0, 1.0), (0.0, 32.0), (-16.0, 16.0)]) {
                    i.even(low, high);
                }
            },
            |i, o| {
                let meter = meter_of(i);
                let (stop, stops) = (i.f(8), i.f(9));
                let wanted = metering::wanted_stops(&meter, stop);
                let local = metering::local_stops(&meter, stops);
                put3(o, [wanted, local, metering::smooth_above(stops)]);
            },
            ROUNDING,
        ),
        twin(
            "window/present",
            "srgb_decode",
            "out3(srgb_decode(in3(0u)));",
            |i| {
                (0..3).for_each(|_| {
                    i.even(0.0, 1.0);
                })
            },
            |i, o| put3(o, f3(i).map(srgb_to_linear)),
            TRANSCENDENTAL,
        ),
    ];
    Group { name: "film", head: HEAD.into(), twins, images, tables: Vec::new }
}
