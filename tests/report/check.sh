#!/bin/sh
# Opens the sample report in a headless Chromium: no console message, all rows, charts and pictures there. Exit status 77 (skipped)
# where there is no Chromium.
#   check.sh TEST_REPORT FOLDER      the test executable, which writes the sample, and a folder for it
set -eu
test_report=$1
folder=$2

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$browser" ]; then
    echo "skipped: there is no chromium (apt-get install --no-install-recommends chromium)"
    exit 77
fi

fail() {
    echo "FAILED: $1"
    exit 1
}

# dom FILE: what the page is after its script ran; console messages go to FILE.log.
dom() {
    "$browser" --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking \
        --disable-component-update --disable-sync --disable-dev-shm-usage --host-resolver-rules='MAP * ~NOTFOUND' \
        --user-data-dir="$folder/profile" --enable-logging=stderr --v=0 --virtual-time-budget=5000 \
        --dump-dom "file://$folder/$1" >"$folder/$1.dom" 2>"$folder/$1.log"
}

# has TEXT COUNT: at least that often in the page.
has() {
    found=$(grep -oF -- "$1" "$folder/report.html.body" | wc -l)
    [ "$found" -ge "$2" ] || fail "'$1' is $found times in the page, expected $2 or more"
}

rm -rf "$folder"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

# The check itself: it must see a console error.
echo '<p id="p"></p><script>document.getElementById("p").append("ran");undefined_function()</script>' >"$folder/control.html"
dom control.html || fail "chromium does not start: $(tail -n 1 "$folder/control.html.log")"
grep -q 'CONSOLE' "$folder/control.html.log" || fail "console errors are not seen"
grep -q '>ran<' "$folder/control.html.dom" || fail "scripts do not run"

"$test_report" --write "$folder" >"$folder/table.txt" || fail "the sample was not written"
dom report.html || fail "chromium failed on the report"
if grep 'CONSOLE' "$folder/report.html.log"; then
    fail "the page writes to the console"
fi
# What was drawn, without the records that it was drawn from.
sed -n '1,/<script type="application\/json"/p' "$folder/report.html.dom" >"$folder/report.html.body"

has '204 of 204 rows' 1                 # traces
has '24 of 24 rows' 1                   # builds
has '<tr' 248                           # with scenes, skipped sets, times and headings
has '>lbvh:bits=63</th>' 39             # 12 cells and a build per scene
has '2.86 WRONG OVERFLOW' 1
has '<td class="number wrong">' 1
has 'refused: brute force would take' 3
has '&lt;/script&gt;&lt;b&gt;' 3        # markup in a reason is text
has '1 cell WRONG above the limit' 1
has '72 other cells with wrong answers' 1
has '<tr class="reference">' 30
has 'aria-sort="none"' 40
has 'src="data:image/png;base64,' 1
has 'missing.png: the file was not there' 1
has '>Total</th>' 1
has '>Not accounted for</th>' 1
has '; 2 skipped.' 1
has 'the mesh is not closed &lt;/script' 1
has '<canvas id="chart-' 4
has 'wrong rays per million: 17 marks' 1 # 5 builders with 3 cells each, and 2 references
has ' ms before the first ray' 2
has '1234567890123456789' 1
echo "ok: $browser shows the report without a console message"
