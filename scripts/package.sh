#!/usr/bin/env bash
# package.sh: builds release and makes Debian packages of it in build/release/packages: mosbench,
# mosbench-hdf5 and python3-mosbench, those of what is built.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/build.sh release --target mosbench --target manual
if [ -d build/release/eval/python ]; then cmake --build --preset release --target mosbench_python; fi
rm -rf build/release/packages
cd build/release
cpack -G DEB
ls packages/*.deb
