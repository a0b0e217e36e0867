#!/usr/bin/env bash
# Whether all programs that were recorded are OpenCL C 1.2 (but for those with a fence, which came
# with 2.0), 2.0 and 3.0, the latter two with all features and extensions, generic address space
# included, for each target; and whether each device file was recorded: languages.sh SOURCE-FOLDER RECORDS
set -euo pipefail
export LC_ALL=C
source "$(dirname "$0")/programs.sh"
sources=$1 records=$2
find_clang || {
    echo "languages: skipped: $no_clang"
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

one() {
    local program=$1 version=$2 target=$3 cpu=${4-} log
    [ "$version" != 120 ] || ! needs_fence "$program" || return 0
    local options=(-x cl -target "$target" ${cpu:+-mcpu=$cpu} -nogpulib -fsyntax-only -w)
    options+=(-cl-std="CL${version:0:1}.${version:1:1}" -D__OPENCL_VERSION__="$version")
    [ "$version" = 120 ] || options+=(-Xclang -cl-ext=+all)
    # shellcheck disable=SC2046 # options are words
    log=$("clang-$clang" "${options[@]}" $(options_of "$program") "$program" 2>&1) || {
        echo "languages: ${program##*/}, OpenCL $version, $target $cpu: $log"
        return 1
    }
}
export -f one options_of needs_fence
export clang
for target in spir64 'amdgcn--amdhsa gfx90a' 'amdgcn--amdhsa gfx1030' nvptx64--nvidiacl; do
    for version in 120 200 300; do
        programs_in "$records" | sed "s/\$/ $version $target/"
    done
done | xargs -P 2 -L 1 bash -c 'one "$@"' one || status=1
echo "languages: $(programs_in "$records" | wc -l) programs, clang $clang"
exit $status
