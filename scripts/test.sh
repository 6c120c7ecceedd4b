#!/usr/bin/env bash
# test.sh [ctest arguments]: installs missing packages, builds release and runs every test.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
"$here/setup.sh" --tests
exec "$here/build_and_test.sh" release "$@"
