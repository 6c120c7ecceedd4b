#!/usr/bin/env bash
# fresh.sh [SCRIPT...]: runs README's two commands, or these of scripts/, where nothing is installed, on the
# files of the last commit, and prints wall and CPU time of each.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
[ $# -gt 0 ] || set -- demo.sh test.sh
source scripts/check/clean_root.sh
mkdir "$root/mosbench"
git archive HEAD | tar -x -C "$root/mosbench"

TIMEFORMAT='%R s wall, %U s user, %S s system'
for script in "$@"; do
  echo "=== scripts/$script with $(nproc) cores, $(in_root dpkg-query -f . -W | wc -c) packages before"
  time in_root "/mosbench/scripts/$script"
  echo "=== $(in_root dpkg-query -f . -W | wc -c) packages after"
done
