#!/usr/bin/env bash
# scripts/gpu-day, small, with the program on the mock GPU: gpu_day_mock.sh SOURCE PROGRAM MOCK
set -euo pipefail
source=$1 program=$2 mock=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/scripts" "$work/build/release" "$work/read"
cp "$source/scripts/gpu-day" "$work/scripts/"
printf '#!/bin/sh\nLD_PRELOAD="%s" exec "%s" "$@"\n' "$mock" "$program" >"$work/build/release/bvhbench"
chmod +x "$work/build/release/bvhbench"

status=0
"$work/scripts/gpu-day" --quick machine stress >"$work/said" 2>&1 || status=$?
[ $status -eq 0 ] || {
    echo "gpu_day_mock.sh: exit status $status: $(cat "$work/said" "$work"/out/gpu-day/*/output)" >&2
    exit 1
}
tar -xf "$work"/out/gpu-day.tar.* -C "$work/read"
grep -q 'Mock GPU' "$work/read/gpu-day/machine/output"
jq -e '([.rows[] | select(.title)] | length) == 1 and any(.rows[]; .device == "Mock GPU")' \
    "$work/read/gpu-day/stress/out/stress.json" >/dev/null

# Two signals at once, as of an impatient Ctrl-C: what the step writes on its way out is packed.
day=$work/out/gpu-day
"$work/scripts/gpu-day" --quick compare >"$work/said" 2>&1 &
gpu_day=$!
until grep -qs ': building' "$day/compare/output"; do
    sleep 0.2
    kill -0 $gpu_day || break
done
sleep 2
kill -TERM $gpu_day
sleep 0.02
kill -TERM $gpu_day
status=0
wait $gpu_day || status=$?
[ $status -eq 130 ] || {
    echo "gpu_day_mock.sh: exit status $status, not 130: $(cat "$work/said" "$day"/compare/output)" >&2
    exit 1
}
tar -tf "$work"/out/gpu-day.tar.* >"$work/packed"
(cd "$work/out" && find gpu-day/compare -type f) >"$work/there"
grep -vxFf "$work/packed" "$work/there" >"$work/left" || true
[ ! -s "$work/left" ] || {
    echo "gpu_day_mock.sh: not packed: $(cat "$work/left")" >&2
    exit 1
}
echo "gpu_day_mock: ok"
