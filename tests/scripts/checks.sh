#!/usr/bin/env bash
# The checks of CI must fail where something was not checked: checks.sh SOURCE
# tests/check_run.sh and tests/check_results.sh on runs made up here.
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "checks.sh: $1" >&2
    exit 1
}

# expect STATUS TEXT COMMAND...: TEXT is in what the command says.
expect() {
    local expected=$1 text=$2 status=0
    shift 2
    "$@" >"$work/said" 2>&1 || status=$?
    [ $status -eq "$expected" ] && grep -qF -- "$text" "$work/said" ||
        fail "exit status $status, not $expected with '$text': $(cat "$work/said")"
}

# ---- runs of ctest ----
tree=$work/tree
mkdir -p "$tree/tests" "$tree/build/Testing/Temporary"
cp "$source/tests/check_run.sh" "$source/tests/skipped.sh" "$tree/tests/"
touch "$tree/tests/test_one.c" "$tree/tests/test_two.c"
printf '%s | ../data | a reason\n' big_case test_two >"$tree/tests/may_skip.txt"

# run STATUS-OF-TWO SKIPPED-CASE: what ctest leaves of a run.
run() {
    {
        echo '	<testcase name="test_one" classname="test_one" status="run">'
        [ -z "$1" ] || echo "	<testcase name=\"test_two\" classname=\"test_two\" status=\"$1\">"
    } >"$tree/build/tests.xml"
    {
        echo '[ RUN      ] a_case'
        [ -z "$2" ] || echo "[  SKIPPED ] $2"
        echo '[  SKIPPED ] 1 test(s), listed below:'
    } >"$tree/build/Testing/Temporary/LastTest.log"
}
unset BVHBENCH_TEST_PART # of the run that this is a part of
check_run() {
    expect "$1" "$2" "$tree/tests/check_run.sh" "$tree/build"
}
expect 1 'usage' "$tree/tests/check_run.sh"
check_run 1 'no tests ran'
run run ''
check_run 0 '2 tests ran'
for two in '' fail; do
    run "$two" ''
    check_run 1 'test_two did not run'
done
run notrun big_case
check_run 0 'test_two was skipped: no ../data'
run run other_case
check_run 1 'other_case was skipped'
run run big_case
check_run 0 'big_case was skipped: no ../data'
mkdir "$work/data"
check_run 1 'big_case was skipped'
run notrun ''
check_run 1 'test_two did not run'
# By turns: only where it was another's turn may a test be missing.
cat >"$tree/build/CTestTestfile.cmake" <<'END'
add_test(test_one true)
add_test(test_two true)
set_tests_properties(test_two PROPERTIES LABELS "two;turn-1")
END
run '' ''
for part in 3 10; do
    BVHBENCH_TEST_PART=$part check_run 0 '1 tests ran'
done
BVHBENCH_TEST_PART=1 check_run 1 'test_two did not run'

# ---- results ----
out=$work/out
mkdir "$out"
check_results() {
    expect "$1" "$2" "$source/tests/check_results.sh" "$out" "$work/list.json"
}
jq -n '{compared: [["s", "scene"], ["b", "builder"], ["e", "reference"], ["k0", "kernel"], ["k1", "kernel"],
    ["r", "rays"], ["i", "intersector"]] | map({name: .[0], summary: .[1]})}' >"$work/list.json"
# results FILTER: good results of three cells, rows 2 to 4, and a part of each, changed by a filter of
# jq.
results() {
    jq -n '([range(2) | {builder: "b", kernel: "k\(.)", intersector: "i"}] + [{builder: "e", kernel: "own"}]
        | map(. + {scene: "s", question: "r"})) as $cells |
        {schema: "bvhbench-table/1", rows: ([{scene: "s"}, {scene: "s", builder: "b", status: "ok"}]
        + [$cells[] + {status: "ok", count: 5, ms: [1, 2], checked: 5}]
        + [$cells[] + {maker: "m"}]
        + [{scene: "s", frame: "p.png"}, {planned_cells: 3, planned_sets: 1}])}' |
        jq "$1" >"$out/results.json"
}
check_results 1 'is not there'
results .
check_results 1 'no report.html'
echo page >"$out/report.html"
check_results 1 'no p.png'
echo picture >"$out/p.png"
check_results 0 '3 cells, each measured and judged'
results 'del(.rows[3])'
check_results 1 '2 cells, not the 3 that were planned'
results 'del(.rows[-1].planned_cells)'
check_results 1 '3 cells, not the 0 that were planned'
results '.rows[-1].planned_sets = 2'
check_results 1 '1 ray sets, not the 2 that were planned'
# A plan that lacks the same: the list does not.
results 'del(.rows[3]) | .rows[-1].planned_cells = 2'
check_results 1 'no cells: s r b k1 i'
results 'del(.rows[4]) | .rows[-1].planned_cells = 2'
check_results 1 'no cells: s r e'
# Other versions of Embree lack queries; no builder of ours may.
lacking='del(.rows[4]) | .rows[-1].planned_cells = 2 | .rows += [{scene: "s", builder: "e", status: "unsupported"}]'
results "$lacking"
check_results 0 '2 cells, each measured and judged'
results "$lacking | .rows[-1].status = \"failed\""
check_results 1 'no cells: s r e'
unsupported='|= (.status = "unsupported" | del(.ms, .checked))'
results ".rows[4] $unsupported"
check_results 0 '3 cells, each measured and judged'
results ".rows[3] $unsupported"
check_results 1 's b k1 r: unsupported'
results '.rows[1].status = "unsupported"'
check_results 1 's b: unsupported'
# Nor may the list lack a kind of what is compared.
results .
cp "$work/list.json" "$work/all.json"
for kind in scene rays builder kernel intersector; do
    jq "del(.compared[] | select(.summary == \"$kind\"))" "$work/all.json" >"$work/list.json"
    check_results 1 "list.json names no $kind"
done
echo '{}' >"$work/list.json"
check_results 1 'is not what `bvhbench list compared --json` prints'
: >"$work/list.json"
check_results 1 'list.json names no scene'
cp "$work/all.json" "$work/list.json"
# From two views each: one lacks a cell.
results '.rows |= (map(select(.question and (.maker | not)) + {view: "v"})
    + map(select(.question and (.maker | not)) + {view: "w"}) + map(select(.question | not))
    + [{scene: "s", view: "v"}, {scene: "s", view: "w"}, {scene: "s", view: "not taken"}])
    | del(.rows[4]) | .rows |= map(if .planned_cells then .planned_cells = 5 | .planned_sets = 2 else . end)'
check_results 1 'no cells: s r w b k1 i'
results '.rows[3].status = "refused"'
check_results 1 's b k1 r: refused'
results '.rows[2].checked = 4'
check_results 1 'not each ray was judged: s b k0 r'
for change in 'del(.rows[2].checked)' 'del(.rows[2].ms)' '.rows[2].ms = [0, 1]' \
    '.rows[2] |= (.count = 0 | .checked = 0)'; do
    results "$change"
    check_results 1 'not each ray was judged'
done
results '.rows[1].status = "failed"'
check_results 1 's b: failed'
results '.rows += [{scene: "s", question: "edges"}]'
check_results 1 's edges'
results '.rows = 7'
check_results 1 'not what it should be'
results '.schema = "bvhbench-results/1" | .rows = []'
check_results 1 'not what it should be'
echo '{' >"$out/results.json"
check_results 1 'not what it should be'
echo "checks: ok"
