#!/usr/bin/env bash
# Runs test programs, on small inputs, under oclgrind, which finds out-of-bounds accesses, data races, uninitialised reads and divergent
# barriers. It exits 0 even so: its log must be empty. Usage: run.sh FOLDER FLAGS PROGRAM...
# (--uninitialized takes buffers that were filled by clEnqueueFillBuffer for uninitialised: not for programs that do that)
set -u
folder=$1
read -r -a flags <<<"$2"
shift 2
if ! command -v oclgrind >/dev/null; then
    echo "skipped: oclgrind is not installed (scripts/setup test)"
    exit 77
fi
mkdir -p "$folder"
status=0
for program in "$@"; do
    log=$folder/$(basename "$program").log
    rm -f "$log"
    if ! BVHBENCH_TEST_SMALL=1 oclgrind "${flags[@]}" --log "$log" "$program" \
        >"$log.out" 2>&1; then
        tail -n 20 "$log.out"
        status=1
    fi
    if [ -s "$log" ]; then
        head -n 40 "$log"
        status=1
    fi
done
exit $status
