#!/usr/bin/env bash
# The architecture as a rule: framework/README.md lists the layers from the bottom up, and no file includes
# anything of a layer above its own; nor do files include each other in a circle, a .c and its .h being one.
set -euo pipefail
cd "$1"
export LC_ALL=C
layers=$(sed -n 's/^| `\([a-z/]*\)\/` .*/\1/p' framework/README.md)
for folder in framework/* scenes traversal builders tracers kernels; do
    [ ! -d "$folder" ] || grep -qxF "$folder" <<<"$layers" || { echo "$folder is no layer of framework/README.md"; exit 1; }
done

# FILE INCLUDED, one per line. What is not there is another package's, or lies beside the file.
arrows=$(find framework traversal scenes builders tracers kernels -name '*.[ch]' -o -name '*.[ch]pp' |
    xargs grep -Ho '^#include "[^"]*"' | sed 's/:#include "/ /; s/"$//' | grep / || true)
[ "$(wc -l <<<"$arrows")" -gt 300 ] || { echo "only $(wc -l <<<"$arrows") includes were found"; exit 1; }

awk -v layers="$layers" '
    BEGIN { n = split(layers, name, "\n") }
    function layer(file,    i, found) { # the longest that the file lies in
        for (i = 1; i <= n; i++)
            if (index(file, name[i] "/") == 1 && (!found || length(name[i]) > length(name[found])))
                found = i
        return found
    }
    { from = layer($1); to = layer($2) }
    to > from { print $1 " includes " $2 ", which is of a layer above"; up++ }
    END { exit up > 0 }' <<<"$arrows"

# tsort complains of circles
sed -E 's/\.(c|h|cpp|hpp)( |$)/\2/g; s/_private//g' <<<"$arrows" | awk '$1 != $2' | tsort >/dev/null

for folder in framework/*/; do
    [ -f "${folder}README.md" ] || { echo "$folder has no README.md that says what may live there"; exit 1; }
done
