#!/bin/sh
# Opens the sample report in a headless Chromium: no console message, all rows, charts and pictures there, the same figures as in the
# charts drawn by gnuplot. Leaves screenshots at the width of a telephone, of a desktop, in the dark, and the print, to be looked at.
# Exit status 77 (skipped) where there is no Chromium.
#   check.sh TEST_REPORT FOLDER      the test executable, which writes the sample, and a folder for it
set -eu
test_report=$1
folder=$2
here=$(cd "$(dirname "$0")" && pwd)

. "$here/browser.sh"

# dom FILE: what the page is after its script ran.
dom() {
    open_page "$1" --dump-dom >"$folder/$1.dom"
}

# screenshot NAME WIDTH HEIGHT OPTION...: a PNG of that size.
screenshot() {
    name=$1 width=$2 height=$3
    shift 3
    open_page report.html --hide-scrollbars --window-size="$width,$height" --screenshot="$folder/$name.png" "$@" >/dev/null ||
        fail "no screenshot $name"
    silent report.html "$name"
    # a PNG, whose width stands in bytes 16 to 19, and of more than a blank page's few kilobytes
    size=$(wc -c <"$folder/$name.png")
    wide=$(od -An -tu1 -j16 -N4 "$folder/$name.png" | awk '{ print (($1 * 256 + $2) * 256 + $3) * 256 + $4 }')
    [ "$wide" = "$width" ] || fail "screenshot $name is $wide wide, not $width"
    [ "$size" -gt 40000 ] || fail "screenshot $name has $size bytes: an empty page?"
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
silent report.html "as it opens"
# What was drawn, without the records that it was drawn from.
sed -n '1,/<script type="application\/json"/p' "$folder/report.html.dom" >"$folder/report.html.body"

has '204 of 204 rows' 1                 # traces
has '24 of 24 rows' 1                   # builds
has '<tr' 248                           # with scenes, skipped sets, times and headings
has '>lbvh:bits=63</th>' 39             # 12 cells and a build per scene
has '2.86 WRONG OVERFLOW' 1
has '<td class="number wrong">' 1
has 'refused: brute force would take' 3
has '&lt;/script&gt;&lt;b&gt;' 4        # markup in a reason or a title is text
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
has '<canvas id="chart-' 5
has 'wrong rays per million: 5 marks' 1  # 3 kernels and intersectors, each on its fastest tree, and 2 references
has 'wrong rays per million: 12 marks' 1 # 5 builders with 2 intersectors each, and 2 references
has '5 of 5 rows' 1                      # the tables beside them
has '12 of 12 rows' 1
has 'all 2 together' 1
has '>≤ 5.72<' 6                         # none of 2 * 262,144 rays: 3/n
has ' ms before the first ray' 2
has '1234567890123456789' 1
has '>native</td>' 120
has '>diffuse (rays as given)</td>' 17   # of one scene
has '>reshaped</td>' 60
has 'code: 30 bits, 10 per axis' 1
has 'presplit 1.50, embree 2.50, map 3.50, rotate 4.50' 3
has 'embree 59.0, rotate 57.0' 3         # SAH after the stages that leave a tree
has 'presplit 3.00 MiB, embree 4.00 MiB, rotate 6.00 MiB' 3
has '>First ray ms<' 2
has 'Time per ray against SAH and EPO, the best mix: 60 marks' 1 # primary: 5 trees, 2 kernels, 2 views, 3 scenes
has '>alpha [range]<' 1
has '✓ held' 1
has '✗ not held' 1
has '? cannot be told: too few rounds' 1
has '~ direction only' 1
has '>Mrays/s [95 %]<' 1                # of coffee's 6 rounds; of interior's 3 a range
has '>Build ms [95 %]<' 1
has '] range</td>' 75                   # 68 traces and 7 builds; of spheres' one round nothing
has 'Upright lines at the marks are 95 % intervals of the median.' 3
has 'inf_nan round_to_nearest fma' 1
has ', rtcIntersect and rtcOccluded' 1
has '<td class="number">4.50</td>' 1

# What the page says of winners and fronts is what gnuplot draws; its script has data blocks per picture.
if [ -f "$folder/report-charts/charts.gp" ]; then
    block() {
        sed -n "/output '$1.svg'/,/output '$1.png'/p" "$folder/report-charts/charts.gp" | sed -n "/^\$$2 <</,/^EOD/p" | sed '1d;$d'
    }
    # a builder's number in gnuplot's legend, for the name that the page has
    block coffee_primary_time cross | sed 's/^[^"]*"\([^"]*\)".*/\1/' | while read -r number crossing; do
        sed -n "/output 'coffee_primary_time.svg'/,\$s/.*title '$number  \([^']*\)'.*/$crossing<\/b>: \1,/p" \
            "$folder/report-charts/charts.gp" | head -n 1
    done >"$folder/crossings"
    [ -s "$folder/crossings" ] || fail "no builder overtakes another in the sample"
    while IFS= read -r crossing; do
        has "$crossing" 1
    done <"$folder/crossings"
    stairs=$(block coffee_primary_accuracy front; block coffee_primary_builders front)
    steps=$(($(echo "$stairs" | wc -l) / 2 - 1))
    found=$(grep -oF '<td>on front</td>' "$folder/report.html.body" | wc -l)
    [ "$found" -eq "$steps" ] || fail "$found marks are on the page's fronts, $steps on gnuplot's"
fi

# Each choice and button, at a telephone's width.
{ cat "$folder/report.html"; echo '<script>'; cat "$here/exercise_files.js" "$here/exercise.js"; echo '</script>'; } >"$folder/exercise.html"
open_page exercise.html --window-size=400,1000 --dump-dom >"$folder/exercise.html.dom"
silent exercise.html "as it is used"
grep -q 'EXERCISE: [0-9]* choices, all well' "$folder/exercise.html.dom" ||
    fail "$(grep -o 'EXERCISE: .*' "$folder/exercise.html.dom" | tail -n 1)"

screenshot telephone 400 5200
screenshot desktop 1280 4200
screenshot dark 1280 4200 --blink-settings=preferredColorScheme=0
open_page report.html --no-pdf-header-footer --print-to-pdf="$folder/print.pdf" >/dev/null || fail "it does not print"
silent report.html "in print"
[ "$(head -c 5 "$folder/print.pdf")" = '%PDF-' ] || fail "the print is no PDF"
echo "ok: $browser shows the report without a console message; screenshots are in $folder"
