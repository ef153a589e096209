# SPDX-License-Identifier: MIT OR Apache-2.0
# sdl.sh -- tests of examples-c/sdl_window, a host with SDL2, on X11 and on Wayland. Functions only, for check of
# tests/lib.sh: each succeeds or says what was wrong. Needs xdotool, ImageMagick and weston, and from its caller:
# $sdl_window, the program; $scratch, a folder; XDG_RUNTIME_DIR; an X server in DISPLAY without a window manager.
# shellcheck shell=bash disable=SC2154

# sdl_until SECONDS COMMAND...: asks again and again until it succeeds; fails after the time, or when the program is
# gone.
sdl_until() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] && kill -0 "$sdl_pid" 2>/dev/null || {
            echo "waited in vain for: $*"
            cat -- "$scratch/sdl.log"
            return 1
        }
        sleep 0.1
    done
}

sdl_says() { grep -q -e "$1" "$scratch/sdl.log"; }
sdl_find() { sdl_window_id=$(xdotool search --onlyvisible --pid "$sdl_pid" | tail -n 1) && [ -n "$sdl_window_id" ]; }
sdl_is_gone() { ! kill -0 "$sdl_pid" 2>/dev/null; }

# sdl_open DRIVER OPTIONS...: starts it in the background. Sets sdl_pid.
sdl_open() {
    SDL_VIDEODRIVER=$1 "$sdl_window" "${@:2}" >"$scratch/sdl.log" 2>&1 &
    sdl_pid=$!
    trap sdl_end EXIT # check runs every test in a subshell
}

# Ends what a test has left, in the order that leaves nobody without a display.
sdl_end() {
    local pid
    for pid in ${sdl_pid:-} ${sdl_weston:-}; do
        kill "$pid" 2>/dev/null && wait "$pid"
    done
    return 0
}

# SDL makes SIGTERM a wish to close the window: the program ends by itself, with status 0.
sdl_close() {
    local status=0 end=$((SECONDS + 30))
    kill "$sdl_pid" || return 1
    until sdl_is_gone; do
        [ "$SECONDS" -lt "$end" ] || { echo "it does not end"; return 1; }
        sleep 0.1
    done
    wait "$sdl_pid" || status=$?
    sdl_pid=
    cat -- "$scratch/sdl.log"
    [ "$status" -eq 0 ] && ! sdl_says '^cannot'
}

# sdl_equal A B: of one size, and no channel of a pixel differs by more than one 8-bit step.
sdl_equal() {
    local error
    [ "$(identify -format '%wx%h' "$1")" = "$(identify -format '%wx%h' "$2")" ] || {
        identify "$1" "$2"
        return 1
    }
    error=$(compare -metric PAE "$1" "$2" null: 2>&1)
    echo "largest difference of a channel: $error"
    awk -v text="$error" 'BEGIN { gsub(/.*\(|\)/, "", text); exit !(text ~ /^[0-9.e+-]+$/ && text * 255 < 1.001) }'
}

# sdl_shows FILE COLOURS: what the window shows now, and that it is a picture.
sdl_shows() { import -window "$sdl_window_id" "$1" && [ "$(identify -format '%k' "$1")" -gt "$2" ]; }

# sdl_shows_held AREA: what the window shows now is the screenshot, in an area of both.
sdl_shows_held() {
    sdl_shows "$scratch/sdl-shown.png" 200 &&
        [ "$(identify -format '%wx%h' "$scratch/sdl-shown.png")" = \
            "$(identify -format '%wx%h' "$scratch/sdl-held.png")" ] || return 1
    local name
    for name in held shown; do
        convert "$scratch/sdl-$name.png" -crop "$1" +repage "$scratch/sdl-$name-area.png" || return 1
    done
    sdl_equal "$scratch/sdl-held-area.png" "$scratch/sdl-shown-area.png"
}

# So many frames, status 0, nothing on stderr; and a driver of SDL's without windows is refused.
sdl_starts() {
    SDL_VIDEODRIVER=x11 "$sdl_window" --size 320x180 --frames 5 >"$scratch/sdl.out" 2>"$scratch/sdl.log" || return 1
    cat -- "$scratch/sdl.out" "$scratch/sdl.log"
    grep -qx 'frames 5' "$scratch/sdl.out" && [ ! -s "$scratch/sdl.log" ] || return 1
    ! SDL_VIDEODRIVER=dummy "$sdl_window" --frames 1 >"$scratch/sdl.log" 2>&1 && sdl_says 'dummy has no windows'
}

# sdl_follows_sizes: the window, whatever is done to it, and a drag turns the picture.
sdl_follows_sizes() {
    local size
    for size in 200x100 1x1 640x360 100x400 33x17 320x180; do
        xdotool windowsize "$sdl_window_id" "${size%x*}" "${size#*x}" && sleep 0.5 || return 1
        import -window "$sdl_window_id" "$scratch/sdl.png" &&
            [ "$(identify -format '%wx%h' "$scratch/sdl.png")" = "$size" ] || { identify "$scratch/sdl.png"; return 1; }
    done
    xdotool windowunmap "$sdl_window_id" && sleep 0.5 && xdotool windowmap "$sdl_window_id" && sleep 0.5 &&
        sdl_until 60 sdl_shows "$scratch/sdl-before.png" 200 || return 1
    xdotool mousemove --window "$sdl_window_id" 100 60 mousedown 1 && sleep 0.2 || return 1
    for size in 1 2 3 4 5; do
        xdotool mousemove_relative 30 9 && sleep 0.1
    done
    xdotool mouseup 1 && sleep 1 && sdl_shows "$scratch/sdl-after.png" 200 &&
        ! sdl_equal "$scratch/sdl-before.png" "$scratch/sdl-after.png"
}

# Under Xlib: the window shows what bhr_render_image gives; it follows sizes, hiding and the mouse; it closes.
sdl_on_x11() {
    sdl_starts || return 1
    sdl_open x11 --size 480x270 --frames 3 --screenshot "$scratch/sdl-held.png" --hold 60 || return 1
    sdl_until 60 sdl_says '^holding' && sdl_until 60 sdl_find && sdl_until 60 sdl_shows_held 480x270+0+0 && sdl_close ||
        return 1
    sdl_open x11 --size 320x180 && sdl_until 60 sdl_find && sleep 1 && sdl_follows_sizes && sdl_close
}

# sdl_weston_begin WIDTH HEIGHT: a compositor in a window of the X server, whose shell gives every window all of its
# screen. (Headless weston has no seat, and SDL 2.26's start follows a null pointer then.) Sets sdl_weston.
sdl_weston_begin() {
    export WAYLAND_DISPLAY=bhr-sdl-$BASHPID
    weston --backend=x11-backend.so --shell=kiosk-shell.so --use-pixman --idle-time=0 --socket="$WAYLAND_DISPLAY" \
        --width="$1" --height="$2" >"$scratch/sdl-weston.log" 2>&1 &
    sdl_weston=$!
    sdl_pid=$sdl_weston
    trap sdl_end EXIT
    : >"$scratch/sdl.log"
    sdl_until 60 test -S "$XDG_RUNTIME_DIR/$WAYLAND_DISPLAY" &&
        sdl_until 60 sdl_find_weston || { cat -- "$scratch/sdl-weston.log"; return 1; }
}
sdl_find_weston() {
    sdl_window_id=$(sed -n 's/.*x11 output .* window id \([0-9]*\)$/\1/p' "$scratch/sdl-weston.log") &&
        [ -n "$sdl_window_id" ]
}

# On Wayland: exactly so many frames, no error; the compositor makes the window larger than it began, and shows at that
# size what bhr_render_image gives, but for the pointer in its corner.
sdl_on_wayland() {
    sdl_weston_begin 640 400 || return 1
    xdotool mousemove --window "$sdl_window_id" 638 398 && sleep 0.5
    sdl_open wayland --size 320x180 --frames 20 --screenshot "$scratch/sdl-held.png" --hold 60 || return 1
    sdl_until 60 sdl_says '^holding' && sdl_says '^frames 20$' || return 1
    [ "$(identify -format '%wx%h' "$scratch/sdl-held.png")" = 640x400 ] ||
        { identify "$scratch/sdl-held.png"; return 1; }
    # The compositor may not be done with the last frame.
    sdl_until 60 sdl_shows_held 600x360+0+0 && sdl_close
}
