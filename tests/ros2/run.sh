#!/usr/bin/env bash
# run.sh TEST_FILE...: reads bags that other writers make. Exit code 77, which ctest counts as skipped,
# where node 20 or its packages are not there; scripts/setup.sh --page installs them.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../node.sh"
[ -d "$here/node_modules/@mcap/core" ] || skip "there is no @mcap/core"
run_node_tests "$@"
