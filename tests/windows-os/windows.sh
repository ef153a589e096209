# SPDX-License-Identifier: MIT OR Apache-2.0
# windows.sh -- tests of windows on Windows: what the screen shows of them is the frame, byte for byte but for one step.
# Functions only, for check of tests/lib.sh. Needs xdotool and ImageMagick, and from its caller: $scratch; $here;
# $seconds, for one program; in_windows, note and steps; an X server in DISPLAY without a window manager.
# shellcheck shell=bash disable=SC2154

# shot_is_frame WHAT FRAME X Y WIDTH HEIGHT: shot.png has there what the file FRAME, of RGBA8, says.
shot_is_frame() {
    local count most size=$5x$6
    convert -size "$size" -depth 8 rgba:"$2" -alpha off rgb:frame.rgb &&
        convert shot.png -crop "$size+$3+$4" +repage -alpha off -depth 8 rgb:shot.rgb || return 1
    read -r count most < <(steps frame.rgb shot.rgb)
    note '%s: %d of %d bytes of the screen differ from the frame, by %d at most\n' "$1" "$count" $(($5 * $6 * 3)) \
        "$most"
    [ "$most" -le 1 ]
}

# shown_by NAME PROGRAM ARGUMENTS...: runs a program that makes the file `shown` once its windows show something, and
# goes on once `go` is there; shot.png has the screen then. Its status is the program's.
shown_by() {
    local pid status=0 i folder=$scratch/$1
    mkdir -- "$folder" && cd -- "$folder" || return 1
    in_windows "${@:2}" &
    pid=$!
    for ((i = 0; i < 1200; i++)); do
        [ ! -e shown ] && kill -0 "$pid" 2>/dev/null || break
        sleep 0.1
    done
    sleep 1 # what was presented is on its way
    import -window root shot.png || status=1
    : >go
    wait "$pid" || status=1
    [ -z "${BHR_KEEP_SHOTS:-}" ] || cp -- shot.png "$BHR_KEEP_SHOTS/$1.png"
    return "$status"
}

window_on() {
    shown_by "window-$1" window "$1" shown go frame && shot_is_frame "window, $1" frame 40 40 480 300
}

window_ends_on() {
    shown_by "window-ends-$1" window_ends "$1" shown go left right &&
        shot_is_frame "the left of two windows, $1" left 40 40 240 150 &&
        shot_is_frame "the right of two windows, $1" right 320 40 240 150
}

# ---- examples-c, with GLFW and with SDL2 ----

# The libraries, and the example programs that MinGW builds with them, by find_package of all three.
toolkits="$scratch/tool kits"
example_programs() {
    local folder=$scratch/examples
    mkdir -p -- "$folder" && "$here/fetch-toolkits" "$toolkits" || return 1
    printf '%s\n' 'cmake_minimum_required(VERSION 3.14)' 'project(host C)' 'find_package(bhr REQUIRED)' \
        'find_package(glfw3 REQUIRED)' 'find_package(SDL2 REQUIRED)' "add_subdirectory(\"$root/examples-c\" programs)" \
        >"$folder/CMakeLists.txt"
    # Libraries of this machine are not for Windows.
    cmake_builds_in "$folder" "$folder/build" "${mingw[@]}" -DCMAKE_CXX_COMPILER= -DCMAKE_FIND_ROOT_PATH="$toolkits" \
        -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY \
        -Dbhr_DIR="$package/lib/cmake/bhr" -Dglfw3_DIR="$toolkits/lib/cmake/glfw3" \
        -DSDL2_DIR="$toolkits/lib/cmake/SDL2" &&
        cp -- "$package/bin/bhr.dll" "$toolkits"/bin/*.dll "$folder/build/programs"
}

# example_until SECONDS COMMAND...: asks again and again until it succeeds; fails after the time, or when the program
# is gone.
example_until() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] && kill -0 "$example_pid" 2>/dev/null || {
            echo "waited in vain for: $*"
            cat -- said
            return 1
        }
        sleep 0.2
    done
}

example_says() { grep -q -e "$1" said; }
example_is_found() {
    example_window=$(xdotool search --onlyvisible --name '^bhr' | tail -n 1) && [ -n "$example_window" ]
}

# The window shows the screenshot that the program has saved. Sets $example_steps.
example_shows_held() {
    local count most size
    import -window "$example_window" shot.png || return 1
    size=$(identify -format '%w %h' shot.png)
    [ "$size" = "$(identify -format '%w %h' held.png)" ] || { echo "the window has $size" && return 1; }
    convert held.png -alpha off -depth 8 rgb:frame.rgb && convert shot.png -alpha off -depth 8 rgb:shot.rgb || return 1
    read -r count most < <(steps frame.rgb shot.rgb)
    example_steps="$count of $(stat -c %s frame.rgb) bytes of the screen differ from the frame, by $most at most"
    [ "$most" -le 1 ]
}

# example_has WIDTH HEIGHT: the window has this size, and a picture in all four quarters.
example_has() {
    local quarter
    import -window "$example_window" sized.png && [ "$(identify -format '%w %h' sized.png)" = "$1 $2" ] || return 1
    for quarter in NorthWest NorthEast SouthWest SouthEast; do
        [ "$(convert sized.png -gravity "$quarter" -crop 50%x50%+0+0 +repage -format '%k' info:)" -gt 50 ] || return 1
    done
}

# example_on NAME WIDTH HEIGHT PROGRAM OPTIONS...: its window has so many pixels and shows what it has saved; it follows
# two other sizes while it holds its picture, and ends with status 0 when its window is closed.
example_on() {
    local folder=$scratch/example-$1 status=0
    mkdir -- "$folder" && cd -- "$folder" || return 1
    timeout -k 10 "$seconds" wine "$scratch/examples/build/programs/$4.exe" --frames 3 --screenshot held.png \
        --hold 240 "${@:5}" >said 2>&1 &
    example_pid=$!
    example_until 120 example_says '^holding' && example_until 60 example_is_found &&
        example_until 60 example_shows_held || status=1
    [ -z "${BHR_KEEP_SHOTS:-}" ] || cp -- shot.png "$BHR_KEEP_SHOTS/$1.png"
    [ "$status" -ne 0 ] || {
        note '%s: %s\n' "$1" "$example_steps"
        [ "$(identify -format '%w %h' held.png)" = "$2 $3" ] && xdotool windowsize "$example_window" 320 200 &&
            example_until 60 example_has 320 200 && xdotool windowsize "$example_window" 500 260 &&
            example_until 60 example_has 500 260 || status=1
    }
    timeout 60 wine taskkill /im "$4.exe" # asks its window to close
    wait "$example_pid" || status=1
    cat -- said
    ! example_says '^cannot' && [ "$status" -eq 0 ]
}

# display_has DPI: sets the dots per inch for programs that start from now on.
display_has() {
    timeout 60 wine reg add 'HKCU\Control Panel\Desktop' /v LogPixels /t REG_DWORD /d "$1" /f >/dev/null &&
        timeout 60 wineserver -w
}

# On a display of 144 dots per inch a window of SDL's of 480 x 300 units has 720 x 450 pixels, and the viewer's, which
# is 1280 x 720 where nobody asks for a size, 1920 x 1080. Windows stretches neither.
dense_display() {
    local status=0
    display_has 144 && example_on sdl-dense 720 450 sdl_window --backend cpu --size 480x300 &&
        example_on viewer-dense 1920 1080 viewer --backend vulkan || status=1
    display_has 96 && return "$status"
}
