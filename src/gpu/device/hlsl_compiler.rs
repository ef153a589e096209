// SPDX-License-Identifier: MIT OR Apache-2.0
//! The compiler that turns the HLSL of Direct3D 12's kernels into what its drivers take: Microsoft's DXC where a host
//! has put it, else FXC, which Windows has, and which is slow with large kernels. Knows no device.

use crate::platform;
use parking_lot::{Mutex, MutexGuard, const_mutex};
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

/// The name of DXC's library.
const DXC: &str = "dxcompiler.dll";

/// Characters of the longest path that Windows loads a library by, unless program and system allow more (MAX_PATH).
const LONGEST_TO_LOAD: usize = 259;

/// A compiler of HLSL.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::gpu) enum HlslCompiler {
    /// DXC's library, by its whole path: by its name alone, Windows would look for it in folders of others as well.
    Dxc(String),
    Fxc,
}

impl HlslCompiler {
    /// The compilers of this process, the best first.
    pub(super) fn all() -> Vec<Self> {
        in_folders(&platform::folders_of_libraries(), Path::is_file)
    }

    pub(super) fn for_wgpu(&self) -> wgpu::Dx12Compiler {
        match self {
            Self::Dxc(path) => wgpu::Dx12Compiler::DynamicDxc { dxc_path: path.clone() },
            Self::Fxc => wgpu::Dx12Compiler::Fxc,
        }
    }

    /// Whether it compiles one shader at a time in a process. DXC's objects are not for several threads at once
    /// (microsoft/DirectXShaderCompiler #2418, #5566); wgpu has one of them for each instance, which contexts share,
    /// and no lock around it. FXC is a function without state.
    pub(super) fn works_alone(&self) -> bool {
        matches!(self, Self::Dxc(_))
    }

    /// To be held while it works. Who has it waits for no other lock: `driver_lock` is taken before.
    pub(super) fn turn(&self) -> Option<MutexGuard<'static, ()>> {
        static WORKS: Mutex<()> = const_mutex(());
        self.works_alone().then(|| WORKS.lock())
    }
}

impl Display for HlslCompiler {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Dxc(_) => "DXC",
            Self::Fxc => "FXC",
        })
    }
}

/// DXC in each of these folders that has it, as one that does not serve is passed over; FXC last.
fn in_folders(folders: &[PathBuf], is_file: impl Fn(&Path) -> bool) -> Vec<HlslCompiler> {
    let mut paths = folders.iter().map(|folder| folder.join(DXC)).filter(|path| is_file(path)).collect::<Vec<_>>();
    // Both folders may be one.
    paths.dedup();
    let mut all = Vec::new();
    for path in paths {
        // wgpu takes paths that are text.
        let Some(text) = path.to_str() else {
            log::warn!("{} is not used: its path is not Unicode", path.display());
            continue;
        };
        if text.encode_utf16().count() > LONGEST_TO_LOAD {
            log::warn!("{text} may not load: its path is longer than {LONGEST_TO_LOAD} characters");
        }
        all.push(HlslCompiler::Dxc(text.into()));
    }
    all.push(HlslCompiler::Fxc);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(folders: &[&str], there: &[&str]) -> Vec<String> {
        let folders = folders.iter().map(PathBuf::from).collect::<Vec<_>>();
        let there = there.iter().map(PathBuf::from).collect::<Vec<_>>();
        let all = in_folders(&folders, |path| there.iter().any(|there| there == path));
        all.into_iter().map(|one| if let HlslCompiler::Dxc(path) = one { path } else { one.to_string() }).collect()
    }

    #[test]
    fn dxc_serves_where_a_host_has_put_it_and_fxc_elsewhere() {
        assert_eq!(of(&["lib", "host"], &[]), ["FXC"]);
        assert_eq!(of(&["lib", "host"], &["elsewhere/dxcompiler.dll", "host/dxil.dll"]), ["FXC"]);
        assert_eq!(of(&["lib", "host"], &["host/dxcompiler.dll"]), ["host/dxcompiler.dll", "FXC"]);
        assert_eq!(
            of(&["lib", "host"], &["host/dxcompiler.dll", "lib/dxcompiler.dll"]),
            ["lib/dxcompiler.dll", "host/dxcompiler.dll", "FXC"]
        );
        assert_eq!(of(&["lib", "lib"], &["lib/dxcompiler.dll"]), ["lib/dxcompiler.dll", "FXC"]);
        assert_eq!(of(&[], &["dxcompiler.dll"]), ["FXC"]);
    }

    #[test]
    fn dxc_works_for_one_thread_at_a_time_and_fxc_for_all() {
        use std::sync::atomic::{AtomicU32, Ordering};
        let most_at_once = |compiler: &HlslCompiler| {
            let (within, most) = (AtomicU32::new(0), AtomicU32::new(0));
            std::thread::scope(|scope| {
                for _ in 0..4 {
                    scope.spawn(|| {
                        for _ in 0..5 {
                            let _turn = compiler.turn();
                            most.fetch_max(within.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                            std::thread::sleep(std::time::Duration::from_millis(2));
                            within.fetch_sub(1, Ordering::SeqCst);
                        }
                    });
                }
            });
            most.into_inner()
        };
        let of_one_folder = HlslCompiler::Dxc("lib/dxcompiler.dll".into());
        assert_eq!(most_at_once(&of_one_folder), 1);
        let turn = of_one_folder.turn();
        assert!(turn.is_some() && HlslCompiler::Fxc.turn().is_none());
        // The other threads of the process wait, whichever file is theirs.
        let waits = std::thread::spawn(|| drop(HlslCompiler::Dxc("host/dxcompiler.dll".into()).turn()));
        std::thread::sleep(std::time::Duration::from_millis(20));
        assert!(!waits.is_finished());
        drop(turn);
        waits.join().unwrap();
    }

    #[test]
    fn wgpu_gets_the_whole_path() {
        let dxc = HlslCompiler::Dxc("lib/dxcompiler.dll".into());
        let wgpu::Dx12Compiler::DynamicDxc { dxc_path } = dxc.for_wgpu() else { panic!("not DXC") };
        assert_eq!(dxc_path, "lib/dxcompiler.dll");
        assert!(matches!(HlslCompiler::Fxc.for_wgpu(), wgpu::Dx12Compiler::Fxc));
        assert_eq!([dxc, HlslCompiler::Fxc].map(|one| one.to_string()), ["DXC", "FXC"]);
    }
}
