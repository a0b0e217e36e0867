#!/usr/bin/env bash
# A kernel that is really slowed down, by 5 % or what is given, is found by `compare --run`, and nothing else is:
#   planted.sh BVHBENCH FOLDER [PERCENT] [PAIRS] [ARGUMENTS OF RUN...]
# The loop in the kernel is calibrated first, with a slowdown that is plain to see. Takes minutes, needs jq, and is for a machine that
# does little else: not a part of `ctest`.
set -euo pipefail
program=$(realpath "$1") folder=$2 percent=${3:-5} pairs=${4:-20}
source=$(cd "$(dirname "$0")/../.." && pwd)
arguments=("${@:5}")
[ ${#arguments[@]} -gt 0 ] || arguments=(--scene sphere-mesh:n=60 --builder lbvh,sah,llbvh,emc --kernel stack,stack8
    --rays primary,random:count=40000 --size 256x256 --repeats 6)
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

# slowed NAME TURNS: a program whose kernel `stack` does so many turns of nothing at each sixteenth node.
slowed() {
    mkdir -p "$folder/kernels-$1"
    sed "s|search->boxes += 2;|search->boxes += 2; if ((search->boxes \& 31) == 0) for (volatile uint turn = 0; turn < $2; turn++) ;|" \
        "$source/kernels/stack.cl" >"$folder/kernels-$1/stack.cl"
    grep -q 'volatile uint turn' "$folder/kernels-$1/stack.cl" || { echo "stack.cl is not as expected"; exit 1; }
    printf '#!/bin/sh\nexec "%s" "$@" --kernels-from "%s"\n' "$program" "$folder/kernels-$1" >"$folder/$1"
    chmod +x "$folder/$1"
}

# The median ratio of the cells that the kernel traces, of all pairs.
ratio_of() {
    for pair in "$folder/$1"/[1-9]*-after; do
        jq -n --slurpfile a "${pair%after}before/results.json" --slurpfile b "$pair/results.json" '
            def median: sort | .[(length - 1) / 2 | floor];
            def times: [.rows[] | select(.kernel == "stack" and .cell) | {key: .cell, value: (.ms[1:] | median)}] | from_entries;
            ($a[0] | times) as $x | ($b[0] | times) as $y | $x | keys[] | $y[.] / $x[.]'
    done | sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'
}

slowed none 0
slowed plain 40
echo "calibrating: 40 turns"
"$program" compare --run "$folder/none" "$folder/plain" --rounds 9 --quiet --out "$folder/calibration" -- "${arguments[@]}" \
    >"$folder/calibration.txt" || true
plain=$(ratio_of calibration)
turns=$(awk -v r="$plain" -v p="$percent" 'BEGIN { printf "%d", 40 * p / 100 / (r - 1) + 0.5 }')
echo "40 turns: $plain times as long; $turns turns for $percent %"
[ "$turns" -ge 1 ] || { echo "one turn is more than $percent %"; exit 1; }
slowed planted "$turns"
status=0
"$program" compare --run "$folder/none" "$folder/planted" --rounds "$pairs" --quiet --out "$folder/planted-runs" -- "${arguments[@]}" |
    tee "$folder/planted.txt" || status=$?
echo "as measured: $(ratio_of planted-runs) times as long"
sed -n '/^worse/,/^$/p' "$folder/planted.txt" >"$folder/worse.txt"
right=$(grep -c 'kernel=stack\(/\|$\| \)' "$folder/worse.txt" || true)
all=$(grep -c 'scene=' "$folder/worse.txt" || true)
echo "worse: $all, of which $right are the slowed kernel's"
[ "$status" -eq 1 ] && [ "$right" -ge 1 ] && [ "$right" -eq "$all" ]
