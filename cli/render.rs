// SPDX-License-Identifier: MIT OR Apache-2.0
//! `bhr render`: frames of a scene to files, pictures or a video; and what they would take.

use crate::ending::Ending;
use crate::film::Film;
use crate::frames::{self, Names};
use crate::open;
use crate::order::Order;
use crate::pictures::Pictures;
use crate::progress::{Progress, say};
use crate::signals::Signals;
use bhr::image::{Effort, Layout};
use bhr::renderer::Renderer;
use clap::ArgMatches;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Renders the frames that arguments ask for.
pub fn run(given: &ArgMatches) -> Result<(), Ending> {
    let order = Order::new(given)?;
    let count = order.opened.render().frames();
    let list = match given.get_one::<String>("frames") {
        Some(list) => frames::list(list)?,
        None => (0..count).collect(),
    };
    let out = given.get_one::<PathBuf>("out").ok_or_else(|| Ending::usage("no --out"))?;
    let names = if order.codec.is_some() { Names::of_one(out)? } else { Names::new(out, list.len() > 1)? };
    let kind = given.get_one::<String>("progress").map_or("auto", String::as_str);
    let progress = Progress::new(kind, list.len() as u64)?;
    let signals = Signals::listen();
    let mut renderers = open::renderers(given)?;
    let count = renderers.len();
    let first = renderers.first_mut().ok_or_else(|| Ending::usage("no --adapter"))?;
    let (again, signals, dry) = (given.get_flag("again"), &signals, given.get_flag("dry-run"));
    if let Some(folder) = names.of(0).parent().filter(|folder| !dry && !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|error| Ending::io(folder, error))?;
    }
    check_use(given, order.codec.is_some())?;
    let result = match &order.codec {
        Some(_) if count > 1 => Err(Ending::usage("--adapter: a video is made on one")),
        Some(codec) => {
            let ffmpeg = given.get_one::<PathBuf>("ffmpeg").cloned().unwrap_or_else(|| "ffmpeg".into());
            let keyframes = given.get_one::<u32>("keyframes").copied();
            let film = Film { order: &order, codec, names: &names, again, ffmpeg, keyframes, signals };
            if dry {
                film.try_encoder(&list, first)?;
                return dry_run(&order, &list, first, count, signals);
            }
            film.render(&list, first, &progress)
        }
        None if dry => return dry_run(&order, &list, first, count, signals),
        None => {
            let encoders = given.get_one::<u32>("encoders").copied().unwrap_or(0) as usize;
            let effort = given.get_one::<i32>("compression").map_or_else(Effort::default, |level| Effort(*level));
            let failed = AtomicBool::new(false);
            let pictures = Pictures { order: &order, names: &names, again, effort, signals, failed };
            let more = open::more_renderers(given, list.len())?;
            pictures.render(&list, encoders, renderers, more, &progress)
        }
    };
    progress.end();
    result
}

/// Errors: options of pictures for a video, or the other way round.
fn check_use(given: &ArgMatches, video: bool) -> Result<(), Ending> {
    let (names, of) = match video {
        true => (&["encoders", "compression", "at-a-time"][..], "pictures"),
        false => (&["keyframes", "ffmpeg"][..], "videos, .mp4 or .mov"),
    };
    match names.iter().find(|name| given.contains_id(name)) {
        Some(name) => Err(Ending::usage(format!("--{name}: it is for {of}"))),
        None => Ok(()),
    }
}

/// The pixels of frames that are tried.
const TRIED_PIXELS: f64 = 320.0 * 180.0;

/// Renders the first, the middle and the last frame small, and says what all of them take.
fn dry_run(
    order: &Order,
    list: &[u32],
    renderer: &mut Renderer,
    renderers: usize,
    signals: &Signals,
) -> Result<(), Ending> {
    let (layout, eye) = (order.layout(), order.eye_layout());
    let pixels = f64::from(eye.width) * f64::from(eye.height);
    let shrink = (TRIED_PIXELS / pixels).sqrt().min(1.0);
    let side = |side: u32| ((f64::from(side) * shrink).round() as u32).max(1);
    // A cube's width is six times its height.
    let small = Layout::packed(eye.format, side(eye.width / 6) * 6, side(eye.height));
    let mut seconds = Vec::new();
    for index in [0, list.len() / 2, list.len().saturating_sub(1)] {
        let Some(frame) = list.get(index) else { continue };
        // The first one compiles what the frames run.
        let mut took = 0.0;
        for _ in 0..2 {
            let begin = Instant::now();
            order.try_small(*frame, small, renderer, signals)?;
            took = begin.elapsed().as_secs_f64();
        }
        seconds.push(took);
    }
    let mean = seconds.iter().sum::<f64>() / seconds.len().max(1) as f64;
    let shrunk = f64::from(small.width) * f64::from(small.height);
    let scale = f64::from(layout.width) * f64::from(layout.height) / shrunk * f64::from(order.moments());
    let (_, whole) = order.places()?;
    let adapter = renderer.adapter();
    say(&format!(
        "{} frames of {} x {} on {renderers} x {} ({}): about {:.0} s, if each takes {scale:.1} times what {} x {} \
         took, {:.3} s",
        list.len(),
        layout.width,
        layout.height,
        adapter.name,
        adapter.backend,
        mean * scale * list.len() as f64 / renderers.max(1) as f64,
        small.width,
        small.height,
        mean,
    ));
    say(&format!("at most {:.1} MB of files", whole as f64 * list.len() as f64 / 1e6));
    Ok(())
}
