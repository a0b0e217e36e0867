#!/usr/bin/env bash
# Does `compare --run` find a kernel, a build and a layout that are really slowed down, by 5 % or what is given, and nothing else?
#   planted.sh BVHBENCH FOLDER [PERCENT] [PAIRS] [TRIALS] [ARGUMENTS OF RUN...]
# Empty loops slow them down; how long these must be is calibrated first, with slowdowns that are plain to see. Each of TRIALS (1) is a
# comparison of its own. Exit status 1 if one does not find all three. Takes minutes, needs jq, and is for a machine that does little else: not a part of `ctest`.
set -euo pipefail
program=$(realpath "$1") folder=$2 percent=${3:-5} pairs=${4:-20} trials=${5:-1}
source=$(cd "$(dirname "$0")/../.." && pwd)
arguments=("${@:6}")
[ ${#arguments[@]} -gt 0 ] || arguments=(--scene sphere-mesh:n=300 --builder lbvh,hploc --kernel stack,stack8
    --rays primary,random:count=40000 --size 256x256 --repeats 6)
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

# plant FILE TURNS AFTER WHEN: copies a file of device code, with a loop of so many turns after a text in it, where the condition holds.
plant() {
    local copy=$kernels/${1##*/}
    sed "s|$3|& if ($4) for (volatile uint turn = 0; turn < $2; turn++) ;|" "$source/$1" >"$copy"
    grep -q 'volatile uint turn' "$copy" || { echo "$1 is not as expected"; exit 1; }
}

# slowed NAME KERNEL BUILD LAYOUT: a program with loops of so many turns in the kernel `stack`, at each sixteenth node; in the build of
# `lbvh`, at each 64th leaf; in the layout `pair`, at each 16th node.
slowed() {
    local kernels=$folder/kernels-$1
    mkdir -p "$kernels"
    plant kernels/stack_pair.clh "$2" 'search->boxes += 2;' '(search->boxes \& 31) == 0'
    plant builders/common/radix_tree.cl "$3" 'start_leaf_ahead(&w, i, starts, values, boxes, refs, ref_end);' '(i \& 63) == 0'
    plant kernels/layout_pair.cl "$4" 'uint children = base\[n + 1\] - base\[n\] + 1u;' '(n \& 15) == 0'
    printf '#!/bin/sh\nexec "%s" "$@" --kernels-from "%s"\n' "$program" "$kernels" >"$folder/$1"
    chmod +x "$folder/$1"
}

# ratio_of RUNS ROWS: the median ratio of times (processor time, where there is one), after to before, of all pairs. ROWS: a jq filter that gives {key, value} of each time.
ratio_of() {
    for pair in "$folder/$1"/[1-9]*-after; do
        jq -n --slurpfile a "${pair%after}before/results.json" --slurpfile b "$pair/results.json" '
            def median: sort | .[(length - 1) / 2 | floor];
            def times: [.rows[] | '"$2"' | .value |= (.[1:] | median)] | from_entries;
            ($a[0] | times) as $x | ($b[0] | times) as $y | $x | keys[] | $y[.] / $x[.]'
    done | sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'
}
kernel='select(.kernel == "stack" and .cpu_ms) | {key: .cell, value: .cpu_ms}'
build='select(.builder == "lbvh" and .build_ms) | {key: .cell, value: .cpu_ms}'
layout='select(.maker == "pair" and .layout_ms) | {key: .builder, value: .layout_ms}'

# calibrate KERNEL BUILD LAYOUT: measures with so many turns, then sets `turns` to as many as slow each time by $percent. What a loop takes
# does not grow with its turns alone, so the second calibration begins near its end.
calibrate() {
    local i name=calibration-$1-$2-$3 plain=("$@") rows=("$kernel" "$build" "$layout")
    slowed "$name" "$@"
    "$program" compare --run "$folder/none" "$folder/$name" --rounds 15 --quiet --out "$folder/$name-runs" -- "${arguments[@]}" \
        >"$folder/$name.txt" || true
    for i in 0 1 2; do
        turns[i]=$(awk -v r="$(ratio_of "$name-runs" "${rows[i]}")" -v p="$percent" -v n="${plain[i]}" \
            'BEGIN { printf "%d", n * p / 100 / (r - 1) + 0.5 }')
        [ "${turns[i]}" -ge 1 ] || { echo "${plain[i]} turns make no difference, or one makes more than $percent %"; exit 1; }
    done
    echo "for $percent %: ${turns[0]} turns in the kernel, ${turns[1]} in the build, ${turns[2]} in the layout"
}

slowed none 0 0 0
turns=()
calibrate 400 2000 400
calibrate "${turns[@]}"
slowed planted "${turns[@]}"
failed=0
for trial in $(seq "$trials"); do
    status=0 runs=planted-runs-$trial
    "$program" compare --run "$folder/none" "$folder/planted" --rounds "$pairs" --quiet --out "$folder/$runs" -- "${arguments[@]}" \
        >"$folder/$runs.txt" || status=$?
    sed -n '/^worse/,/^$/p' "$folder/$runs.txt" | grep 'scene=' >"$folder/worse.txt" || true
    all=$(wc -l <"$folder/worse.txt")
    traces=$(grep -c 'kernel=stack\(/\|$\| \)' "$folder/worse.txt" || true)
    layouts=$(grep -c 'layout=pair' "$folder/worse.txt" || true)
    builds=$(grep -v 'layout=\|kernel=' "$folder/worse.txt" | grep -c 'builder=lbvh' || true)
    echo "trial $trial: kernel $(ratio_of "$runs" "$kernel"), build $(ratio_of "$runs" "$build"), layout $(ratio_of "$runs" "$layout")" \
        "times as long; found worse: $traces traces, $builds builds, $layouts layouts, $((all - traces - builds - layouts)) others"
    [ "$status" -eq 1 ] && [ "$traces" -ge 1 ] && [ "$builds" -ge 1 ] && [ "$layouts" -ge 1 ] &&
        [ $((traces + builds + layouts)) -eq "$all" ] || failed=$((failed + 1))
    rm -rf "${folder:?}/$runs"
done
echo "$((trials - failed)) of $trials trials found all three and nothing else"
[ "$failed" -eq 0 ]
