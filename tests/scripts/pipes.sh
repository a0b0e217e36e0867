#!/usr/bin/env bash
# No script pipes into a command that may end before it has read everything: pipes.sh SOURCE
# The writer then gets SIGPIPE, and with pipefail the pipe fails, but only now and then. Instead of
# `x | grep -q y` write `grep -q y < <(x)`, instead of `x | head -n 1` write `x | sed -n 1p`.
# Looks for head, grep -q, -m and -l, sed with q and awk with exit, wherever they stand in a pipe.
set -euo pipefail
cd "$1"
export LC_ALL=C
scripts=$(grep -lrE '^[^#]*pipefail' scripts tests .ci)
[ "$(wc -l <<<"$scripts")" -gt 20 ] || { echo "only $(wc -l <<<"$scripts") scripts were found"; exit 1; }
# after a pipe and whatever stands before the command's own name, such as LC_ALL=C or xargs
before='(^|[^|])\|&?[[:space:]]*([^|;&<>]*[[:space:]/({])?'
early="head([[:space:]]|\$|[;)}])"
early+='|[efz]?grep[[:space:]]([^|)]*[[:space:]])?(-[a-zA-Z]*[qml]|--(quiet|silent|max-count|files-with))'
early+="|sed[[:space:]][^|]*[0-9/;{ ]q[[:space:]]*(\$|[;}'\"])"
early+='|awk[[:space:]][^|]*exit'
bad=0
for script in $scripts; do
    # a pipe may go on in the next line; comments may name what is forbidden
    found=$(sed -E '/^[[:space:]]*#/d; :more; /(\||\\)[[:space:]]*$/ { N; s/\\?[[:space:]]*\n[[:space:]]*/ /; b more; }' "$script" |
        sed -E "s/\|\|/;/g" | grep -E "$before($early)" || true)
    [ -z "$found" ] || { echo "$script: $found"; bad=1; }
done
exit $bad
