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
status=0

missing=$(comm -23 \
    <(find "$sources/kernels" "$sources/builders" -name '*.cl' -printf '%f\n' | sort) \
    <(programs_in "$records" | sed 's,.*/,,; s/-[0-9a-f]\{16\}\.cl$/.cl/' | sort -u) | xargs)
[ -z "$missing" ] || {
    echo "languages: let tests/isa/record.sh have programs built of these too: $missing"
    status=1
}

# one PROGRAM: in all versions for all targets. Of the kernels that trace, which are built in many
# variants, only 3.0 for the targets but SPIR-V, and not at all those that count tests.
one() {
    local program=$1 first target version log status=0
    first=$(head -n 1 "$program")
    # shellcheck disable=SC2046 # options are words
    set -- $(options_of "$program")
    for target in spir64 'amdgcn--amdhsa -mcpu=gfx90a' 'amdgcn--amdhsa -mcpu=gfx1030' \
        nvptx64--nvidiacl; do
        for version in 120 200 300; do
            [ $version != 120 ] || [[ $first == *-cl-std=CL1.2* ]] || continue
            case $first in
            *BB_COUNTING=1*) [ "$target" = spir64 ] || continue ;;
            *BB_COUNTING=0*) [ "$target" = spir64 ] || [ $version = 300 ] || continue ;;
            esac
            local features=()
            [ $version = 120 ] || features=(-Xclang -cl-ext=+all)
            # shellcheck disable=SC2086 # a target is words
            log=$("clang-$clang" -x cl -target $target -nogpulib -fsyntax-only -w "${features[@]}" \
                -cl-std="CL${version:0:1}.${version:1:1}" -D__OPENCL_VERSION__=$version \
                "$@" "$program" 2>&1) || {
                echo "languages: ${program##*/}, OpenCL $version, $target: $log"
                status=1
            }
        done
    done
    return $status
}
export -f one options_of
export clang
programs_in "$records" | xargs -P 2 -L 1 bash -c 'one "$@"' one || status=1
echo "languages: $(programs_in "$records" | wc -l) programs, clang $clang"
exit $status
