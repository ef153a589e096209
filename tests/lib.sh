# SPDX-License-Identifier: MIT OR Apache-2.0
# lib.sh -- what the scripts of tests/ share: folders, the Vulkan driver, building, counting. Sourced by them; runs no
# test.
# shellcheck shell=bash

tests=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd -P)
root=$(dirname -- "$tests")

# Takes a relative CARGO_TARGET_DIR from where it is called, as cargo does.
case ${CARGO_TARGET_DIR:-} in
    "") target=$root/target ;;
    /*) target=$CARGO_TARGET_DIR ;;
    *) target=$PWD/$CARGO_TARGET_DIR ;;
esac
export CARGO_TARGET_DIR=$target

# Whether long soaks run: tests/run all.
runs_all() { [ "${BHR_TESTS_ALL:-}" = 1 ]; }
# in_all COMMAND...: a test of tests/run all. The head of tests/run says what stands for it everyday.
in_all() { ! runs_all || "$@"; }

# The library that C programs and examples link. It is the one that cargo builds for the Rust tests, optimised, with
# every check on and with symbols, so that nothing has to be built twice; with the long soaks it is the release
# library, as hosts link it, and the checked one serves valgrind.
checked_library=$target/checked/deps/libbhr.so
library=$checked_library
! runs_all || library=$target/release/libbhr.so

passed=0
failed=0

# The manifest of lavapipe, Mesa's Vulkan driver for the CPU; fails when it is not installed. Debian may have those of
# other architectures beside this machine's (tests/aarch64).
lavapipe_manifest() {
    local manifest folder
    for folder in /usr/share /usr/local/share /etc; do
        for manifest in "$folder/vulkan/icd.d/lvp_icd."{"$(uname -m).json",json}; do
            if [ -f "$manifest" ]; then
                printf '%s\n' "$manifest"
                return 0
            fi
        done
    done
    return 1
}

# Picks the Vulkan driver that every test sees: what the caller chose, else the machine's own where there is a GPU,
# else lavapipe. Makes a run-time folder for drivers that want one. Fails when there is no driver at all.
use_vulkan_driver() {
    if [ -z "${XDG_RUNTIME_DIR:-}" ]; then
        XDG_RUNTIME_DIR=$scratch/runtime
        mkdir -m 700 -- "$XDG_RUNTIME_DIR"
        export XDG_RUNTIME_DIR
    fi
    if [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ]; then
        return 0
    fi
    if compgen -G '/dev/dri/renderD*' >/dev/null || [ -e /dev/nvidia0 ]; then
        return 0
    fi
    VK_DRIVER_FILES=$(lavapipe_manifest) || return 1
    VK_ICD_FILENAMES=$VK_DRIVER_FILES # the same, for loaders before 1.3.207
    export VK_DRIVER_FILES VK_ICD_FILENAMES
}

# without_drivers COMMAND...: as on a machine where neither a Vulkan loader nor EGL is installed. The dynamic linker
# stops at the first file of a name, and these are no libraries.
without_drivers() {
    local name folder=$scratch/no-drivers
    mkdir -p -- "$folder"
    for name in libvulkan.so.1 libvulkan.so libEGL.so.1 libEGL.so; do
        : >"$folder/$name"
    done
    LD_LIBRARY_PATH=$folder${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} "$@"
}

# Cargo tells checkouts that share a target folder apart by nothing but the age of their files, and a checkout that was
# moved not at all: it takes what the other one built, which looks for its files there. What is bhr's in the target
# folder goes when another checkout built it.
own_target_folder() {
    local mark=$target/bhr-checkout profile
    if [ -f "$mark" ] && [ "$(cat -- "$mark")" != "$root" ]; then
        for profile in release checked; do
            cargo clean --quiet --profile "$profile" --package libbhr --manifest-path "$root/Cargo.toml" || return 1
        done
        rm -rf -- "$target/web-quick" || return 1
    fi
    mkdir -p -- "$target" && printf '%s\n' "$root" >"$mark"
}

# The example programs, by CMake.
examples=$target/examples-cmake
cmake_builds() (
    # Scripts that run side by side all ask for them.
    mkdir -p -- "$target" && exec 9>"$examples.lock" && flock 9 || return 1
    # CMake refuses a folder that it made for another checkout, or at another place: that one is started afresh.
    local cache=$examples/CMakeCache.txt line
    for line in "CMAKE_HOME_DIRECTORY:INTERNAL=$root/examples-c" "CMAKE_CACHEFILE_DIR:INTERNAL=$examples"; do
        [ ! -f "$cache" ] || grep -qxF -e "$line" -- "$cache" || rm -rf -- "$examples"
    done
    # Their speed is the library's: everyday they are compiled quickly.
    local flags=(-DCMAKE_C_FLAGS_RELEASE=-O1 -DCMAKE_CXX_FLAGS_RELEASE=-O0)
    ! runs_all || flags=("-DCMAKE_C_FLAGS_RELEASE=-O3 -DNDEBUG" "-DCMAKE_CXX_FLAGS_RELEASE=-O3 -DNDEBUG")
    cmake -S "$root/examples-c" -B "$examples" -DBHR_ROOT="$root" -DBHR_LIBRARY="$library" -DCMAKE_BUILD_TYPE=Release \
        "${flags[@]}" &&
        cmake --build "$examples" --parallel 2
)

# cargo_test ARGUMENTS...: cargo test of bhr as all tests build it. Clippy's driver is rustc, and says what Clippy finds
# besides: cargo clippy would check all dependencies once more, for a minute and a half of a processor. Cargo keeps what
# it builds apart from what plain rustc does. Its warnings are errors in tests/rust/run.
cargo_test() {
    RUSTC_WORKSPACE_WRAPPER=clippy-driver \
        cargo test --profile checked --locked --features cli --manifest-path "$root/Cargo.toml" "$@"
}

# Builds the libraries that the C tests and examples need. cargo test makes the checked one: cargo build would make
# another, without the features of dependencies that only tests need, and compile those dependencies once more for it.
# tests/run has built them before it starts the scripts that ask for them, several at a time.
build_library() {
    [ -z "${BHR_TESTS_BUILT:-}" ] || return 0
    own_target_folder || return 1
    cargo_test --no-run --test reference || return 1
    ! runs_all ||
        cargo build --release --lib --features cli --bin bhr --locked --manifest-path "$root/Cargo.toml"
}

# compile_c PROGRAM SOURCES AND FLAGS...: a C program that links $library. The runpath, unlike an rpath, comes after
# LD_LIBRARY_PATH.
compile_c() {
    local program=$1
    shift
    cc -std=c99 -g -O1 -Wall -Wextra -Wpedantic -Werror -pthread -I "$root/include" "$@" -o "$program" \
        -L "${library%/*}" -lbhr -lm -Xlinker --enable-new-dtags -Xlinker -rpath -Xlinker "${library%/*}"
}

# under_valgrind COMMAND...: the CPU backend of the checked library, which has symbols, for at most $seconds. Drivers
# are hidden, as their own leaks and unknown instructions are not the library's.
under_valgrind() {
    CHECK_WITHOUT_MILKY_WAY=1 LD_LIBRARY_PATH=${checked_library%/*} without_drivers timeout "${seconds:-600}" \
        valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite \
        --show-leak-kinds=definite --suppressions="$tests/c/valgrind.supp" --vgdb=no "$@"
}

# Where each test's name goes, after its seconds and those of the processors: tests/run shows the slowest.
export BHR_TESTS_TIMES=${BHR_TESTS_TIMES:-/dev/null}

# Sets $processor_ms: what this shell's programs that ended took of the processors, in milliseconds.
processor_time() {
    local part
    times >"$scratch/times"
    processor_ms=0
    for part in $(tail -n 1 -- "$scratch/times"); do # such as 1m2.345s
        part=${part%s}
        processor_ms=$((processor_ms + 60000 * ${part%m*}))
        part=${part#*m}
        processor_ms=$((processor_ms + 10#${part/[.,]/}))
    done
}

# count NAME STATUS SECONDS FILE MILLISECONDS: one test's end, and what it took of the processors. Says ok or FAIL and
# the time; shows what it printed only when it failed.
count() {
    if [ "$2" -eq 0 ]; then
        passed=$((passed + 1))
        printf 'ok    %s (%d s)\n' "$1" "$3"
    else
        failed=$((failed + 1))
        printf 'FAIL  %s (exit status %d, %d s)\n' "$1" "$2" "$3"
        tail -n 100 -- "$4" | sed 's/^/      /'
    fi
    printf '%d\t%d.%03d\t%s\n' "$3" $(($5 / 1000)) $(($5 % 1000)) "$1" >>"$BHR_TESTS_TIMES"
}

# check NAME COMMAND...: one test, in a subshell.
check() {
    local name=$1 begin=$SECONDS status=0 processor_ms before
    shift
    processor_time
    before=$processor_ms
    ("$@") >"$scratch/output" 2>&1 </dev/null || status=$?
    processor_time
    count "$name" "$status" $((SECONDS - begin)) "$scratch/output" $((processor_ms - before))
}

# begin NAME COMMAND...: as check, but as many at a time as there are cores, for what keeps one of them busy.
# count_begun waits for all of them and counts.
begun=()
begun_pids=()
begin() {
    local name=$1 file=$scratch/begun-${#begun[@]} pid running
    shift
    while running=0; for pid in "${begun_pids[@]}"; do kill -0 "$pid" 2>/dev/null && running=$((running + 1)); done
        [ "$running" -ge "$(nproc)" ]; do
        sleep 0.2
    done
    (
        status=0 since=$SECONDS processor_ms=0 scratch=$file.d
        rm -rf -- "$scratch" "$file.end" # an earlier count_begun's
        mkdir -- "$scratch"
        ("$@") >"$file" 2>&1 </dev/null || status=$?
        processor_time
        printf '%d %d %d\n' "$status" $((SECONDS - since)) "$processor_ms" >"$file.end"
    ) &
    begun+=("$name")
    begun_pids+=($!)
}
count_begun() {
    local i status seconds processor_ms
    for i in "${!begun[@]}"; do
        wait "${begun_pids[i]}" 2>/dev/null # which may have been waited for already
        status=1 seconds=0 processor_ms=0
        [ -s "$scratch/begun-$i.end" ] && read -r status seconds processor_ms <"$scratch/begun-$i.end"
        count "${begun[i]}" "$status" "$seconds" "$scratch/begun-$i" "$processor_ms"
    done
    begun=()
    begun_pids=()
}

# stop MESSAGE...: ends a script at once, as something that the tests need is missing.
stop() {
    printf '%s\n' "$@"
    failed=$((failed + 1))
    finish
    exit 1
}

# Ends a script: the count as a plain line, and the exit status.
finish() {
    printf '%d passed, %d failed\n' "$passed" "$failed"
    [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
}
