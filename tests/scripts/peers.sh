#!/usr/bin/env bash
# Adapters to other libraries: they trace, what they answer is judged, and the judge of hits agrees: peers.sh SOURCE PROGRAM
# FOLDER, where the adapters are. Skips without the checkouts they are compiled against.
set -euo pipefail
source=$1 program=$2 folder=$3
[ -f "$folder/tinybvh.so" ] && [ -f "$folder/madmann91.so" ] || { echo "skipped: no checkouts of other libraries"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail()
{
    echo "peers.sh: $1" >&2
    exit 1
}
# Few lines each, as promised of adapters.
for adapter in tinybvh madmann91; do
    lines=$(wc -l <"$source/examples/tracers/$adapter/$adapter.cpp")
    [ "$lines" -le 120 ] || fail "$adapter.cpp has $lines lines"
done

tinybvh=$folder/tinybvh.so madmann91=$folder/madmann91.so
"$program" run --quiet --scene sphere-mesh:n=40 --builder lbvh --kernel stack --rays primary,random,shadow --size 64x64 --max-rays 4096 \
    --repeats 1 --no-pictures --charts no --out out --tracer "$tinybvh:layout=bvh2" --tracer "$tinybvh:layout=bvh4" \
    --tracer "$tinybvh" --tracer "$tinybvh:quality=sbvh" --tracer "$tinybvh:optimize=3" --tracer "$madmann91" \
    --tracer "$madmann91:quality=low" --tracer "$madmann91:quality=medium,mode=fast" >log 2>&1 || fail "run: $(cat log)"
peers='.rows[] | select(.maker | not) | select((.builder // "") | test("tinybvh|madmann91"))'
rows=$(jq -r "$peers | select(.question | not) | .builder + \" \" + .status" out/results.json)
[ "$(wc -l <<<"$rows")" -eq 8 ] || fail "rows: $rows"
! grep -v ' ok$' <<<"$rows" || fail "a build is not ok"
# No library here is exact, but none loses one ray in twenty of a mesh like this one.
wrong=$(jq -c "[$peers | select(.question) | .wrong_ppm]" out/results.json)
jq -e 'length >= 24 and all(. != null) and max < 50000' <<<"$wrong" >/dev/null || fail "wrong per million: $wrong"
