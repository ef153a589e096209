# SPDX-License-Identifier: MIT OR Apache-2.0
# packages.sh -- the tests of packages, which build the library again for old systems and for cargo-c: for tests/run
# all. Sourced by tests/install/run.
# shellcheck shell=bash

# Programs that Debian does not have, from Python's and Rust's registries, go into a folder of their own, unless they
# are there.
tools=$scratch/tools
install_tools() {
    local missing=()
    command -v dh >/dev/null || missing+=(debhelper)
    command -v lintian >/dev/null || missing+=(lintian)
    command -v debootstrap >/dev/null || missing+=(debootstrap)
    command -v ruby >/dev/null || missing+=(ruby)
    python3 -c 'import ensurepip' || missing+=(python3-venv)
    if [ ${#missing[@]} -gt 0 ]; then
        apt-get install -y -qq --no-install-recommends "${missing[@]}" ||
            { echo "missing, by their Debian names: ${missing[*]}" && return 1; }
    fi
    { cargo-zigbuild --version && conan --version && pyspdxtools --help >/dev/null; } ||
        { python3 -m venv "$tools" && "$tools/bin/pip" install -q cargo-zigbuild ziglang conan spdx-tools; } || return 1
    [[ $(cargo-cinstall --version 2>&1) == *' 0.1'* ]] || # Debian's 0.9 does not know the edition 2024
        CARGO_TARGET_DIR=$scratch/cargo-c cargo install -q cargo-c --version '=0.10.24' --locked --root "$tools"
}

# with_tools COMMAND...
with_tools() { PATH=$tools/bin:$PATH "$@"; }

# An installation by cargo-c is found and used as one by ./install is.
cargo_c() {
    with_tools cargo cinstall --release --locked --prefix="$scratch/cargo-c-prefix" \
        --libdir="$scratch/cargo-c-prefix/lib" --manifest-path "$root/Cargo.toml" || return 1
    find "$scratch/cargo-c-prefix" ! -type d -printf '%P\n' | sort
    prefix=$scratch/cargo-c-prefix
    [ "$(soname "$prefix/lib/libbhr.so")" = "$named" ] && [ -f "$prefix/lib/$file" ] &&
        [[ $(readelf -d -- "$prefix/lib/libbhr.so") == *NODELETE* ]] && [ -f "$prefix/include/bhr.h" ] || return 1
    # Its pkg-config file holds the prefix, so that it is not tried at another place.
    by_pkg_config && rm -rf -- "$scratch/found project" && by_find_package
}

debian_packages() {
    "$root/packaging/deb" --no-build "$scratch/debs" && ls -l "$scratch/debs" &&
        [ "$(find "$scratch/debs" -name '*.deb' | wc -l)" -eq 3 ] &&
        lintian --allow-root --fail-on error,warning "$scratch"/debs/*.deb
}

# The man pages are well formed, and have every option of the programs.
man_pages() {
    local page
    mkdir -p -- "$scratch/unpacked" && dpkg-deb -x "$scratch"/debs/bhr-tools_*.deb "$scratch/unpacked" &&
        dpkg-deb -x "$scratch"/debs/libbhr-dev_*.deb "$scratch/unpacked" || return 1
    for page in "$scratch"/unpacked/usr/share/man/man?/*.gz; do
        # Letters that are printed twice, for bold type, count once.
        zcat "$page" | man --warnings -l -Tutf8 - 2>"$scratch/warnings" | sed 's/.\x08//g' >"$scratch/page" || return 1
        [ ! -s "$scratch/warnings" ] || { cat "$scratch/warnings" && return 1; }
        [[ $page == *.3.gz ]] || grep -q -e '--help' "$scratch/page" || return 1
    done
    [ "$(find "$scratch/unpacked/usr/share/man" -name '*.gz' | wc -l)" -eq 7 ] || return 1
    # Scene files are where the programs look for them, and bhr.json is in the other package.
    [ -s "$scratch/unpacked/usr/share/bhr/scenes/cinematic.toml" ] && [ -s "$scratch/unpacked/usr/share/bhr/bhr.json" ]
}

tarball() {
    with_tools "$root/packaging/tarball" "$scratch/tarball" && (cd "$scratch/tarball" && sha256sum -c SHA256SUMS) ||
        return 1
    mkdir -p -- "$scratch/untarred" || return 1
    tar -C "$scratch/untarred" --strip-components=1 -xzf "$scratch"/tarball/*.tar.gz || return 1
    (cd "$scratch/untarred" && sha256sum --quiet -c SHA256SUMS) || return 1
    ! grep -rlF -e "$root" -e "$HOME/.cargo" -- "$scratch/untarred" || return 1
    prefix=$scratch/untarred
    symbols && by_pkg_config && by_find_package
}

# Sources that have not changed give the same bytes.
tarball_again() {
    with_tools "$root/packaging/tarball" "$scratch/tarball-again" &&
        cmp "$scratch"/tarball/*.tar.gz "$scratch"/tarball-again/*.tar.gz
}

bill_is_valid() { with_tools pyspdxtools --infile "$scratch"/tarball/*.spdx.json; }

# The port of vcpkg, with stand-ins for vcpkg's functions, in the form of a script for CMake.
vcpkg_port() {
    local linkage packages
    for linkage in dynamic static; do
        packages=$scratch/vcpkg-$linkage
        cat >"$scratch/vcpkg.cmake" <<END
function(vcpkg_execute_required_process)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "WORKING_DIRECTORY;LOGNAME" "COMMAND")
    list(TRANSFORM arg_COMMAND REPLACE "^CARGO_TARGET_DIR=.*" "CARGO_TARGET_DIR=$target")
    execute_process(COMMAND \${arg_COMMAND} WORKING_DIRECTORY "\${arg_WORKING_DIRECTORY}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()
function(vcpkg_fixup_pkgconfig)
endfunction()
function(vcpkg_install_copyright)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "FILE_LIST")
    foreach(file IN LISTS arg_FILE_LIST)
        file(READ "\${file}" text)
        file(APPEND "\${CURRENT_PACKAGES_DIR}/share/bhr/copyright" "\${text}")
    endforeach()
endfunction()
set(CURRENT_PACKAGES_DIR "$packages")
set(CURRENT_BUILDTREES_DIR "$scratch/vcpkg-trees")
set(VCPKG_LIBRARY_LINKAGE $linkage)
include("$root/packaging/vcpkg/bhr/portfile.cmake")
END
        BHR_INSTALL=--no-build cmake -P "$scratch/vcpkg.cmake" && [ -s "$packages/share/bhr/copyright" ] || return 1
    done
    [ ! -e "$scratch/vcpkg-static/lib/libbhr.so" ] || return 1
    # Both in one prefix, as a host by find_package wants them.
    cp -- "$scratch/vcpkg-static/lib/libbhr.a" "$scratch/vcpkg-dynamic/lib/"
    prefix=$scratch/vcpkg-dynamic
    rm -rf -- "$scratch/found project" && by_find_package
}

# In a copy of the repository, as Conan builds the test beside its recipe.
conan_recipe() {
    local shared copy=$scratch/copy
    mkdir -p -- "$copy" && tar -C "$root" --exclude=./target --exclude=./.git -cf - . | tar -C "$copy" -xf - || return 1
    export CONAN_HOME=$scratch/conan BHR_INSTALL=--no-build
    with_tools conan profile detect || return 1
    for shared in True False; do
        with_tools conan create "$copy/packaging/conan" -o "bhr/*:shared=$shared" || return 1
    done
}

# The recipe for Windows, of a zip with stand-ins for its files: tests/windows-os looks into the real one. It is for
# no other system, and the recipe of the repository is not for Windows.
conan_recipe_of_windows() {
    local name made=$scratch/conan-windows file
    name=bhr-$(version)-x86_64-windows
    local windows=(-s os=Windows -s arch=x86_64 -s compiler=gcc -s compiler.version=12 -s build_type=Release)
    mkdir -p -- "$made/$name"/{bin,lib,include,share/doc/bhr} && cd -- "$made" || return 1
    for file in bin/bhr.dll lib/{bhr.lib,libbhr.dll.a} include/bhr.h \
        share/doc/bhr/{LICENSE-MIT,LICENSE-APACHE,THIRD-PARTY.txt,bhr.spdx.json}; do
        echo "$file" >"$name/$file"
    done
    echo "# bhr $(version) for Windows" >"$name/README.md"
    (cd -- "$name" && find . -type f ! -name SHA256SUMS -exec sha256sum {} + >SHA256SUMS) &&
        python3 -m zipfile -c "$name.zip" "$name" && "$root/packaging/windows-packages" "$name.zip" "$made" || return 1
    export CONAN_HOME=$scratch/conan-of-windows
    with_tools conan profile detect && with_tools conan create "$made/conan-$(version)" "${windows[@]}" -tf="" &&
        with_tools conan install --requires="bhr/$(version)" "${windows[@]}" --deployer=full_deploy \
            --deployer-folder="$made" || return 1
    for file in bin/bhr.dll lib/bhr.lib include/bhr.h share/doc/bhr/LICENSE-MIT; do
        cmp -- "$name/$file" "full_deploy/host/bhr/$(version)/x86_64/$file" || return 1
    done
    ! with_tools conan create "$made/conan-$(version)" -tf="" >said 2>&1 && grep 'for Windows on x86-64' said &&
        ! with_tools conan create "$root/packaging/conan" "${windows[@]}" -tf="" >said 2>&1 &&
        grep 'makes one for Windows' said
}

homebrew_formula() { ruby -c "$root/packaging/homebrew/bhr.rb"; }

# The crate, as it would be published, builds by itself.
crate_is_built() { cargo package --locked --allow-dirty --manifest-path "$root/Cargo.toml"; }

runs_elsewhere() {
    "$root/packaging/bare-container" "$scratch/debs" "$scratch"/tarball/*.tar.gz "$prefix" ${BHR_WHEEL:+"$BHR_WHEEL"}
}

check "tools for packages" install_tools
try "cargo-c" cargo_c
try "Debian packages, by lintian" debian_packages
try "man pages" man_pages
try "tarball for old systems" tarball
try "tarball, made again" tarball_again
try "the bill of materials is valid" bill_is_valid
try "vcpkg port" vcpkg_port
try "Conan recipe" conan_recipe
try "Conan recipe for Windows" conan_recipe_of_windows
try "Homebrew formula" homebrew_formula
try "cargo package" crate_is_built
try "a bare Debian" runs_elsewhere
