// SPDX-License-Identifier: MIT OR Apache-2.0
//! ffmpeg as a process beside this one. Started without a shell, so that no name of a file can be taken for a command,
//! and beyond the reach of a terminal's Ctrl-C, which is this program's to act on. Knows no boxes and no frames.

use crate::ending::Ending;
use std::ffi::{OsStr, OsString};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Bytes that are kept of all that ffmpeg says: its last words tell why it ended.
const MOST_WORDS: usize = 4096;

/// How often it is looked whether a process has ended.
const GLANCE: Duration = Duration::from_millis(5);

/// How long last words are waited for, which a process that ffmpeg has left behind may keep from ending.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// A process that several threads may end.
#[derive(Clone)]
struct Shared(Arc<Mutex<Child>>);

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Child> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn kill(&self) {
        let _ = self.lock().kill();
    }

    fn wait(&self) -> std::io::Result<ExitStatus> {
        loop {
            if let Some(status) = self.lock().try_wait()? {
                return Ok(status);
            }
            std::thread::sleep(GLANCE);
        }
    }
}

/// The processes that are there, for a thread that ends them where they hang.
#[derive(Clone, Default)]
pub struct Running(Arc<Mutex<Vec<Shared>>>);

impl Running {
    fn lock(&self) -> MutexGuard<'_, Vec<Shared>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn add(&self, process: &Shared) {
        let mut all = self.lock();
        all.retain(|process| Arc::strong_count(&process.0) > 1);
        all.push(process.clone());
    }

    /// Ends all of them.
    pub fn kill(&self) {
        self.lock().iter().for_each(Shared::kill);
    }
}

/// An ffmpeg that makes a file. One that is dropped before its end is ended, and its file removed.
pub struct Ffmpeg {
    process: Shared,
    input: Option<ChildStdin>,
    said: Receiver<String>,
    file: PathBuf,
}

/// A name that ffmpeg takes for a file, whatever is in it.
pub fn name_of(file: &Path) -> OsString {
    let mut name = OsString::from("file:");
    name.push(file);
    name
}

impl Ffmpeg {
    /// Starts ffmpeg with these arguments and the file's name behind them. Errors: it is not there.
    pub fn begin(program: &Path, arguments: &[OsString], file: &Path, running: &Running) -> Result<Self, Ending> {
        let mut command = Command::new(program);
        command.args(["-hide_banner", "-loglevel", "error", "-nostdin", "-y"]).args(arguments).arg(name_of(file));
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        // SVT-AV1 writes past ffmpeg's log: errors only.
        command.env("SVT_LOG", "1");
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        #[cfg(windows)]
        std::os::windows::process::CommandExt::creation_flags(&mut command, CREATE_NEW_PROCESS_GROUP);
        let mut child = command.spawn().map_err(|error| {
            let advice = match error.kind() {
                ErrorKind::NotFound => "it was not found; install it, name it with --ffmpeg, or render pictures",
                _ => "it did not start",
            };
            Ending::io(program, format!("{advice}: {error}"))
        })?;
        let (tell, said) = channel();
        if let Some(words) = child.stderr.take() {
            std::thread::spawn(move || tell.send(last_words(words)));
        }
        let input = child.stdin.take();
        let process = Shared(Arc::new(Mutex::new(child)));
        running.add(&process);
        Ok(Self { process, input, said, file: file.to_owned() })
    }

    /// Gives it bytes. Errors: it has ended.
    pub fn give(&mut self, bytes: &[u8]) -> Result<(), Ending> {
        let given = self.input.as_mut().map_or(Err(ErrorKind::BrokenPipe.into()), |input| input.write_all(bytes));
        given.map_err(|error| {
            self.close();
            let _ = self.process.wait();
            self.failed(&error.to_string())
        })
    }

    /// Ends its input.
    pub fn close(&mut self) {
        drop(self.input.take());
    }

    /// Whether it has ended.
    pub fn has_ended(&self) -> bool {
        !matches!(self.process.lock().try_wait(), Ok(None))
    }

    /// Waits for its end; its file is there. Errors: it failed.
    pub fn finish(&mut self) -> Result<(), Ending> {
        self.close();
        match self.process.wait() {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(self.failed(&status.to_string())),
            Err(error) => Err(self.failed(&error.to_string())),
        }
    }

    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Its last words, or why it ended where it said nothing.
    fn failed(&self, why: &str) -> Ending {
        let said = self.said.recv_timeout(LAST_WORDS).unwrap_or_default();
        let said = said.trim();
        Ending::io(Path::new("ffmpeg"), if said.is_empty() { why } else { said })
    }
}

/// Windows: Ctrl-C in the console is for this program only.
#[cfg(windows)]
const CREATE_NEW_PROCESS_GROUP: u32 = 0x200;

fn last_words(mut said: impl Read) -> String {
    let (mut words, mut some) = (Vec::new(), [0; 1024]);
    while let Ok(count @ 1..) = said.read(&mut some) {
        words.extend_from_slice(some.get(..count).unwrap_or_default());
        let extra = words.len().saturating_sub(MOST_WORDS);
        words.drain(..extra);
    }
    String::from_utf8_lossy(&words).into_owned()
}

impl Drop for Ffmpeg {
    fn drop(&mut self) {
        self.close();
        self.process.kill();
        let _ = self.process.wait();
        let _ = std::fs::remove_file(&self.file);
    }
}

/// Arguments from text.
pub fn arguments<T: AsRef<OsStr>>(list: impl IntoIterator<Item = T>) -> Vec<OsString> {
    list.into_iter().map(|argument| argument.as_ref().to_owned()).collect()
}
