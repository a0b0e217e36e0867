# shellcheck shell=sh
# Sourced by the checks of pages: a headless Chromium without a network. Ends with 77 (skipped) where there is none.
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$browser" ]; then
    echo "skipped: there is no chromium (apt-get install --no-install-recommends chromium)"
    exit 77
fi

fail() {
    echo "FAILED: $1"
    exit 1
}

# open_page FILE OPTION...: the browser on a page of $folder; console messages go to FILE.log.
open_page() {
    page=$1
    shift
    "$browser" --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking \
        --disable-component-update --disable-sync --disable-dev-shm-usage --host-resolver-rules='MAP * ~NOTFOUND' \
        --user-data-dir="$folder/profile" --enable-logging=stderr --v=0 --virtual-time-budget=5000 \
        "$@" "file://$folder/$page" 2>"$folder/$page.log"
}

# silent FILE WHEN: the page wrote nothing to the console.
silent() {
    if grep 'CONSOLE' "$folder/$1.log"; then
        fail "the page writes to the console ($2)"
    fi
}
