#!/usr/bin/env bash
# fuzz.sh SECONDS [JOBS [TARGET...]]: runs libFuzzer targets of --preset fuzz, every one or those named, all together
# for SECONDS on each of JOBS cores (1), from the corpus of tests/fuzz and from what earlier rounds found new
# (build/fuzz/found). Prints how many inputs each has run; the exit code is 1 if any ended with a finding, which lies
# in build/fuzz/findings.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:?seconds} jobs=${2:-1}
programs=(build/fuzz/tests/fuzz_*)
if [ $# -gt 2 ]; then programs=("${@:3}") && programs=("${programs[@]/#/build/fuzz/tests/fuzz_}"); fi
[ -x "${programs[0]}" ] || { echo "fuzz.sh: build/fuzz/tests holds no program: cmake --build --preset fuzz" >&2; exit 2; }
mkdir -p build/fuzz/findings
share=$((seconds * jobs / ${#programs[@]}))
[ "$share" -gt 0 ] || { echo "fuzz.sh: less than a second for each of ${#programs[@]} programs" >&2; exit 2; }

# Shorter traces of allocations, which cost time with each. New functions are not named, for which libFuzzer calls
# llvm-symbolizer each time.
export ASAN_OPTIONS=malloc_context_size=4
# fuzz PROGRAM SECONDS: prints "name inputs verdict".
fuzz() {
  local name=${1##*/fuzz_} verdict=ok log=build/fuzz/findings/${1##*/}.log
  mkdir -p "build/fuzz/found/$name"
  "$1" "build/fuzz/found/$name" "tests/fuzz/corpus/$name" -max_total_time="$2" -max_len=65536 -timeout=60 -reload=0 \
    -entropic=0 -print_funcs=0 -rss_limit_mb=4096 -print_final_stats=1 -artifact_prefix="build/fuzz/findings/$name-" \
    >"$log" 2>&1 || verdict=FINDING
  echo "$name $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") $verdict"
}
export -f fuzz

printf '%s\n' "${programs[@]}" | xargs -P "$jobs" -I{} bash -c "fuzz {} $share" | tee build/fuzz/findings/summary
awk '{ sum += $2; bad += $3 != "ok" } END { print sum " inputs, " bad + 0 " findings"; exit bad > 0 }' \
  build/fuzz/findings/summary
