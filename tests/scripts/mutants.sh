#!/usr/bin/env bash
# scripts/mutants: mutants.sh SOURCE
# All mutants can be planted still; and what the script says of some, around programs made of stubs.
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "mutants.sh: $1: $(cat "$work/said")" >&2
    exit 1
}

# expect STATUS TEXT ARGUMENT...: the script ends with STATUS, and a line of what it says begins so;
# runs of blanks count as one.
expect() {
    local status=$1 text=$2 got=0
    shift 2
    "$tree/scripts/mutants" "$@" >"$work/said" 2>&1 || got=$?
    [ $got -eq "$status" ] || fail "$*: exit status $got, not $status"
    tr -s ' ' <"$work/said" >"$work/squeezed"
    grep -q -- "^$text" "$work/squeezed" || fail "$*: no line '$text'"
}

tree=$source
expect 0 'pad-box answers ' --list
[ "$(wc -l <"$work/said")" -ge 60 ] || fail 'few mutants'
expect 2 'mutants: there is no mutant nobody' --list --only nobody
expect 2 'mutants: usage: ' --hist

# ---- a tree of one file, and programs that look into it ----
tree=$work/tree
list=$tree/tests/mutants/all.txt
mkdir -p "$tree/scripts" "$tree/tests/mutants" "$work/bin"
cp "$source/scripts/mutants" "$tree/scripts/"
touch "$tree/tests/test_a.c" "$tree/tests/fixture.h"
printf 'build/\n' >"$tree/.gitignore"
printf 'int one = 1;\nint two = 2;\n' >"$tree/code.c"
git -C "$tree" init -q

# A program that says what stands in the copy's code.c: `find WORD STATUS`.
stub() {
    printf '#!/bin/bash\nsource=%s/build/mutants/tree/code.c\nfind() { ! grep -q "$1" $source || exit $2; }\n%s\n' \
        "$tree" "$2" >"$work/bin/$1"
    chmod +x "$work/bin/$1"
}
stub bvhbench 'find answer 1; find refused 2; find crash 139
if grep -q loop $source; then echo "HUNG  here"; exit 1; fi
exit 0'
# shellcheck disable=SC2016
stub cmake 'mkdir -p $(dirname $source)/build/test
touch $(dirname $source)/build/test/build.ninja
cp '"$work"'/bin/bvhbench $(dirname $source)/build/test/bvhbench
find syntax 1; exit 0'
stub ctest '
case "$*" in *test_a*) find seen 8 ;; *) if grep -q slowly $source; then
echo "1/2 Test  #1: test_b ....***Failed  0.1 sec"; exit 8; fi ;; esac
exit 0'
PATH=$work/bin:$PATH

# mutant NAME KIND AFTER [LINE...]
mutant() {
    printf 'mutant %s\nbug a bug\nfile code.c\nkind %s\ntests test_a\n' "$1" "$2"
    [ $# -lt 4 ] || printf '%s\n' "${@:4}"
    printf -- '-one = 1\n+%s\n\n' "$3"
}

mutant found figures 'seen' >"$list"
expect 0 'found figures test_a - - ' # and the table ends with a line of its own
grep -q '^mutants: 1, each found by all that must' "$work/said" || fail 'no last line'
cmp -s "$tree/code.c" "$tree/build/mutants/tree/code.c" || fail 'the bug is in the copy still'
grep -q 'one = 1' "$tree/code.c" || fail 'the bug is in the source'

mutant later figures 'slowly' >"$list"
expect 0 'later figures test_b (not named) - - '
mutant unseen figures 'unseen'\''s other' >"$list"
sed -i 's/^+.*/+one = 3/' "$list"
expect 1 'unseen figures NO - - '
expect 1 'mutants: of 1, these were not found by all that must: unseen'
mutant broken figures 'syntax' >"$list"
expect 1 'broken figures compiler - - '
mutant both answers 'seen answer' 'check --scene x' 'run --scene x' >"$list"
expect 0 'both answers test_a found found '
mutant half answers 'seen' 'check --scene x' >"$list"
expect 1 'half answers test_a NO - '
mutant endless answers 'seen loop' 'check --scene x' >"$list"
expect 0 'endless answers test_a hung - '
# what could not be asked has found nothing
mutant refused answers 'seen refused' 'run --scene x' >"$list"
expect 1 'refused answers test_a - refused '
mutant crash answers 'seen crash' 'run --scene x' >"$list"
expect 0 'crash answers test_a - exit 139 '

# ---- without a bug something fails ----
printf 'int one = 1; /* seen */\n' >"$tree/code.c"
mutant found figures 'three' >"$list"
expect 2 'mutants: without a bug, test_a: test_a: '
printf 'int one = 1;\nint two = 2;\n' >"$tree/code.c"

# ---- lists that cannot be right ----
mutant gone figures 'seen' >"$list"
sed -i 's/^-.*/-one = 4/' "$list"
expect 2 'mutants: gone: what it replaces is not in code.c' --list
sed -i 's/^-.*/-int /' "$list"
expect 2 'mutants: gone: what it replaces is in code.c more than once' --list
mutant same figures 'one = 1' >"$list"
expect 2 'mutants: same: it changes nothing' --list
mutant unasked answers 'seen' >"$list"
expect 2 'mutants: unasked: answers are wrong: say which check or run must find it' --list
mutant odd colours 'seen' >"$list"
expect 2 "mutants: odd: kind 'colours' is none of" --list
{ mutant twice figures 'seen' && mutant twice figures 'seen'; } >"$list"
expect 2 '.*two mutants of the name twice' --list
mutant lost figures 'seen' 'tests test_lost' >"$list"
expect 2 'mutants: lost: there is no test test_lost' --list
printf 'mutant little\nbug none\n' >"$list"
expect 2 '.*mutant little has no .file.' --list
