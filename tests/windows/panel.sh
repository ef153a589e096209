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
    trap panel_gone EXIT
    panel_says 1 '^frames ' "$panel_start"
}

# panel_gone: a test that fails, however it does, leaves no window that hides the next test's.
panel_gone() { kill "$panel_pid" 2>/dev/null && wait "$panel_pid"; }

# Puts the window of a program that stays open into $panel_window. --all: of this program, not of any other panel.
panel_find() {
    read -r panel_window < <(xdotool search --all --pid "$panel_pid" --name 'bhr: panel')
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

# panel_widget SECTION/LABEL: where the window shows it, two numbers.
panel_widget() {
    awk -v name="$1" '/^widget / { place = $2 " " $3; sub(/^widget [0-9-]+ [0-9-]+ /, "")
        if ($0 == name) found = place }
        END { if (found == "") exit 1; print found }' "$panel_log" || panel_complain "no widget '$1' is seen"
}

# panel_places: of the window as it was drawn last.
panel_places() {
    awk '/^places$/ { text = ""; in_places = 1; next }
        /^(section|widget) / { if (in_places) text = text $0 "\n"; next }
        { in_places = 0 }
        END { printf "%s", text }' "$panel_log"
}

# panel_click_on SECTION/LABEL
panel_click_on() {
    local x y
    read -r x y < <(panel_widget "$1") && [ -n "$y" ] && panel_press "$x" "$y"
}

# panel_set SECTION/LABEL TEXT PATTERN: as panel_type_into.
panel_set() {
    local x y
    read -r x y < <(panel_widget "$1") && [ -n "$y" ] && panel_type_into "$x" "$y" "$2" "$3"
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

    panel_set 'Hole/spin a / M' 0.25 ' spin 0.25 ' || return 1
    panel_set 'Matter with depth/volumes' 2 '^matter volumes 2 hot spots 0$' || return 1
    panel_set 'Matter with depth/hot spots' 1 '^matter volumes 2 hot spots 1$' || return 1
    # A refusal is written below its slider, and moves all that follows.
    panel_set 'Hole/spin a / M' 1.5 '^refused .*1\.5.*\[-1, 1\]' || return 1
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
    panel_set 'Hole/spin a / M' 0.25 "$spin 0.25 " && panel_press 140 30 && panel_says 1 '^file saved panel.toml$' &&
        cp -- panel.toml first.toml || return 1
    panel_set 'Hole/spin a / M' 0.5 "$spin 0.5 " && panel_point "${away%,*}" "${away#*,}" && xdotool click 4 &&
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

# panel_fits WIDTH HEIGHT: nothing of the window as it was drawn last is outside it, or hidden without a scroll bar; the
# windows and the picture do not overlap, and the picture is at least a third of the window.
panel_fits() {
    local places=$scratch/panel-places
    panel_places >"$places"
    panel_last '^picture ' >>"$places"
    awk -v width="$1" -v height="$2" '
        function fail(why) { print why ": " $0; failed = 1 }
        $1 == "section" {
            name = $0
            sub(/.* bar [01] /, "", name)
            if ($2 < 0 || $3 < 0 || $2 + $4 > width || $3 + $5 > height) fail("beyond the window")
            if ($7 > 0) fail("cut off at the side")
            if ($8 > 0 && $10 != 1) fail("hidden without a scroll bar")
            scrolling += $8 > 0
            if (name !~ /^Settings, /) { place[++count] = $2 " " $3 " " $4 " " $5 " " name }
        }
        $1 == "picture" {
            if ($4 * $5 < width * height / 3) fail("too small")
            place[++count] = $2 " " $3 " " $4 " " $5 " picture"
        }
        END {
            for (i = 1; i <= count; i++) for (j = i + 1; j <= count; j++) {
                split(place[i], a, " "); split(place[j], b, " ")
                if ((a[5] "" b[5]) ~ /Instruments/ && (a[5] "" b[5]) !~ /Scene|picture/) continue # its own parts
                if (a[1] < b[1] + b[3] && b[1] < a[1] + a[3] && a[2] < b[2] + b[4] && b[2] < a[2] + a[4]) {
                    print "overlap: " place[i] ", " place[j]; failed = 1
                }
            }
            print count " places, " scrolling " of them scroll"
            exit failed || count < 4
        }' "$places"
}

# At every usual size of a screen each tab of the settings, and each of the instruments, has all of its content in the
# window or behind a scroll bar. The film has a widget for every field of BhrFilm.
panel_fits_screens() {
    local size tab instrument fields names
    for size in 1280x720 1280x800 1920x1080; do
        panel_open --size "$size" --paused --backend cpu --preset cinematic && panel_find || return 1
        for tab in Scene Film Effects Frames; do
            panel_click_on "tabs/$tab" && panel_says 1 "^section .* Settings, $tab\$" && sleep 1 &&
                panel_fits "${size%x*}" "${size#*x}" || panel_complain "$size, $tab" || return 1
        done
        for instrument in $([ "$size" = 1920x1080 ] || echo g_tt Steps Performance Ray); do
            panel_click_on "instruments/$instrument" && sleep 1 && panel_fits "${size%x*}" "${size#*x}" ||
                panel_complain "$size, $instrument" || return 1
        done
        if [ "$size" = 1280x720 ]; then
            panel_click_on tabs/Film && sleep 1 &&
                panel_set 'Exposure/auto exposure' 1 '^light .* auto -?[0-9]*\.[0-9]*[1-9]' && sleep 1 &&
                panel_fits 1280 720 && panel_point 40 500 || return 1
            for _ in 1 2 3 4 5 6 7 8; do
                xdotool click 5 && sleep 0.3
            done
            fields=$(awk '/FILM_FIELDS/ { inside = 1 } inside && /"--/ { count++ } /QUALITY_FIELDS/ { exit }
                END { print count }' "$root/examples-c/fields.c")
            names=$(grep -E '^widget [0-9]+ [0-9]+ (Exposure|High.*|Curve|Grade|Lens|Grain|LUT.*|More)/' "$panel_log" |
                cut -d ' ' -f 4- | sort -u | grep -cv 'LUT file')
            panel_expect "$names fields of film" "$fields fields of film" || return 1
        fi
        panel_close $((${size%x*} / 2)) 200 || return 1
    done
}

# panel_mean FILE COLUMNS: the mean of the columns WIDTHxHEIGHT+X+Y of a picture, 0 to 255.
panel_mean() { convert "$1" -crop "$2" -colorspace Gray -format '%[fx:255*mean]' info:; }

# panel_shows FILE CONDITION...: takes pictures of a window of 1280 x 720 until the condition holds of FILE, with the
# mouse in its last corner, where no tooltip follows: one beside a slider hides a part of the picture, and when it does
# depends on how fast frames come.
panel_shows() {
    local end=$((SECONDS + panel_action)) file=$1
    shift
    panel_point 1275 715 || return 1
    until sleep 0.5 && import -window "$panel_window" "$file" && "$@"; do
        if [ "$SECONDS" -ge "$end" ] || ! kill -0 "$panel_pid" 2>/dev/null; then
            panel_complain "the window does not show it: $*"
            return 1
        fi
    done
}

# panel_rests FILE: twice the same.
panel_rests() {
    cp -- "$1" "$1.first" && sleep 1 && import -window "$panel_window" "$1" &&
        [ "$(compare -metric AE "$1.first" "$1" null: 2>&1)" = 0 ]
}

# panel_equal_means FILE COLUMNS MEAN
panel_equal_means() {
    awk -v a="$3" -v b="$(panel_mean "$1" "$2")" \
        'BEGIN { print "left of the line " a ", then " b; exit !(a - b < 0.1 && b - a < 0.1) }'
}

# panel_brighter_than FILE OTHER COLUMNS: these columns are more than half as bright again as in the other picture.
panel_brighter_than() {
    awk -v a="$(panel_mean "$1" "$3")" -v b="$(panel_mean "$2" "$3")" \
        'BEGIN { print a " against " b; exit !(a > 1.5 * b) }'
}

# panel_differs_in FILE OTHER COLUMNS SAME: COLUMNS are brighter than in the other picture, and SAME as bright.
panel_differs_in() {
    panel_brighter_than "$1" "$2" "$3" && panel_equal_means "$1" "$4" "$(panel_mean "$2" "$4")"
}

# A setting is kept as A: the left of the picture goes on to show it while B changes on the right; the line between them
# follows the mouse; and A and B change places.
panel_compares() {
    local left top width height before=$scratch/wipe-0.png beside=$scratch/wipe-1.png swapped=$scratch/wipe-2.png
    local left_half right_half left_of_line
    panel_open --size 1280x720 --paused --backend cpu && panel_find || return 1
    read -r _ left top width height <<<"$(panel_last '^picture ')"
    # Below the line that counts frames.
    top=$((top + 30)) height=$((height - 30))
    left_half=$((width / 2 - 40))x$height+$left+$top
    right_half=$((width / 2 - 40))x$height+$((left + width / 2 + 40))+$top
    left_of_line=$((width / 4 - 40))x$height+$left+$top
    panel_click_on tabs/Film && sleep 1 && panel_shows "$before" panel_rests "$before" || return 1
    panel_click_on 'A and B/keep as A' && panel_says 1 '^compared 1$' &&
        panel_set Exposure/exposure 3 '^frames [2-9]' &&
        panel_shows "$beside" panel_differs_in "$beside" "$before" "$right_half" "$left_half" || return 1
    # Dragging the line moves nothing else.
    panel_point $((left + width / 2)) $((top + 300)) && xdotool mousedown 1 && sleep 0.3 &&
        panel_point $((left + width / 3)) $((top + 320)) && panel_point $((left + width / 4)) $((top + 320)) &&
        xdotool mouseup 1 && panel_says 1 '^wipe 0\.2[45]' || return 1
    panel_expect "$(grep -c '^scene ' "$panel_log")" 1 || return 1
    panel_click_on 'A and B/swap' && panel_says 1 '^compared [2-9]' &&
        panel_shows "$swapped" panel_brighter_than "$swapped" "$before" "$left_of_line" &&
        panel_close $((left + 100)) 200
}

# panel_red_to_blue FILE LEFT RIGHT: mean colours of two parts.
panel_red_to_blue() {
    local part means=()
    for part in "$2" "$3"; do
        means+=("$(convert "$1" -crop "$part" +repage -format '%[fx:255*(mean.r-mean.b)]' info:)")
    done
    awk -v left="${means[0]}" -v right="${means[1]}" \
        'BEGIN { print "red over blue: " left ", " right; exit !(left > 5 && right < -10) }'
}

# panel_colours FILE PART: how many it has.
panel_colours() { convert "$1" -crop "$2" +repage -format '%k' info:; }

# panel_only_left FILE LEFT RIGHT: one part has colours, and the other is empty.
panel_only_left() { [ "$(panel_colours "$1" "$2")" -gt 50 ] && [ "$(panel_colours "$1" "$3")" -eq 1 ]; }

# False colours are explained beneath the picture, which makes room for that: red to blue for the frequency's ratio.
# Where A has them and B has not, A's half alone is explained.
panel_explains_colours() {
    local folder=$scratch/panel-colours shot=$scratch/panel-colours.png g='frequency ratio g = seen / sent'
    local left top width height whole foot
    mkdir -p -- "$folder" && cd -- "$folder" && echo 'view = "redshift"' >panel.toml &&
        panel_open --size 1280x720 --paused --backend cpu && panel_find || return 1
    read -r _ _ _ _ whole <<<"$(panel_last '^picture ')"
    panel_press 188 30 && panel_says 1 "^colours none [|] $g\$" || return 1
    read -r _ left top width height <<<"$(panel_last '^picture ')"
    foot=$((whole - height))
    [ "$foot" -ge 40 ] && [ "$foot" -le 70 ] || panel_complain "the bar has $foot pixels" || return 1
    # Half of the foot, in its middle, is the bar and the text beside it.
    top=$((top + height + foot / 4)) height=$((foot / 2))
    panel_shows "$shot" panel_red_to_blue "$shot" $((width / 6))x$height+$((left + 30))+$top \
        $((width / 6))x$height+$((left + width - width / 6 - 30))+$top || return 1
    panel_click_on 'A and B/keep as A' && panel_says 1 "^colours $g [|] $g\$" && : >panel.toml &&
        panel_press 188 30 && panel_says 1 "^colours $g [|] none\$" &&
        panel_shows "$shot" panel_only_left "$shot" $((width / 2 - 20))x$height+$left+$top \
            $((width / 2 - 20))x$height+$((left + width / 2 + 10))+$top && panel_close $((left + 100)) 200
}

# The share of bright pixels beside the exposure is that of the picture, as another program counts it.
panel_counts_light() {
    local said counted
    panel_open --size 1280x720 --paused --backend cpu --hold 12 --picture "$scratch/panel-light.png" && panel_find &&
        panel_click_on tabs/Film && panel_says 1 '^light above 235: ' && panel_ends || return 1
    said=$(panel_last '^light ' | cut -d ' ' -f 4)
    # Luma of encoded values, rounded: above 235 is from 235.5 on.
    counted=$(convert "$scratch/panel-light.png" -set colorspace RGB -alpha off \
        -color-matrix '0.2126 0.7152 0.0722 0.2126 0.7152 0.0722 0.2126 0.7152 0.0722' -threshold 92.353% \
        -format '%[fx:mean]' info:)
    awk -v said="$said" -v counted="$counted" 'BEGIN { print "said " said ", counted " counted
        exit !(counted > 0.01 && said - counted < 0.003 && counted - said < 0.003) }'
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
