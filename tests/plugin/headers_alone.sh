#!/usr/bin/env bash
# The headers that are installed are all that a plug-in needs: headers_alone.sh SOURCE HEADER...
# Each compiles by itself, in C and in C++, with nothing but the others on its path.
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
    echo "#include \"$header\"" | tee "$work/alone.c" >"$work/alone.cpp"
    "${CC:-cc}" -std=c11 -Wall -Wextra -Wpedantic -Werror -I"$work/include" -fsyntax-only "$work/alone.c"
    "${CXX:-c++}" -std=c++17 -Wall -Wextra -Wpedantic -Werror -I"$work/include" -fsyntax-only "$work/alone.cpp"
done
[ $# -gt 0 ] && echo "$# headers compile alone"
