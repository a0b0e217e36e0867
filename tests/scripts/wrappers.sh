#!/usr/bin/env bash
# scripts/bench and scripts/test around programs made of stubs: wrappers.sh SOURCE
# What they pass on, and what scripts/test says at its end.
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "wrappers.sh: $1: $(cat "$work/said")" >&2
    exit 1
}

tree=$work/tree
mkdir -p "$tree/scripts" "$tree/tests" "$tree/build/release" "$work/bin"
cp "$source/scripts/bench" "$source/scripts/test" "$tree/scripts/"
cp "$source/tests/skipped.sh" "$tree/tests/"
stub() {
    printf '#!/bin/sh\n%s\n' "$2" >"$1"
    chmod +x "$1"
}
stub "$tree/scripts/setup" 'echo "setup $*"'
stub "$tree/scripts/build" 'echo "build $*"'
stub "$tree/build/release/bvhbench" 'echo "bvhbench $*"'
# A ctest that ran two tests and skipped one, and a case of another.
stub "$work/bin/ctest" 'echo "ctest $*"
mkdir -p "$2/Testing/Temporary"
for test in "one\" status=\"run" "two\" status=\"fail" "three\" status=\"notrun"; do
    echo "<testcase name=\"$test\">"
done >"$2/tests.xml"
echo "[  SKIPPED ] a_case" >"$2/Testing/Temporary/LastTest.log"'
PATH=$work/bin:$PATH

# expect TEXT SCRIPT ARGUMENT...: a line of what the script says is TEXT.
expect() {
    local text=$1 script=$2
    shift 2
    (cd "$work" && "$tree/scripts/$script" "$@") >"$work/said" 2>&1 || fail "$script $*: exit status $?"
    grep -qxF -- "$text" "$work/said" || fail "$script $*: no line '$text'"
}

expect "bvhbench run --out $tree/out" bench
expect "bvhbench run --scene cube --out $tree/out" bench run --scene cube
expect "bvhbench run --quick --out=here" bench --quick --out=here
expect 'setup bench' bench
expect 'build release' bench # all that is installed, not the program alone
volume='bvhbench volume --brief --scene nbody:n=160 --size 48x48 --step 1 --steps 4,2,1 --kernel stack'
overlap='bvhbench overlap --brief --fit 0.6 tets:side=14,shape=block tets:side=14'
for part in "$volume" "$overlap"; do
    expect "$part --repeats 6 --out $tree/out" bench
    expect "$part --repeats 3 --seed=2 --out here" bench --repeats 3 --seed=2 --out here
done
expect "bvhbench run --repeats 3 --seed=2 --out here" bench run --repeats 3 --seed=2 --out here
expect "bvhbench run --scene cube --repeats 2 --out $tree/out" bench --scene cube --repeats 2
! grep -q 'bvhbench volume' "$work/said" || fail 'volumes are compared beside chosen scenes'

unset BVHBENCH_TEST_PART # of the run that this is a part of
expect 'test: 6 tests ran in build/test build/asan build/tsan; skipped: 3 tests and 3 test cases' test
grep -qxF 'test: skipped: case a_case in build/asan' "$work/said" || fail 'no skipped case'
# expect_part PART BUILD TURNS: beside build/test it runs BUILD; labels TURNS are left out.
expect_part() {
    BVHBENCH_TEST_PART=$1 expect "test: 4 tests ran in build/test build/$2; skipped: 2 tests and 2 test cases" test
    local called
    called=$(grep -F '/build/test ' "$work/said")
    [[ $called == *" --label-exclude ^long\$|$3 "* ]] || fail "part $1: other labels"
}
expect_part 5 tsan '^turn-[^5]'
expect_part 11 asan '^turn-'
grep -q '/build/asan .* -I 6,,6 ' "$work/said" || fail 'part 11: not the last sixth under AddressSanitizer'
BVHBENCH_TEST_PART=0 expect 'test: 2 tests ran in build/test; skipped: 1 tests and 1 test cases' test
expect 'test: 2 tests ran in build/test; skipped: 1 tests and 1 test cases' test --quick
expect 'setup quick-test' test --quick
expect 'build test' test -R x --quick
grep -qE '^ctest .* --label-exclude \^\(oclgrind\|slow\|long\)\$ -R x$' "$work/said" ||
    fail 'arguments do not reach ctest'
echo "wrappers: ok"
