#!/usr/bin/env bash
# The papers that methods name: `list --bibtex` as BibTeX reads it, and `list --json` beside it.
#   bibtex.sh PROGRAM PLUGIN     PLUGIN.so has a NAME.bib with an entry of its own and one that it includes
set -euo pipefail
program=$1 plugin=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
    echo "bibtex.sh: $1" >&2
    exit 1
}

# Entries by counting braces; fields from the lines NAME = {VALUE}.
parse() {
    awk '
        { for (i = 1; i <= length($0); i++) { c = substr($0, i, 1); depth += (c == "{") - (c == "}")
              if (depth < 0) { print "more } than {" > "/dev/stderr"; bad = 1; exit } } }
        /^@/ { if (open) { print "entry " key " does not end" > "/dev/stderr"; bad = 1 }
            open = 1; key = $0; sub(/^@[a-z]+\{/, "", key); sub(/,$/, "", key); type = $0; sub(/^@/, "", type); sub(/\{.*/, "", type)
            print key "\ttype\t" type }
        /^  [a-z]+ = \{.*\},?$/ { name = $1; value = $0; sub(/^[^{]*\{/, "", value); sub(/\},?$/, "", value); print key "\t" name "\t" value }
        /^}$/ && depth == 0 { open = 0 }
        END { exit bad || depth != 0 || open }' "$1"
}
"$program" list --bibtex >"$work/all.bib"
parse "$work/all.bib" >"$work/fields" || fail "list --bibtex: braces do not match"
[ "$(grep -c "	type	" "$work/fields")" -ge 40 ] || fail "too few papers: $(grep -c "	type	" "$work/fields")"
twice=$(cut -f 1,2 "$work/fields" | sort | uniq -d)
[ -z "$twice" ] || fail "keys or fields are there twice: $twice"
declare -A venue=([article]=journal [inproceedings]=booktitle [techreport]=institution [mastersthesis]=school [misc]=howpublished)
while IFS=$'\t' read -r key _ type; do
    for field in author title year "${venue[$type]-no-such-type}"; do
        grep -qF "$key	$field	" "$work/fields" || fail "$key is a $type without $field"
    done
done < <(grep "	type	" "$work/fields")
odd=$(awk -F '\t' '$2 == "doi" && $3 !~ /^10\.[0-9]+\/[^ {}]+$/ || $2 == "year" && $3 !~ /^(19|20)[0-9][0-9]$/' "$work/fields")
[ -z "$odd" ] || fail "no DOI, or no year: $odd"
twice=$(awk -F '\t' '$2 == "doi" { print $3 }' "$work/fields" | sort | uniq -d)
[ -z "$twice" ] || fail "two papers have one DOI: $twice"

# Each kind alone; and JSON says the same.
"$program" list --json >"$work/all.json"
for kind in builders tracers kernels intersectors metrics; do
    "$program" list "$kind" --bibtex >"$work/$kind.bib"
    parse "$work/$kind.bib" | awk -F '\t' '$2 == "type" { print $1 }' | sort >"$work/printed"
    jq -r ".${kind}[].references[].key" "$work/all.json" | sort -u >"$work/listed"
    diff "$work/printed" "$work/listed" || fail "$kind: --bibtex and --json differ"
    silent=$(jq -r ".${kind}[] | select((.paper // \"none\") != \"none\" and .references == []) | .name" "$work/all.json")
    [ -z "$silent" ] || fail "$kind name a paper and have no BibTeX: $silent"
done
jq -r '.[][] | .references[]? | [.key, "doi", .doi // empty] | select(length == 3) | @tsv' "$work/all.json" | sort -u >"$work/dois"
diff <(grep "	doi	" "$work/fields" | sort) "$work/dois" || fail "DOIs of --bibtex and --json differ"

# A plug-in brings its own.
"$program" list builders --bibtex --plugin "$plugin" >"$work/with.bib"
[ "$(parse "$work/with.bib" | grep "	type	" | comm -13 <(parse "$work/builders.bib" | grep "	type	" | sort) <(parse "$work/with.bib" | grep "	type	" | sort))" = "strips	type	misc" ] ||
    fail "the plug-in's paper is not one more"
"$program" list builders --json --plugin "$plugin" | jq -e '.builders[] | select(.name == "strips") | [.references[].key] == ["strips", "gu2018"]' >"$work/log" ||
    fail "the plug-in's references are not its own and the included one"

refuses() {
    status=0
    "$program" "${@:2}" >"$work/out" 2>"$work/error" || status=$?
    [ $status = 2 ] && [ ! -s "$work/out" ] && grep -qF -- "$1" "$work/error" || fail "${*:2}: status $status: $(cat "$work/error")"
}
refuses 'scenes implement no papers' list scenes --bibtex
refuses "no list 'builder'" list builder --bibtex
refuses '--json' list builders --bibtex --json
