#!/usr/bin/env bash
# A tracer that no one here wrote: three-mesh-bvh, installed by npm, answers rays files, and its hits are judged:
# three_mesh_bvh.sh SOURCE PROGRAM
set -euo pipefail
source=$1 program=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail()
{
    echo "three_mesh_bvh.sh: $1" >&2
    exit 1
}
command -v npm >/dev/null || { echo "skipped: no npm"; exit 77; }
cp "$source"/examples/three-mesh-bvh/* "$work"
cd "$work"
npm install --no-audit --no-fund >log 2>&1 || { echo "skipped: npm cannot install: $(tail -1 log)"; exit 77; }

answer() # SCENE RAYS
{
    "$program" rays --scene "$1" --rays "$2" --size 64x64 --max-rays 4096 --out a.rays >log 2>&1 || fail "rays: $(cat log)"
    node trace.mjs a.rays a.hits >speed || fail "no answer to $2 on $1"
    jq -e '.build_ms > 0 and .mrays_s > 0' speed >/dev/null || fail "no speed: $(cat speed)"
    "$program" judge --scene "$1" --rays-file a.rays --hits a.hits --mrays-s "$(jq .mrays_s speed)" --out out >log ||
        true # what is wrong is counted below
    grep -q '^three-mesh-bvh on ' log || fail "judge: $(cat log)"
    right=$(sed -n 's/^ *right *\([0-9]*\).*/\1/p' log)
}

# a closed mesh of ordinary triangles: all right but for edges
for rays in primary shadow random; do
    answer sphere-mesh:n=32 $rays
    [ "$right" -ge 3900 ] || fail "$rays: only $right right: $(cat log)"
done

# a file with indices out of range names the ray and is refused
"$program" rays --scene sphere-mesh:n=4 --rays primary --size 16x16 --out a.rays >log
node trace.mjs a.rays a.hits >speed
printf '\x40\x42\x0f\x00' | dd of=a.hits bs=1 seek=$((128 + 8 * 100 + 4)) conv=notrunc 2>/dev/null
printf '\x00\x00\x80\x3f' | dd of=a.hits bs=1 seek=$((128 + 8 * 100)) conv=notrunc 2>/dev/null
if "$program" judge --scene sphere-mesh:n=4 --rays-file a.rays --hits a.hits --out out >log 2>&1; then
    fail "primitive 1000000 was taken"
fi
grep -q 'ray 100' log || fail "the ray is not named: $(cat log)"

# bad input of trace.mjs itself: a line, and status 2
for bad in "none.rays a.hits" "log a.hits" "a.rays" "a.rays a.hits --quality=best"; do
    set +e
    # shellcheck disable=SC2086
    node trace.mjs $bad >out.txt 2>err.txt
    status=$?
    set -e
    [ $status -eq 2 ] && [ "$(wc -l <err.txt)" -eq 1 ] || fail "$bad: status $status: $(cat err.txt)"
done
