#!/usr/bin/env bash
# The out-of-tree plug-in against an installed bvhbench: installed.sh SOURCE BUILD
# Installs BUILD into a temporary prefix, builds a copy of tests/plugin/median with nothing but that, and has the installed
# program list, check and run it; then the same for what new-builder makes. At last the installation is moved.
set -euo pipefail
source=$1 build=$2
work=$(realpath "$(mktemp -d)")
trap 'rm -rf "$work"' EXIT

fail()
{
    echo "installed.sh: $1" >&2
    exit 1
}

cmake --install "$build" --prefix "$work/prefix" >"$work/log" || fail "install: $(tail -1 "$work/log")"
program=$work/prefix/bin/bvhbench
[ -x "$program" ] || fail "no bin/bvhbench was installed"
[ -f "$work/prefix/share/bash-completion/completions/bvhbench" ] || fail "no completion was installed"

# Builds the builder in folder $1 against the prefix; $1/build/$2.so comes out.
build_plugin()
{
    cmake -S "$1" -B "$1/build" -DCMAKE_PREFIX_PATH="$work/prefix" >"$work/log" 2>&1 &&
        cmake --build "$1/build" >"$work/log" 2>&1 || fail "building $2: $(cat "$work/log")"
    [ -f "$1/build/$2.so" ] || fail "$2.so did not come out"
    grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Release$' "$1/build/CMakeCache.txt" || fail "$2 is not optimised"
}

check_plugin()
{
    "$program" list builders --plugin "$1/build/$2.so" >"$work/log" || fail "list with $2"
    grep -q "^ *$2 " "$work/log" || fail "list does not show $2"
    "$program" check --plugin "$1/build/$2.so" --builder "$2" --scene cube --scene single \
        >"$work/log" 2>&1 || fail "check of $2: $(cat "$work/log")"
    grep -q "^ok .* $2 " "$work/log" || fail "check does not speak of $2: $(cat "$work/log")"
}

cp -r "$source/tests/plugin/median" "$work/median"
build_plugin "$work/median" median
check_plugin "$work/median" median
"$program" run --plugin "$work/median/build/median.so" --builder median --scene cube --rays primary \
    --size 32x32 --repeats 2 --out "$work/out" --quiet >"$work/log" 2>&1 ||
    fail "run with median: $(tail -5 "$work/log")"
grep -q '"builder":[[:space:]]*"median"' "$work/out/results.json" || fail "results.json has no row of median"

# Several device files, and headers that they share.
cp -r "$source/tests/plugin/strips" "$work/strips"
build_plugin "$work/strips" strips
check_plugin "$work/strips" strips

# Two plug-ins whose device files have the same names are not loaded together.
mkdir "$work/other"
cp "$work"/strips/*.cl "$work"/strips/*.clh "$work"/strips/*.h "$work/other/"
sed 's/bb_builder_strips/bb_builder_other/; s/"strips"/"other"/' "$work/strips/strips.c" >"$work/other/other.c"
sed 's/strips/other/g' "$work/strips/CMakeLists.txt" >"$work/other/CMakeLists.txt"
build_plugin "$work/other" other
check_plugin "$work/other" other
set +e
"$program" list builders --plugin "$work/strips/build/strips.so" --plugin "$work/other/build/other.so" \
    >"$work/log" 2>"$work/errors"
status=$?
set -e
[ $status -eq 2 ] && grep -q 'builder other: there is a device file strips.cl already' "$work/errors" ||
    fail "two device files of one name: exit status $status, $(cat "$work/errors")"

# What the installed new-builder makes is a plug-in as it stands, compiled with the tree's flags.
"$work/prefix/bin/bvhbench-new-builder" my-tree --out "$work/my-tree" >/dev/null
build_plugin "$work/my-tree" my-tree
check_plugin "$work/my-tree" my-tree
cmake -S "$work/my-tree" -B "$work/my-tree/build" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >"$work/log"
for flag in -Wall -Wextra -Wpedantic -ffp-contract=off -std=c11 -D_GNU_SOURCE -fvisibility=hidden; do
    grep -q -e " $flag " "$work/my-tree/build/compile_commands.json" || fail "plug-ins are compiled without $flag"
done

# find_package holds to the version: the same minor one, not a later one.
version=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")
minor=${version%.*}
for wanted in "$minor" "${minor%.*}.$((${minor#*.} + 1))"; do
    mkdir "$work/version-$wanted"
    printf 'cmake_minimum_required(VERSION 3.22)\nproject(version LANGUAGES C)\nfind_package(bvhbench %s REQUIRED)\n' \
        "$wanted" >"$work/version-$wanted/CMakeLists.txt"
    found=yes
    cmake -S "$work/version-$wanted" -B "$work/version-$wanted/build" -DCMAKE_PREFIX_PATH="$work/prefix" \
        >"$work/log" 2>&1 || found=no
    [ "$wanted" = "$minor" ] && expected=yes || expected=no
    [ "$found" = "$expected" ] || fail "find_package(bvhbench $wanted), version $version: found: $found"
done

# What is no plug-in: exit status 2 and one line.
set +e
"$program" list --plugin "$source/CMakeLists.txt" >"$work/log" 2>"$work/errors"
status=$?
set -e
[ $status -eq 2 ] || fail "exit status $status instead of 2 for a plug-in that is none"
[ "$(wc -l <"$work/errors")" -eq 1 ] || fail "more than one line: $(cat "$work/errors")"

# A shipped scene comes from the installation itself, also after that was moved: with the file it is read, without it the
# message names the place, and the source tree's copy is not taken instead.
mv "$work/prefix" "$work/moved"
program=$work/moved/bin/bvhbench
scene=$(find "$work/moved" -name mountain.glb)
[ -n "$scene" ] || fail "no shipped scene was installed"
check_mountain()
{
    env -u BVHBENCH_SCENES "$program" check --builder null --scene mountain >"$work/log" 2>"$work/errors"
}
check_mountain || fail "a shipped scene of a moved installation: $(cat "$work/errors")"
mv "$scene" "$work/elsewhere.glb"
set +e
check_mountain
status=$?
set -e
[ $status -ne 0 ] && grep -qF "$work/moved/" "$work/errors" ||
    fail "exit status $status without the shipped scene: $(cat "$work/errors")"
echo "installed plug-in: ok"
