# SPDX-License-Identifier: MIT OR Apache-2.0
# panel.sh -- examples-c/panel driven as a person would, under the X display of DISPLAY. Functions only, for check of
# tests/lib.sh: each succeeds or says what was wrong. Needs xdotool and ImageMagick, and from its caller: $panel and
# $render_frame, the programs; $scratch, a folder.
# shellcheck shell=bash

panel_start=120  # seconds for a first picture, on a slow machine
panel_action=60 # seconds for what follows on an input

# panel_open OPTIONS...: starts the program, what it says going to $panel_log, and waits for its first picture.
panel_open() {
    panel_log=$(mktemp -p "$scratch" panel-XXXXXX)
    "$panel" --verbose "$@" >"$panel_log" 2>"$panel_log.err" &
    panel_pid=$!
    panel_says 1 '^frames ' "$panel_start"
}

# Puts the window of a program that stays open into $panel_window.
panel_find() {
    read -r panel_window < <(xdotool search --pid "$panel_pid" --name 'bhr: panel')
    [ -n "$panel_window" ] || panel_complain 'it has no window'
}

panel_complain() {
    printf '%s\n' "$1"
    tail -n 20 -- "$panel_log" "$panel_log.err"
    kill "$panel_pid" 2>/dev/null
    return 1
}

# panel_hears COUNT PATTERN SECONDS: waits until so many lines match; fails when it is too late or the program has
# ended.
panel_hears() {
    local end=$((SECONDS + $3))
    until [ "$(grep -cE -- "$2" "$panel_log")" -ge "$1" ]; do
        [ "$SECONDS" -lt "$end" ] && kill -0 "$panel_pid" 2>/dev/null || return 1
        sleep 0.1
    done
}

# panel_says COUNT PATTERN [SECONDS]: the same, and the end of a test that waits in vain.
panel_says() {
    panel_hears "$1" "$2" "${3:-$panel_action}" || panel_complain "'$2' was not said $1 times"
}

panel_last() {
    grep -E -- "$1" "$panel_log" | tail -n 1
}

# panel_ends: it was asked to end, and does so by itself with status 0, whatever is in flight.
panel_ends() {
    local end=$((SECONDS + panel_action))
    while kill -0 "$panel_pid" 2>/dev/null; do
        if [ "$SECONDS" -ge "$end" ]; then
            panel_complain 'it does not end'
            return 1
        fi
        sleep 0.1
    done
    wait "$panel_pid" || panel_complain "exit status $?"
}

# panel_close X Y: ends the program by its key, with the mouse in its window: without a window manager the keyboard is
# that of the window under the mouse. The first Escape may leave a text field instead.
panel_close() {
    panel_point "$1" "$2" && xdotool key Escape && sleep 0.5 || return 1
    kill -0 "$panel_pid" 2>/dev/null && xdotool key Escape
    panel_ends
}

# Inputs with pauses: a program that draws 10 frames a second sees what lasts for one of them.
panel_point() {
    xdotool mousemove --window "$panel_window" "$1" "$2" && sleep 0.3
}

panel_press() {
    panel_point "$1" "$2" && xdotool mousedown 1 && sleep 0.3 && xdotool mouseup 1 && sleep 0.3
}

# panel_ray X Y: a click there; the answer is in $panel_answer.
panel_ray() {
    local before
    before=$(grep -c '^ray ' "$panel_log")
    panel_press "$1" "$2" && panel_says $((before + 1)) '^ray ' || return 1
    panel_answer=$(panel_last '^ray ')
}

# panel_type_into X Y TEXT PATTERN: the slider there takes what is typed instead of its value, and the program says
# PATTERN then. ImGui looks at keys and buttons once in a frame: where one takes too long it has seen no Ctrl, and only
# another try helps.
panel_type_into() {
    local attempt
    for attempt in 1 2 3; do
        panel_point "$1" "$2" && xdotool keydown ctrl && sleep 0.4 && xdotool mousedown 1 && sleep 0.4 &&
            xdotool mouseup 1 && sleep 0.4 && xdotool keyup ctrl && sleep 0.4 &&
            xdotool type --delay 150 -- "$3" && sleep 0.4 &&
            xdotool keydown Return && sleep 0.4 && xdotool keyup Return || return 1
        panel_hears 1 "$4" 5 && return 0
        printf 'attempt %s to type %s was not seen\n' "$attempt" "$3"
    done
    panel_complain "'$4' was not said"
}

# panel_expect GOT WANTED
panel_expect() {
    if [ "$1" != "$2" ]; then
        panel_complain "expected '$2', got '$1'"
    fi
}

# ---- the tests ----

# A window with all panels, exactly as many pictures as asked for, and a clean end by itself.
panel_starts() {
    panel_open --size 1600x1000 --frames 3 --hold 0 --screenshot "$scratch/panel-starts.png" && panel_ends || return 1
    panel_expect "$(panel_last '^frames ')" 'frames 3' || return 1
    panel_expect "$(identify -format '%wx%h' "$scratch/panel-starts.png")" 1600x1000 || return 1
    # Without a display, or with a backend that is not there: a message and status 1.
    if DISPLAY='' "$panel" --frames 1 2>"$panel_log.err" || [ ! -s "$panel_log.err" ]; then
        panel_complain 'it starts without a display'
        return 1
    fi
    if "$panel" --frames 1 --backend metal 2>"$panel_log.err" || [ ! -s "$panel_log.err" ]; then
        panel_complain 'it starts with a backend that does not exist'
    fi
}

# Clicks ask for rays, drags orbit, the wheel zooms, Ctrl and a click takes a number, and what the library refuses
# leaves the old one.
panel_takes_clicks() {
    local left top width height middle_x middle_y
    panel_open --size 1600x1000 --paused --backend cpu --screenshot "$scratch/panel-clicks.png" &&
        panel_find || return 1
    read -r _ left top width height <<<"$(panel_last '^picture ')"
    middle_x=$((left + width / 2))
    middle_y=$((top + height / 2))

    panel_ray "$middle_x" "$middle_y" || return 1 # into the hole
    panel_expect "${panel_answer%% deflection*}" "ray $((width / 2)) $((height / 2)) captured" || return 1
    panel_ray $((left + 5)) $((top + 30)) || return 1 # past it
    panel_expect "${panel_answer%% deflection*}" 'ray 5 30 escaped' || return 1

    # 100 pixels to the right and 40 down: a quarter of a degree each.
    panel_point "$middle_x" "$middle_y" && xdotool mousedown 1 && sleep 0.3
    panel_point $((middle_x + 60)) $((middle_y + 20)) && panel_point $((middle_x + 100)) $((middle_y + 40))
    xdotool mouseup 1
    panel_says 1 'azimuth -115 elevation 20$' || return 1
    xdotool click 4
    panel_says 1 'distance 27 ' || return 1

    # Below the row of files the second row of the first section is the spin.
    panel_type_into 200 84 0.25 ' spin 0.25 ' || return 1
    # The section after the disk's: how many volumes and hot spots there are.
    panel_type_into 150 561 2 '^matter volumes 2 hot spots 0$' || return 1
    panel_type_into 150 579 1 '^matter volumes 2 hot spots 1$' || return 1
    # A refusal is written below its slider, and moves all that follows.
    panel_type_into 200 84 1.5 '^refused .*1\.5.*\[-1, 1\]' || return 1
    panel_expect "$(panel_last '^(scene|refused) ' | cut -d ' ' -f 1)" refused || return 1 # the scene is as it was

    panel_close "$middle_x" "$middle_y"
}

# panel_ctrl KEY: both are held for a while, as by a hand.
panel_ctrl() {
    xdotool keydown ctrl && sleep 0.3 && xdotool keydown "$1" && sleep 0.3 && xdotool keyup "$1" && sleep 0.3 &&
        xdotool keyup ctrl && sleep 0.3
}

# Changes are undone and done again by keys and buttons, a load among them; a scene comes back from its file, all of it,
# and a file that is none is said in the panel and changes nothing.
panel_keeps_scenes() {
    local folder=$scratch/panel-scenes spin='^scene mass 1 spin' away=800,300
    mkdir -p -- "$folder" && cd -- "$folder" && panel_open --size 1600x1000 --paused --backend cpu && panel_find ||
        return 1
    panel_type_into 200 84 0.25 "$spin 0.25 " && panel_press 140 30 && panel_says 1 '^file saved panel.toml$' &&
        cp -- panel.toml first.toml || return 1
    panel_type_into 200 84 0.5 "$spin 0.5 " && panel_point "${away%,*}" "${away#*,}" && xdotool click 4 &&
        panel_says 1 'spin 0.5 distance 27 ' && sleep 1 || return 1
    # One step is the wheel's, and one is the number's, digit by digit as it was typed.
    panel_ctrl z && panel_says 2 'spin 0.5 distance 30 ' && panel_ctrl z && panel_says 2 "$spin 0.25 " &&
        panel_ctrl y && panel_says 3 'spin 0.5 distance 30 ' && panel_press 288 30 &&
        panel_says 2 'spin 0.5 distance 27 ' || return 1
    panel_press 188 30 && panel_says 1 '^file loaded panel.toml$' && panel_says 3 "$spin 0.25 distance 30 " &&
        rm panel.toml && panel_press 140 30 && panel_says 2 '^file saved' && cmp panel.toml first.toml ||
        return 1
    echo 'spin = 3' >>panel.toml
    panel_press 188 30 && panel_says 1 '^file .*panel.toml: line .*spin' && panel_press 238 30 &&
        panel_says 3 'spin 0.5 distance 27 ' && panel_close "${away%,*}" "${away#*,}"
}

# Ten sizes, 1 x 1 among them, with frames in flight all the time: the picture follows each.
panel_resizes() {
    local size width height frames
    panel_open --size 800x600 --bare && panel_find || return 1
    for size in 1000x700 640x480 333x77 1x1 200x900 2x500 1599x33 17x17 1280x720 400x300; do
        width=${size%x*}
        height=${size#*x}
        xdotool windowsize "$panel_window" "$width" "$height"
        panel_says 1 "^picture 0 0 $width $height\$" || return 1
        sleep 0.2
    done
    frames=$(grep -c '^frames ' "$panel_log")
    panel_says $((frames + 2)) '^frames ' || return 1
    panel_close 50 50
}

# The window's content is the picture, byte for byte; the picture is what the same scene gives every time, and what
# bhr_render_image makes of it (render_frame), within one 8-bit step.
panel_saves() {
    local run difference
    for run in one two; do
        panel_open --size 480x300 --bare --frames 1 --hold 0 --screenshot "$scratch/panel-window-$run.png" \
            --picture "$scratch/panel-picture-$run.png" && panel_ends || return 1
    done
    # By itself it may take the CPU tracer, where that is done sooner.
    "$render_frame" --backend vulkan --size 480x300 --spin 0.7 --distance 30 --azimuth -90 --elevation 10 --fov 45 \
        --turbulence 0.6 \
        --output "$scratch/panel-frame.png" || return 1
    panel_expect "$(panel_compare AE window-one picture-one)" 0 || return 1
    panel_expect "$(panel_compare AE picture-one picture-two)" 0 || return 1
    difference=$(panel_compare PAE picture-one frame) # of 65535
    if ! [ "${difference%% *}" -le 257 ]; then
        panel_complain "the picture differs from render_frame's by $difference"
        return 1
    fi
    # Not one colour all over: a hole, a disk, a sky.
    if [ "$(identify -format '%k' "$scratch/panel-picture-one.png")" -le 1000 ]; then
        panel_complain 'the picture is empty'
        return 1
    fi
    panel_expect "$(identify -format '%wx%h' "$scratch/panel-picture-one.png")" 480x300
}

# panel_compare METRIC ONE OTHER: of two pictures of panel_saves.
panel_compare() {
    compare -metric "$1" "$scratch/panel-$2.png" "$scratch/panel-$3.png" null: 2>&1
}
