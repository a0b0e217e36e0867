#!/bin/bash
# Runs a program, and again (three times at most) where LeakSanitizer says that it broke itself, which is not what it looks for:
# again.sh PROGRAM ARGUMENT...   The program sees the PATH that it was given.
set -u
tool() { (PATH=/usr/bin:/bin && "$@"); }
out=$(tool mktemp) errors=$(tool mktemp)
trap 'tool rm -f "$out" "$errors"' EXIT
for attempt in 1 2 3; do
    "$@" >"$out" 2>"$errors"
    status=$?
    tool grep -q 'LeakSanitizer has encountered a fatal error' "$out" "$errors" || break
done
tool cat "$out"
tool cat "$errors" >&2
exit $status
