#!/usr/bin/env bash
# What bash offers after a part of a command line: completion.sh SOURCE PROGRAM
set -euo pipefail
source "$1/scripts/completion.bash"
PATH=$(dirname "$(realpath "$2")"):$PATH
COMP_WORDBREAKS=$' \t\n"\'><=;|&(:'
failed=0

# `expect LINE REPLY...`: the replies, in any order; `expect LINE +REPLY...`: at least these.
expect()
{
    COMP_LINE=$1 COMP_POINT=${#1}
    shift
    _bvhbench 2>"$noise"
    [[ ! -s $noise ]] || {
        echo "'$COMP_LINE' prints $(<"$noise")"
        failed=1
    }
    local wanted found
    found=$(printf '%s\n' "${COMPREPLY[@]}" | sort -u)
    if [[ ${1:-} == +* ]]; then
        for word in "${@#+}"; do
            grep -qxF -- "$word" <<<"$found" || {
                echo "'$COMP_LINE': no '$word' in:" $found
                failed=1
            }
        done
        return
    fi
    wanted=$(printf '%s\n' "$@" | sort -u)
    [[ $found == "$wanted" ]] || {
        echo "'$COMP_LINE':" $found "and not" $wanted
        failed=1
    }
}

[[ $(complete -p bvhbench) == *"-F _bvhbench bvhbench" ]] || { echo "nothing is registered"; exit 1; }
cd "$(mktemp -d)"
noise=$(mktemp)
trap 'rm -rf "$PWD" "$noise"' EXIT
touch room.glb

expect 'bvhbench ' +run +compare +merge +check +help +version +--help
expect 'bvhbench re' render report reproduce
expect 'bvhbench help ch' check
expect 'bvhbench list sc' scenes
expect 'bvhbench reproduce em' emc
expect 'bvhbench run --sc' --scene
expect 'bvhbench run --he' --help
expect 'bvhbench render --' +--show +--view +--out
expect 'bvhbench run --cam'
expect 'bvhbench run --scene cof' coffee
expect 'bvhbench run --scene roo' room.glb
expect 'bvhbench run --scene=cof' coffee
expect 'bvhbench run --scene spheres:n=9,cof' 9,coffee
expect 'bvhbench run --scene al' all
expect 'bvhbench run --builder lbvh,sa' lbvh,sah
expect 'bvhbench run --builder sah+rot' sah+rotate
expect 'bvhbench run --builder lbvh:bi' bits=
expect 'bvhbench run --builder sah:me' method=
expect 'bvhbench run --builder sah:method=' binned sweep
expect 'bvhbench run --builder sah:method=binned,bi' binned,bins=
expect 'bvhbench run --kernel stack4' stack4
expect 'bvhbench run --rays prim' primary
expect 'bvhbench run --metrics ep' epo epo_quick
expect 'bvhbench run --intersector exact,mo' exact,moeller
expect 'bvhbench run --quiet --sce' --scene
expect 'bvhbench report roo' room.glb
expect 'bvhbench compare --fo' --format
expect 'bvhbench compare --format ' text github markdown junit
expect 'bvhbench compare --format=gi' github
expect 'bvhbench run --handover l' levels
expect 'bvhbench slice --axis ' x y z
expect 'bvhbench compare roo' room.glb
expect 'bvhbench run --hist' --history
expect 'bvhbench run --sha' --shard
expect 'bvhbench report --history roo' room.glb
expect 'bvhbench merge --' --out --history --help
expect 'bvhbench nothing --x'
expect 'bvhbench run [ x'
expect 'bvhbench run --a/b=c'
exit $failed
