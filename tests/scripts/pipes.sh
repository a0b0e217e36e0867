#!/usr/bin/env bash
# No script pipes into a command that may end before it has read everything: pipes.sh SOURCE
# The writer then gets SIGPIPE, and with pipefail the pipe fails, but only now and then. Instead of
# `x | grep -q y` write `grep -q y < <(x)`, instead of `x | head -n 1` write `x | sed -n 1p`.
set -euo pipefail
cd "$1"
export LC_ALL=C
scripts=$(grep -lrE '^set -[a-z]*o pipefail' scripts tests .ci)
[ "$(wc -l <<<"$scripts")" -gt 20 ] || { echo "only $(wc -l <<<"$scripts") scripts were found"; exit 1; }
early='[^|]\|[[:space:]]*(head\b|grep([[:space:]]+-[^[:space:]]+)*[[:space:]]+-[a-zA-Z]*[qm])'
bad=0
for script in $scripts; do
    # a pipe may go on in the next line; comments may name what is forbidden
    found=$(sed -E '/^[[:space:]]*#/d; :more; /\|[[:space:]]*$/ { N; s/\n[[:space:]]*/ /; b more; }' "$script" |
        grep -E "$early" || true)
    [ -z "$found" ] || { echo "$script: $found"; bad=1; }
done
exit $bad
