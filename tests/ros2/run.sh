#!/usr/bin/env bash
# run.sh TEST_FILE...: reads bags that other writers make. Exit code 77, which ctest counts as skipped,
# where node 20 or its packages are not there; scripts/setup.sh --page installs them.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
skip() {
  echo "skipped: $1 (scripts/setup.sh --page installs it)"
  exit 77
}
command -v node >/dev/null || skip "there is no node"
[ "$(node -p 'parseInt(process.versions.node)')" -ge 20 ] || skip "node $(node --version) is older than 20"
[ -d "$here/node_modules/@mcap/core" ] || skip "there is no @mcap/core"
exec node --test --test-reporter=spec "$@"
