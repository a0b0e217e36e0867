#!/usr/bin/env bash
# Whether the last runs of `scripts/test` checked what there is to check: tests/check_run.sh
# BUILD... (folders such as build/test) Prints what was skipped. Exit status 1 if a test_NAME.c did
# not run, or if something was skipped that may_skip.txt does not allow here.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(dirname "$here")
bad=0

complain() {
    echo "check_run: $1" >&2
    bad=1
}

# Tests that ctest skipped, and cases that cmocka did, of the run in folder $1.
skipped() {
    sed -n 's/.*<testcase name="\([^"]*\)".* status="notrun".*/\1/p' "$1/tests.xml"
    sed -n 's/^\[  SKIPPED \] \([A-Za-z_][A-Za-z_0-9]*\)$/\1/p' "$1/Testing/Temporary/LastTest.log"
}

# The file whose absence allows that $1 is skipped; nothing if none does.
allowed_without() {
    awk -F '|' -v name="$1" '!/^#/ && NF == 3 {
        for (i = 1; i <= 2; i++) gsub(/^ +| +$/, "", $i)
        if ($1 == name) print $2
    }' "$here/may_skip.txt"
}

[ $# -gt 0 ] || complain "usage: tests/check_run.sh BUILD..."
for build in "$@"; do
    if [ ! -f "$build/tests.xml" ] || [ ! -f "$build/Testing/Temporary/LastTest.log" ]; then
        complain "$build: no tests ran"
        continue
    fi
    for source in "$here"/test_*.c; do
        name=$(basename "$source" .c)
        grep -q "<testcase name=\"$name\".* status=\"run\"" "$build/tests.xml" ||
            complain "$build: $name did not run"
    done
    while IFS= read -r name; do
        needed=$(allowed_without "$name")
        if [ -n "$needed" ] && [ ! -e "$root/$needed" ]; then
            echo "check_run: $build: $name was skipped: no $needed"
        else
            complain "$build: $name was skipped"
        fi
    done < <(skipped "$build" | sort -u)
    ran=$(grep -c '<testcase .* status="run"' "$build/tests.xml" || true)
    echo "check_run: $build: $ran tests ran"
done
exit $bad
