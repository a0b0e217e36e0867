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
jq -e '.context.device == "Mock GPU" and (.axes | length) == 1' \
    "$work/read/gpu-day/stress/out/stress.json" >/dev/null
echo "gpu_day_mock: ok"
