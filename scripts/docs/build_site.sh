#!/usr/bin/env bash
# build_site.sh [MOSBENCH]: makes build/site, the manual as web pages with search, and a page of results: a simulated
# drive that all methods segment. A dead link is an error. Needs what setup.sh --page installs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
mosbench=${1:-build/release/eval/mosbench}
pages=build/site_pages drive=build/site_drive
command -v mkdocs >/dev/null || { echo "build_site.sh: there is no mkdocs; scripts/setup.sh --page installs it" >&2; exit 1; }
rm -rf "$pages" "$drive"
scripts/docs/site_pages.py "$pages"

"$mosbench" simulate --layout semantickitti --scene street --scans 60 --seed 1 --out "$drive/street"
"$mosbench" run "$drive/street" --method all --out "$drive/runs" >/dev/null
"$mosbench" report "$drive/runs" -o "$pages/results/street.html" --max-mb 10
{
  printf '# Results\n\n[Real drives](../README.md), [every method](../docs/history/methods.md) and [studies](studies/README.md)\n'
  printf 'are measured by hand. The table and the scans below are made with this site: a simulated street.\n\n'
  "$mosbench" rank "$drive/runs" --as markdown
  printf '\n<iframe src="street.html" title="Report of the simulated street" width="100%%" height="800"></iframe>\n\n'
  printf '[The report alone](street.html)\n'
} >"$pages/results/README.md"
mkdocs build --quiet --strict --clean --config-file scripts/docs/mkdocs.yml
echo "build/site/index.html"
