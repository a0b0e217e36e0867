#!/usr/bin/env bash
# The headers that are installed are all that a plug-in needs: headers_alone.sh SOURCE HEADER...
# Each compiles by itself, in C and in C++, with nothing but the others on its path. Builders include no others (`embree` its
# library's names), and what lies beside them by its name alone, so that the same folder is a plug-in.
set -euo pipefail
source=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for header in "$@"; do
    mkdir -p "$work/include/$(dirname "$header")"
    cp "$source/$header" "$work/include/$header"
done
for header in "$@"; do
    printf '#include "%s"\nextern int alone;\n' "$header" | tee "$work/alone.c" >"$work/alone.cpp"
    "${CC:-cc}" -std=c11 -Wall -Wextra -Wpedantic -Werror -I"$work/include" -fsyntax-only "$work/alone.c"
    "${CXX:-c++}" -std=c++17 -Wall -Wextra -Wpedantic -Werror -I"$work/include" -fsyntax-only "$work/alone.cpp"
done
# The clock of phases is not a hook's to write.
printf '#include "framework/builder/builder.h"\nvoid lie(bb_phases *phases) { phases->outside_ms = 1e3; }\n' >"$work/lie.c"
if "${CC:-cc}" -std=c11 -I"$work/include" -fsyntax-only "$work/lie.c" 2>"$work/why"; then
    echo "a hook can write what is subtracted from its build's time"
    exit 1
fi
grep -q 'outside_ms' "$work/why"
for folder in "$source"/builders/*/; do
    name=$(basename "$folder")
    [ "$name" != common ] || continue
    grep -hoE '^#include "[^"]*/[^"]*"' "$folder"*.[ch] | cut -d '"' -f 2 | sort -u >"$work/included"
    printf '%s\n' "$@" | sort >"$work/installed"
    others=$(comm -23 "$work/included" "$work/installed" | tr '\n' ' ')
    [ "$name" != embree ] || others=${others//framework\/judge\/embree_api.h /}
    [ -z "$others" ] || { echo "the builder $name includes what is not installed: $others"; exit 1; }
done
[ $# -gt 0 ] && echo "$# headers compile alone"
