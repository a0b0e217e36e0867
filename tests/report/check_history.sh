#!/bin/sh
# Opens the page of a made-up history in a headless Chromium and uses it (exercise_history.js): no console message, marks at the right
# revisions, a band around the median. Leaves screenshots. Exit status 77 (skipped) where there is no Chromium.
#   check_history.sh TEST_HISTORY FOLDER      the test executable, which writes the sample, and a folder for it
set -eu
test_history=$1
folder=$2
here=$(cd "$(dirname "$0")" && pwd)

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$browser" ]; then
    echo "skipped: there is no chromium (apt-get install --no-install-recommends chromium)"
    exit 77
fi

fail() {
    echo "FAILED: $1"
    exit 1
}

open_page() {
    "$browser" --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking \
        --disable-component-update --disable-sync --disable-dev-shm-usage --host-resolver-rules='MAP * ~NOTFOUND' \
        --user-data-dir="$folder/profile" --enable-logging=stderr --v=0 --virtual-time-budget=5000 \
        "$@" "file://$folder/exercise.html" 2>"$folder/log"
    if grep 'CONSOLE' "$folder/log"; then
        fail "the page writes to the console"
    fi
}

rm -rf "$folder"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
"$test_history" --write "$folder" >"$folder/table.txt" || fail "the sample was not written"
! grep -qE '(src|href)="(https?:)?//' "$folder/history.html" || fail "the page loads something"
{ cat "$folder/history.html"; echo '<script>'; cat "$here/exercise_history.js"; echo '</script>'; } >"$folder/exercise.html"
for width in 400 1280; do
    open_page --window-size="$width,1500" --dump-dom >"$folder/dom"
    grep -q 'EXERCISE: [0-9]* charts, all well' "$folder/dom" ||
        fail "$width wide: $(grep -o 'EXERCISE: [^<]*' "$folder/dom" | tail -n 1)"
    open_page --hide-scrollbars --window-size="$width,1500" --screenshot="$folder/$width.png" >/dev/null
    [ "$(wc -c <"$folder/$width.png")" -gt 30000 ] || fail "an empty page?"
done
open_page --hide-scrollbars --window-size=1280,1500 --blink-settings=preferredColorScheme=0 --screenshot="$folder/dark.png" >/dev/null
echo "ok: screenshots are in $folder"
