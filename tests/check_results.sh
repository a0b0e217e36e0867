#!/usr/bin/env bash
# Whether a comparison measured and judged all that it should: tests/check_results.sh FOLDER LIST
# FOLDER is what `bvhbench run` wrote, LIST what `bvhbench list compared --json` prints. Exit status 1
# unless the results have the ray sets and cells that the run planned, and on the listed scenes each
# listed builder by each listed kernel and intersector with all listed rays from each view, and the
# references; each measured and each of its rays judged, no ray set was left out, and report and
# pictures are there. A reference may be unsupported: another version of Embree has other queries.
set -euo pipefail
folder=$1 list=$2
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
    def names($what): $list[0].compared[] | select(.summary == $what) | .name;
    [names("reference")] as $references
    | def may_lack: .status == "unsupported" and (.builder | IN($references[]));
'
count() {
    jq -r --slurpfile list "$list" "$rows$1" "$results" || fail "is not what it should be: see above"
}

# A list that names none of a kind would ask for no cells.
for kind in scene rays builder kernel intersector; do
    named=$(jq --arg kind "$kind" '[.compared[] | select(.summary == $kind)] | length' "$list") ||
        fail "$list is not what \`bvhbench list compared --json\` prints: see above"
    [ "${named:-0}" -gt 0 ] || fail "$list names no $kind"
done
found=$(count '[traces] | length')
cells=$(count '[rows | .planned_cells // empty][0] // 0')
[ "$found" -eq "$cells" ] || fail "$found cells, not the $cells that were planned"
sets=$(count '[traces | [.run, .scene, .question, .view]] | unique | length')
planned=$(count '[rows | .planned_sets // empty][0] // 0')
[ "$sets" -eq "$planned" ] || fail "$sets ray sets, not the $planned that were planned"
# Rays are made from views of a scene, as many as were planned, or once. How a reference traces is
# its own affair.
bad=$(count '[traces | [.scene, (.question | split(":")[0]), .view, .builder]
        + if .builder | IN($references[]) then [] else [.kernel, .intersector] end] as $there
    | [builds | select(may_lack) | [.scene, .builder]] as $lacking
    | [names("scene") as $scene | names("rays") as $rays
        | ([$there[] | select(.[0] == $scene and .[1] == $rays) | .[2]] | unique
            | if . == [] then null else .[] end) as $view
        | (([["builder", "kernel", "intersector"][] | [names(.)]] | combinations),
            ($references[] | select([[$scene, .]] - $lacking != []) | [.])) as $by
        | [$scene, $rays, $view] + $by | select([.] - $there != []) | map(values) | join(" ")]
    | unique | .[:3] | join("; ")')
[ -z "$bad" ] || fail "no cells: $bad"
bad=$(count '[traces | select(.status != "ok" and (may_lack | not))
    | "\(.scene) \(.builder) \(.kernel) \(.question): \(.status)"] | .[:3] | join("; ")')
[ -z "$bad" ] || fail "cells that were not measured: $bad"
bad=$(count '[traces | select(may_lack | not)
    | select((.checked == .count and .count > 0 and (.ms // [] | length > 0 and all(. > 0))) | not)
    | "\(.scene) \(.builder) \(.kernel) \(.question)"] | .[:3] | join("; ")')
[ -z "$bad" ] || fail "cells of which not each ray was judged: $bad"
bad=$(count '[builds | select(.status != "ok" and (may_lack | not)) | "\(.scene) \(.builder): \(.status)"]
    | .[:3] | join("; ")')
[ -z "$bad" ] || fail "builds that were not measured: $bad"
bad=$(count '[skipped | "\(.scene) \(.question)"] | .[:3] | join("; ")')
[ -z "$bad" ] || fail "ray sets that were left out: $bad"
[ -s "$folder/report.html" ] || fail "no report.html beside it"
while IFS= read -r picture; do
    [ -s "$folder/$picture" ] || fail "no $picture beside it"
done < <(count 'rows | .frame // empty')
echo "check_results: $results: $found cells, each measured and judged"
