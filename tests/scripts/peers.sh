#!/usr/bin/env bash
# scripts/peers with the checkouts beside this one: it builds the adapters against an installed
# bvhbench, all its rows run, and no library has more wrong answers than are known of it:
# peers.sh SOURCE PROGRAM. Skips without the checkouts.
set -euo pipefail
source=$1 program=$2 shared=$1/../shared/peers
[ -d "$shared/tinybvh" ] && [ -d "$shared/madmann91-bvh" ] || { echo "skipped: no checkouts of other libraries"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

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

# The script in a tree whose build/release is the build under test.
tree=$work/tree
mkdir -p "$tree/scripts" "$tree/build"
cp "$source/scripts/peers" "$tree/scripts/"
ln -s "$(realpath "$source")/examples" "$tree/examples"
ln -s "$(dirname "$(realpath "$program")")" "$tree/build/release"
for script in setup build; do
    printf '#!/bin/sh\n' >"$tree/scripts/$script"
    chmod +x "$tree/scripts/$script"
done
cd "$work"
# peers OUT SCENE RAYS OPTION...: the rows of libraries in OUT.
peers()
{
    CXXFLAGS='-Wall -Wextra -Wno-missing-field-initializers -Werror' "$tree/scripts/peers" "${@:4}" --quiet \
        --scene "$2" --builder lbvh --kernel stack --rays "$3" --size 64x64 --max-rays 4096 --repeats 1 \
        --no-pictures --charts no --out "$1" >log 2>&1 || fail "$*: $(cat log)"
    jq '[.rows[] | select(.maker | not) | select((.builder // "") | test("tinybvh|madmann91"))]' \
        "$1/results.json" >"$1.rows"
    rows=$(jq -r '.[] | select(.question | not) | .builder + " " + .status' "$1.rows")
    ! grep -v ' ok$' <<<"$rows" || fail "$1: a build is not ok"
}
# most OUT PATTERN PPM: no row whose builder matches has more wrong rays per million.
most()
{
    jq -e --arg of "$2" --argjson most "$3" '[.[] | select(.question) | select(.builder | test($of))] |
        length >= 3 and all(.wrong_ppm != null and .wrong_ppm <= $most)' "$1.rows" >/dev/null ||
        fail "$1: $2 above $3: $(jq -c '.[] | select(.question) | [.builder, .question, .wrong_ppm]' "$1.rows")"
}

both=(--tinybvh "$shared/tinybvh" --madmann91 "$shared/madmann91-bvh")
peers rooms interior:n=20000 primary,random,shadow,primary:tmin=1.5 "${both[@]}"
[ "$(wc -l <<<"$rows")" -eq 9 ] || fail "rows: $rows"
most rooms '^(?!.*optimize)' 250 # measured: 0; this is one ray of a set
most rooms optimize=25 3000 # 2197: what Optimize() loses (examples/tracers/README.md)
for settings in quality=sbvh,optimize=3 layout=bvh2,quality=sbvh layout=bvh4,quality=sbvh; do
    both+=(--tracer "$tree/build/peers/tinybvh.so:$settings")
done
peers coffee coffee primary,random,shadow "${both[@]}"
most coffee layout=bvh2 33000 # measured: at most 29541, of small triangles
most coffee 'tinybvh(?!:layout=bvh2)' 500 # 244: one ray
most coffee madmann91 250 # 0

# What is no checkout is named.
set +e
"$tree/scripts/peers" --tinybvh "$work" >log 2>&1
status=$?
set -e
[ $status -eq 2 ] && grep -q 'has no tiny_bvh.h' log || fail "no checkout: status $status: $(cat log)"
