#!/usr/bin/env bash
# Whether kernels/isa.tsv, as `list kernels --isa` prints it, has a row of each kernel for each
# version of clang in it: rows.sh BVHBENCH
set -euo pipefail
table=$("$1" list kernels --isa)
versions=$(awk '/^[0-9]/ { print $1 }' <<<"$table" | sort -u)
status=0
for version in ${versions:?no version of clang has rows}; do
    for kernel in $("$1" list kernels --json | jq -r '.kernels[].name'); do
        awk -v version="$version" -v kernel="$kernel" \
            '$1 == version && $2 == kernel && $3 == "trace" { found = 1 } END { exit !found }' \
            <<<"$table" || {
            echo "rows: kernel $kernel has no row for clang $version: scripts/isa --write --clang $version"
            status=1
        }
    done
done
for refused in 'list --isa' 'list builders --isa' 'list kernels --isa --json'; do
    code=0
    # shellcheck disable=SC2086 # words
    "$1" $refused >/dev/null 2>&1 || code=$?
    [ $code -eq 2 ] || {
        echo "rows: bvhbench $refused: exit status $code, not 2"
        status=1
    }
done
exit $status
