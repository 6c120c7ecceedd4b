#!/usr/bin/env bash
# check_install.sh [BUILD_FOLDER]: installs a built tree (build/release) into a new prefix, builds a
# program outside the project against it with find_package(mosbench) and checks what it prints.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:-build/release}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cmake --install "$build" --prefix "$scratch/prefix" >"$scratch/install.log"
cp -r tests/install "$scratch/consumer"
cmake -S "$scratch/consumer" -B "$scratch/consumer/build" -G Ninja \
  -DCMAKE_PREFIX_PATH="$scratch/prefix" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$scratch/consumer/build" >/dev/null
labels=$("$scratch/consumer/build/label_one_scan" | paste -sd ' ')
# The first scan of a sequence has nothing to have moved from.
[ "$labels" = "9 9 9" ] || { echo "the installed library labels '$labels', expected '9 9 9'" >&2; exit 1; }
"$scratch/prefix/bin/mosbench" --help >/dev/null
echo "installed, found by find_package(mosbench), linked and run"
