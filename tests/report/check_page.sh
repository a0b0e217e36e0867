#!/bin/sh
# Opens a page in a headless Chromium and uses it as EXERCISE.js does: no console message, and all that it expects. Leaves screenshots.
# Exit status 77 (skipped) where there is no Chromium.
#   check_page.sh EXERCISE.js PAGE.html FOLDER COMMAND...      a command that writes PAGE.html into FOLDER
set -eu
exercise=$1 page=$2 folder=$3
shift 3
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
"$@" >"$folder/table.txt" || fail "the page was not written"
! grep -qE '(src|href)="(https?:)?//' "$folder/$page" || fail "the page loads something"
{ cat "$folder/$page"; echo '<script>'; cat "$here/$exercise"; echo '</script>'; } >"$folder/exercise.html"
for width in 400 1280; do
    open_page --window-size="$width,1500" --dump-dom >"$folder/dom"
    grep -q 'EXERCISE: [0-9]* charts, all well' "$folder/dom" ||
        fail "$width wide: $(grep -o 'EXERCISE: [^<]*' "$folder/dom" | tail -n 1)"
    open_page --hide-scrollbars --window-size="$width,1500" --screenshot="$folder/$width.png" >/dev/null
    [ "$(wc -c <"$folder/$width.png")" -gt 30000 ] || fail "an empty page?"
done
open_page --hide-scrollbars --window-size=1280,1500 --blink-settings=preferredColorScheme=0 --screenshot="$folder/dark.png" >/dev/null
echo "ok: screenshots are in $folder"
