#!/usr/bin/env bash
# run.sh TEST_FILE...: tests of the report's page with node's own runner. Exit code 77, which ctest
# counts as skipped, where node 20, its packages or Chromium are not there; scripts/setup.sh --page
# installs them.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../node.sh"
[ -d "$here/../../eval/report/page/node_modules/playwright-core" ] || skip "there is no playwright-core"
[ -x "${MOSBENCH_CHROMIUM:-/usr/bin/chromium}" ] || skip "there is no Chromium"
run_node_tests "$@"
