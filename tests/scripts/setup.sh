#!/usr/bin/env bash
# scripts/setup on machines made of stubs: setup.sh SOURCE It installs what is missing where it can;
# where it cannot, it says so in one line and lets the build go on.
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "setup.sh: $1" >&2
    exit 1
}

stub() {
    printf '#!/bin/sh\n%s\n' "$2" >"$work/bin/$1"
    chmod +x "$work/bin/$1"
}

# A PATH with nothing but what the script uses, and no package, no root, no sudo.
machine() {
    rm -rf "$work/bin" "$work/calls"
    mkdir "$work/bin"
    local tool
    for tool in bash dirname sed tr mktemp rm env cat; do
        ln -s "$(command -v "$tool")" "$work/bin/$tool"
    done
    stub dpkg-query 'case "$4" in '"${1-}"') printf installed ;; *) exit 1 ;; esac'
    stub id 'echo 1000'
    stub apt-get 'echo "$1" >>'"$work/calls"'; for i in 1 2 3 4 5; do echo noise; done; exit 100'
}

# setup LINES ARGUMENT...: exit status 0, that many lines on standard error, nothing on standard
# output.
setup() {
    local lines=$1 status=0
    shift
    env -i PATH="$work/bin" TMPDIR="$work" ${variable-} "$source/scripts/setup" "$@" \
        >"$work/said" 2>"$work/errors" || status=$?
    [ $status -eq 0 ] || fail "$case: exit status $status: $(cat "$work/errors")"
    [ ! -s "$work/said" ] || fail "$case: says $(cat "$work/said")"
    [ "$(wc -l <"$work/errors")" -eq "$lines" ] ||
        fail "$case: not $lines lines: $(cat "$work/errors")"
}

says() {
    grep -qF -- "$1" "$work/errors" || fail "$case: '$1' is not in: $(cat "$work/errors")"
}

# The calls of apt-get, each with a comma after it.
called() {
    [ "$(tr '\n' , <"$work/calls")" = "$1" ] || fail "$case: called $(cat "$work/calls")"
}

case="all is there"
machine '*'
setup 0 test

case="nothing is wanted"
machine
variable=BVHBENCH_SETUP=no setup 0 bench
[ ! -e "$work/calls" ] || fail "$case: called $(cat "$work/calls")"

case="no Debian"
machine
rm "$work/bin/dpkg-query"
setup 1 bench
says libembree-dev

case="neither root nor sudo"
machine 'c*|l*'
setup 1 test
says 'oclgrind'
says 'as root, run: apt-get install'
grep -q 'libembree-dev' "$work/errors" && fail "$case: names what is installed"
[ ! -e "$work/calls" ] || fail "$case: called $(cat "$work/calls")"

case="sudo that refuses"
machine
stub sudo 'echo "a password is required" >&2; exit 1'
setup 3 bench
says 'going on'
says 'as root, run: apt-get install'

case="root, no network"
machine
stub id 'echo 0'
setup 3 bench
says 'going on'
log=$(sed -n 's/.*failed (log: \([^)]*\)).*/\1/p' "$work/errors")
grep -q noise "$log" || fail "$case: the log is not at '$log'"
called install,update,install,install,update,

# What apt says beforehand, in its own words.
knows='case " $* " in *" --print-uris "*)
    echo "0 upgraded, 152 newly installed, 0 to remove and 1 not upgraded."
    echo "Need to get 12.3 MB/186 MB of archives."
    echo "After this operation, 844 MB of additional disk space will be used."
    echo "a URI" ;; esac'

case="root, all is well"
machine
stub id 'echo 0'
stub apt-get "echo \"\$1\" >>$work/calls; $knows"
setup 1 bench
says 'installing build-essential'
says '152 packages, 186 MB to download, 844 MB on disk'
called install,install,
[ -z "$(find "$work" -name 'bvhbench-setup.*' -newer "$work/bin")" ] || fail "$case: left its log"

case="a user with sudo"
machine
stub sudo "echo sudo >>$work/calls; shift; exec \"\$@\""
stub apt-get "echo \"\$1\" >>$work/calls; $knows"
setup 1 bench
called install,sudo,install,

case="root, lists that are old"
machine
stub id 'echo 0'
ln -s "$(command -v grep)" "$work/bin/grep"
stub apt-get "echo \"\$1\" >>$work/calls
[ \"\$1\" = update ] || grep -q update $work/calls || exit 100; $knows"
setup 2 bench
says "fetching Debian's package lists"
says '152 packages'
called install,update,install,install,
[ -z "$(find "$work" -name 'bvhbench-setup.*' -newer "$work/bin")" ] || fail "$case: left its log"

# A release without oclgrind: apt finds nothing of a list that names it.
lacks_oclgrind() {
    stub apt-cache "echo cache >>$work/calls; [ \"\$2\" != oclgrind ] ${1-}"
    stub apt-get "echo \"\$1\" >>$work/calls
case \" \$* \" in *\" oclgrind \"*) exit 100 ;; esac; $knows"
}

case="root, a release without oclgrind"
machine
stub id 'echo 0'
lacks_oclgrind
setup 2 test
says 'has no oclgrind'
says '152 packages'
called cache,cache,install,install,
says 'installing build-essential'
! grep -q 'installing.*oclgrind' "$work/errors" || fail "$case: asks for it"

case="a release without oclgrind, all else is there"
machine '[!o]*|ocl-*|op*'
stub id 'echo 0'
lacks_oclgrind
setup 1 test
called cache,cache,

case="root, a release without oclgrind, lists that are old"
machine
stub id 'echo 0'
ln -s "$(command -v grep)" "$work/bin/grep"
lacks_oclgrind "&& grep -q update $work/calls"
setup 3 test
called cache,install,update,cache,cache,install,install,

case="no such set"
status=0
"$source/scripts/setup" all >/dev/null 2>"$work/errors" || status=$?
[ $status -eq 2 ] && [ "$(wc -l <"$work/errors")" -eq 1 ] || fail "$case: exit status $status"
echo "setup: ok"
