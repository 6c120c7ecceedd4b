# Sourced by run.sh of tests by node's own runner.

# skip WHAT: exit code 77, which ctest counts as skipped.
skip() {
  echo "skipped: $1 (scripts/setup.sh --page installs it)"
  exit 77
}

# run_node_tests TEST_FILE...: where node is there and new enough.
run_node_tests() {
  command -v node >/dev/null || skip "there is no node"
  [ "$(node -p 'parseInt(process.versions.node)')" -ge 20 ] || skip "node $(node --version) is older than 20"
  exec node --test --test-reporter=spec "$@"
}
