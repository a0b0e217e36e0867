#!/usr/bin/env bash
# scripts/gpu-day around programs made of stubs: gpu_day.sh SOURCE
# What it runs, in which order; what it packs and when; what it does again, and what not; statuses.
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tree=$work/tree
said=$work/said

fail() {
    echo "gpu_day.sh: $1: $(cat "$said")" >&2
    exit 1
}

mkdir -p "$tree/scripts" "$tree/build/release" "$work/bin"
cp "$source/scripts/gpu-day" "$tree/scripts/"
stub() {
    cat >"$1"
    chmod +x "$1"
}
# A bvhbench whose steps end as the file `ends` says: STEP STATUS in each line; `slow` is one that
# takes until it is asked to end. It leaves what it was asked in `asked`, and what the archive has
# meanwhile in `packed`.
stub "$tree/build/release/bvhbench" <<END
#!/bin/bash
cd "$work"
case \$1 in
version) exec cat version ;;
list) [ \$2 = papers ] && exec printf 'papers\n  ours  x\n  emc  x\n  volume  x\n'; exec cat devices ;;
esac
echo "\$*" >>asked
tar -tf tree/out/gpu-day.tar.zst >packed 2>/dev/null
step=\$1
[ \$1 != reproduce ] || step=\$2
[ "\$1 \$2" != 'run --quick' ] || step=look
[[ "\$*" =~ --out\ (.*) ]] && mkdir -p "\${BASH_REMATCH[1]}" && echo "\$step" >"\${BASH_REMATCH[1]}/results.json"
how=\$(sed -n "s/^\$step //p" ends)
[ "\$how" != slow ] || { trap 'exit 130' TERM; sleep 20 & wait; }
exit \${how:-0}
END
stub "$work/bin/nvidia-smi" <<'END'
#!/bin/bash
echo "nvidia-smi $*"
case $* in *--loop*) sleep 100 & trap 'kill $!' EXIT TERM; wait ;; esac
END
PATH=$work/bin:$PATH
echo 'bvhbench 1' >"$work/version"
printf 'devices\n  0   Maker / Card / OpenCL 3.0\n' >"$work/devices"

# day STATUS ARGUMENT...: it ends with this status; what it asked its program is in `asked`.
day() {
    local expected=$1 status=0
    shift
    : >"$work/asked"
    "$tree/scripts/gpu-day" "$@" >"$said" 2>&1 || status=$?
    [ $status -eq "$expected" ] || fail "$*: exit status $status, not $expected"
}
asked() { # LINE...: these and no others, as far as the folder --out
    printf '%s\n' "$@" | sed '/^$/d' >"$work/expected"
    sed -i "s| *--out $work/tree/out/gpu-day.*||" "$work/asked"
    diff "$work/expected" "$work/asked" >>"$said" || fail 'other commands were run'
}
says() {
    grep -qE -- "$1" "$said" || fail "no line '$1'"
}
packed() { # FILE...: are in the archive now
    tar -tf "$tree/out/gpu-day.tar.zst" >"$work/packed"
    for file in "$@"; do
        grep -qx "gpu-day/$file" "$work/packed" || fail "$file is not packed"
    done
}

# All steps, in their order; none twice.
: >"$work/ends"
day 0
all=('run --quick' check run 'reproduce emc --max-prims 10M' 'reproduce volume --max-prims 10M'
    'reproduce ours --max-prims 10M' 'stress --quick')
asked "${all[@]}"
says '^ *8/8  stress         ok  '
grep -qx gpu-day/ours/out/results.json "$work/packed" || fail 'the archive is not made anew after each step'
packed machine/output machine/clocks.csv look/output look/out/results.json check/clocks.csv stress/done
tar -xOf "$tree/out/gpu-day.tar.zst" gpu-day/machine/output >"$work/machine"
grep -qx 'nvidia-smi -q' "$work/machine" || fail 'what nvidia-smi says is not kept'
grep -q 'Maker / Card' "$work/machine" || fail 'the devices are not kept'
tar -xOf "$tree/out/gpu-day.tar.zst" gpu-day/check/clocks.csv >"$work/clocks"
grep -q -- '--loop=1' "$work/clocks" || fail 'no clocks are kept'
day 0
asked
says '^ *2/8  look           ok, before '

# Wrong is done, and stays said; what failed, or crashed, is done again.
printf 'check 1\nemc 2\nours 139\n' >"$work/ends"
rm -r "$tree/out"
day 1
says '^ *3/8  check          WRONG .*check/output$'
says '^ *5/8  emc            refused '
says '^ *7/8  ours           FAILED 139 '
day 1
asked "${all[3]}" "${all[5]}"
says '^ *3/8  check          WRONG, before '
printf 'emc 2\n' >"$work/ends"
day 2 machine emc
asked "${all[3]}"

# Another program, device or setting: all again.
: >"$work/ends"
day 0 machine look # none of which is done again
asked
echo 'bvhbench 2' >"$work/version"
day 0 look
asked 'run --quick'
printf 'devices\n  0   Maker / Card 2 / OpenCL 3.0\n' >"$work/devices"
day 0 look
asked 'run --quick'
day 0 --device Card look
asked 'run --quick --device Card'
day 0 look
asked 'run --quick'
day 0 --quick look emc
asked 'reproduce emc --quick'

# Time that runs out: what was done is packed, the rest is named; then it goes on.
printf 'check slow\n' >"$work/ends"
rm -r "$tree/out"
day 0 --minutes 0.05 look check emc
asked 'run --quick' check
says '^ *2/3  check          cut off '
says '^gpu-day: not done: check emc; the same command goes on there$'
packed look/out/results.json check/output
: >"$work/ends"
day 0 look check emc
asked check "${all[3]}"

# Ctrl-C: the step ends as its program does, what there is is packed, nothing else begins.
printf 'check slow\n' >"$work/ends"
rm -r "$tree/out"
: >"$work/asked"
setsid "$tree/scripts/gpu-day" look check emc >"$said" 2>&1 &
child=$!
until grep -qs '^check' "$work/asked"; do sleep 0.1; done
kill -TERM "$child"
status=0
wait "$child" || status=$?
[ $status -eq 130 ] || fail "interrupted: exit status $status"
asked 'run --quick' check
says '^gpu-day: not done: check emc; the same command goes on there$'
packed look/out/results.json check/output

# What cannot be done is said in one line.
refused() { # TEXT ARGUMENT...
    local text=$1
    shift
    day 2 "$@"
    [ "$(wc -l <"$said")" -eq 1 ] && grep -qF -- "$text" "$said" || fail "$*: not one line with '$text'"
}
refused "no step 'sing'" sing
refused "unknown option '--fast'" --fast
refused "must be a number" --minutes soon
touch "$work/taken"
refused "cannot make the folder" --out "$work/taken/x"
(
    flock 9
    refused 'another gpu-day' look
) 9>"$tree/out/gpu-day/lock"
printf 'devices\n  none: install a driver\n' >"$work/devices"
refused 'no OpenCL device' look
echo "gpu_day: ok"
