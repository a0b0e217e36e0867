#!/usr/bin/env bash
# Whether the last runs of `scripts/test` checked what there is to check: tests/check_run.sh
# BUILD... (folders such as build/test) Prints what was skipped. Exit status 1 if a test_NAME.c that
# BVHBENCH_TEST_PART does not leave out did not run, in the first of the builds or, unless once.txt
# has it, in another; or if something was skipped that may_skip.txt does not allow here.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(dirname "$here")
bad=0

complain() {
    echo "check_run: $1" >&2
    bad=1
}

# Whether test $1 has status $2 in the run of $build.
listed() {
    grep -q "<testcase name=\"$1\".* status=\"$2\"" "$build/tests.xml"
}

# The file whose absence allows that $1 is skipped; nothing if none does.
allowed_without() {
    awk -F '|' -v name="$1" '!/^#/ && NF == 3 {
        for (i = 1; i <= 2; i++) gsub(/^ +| +$/, "", $i)
        if ($1 == name) print $2
    }' "$here/may_skip.txt"
}

# Whether test $2 is in the part of $build that BVHBENCH_TEST_PART names, as scripts/test takes it:
# of the first, $1, by turns; of another every sixth.
in_this_part() {
    local part=${BVHBENCH_TEST_PART-} chosen listed
    [ -n "$part" ] || return 0
    if [ "$build" != "$1" ]; then
        chosen=(-I "$((part - 5)),,6")
    elif [ "$part" -lt 6 ]; then
        chosen=(--label-exclude "^turn-[^$part]")
    else
        chosen=(--label-exclude '^turn-')
    fi
    listed=$(ctest --test-dir "$build" -N "${chosen[@]}")
    grep -q " $2\$" <<<"$listed"
}

may_skip() {
    local needed
    needed=$(allowed_without "$1")
    [ -n "$needed" ] && [ ! -e "$root/$needed" ]
}

[ $# -gt 0 ] || complain "usage: tests/check_run.sh BUILD..."
for build in "$@"; do
    if [ ! -f "$build/tests.xml" ] || [ ! -f "$build/Testing/Temporary/LastTest.log" ]; then
        complain "$build: no tests ran"
        continue
    fi
    for source in "$here"/test_*.c; do
        name=$(basename "$source" .c)
        [ "$build" = "$1" ] || ! grep -qx "$name" "$here/once.txt" || continue
        in_this_part "$1" "$name" || continue
        listed "$name" run || { listed "$name" notrun && may_skip "$name"; } ||
            complain "$build: $name did not run"
    done
    while read -r _ name; do
        if may_skip "$name"; then
            echo "check_run: $build: $name was skipped: no $(allowed_without "$name")"
        else
            complain "$build: $name was skipped"
        fi
    done < <("$here/skipped.sh" "$build")
    ran=$(grep -c '<testcase .* status="run"' "$build/tests.xml" || true)
    echo "check_run: $build: $ran tests ran"
done
exit $bad
