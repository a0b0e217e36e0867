#!/usr/bin/env bash
# Builds the program with what somebody may drop into its sources, each a file or folder more: a
# metric (metric/dropped_in.c), a builder from scripts/new-builder, and one of several device files
# that takes triangles only (plugin/strips): dropped_in.sh SOURCE BUILD FOLDER
# Tests look at what becomes of it (plugin/one_folder.sh, metric/one_file.sh). FOLDER gets tree and
# build; nothing without BVHBENCH_SLOW_TESTS.
folder=$3
rm -rf "$folder"
if [ -z "${BVHBENCH_SLOW_TESTS-}" ]; then
    echo "dropped in: not built without BVHBENCH_SLOW_TESTS"
    exit 0
fi
. "$(dirname "$0")/source_copy.sh"

scripts/new-builder my-tree >/dev/null
cp -r tests/plugin/strips builders/strips
rm builders/strips/CMakeLists.txt
cp tests/metric/dropped_in.c framework/builder/metric_dropped_in.c
generator=$(grep '^CMAKE_GENERATOR:' "$build/CMakeCache.txt" | cut -d= -f2)
mkdir -p "$folder"
mv "$work/tree" "$folder/tree"
cd "$folder/tree"
cmake -S . -B "$folder/build" -G "$generator" -DCMAKE_BUILD_TYPE=None -DBVHBENCH_TESTS=ON >"$work/log" 2>&1 &&
    cmake --build "$folder/build" -j 2 --target bvhbench-program test_no_stack >"$work/log" 2>&1 ||
    fail "build: $(tail -5 "$work/log")"
echo "dropped in: built"
