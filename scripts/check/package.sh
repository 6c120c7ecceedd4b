#!/usr/bin/env bash
# package.sh FOLDER: installs the packages of FOLDER (build/release/packages) where nothing else is
# installed, and uses each: the program, the module for .h5 files, and the Python package.
# lintian must find no errors; that the project has no address is none.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
folder=${1:-build/release/packages}
lintian --fail-on error --allow-root --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog \
  "$folder"/*.deb

source scripts/check/clean_root.sh
mkdir "$root/packages"
cp "$folder"/*.deb "$root/packages"
in_root apt-get -q update >/dev/null
install_package() {
  in_root sh -c "apt-get -q -y install --no-install-recommends /packages/$1_*.deb" >"$root/apt.log" 2>&1 ||
    { tail -n 20 "$root/apt.log" >&2; return 1; }
  echo "installed $1, $(in_root dpkg-query -f . -W | wc -c) packages are there"
}
refuse_development_packages() {
  if in_root dpkg-query -W | cut -f 1 | grep -E -e '-dev(:|$)'; then
    echo "a package depends on these" >&2
    exit 1
  fi
}

install_package mosbench
in_root sh -euc 'cd /root
  mosbench simulate --layout semantickitti --scene street --scans 12 --seed 1 --out street
  mosbench run street --out run
  mosbench report run -o report.html' >/dev/null 2>"$root/log" || { cat "$root/log" >&2; exit 1; }
[ -s "$root/root/report.html" ]

mkdir -p "$root/root/pcd/velodyne"
printf '%s\n' 'VERSION .7' 'FIELDS x y z' 'SIZE 4 4 4' 'TYPE F F F' 'COUNT 1 1 1' 'WIDTH 1' 'HEIGHT 1' \
  'VIEWPOINT 0 0 0 1 0 0 0' 'POINTS 1' 'DATA ascii' '5 1 0' >"$root/root/pcd/velodyne/000000.pcd"
echo 1 0 0 0 0 1 0 0 0 0 1 0 >"$root/root/pcd/poses.txt"
in_root mosbench run /root/pcd --dataset semantickitti --out /root/pcd-run >/dev/null 2>"$root/log" ||
  { cat "$root/log" >&2; exit 1; }

install_package mosbench-hdf5
in_root sh -euc 'mosbench simulate --layout opensceneflow --scene street --scans 4 --seed 1 --out /root/flow
  mosbench run /root/flow --out /root/flow-run' >/dev/null 2>"$root/log" || { cat "$root/log" >&2; exit 1; }

install_package python3-mosbench
in_root python3 -c '
import mosbench
assert len(mosbench.open("/root/street").scan(0).points) > 1000
assert len(mosbench.open("/root/pcd", dataset="semantickitti").scan(0).points) == 1
assert mosbench.Result("/root/run").iou is not None
print("mosbench", mosbench.__version__, "imported")'
refuse_development_packages
