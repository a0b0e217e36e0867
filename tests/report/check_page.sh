#!/bin/sh
# Opens a page in a headless Chromium and uses it as EXERCISE.js does: no console message, and all that it expects. Leaves screenshots.
# Exit status 77 (skipped) where there is no Chromium.
#   check_page.sh EXERCISE.js PAGE.html FOLDER COMMAND...      a command that writes PAGE.html into FOLDER
set -eu
exercise=$1 html=$2 folder=$3
shift 3
here=$(cd "$(dirname "$0")" && pwd)

. "$here/browser.sh"

# look OPTION...: the page, exercised; prints what the browser does.
look() {
    open_page exercise.html "$@"
    silent exercise.html "$*"
}

rm -rf "$folder"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
"$@" >"$folder/table.txt" || fail "the page was not written"
! grep -qE '(src|href)="(https?:)?//' "$folder/$html" || fail "the page loads something"
{ cat "$folder/$html"; echo '<script>'; cat "$here/exercise_files.js" "$here/$exercise"; echo '</script>'; } >"$folder/exercise.html"
for width in 400 1280; do
    look --window-size="$width,1500" --dump-dom >"$folder/dom"
    grep -q 'EXERCISE: [0-9]* charts, all well' "$folder/dom" ||
        fail "$width wide: $(grep -o 'EXERCISE: [^<]*' "$folder/dom" | tail -n 1)"
    look --hide-scrollbars --window-size="$width,1500" --screenshot="$folder/$width.png" >/dev/null
    [ "$(wc -c <"$folder/$width.png")" -gt 30000 ] || fail "an empty page?"
done
look --hide-scrollbars --window-size=1280,1500 --blink-settings=preferredColorScheme=0 --screenshot="$folder/dark.png" >/dev/null
echo "ok: screenshots are in $folder"
