#!/usr/bin/env bash
# scripts/fetch-scenes with a curl that copies a local file: fetch_scenes.sh SOURCE What is kept has
# the sum of the list, or the one that the user confirms where the list has none; all else is
# refused, and nothing of it stays. The real list names a commit in each direct link.
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "fetch_scenes.sh: $1" >&2
    exit 1
}

mkdir -p "$work/tree/scripts" "$work/tree/scenes" "$work/bin"
cp "$source/scripts/fetch-scenes" "$work/tree/scripts/"
cat >"$work/bin/curl" <<'END'
#!/bin/sh
while [ $# -gt 1 ]; do
    [ "$1" = --output ] && output=$2
    link=$2
    shift
done
echo "$link" >>"$CURL_LOG"
cp "$CURL_GIVES" "$output"
END
chmod +x "$work/bin/curl"
printf 'glTF and more' >"$work/good"
printf 'glTF and mor!' >"$work/changed"
printf '<html>gone' >"$work/page"
export CURL_LOG=$work/links CURL_GIVES=$work/good PATH=$work/bin:$PATH
sum() { sha256sum <"$1" | cut -d ' ' -f 1; }
good=$(sum "$work/good")
link=https://example.org/0123456789012345678901234567890123456789/a.glb
cat >"$work/tree/scenes/fetch.txt" <<END
# name | archive | where | sha256
known | Archive, CC0 | $link | $good
new   | Archive, CC0 | $link | unknown
page  | Archive, CC0 | $link | $(sum "$work/page")
home  | Archive | https://example.org/
END

# fetch WHAT-TO-EXPECT ARGUMENT...: runs the script into an empty folder. "kept", or a text that its
# one line of refusal has.
fetch() {
    local expected=$1 status=0
    shift
    rm -rf "$work/out"
    : >"$CURL_LOG"
    "$work/tree/scripts/fetch-scenes" "$@" >"$work/said" 2>"$work/errors" || status=$?
    if [ "$expected" = kept ]; then
        [ $status -eq 0 ] && cmp -s "$work/good" "$work/out/$1.glb" ||
            fail "$*: not kept: $(cat "$work/errors")"
        [ "$(cat "$CURL_LOG")" = "$link" ] || fail "$*: fetched $(cat "$CURL_LOG")"
    else
        [ $status -eq 2 ] || fail "$*: exit status $status instead of 2"
        [ "$(wc -l <"$work/errors")" -eq 1 ] || fail "$*: more than one line: $(cat "$work/errors")"
        grep -qF -- "$expected" "$work/errors" ||
            fail "$*: '$expected' is not in: $(cat "$work/errors")"
        [ -z "$(ls -A "$work/out" 2>/dev/null)" ] || fail "$*: left $(ls -A "$work/out")"
    fi
}

fetch kept known "$work/out"
fetch kept known "$work/out" "$good"
CURL_GIVES=$work/changed fetch "$good" known "$work/out"
CURL_GIVES=$work/changed fetch "$good" known "$work/out" "$(sum "$work/changed")"
fetch "sha256 $good" new "$work/out"
fetch kept new "$work/out" "$good"
CURL_GIVES=$work/changed fetch "you say $good" new "$work/out" "$good"
CURL_GIVES=$work/page fetch "no binary glTF" page "$work/out"
fetch "no SHA-256 sum" known "$work/out" 1234
fetch "by hand from https://example.org/" home "$work/out"
fetch "no scene 'none'" none "$work/out"
fetch "usage"

complete='\| https://[^ ]*/[0-9a-f]{40}/[^ ]*\.(glb|vox|msh) \| (unknown|[0-9a-f]{64})$'
entries=$(grep -cE "$complete" "$source/scenes/fetch.txt")
listed=$("$source/scripts/fetch-scenes" --list | grep -c '^download ')
[ "$listed" -gt 0 ] && [ "$entries" -eq "$listed" ] ||
    fail "$listed direct links in scenes/fetch.txt, $entries with a commit and a sum (or 'unknown')"
echo "fetch-scenes: ok"
