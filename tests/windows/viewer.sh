# SPDX-License-Identifier: MIT OR Apache-2.0
# viewer.sh -- tests of examples-c/viewer in a window: started, driven with xdotool, looked at with ImageMagick.
# Functions only, each one a test for `check` or a helper of them. Needs tests/lib.sh's $scratch, $viewer (the program),
# and an X server in DISPLAY without a window manager; Xvfb with -noreset, as it is deaf for a moment after its last
# client has left.
# shellcheck shell=bash disable=SC2154

viewer_log=$scratch/viewer.log

# viewer_until SECONDS COMMAND...: asks again and again until it succeeds; fails after the time.
viewer_until() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] || {
            echo "waited in vain for: $*"
            return 1
        }
        sleep 0.1
    done
}

viewer_window_of() { xdotool search --onlyvisible --pid "$1"; }
viewer_says() { grep -q -e "$1" "$viewer_log"; }
viewer_lives() { kill -0 "$viewer_pid" 2>/dev/null || { echo "the viewer is gone"; return 1; }; }
viewer_title() { xdotool getwindowname "$viewer_window"; }
viewer_title_says() { grep -q -e "$1" <<<"$(viewer_title)"; }

# viewer_open OPTIONS...: starts it in the background in a folder of its own, waits for its first frames and puts the
# mouse, and so the keys, over its window. Sets viewer_pid, viewer_window, viewer_folder.
viewer_open() {
    viewer_folder=$(mktemp -d -p "$scratch") || return 1
    : >"$viewer_log"
    (cd -- "$viewer_folder" && exec "$viewer" "$@") >"$viewer_log" 2>&1 &
    viewer_pid=$!
    trap 'viewer_end' EXIT # check runs every test in a subshell
    viewer_until 60 viewer_window_of "$viewer_pid" || { cat -- "$viewer_log"; return 1; }
    viewer_window=$(viewer_window_of "$viewer_pid" | tail -n 1)
    viewer_until 60 viewer_title_says 'M 1' && xdotool mousemove --window "$viewer_window" 100 60
}

# Ends a viewer that a failed test has left.
viewer_end() {
    [ -n "${viewer_pid:-}" ] && kill "$viewer_pid" 2>/dev/null && wait "$viewer_pid"
    return 0
}

# Esc: it must end by itself, with status 0.
viewer_close() {
    local status=0
    viewer_lives && xdotool key Escape && viewer_until 60 viewer_is_gone || return 1
    wait "$viewer_pid" || status=$?
    viewer_pid=
    cat -- "$viewer_log"
    [ "$status" -eq 0 ]
}
viewer_is_gone() { ! kill -0 "$viewer_pid"; }

# viewer_grab FILE: what the window shows now.
viewer_grab() { import -window "$viewer_window" "$1"; }

# viewer_colours FILE: how many.
viewer_colours() { identify -format '%k' "$1"; }

# viewer_equal A B: the pictures' sizes are equal, and no channel of a pixel differs by more than one 8-bit step.
viewer_equal() {
    local error
    [ "$(identify -format '%wx%h' "$1")" = "$(identify -format '%wx%h' "$2")" ] || {
        identify "$1" "$2"
        return 1
    }
    error=$(compare -metric PAE "$1" "$2" -alpha off null: 2>&1)
    echo "largest difference of a channel: $error"
    awk -v text="$error" 'BEGIN { gsub(/.*\(|\)/, "", text); exit !(text ~ /^[0-9.e+-]+$/ && text * 255 < 1.001) }'
}

# ---- the tests ----

# Exactly so many frames, status 0, nothing on stderr.
viewer_starts() {
    "$viewer" --size 320x180 --frames 20 --screenshot "$scratch/viewer-first.png" 2>"$scratch/viewer-errors" || return 1
    cat -- "$scratch/viewer-errors"
    [ ! -s "$scratch/viewer-errors" ] && [ "$(viewer_colours "$scratch/viewer-first.png")" -gt 200 ]
}

# The driver's own checks, where its validation layers are installed, have nothing to say. Debian 12's do not know WGSL,
# which naga names as the language of its shaders: that message is none about what the viewer does.
viewer_is_valid() {
    "$viewer" --size 160x90 --frames 5 --validation 2>"$scratch/viewer-errors" || return 1
    cat -- "$scratch/viewer-errors"
    [ "$(grep -c 'VALIDATION \[' "$scratch/viewer-errors")" -eq \
        "$(grep -c 'Invalid source language operand' "$scratch/viewer-errors")" ]
}

viewer_needs_display() {
    local status=0
    env -u DISPLAY -u WAYLAND_DISPLAY "$viewer" 2>"$scratch/viewer-errors" || status=$?
    cat -- "$scratch/viewer-errors"
    [ "$status" -eq 1 ] && grep -q 'display' "$scratch/viewer-errors"
}

# Every kind of key: values, switches, what bhr refuses, motions, help; and the viewer goes on.
viewer_takes_keys() {
    viewer_open --size 160x90 || return 1
    local key
    for key in Right x x 3 v v v v v v v v u j j n n n m p space period slash shift+t g bracketleft Up k i l l \
        shift+1 shift+3 shift+3; do
        xdotool key "$key" && sleep 0.1
    done
    viewer_until 60 viewer_says 'beaming at 50 %' || return 1
    local words
    for words in 'spin 0.100' 'disk off' 'disk on' 'beaming off' 'view: metric' 'view: intensity' \
        'depth: disk' 'hot spot on' 'hot spot off' 'camera: freefall' 'camera: orbit' \
        'camera: static' 'mass 1.1' 'time stands still' '6 M of the' '-6 M of the' 'turbulence of the disk 0.90' \
        'tone map: agx' 'Doppler shift at 75 %' 'field of view 40.9' 'exposure +0.25' 'stars off' 'method: rk4' \
        'quality as it is set'; do
        viewer_says "$words" || { echo "it did not say: $words"; cat -- "$viewer_log"; return 1; }
    done
    xdotool key BackSpace && viewer_until 60 viewer_says 'back to the beginning' &&
        viewer_until 60 viewer_title_says 'a +0.000' && viewer_close
}

viewer_keys_window() { xdotool search --all --onlyvisible --pid "$viewer_pid" --name '^bhr: keys$'; }
viewer_hides_keys() { ! viewer_keys_window; }
# grep reads to the end: with -q it may close the pipe before xdotool has written its second line, which then fails.
viewer_keys_lie_at() { xdotool getwindowgeometry "$(viewer_keys_window)" | grep -e "Position: $1 " >/dev/null; }

# H shows the keys over the window, goes along with it, and takes them away; the window stays the one that hears keys.
viewer_shows_keys() {
    viewer_open --size 720x720 && xdotool key h && viewer_until 60 viewer_keys_window && sleep 1 || return 1
    import -window "$(viewer_keys_window)" "$scratch/keys.png" || return 1
    # Letters, a twentieth to a third of it, on a dark ground: white, and a rim that is darker than the ground.
    convert "$scratch/keys.png" -colorspace Gray -threshold 50% -format '%[fx:mean]' info: |
        awk '{ print "share of ink: " $0; exit !($0 > 0.03 && $0 < 0.33) }' || return 1
    viewer_until 60 viewer_keys_lie_at 12,12 && xdotool windowmove "$viewer_window" 80 60 &&
        viewer_until 60 viewer_keys_lie_at 92,72 && xdotool key m && viewer_until 60 viewer_says '^mass 1.1' &&
        xdotool key h && viewer_until 60 viewer_hides_keys && viewer_close
}

viewer_bar() { xdotool search --all --onlyvisible --pid "$viewer_pid" --name '^bhr: colours$'; }
viewer_hides_bar() { ! viewer_bar; }
# viewer_bar_lies WIDTHxHEIGHT X,Y
viewer_bar_lies() {
    local place
    place=$(xdotool getwindowgeometry "$(viewer_bar)") && grep -q -e "Geometry: $1\$" <<<"$place" &&
        grep -q -e "Position: $2 " <<<"$place"
}
# viewer_bar_shows X OTHER: red at one column and blue at the other.
viewer_bar_shows() {
    import -window "$(viewer_bar)" "$scratch/bar.png" && convert "$scratch/bar.png" -format \
        "%[fx:255*p{$1,20}.r] %[fx:255*p{$1,20}.b] %[fx:255*p{$2,20}.r] %[fx:255*p{$2,20}.b]" info: |
        awk '{ exit !($1 > 2 * $2 && $4 > 2 * $3) }'
}

# A bar says what false colours mean: at the window's foot as soon as V has chosen some, following its size and place;
# keys, wheel and drags over it are the window's; and it goes with them. The bar's ends are a twelfth from the window's.
viewer_explains_colours() {
    viewer_open --size 640x360 && viewer_hides_bar && xdotool key space v && viewer_until 60 viewer_bar &&
        viewer_until 60 viewer_bar_lies 640x44 0,316 && viewer_until 60 viewer_bar_shows 55 584 || return 1
    xdotool windowsize "$viewer_window" 720 400 windowmove "$viewer_window" 80 60 &&
        viewer_until 60 viewer_bar_lies 720x44 80,416 && viewer_until 60 viewer_bar_shows 62 657 || return 1
    xdotool mousemove 200 440 key m && viewer_until 60 viewer_says '^mass 1.1' && xdotool click 4 &&
        viewer_until 60 viewer_title_says 'r 2[0-4].* M' || return 1
    xdotool key v v v v v v v && viewer_until 60 viewer_says '^view: light' && viewer_until 60 viewer_hides_bar &&
        viewer_close
}

# A preset has the matter that --matter says, with auto the one that the rate allows, and the title says which. On the
# CPU, as each preset is a kernel on the GPU.
viewer_chooses_matter() {
    viewer_open --backend cpu --size 64x36 --preset physical --matter deep &&
        viewer_until 60 viewer_title_says 'physical, deep' || return 1
    xdotool key y && viewer_until 60 viewer_says 'preset: observatory, deep matter' || return 1
    xdotool key y && viewer_until 60 viewer_says 'preset: teaching, thin matter' &&
        viewer_until 60 viewer_title_says 'teaching, thin' && viewer_close || return 1
    viewer_open --backend cpu --size 64x36 --preset physical --rate 0.01 &&
        viewer_until 60 viewer_title_says 'physical, deep' && viewer_close || return 1
    viewer_open --backend cpu --size 64x36 --preset physical --rate 5e5 &&
        viewer_until 60 viewer_title_says 'physical, thin' && viewer_close
}

# Dragging turns the picture, the wheel brings the hole nearer, W flies on to it.
viewer_takes_mouse() {
    # At rest nothing but the mouse changes the picture.
    viewer_open --size 320x180 && xdotool key space && viewer_until 60 viewer_title_says 'at rest' || return 1
    viewer_grab "$scratch/mouse-1.png" && xdotool mousedown 1 || return 1
    local step
    for step in 1 2 3 4 5 6; do
        xdotool mousemove_relative -- 8 6 && sleep 0.1
    done
    xdotool mouseup 1 && viewer_until 60 viewer_has_turned || return 1
    viewer_until 60 viewer_title_says 'r 26.* M' || return 1
    xdotool click 4 click 4 click 4 && viewer_until 60 viewer_title_says 'r 16.* M' || { viewer_title; return 1; }
    xdotool key f keydown w && sleep 2 && xdotool keyup w &&
        viewer_until 60 viewer_title_says 'r 1[0-4]\.\|r [2-9]\.' || { viewer_title; return 1; }
    viewer_close
}

viewer_has_turned() {
    viewer_grab "$scratch/mouse-2.png" && ! viewer_equal "$scratch/mouse-1.png" "$scratch/mouse-2.png"
}

# With time stopped the picture is refined, and then costs nothing: less than a tenth of a core.
viewer_rests() {
    viewer_open --size 320x180 && xdotool key space || return 1
    viewer_until 60 viewer_title_says 'at rest' && sleep 2 || return 1
    local before after
    before=$(viewer_ticks) && sleep 3 && after=$(viewer_ticks) && echo "$((after - before)) ticks in 3 s" || return 1
    [ $((after - before)) -lt $((3 * $(getconf CLK_TCK) / 10)) ] && viewer_close
}
viewer_ticks() { awk '{ print $14 + $15 }' "/proc/$viewer_pid/stat"; }

# viewer_flies ARGUMENTS...: in a small window, as it is the way of the camera that is tested; every frame is rendered.
viewer_flies() {
    "$viewer" --size 16x9 "$@" >"$scratch/flight" 2>&1 && ! grep 'cannot' "$scratch/flight" ||
        { cat -- "$scratch/flight"; return 1; }
}

# A fall into a hole without spin goes on to the centre and begins again, one into a spinning hole to the inner horizon.
# Orbits near the hole, in the plane and inclined. Every frame of all that can be rendered.
viewer_falls_and_orbits() {
    local spin orbit=300
    local -A end=([0]=singularity [0.9]="inner horizon")
    for spin in 0 0.9; do
        viewer_flies --spin "$spin" --motion freefall --distance 4 --frames 900 &&
            grep "${end[$spin]} is reached; the fall begins again" "$scratch/flight" || return 1
        viewer_flies --spin "$spin" --motion orbit --distance 4 --frames "$orbit" || return 1
    done
}

# Ten sizes; after each the window shows a picture of that size.
viewer_resizes() {
    viewer_open --size 320x180 || return 1
    local size
    for size in 200x100 1x1 640x360 100x400 33x17 2x300 500x2 801x451 64x64 320x180; do
        xdotool windowsize "$viewer_window" "${size%x*}" "${size#*x}" && sleep 0.5 && viewer_lives || return 1
        viewer_grab "$scratch/size.png" && [ "$(identify -format '%wx%h' "$scratch/size.png")" = "$size" ] || {
            identify "$scratch/size.png"
            return 1
        }
    done
    xdotool mousemove --window "$viewer_window" 100 60 key space
    viewer_until 60 viewer_shows_picture && viewer_close && ! viewer_says 'cannot'
}
viewer_shows_picture() { viewer_grab "$scratch/shown.png" && [ "$(viewer_colours "$scratch/shown.png")" -gt 200 ]; }

# viewer_screenshot_equals_window OPTIONS...: of the same scene, to one 8-bit step in all pixels.
viewer_screenshot_equals_window() {
    viewer_open --size 480x270 --frames 3 --screenshot "$scratch/held.png" --hold 60 "$@" || return 1
    viewer_until 60 viewer_says '^holding' && sleep 0.5 && viewer_grab "$scratch/window.png" &&
        viewer_equal "$scratch/held.png" "$scratch/window.png" && viewer_end
}

# F12: numbered pictures of the window's size, none overwritten.
viewer_saves_pictures() {
    viewer_open --size 320x180 && printf 'kept' >"$viewer_folder/viewer-0001.png" || return 1
    xdotool key F12 && viewer_until 60 viewer_says 'saved: viewer-0002.png' &&
        viewer_until 60 viewer_title_says 'saved viewer-0002.png' &&
        xdotool key F12 && viewer_until 60 viewer_says 'saved: viewer-0003.png' && viewer_close &&
        [ "$(cat -- "$viewer_folder/viewer-0001.png")" = kept ] &&
        [ "$(identify -format '%wx%h' "$viewer_folder/viewer-0003.png")" = 320x180 ]
}

# F12 twice, of a scene that takes long: the picture is broken off, without a file, and the window goes on.
viewer_breaks_pictures_off() {
    viewer_open --size 320x180 --scene "$root/examples-c/scenes/soft-disk.toml" || return 1
    xdotool key F12 key F12 && viewer_until 120 viewer_says '^picture broken off: viewer-0001.png' &&
        [ ! -e "$viewer_folder/viewer-0001.png" ] && xdotool key m && viewer_until 60 viewer_says '^mass' &&
        viewer_close
}

# Esc while a picture is rendered: it says so, ends when that is saved; and at once when it is pressed again.
viewer_waits_for_pictures() {
    viewer_open --backend cpu --size 160x90 --scene "$root/examples-c/scenes/soft-disk.toml" || return 1
    xdotool key F12 && viewer_until 60 viewer_title_says 'viewer-0001.png [0-9]* %' && xdotool key Escape &&
        viewer_until 60 viewer_says '^ends when viewer-0001.png is saved; Esc again breaks it off' &&
        viewer_until 60 viewer_title_says 'Esc again ends without   viewer-0001.png' &&
        viewer_until 300 viewer_is_gone && wait "$viewer_pid" || return 1
    [ "$(identify -format '%wx%h' "$viewer_folder/viewer-0001.png")" = 160x90 ] || return 1
    viewer_open --backend cpu --size 160x90 --scene "$root/examples-c/scenes/soft-disk.toml" || return 1
    xdotool key F12 && viewer_until 60 viewer_title_says 'viewer-0001.png [0-9]* %' && xdotool key Escape &&
        viewer_until 60 viewer_says '^ends when' && xdotool key Escape && viewer_until 60 viewer_is_gone &&
        wait "$viewer_pid" && viewer_says '^picture broken off: viewer-0001.png' &&
        [ ! -e "$viewer_folder/viewer-0001.png" ]
}

# How often an exposure was said, as a number.
viewer_exposures() { grep -c '^exposure' "$viewer_log"; }

# viewer_answer_times COUNT: moves the mouse and presses a key, so many times; the milliseconds from before xdotool is
# started until the answer is in the program's output, one line each.
viewer_answer_times() {
    local i count begin
    for ((i = 0; i < $1; i++)); do
        count=$(viewer_exposures)
        xdotool mousemove_relative -- 3 1
        begin=${EPOCHREALTIME/[.,]/}
        xdotool key "$([ $((i % 2)) = 0 ] && echo Up || echo Down)"
        until [ "$(viewer_exposures)" -gt "$count" ]; do
            [ $((${EPOCHREALTIME/[.,]/} - begin)) -lt 60000000 ] || { echo 'no answer' >&2; return 1; }
        done
        echo $(((${EPOCHREALTIME/[.,]/} - begin) / 1000))
        sleep 0.05
    done
}

# viewer_median FILE: the lower of the two middle numbers of a file of an even number of lines, one number each.
viewer_median() { sort -n -- "$1" | sed -n "$(($(wc -l <"$1") / 2))p"; }

# F12 of a soft disk, by a tracer that takes many seconds for it, while the mouse drags. The median answer may come at
# most 100 ms later than without the picture: other work on the machine slows both measurements down. A window that
# waits for its frames is late nearly every time, with the picture and without it; so no more than 150 ms are taken for
# the machine's.
viewer_answers() {
    local backend=$1 before after beside machine
    viewer_open --backend "$backend" --size 240x135 --scene "$root/examples-c/scenes/soft-disk.toml" || return 1
    # The keys leave the exposure as it is here: later, only the drag makes another picture.
    viewer_grab "$scratch/answers-1.png" && viewer_answer_times 20 >"$scratch/answers-before" && xdotool key F12 &&
        viewer_until 120 viewer_title_says 'viewer-0001.png [0-9]* %' &&
        xdotool mousemove --window "$viewer_window" 100 60 mousedown 1 || return 1
    viewer_answer_times 40 >"$scratch/answers-beside" || { xdotool mouseup 1; return 1; }
    xdotool mouseup 1 && viewer_title_says 'viewer-0001.png [0-9]* %' || {
        echo 'the picture was done before the measurement'
        return 1
    }
    viewer_until 600 viewer_says '^picture saved: viewer-0001.png, 240 x 135$' &&
        viewer_until 10 viewer_title_says 'saved viewer-0001.png' &&
        [ "$(identify -format '%wx%h' "$viewer_folder/viewer-0001.png")" = 240x135 ] &&
        viewer_until 60 viewer_turned_since &&
        xdotool mousemove --window "$viewer_window" 100 60 || return 1
    viewer_answer_times 20 >"$scratch/answers-after" || return 1
    before=$(viewer_median "$scratch/answers-before")
    beside=$(viewer_median "$scratch/answers-beside")
    after=$(viewer_median "$scratch/answers-after")
    machine=$((before > after ? before : after))
    echo "median answers, ms: $before before the picture, $beside beside it, $after after it; beside it:"
    paste -sd ' ' "$scratch/answers-beside"
    [ "$beside" -le $((100 + (machine < 150 ? machine : 150))) ] && viewer_close
}
viewer_turned_since() {
    viewer_grab "$scratch/answers-2.png" && ! viewer_equal "$scratch/answers-1.png" "$scratch/answers-2.png"
}

# R: a folder of numbered pictures that differ, as many as it says, even when the window changes its size on the way;
# rendered beside the window, whose title tells how far that is.
viewer_records() {
    viewer_open --size 160x90 --motion freefall --distance 8 || return 1
    xdotool key r && viewer_until 60 viewer_title_says 'recording viewer-film-01 [0-9]* of [0-9]' &&
        viewer_until 60 test -e "$viewer_folder/viewer-film-01/frame-000004.png" &&
        xdotool windowsize "$viewer_window" 200 100 &&
        viewer_until 60 test -e "$viewer_folder/viewer-film-01/frame-000008.png" &&
        xdotool key r && viewer_until 60 viewer_says '^recording ends: ' && viewer_until 300 viewer_says '^recorded' &&
        viewer_until 10 viewer_title_says 'saved viewer-film-01' && viewer_close || return 1
    local files=("$viewer_folder"/viewer-film-01/frame-*.png)
    viewer_says "^recording ends: ${#files[@]} frames" &&
        viewer_says "^recorded ${#files[@]} frames in viewer-film-01" &&
        [ "$(identify -format '%wx%h\n' "${files[@]}" | sort -u)" = 160x90 ] &&
        ! viewer_equal "${files[0]}" "${files[6]}"
}

# R a third time breaks the film off; what is saved stays, and it says how much.
viewer_breaks_films_off() {
    viewer_open --backend cpu --size 320x180 --scene "$root/examples-c/scenes/soft-disk.toml" || return 1
    xdotool key r && viewer_until 120 viewer_title_says 'recording viewer-film-01 [0-9]* of [2-9]' && xdotool key r &&
        viewer_until 60 viewer_title_says 'film viewer-film-01 [0-9]* of' && xdotool key r &&
        viewer_until 60 viewer_says '^recorded [0-9]* frames in viewer-film-01, of [0-9]*: broken off' || return 1
    local count
    count=$(find "$viewer_folder/viewer-film-01" -name 'frame-*.png' | wc -l)
    viewer_says "^recorded $count frames" && viewer_close
}

# viewer_rounded FILE: a scene file with its numbers to eight digits behind the point: each frame makes the camera's
# axes stand on each other, which may change their last digits.
viewer_rounded() {
    awk '{ line = ""; count = split($0, part, /[][, ]+/)
        for (i = 1; i <= count; i++) {
            text = part[i] ~ /^-?[0-9]/ ? sprintf("%.8f", part[i]) : part[i]
            line = line " " (text == "-0.00000000" ? "0.00000000" : text)
        }
        print line }' "$1"
}

# F5 and F9: the camera and every setting come back from the file, whatever was changed in between; --scene begins
# there.
viewer_keeps_scenes() {
    viewer_open --size 160x90 && xdotool key space Right bracketleft v u j k 3 Up g b || return 1
    viewer_until 60 viewer_says 'samples a pixel' && xdotool click 4 &&
        viewer_until 60 viewer_title_says 'r 2[12].* M' && viewer_until 60 viewer_title_says 'at rest' || return 1
    xdotool key F5 && viewer_until 60 viewer_says 'scene saved: viewer-scene.toml' || return 1
    cp -- "$viewer_folder/viewer-scene.toml" "$scratch/kept.toml" || return 1
    xdotool key Right Right bracketright v u j k 3 Down g B m x 1 p && xdotool click 5 click 5 &&
        viewer_until 60 viewer_says 'mass 1.1' && viewer_until 60 viewer_title_says 'a +0.300' || return 1
    xdotool key F9 && viewer_until 60 viewer_says 'scene loaded: viewer-scene.toml$' &&
        viewer_until 60 viewer_title_says 'M 1 .* a +0.100' && rm -- "$viewer_folder/viewer-scene.toml" &&
        xdotool key F5 && viewer_until 60 test -s "$viewer_folder/viewer-scene.toml" && viewer_close || return 1
    diff <(viewer_rounded "$scratch/kept.toml") <(viewer_rounded "$viewer_folder/viewer-scene.toml") || return 1
    viewer_open --size 160x90 --scene "$scratch/kept.toml" && viewer_until 60 viewer_title_says 'r 2[12].* M' &&
        viewer_title_says 'a +0.100' || return 1
    echo 'spin = 3' >>"$scratch/kept.toml" && xdotool key F9 &&
        viewer_until 60 viewer_says 'cannot load the scene.*line' && viewer_close
}

# A scene's file and nothing else: what the gallery renders of it; options of a scene, and files that are none, are
# refused.
viewer_shows_a_file() {
    local file=$root/examples-c/scenes/grid.toml
    "$viewer" --backend cpu --size 96x54 --scene "$file" --frames 1 --screenshot "$scratch/viewer-grid.png" &&
        "$examples/gallery" --backend cpu --width 96 --only grid --output "$scratch" &&
        viewer_equal "$scratch/viewer-grid.png" "$scratch/grid.png" || return 1
    viewer_refuses 2 'the file says all' --scene "$file" --spin 0.5 &&
        viewer_refuses 1 'absent.toml' --scene absent.toml &&
        viewer_refuses 1 'key with no value' --scene "$root/tests/run"
}

# viewer_refuses STATUS WORDS OPTIONS...
viewer_refuses() {
    local expected=$1 words=$2 status=0
    shift 2
    "$viewer" --size 16x9 --frames 1 "$@" 2>"$scratch/viewer-errors" || status=$?
    cat -- "$scratch/viewer-errors"
    [ "$status" -eq "$expected" ] && grep -q -e "$words" "$scratch/viewer-errors"
}
