#!/usr/bin/env bash
# A metric of trees is one file: one_file.sh SOURCE BUILD FOLDER (of dropped_in.sh)
# 1. No file of the harness but its own names a metric, apart from papers, whose data do, and SAH, which the harness itself
# uses for layouts. 2. With BVHBENCH_SLOW_TESTS set: a metric dropped into framework/builder (dropped_in.c) is in every output: list, help,
# file, tables, page, charts.
. "$(dirname "$0")/../source_copy.sh"

for file in framework/builder/metric_*.c; do
    name=$(basename "$file" .c)
    name=${name#metric_}
    [ "$name" != sah ] || continue
    grep -rnE "\"$name(_half)?\"|'$name'|\"$name\"|bb_metric_$name\b|[.]$name\b" CMakeLists.txt cmake framework traversal \
        --include='*.c' --include='*.h' --include='*.js' --include='*.html' --include='*.cmake' \
        --include='CMakeLists.txt' --exclude-dir=papers | grep -v "^$file:" >"$work/found" || true
    [ ! -s "$work/found" ] || fail "the harness names the metric $name: $(head -1 "$work/found")"
done

if [ -z "${BVHBENCH_SLOW_TESTS-}" ]; then
    echo "one file: nobody else names a metric"
    exit 0
fi
program=$3/build/bvhbench
[ -x "$program" ] || fail "$program is not built: run dropped_in.sh first"
run()
{
    "$program" run --table --scene cube --builder lbvh,embree-native --kernel stack --rays primary --size 16x16 --repeats 1 \
        --no-pictures --quiet --out "$work/$1" "${@:2}" >"$work/$1.txt" 2>"$work/$1.err" ||
        fail "run $1: $(cat "$work/$1.err")"
}
grep -q '^  dropped_in  *nodes and a quarter' <<<"$("$program" list metrics)" || fail "list does not show it"
grep -q '^  dropped_in ' <<<"$("$program" run --help)" || fail "the help does not show it"
run with --metrics dropped_in
run without
build=$(grep -m 1 '"nodes":' "$work/with/results.json")
value=$(sed 's/.*"nodes":\([0-9]*\).*/\1/' <<<"$build").25
grep -qF "\"dropped_in\":$value," <<<"$build" || fail "the file lacks it, or its value"
grep -qE '"dropped_in_half":0.125[,}]' <<<"$build" || fail "the file lacks its interval"
! grep -q '"dropped_in' "$work/without/results.json" || fail "not asked for, it is in the file"
grep -q '^Builder .* DROP ' "$work/with.txt" || fail "the table has no column for it"
grep -q "^lbvh .* ${value%5}" "$work/with.txt" || fail "the table lacks its value, to three digits"
! grep -q DROP "$work/without.txt" || fail "the table has a column for what nobody measured"
! "$program" run --table --scene cube --metrics dropped --out "$work/bad" 2>"$work/err" || fail "a metric that is none is taken"
grep -q "unknown metric 'dropped'" "$work/err" || fail "what is wrong is not said: $(cat "$work/err")"
# an earlier file, and one whose value is no number
sed 's/"dropped_in":[0-9.]*/"dropped_in":"much"/' "$work/with/results.json" >"$work/broken.json"
! "$program" report "$work/broken.json" --out "$work/broken.html" >/dev/null 2>"$work/err" ||
    fail "a metric that is no number is taken"
grep -q '"dropped_in" has the wrong type' "$work/err" || fail "$(cat "$work/err")"
sed '/"name":"dropped_in/d; s/,"dropped_in[a-z_]*":[0-9.]*//g' "$work/with/results.json" >"$work/earlier.json"
"$program" report "$work/earlier.json" --out "$work/earlier.html" >"$work/earlier.txt" 2>&1 ||
    fail "a file without it is not read: $(cat "$work/earlier.txt")"

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
grep -q '"name":"dropped_in"' "$work/with/report.html" || fail "the page's schema lacks it"
if [ -n "$browser" ]; then
    "$browser" --headless --no-sandbox --disable-gpu --no-first-run --disable-dev-shm-usage \
        --user-data-dir="$work/profile" --virtual-time-budget=5000 --dump-dom "file://$work/with/report.html" \
        2>/dev/null | sed -n '1,/<script type="application\/json"/p' >"$work/page"
    grep -q '>DROP</button>' "$work/page" || fail "the page's table of builds has no column for it"
    grep -q '<option value="dropped_in">DROP of the tree</option>' "$work/page" || fail "the page's chart has no choice of it"
    grep -q '<dt>DROP</dt><dd>Nobody else knows of this.</dd>' "$work/page" || fail "the page does not say what it is"
fi
if command -v gnuplot >/dev/null; then
    grep -q "cube_primary_dropped_in.svg" "$work/with/report-charts/charts.gp" || fail "there is no picture of it"
    [ -s "$work/with/report-charts/cube_primary_dropped_in.svg" ] || fail "its picture is not drawn"
fi
echo "one file: ok"
