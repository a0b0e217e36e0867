#!/usr/bin/env bash
# A name means one thing: no include guard is in two headers, and no public type is defined in two.
# Device code has variants of one type, chosen by the file that is included: of it only what the host
# shares is asked. names.sh SOURCE
set -euo pipefail
cd "$1"
export LC_ALL=C
headers=$(find framework traversal kernels builders scenes -name "*.h" | sort)
[ "$(wc -l <<<"$headers")" -gt 200 ] || { echo "only $(wc -l <<<"$headers") headers were found"; exit 1; }

# twice PATTERN WHAT GROUP: complains of each name that PATTERN finds, as its GROUP, in two headers.
bad=0
twice() {
    local names found name
    # shellcheck disable=SC2086
    found=$(sed -nE "s/$1/$3/p" $headers | wc -l)
    [ "$found" -gt 150 ] || { echo "only $found $2s were found"; exit 1; }
    # shellcheck disable=SC2086
    names=$(for header in $headers; do sed -nE "s/$1/$3/p" "$header" | sort -u; done | sort | uniq -d)
    for name in $names; do
        # shellcheck disable=SC2086
        echo "$2 $name is in $(grep -lE "(#ifndef|\}|typedef .*) ?\*?$name\b" $headers | tr '\n' ' ')"
        bad=1
    done
}
twice '^#ifndef (BB_[A-Z0-9_]+_(H|CLH))$' guard '\1'
twice '^(\} |typedef [^(]*[ *])(bb_[a-z0-9_]+)(;|\(.*)$' type '\2'
exit $bad
