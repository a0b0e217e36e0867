#!/usr/bin/env bash
# scripts/test-on and scripts/matrix around programs made of stubs: test_on.sh SOURCE
# What they refuse, what test-on mounts and runs and where, what it says, and that nothing goes on
# when it is killed.
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "test_on.sh: $1: $(cat "$work/said" 2>/dev/null)" >&2
    exit 1
}
stub() {
    printf '#!/bin/bash\n%s\n' "$2" >"$work/bin/$1"
    chmod +x "$work/bin/$1"
}

tree=$work/tree
mkdir -p "$tree/scripts" "$work/bin"
cp "$source/scripts/test-on" "$source/scripts/matrix" "$tree/scripts/"
stub id 'echo ${STUB_USER-0}'
stub apt-get 'case "$1" in indextargets) printf "http://x/security\nhttp://mirror/debian\n" ;; esac'
stub apt-config 'exit 0'
stub chown 'exit 0'
stub debootstrap 'echo "debootstrap $*" >>"$STUB_LOG"
mkdir -p "$3/etc/apt/apt.conf.d" "$3/root"
echo "VERSION_CODENAME=$2" >"$3/etc/os-release"
echo 99 >"$3/etc/debian_version"'
# What would be namespaces and another root: the command itself, in the folder of the clone.
stub setpriv '[ "$1 $2" = "--pdeathsig KILL" ] || exit 9; shift 2; exec "$@"'
stub unshare 'while [ "${1#--}" != "$1" ]; do echo "unshare $1" >>"$STUB_LOG"; shift; done; exec "$@"'
stub mount 'echo "mount $*" >>"$STUB_LOG"'
stub chroot 'echo "chroot $*" >>"$STUB_LOG"; cd "$1/bvhbench" 2>/dev/null || cd "$1"
shift; while [ "$1" != -c ]; do shift; done; shift 3; exec "$@"'
stub dpkg-query 'exit 0'
stub dpkg 'exit ${STUB_DPKG-0}'
# A checkout whose commands say what they are.
git -C "$tree" init -q
for name in bench setup build test; do
    printf '#!/bin/bash\necho "%s $*"\n[ %s != "${STUB_FAILS-}" ] || exit 3\n' $name $name \
        >"$tree/scripts/$name"
    chmod +x "$tree/scripts/$name"
done
git -C "$tree" add -A
git -C "$tree" -c user.name=x -c user.email=x@x commit -qm x
export PATH=$work/bin:$PATH STUB_LOG=$work/log

# on STATUS ARGUMENT...
on() {
    local wanted=$1 status=0
    shift
    : >"$STUB_LOG"
    "$tree/scripts/test-on" "$@" >"$work/said" 2>&1 || status=$?
    [ $status -eq "$wanted" ] || fail "test-on $*: exit status $status"
}
refuses() { # TEXT ARGUMENT...: in one line
    local text=$1
    shift
    on 2 "$@"
    [ "$(wc -l <"$work/said")" -eq 1 ] || fail "test-on $*: not one line"
    grep -qF -- "$text" "$work/said" || fail "test-on $*: no '$text'"
    [ ! -s "$STUB_LOG" ] || fail "test-on $*: did something: $(cat "$STUB_LOG")"
}
says() {
    grep -qE -- "$1" "${2-$work/said}" || fail "no '$1' in $(cat "${2-$work/said}")"
}

chroot=$work/chroot
refuses usage
refuses "no suite 'sid'" sid
refuses "no option '--fast'" trixie --fast
refuses '--in needs a value' trixie --in
refuses "--driver is 'cuda'" trixie --driver cuda
refuses "--only is 'all'" trixie --only all
STUB_USER=1000 refuses 'only root' trixie --in "$chroot"
mkdir -p "$work/other/photos"
refuses 'holds something else' trixie --in "$work/other"
refuses 'holds something else' bookworm --in /

on 0 trixie --in "$chroot" --out "$work/out"
says "^debootstrap --variant=minbase trixie $chroot http://mirror/debian\$" "$STUB_LOG"
for mount in 'proc proc .*/proc' 'sysfs sysfs .*/sys' '--bind /dev .*/dev' \
    'devpts devpts .*/dev/pts' 'tmpfs tmpfs .*/dev/shm'; do
    says "^mount (-t )?${mount// .\*/ $chroot}\$" "$STUB_LOG"
done
for namespace in --mount --pid --fork --kill-child; do
    says "^unshare $namespace\$" "$STUB_LOG"
done
says "^chroot $chroot env -i HOME=/root PATH=" "$STUB_LOG"
says '^scripts/bench +ok .* bench $'
says '^scripts/bench --quick +ok .* bench --quick$'
says '^scripts/test +ok .* test $'
says "^revision $(git -C "$tree" rev-parse --short=12 HEAD) on trixie, Debian 99, driver pocl" \
    "$work/out/table.txt"
[ -d "$chroot/bvhbench/.git" ] || fail 'no clone'

# The chroot is kept, another suite's is refused, a failure is one of the table.
refuses 'holds something else' bookworm --in "$chroot"
touch "$chroot/bvhbench/left"
STUB_FAILS=bench on 1 trixie --in "$chroot" --out "$work/out" --only bench
! grep -q debootstrap "$STUB_LOG" || fail 'makes the chroot again'
[ ! -e "$chroot/bvhbench/left" ] || fail 'the clone is not clean'
says '^scripts/bench +exit 3'
! grep -q '^scripts/test' "$work/said" || fail '--only bench also tests'
mkdir "$chroot/debootstrap" # of a debootstrap that was interrupted
on 0 trixie --in "$chroot" --out "$work/out" --only test --mirror http://other
says 'debootstrap .* http://other' "$STUB_LOG"
rmdir "$chroot/debootstrap"
on 2 trixie --in "$chroot" --out "$work/out" --driver rusticl
says 'has no driver rusticl'

# When it is killed, what it started ends as well.
printf '#!/bin/bash\necho $$ >"%s/pid"\nexec sleep 60\n' "$work" >"$tree/scripts/test"
git -C "$tree" -c user.name=x -c user.email=x@x commit -qam x
"$tree/scripts/test-on" trixie --in "$chroot" --out "$work/out" --only test >"$work/said" 2>&1 &
script=$!
for _ in $(seq 100); do
    [ -s "$work/pid" ] && break
    sleep 0.1
done
kill -TERM $script
wait $script && fail 'exit status 0 when killed'
for _ in $(seq 50); do
    kill -0 "$(cat "$work/pid")" 2>/dev/null || break
    sleep 0.1
done
! kill -0 "$(cat "$work/pid")" 2>/dev/null || fail 'its command goes on'

# ---- matrix ----
matrix() {
    local wanted=$1 status=0
    shift
    "$tree/scripts/matrix" --program "$work/bin/bvhbench" --out "$work/matrix" "$@" \
        >"$work/said" 2>&1 || status=$?
    [ $status -eq "$wanted" ] || fail "matrix: exit status $status"
}
stub bvhbench 'while [ $# -gt 0 ]; do [ "$1" != --out ] || out=$2; [ "$1" != --scene ] || scene=$2; shift; done
[ -z "${STUB_DIES-}" ] || [ "$scene" != "$STUB_DIES" ] || { echo "bvhbench: the device is lost"; exit 2; }
mkdir -p "$out"
row() { echo "{\"scene\":\"$scene\",\"question\":\"r\",\"builder\":\"$1\",\"kernel\":\"k\",\"query\":\"any\",\"status\":\"$2\",\"unlike\":0,\"wrong_ppm\":0$3}"; }
{
    echo "{\"rows\":[{\"scene\":\"$scene\"},{\"scene\":\"$scene\",\"builder\":\"good\",\"status\":\"ok\"},"
    row good ok ""; echo ,; row good ok ",\"maker\":\"m\""; echo ,
    row shy refused ",\"reason\":\"too small\""; echo ,
    row bad ok "${STUB_WRONG:+,\"wrong\":\"$STUB_WRONG\"}"; echo ,
    row embree ok ",\"wrong\":\"yes\",\"reference\":\"yes\""
    echo "]}"
} >"$out/results.json"
way="\"builder\":\"b\",\"intersector\":\"skip\""
for name in volume slice overlap; do
    echo "{\"rows\":[{\"device\":\"d\"},{$way,\"differ\":${STUB_DIFFER-0}},{$way,\"refused\":\"no room\"}]}" >"$out/$name.json"
done'
matrix 0
says '^matrix: 26 right, 18 refused, 0 wrong'
says "^gpu.cube.shy.k.any.refused.too small\$" "$work/matrix/matrix.tsv"
says "slice.refused.no room\$" "$work/matrix/matrix.tsv"
STUB_WRONG=yes matrix 1
says '^matrix: 18 right, 18 refused, 8 wrong'
STUB_DIFFER=3 matrix 1
says '^matrix: 16 right, 18 refused, 10 wrong'
STUB_DIES=cube matrix 1
says 'wrong.bvhbench: the device is lost$' "$work/matrix/matrix.tsv"
STUB_WRONG=yes matrix 2 --fast x
echo "test_on: ok"
