#!/usr/bin/env bash
# Whether a comparison measured and judged all that it should: tests/check_results.sh FOLDER CELLS
# FOLDER is what `bvhbench run` wrote. Exit status 1 unless its results have exactly CELLS cells,
# each measured and each of its rays judged, no ray set was left out, and report and pictures are
# there.
set -euo pipefail
folder=$1 cells=$2
results=$folder/results.json

fail() {
    echo "check_results: $results: $1" >&2
    exit 1
}

[ -s "$results" ] || fail "is not there"
# What a row is follows from its names (framework/record/README.md).
rows='def rows: if .schema == "bvhbench-table/1" then .rows[] else error("no table") end |
        select(.maker | not);
    def traces: rows | select(.question and .builder);
    def builds: rows | select(.builder and (.question | not));
    def skipped: rows | select(.question and .scene and (.builder | not));
'
count() {
    jq -r "$rows$1" "$results" || fail "is not what it should be: see above"
}

found=$(count '[traces] | length')
[ "$found" -eq "$cells" ] || fail "$found cells, not $cells"
bad=$(count '[traces | select(.status != "ok")
    | "\(.scene) \(.builder) \(.kernel) \(.question): \(.status)"] | .[:3] | join("; ")')
[ -z "$bad" ] || fail "cells that were not measured: $bad"
bad=$(count '[traces
    | select((.checked == .count and .count > 0 and (.ms // [] | length > 0 and all(. > 0))) | not)
    | "\(.scene) \(.builder) \(.kernel) \(.question)"] | .[:3] | join("; ")')
[ -z "$bad" ] || fail "cells of which not each ray was judged: $bad"
bad=$(count '[builds | select(.status != "ok") | "\(.scene) \(.builder): \(.status)"]
    | .[:3] | join("; ")')
[ -z "$bad" ] || fail "builds that were not measured: $bad"
bad=$(count '[skipped | "\(.scene) \(.question)"] | .[:3] | join("; ")')
[ -z "$bad" ] || fail "ray sets that were left out: $bad"
[ -s "$folder/report.html" ] || fail "no report.html beside it"
while IFS= read -r picture; do
    [ -s "$folder/$picture" ] || fail "no $picture beside it"
done < <(count 'rows | .frame // empty')
echo "check_results: $results: $found cells, each measured and judged"
