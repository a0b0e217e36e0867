#!/usr/bin/env bash
# Has the mock GPU write down every program that bvhbench builds, by building and tracing with all
# that there is: record.sh BVHBENCH MOCK-LIBRARY FOLDER
#   FOLDER/FORM/N/         what command N built; FORM: cpu or gpu; or test: of both
#   FOLDER/trace/SPEC/     what kernel SPEC traces closest hits with, in the form for GPUs
#   FOLDER/spheres/SPEC/   the same of spheres alone, but for kernels that no simulation reads the
#                          code of: those of packets, and of rays in turns
#   FOLDER/march/KERNEL/   what kernel KERNEL marches through a volume with, likewise
# SPEC: each kernel of `list kernels`, and the variants that are for GPUs; with a stack of 32 where
# it has one of the tree's size.
set -euo pipefail
program=$1 library=$2 folder=$3
variants=(stack:persistent=yes stack8q:order=octant stack8q:order=octant,leaf=4)
rm -rf "$folder"
mkdir -p "$folder/logs"

# A line each: a place, then a command of bvhbench, or a test program, whose answers are other
# tests' matter.
commands() {
    local form handover trace kernel frame
    local searches="--search skip,octree,olbvh,octree:boundary=no,olbvh:boundary=no"
    for form in cpu gpu; do
        for handover in fence levels; do
            echo "$form/$handover check --form $form --handover $handover --builder all" \
                "--scene cube --scene tets:side=2 --side 6 --quiet"
        done
        echo "$form/arrays check --form $form --builder lobvh:levels=3,chains=keep,octree=arrays" \
            "--scene cube --side 6 --quiet"
        echo "$form/wide check --form $form --builder lbvh:arity=8,lbvh:arity=8,bits=63 --scene cube --side 6 --quiet"
        echo "$form/more check --form $form --builder presplit:method=priority+lbvh" \
            "--scene soup:n=50 --side 6 --quiet"
        trace="--form $form --builder lbvh --rays primary,ao --size 8x8 --max-rays 64 --repeats 1"
        trace+=" --no-pictures --charts no --quiet"
        echo "$form/mixed run $trace --scene blocks:side=2,mixed=yes --kernel all --metrics all" \
            "--out $folder/logs/mixed-$form"
        echo "$form/leaf run $trace --scene cube --kernel stack:leaf=4" \
            "--intersector all --out $folder/logs/leaf-$form"
        echo "$form/sorted run $trace --scene cube --kernel packet:sort=yes" \
            "--out $folder/logs/sorted-$form"
        echo "$form/volume volume --form $form --scene nbody:n=16 --scene tets:side=2 --size 8x8" \
            "--steps 1 $searches --repeats 1"
        echo "$form/slice slice --form $form --scene tets:side=2 --size 8x8 $searches --no-tree" \
            "--repeats 1"
        echo "$form/overlap overlap --form $form tets:side=2 tets:side=3 $searches" \
            "--no-tree --repeats 1"
        echo "$form/animate animate --form $form --scene twist:n=100,frames=3 --size 8x8" \
            "--max-rays 64 --repeats 1 --quiet --builder lbvh+refit:rotate=yes" \
            "--builder lbvh+refit:partial=2"
    done
    echo "test/points test_locate" # no command asks for points alone
    echo "test/faces test_locate_faces"
    for kernel in $("$program" list kernels --json | jq -r '.kernels[].name') "${variants[@]}"; do
        frame="--builder lbvh --kernel $kernel,stack=32 --rays primary --size 8x8 --repeats 1"
        frame+=" --no-pictures --charts no --quiet"
        echo "trace/$kernel run --form gpu --scene cube $frame --out $folder/logs/$kernel"
        [[ $kernel = packet* || $kernel = stack8i ]] && continue
        echo "spheres/$kernel run --form gpu --scene spheres:n=100 $frame" \
            "--out $folder/logs/spheres-$kernel"
        [[ $kernel = *:* ]] ||
            echo "march/$kernel volume --form gpu --scene nbody:n=16 --builder lbvh" \
                "--kernel $kernel,stack=32 --size 8x8 --steps none --repeats 1 --quiet"
    done
}

one() {
    local place=$1
    local log=$folder/logs/${place//\//-}.log
    shift
    mkdir -p "$folder/$place"
    # The form for GPUs is recorded on a mock GPU, since programs are told what the device is. Kernels
    # by themselves are recorded on a CPU, which refuses none of them.
    local device=cpu
    [[ $place != gpu/* ]] || device=gpu
    local recorded=(env MOCK_GPU_DEVICES=$device MOCK_GPU_FENCE=cl3 MOCK_GPU_RECORD="$folder/$place"
        LD_PRELOAD="$library")
    case $1 in
    test_*) recorded+=(BVHBENCH_TEST_SMALL=1 "$(dirname "$library")/$1") && shift ;;
    *) recorded+=("$program") ;;
    esac
    "${recorded[@]}" "$@" >"$log" 2>&1 || {
        grep -q 'drop stack=' "$log" || return 0
        "${recorded[@]}" "${@/[:,]stack=32/}" >"$log" 2>&1 || true
    }
}
export -f one
export program library folder
commands | sed 's/\(--kernel [a-z0-9]*\),stack/\1:stack/' |
    xargs -P 2 -I LINE bash -c 'one LINE'
