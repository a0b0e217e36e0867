#!/usr/bin/env bash
# Whether all programs that were recorded are OpenCL C 1.2 (but for those with a fence, which came
# with 2.0), 2.0 and 3.0, the latter two with all features and extensions, generic address space
# included, for each target; and whether each device file was recorded: languages.sh SOURCE-FOLDER RECORDS
set -euo pipefail
export LC_ALL=C
source "$(dirname "$0")/programs.sh"
sources=$1 records=$2
find_clang 15 19 || {
    echo "languages: skipped: neither clang 15 nor 19 with its libclc is installed"
    exit 77
}
headers=$("clang-$clang" -print-resource-dir)/include
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

missing=$(comm -23 \
    <(find "$sources/kernels" "$sources/builders" -name '*.cl' -printf '%f\n' | sort) \
    <(programs_in "$records" | sed 's,.*/,,; s/-[0-9a-f]\{16\}\.cl$/.cl/' | sort -u) | xargs)
[ -z "$missing" ] || {
    echo "languages: let tests/isa/record.sh have programs built of these too: $missing"
    status=1
}

# The compiler takes many programs at once, but then the same options for all. So each program's own
# become its first lines.
programs_in "$records" | xargs awk -v work="$work" '
    FNR == 1 {
        close(program)
        name = FILENAME
        sub(/.*\//, "", name)
        program = work "/" name
        tracing = match($0, /BB_COUNTING=[01]/) ? substr($0, RSTART + RLENGTH - 1, 1) : "no"
        print program, tracing, index($0, "-cl-std=CL1.2") ? 120 : 200 >>(work "/list")
        for (i = 1; i <= NF; i++)
            if (sub(/^-D/, "", $i))
                print "#define " (sub(/=/, " ", $i) ? $i : $i " 1") >program
        print "#line 2" >program
        next
    }
    { print >program }'

# check TARGET CPU VERSION TRACING ...: programs of these kinds: `no` for those that do not trace, 0
# for those that do, 1 for those that count tests.
check() {
    local target=$1 cpu=$2 version=$3 log
    local options=(-triple "$target" ${cpu:+-target-cpu "$cpu"} -cl-std="CL${version:0:1}.${version:1:1}"
        -D__OPENCL_VERSION__="$version" -finclude-default-header -fdeclare-opencl-builtins
        -internal-isystem "$headers")
    [ "$version" = 120 ] || options+=(-cl-ext=+all)
    shift 3
    log=$(awk -v version="$version" -v kinds=" $* " \
        '$3 <= version && index(kinds, " " $2 " ") { print $1 }' "$work/list" |
        xargs -P 2 -n 32 "clang-$clang" -cc1 -fsyntax-only -w "${options[@]}" 2>&1) || {
        echo "languages: OpenCL $version, $target $cpu:" "${log//$work\//}"
        status=1
    }
}

# Of the kernels that trace, which are built in many variants, only 3.0 for the targets but SPIR-V,
# and not at all those that count tests.
for version in 120 200 300; do
    check spir64 '' $version no 0 1
    for target in 'amdgcn--amdhsa gfx90a' 'amdgcn--amdhsa gfx1030' 'nvptx64--nvidiacl '; do
        # shellcheck disable=SC2086 # a processor, or nothing
        check ${target% *} "${target#* }" $version no $([ $version != 300 ] || echo 0)
    done
done
[ "$(wc -l <"$work/list")" = "$(programs_in "$records" | wc -l)" ] || {
    echo "languages: not all programs were compiled"
    status=1
}
echo "languages: $(wc -l <"$work/list") programs, clang $clang"
exit $status
