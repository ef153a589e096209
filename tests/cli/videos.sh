# SPDX-License-Identifier: MIT OR Apache-2.0
# videos.sh -- the tests of videos that `bhr render` makes through ffmpeg. Sourced by tests/cli/run, whose $scratch,
# $bhr and functions it uses.
# shellcheck shell=bash

# Three seconds in pieces of 16 frames, the last one longer.
video_frames=72
sed "s/^duration = .*/duration = 3/; s/^width = .*/width = 32/; s/^height = .*/height = 32/" "$scratch/dome.toml" \
    >"$scratch/video.toml"

video() {
    timeout 300 "$bhr" render "$scratch/video.toml" --backend cpu --progress plain --keyframes 16 "$@"
}

# frames_in FILE: the frames that a player finds.
frames_in() {
    ffprobe -v error -count_frames -select_streams v:0 -show_entries stream=nb_read_frames -of csv=p=0 "$1"
}

# The folder has the video of an undisturbed run, its manifest, and nothing else.
only_the_video() {
    local names
    names=$(cd -- "$1" && find . -type f | sort | tr '\n' ' ')
    [ "$names" = "./v.manifest.jsonl ./v.mp4 " ] || { echo "$names" && return 1; }
    cmp "$1/v.mp4" "$scratch/video/v.mp4" && [ "$(frames_in "$1/v.mp4")" -eq "$video_frames" ]
}

a_video() {
    video --out "$scratch/video/v.mp4" >"$scratch/said" &&
        [ "$(grep -c 'v.mp4' "$scratch/said")" -eq "$video_frames" ] &&
        only_the_video "$scratch/video" && video --out "$scratch/video/v.mp4" >"$scratch/said" &&
        [ "$(grep -c 'was there' "$scratch/said")" -eq "$video_frames" ]
}

# Its frames are those of pictures, but for what the codec loses: 38 dB is a faint loss.
as_pictures() {
    local frame=37 found
    timeout 300 "$bhr" render "$scratch/video.toml" --backend cpu --out "$scratch/video.png" --frames "$frame" \
        >/dev/null &&
        ffmpeg -v error -y -i "$scratch/video/v.mp4" -vf "select=eq(n\\,$frame),scale=in_color_matrix=bt709" \
            -vframes 1 "$scratch/video.frame.png" || return 1
    found=$(compare -metric PSNR "$scratch/video.png" "$scratch/video.frame.png" null: 2>&1)
    echo "PSNR $found"
    python3 -c 'import sys; sys.exit(not float(sys.argv[1]) > 38)' "${found%% *}"
}

# Killed at any moment, its processes as well where a farm does so: all that was noted plays, and in the end the video
# is the one of an undisturbed run.
killed_videos() {
    local folder=$scratch/killed-video i pid noted found seen=0 runs=30
    for ((i = 0; i < runs; i++)); do
        "$bhr" render "$scratch/video.toml" --backend cpu --progress none --keyframes 16 --out "$folder/v.mp4" &
        pid=$!
        if [ "$i" -eq 0 ]; then
            until grep -qsE '"frames":[1-9]' "$folder/v.manifest.jsonl" || ! kill -0 "$pid"; do
                sleep 0.02
            done
        else
            sleep "$((i % 2)).$((RANDOM % 9))"
        fi
        kill -KILL "$pid" 2>/dev/null
        wait "$pid" 2>/dev/null
        [ ! -e "$folder/v.mp4" ] || break
        [ $((i % 3)) -ne 2 ] || pkill -KILL -f "file:$folder"
        noted=$(python3 -c 'import json, sys
lines = [json.loads(line) for line in sys.stdin if line.endswith("}\n")]
print(max([0] + [line.get("frames", 0) for line in lines]))' <"$folder/v.manifest.jsonl" 2>/dev/null || echo 0)
        [ "$noted" -gt 0 ] || continue
        found=$(frames_in "$folder/v.part.mp4" 2>/dev/null)
        echo "noted $noted, found $found"
        [ "$found" -ge "$noted" ] || return 1
        seen=$((seen + 1))
    done
    [ "$seen" -ge 1 ] || return 1
    video --out "$folder/v.mp4" --continue >"$scratch/said" && only_the_video "$folder"
}

interrupted_video() {
    local folder=$scratch/interrupted-video found=0 pid
    rm -rf -- "$folder"
    "$bhr" render "$scratch/video.toml" --backend cpu --progress plain --keyframes 16 --out "$folder/v.mp4" \
        >/dev/null 2>"$scratch/said" &
    pid=$!
    until grep -qsE '"frames":[1-9]' "$folder/v.manifest.jsonl"; do
        sleep 0.05
    done
    kill "-$1" "$pid"
    wait "$pid" || found=$?
    cat -- "$scratch/said"
    # A video that was done before the signal came is no failure.
    [ "$found" -eq 0 ] || { [ "$found" -eq "$2" ] && grep -q 'run it again' "$scratch/said"; } || return 1
    [ -z "$(find "$folder" -name '*.piece' -o -name '*.lock')" ] &&
        video --out "$folder/v.mp4" >"$scratch/said" && only_the_video "$folder"
}

# Frames of another film are not mixed into one that has been begun.
another_video() {
    local folder=$scratch/another-video
    mkdir -p -- "$folder" && printf 'garbage' >"$folder/v.part.mp4" || return 1
    printf '{"file":"v.part.mp4","video":"of another","frames":16,"bytes":7}\n{"fil' >"$folder/v.manifest.jsonl"
    video --out "$folder/v.mp4" >/dev/null && only_the_video "$folder" || return 1
    # Nor does a note frames_in of what is not there.
    rm -- "$folder/v.mp4"
    local video
    video=$(grep -o '"video":"[0-9a-f]*"' "$folder/v.manifest.jsonl" | tail -1)
    printf '{"file":"v.part.mp4",%s,"frames":16,"bytes":70000}\n' "$video" >>"$folder/v.manifest.jsonl"
    video --out "$folder/v.mp4" >/dev/null && only_the_video "$folder"
}

# failing PIECE: an ffmpeg that fails at the piece that begins at this frame, after the next one has been made.
failing() {
    printf '#!/bin/bash\ncase ${!#} in *-%s.piece) cat >/dev/null; sleep 2; exit 1 ;; esac\nexec ffmpeg "$@"\n' "$1" \
        >"$scratch/failing-ffmpeg"
    chmod +x "$scratch/failing-ffmpeg"
}

# A piece that fails, in the middle or at the end: no other takes its place, and the next run makes the rest.
failed_pieces() {
    local begin folder
    for begin in 16 48; do
        folder=$scratch/failed-$begin
        failing "$begin"
        status 74 video --out "$folder/v.mp4" --ffmpeg "$scratch/failing-ffmpeg" && [ ! -e "$folder/v.mp4" ] &&
            [ "$(frames_in "$folder/v.part.mp4")" -eq "$begin" ] &&
            video --out "$folder/v.mp4" >/dev/null && only_the_video "$folder" || return 1
    done
}

# Files that bhr has not made stay as they are, and no video counts as there that no manifest names.
foreign_files() {
    local folder=$scratch/foreign name
    for name in v.mp4 v.part.mp4; do
        rm -rf -- "$folder" && mkdir -- "$folder" && echo precious >"$folder/$name" &&
            status 64 video --out "$folder/v.mp4" && grep "$name" "$scratch/said" &&
            [ "$(cat -- "$folder/$name")" = precious ] && [ ! -e "$folder/v.mp4.lock" ] || return 1
    done
    rm -rf -- "$folder" && mkdir -p -- "$folder/v.mp4" && status 64 video --out "$folder/v.mp4" || return 1
    # One whose program was killed between renaming and noting it is made whole again; pieces of the dead go.
    rm -rf -- "$folder" && cp -r -- "$scratch/video" "$folder" && : >"$folder/.v.mp4.1-16.piece" &&
        printf '{"file":"v.mp4","frame":0}\n' >>"$folder/v.manifest.jsonl" && video --out "$folder/v.mp4" >/dev/null &&
        only_the_video "$folder"
}

# A 360-degree film of two eyes says so to players.
panorama() {
    sed 's/projection = .*/projection = "equirect"\neye_distance = 0.1/; s/^height = .*/height = 16/; /^fov_y/d' \
        "$scratch/video.toml" >"$scratch/panorama.toml"
    local panorama=(timeout 300 "$bhr" render "$scratch/panorama.toml" --backend cpu --progress none --frames 0-3)
    "${panorama[@]}" --stereo top-bottom --out "$scratch/panorama.mp4" &&
        ffprobe -v error -show_streams "$scratch/panorama.mp4" | tee "$scratch/said" >/dev/null &&
        grep -x 'projection=equirectangular' "$scratch/said" && grep -x 'type=top and bottom' "$scratch/said" &&
        grep -x 'height=32' "$scratch/said" || return 1
    # 180 degrees are the middle half of the panorama; the picture is that half.
    "${panorama[@]}" --codec h265 --stereo side-by-side --tile 8,0,16,16 --out "$scratch/half.mp4" &&
        ffprobe -v error -show_streams "$scratch/half.mp4" | tee "$scratch/said" >/dev/null &&
        grep -x 'projection=tiled equirectangular' "$scratch/said" && grep -x 'type=side by side' "$scratch/said" ||
        return 1
    # So it is where the scene has a region, as with one eye of that part.
    "${panorama[@]}" --codec h265 --tile 8,0,16,16 --out "$scratch/tile.mp4" || return 1
    sed 's/^\[render\]/[region]\nfull_width = 32\nfull_height = 16\nx = 8\n\n&/; s/^width = .*/width = 16/' \
        "$scratch/panorama.toml" >"$scratch/region.toml" &&
        timeout 300 "$bhr" render "$scratch/region.toml" --backend cpu --progress none --frames 0-3 \
            --out "$scratch/region.mp4" --codec h265 &&
        diff <(ffprobe -v error -show_streams "$scratch/tile.mp4" | grep bound_) \
            <(ffprobe -v error -show_streams "$scratch/region.mp4" | grep bound_) || return 1
    # The halves of a frame of both eyes are the frames of each.
    local eye
    for eye in left right; do
        sed "s/^eye_distance/eye = \"$eye\"\n&/" "$scratch/panorama.toml" >"$scratch/eye.toml"
        timeout 300 "$bhr" render "$scratch/eye.toml" --backend cpu --progress none --frames 1 \
            --out "$scratch/$eye.png" || return 1
    done
    timeout 300 "$bhr" render "$scratch/panorama.toml" --backend cpu --progress none --frames 1 --stereo top-bottom \
        --out "$scratch/both.png" &&
        timeout 300 "$bhr" render "$scratch/panorama.toml" --backend cpu --progress none --frames 1 \
            --stereo side-by-side --out "$scratch/beside.png" &&
        convert "$scratch/left.png" "$scratch/right.png" -append "$scratch/expected.png" &&
        [ "$(compare -metric AE "$scratch/both.png" "$scratch/expected.png" null: 2>&1)" = 0 ] &&
        convert "$scratch/left.png" "$scratch/right.png" +append "$scratch/expected.png" &&
        [ "$(compare -metric AE "$scratch/beside.png" "$scratch/expected.png" null: 2>&1)" = 0 ] &&
        [ "$(compare -metric AE "$scratch/left.png" "$scratch/right.png" null: 2>&1)" != 0 ]
}

codecs() {
    local of name pixels
    for of in "c.mp4 h265 yuv420p10le" "c.mov prores yuv422p10le" "c.mov h264 yuv420p" "t.mov prores4444 yuva444p"; do
        read -r name codec pixels <<<"$of"
        local more=()
        [ "$name" != t.mov ] || more=(--transparent)
        rm -f -- "$scratch/codecs/$name"
        video --out "$scratch/codecs/$name" --frames 0-1 --codec "$codec" "${more[@]}" >/dev/null &&
            [[ $(ffprobe -v error -show_entries stream=pix_fmt -of csv=p=0 "$scratch/codecs/$name") == "$pixels"* ]] &&
            [ "$(frames_in "$scratch/codecs/$name")" -eq 2 ] || return 1
    done
    # Pieces of one film agree in what they say of their frames, calm ones and those in which much moves.
    for codec in h265 av1; do
        video --out "$scratch/codecs/$codec.mp4" --frames 0-47 --size 64x64 --codec "$codec" >/dev/null &&
            [ "$(frames_in "$scratch/codecs/$codec.mp4")" -eq 48 ] || return 1
    done
    video --out "$scratch/codecs/small.mp4" --frames 0-47 --size 16x16 --codec h265 >/dev/null &&
        [ "$(frames_in "$scratch/codecs/small.mp4")" -eq 48 ]
}

# A video of high dynamic range says so, and shows the pictures, but for what the codec loses.
hdr_videos() {
    local case curve found codec
    for case in pq:smpte2084:h265.mp4 hlg:arib-std-b67:prores.mov; do
        curve=${case#*:} codec=${case##*:}
        video --out "$scratch/hdr/${case%%:*}.${codec#*.}" --codec "${codec%.*}" --hdr "${case%%:*}" --frames 0-16 \
            --size 64x64 >/dev/null || return 1
        found=$(ffprobe -v error -select_streams v:0 -of csv=p=0 -show_entries \
            stream=color_transfer,color_primaries,color_space,color_range "$scratch/hdr/${case%%:*}.${codec#*.}")
        echo "$found"
        [[ $found == tv,bt2020nc,${curve%%:*},bt2020 ]] || return 1
    done
    timeout 300 "$bhr" render "$scratch/video.toml" --backend cpu --out "$scratch/hdr.png" --frames 5 --size 64x64 \
        --hdr pq --progress none &&
        ffmpeg -v error -y -i "$scratch/hdr/pq.mp4" -vf 'select=eq(n\,5),scale=in_color_matrix=bt2020,format=rgb48be' \
            -vframes 1 "$scratch/hdr.frame.png" || return 1
    found=$(compare -metric PSNR "$scratch/hdr.png" "$scratch/hdr.frame.png" null: 2>&1)
    echo "PSNR $found"
    python3 -c 'import sys; sys.exit(not float(sys.argv[1]) > 38)' "${found%% *}" || return 1
    # The picture names its curve: cICP with Rec. 2020, PQ, RGB, the full range.
    python3 - "$scratch/hdr.png" <<'END' || return 1
import sys

picture = open(sys.argv[1], "rb").read()
place = picture.index(b"cICP")
assert picture[place + 4:place + 8] == bytes([9, 16, 0, 1]), picture[place:place + 8]
assert picture[24] == 16, "it has no 16 bits"
END
    status 64 video --out "$scratch/hdr/bad.mp4" --hdr pq --codec h264 || return 1
    status 64 video --out "$scratch/hdr/bad.mp4" --hdr 2020 || return 1
    status 64 render --out "$scratch/hdr/bad.exr" --frames 0 --hdr pq || return 1
    status 64 render --out "$scratch/hdr/bad.png" --frames 0 --hdr pq --transparent || return 1
    status 64 render --out "$scratch/hdr/bad.png" --frames 0 --hdr pq --tile 0,0,4,4
}

mistakes_of_videos() {
    local out=$scratch/mistakes/v.mp4
    status 64 video --out "$out" --codec prores || return 1
    status 64 video --out "$out" --codec vp9 || return 1
    status 64 video --out "$out" --quality 52 || return 1
    status 64 video --out "$out" --size 31x32 || return 1
    status 64 video --out "$out" --transparent || return 1
    status 64 video --out "$out" --keyframes 15 || return 1
    status 64 video --out "$out" --outputs depth || return 1
    status 64 video --out "$scratch/mistakes/v.####.mp4" || return 1
    status 64 render --out "$scratch/mistakes/v.####.png" --quality 3 || return 1
    status 64 video --out "$out" --stereo cross-eyed || return 1
    status 64 video --out "$out" --encoders 2 || return 1
    status 64 video --out "$scratch/mistakes/v.####.png" --keyframes 20 || return 1
    status 64 video --out "$scratch/mistakes/..mp4" || return 1
    status 64 video --out "$scratch/mistakes/v.part.mp4" || return 1
    status 74 video --out "$out" --dry-run --ffmpeg "$scratch/nowhere" || return 1
    # A dome has no two eyes.
    status 65 video --out "$out" --stereo top-bottom || return 1
    status 74 video --out "$out" --ffmpeg "$scratch/nowhere" && grep -q 'not found' "$scratch/said" || return 1
    status 74 video --out "$out" --ffmpeg false || return 1
    printf '#!/bin/sh\ncat >/dev/null\necho no such codec >&2\nexit 1\n' >"$scratch/bad-ffmpeg"
    chmod +x "$scratch/bad-ffmpeg"
    status 74 video --out "$out" --ffmpeg "$scratch/bad-ffmpeg" && grep -q 'no such codec' "$scratch/said" || return 1
    # One that makes fewer frames than it was given.
    printf '#!/bin/sh\nexec ffmpeg -to 0.5 "$@"\n' >"$scratch/short-ffmpeg"
    chmod +x "$scratch/short-ffmpeg"
    status 74 video --out "$out" --ffmpeg "$scratch/short-ffmpeg" || return 1
    [ ! -e "$out" ] && [ -z "$(find "$scratch/mistakes" -name '*.piece' -o -name '*.lock')" ]
}

# Layers beside the light, under the names of bhr_save_outputs.
layers() {
    local out=$scratch/layers.exr name
    render --out "$out" --frames 2 --outputs depth,position,position1,disk,sky,steps >/dev/null || return 1
    for name in depth.Z position.x position1.order disk.azimuth sky.g steps.Y; do
        grep -aqF "$name" "$out" || { echo "no $name" && return 1; }
    done
    # The light is the same without layers; another list is another file.
    render --out "$out" --frames 2 --outputs depth | grep -v 'was there' &&
        status 64 render --out "$out" --frames 2 --outputs depths &&
        status 64 render --out "$out" --frames 2 --outputs position16 &&
        status 64 render --out "$out" --frames 2 --outputs sky1 &&
        status 64 render --out "$scratch/layers.png" --frames 2 --outputs depth
}

# An ffmpeg that hangs holds nothing up for long after a signal.
hanging_ffmpeg() {
    local folder=$scratch/hanging found=0 pid begin
    printf '#!/bin/bash\ncase ${!#} in *-16.piece) exec sleep 601.5 ;; esac\nexec ffmpeg "$@"\n' \
        >"$scratch/hanging-ffmpeg"
    chmod +x "$scratch/hanging-ffmpeg"
    "$bhr" render "$scratch/video.toml" --backend cpu --keyframes 16 --size 256x256 --out "$folder/v.mp4" \
        --ffmpeg "$scratch/hanging-ffmpeg" >/dev/null 2>&1 &
    pid=$!
    until pgrep -f 'sleep 601.5' >/dev/null; do
        sleep 0.1
    done
    sleep 3
    begin=$SECONDS
    kill -TERM "$pid"
    wait "$pid" || found=$?
    echo "status $found after $((SECONDS - begin)) s"
    [ "$found" -eq 143 ] && [ $((SECONDS - begin)) -lt 40 ] && [ -z "$(find "$folder" -name '*.piece')" ] &&
        [ "$(frames_in "$folder/v.part.mp4")" -eq 16 ]
}

# Disks that are full at one point or another, also in the end, where ffmpeg may report success: a video is whole or not
# there.
full_disk_of_videos() {
    local as=-m
    [ "$(id -u)" -eq 0 ] || as=-rm
    export scratch bhr
    export -f status video frames_in on_full_disk_of_videos
    export video_frames
    unshare "$as" bash -c on_full_disk_of_videos
}

on_full_disk_of_videos() {
    local folder=$scratch/small-video size found refused=0
    mkdir -p -- "$folder" || return 1
    for size in 4 8 12 16 20 24 28; do
        mount -t tmpfs -o size="${size}k" none "$folder" || return 1
        found=0
        video --out "$folder/v.mp4" >"$scratch/said" 2>&1 || found=$?
        echo "$size KiB: status $found"
        case $found in
            0) [ "$(frames_in "$folder/v.mp4")" -eq "$video_frames" ] || return 1 ;;
            74) [ ! -e "$folder/v.mp4" ] && refused=$((refused + 1)) || return 1 ;;
            *) return 1 ;;
        esac
        umount "$folder" || return 1
    done
    [ "$refused" -ge 3 ]
}
