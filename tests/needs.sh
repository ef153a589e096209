# SPDX-License-Identifier: MIT OR Apache-2.0
# needs.sh -- finds the programs and libraries that the tests need, and installs them on Debian and Ubuntu. Sourced by
# tests/run after lib.sh; runs no test. Its functions answer by their exit status, or print the Debian packages of
# what is missing.
# shellcheck shell=bash

# No pipe into grep -q, here or in any script: grep ends at its first match, what feeds it is killed by SIGPIPE as soon
# as it has more to say than a pipe holds, and pipefail makes a failure of that.

# has_library NAME: the dynamic linker knows the library.
has_library() { [[ $(ldconfig -p 2>/dev/null) == *"$1"* ]]; }
has_vulkan_loader() { has_library libvulkan.so.1; }
has_software_gl() {
    has_library libEGL.so.1 &&
        { compgen -G '/usr/lib/*/dri/swrast_dri.so' || compgen -G '/usr/lib/*/libgallium*.so'; } >/dev/null
}
has_vulkan_driver() { [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] || lavapipe_manifest >/dev/null; }
# compiles COMPILER LANGUAGE HEADER...
compiles() {
    local compiler=$1 language=$2
    shift 2
    { printf '#include <%s>\n' "$@" && echo 'int main(void) { return 0; }'; } |
        "$compiler" -x "$language" - -o "$scratch/probe" 2>/dev/null
}
c_compiles() { compiles cc c stdio.h; }
cxx_compiles() { compiles c++ c++ cstdio; }
valgrind_works() { c_compiles && valgrind --quiet --error-exitcode=9 "$scratch/probe" 2>/dev/null; }

has_validation() { compgen -G '/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation*.json' >/dev/null; }
# missing PACKAGE COMMAND...: the package, unless all of these commands are there.
missing() {
    local package=$1 command
    shift
    for command; do
        command -v "$command" >/dev/null || { printf '%s\n' "$package" && return; }
    done
}

# The Debian packages of missing programs and libraries that make windows and look at them.
missing_window_packages() {
    missing xvfb Xvfb
    missing weston weston
    missing xdotool xdotool
    missing imagemagick import identify compare convert
    missing pkg-config pkg-config
    compiles cc c X11/Xlib.h || printf '%s\n' libx11-dev
    compiles cc c xcb/xcb.h || printf '%s\n' libxcb1-dev
    compiles cc c X11/Xlib.h X11/extensions/Xrandr.h || printf '%s\n' libxrandr-dev
    compiles cc c GLFW/glfw3.h || printf '%s\n' libglfw3-dev
    compiles cc c SDL2/SDL.h || printf '%s\n' libsdl2-dev
    compiles c++ c++ GL/gl.h || printf '%s\n' libgl-dev
    compiles c++ c++ imgui/imgui.h || printf '%s\n' libimgui-dev
    compiles cc c vulkan/vulkan.h || printf '%s\n' libvulkan-dev
    compiles cc c EGL/egl.h || printf '%s\n' libegl-dev
    has_validation || printf '%s\n' vulkan-validationlayers
}

# The Debian packages of missing programs that build bhr.dll for Windows, and hosts of it, and run them.
missing_packages_of_windows() {
    missing gcc-mingw-w64-x86-64 x86_64-w64-mingw32-gcc
    missing binutils-mingw-w64-x86-64 x86_64-w64-mingw32-objdump
    missing wine wine wineserver
    missing zip zip
    missing unzip unzip
    missing clang clang
    missing lld lld-link
    missing llvm llvm-dlltool
}

# The Debian packages of missing programs and libraries that build libbhr.so for AArch64, and hosts of it, and run them.
missing_packages_of_aarch64() {
    dpkg-query -W libc6:arm64 >/dev/null 2>&1 || printf '%s\n' libc6:arm64
    [[ " $* " != *" vulkan "* ]] || [ -e /usr/lib/aarch64-linux-gnu/libvulkan_lvp.so ] ||
        printf '%s\n' mesa-vulkan-drivers:arm64
    [[ " $* " != *" vulkan "* ]] || [ -e /usr/lib/aarch64-linux-gnu/libvulkan.so.1 ] ||
        printf '%s\n' libvulkan1:arm64
    missing gcc-aarch64-linux-gnu aarch64-linux-gnu-gcc aarch64-linux-gnu-ld
    command -v aarch64-linux-gnu-gcc >/dev/null && compiles aarch64-linux-gnu-gcc c stdio.h ||
        printf '%s\n' libc6-dev-arm64-cross
    missing qemu-user qemu-aarch64
    missing debhelper dh
}

# The Debian packages of missing programs that only tests/run all needs.
missing_packages_of_all() {
    missing clang clang++
    missing golang-go go gofmt
    missing gcc-arm-linux-gnueabihf arm-linux-gnueabihf-gcc
    missing_packages_of_windows
    missing_packages_of_aarch64 vulkan
    missing openmpi-bin mpirun
    missing libopenmpi-dev mpicc
    missing slurmctld slurmctld
    missing slurmd slurmd
    missing munge munged
    missing firefox-esr firefox-esr
}

# The Debian packages of what is missing, one a line.
missing_packages() {
    c_compiles || printf '%s\n' gcc libc6-dev
    cxx_compiles || printf '%s\n' g++
    python3 -c 'import ensurepip, venv' 2>/dev/null || printf '%s\n' python3 python3-venv
    command -v cmake >/dev/null && command -v make >/dev/null || printf '%s\n' cmake make
    missing meson meson
    missing ninja-build ninja
    missing binutils ld objcopy readelf
    valgrind_works || printf '%s\n' valgrind libc6-dbg
    missing abigail-tools abidiff abidw
    has_vulkan_loader || printf '%s\n' libvulkan1
    has_vulkan_driver || printf '%s\n' mesa-vulkan-drivers
    has_software_gl || printf '%s\n' libegl1 libgl1-mesa-dri
    missing luajit luajit
    luajit -e 'require "dkjson"' 2>/dev/null || printf '%s\n' lua-dkjson
    missing doxygen doxygen
    missing ffmpeg ffmpeg ffprobe
    missing procps pkill pgrep
    missing chromium chromium
    missing nodejs node
    missing npm npm
    missing_window_packages
    ! runs_all || missing_packages_of_all
}

install_missing() {
    local packages as_root=()
    mapfile -t packages < <(missing_packages)
    [ ${#packages[@]} -gt 0 ] || return 0
    local install="apt-get install --no-install-recommends ${packages[*]}"
    local advice="apt-get update && $install" other=(true)
    # Packages of another architecture are known only when it was added. Ubuntu has them in an archive of their own,
    # without which apt would fail from then on.
    if [[ " ${packages[*]} " == *:arm64\ * ]]; then
        grep -qx 'ID=debian' /etc/os-release 2>/dev/null ||
            stop "Missing here, from an archive for arm64 that apt has to be told of: ${packages[*]}"
        advice="dpkg --add-architecture arm64 && $advice"
        other=(dpkg --add-architecture arm64)
    fi
    command -v apt-get >/dev/null || stop "Missing here, by their Debian names: ${packages[*]}"
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || stop "Packages are missing, and there is no sudo here. Run as root:" "    $advice"
        advice=$(sed -E 's/(^|&& )/\1sudo /g' <<<"$advice")
        sudo -n true 2>/dev/null || stop "Packages are missing, and sudo asks for a password here. Run:" "    $advice"
        as_root=(sudo -n)
    fi
    printf 'Installing %s\n' "${packages[*]}"
    "${as_root[@]}" "${other[@]}" && "${as_root[@]}" apt-get update -qq &&
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
            apt-get install -y -qq --no-install-recommends "${packages[@]}" >"$scratch/apt" 2>&1 || {
        tail -n 30 -- "$scratch/apt"
        stop "The installation failed. Run:" "    $advice"
    }
    mapfile -t packages < <(missing_packages)
    [ ${#packages[@]} -eq 0 ] || stop "Still missing after the installation: ${packages[*]}"
}

need_rust() {
    command -v cargo >/dev/null || stop "Rust is missing (cargo was not found). Get it from https://rustup.rs"
    local part
    for part in fmt clippy; do
        cargo "$part" --version >/dev/null 2>&1 && continue
        rustup component add rustfmt clippy ||
            stop "cargo $part is missing. Run:" "    rustup component add rustfmt clippy"
    done
    # The standard library of web pages.
    local triple=wasm32-unknown-unknown
    compgen -G "$(rustc --print target-libdir --target "$triple")/libstd-*.rlib" >/dev/null ||
        rustup target add "$triple" ||
        stop "Rust's standard library for $triple is missing. Run:" "    rustup target add $triple"
}
