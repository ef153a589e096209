// SPDX-License-Identifier: MIT OR Apache-2.0
//! How far the program is, as people and farms read it: a bar on a terminal, lines of text, JSON, or OpenJD's. Knows no
//! scene.

use crate::encode::{Done, Encoders};
use crate::ending::Ending;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Any thread may report what is done.
pub struct Progress(Mutex<Shown>);

enum Shown {
    None,
    Bar(ProgressBar, Count),
    Plain(Count),
    Json(Count),
    /// Lines that Open Job Description's runner reads from stdout: openjd_progress, openjd_status.
    OpenJd(Count),
}

/// Frames that are done, those that were there already among them.
#[derive(Clone, Copy)]
pub struct Count {
    done: u64,
    /// Frames that this run has made.
    made: u64,
    total: u64,
    begin: Instant,
}

impl Count {
    fn add(&mut self, done: &Done) {
        self.done += 1;
        self.made += u64::from(done.seconds.is_some());
    }

    fn percent(self) -> f64 {
        100.0 * self.done as f64 / self.total.max(1) as f64
    }

    /// Frames a second of this run, and the seconds that are left if all are made so; `None`: it has made none yet.
    fn pace(self) -> Option<[f64; 2]> {
        let rate = self.made as f64 / self.begin.elapsed().as_secs_f64().max(1e-9);
        (self.made > 0).then(|| [rate, self.total.saturating_sub(self.done) as f64 / rate])
    }

    /// The pace in words, to go on a line with.
    fn told_pace(self) -> String {
        let words = self.pace().map(|[rate, left]| format!("; {rate:.2} frames a second, {left:.0} s to go"));
        words.unwrap_or_default()
    }
}

impl Progress {
    pub fn new(kind: &str, total: u64) -> Result<Self, Ending> {
        let count = Count { done: 0, made: 0, total, begin: Instant::now() };
        let bar = || {
            let style = "{bar:40} {pos}/{len} frames, {elapsed} gone{msg}";
            let bar = ProgressBar::new(total);
            bar.set_style(ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        };
        let shown = match kind {
            "auto" if std::io::stderr().is_terminal() => Shown::Bar(bar(), count),
            "bar" => Shown::Bar(bar(), count),
            "auto" | "plain" => Shown::Plain(count),
            "json" => Shown::Json(count),
            "openjd" => Shown::OpenJd(count),
            "none" => Shown::None,
            _ => {
                return Err(Ending::usage(format!(
                    "--progress {kind}: it must be auto, bar, plain, json, openjd or none"
                )));
            }
        };
        Ok(Self(Mutex::new(shown)))
    }

    fn lock(&self) -> MutexGuard<'_, Shown> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn frames(&self, done: &[Done]) {
        done.iter().for_each(|done| self.frame(done));
    }

    /// Waits for all frames that were ordered. Frames that are rendered are written, whatever ended the rest; the
    /// first mistake is returned.
    pub fn finish(&self, encoders: Encoders, mut ended: Result<(), Ending>) -> Result<(), Ending> {
        for written in encoders.finish() {
            match written {
                Ok(done) => self.frames(&done),
                Err(ending) => ended = ended.and(Err(ending)),
            }
        }
        ended
    }

    /// A frame's file is there: from this run after so many seconds, or from before.
    pub fn frame(&self, done: &Done) {
        self.lock().frame(done);
    }

    pub fn end(&self) {
        if let Shown::Bar(bar, _) = &*self.lock() {
            bar.finish_and_clear();
        }
    }
}

impl Shown {
    fn frame(&mut self, done: &Done) {
        let Done { frame, file, seconds } = done;
        let took = seconds.map_or("was there".into(), |seconds| format!("{seconds:.2} s"));
        let file = file.display();
        match self {
            Self::None => {}
            Self::Bar(bar, count) => {
                count.add(done);
                bar.set_message(format!("{}  {file}", count.told_pace()));
                bar.inc(1);
            }
            Self::Plain(count) => {
                count.add(done);
                let pace = count.told_pace();
                say(&format!("frame {frame}, {} of {}: {file} ({took}){pace}", count.done, count.total));
            }
            Self::Json(count) => {
                count.add(done);
                let [rate, left] = count.pace().map_or([None; 2], |pace| pace.map(Some));
                let line = json!({"frame": frame, "file": file.to_string(), "seconds": seconds, "done": count.done,
                                  "total": count.total, "pace": rate, "seconds_left": left});
                say(&line.to_string());
            }
            Self::OpenJd(count) => {
                count.add(done);
                say(&format!("openjd_progress: {:.2}", count.percent()));
                say(&format!("openjd_status: frame {frame}: {file} ({took})"));
            }
        }
    }
}

/// A line on stdout. A reader that has gone is no reason to stop rendering.
pub fn say(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}
