#!/usr/bin/env bash
# setup.sh [--python|--tests|--checks|--package|--page|--cluster]: installs the Debian packages for building
# and testing; with --python also those of the Python package, its tests and its examples; with --checks those
# of the format and clang checks and of the API pages; with --package those that make and check Debian
# packages; with --page what tests, lints and builds the report's page and the site: a browser, node, the packages of
# eval/report/page/package-lock.json and MkDocs; with --cluster Snakemake and Slurm; --tests is --python and --page.
# Returns quickly when all are installed.
# MOSBENCH_WITH_PCL=OFF leaves out PCL, which only tests need and which brings some 400 packages,
# MOSBENCH_WITH_ROSBAG=OFF the 40 or so of ROS's bag library, which only writing bags needs,
# MOSBENCH_WITH_HDF5=OFF the 30 or so of libhdf5, which only .h5 files need,
# MOSBENCH_WITH_OCTOMAP=OFF the two of OctoMap, for the method of that name,
# MOSBENCH_BUILD_TESTS=OFF the libraries of tests and benchmarks, what makes manual pages, and git, of which the
# program needs no more than the version of a clone.
set -euo pipefail

packages=(g++ cmake ninja-build pkg-config xz-utils jq bsdextrautils python3
  libeigen3-dev libfmt-dev nlohmann-json3-dev libcli11-dev libxxhash-dev libutfcpp-dev libyaml-cpp-dev
  zlib1g-dev libpng-dev libbz2-dev liblz4-dev libzstd-dev libsqlite3-dev libexpat1-dev libboost-dev
  libnanoflann-dev)
[ "${MOSBENCH_BUILD_TESTS:-ON}" = OFF ] || packages+=(git libgtest-dev libgmock-dev libbenchmark-dev help2man)
[ "${MOSBENCH_WITH_PCL:-ON}" = OFF ] || packages+=(libpcl-dev)
[ "${MOSBENCH_WITH_ROSBAG:-ON}" = OFF ] || packages+=(librosbag-storage-dev)
[ "${MOSBENCH_WITH_HDF5:-ON}" = OFF ] || packages+=(libhdf5-dev)
[ "${MOSBENCH_WITH_OCTOMAP:-ON}" = OFF ] || packages+=(liboctomap-dev)
case "${1:-}" in
  "" | --page) ;;
  --python | --tests)
    packages+=(pybind11-dev python3-dev python3-numpy python3-pytest python3-h5py python3-matplotlib
      python3-pandas python3-pip python3-venv python3-setuptools python3-wheel)
    ;;
  --checks) packages+=(codespell clang clang-format clang-tidy doxygen mypy python3-numpy) with_types=1 ;;
  --package) packages+=(pybind11-dev python3-dev python3-numpy dpkg-dev lintian mmdebstrap) ;;
  --cluster) packages+=(snakemake slurm-wlm munge) ;;
  *) echo "usage: setup.sh [--python|--tests|--checks|--package|--page|--cluster]" >&2; exit 2 ;;
esac
with_page=$(case "${1:-}" in --page | --tests) echo 1 ;; esac)
[ -z "$with_page" ] || packages+=(chromium fonts-dejavu-core util-linux mkdocs mkdocs-material)
if [ -n "$with_page${with_types:-}" ] && ! command -v npm >/dev/null; then packages+=(nodejs npm); fi

give_up() {
  echo "setup.sh: $1; these Debian packages must be installed first:" >&2
  printf '  %s\n' "${missing[@]}" >&2
  exit 1
}

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) || status=absent
  [ "$status" = installed ] || missing+=("$package")
done

install_packages() {
  [ ${#missing[@]} -gt 0 ] || return 0
  command -v apt-get >/dev/null || give_up "there is no apt-get here"
  as_root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || give_up "neither root nor sudo"
    as_root=(sudo)
    # Without a terminal a password prompt would wait forever.
    [ -t 0 ] || as_root=(sudo -n)
  fi

  echo "setup.sh: installing ${missing[*]}" >&2
  log=$(mktemp)
  trap 'rm -f "$log"' EXIT
  apt_get() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y \
      -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "$@" </dev/null >"$log" 2>&1
  }
  for arguments in update "install --no-install-recommends ${missing[*]}"; do
    # shellcheck disable=SC2086  # the arguments are words
    if ! apt_get $arguments; then
      tail -n 20 "$log" >&2
      give_up "apt-get ${arguments%% *} failed"
    fi
  done
}

# install_node_packages FOLDER WHAT: what its lock file names and nothing else; the stamp is the copy of
# that at the last installation.
install_node_packages() {
  local folder stamp
  folder=$(dirname "${BASH_SOURCE[0]}")/../$1
  stamp=$folder/node_modules/.installed-lock.json
  cmp -s "$folder/package-lock.json" "$stamp" && return 0
  echo "setup.sh: installing the packages of $2" >&2
  if ! (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >&2); then
    echo "setup.sh: npm could not install them; tests of $2 will be skipped" >&2
    rm -rf "$folder/node_modules"
    return 0
  fi
  cp "$folder/package-lock.json" "$stamp"
}

install_packages
if [ -n "$with_page" ]; then
  install_node_packages eval/report/page "the report's page"
  install_node_packages tests/ros2 "ROS 2 bags of other writers"
fi
[ -z "${with_types:-}" ] || install_node_packages tests/python "Python's types"
