#!/usr/bin/env bash
# build_report.sh [--check]: makes eval/report/page/page.html, study.html and review.html, which `mosbench` fills in or serves,
# from eval/report/page/src. Run it after a change there; building mosbench takes the file as it is and
# needs no node. With --check it writes nothing, and ends with exit code 1 when the file differs from what
# src makes, or when the linter or a unit test of the page complains.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/setup.sh --page
cd eval/report/page
case "${1:-}" in
  "") npm run --silent build ;;
  --check)
    npm run --silent lint
    npm test --silent
    npm run --silent build -- --check
    ;;
  *) echo "usage: build_report.sh [--check]" >&2; exit 2 ;;
esac
