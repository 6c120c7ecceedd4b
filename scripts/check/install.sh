#!/usr/bin/env bash
# install.sh [BUILD_FOLDER]: installs a built tree (build/release) into a new prefix, builds a program
# outside the project against it with find_package(mosbench), and checks what it prints.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build/release}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cmake --install "$build" --prefix "$scratch/prefix" >"$scratch/install.log"
# <mosbench/...> and nothing else.
public=$(cd core/include && find . -name '*.hpp' | sort)
installed=$(cd "$scratch/prefix/include/mosbench" && find . -name '*.hpp' | sort)
[ "$public" = "$installed" ] ||
  { echo "other headers are installed than those of core/include:" >&2; diff <(echo "$public") <(echo "$installed") >&2; exit 1; }
cp -r tests/install "$scratch/consumer"
cmake -S "$scratch/consumer" -B "$scratch/consumer/build" -G Ninja \
  -DCMAKE_PREFIX_PATH="$scratch/prefix" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$scratch/consumer/build" >/dev/null
labels=$("$scratch/consumer/build/label_one_scan" | paste -sd ' ')
# The first scan of a sequence has nothing to have moved from.
[ "$labels" = "9 9 9" ] || { echo "the installed library labels '$labels', expected '9 9 9'" >&2; exit 1; }
"$scratch/prefix/bin/mosbench" --help >/dev/null
for file in bash-completion/completions/mosbench zsh/site-functions/_mosbench; do
  [ -s "$scratch/prefix/share/$file" ] || { echo "share/$file is not installed" >&2; exit 1; }
done
if command -v help2man >/dev/null; then
  grep -q '^\.SH EXAMPLES' "$scratch/prefix/share/man/man1/mosbench-run.1" ||
    { echo "there is no manual page with examples of mosbench run" >&2; exit 1; }
fi
echo "installed, found by find_package(mosbench), linked and run"
