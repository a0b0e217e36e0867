#!/usr/bin/env bash
# The Debian package: package.sh BUILD. It is made and unpacked; its program, run from there, finds
# the scenes that it ships.
set -euo pipefail
command -v dpkg-shlibdeps >/dev/null || exit 77
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "package.sh: $1" >&2
    exit 1
}

cpack -G DEB --config "$build/CPackConfig.cmake" -B "$work/made" >"$work/log" 2>&1 ||
    fail "cpack: $(cat "$work/log")"
package=$(echo "$work"/made/bvhbench_*.deb)
[ -f "$package" ] || fail "no package: $(ls "$work/made")"
grep -q libembree <<<"$(dpkg-deb -f "$package" Depends)" || fail "does not depend on Embree"
grep -q 'pocl-opencl-icd | opencl-icd' <<<"$(dpkg-deb -f "$package" Recommends)" || fail "no OpenCL driver"
dpkg-deb -x "$package" "$work/root"
share=$work/root/usr/share
for file in doc/bvhbench/LICENSE bvhbench/table.schema.json bvhbench/scenes/data/{coffee,mountain,scorpion}.LICENSE.md; do
    [ -s "$share/$file" ] || fail "no $file"
done

rays() {
    "$work/root/usr/bin/bvhbench" rays --scene mountain --rays random --max-rays 100 \
        --out "$work/a.rays" >"$work/log" 2>&1
}
rays || fail "bvhbench rays: $(cat "$work/log")"
# If it is gone, no other takes its place: it was the package's.
rm "$share/bvhbench/scenes/data/mountain.glb"
! rays || fail "the scenes are not those of the package"
echo "package: ok"
