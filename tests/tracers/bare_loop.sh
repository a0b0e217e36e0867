#!/usr/bin/env bash
# What the adapters to tinybvh and madmann91/bvh cost beside a bare loop (bare_loop.cpp), after
# scripts/peers has built them: tests/tracers/bare_loop.sh TINYBVH_DIR MADMANN91_DIR [SCENE...]
# A measurement, for a quiet machine: no test.
set -euo pipefail
cd "$(dirname "$0")/../.."
tinybvh=$1 madmann91=$2
shift 2
scenes=("$@")
[ $# -gt 0 ] || scenes=(coffee interior:n=200000)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=build/peers/bvhbench
for peer in tinybvh madmann91; do
    [ -f "build/peers/$peer.so" ] || {
        echo "bare_loop: build/peers/$peer.so is not there: run scripts/peers first" >&2
        exit 2
    }
    c++ -std=c++20 -O3 -march=native -DBARE_${peer^^} -I"$prefix/include/bvhbench" -I"$tinybvh" \
        -I"$madmann91/src" tests/tracers/bare_loop.cpp -o "$work/$peer" -L"$prefix/lib" -lbvhbench \
        -Wl,-rpath,"$PWD/$prefix/lib" -ldl -lpthread
done
for scene in "${scenes[@]}"; do
    for rays in primary diffuse; do
        build/release/bvhbench rays --scene "$scene" --rays $rays --size 512x512 --max-rays 262144 \
            --out "$work/rays" >/dev/null
        echo "$scene, $rays"
        "$work/tinybvh" build/peers/tinybvh.so "$work/rays" tinybvh:layout=bvh8
        "$work/madmann91" build/peers/madmann91.so "$work/rays" madmann91:quality=high,mode=robust
    done
done
