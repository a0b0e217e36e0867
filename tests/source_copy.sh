# Sourced by tests that look at the sources, or build them with a file more: starts such a test, called SOURCE BUILD.
# What git knows of SOURCE, or would, is copied to $work/tree, which becomes the working directory; the test is skipped where
# SOURCE is no git working tree.
set -euo pipefail
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail()
{
    echo "$(basename "$0"): $1" >&2
    exit 1
}

cd "$source"
git rev-parse --is-inside-work-tree >/dev/null 2>&1 || {
    echo "skipped: $source is no git working tree"
    exit 77
}
mkdir "$work/tree"
git ls-files -z --cached --others --exclude-standard |
    while IFS= read -r -d '' file; do [ -e "$file" ] && printf '%s\0' "$file"; done |
    tar --null -T - -cf - | tar -xf - -C "$work/tree"
cd "$work/tree"
