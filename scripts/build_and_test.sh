#!/usr/bin/env bash
# build_and_test.sh PRESET [ctest arguments]: configures, builds, runs the tests and ends with
# "N passed, N failed, N skipped". Exit code 1 when a test failed or none ran.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -ge 1 ] || { echo "usage: build_and_test.sh PRESET [ctest arguments]" >&2; exit 2; }
preset=$1
shift

scripts/build.sh "$preset"

report=$PWD/build/$preset/tests.xml
rm -f "$report"
ctest_exit=0
ctest --preset "$preset" -j "$(nproc)" --output-junit "$report" "$@" || ctest_exit=$?
[ -f "$report" ] || { echo "ctest wrote no report" >&2; exit 1; }

count() { sed -nE "s/^[[:space:]]*$1=\"([0-9]+)\".*/\1/p" "$report" | head -n 1; }
tests=$(count tests)
failed=$(count failures)
skipped=$(($(count skipped) + $(count disabled)))
passed=$((tests - failed - skipped))
echo "$passed passed, $failed failed, $skipped skipped"
[ "$ctest_exit" = 0 ] && [ "$failed" = 0 ] && [ "$passed" -gt 0 ]
