#!/usr/bin/env bash
# fuzz.sh [--inputs N] SECONDS [JOBS [TARGET...]]: runs libFuzzer targets of --preset fuzz, every one or those named, all
# together for SECONDS on each of JOBS cores (1), from the corpus of tests/fuzz and from what earlier rounds found new
# (build/fuzz/found). With --inputs they end as soon as all together have run N: each 100,000 first, if it can in its
# share of the time, then the fastest quarter of them the rest. Prints how many inputs each has run; the exit code is 1
# if any ended with a finding, which lies in build/fuzz/findings.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
inputs=0
if [ "${1:-}" = --inputs ]; then inputs=${2:?inputs} && shift 2; fi
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
# fuzz PROGRAM LIMIT...: prints "name inputs verdict inputs_per_second".
fuzz() {
  local name=${1##*/fuzz_} verdict=ok log=build/fuzz/findings/${1##*/}.log
  mkdir -p "build/fuzz/found/$name"
  "$1" "build/fuzz/found/$name" "tests/fuzz/corpus/$name" "${@:2}" -max_len=65536 -timeout=60 -reload=0 \
    -entropic=0 -print_funcs=0 -rss_limit_mb=4096 -print_final_stats=1 -artifact_prefix="build/fuzz/findings/$name-" \
    >"$log" 2>&1 || verdict=FINDING
  echo "$name $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") $verdict" \
    "$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")"
}
export -f fuzz

# together LIMITS PROGRAM...: runs programs with the same limits.
together() {
  printf '%s\n' "${@:2}" | xargs -P "$jobs" -I{} bash -c "fuzz {} $1" | tee -a build/fuzz/findings/summary
}

: >build/fuzz/findings/summary
if [ "$inputs" = 0 ]; then
  together "-max_total_time=$share" "${programs[@]}"
else
  together "-max_total_time=$share -runs=100000" "${programs[@]}"
  left=$(awk -v wanted="$inputs" '{ wanted -= $2 } END { printf "%d", wanted }' build/fuzz/findings/summary)
  seconds_left=$(((seconds - SECONDS) * jobs))
  mapfile -t fastest < <(grep ' ok ' build/fuzz/findings/summary | sort -k4,4nr |
    head -n $(((${#programs[@]} + 3) / 4)) | sed 's|^\([^ ]*\).*|build/fuzz/tests/fuzz_\1|')
  if [ "$left" -gt 0 ] && [ "$seconds_left" -ge "${#fastest[@]}" ] && [ ${#fastest[@]} -gt 0 ]; then
    together "-max_total_time=$((seconds_left / ${#fastest[@]})) -runs=$((left / ${#fastest[@]}))" "${fastest[@]}"
  fi
fi
awk '{ sum += $2; bad += $3 != "ok" } END { print sum " inputs, " bad + 0 " findings"; exit bad > 0 }' \
  build/fuzz/findings/summary
