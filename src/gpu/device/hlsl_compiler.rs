// SPDX-License-Identifier: MIT OR Apache-2.0
//! The compiler that turns the HLSL of Direct3D 12's kernels into what its drivers take: Microsoft's DXC where a host
//! has put it, else FXC, which Windows has, and which is slow with large kernels. Knows no device.

use crate::platform;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

/// The name of DXC's library.
const DXC: &str = "dxcompiler.dll";

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
    let paths = folders.iter().map(|folder| folder.join(DXC)).filter(|path| is_file(path));
    // wgpu takes paths that are text.
    let mut all = paths.filter_map(|path| path.to_str().map(|text| HlslCompiler::Dxc(text.into()))).collect::<Vec<_>>();
    // Both folders may be one.
    all.dedup();
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
    fn wgpu_gets_the_whole_path() {
        let dxc = HlslCompiler::Dxc("lib/dxcompiler.dll".into());
        let wgpu::Dx12Compiler::DynamicDxc { dxc_path } = dxc.for_wgpu() else { panic!("not DXC") };
        assert_eq!(dxc_path, "lib/dxcompiler.dll");
        assert!(matches!(HlslCompiler::Fxc.for_wgpu(), wgpu::Dx12Compiler::Fxc));
        assert_eq!([dxc, HlslCompiler::Fxc].map(|one| one.to_string()), ["DXC", "FXC"]);
    }
}
