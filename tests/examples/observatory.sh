# SPDX-License-Identifier: MIT OR Apache-2.0
# observatory.sh -- tests of examples-c/observatory: its fluxes, files, light curves and messages. Functions only, each
# one a test for `check` or a helper of them. Needs tests/lib.sh's $scratch and $tests, $examples (the folder of the
# programs), tests/examples/run's `picture`, ImageMagick, and Python without any package.
# shellcheck shell=bash disable=SC2154

# observatory_says FILE ARGUMENTS...: runs it and keeps what it prints.
observatory_says() {
    local file=$1
    shift
    "$examples/observatory" "$@" >"$file" || return 1
    cat -- "$file"
}

# Five published fluxes; the last column says by how much they differ. In `tests/run all` alone, as they take 18 s.
observatory_gold() {
    observatory_says "$scratch/gold" gold && [ "$(grep -c '^ *[1-5] ' "$scratch/gold")" -eq 5 ] &&
        awk '$1 ~ /^[1-5]$/ { off = $NF < 0 ? -$NF : $NF; if (!(off < ($1 == 1 ? 4e-4 : 5.1e-5))) exit 1 }' \
            "$scratch/gold"
}

# Three frequencies of a small image: matter is the more opaque the lower the frequency, the flux at 230 GHz is what was
# asked for, and the files are well formed, hold the printed fluxes, and say where and how large the image is.
observatory_image() {
    local folder=$scratch/observatory
    observatory_says "$scratch/fluxes" image --plain --pixels 40 --output "$folder" --flux-230 2.5 || return 1
    awk '/ GHz  flux / { depth[$1] = $(NF - 1) + 0; flux[$1] = $4 }
        END { exit !(depth[86] > 10 * depth[230] && depth[230] > 2 * depth[345] && depth[345] > 0 &&
            flux[230] > 2.49999 && flux[230] < 2.50001) }' "$scratch/fluxes" || return 1
    python3 "$tests/observatory/fits.py" "$folder" "$scratch/fluxes" 40 180 20 || return 1
    local ghz
    for ghz in 86 230 345; do
        picture "$folder/sgra-${ghz}GHz.png" 640x728 100 || return 1
    done
    # Another frame, beam, target and frequency.
    observatory_says "$scratch/fluxes" image --target m87 --plain --pixels 24 --beam 0 --fov 150 --frequency 230 \
        --volume torus,power-law,radius=6,absorption=0.1,spectral-index=0.7 --volume jet --output "$folder" &&
        python3 "$tests/observatory/fits.py" "$folder" "$scratch/fluxes" 24 150 0 &&
        picture "$folder/m87-230GHz.png" 648x736 50
}

# Reads the files with astropy, as observers do.
observatory_astropy() {
    python3 -m venv "$scratch/astropy" && "$scratch/astropy/bin/pip" install --quiet astropy &&
        "$scratch/astropy/bin/python" "$tests/observatory/astropy_reads.py" "$scratch/observatory"/*.fits
}

# contrast PHASE ARGUMENTS...: that of a hot spot's light curve at this phase, of 32, and half an orbit later.
contrast() {
    local azimuth
    azimuth=$(awk -v phase="$1" 'BEGIN { print phase * 360 / 32 }')
    shift
    "$examples/observatory" hotspot --observer 1000 --phases 2 --hot-spot "radius=7,size=0.7,azimuth=$azimuth" \
        --output "$scratch/spot" "$@" | tee "$scratch/curve" >&2 || return 1
    sed -n 's/.*contrast \([0-9.]*\);.*/\1/p' "$scratch/curve"
}

# near VALUE TRUTH TOLERANCE
near() { awk -v v="$1" -v truth="$2" -v most="$3" 'BEGIN { exit !(v - truth <= most && truth - v <= most) }'; }

# On a grid of 96 x 96 rays the contrast of slow light is 22.1, and that of fast light 8.9 (the curves of
# tests/golden/volume/manifest.json); more rays beside the shadow find more light in the dark phase.
observatory_hotspot() {
    local found pixels=16 refined=20.82 # everyday few, of which most are refined
    ! runs_all || pixels=40 refined=20.96
    found=$(contrast 7 --plain) && near "$found" 22.1 0.1 || return 1
    found=$(contrast 7 --pixels "$pixels") && near "$found" "$refined" 0.1 || return 1
    [ "$(wc -l <"$scratch/spot/hotspot.csv")" -eq 3 ] && picture "$scratch/spot/hotspot.png" 1180x560 20 || return 1
    # Half an orbit later; a M of Sgr A* is 21.16 seconds and 5.124 microarcseconds.
    awk -F , 'NR == 3 { exit !($2 > 58.183 && $2 < 58.1832 && $3 / $2 > 0.3526 && $3 / $2 < 0.3529 &&
        $8 / $6 > 5.123 && $8 / $6 < 5.125 && $6 < -5) }' "$scratch/spot/hotspot.csv"
}

observatory_fast_light() {
    local found
    found=$(contrast 6 --plain --fast-light) && near "$found" 8.9 0.1
}

# refuses STATUS WORDS ARGUMENTS...
refuses() {
    local status=$1 words=$2
    shift 2
    exits "$status" "$words" "$examples/observatory" "$@"
}

# A disk that is full: a message, and nothing half written stays.
observatory_on_a_full_disk() {
    local folder=$scratch/full
    mkdir -p -- "$folder" && ln -s /dev/full "$folder/sgra-230GHz.fits" && ln -s /dev/full "$folder/hotspot.csv" &&
        refuses 1 'cannot write .*sgra-230GHz.fits: No space left' image --plain --pixels 8 --output "$folder" &&
        refuses 1 'cannot write .*hotspot.csv: No space left' hotspot --plain --pixels 16 --phases 2 \
            --output "$folder" && [ -z "$(ls -- "$folder")" ]
}

observatory_refusals() {
    local option
    refuses 2 'image, gold or hotspot' && refuses 2 'no command' picture || return 1
    for option in mass-msun distance-kpc inclination fov beam flux-230 observer position-angle; do
        refuses 2 "--$option is nan" image --$option nan && refuses 2 "--$option is -1e+30" image --$option -1e30 ||
            return 1
    done
    refuses 2 '2 to 4096' image --pixels 1 && refuses 2 '2 to 1000' hotspot --phases 1 &&
        refuses 2 'unknown option' gold --spin 0 && refuses 2 'unknown option' hotspot --beam 20 &&
        refuses 2 '1 to 8 numbers' image --frequency 230,,345 && refuses 2 '1 to 8 numbers' image --frequency nan &&
        refuses 2 '1 to 8 numbers' image --frequency 1,2,3,4,5,6,7,8,9 &&
        refuses 2 'both be named 230' image --frequency 230,230.0001 &&
        refuses 2 'both be named 86' image --frequency 230,86,345,86 &&
        refuses 2 'disk, torus, halo or jet' image --volume ball &&
        refuses 2 'no field' image --volume halo,size=3 && refuses 2 'a number' image --volume halo,radius=big &&
        refuses 2 'no power law' image --volume halo && refuses 2 'no field' hotspot --hot-spot width=1 &&
        refuses 2 'must be the same' image --volume halo,power-law --volume jet,power-law,spectral-index=0 &&
        refuses 2 'given 2 times' hotspot --hot-spot radius=7 --hot-spot radius=8 &&
        refuses 2 'at most 200000 M' image --mass-msun 1 && refuses 2 'at most 20 M' hotspot --observer 100 &&
        refuses 1 'spin' image --spin 2 && refuses 1 'spin' hotspot --spin nan &&
        refuses 1 'radius' image --volume halo,power-law,radius=nan --output "$scratch/none" &&
        refuses 1 'size' hotspot --hot-spot size=9 && refuses 1 'absent' image --output "$scratch/absent/none" &&
        refuses 1 'tests/run' image --pixels 4 --plain --output "$tests/run" &&
        refuses 1 'no light' image --plain --pixels 4 --fov 0.001 --output "$scratch/none" \
            --volume disk,power-law,inner-radius=500,outer-radius=600,thickness=0.01 --inclination 0
}
