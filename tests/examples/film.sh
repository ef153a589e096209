# SPDX-License-Identifier: MIT OR Apache-2.0
# film.sh -- tests of what examples-c/film leaves behind: after Ctrl-C, SIGTERM and SIGKILL, in folders that hold a film
# already, as .exr files; and of its progress. Functions only, each one a test for `check` or a helper of them. Needs
# tests/lib.sh's $scratch, $examples (the folder of the programs), tests/examples/run's `picture`, `bytes` and `exits`,
# ImageMagick, ffmpeg and ffprobe.
# shellcheck shell=bash disable=SC2154

# until_in FILE COUNT WORD PID: waits until the file holds the word so often. Fails when the process ends before.
until_in() {
    until [ "$(grep -aoshe "$3" -- "$1" | wc -l)" -ge "$2" ]; do
        kill -0 "$4" 2>/dev/null || { echo "it ended before $1 had $2 $3" && return 1; }
        sleep 0.02
    done
}

# frames_in VIDEO: how many can be decoded.
frames_in() {
    ffprobe -v error -count_frames -select_streams v -show_entries stream=nb_read_frames -of csv=p=0 "$1"
}

# long_film FILE: a scene of 400 small pictures, four a second, so that a video has a keyframe every four.
long_film() {
    printf '%s\n' 'camera.fov_y = { keys = [[0, 1.0], [100, 0.5]] }' '[render]' 'width = 64' 'height = 36' \
        'duration = 100' 'frames_per_second = 4' >"$1"
}

# noting_ffmpeg: puts an ffmpeg into $scratch/noting that notes its process in $scratch/ffmpeg.pid.
noting_ffmpeg() {
    mkdir -p -- "$scratch/noting" && rm -f -- "$scratch/ffmpeg.pid" &&
        printf '#!/bin/sh\necho $$ >%q\nexec %q "$@"\n' "$scratch/ffmpeg.pid" "$(command -v ffmpeg)" \
            >"$scratch/noting/ffmpeg" && chmod +x "$scratch/noting/ffmpeg"
}

# breaks_off FILE WORD COMMAND...: Ctrl-C ends the command once the file holds the word. Shells start what runs in the
# background without SIGINT.
breaks_off() {
    local file=$1 word=$2 pid status=0
    shift 2
    rm -f -- "$scratch/said"
    env --default-signal=INT "$@" 2>"$scratch/said" &
    pid=$!
    until_in "$file" 1 "$word" "$pid" && kill -INT "$pid" || return 1
    wait "$pid" || status=$?
    cat -- "$scratch/said"
    [ "$status" -eq 130 ]
}

# film_goes_on SIGNAL STATUS: pictures that were broken off are whole, and --continue makes the rest, after which all
# are those of a film that was not disturbed. Shells start what runs in the background without SIGINT.
film_goes_on() {
    local whole=$scratch/film-whole folder=$scratch/film-broken-$1 pid status=0 count first file
    local command=("$examples/film" --backend cpu --frames 24 --size 64x36)
    [ -d "$whole" ] || "${command[@]}" --output "$whole" || return 1
    env --default-signal=INT "${command[@]}" --output "$folder" 2>"$scratch/said" &
    pid=$!
    until [ -e "$folder/frame-00002.png" ]; do
        kill -0 "$pid" 2>/dev/null || { cat -- "$scratch/said" && return 1; }
        sleep 0.02
    done
    kill "-$1" "$pid"
    wait "$pid" || status=$?
    cat -- "$scratch/said"
    count=$(find "$folder" -name 'frame-*.png' | wc -l)
    [ "$status" -eq "$2" ] && [ "$count" -lt 24 ] && [ "$(find "$folder" -type f | wc -l)" -eq $((count + 1)) ] &&
        grep -q "$folder has $count of 24 frames, .* --continue" "$scratch/said" || return 1
    for file in "$folder"/frame-*.png; do
        cmp "$file" "$whole/${file##*/}" || return 1
    done
    rm -- "$folder/frame-00001.png" && first=$(stat -c %i "$folder/frame-00000.png") &&
        "${command[@]}" --output "$folder" --continue >"$scratch/said" && cat "$scratch/said" &&
        grep -q "^24 frames, $((25 - count)) of them new: $folder, .* a second\$" "$scratch/said" &&
        diff -r "$whole" "$folder" && [ "$(stat -c %i "$folder/frame-00000.png")" = "$first" ] &&
        "${command[@]}" --output "$folder" --continue | grep -xF "24 frames, 0 of them new: $folder"
}

# A terminal sends Ctrl-C to all processes of a group: ffmpeg still finishes the video, which holds every frame that the
# message counts. A second Ctrl-C ends the program even where ffmpeg hangs.
film_into_a_video_is_interrupted() {
    local video=$scratch/interrupted.mp4 scene=$scratch/long.toml pid status=0
    long_film "$scene" || return 1
    setsid env --default-signal=INT "$examples/film" --backend cpu --scene "$scene" --video "$video" \
        2>"$scratch/said" &
    pid=$!
    until_in "$video" 1 moof "$pid" && kill -INT -- "-$pid" || return 1
    wait "$pid" || status=$?
    cat -- "$scratch/said"
    [ "$status" -eq 130 ] && grep -q "has $(frames_in "$video") of 400 frames.*--continue" "$scratch/said" &&
        [ "$(frames_in "$video")" -ge 4 ] || return 1
    mkdir -p -- "$scratch/hanging" && rm -f -- "$scratch/ffmpeg.pid" &&
        printf '#!/bin/sh\necho $$ >%q\nexec sleep 300\n' "$scratch/ffmpeg.pid" >"$scratch/hanging/ffmpeg" &&
        chmod +x "$scratch/hanging/ffmpeg" || return 1
    PATH=$scratch/hanging:$PATH env --default-signal=INT "$examples/film" --backend cpu --scene "$scene" \
        --video "$video" 2>"$scratch/said" &
    pid=$! status=0
    until_in "$scratch/ffmpeg.pid" 1 . "$pid" && kill -INT "$pid" && sleep 0.5 && kill -INT "$pid" || status=1
    wait "$pid" || status=$?
    kill "$(cat "$scratch/ffmpeg.pid")"
    [ "$status" -eq 130 ] && ! grep stopped "$scratch/said"
}

# After SIGKILL, also of ffmpeg, the video on the disk plays, but for its end.
film_into_a_video_is_killed() {
    local video=$scratch/killed.mp4 scene=$scratch/long.toml pid frames
    long_film "$scene" && noting_ffmpeg || return 1
    PATH=$scratch/noting:$PATH "$examples/film" --backend cpu --scene "$scene" --video "$video" &
    pid=$!
    until_in "$video" 2 moof "$pid" && kill -KILL "$pid" "$(cat "$scratch/ffmpeg.pid")" || return 1
    ! wait "$pid" || return 1
    frames=$(frames_in "$video") && echo "$frames frames" && [ "$frames" -ge 4 ] && [ "$frames" -lt 400 ]
}

# No pictures of two films lie side by side.
film_in_a_folder_of_another() {
    local folder=$scratch/film-folder said=$scratch/said
    local command=("$examples/film" --backend cpu --size 32x18)
    mkdir -p -- "$folder/foreign" "$folder/text" && : >"$folder/foreign/frame-00007.png" &&
        echo mine >"$folder/text/film.txt" || return 1
    exits 1 'frame-00007.png is there, and no film.txt' "${command[@]}" --frames 3 --output "$folder/foreign" &&
        exits 1 'no film.txt' "${command[@]}" --frames 3 --output "$folder/foreign" --continue &&
        [ "$(ls "$folder/foreign")" = frame-00007.png ] &&
        exits 1 'film.txt is not of this program' "${command[@]}" --frames 3 --output "$folder/text" &&
        [ "$(cat "$folder/text/film.txt")" = mine ] || return 1
    # --continue names the first difference, and touches nothing; a folder without a film gets one.
    "${command[@]}" --frames 5 --output "$folder/a" --continue && cp -a -- "$folder/a" "$folder/kept" || return 1
    exits 1 "'frames = 5' where this one has 'frames = 3'" "${command[@]}" --frames 3 --output "$folder/a" --continue &&
        exits 1 "'size = 32x18' where this one has 'size = 16x9'" "$examples/film" --backend cpu --frames 5 \
            --size 16x9 --output "$folder/a" --continue &&
        exits 1 "'# A fall into a hole without spin.*' where this one has '# A fall into a hole of spin 0.9" \
            "${command[@]}" --frames 5 --output "$folder/a" --scene "$root/examples-c/scenes/fall-kerr.toml" \
            --continue &&
        exits 1 "'format = png' where this one has 'format = exr'" "${command[@]}" --frames 5 --format exr \
            --output "$folder/a" --continue &&
        diff -r "$folder/a" "$folder/kept" || return 1
    # Without --continue the other film's pictures are removed, but unknown pictures are an error before that.
    : >"$folder/a/frame-00005.png" &&
        exits 1 'frame-00005.png is there' "${command[@]}" --frames 2 --output "$folder/a" &&
        rm -- "$folder/a/frame-00005.png" && diff -r "$folder/a" "$folder/kept" &&
        "${command[@]}" --frames 2 --output "$folder/a" 2>"$said" && grep -q 'its 5 pictures are removed' "$said" &&
        [ "$(ls "$folder/a" | tr '\n' ' ')" = 'film.txt frame-00000.png frame-00001.png ' ] || return 1
    # An exposure that follows the frames before it cannot begin in the middle.
    printf '%s\n' 'film.auto_exposure = 1' 'film.auto_adaptation = 0.1' '[render]' 'duration = 1' \
        'frames_per_second = 4' >"$folder/adapts.toml"
    "${command[@]}" --scene "$folder/adapts.toml" --output "$folder/adapts" && rm "$folder/adapts/frame-00002.png" &&
        exits 1 'auto_adaptation' "${command[@]}" --scene "$folder/adapts.toml" --output "$folder/adapts" --continue &&
        exits 2 'bhr render' "${command[@]}" --continue --video "$folder/no.mp4"
}

# film.txt does not know what a map holds: without --continue the film's own pictures go, too, so that a film of another
# map, broken off, is not taken for one with the pictures of the map before.
film_begins_anew() {
    local folder=$scratch/film-anew scene=$scratch/long.toml count
    local command=("$examples/film" --backend cpu --scene "$scene" --output "$folder")
    long_film "$scene" && breaks_off "$folder/frame-00002.png" PNG "${command[@]}" && ! grep removed "$scratch/said" &&
        : >"$folder/frame-00399.png" && count=$(find "$folder" -name 'frame-*.png' | wc -l) &&
        breaks_off "$scratch/said" "this film: its $count pictures are removed" "${command[@]}" &&
        [ ! -e "$folder/frame-00399.png" ] && count=$(find "$folder" -name 'frame-*.png' | wc -l) &&
        grep "has $count of 400 frames" "$scratch/said"
}

# A film that cannot be made takes no other one's place: one whose view is not light as .exr files, be it at the end,
# and one whose first frame fails.
film_that_fails_removes_nothing() {
    local folder=$scratch/film-fails
    local command=("$examples/film" --backend cpu --size 32x18 --output "$folder")
    "${command[@]}" --frames 3 && cp -a -- "$folder" "$folder-kept" || return 1
    printf '%s\n' 'view = { keys = [[0, "light"], [1, "redshift"]] }' '[render]' 'duration = 2' \
        'frames_per_second = 2' >"$scratch/view.toml" && echo 'camera.projection = "cube"' >"$scratch/cube.toml" ||
        return 1
    exits 2 'redshift at 1 seconds.*exr' "${command[@]}" --scene "$scratch/view.toml" --format exr &&
        grep -q 'false colour; view = "light"' "$scratch/said" &&
        exits 1 'CUBE' "${command[@]}" --scene "$scratch/cube.toml" && diff -r "$folder" "$folder-kept" &&
        exits 1 'CUBE' "${command[@]}" --scene "$scratch/cube.toml" --output "$folder-none" &&
        [ ! -e "$folder-none" ]
}

# film.txt is the same wherever film is started, and whatever bytes the path of a LUT has.
film_goes_on_from_elsewhere() {
    local folder=$scratch/$'film-\xe4'
    mkdir -p -- "$folder/below" && cd -- "$folder" || return 1
    printf '%s\n' 'LUT_3D_SIZE 2' '0 0 0' '1 0 0' '0 1 0' '1 1 0' '0 0 1' '1 0 1' '0 1 1' '1 1 1' >look.cube &&
        printf '%s\n' 'film.lut = "look.cube"' '[render]' 'duration = 1' 'frames_per_second = 4' >look.toml || return 1
    local command=("$examples/film" --backend cpu --size 32x18)
    "${command[@]}" --scene look.toml --output film && rm film/frame-00002.png && cd below &&
        "${command[@]}" --scene ../look.toml --output ../film --continue | grep '^4 frames, 1 of them new'
}

# A signal while the last frame is written comes too late: ffmpeg sends it when it has read a part of that.
film_is_done_before_the_signal() {
    mkdir -p -- "$scratch/signals" || return 1
    printf '#!/bin/sh\nhead -c 100000 >/dev/null; kill -INT $PPID; sleep 0.2; cat >/dev/null\n' \
        >"$scratch/signals/ffmpeg" && chmod +x "$scratch/signals/ffmpeg" &&
        PATH=$scratch/signals:$PATH env --default-signal=INT "$examples/film" --backend cpu --frames 1 \
            --size 320x180 --video "$scratch/no.mp4" | grep '^1 frames: '
}

# Linear light, which has more than 8 bits; false colour has 8 alone.
film_as_exr() {
    local folder=$scratch/film-exr
    local command=("$examples/film" --backend cpu --frames 2 --size 64x36 --format exr)
    "${command[@]}" --output "$folder" || return 1
    [ "$(bytes "$folder/frame-00001.exr" 0 4)" = 762f3101 ] &&
        [ "$(ffprobe -v error -show_entries stream=codec_name,width,height -of csv=p=0 "$folder/frame-00001.exr")" = \
            exr,64,36 ] &&
        ffmpeg -v error -y -i "$folder/frame-00001.exr" -f rawvideo -pix_fmt gbrpf32le "$scratch/light" &&
        [ "$(od -An -v -tx4 -w4 "$scratch/light" | sort -u | wc -l)" -gt 1000 ] || return 1
    exits 2 'exr hold light alone' "${command[@]}" --clock --output "$folder" &&
        exits 2 '8 bits' "${command[@]}" --video "$scratch/no.mp4" &&
        exits 2 'png|exr' "$examples/film" --format jpg
}

# On a terminal there is a line of progress; else stderr stays empty. An ffmpeg that begins to read late makes the film
# last long enough for the line.
film_shows_progress() {
    local scene=$scratch/long.toml said=$scratch/said
    mkdir -p -- "$scratch/late" && printf '#!/bin/sh\nsleep 1; cat >/dev/null\n' >"$scratch/late/ffmpeg" &&
        chmod +x "$scratch/late/ffmpeg" && long_film "$scene" || return 1
    printf 'PATH=%q:$PATH %q --backend cpu --scene %q --frames 24 --video %q\n' "$scratch/late" "$examples/film" \
        "$scene" "$scratch/no.mp4" >"$scratch/command" || return 1
    script -qec "bash $(printf %q "$scratch/command")" /dev/null >"$said" && tr '\r' '\n' <"$said" | tee "$said.lines"
    grep -qE '^\[#*\.*\] [0-9]+ of 24 frames, [0-9.]+ a second, 0:[0-9][0-9] left *$' "$said.lines" &&
        bash "$scratch/command" 2>"$said" && [ ! -s "$said" ]
}
