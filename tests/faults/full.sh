#!/bin/bash
# What bvhbench does where nothing can be written: full.sh PROGRAM TRACER. Each file that a command
# writes goes to a full disk (a tmpfs of 64 KB, where one may be mounted) and to /dev/full: exit status
# 2, one line, and no file under the name that was asked for. Skips (77) what cannot be mounted.
set -u
program=$1 tracer=$2
folder=$(mktemp -d /tmp/bvhbench-full-XXXXXX)
mounted=no
end() {
    [ $mounted = no ] || umount "$folder/disk"
    rm -rf "$folder"
}
trap end EXIT
cd "$folder" || exit 1
status=0
fail() {
    echo "full: $*" >&2
    sed 's/^/  | /' err >&2
    status=1
}

# refused FILE ARGUMENT...: the file is not there afterwards, nor half of it under another name.
refused() {
    local file=$1
    shift
    "$program" "$@" >out 2>err
    local got=$?
    [ $got = 2 ] || fail "exit status $got, not 2: bvhbench $*"
    [ "$(grep -c '' err)" = 1 ] && grep -q '^bvhbench: ' err || fail "not one line: bvhbench $*"
    [ "$file" = /dev/full ] || [ ! -e "$file" ] || fail "$file is there: bvhbench $*"
    [ -z "$(find . -name '*.tmp')" ] || fail "a temporary file is left: bvhbench $*"
    rm -rf disk/*
    fill
}

fill() {
    [ $mounted = no ] || dd if=/dev/zero of=disk/filler bs=1k count=80 2>/dev/null
}

run="run --scene cube --builder lbvh --kernel stack --rays primary --size 8x8 --repeats 1 --quick --quiet"
"$program" $run --charts no --out there >out 2>err || { fail "the run failed"; exit 1; }
"$program" rays --scene cube --rays primary --size 8x8 --out a.rays >out 2>err || { fail "no rays"; exit 1; }
"$tracer" a.rays a.hits >out 2>err || { fail "no hits"; exit 1; }

# Standard output that is lost, and a file name that is a device.
for arguments in "list builders" "report there --table" "report there --csv --charts no" "version" "help run"; do
    "$program" $arguments >/dev/full 2>err
    [ $? = 2 ] && [ "$(grep -c '' err)" = 1 ] || fail "lost output is not said: bvhbench $arguments"
done
refused /dev/full report there --charts no --out /dev/full
refused /dev/full rays --scene cube --rays primary --size 8x8 --out /dev/full

mkdir disk
if ! mount -t tmpfs -o size=64k tmpfs disk 2>/dev/null; then
    echo "full: no tmpfs can be mounted here: left out" >&2
    [ $status = 0 ] && exit 77
    exit $status
fi
mounted=yes
fill
refused disk/report.html report there --charts no --out disk/report.html
refused disk/a.rays rays --scene cube --rays primary --size 64x64 --out disk/a.rays
refused disk/heat.png render --scene cube --show heat --size 128x128 --out disk/heat.png
refused disk/depth.exr render --scene cube --show depth --size 128x128 --out disk/depth.exr
refused disk/o/report.html judge --scene cube --rays-file a.rays --hits a.hits --out disk/o
refused disk/o/report.html $run --charts no --out disk/o
# What there is room for stays whole: the results, without the page.
rm -f disk/filler
"$program" $run --charts no --no-pictures --out disk/o >out 2>err
[ $? = 2 ] && [ "$(grep -c '' err)" = 1 ] || fail "a run that has no room for its page"
[ ! -e disk/o/report.html ] || fail "the page is there"
[ ! -e disk/o/results.json ] || jq -e . disk/o/results.json >/dev/null || fail "results.json is no JSON"
if command -v gnuplot >/dev/null; then
    refused disk/report-charts/charts.gp report there --charts yes --out disk/report.html
fi
exit $status
