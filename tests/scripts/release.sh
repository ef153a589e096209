# SPDX-License-Identifier: MIT OR Apache-2.0
# packaging/release on a copy of this checkout that is ready for a release, and on copies with faults. Sourced by
# tests/scripts/run. What builds (all but source and sums) has stand-ins that make small files in a moment; the
# commands themselves are tested by tests/install/packages.sh, tests/python/run and tests/abidiff.rs.
# shellcheck shell=bash

# ready: a repository in which everything says that its version is released.
ready() {
    local copy=$scratch/ready
    rm -rf -- "$copy" "$scratch/released"
    mkdir -p -- "$copy"
    (
        cd -- "$root" && git ls-files -z --cached --others --exclude-standard |
            while IFS= read -r -d '' name; do [ ! -e "$name" ] || printf '%s\0' "$name"; done |
            tar --null --no-recursion -T - -cf - | tar -C "$copy" -xf - && cd -- "$copy" || exit 1
        sed -i 's/^\(## [0-9.]*\), which is not released yet$/\1, 2026-12-01/' CHANGELOG.md
        git init --quiet && git config user.name tests && git config user.email tests@localhost && commit ready
    )
}
commit() { git add --all && git -c gc.auto=0 -c commit.gpgsign=false commit --quiet -m "$1"; }
release_version() { sed -n 's/^version = "\(.*\)"$/\1/p' "$root/Cargo.toml" | head -n 1; }

release_is_made() {
    local version made=$scratch/released
    version=$(release_version)
    ready && cd -- "$scratch/ready" && packaging/release --dry-run "$made" && [ ! -e "$made" ] &&
        packaging/release "$made" source sums && (cd -- "$made" && sha256sum -c SHA256SUMS) &&
        [ "$(cd -- "$made" && echo *)" = "SHA256SUMS bhr-$version.tar.gz" ] &&
        tar -xzf "$made/bhr-$version.tar.gz" -C "$scratch" && diff -r --exclude=.git . "$scratch/bhr-$version" &&
        cp -- "$made/bhr-$version.tar.gz" "$scratch/first.tar.gz" && packaging/release "$made" source sums >/dev/null &&
        cmp -- "$made/bhr-$version.tar.gz" "$scratch/first.tar.gz" || return 1
    # A file of another version is left over, and a part that does not exist.
    : >"$made/bhr-0.0.9.tar.gz"
    ! packaging/release "$made" sums && ! packaging/release "$made" flatpak &&
        git tag "v$version" && packaging/release --dry-run "$made"
}

# stand_in FILE: a command that runs what is on standard input.
stand_in() { { printf '#!/bin/sh\nset -e\nversion=%s\n' "$(release_version)" && cat; } >"$1" && chmod +x -- "$1"; }
release_has_all_parts() {
    local version made=$scratch/released bin=$scratch/release-bin
    version=$(release_version)
    mkdir -p -- "$bin" && ready && cd -- "$scratch/ready" || return 1
    stand_in packaging/tarball <<'END'
echo x >"$1/bhr-$version-x86_64-linux-gnu.tar.gz"
echo other >"$1/SHA256SUMS"
END
    stand_in packaging/deb <<'END'
mkdir -p "$1/tree/DEBIAN"
printf 'Package: libbhr0\nVersion: %s\nArchitecture: all\nMaintainer: a <a@localhost>\nDescription: x\n' \
    "${OTHER_VERSION:-$version}" >"$1/tree/DEBIAN/control"
dpkg-deb --build "$1/tree" "$1/libbhr0_${version}_amd64.deb"
rm -r "$1/tree"
END
    stand_in packaging/npm <<'END'
[ "$1" != --check ] || exit 0
case $1 in
    --tree) mkdir -p "$2" && echo x >"$2/index.js" ;;
    *) echo x >"$1/bhr-$version.tgz" ;;
esac
END
    stand_in packaging/page <<'END'
mkdir -p "$1" && cp "$BHR_WEB_TREE/index.js" "$1/index.html"
END
    stand_in python/build-wheel <<'END'
[ -f "$BHR_WEB_TREE/index.js" ] || exit
platform=manylinux_2_28_x86_64
[ "$1" != --platform ] || { platform=$2 && shift 2; }
echo x >"$1/bhr-$version-py3-none-$platform.whl"
END
    stand_in packaging/windows <<'END'
[ "$1" != --check ] || { echo "${WITHOUT_MINGW:-}" && [ -z "${WITHOUT_MINGW:-}" ] && exit; }
echo x >"$1/bhr-$version-x86_64-windows.zip"
echo other >"$1/SHA256SUMS"
END
    stand_in packaging/windows-packages <<'END'
url=
case $1 in --url=*) url=$1 && echo "$1" && shift ;; esac
mkdir -p "$2/vcpkg-$version/bhr" "$2/conan-$version"
[ -z "$url" ] || { mkdir "$2/winget-$version" && echo x >"$2/winget-$version/bhr.yaml"; }
echo x | tee "$2/bhr.$version.nupkg" "$2/vcpkg-$version/bhr/portfile.cmake" "$2/conan-$version/conanfile.py"
END
    stand_in packaging/aarch64 <<'END'
[ "$1" != --check ] || exit 0
mkdir -p "$1/bhr/lib"
echo x >"$1/bhr/lib/libbhr.so"
tar -C "$1" -czf "$1/bhr-$version-aarch64-linux-gnu.tar.gz" bhr
rm -r "$1/bhr"
echo other >"$1/SHA256SUMS"
END
    stand_in "$bin/cargo" <<'END'
[ "$BHR_NEW_BASELINE" = 1 ] && cmp "tests/abi/bhr-$version.h" include/bhr.h && echo x >"tests/abi/bhr-$version.abi"
END
    commit stand-ins && PATH=$bin:$PATH packaging/release "$made" >"$scratch/said" && cd -- "$made" &&
        sha256sum -c SHA256SUMS && [ "$(wc -l <SHA256SUMS)" -eq 13 ] &&
        tar -tzf "bhr-$version-page.tar.gz" "bhr-$version-page/index.html" &&
        cmp -- "abi/bhr-$version.h" "$root/include/bhr.h" && grep "^left out: .*BHR_RELEASE_URL" "$scratch/said" ||
        return 1
    # With the place where it will be published there is no more to leave out; without a tool for a part, the rest is
    # made, unless the part was named.
    cd -- "$scratch/ready" && rm -r -- "$made" &&
        BHR_RELEASE_URL=file:///there/ PATH=$bin:$PATH packaging/release "$made" >"$scratch/said" &&
        [ "$(wc -l <"$made/SHA256SUMS")" -eq 16 ] && ! grep "left out" "$scratch/said" &&
        grep -xF -e "--url=file:///there/bhr-$version-x86_64-windows.zip" "$scratch/said" && rm -r -- "$made" &&
        WITHOUT_MINGW="no MinGW" PATH=$bin:$PATH packaging/release "$made" >"$scratch/said" &&
        grep -xF "left out: windows: no MinGW" "$scratch/said" && [ "$(wc -l <"$made/SHA256SUMS")" -eq 10 ] &&
        [ ! -e "$made/bhr-$version-x86_64-windows.zip" ] || return 1
    # A part that fails, or that makes what is of another version, is the end.
    rm -r -- "$made" && ! OTHER_VERSION=9.0 packaging/release "$made" deb sums &&
        [ ! -e "$made/SHA256SUMS" ] && stand_in python/build-wheel <<<'exit 3' && commit broken &&
        ! packaging/release "$made" wheel sums && [ ! -e "$made/SHA256SUMS" ]
}

# refuses WORDS COMMAND...: after the command, nothing is made, and these words say why.
refuses() {
    local words=$1
    shift
    ("$@") && ! packaging/release "$scratch/released" source >"$scratch/said" 2>&1 &&
        grep -F -- "$words" "$scratch/said" && [ ! -e "$scratch/released" ] || { cat -- "$scratch/said" && return 1; }
    git reset --quiet --hard ready && git clean -fdq
}
edit() { sed -i "$1" "$2" && ! git diff --quiet && commit "$2"; }
release_refuses() {
    ready && cd -- "$scratch/ready" && git tag ready || return 1
    refuses 'include/bhr.h says version 9.' edit 's/^\(#define BHR_VERSION_MAJOR\) [0-9]*/\1 9/' include/bhr.h &&
        refuses 'vcpkg.json says version 9.0' \
            edit 's/"version": ".*"/"version": "9.0"/' packaging/vcpkg/bhr/vcpkg.json &&
        refuses 'package-lock.json says version 9.0' \
            edit '3s/"version": ".*"/"version": "9.0"/' web/package-lock.json &&
        refuses 'the package in web/package-lock.json says version 9.0' \
            edit '/^ *"": {$/,/}/s/"version": ".*"/"version": "9.0"/' web/package-lock.json &&
        refuses 'bhr.rb says version 9.0' edit 's/^  version ".*"/  version "9.0"/' packaging/homebrew/bhr.rb &&
        refuses 'Cargo.lock says version 9.0.0' edit '/^name = "libbhr"/{n;s/".*"/"9.0.0"/}' Cargo.lock &&
        refuses 'metadata.capi.library, says version 9.0.0' \
            edit '/^\[package.metadata.capi.library/,/^$/s/^version = ".*"/version = "9.0.0"/' Cargo.toml &&
        refuses 'a version of its own' edit 's|^path = "../Cargo.toml"|path = "version.txt"|' python/pyproject.toml &&
        refuses 'has no heading for' edit "/^## $(release_version),/d" CHANGELOG.md &&
        refuses 'CHANGELOG.md says: ##' edit 's/, 2026-12-01$/, which is not released yet/' CHANGELOG.md &&
        refuses 'not committed: ?? note.txt' touch note.txt &&
        refuses 'not committed: M README.md' sed -i 1d README.md &&
        git tag "v$(release_version)" && refuses 'is on another commit' edit 1d README.md
}

check "a release is made" release_is_made
check "a release has all its parts" release_has_all_parts
check "faults of a release are found" release_refuses
