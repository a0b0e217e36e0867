#!/usr/bin/env bash
# What the last run of the tests in a build folder skipped, a line each, as "test NAME" or "case
# NAME" (one of a test's cases): tests/skipped.sh BUILD
set -euo pipefail
{
    sed -n 's/.*<testcase name="\([^"]*\)".* status="notrun".*/test \1/p' "$1/tests.xml"
    sed -n 's/^\[  SKIPPED \] \([A-Za-z_][A-Za-z_0-9]*\)$/case \1/p' \
        "$1/Testing/Temporary/LastTest.log"
} | sort -u
