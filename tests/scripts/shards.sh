#!/usr/bin/env bash
# Shards of a run have each of its cells, none twice, and are merged into it: shards.sh PROGRAM
set -euo pipefail
program=$1
cd "$(mktemp -d)"
trap 'rm -rf "$PWD"' EXIT
fail() {
    echo "FAILED: $1"
    exit 1
}
arguments=(--scene sphere-mesh:n=8,cube --builder lbvh,sah --kernel stack,stack8 --rays primary,random:count=500,ao
    --size 16x16 --repeats 1 --charts no --quiet)
common=(--charts no --quiet --repeats 1)
planned() { # FILE
    jq -r '.rows[] | select(.planned_cells) | "\(.planned_sets) ray sets, \(.planned_cells) cells"' "$1"
}
cells() { # FILE...: keys of traces, and of builds that were measured
    jq -r '.rows[] | select(.unmeasured != "yes") | .cell // empty' "$@" | sort
}
exact() { # FILE: all that neither a clock decides nor the order of turns (whoever is judged first has a ray arbitrated), by cell
    jq -S '([.columns[] | select(.sense == "timed") | .name] + ["unlike_whom", "arbitrated"]) as $timed
        | [.rows[] | select(.builder) | del(.[$timed[]])] | sort_by(.scene, .question, .view, .builder, .kernel, .maker)' "$1"
}

"$program" run "${arguments[@]}" --out whole >/dev/null
for count in 3 13; do
    for ((i = 1; i <= count; i++)); do
        "$program" run "${arguments[@]}" --shard "$i/$count" --out "shard-$count-$i" >/dev/null
    done
    cells "shard-$count-"*/results.json >shards.txt
    cells whole/results.json | diff - shards.txt >&2 || fail "$count shards have other cells than the run"
    [ -z "$(uniq -d shards.txt)" ] || fail "cells are in two of $count shards"
    "$program" merge "shard-$count-"* --out "merged-$count" --history bench.db >/dev/null || fail "$count shards are not merged"
    cells "merged-$count/results.json" | diff - shards.txt >&2 || fail "$count shards merged have other cells"
    diff <(planned whole/results.json) <(planned "merged-$count/results.json") >&2 || fail "$count shards merged have another plan"
    diff <(exact whole/results.json) <(exact "merged-$count/results.json") >&2 || fail "$count shards merged have other figures"
    jq -e 'all(.rows[]; .unmeasured != "yes" and .shard == null and .shard_of == null)
        and ([.rows[] | .shards // empty] | length == 1 and (.[0] | split("; ") | length) == '"$count)" \
        "merged-$count/results.json" >/dev/null || fail "$count shards: the context, or a build that nobody measured"
    # each trace has its own scene's build
    jq -e '[.rows[] | select(.status) | select(.question | not)] as $builds
        | all(.rows[] | select(.status == "ok" and .question); . as $trace | any($builds[]; .status == "ok" and .scene == $trace.scene
        and .builder == $trace.builder and .run == ($trace.tree_run // $trace.run)))' "merged-$count/results.json" >/dev/null || fail "a trace has another's build"
    [ "$(find "merged-$count" -name '*.png' | wc -l)" -eq "$(find whole -maxdepth 1 -name '*.png' | wc -l)" ] || fail "pictures are missing"
    grep -q 'nothing is worse' <<<"$("$program" compare whole "merged-$count")" || fail "the merged run is worse"
done
grep -qE 'Z +2 +[0-9]+ ' <<<"$("$program" report --history bench.db --out page.html)" || fail "the merged runs are not in the history"

# A shard's own interleaved cells: all builders of a ray set are together.
jq -r '.rows[] | select(.question) | .cell // empty' shard-3-2/results.json | sed 's,/builder=.*,,' | sort | uniq -c | awk '{ print $1 }' | sort -u >counts.txt
[ "$(wc -l <counts.txt)" -eq 1 ] && [ "$(cat counts.txt)" -ge 4 ] || fail "a ray set is torn apart"

# Builds alone, and the default comparison's second part, too.
"$program" run --scene cube,sphere-mesh:n=8 --builder lbvh,sah --rays none --out builds "${common[@]}" >/dev/null
for i in 1 2; do
    "$program" run --scene cube,sphere-mesh:n=8 --builder lbvh,sah --rays none --shard $i/2 --out builds-$i "${common[@]}" >/dev/null
done
diff <(cells builds/results.json) <(cells builds-[12]/results.json) >&2 || fail "builds"
# One cell by its key, in one shard of two.
key=$(jq -r '[.rows[] | select(.question) | .cell // empty][3]' whole/results.json)
for i in 1 2; do
    "$program" run --cell "$key" --shard $i/2 --out key-$i "${common[@]}" >/dev/null
done
[ "$(cells key-[12]/results.json | grep -cxF "$key")" -eq 1 ] || fail "the cell is measured in both shards or in none"

# What cannot be merged is refused in a line; what is missing is said.
refused() { # WORDS ARGUMENT...
    local words=$1 status=0
    shift
    "$program" "$@" >out.txt 2>err.txt || status=$?
    [ $status -eq 2 ] && [ "$(wc -l <err.txt)" -eq 1 ] && grep -qF -- "$words" err.txt || fail "$*: exit $status, $(cat err.txt)"
}
refused 'is given twice' merge shard-3-1 shard-3-1/results.json --out bad
refused 'is no shard' merge shard-3-1 whole --out bad
refused 'is one of 3 shards' merge shard-3-1 shard-13-2 --out bad
cp -r shard-3-1 copy
refused 'are both shard 1' merge shard-3-1 copy --out bad
jq '(.rows[] | select(.revision)).shard = "2/3"' shard-3-1/results.json >copy/results.json
refused 'is in two of the files' merge shard-3-1 copy --out bad
"$program" run "${arguments[@]/stack,stack8/stack}" --shard 2/3 --out other >/dev/null
refused 'made with the same options' merge shard-3-1 other --out bad
jq '(.rows[] | select(.revision)).revision = "other"' shard-3-2/results.json >copy/results.json
refused 'have the same revision' merge shard-3-1 copy --out bad
jq '(.rows[] | select(.revision)).shard = "4/3"' shard-3-2/results.json >copy/results.json
refused 'must be I/N' merge shard-3-1 copy --out bad
refused '--out DIR says' merge shard-3-1 shard-3-2
for shard in 0/3 4/3 3 a/b 1/0 -1/2 1/2/3; do
    refused 'must be I/N' run --shard "$shard" "${arguments[@]}" --out bad
done
status=0
"$program" merge shard-3-1 shard-3-3 --out part >/dev/null 2>err.txt || status=$?
[ $status -eq 1 ] && grep -qx 'bvhbench: shard 2 of 3 is missing' err.txt || fail "a missing shard: exit $status, $(cat err.txt)"
echo ok
