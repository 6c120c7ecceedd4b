#!/usr/bin/env bash
# build.sh PRESET [cmake --build arguments]: configures and builds, with ccache if it is installed.
# MOSBENCH_WITH_PCL, MOSBENCH_WITH_ROSBAG, MOSBENCH_WITH_HDF5, MOSBENCH_WITH_OCTOMAP,
# MOSBENCH_PRECOMPILED_HEADERS, MOSBENCH_WARNINGS_AS_ERRORS, MOSBENCH_BUILD_TESTS and MOSBENCH_BUILD_BENCH are passed on if set.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -ge 1 ] || { echo "usage: build.sh PRESET [cmake --build arguments]" >&2; exit 2; }
preset=$1
shift

options=(-DMOSBENCH_WITH_PCL="${MOSBENCH_WITH_PCL:-ON}"
  -DMOSBENCH_WITH_ROSBAG="${MOSBENCH_WITH_ROSBAG:-ON}"
  -DMOSBENCH_WITH_HDF5="${MOSBENCH_WITH_HDF5:-ON}"
  -DMOSBENCH_WITH_OCTOMAP="${MOSBENCH_WITH_OCTOMAP:-ON}")
for option in MOSBENCH_PRECOMPILED_HEADERS MOSBENCH_WARNINGS_AS_ERRORS MOSBENCH_BUILD_TESTS MOSBENCH_BUILD_BENCH; do
  [ -z "${!option:-}" ] || options+=("-D$option=${!option}")
done
# ccache does not know what a precompiled header holds; clang-tidy and clang's fuzzers read headers themselves.
if command -v ccache >/dev/null; then
  options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
elif [ -z "${MOSBENCH_PRECOMPILED_HEADERS:-}" ] && [[ $preset != tidy && $preset != fuzz ]]; then
  options+=(-DMOSBENCH_PRECOMPILED_HEADERS=ON)
fi
cmake --preset "$preset" "${options[@]}"
cmake --build --preset "$preset" -j "$(nproc)" "$@"
