#!/usr/bin/env bash
# Benchmarks a program of one's own: the same method as a C++ program and, where numpy is, as a Python
# script, run by mosbench like a method of its own. Their labels are equal. Takes the folder that holds
# the compiled client.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
client="$1/exec_client"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

mosbench simulate --layout semantickitti --scene room --scans 8 --seed 1 --out "$work/sim"
mosbench run "$work/sim" --method "hmm-mos,exec:$client" --out "$work/runs"
mosbench rank "$work/runs"

python="${PYTHON:-/usr/bin/python3}"
if ! "$python" -c 'import numpy' 2> /dev/null; then
  echo "numpy is not there: the Python client was not run"
  exit 0
fi
mosbench run "$work/sim" --method "exec:$python $here/client.py" --write scores --out "$work/python"
diff -r "$work/runs/exec/08/labels" "$work/python/08/labels"
mosbench stats "$work/python" --by threshold
echo "both clients give the same labels"
