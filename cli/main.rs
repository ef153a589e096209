// SPDX-License-Identifier: MIT OR Apache-2.0
//! bhr, the program: renders scene files to pictures and films, on one machine or on many. The commands and their
//! arguments; what each does is in a file of its own. Knows no scene and no pixel.

mod ending;
mod frames;
mod claim;
mod manifest;
mod signals;
mod encode;
mod progress;
mod open;
mod look;
mod map;
mod order;
mod video;
mod pictures;
mod film;
mod render;
mod join;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use ending::Ending;
use std::path::PathBuf;
use std::process::ExitCode;

const AFTER: &str = "\
Exit statuses: 0 done; 64 a wrong argument; 65 a scene with a mistake; 70 a bug in bhr; 74 a file that cannot be read
or written, or ffmpeg that fails; 75 try again (no adapter, no memory, a device that was lost more than three times);
130 and 143 after SIGINT and SIGTERM. docs/farms.md has more.";

fn scene() -> Arg {
    Arg::new("scene").required(true).value_name("SCENE").value_parser(value_parser!(PathBuf)).help("A scene file")
}

fn option(name: &'static str, value: &'static str, help: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(value).help(help)
}

fn flag(name: &'static str, help: &'static str) -> Arg {
    Arg::new(name).long(name).help(help).action(ArgAction::SetTrue)
}

fn device() -> [Arg; 2] {
    [
        option("backend", "NAME", "auto, cpu, vulkan, metal, d3d12 or gl").default_value("auto"),
        option("adapter", "N", "Its number in `bhr adapters`; for pictures also several, 0,1, or all (GPUs)"),
    ]
}

fn command() -> Command {
    let render = Command::new("render")
        .about("Renders frames of a scene to files; those that are there already are passed over")
        .args_override_self(true)
        .arg(scene())
        .arg(
            option(
                "out",
                "FILE",
                "Pictures, .png or .exr, where ###### becomes the frame's number; or one video, .mp4 or .mov",
            )
            .required(true)
            .value_parser(value_parser!(PathBuf)),
        )
        .arg(option("frames", "LIST", "Such as 0-99, 0-99x3 or 5,7,20-30; all frames of the scene without it"))
        .arg(option("size", "WxH", "Pixels, instead of the scene's"))
        .arg(option("tile", "X,Y,W,H", "Only this part of each frame"))
        .arg(option("samples", "N", "Rays of a pixel, instead of the scene's").value_parser(value_parser!(u32)))
        .arg(
            option(
                "shutter",
                "DEGREES",
                "Motion blur: how long the shutter is open, 0 to 360, of a frame's time; 0: off",
            )
            .value_parser(value_parser!(f64)),
        )
        .arg(
            option(
                "shutter-samples",
                "N",
                "Moments of a blurred frame, 2 to 4096; default 16, or 64 if --aperture is given",
            )
            .value_parser(value_parser!(u32).range(2..=4096)),
        )
        .arg(
            option("aperture", "LENGTH", "Depth of field: the diameter of the lens, scene lengths; 0: off")
                .value_parser(value_parser!(f64)),
        )
        .arg(
            option(
                "focus",
                "LENGTH",
                "With --aperture: the distance ahead that is sharp; by default the hole's distance",
            )
            .value_parser(value_parser!(f64)),
        )
        .arg(flag("float", "Pixels of 32 bits in .exr files, instead of 16"))
        .arg(option("colour-space", "NAME", "Primaries of .exr files: rec709 (default), p3, rec2020 or acescg"))
        .arg(option("hdr", "CURVE", "High dynamic range, pq or hlg: .png files of 16 bits, or videos but for h264"))
        .arg(flag("transparent", "Without the sky; alpha says where it was"))
        .arg(option("outputs", "LIST", "Layers of .exr files beside the light: depth,sky,position,position1 .."))
        .arg(option("stereo", "PLACES", "Both eyes of a panorama: top-bottom or side-by-side"))
        .arg(option(
            "codec",
            "NAME",
            "Of a video: h264 (default of .mp4), h265 (default with --hdr), av1, prores (of .mov), prores4444",
        ))
        .arg(
            option(
                "quality",
                "N",
                "Of a video: 1 (best) to 51, default 14 (h265: 16); av1: to 63, default 20; not for ProRes",
            )
            .value_parser(value_parser!(u32)),
        )
        .arg(
            option("keyframes", "N", "Of a video: frames of a piece, which is encoded by itself; default two seconds")
                .value_parser(value_parser!(u32).range(16..=10_000)),
        )
        .arg(
            option("ffmpeg", "FILE", "The program that encodes videos; default ffmpeg")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(flag("again", "Renders also the frames that are there already"))
        .arg(
            flag("continue", "Goes on with what is there, as without it; the opposite of --again")
                .overrides_with("again"),
        )
        .arg(flag("dry-run", "Renders three small frames, and says what the whole takes"))
        .arg(
            option("encoders", "N", "Threads that write files, to 256; 0: one a core")
                .value_parser(value_parser!(u32).range(0..=MOST_ENCODERS)),
        )
        .arg(
            option("at-a-time", "N", "Frames that an adapter renders at once, to 8; default 2, on a processor 1")
                .value_parser(value_parser!(u32).range(1..=8)),
        )
        .arg(compression())
        .arg(option("progress", "KIND", "auto, bar, plain, json, openjd or none").default_value("auto"))
        .args(device());
    Command::new("bhr")
        .version(env!("CARGO_PKG_VERSION"))
        .about("Renders black holes: scene files to pictures and films")
        .after_help(AFTER)
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(render)
        .subcommand(
            Command::new("check").about("Reads a scene and tries every frame of it, without rendering").arg(scene()),
        )
        .subcommand(
            Command::new("info")
                .about("Says what a scene is at a time, as JSON")
                .arg(scene())
                .arg(option("at", "SECONDS", "The time").default_value("0").value_parser(value_parser!(f64))),
        )
        .subcommand(Command::new("adapters").about("Lists the adapters of this machine"))
        .subcommand(
            Command::new("trace")
                .about("Follows the ray of one pixel, and says where its light came from, as JSON")
                .arg(scene())
                .arg(option("pixel", "X,Y", "The pixel's place; 0,0 is the frame's top-left corner").required(true))
                .arg(option("size", "WxH", "Pixels, instead of the scene's"))
                .arg(option("at", "SECONDS", "The time").default_value("0").value_parser(value_parser!(f64)))
                .args(device()),
        )
        .subcommand(
            Command::new("join")
                .about("Puts the tiles of a frame together, which `bhr render --tile` has made")
                .arg(
                    Arg::new("tiles")
                        .required(true)
                        .num_args(1..)
                        .value_name("TILE")
                        .value_parser(value_parser!(PathBuf))
                        .help("The tiles' files; the manifests beside them say where each belongs"),
                )
                .arg(option("out", "FILE", "A .png or .exr file").required(true).value_parser(value_parser!(PathBuf)))
                .arg(compression()),
        )
        .subcommand(
            Command::new("map")
                .about("Compresses a picture of the whole sky to a .ktx2 sky map, which takes a quarter of the memory")
                .arg(
                    Arg::new("picture")
                        .required(true)
                        .value_name("PICTURE")
                        .value_parser(value_parser!(PathBuf))
                        .help("An equirectangular .png, .exr, .pnm or .ktx2 file"),
                )
                .arg(option("out", "FILE", "A .ktx2 file").required(true).value_parser(value_parser!(PathBuf))),
        )
        .subcommand(
            Command::new("man")
                .hide(true)
                .about("Writes the man pages into a folder, for packages")
                .arg(Arg::new("folder").required(true).value_name("FOLDER").value_parser(value_parser!(PathBuf))),
        )
}

fn run(matches: &ArgMatches) -> Result<(), Ending> {
    match matches.subcommand() {
        Some(("render", given)) => render::run(given),
        Some(("check", given)) => look::check(given),
        Some(("info", given)) => look::info(given),
        Some(("adapters", _)) => look::adapters(),
        Some(("trace", given)) => look::trace(given),
        Some(("join", given)) => join::run(given),
        Some(("map", given)) => map::run(given),
        Some(("man", given)) => man(given),
        _ => Err(Ending::usage("no command")),
    }
}

/// Writes a page for the program, and one for each of its commands.
fn man(given: &ArgMatches) -> Result<(), Ending> {
    let folder = given.get_one::<PathBuf>("folder").ok_or_else(|| Ending::usage("no folder"))?;
    clap_mangen::generate_to(command(), folder).map_err(|error| Ending::io(folder, error))
}

fn compression() -> Arg {
    option("compression", "LEVEL", "Of .exr files, 1 to 3 fast .. 9 small; default 1")
        .value_parser(value_parser!(i32).range(1..=9))
}

/// The most threads that write files.
const MOST_ENCODERS: i64 = 256;

fn main() -> ExitCode {
    // A panic has told of itself; its status is that of a bug.
    std::panic::catch_unwind(begin).unwrap_or(ExitCode::from(Ending::SOFTWARE))
}

fn begin() -> ExitCode {
    let matches = match command().try_get_matches() {
        Ok(matches) => matches,
        Err(error) => {
            // Help and version are no mistakes. Where nobody reads what is printed there is nobody to tell.
            let _ = error.print();
            return if error.use_stderr() { ExitCode::from(Ending::USAGE) } else { ExitCode::SUCCESS };
        }
    };
    match run(&matches) {
        Ok(()) => ExitCode::SUCCESS,
        Err(ending) => {
            ending.tell();
            ExitCode::from(ending.status)
        }
    }
}
