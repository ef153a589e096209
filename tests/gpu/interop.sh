#!/usr/bin/env bash
# SPDX-License-Identifier: MIT OR Apache-2.0
# By hand, on a machine with a GPU: the tests of bhr_interop.h there, its times at 3840 x 2160 in RGBA16F, and 10,000
# frames with descriptors and memory counted.
#
#     tests/gpu/interop.sh LIBRARY [FRAMES]
#
# LIBRARY is a libbhr.so, best the release one. Needs a C compiler and the headers and loader of Vulkan; the layers
# are used where they are. With BHR_INTEROP_PROGRAMS=FOLDER it compiles nothing, and runs the programs that lie there.
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd -P)
library=$(realpath -- "$1")
frames=${2:-10000}
bin=${BHR_INTEROP_PROGRAMS:-}
if [ -z "$bin" ]; then
    bin=$(mktemp -d)
    trap 'rm -rf -- "$bin"' EXIT
    for program in shared outputs images sky host bad killed timing; do
        cc -std=c99 -O2 -Wall -Wextra -D_GNU_SOURCE -pthread -I "$root/include" "$root/tests/interop/$program.c" \
            "$root"/tests/{interop/vk,interop/share,c/check}.c -o "$bin/$program" "$library" -lvulkan -lm
    done
fi
export LD_LIBRARY_PATH=${library%/*}${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
failed=0
for program in shared outputs images sky host bad killed "timing $frames"; do
    read -r name argument <<<"$program"
    echo "== $name"
    timeout 500 "$bin/$name" vulkan ${argument:+"$argument"} || failed=1
done
exit "$failed"
