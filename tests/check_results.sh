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
count() {
    jq -r "$1" "$results" || fail "is not what it should be: see above"
}

found=$(count '.traces | length')
[ "$found" -eq "$cells" ] || fail "$found cells, not $cells"
bad=$(count '[.traces[] | select(.status != "ok")
    | "\(.scene) \(.builder) \(.kernel) \(.rays): \(.status)"] | .[:3] | join("; ")')
[ -z "$bad" ] || fail "cells that were not measured: $bad"
bad=$(count '[.traces[]
    | select((.accuracy.checked == .count and .count > 0 and .mrays_s > 0) | not)
    | "\(.scene) \(.builder) \(.kernel) \(.rays)"] | .[:3] | join("; ")')
[ -z "$bad" ] || fail "cells of which not each ray was judged: $bad"
bad=$(count '[.builds[] | select(.status != "ok") | "\(.scene) \(.builder): \(.status)"]
    | .[:3] | join("; ")')
[ -z "$bad" ] || fail "builds that were not measured: $bad"
bad=$(count '[.skipped[] | "\(.scene) \(.rays)"] | .[:3] | join("; ")')
[ -z "$bad" ] || fail "ray sets that were left out: $bad"
[ -s "$folder/report.html" ] || fail "no report.html beside it"
while IFS= read -r picture; do
    [ -s "$folder/$picture" ] || fail "no $picture beside it"
done < <(count '.pictures[].path')
echo "check_results: $results: $found cells, each measured and judged"
