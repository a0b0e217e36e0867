#!/usr/bin/env bash
# The library shows what the public headers declare, and nothing besides: exported.sh LIBRARY SOURCE HEADER...
# The program's entry, bb_main, is the one name more.
set -euo pipefail
export LC_ALL=C
library=$1 source=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

nm -D --defined-only "$library" | awk '{print $3}' | sort -u >"$work/exported"

# What is declared at the top level: functions without a body, and extern data. Bodies and structs go first, from the
# innermost; macros and comments are gone by then, and pragmas.
printf '#include "%s"\n' "$@" >"$work/all.c"
"${CC:-cc}" -E -P -I"$source" "$work/all.c" | grep -v '^#' | tr '\n' ' ' | sed -E ':again; s/\{[^{}]*\}/ BODY /; t again' |
    sed 's/BODY/;/g' | tr ';' '\n' >"$work/declarations"
{
    sed -nE 's/^[^(]*\b(bb_[a-z0-9_]+)\(.*\).*/\1/p' "$work/declarations" >"$work/functions"
    # static inline functions, whose body was cut off, are no part of the library
    sed -nE '/\binline\b/s/^[^(]*\b(bb_[a-z0-9_]+)\(.*/\1/p' "$work/declarations" | sort -u >"$work/inline"
    sort -u "$work/functions" | comm -23 - "$work/inline"
    sed -nE '/^ *extern [^(]*$/s/.*\b(bb_[a-z0-9_]+)(\[[0-9]*\])* *$/\1/p' "$work/declarations"
    echo bb_main
} | sort -u >"$work/declared"

[ "$(wc -l <"$work/declared")" -gt 50 ] || { echo "only $(wc -l <"$work/declared") declarations were found"; exit 1; }
missing=$(comm -13 "$work/exported" "$work/declared" | tr '\n' ' ')
besides=$(comm -23 "$work/exported" "$work/declared" | tr '\n' ' ')
[ -z "$missing" ] || { echo "declared in a public header, not exported: $missing"; exit 1; }
[ -z "$besides" ] || { echo "exported, not declared in a public header: $besides"; exit 1; }
echo "$(wc -l <"$work/exported") names are exported"
