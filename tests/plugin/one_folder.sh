#!/usr/bin/env bash
# The plug-in rule: a new builder is one new folder, and no other file is touched: one_folder.sh SOURCE BUILD FOLDER (of dropped_in.sh)
# 1. No file of the harness names a builder, but for papers, whose experiments are about theirs; planted lines show that it would be seen. 2. scripts/new-builder adds one folder and nothing else, and what it makes
# compiles. 3. With BVHBENCH_SLOW_TESTS set: built with it (dropped_in.sh), and with a builder of several device files that takes
# triangles only, the program lists and checks both; and a test that walks the registry skips what a builder does not take.
. "$(dirname "$0")/../source_copy.sh"

comment='^[^:]+:[0-9]+: *(\*|/\*|//|# )'
# "embree" is the oracle and a kernel too, "null" a word of JSON, "olbvh" a layout and a search: only as specifications they say something. "sah" is a metric, whose
# name stands in its file.
metric='^framework/builder/metric_sah\.c:[^"]*"sah"[^"]*$'

# Prints the lines of the harness that name the builder $1: its symbol, its folder, or its name as a word of any text between quotes.
lines_that_name()
{
    local name=$1 pattern
    pattern="bb_builder_${name//-/_}\\b|builders/$name\\b"
    case $name in
    embree | null | olbvh) pattern="$pattern|\"([^\"]*[^a-z0-9_-])?$name[:+]" ;;
    *) pattern="$pattern|\"([^\"]*[^a-z0-9_-])?$name([^a-z0-9_-][^\"]*)?\"" ;;
    esac
    grep -rnE "$pattern" CMakeLists.txt cmake framework traversal kernels scenes \
        --include='*.c' --include='*.h' --include='*.cpp' --include='*.hpp' --include='*.cl' --include='*.clh' \
        --include='*.json' --include='*.js' --include='CMakeLists.txt' --include='*.cmake' --exclude-dir=papers |
        grep -vE "$comment" | sed 's#/\*.*##' | grep -E "$pattern" | grep -vE "$metric" || true
}

for folder in builders/*/; do
    name=$(basename "$folder")
    [ -f "builders/$name/$name.c" ] || continue
    lines_that_name "$name" >"$work/found"
    [ ! -s "$work/found" ] || fail "the harness names the builder $name: $(head -1 "$work/found")"
done

# Whether it would be seen: each line planted by itself, in a file of its kind.
planted()
{
    printf '%s\n' "$3" >"$2"
    lines_that_name "$1" >"$work/found"
    rm "$2"
    [ "$(cut -d: -f1 "$work/found" | sort -u)" = "$4" ] || fail "'$3' names $1: $5"
}
sees() { planted "$1" "$2" "$3" "$2" "not seen"; }
lets() { planted "$1" "$2" "$3" "" "it does not"; }
code=framework/cli/planted.c axis=framework/stress/axes/planted.json
sees lbvh $code 'static const char *usual = "vlbvh,lbvh";'
sees vlbvh $code 'static const char *usual = "vlbvh,lbvh";'
sees vlbvh $code 'puts(" builders other than vlbvh get the boxes");'
sees refit $code '"lbvh, lbvh+refit."'
sees loose-bvh $code 'find("loose-bvh");'
sees sah $code 'strncmp(text, "sah", 3)'
sees sah $code 'bb_names_add(&names, "sah:method=sweep");'
sees embree $code '"lbvh,embree:quality=low"'
sees lbvh $code '#include "builders/lbvh/x.h"'
sees gs $code 'extern const bb_builder bb_builder_gs;'
sees lbvh $axis '{"builder": "lbvh"}'
lets lbvh $code 'char label[48]; /* such as "lbvh#2" */'
lets lbvh $code ' * as in "lbvh", lbvh:bits=63'
lets lbvh $code 'puts("vlbvh, lbvhs, not-lbvh");'
lets embree $code 'put("embree", version);'

find . -type f -exec sha256sum {} + | sort -k 2 >"$work/before"
scripts/new-builder my-tree >/dev/null
find . -type f -exec sha256sum {} + | sort -k 2 >"$work/after"
added=$(diff "$work/before" "$work/after" | grep '^[<>]' | awk '{print $1, $3}' || true)
[ "$added" = "$(printf '> ./builders/my-tree/my-tree.c\n> ./builders/my-tree/my-tree.cl')" ] ||
    fail "new-builder touched more than builders/my-tree: $added"
scripts/new-builder your-tree --out "$work/plugin" >/dev/null
[ "$(ls "$work/plugin")" = "$(printf 'CMakeLists.txt\nyour-tree.c\nyour-tree.cl')" ] ||
    fail "new-builder --out made $(ls "$work/plugin")"
"${CC:-cc}" -std=c11 -Wall -Wextra -Wpedantic -Werror -I. -fsyntax-only builders/my-tree/my-tree.c ||
    fail "what new-builder makes does not compile"
for bad in '' Upper all common embree-native my-tree ../x 'a b'; do
    set +e
    scripts/new-builder "$bad" >"$work/out" 2>"$work/errors"
    status=$?
    set -e
    [ $status -eq 2 ] && [ "$(wc -l <"$work/errors")" -eq 1 ] ||
        fail "new-builder '$bad': exit status $status, $(cat "$work/errors")"
done

if [ -n "${BVHBENCH_SLOW_TESTS-}" ]; then
    dropped=$3
    [ -x "$dropped/build/bvhbench" ] || fail "$dropped/build is not built: run dropped_in.sh first"
    for builder in my-tree strips; do
        grep -q "^ *$builder " <<<"$("$dropped/build/bvhbench" list builders)" || fail "list does not show $builder"
        "$dropped/build/bvhbench" check --builder "$builder" --scene cube >"$work/log" 2>&1 ||
            fail "check: $(cat "$work/log")"
    done
    "$dropped/build/tests/test_no_stack" >"$work/log" 2>&1 || fail "test_no_stack with a triangle-only builder: $(tail -5 "$work/log")"
    grep -q '^skipped: strips: ' "$work/log" || fail "test_no_stack does not say that it skips strips"
    for builder in strips clash; do
        mkdir "builders/$builder"
        cp tests/plugin/strips/strips.c "builders/$builder/$builder.c"
        cp tests/plugin/strips/strips.clh "builders/$builder/"
    done
    ! cmake -S . -B "$work/build" >"$work/log" 2>&1 || fail "two device files of one name were taken"
    grep -q 'two device files of one name' "$work/log" || fail "clash: $(tail -5 "$work/log")"
fi
echo "one folder: ok"
