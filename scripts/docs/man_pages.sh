#!/usr/bin/env bash
# man_pages.sh MOSBENCH FOLDER: writes mosbench.1 and a page per command, mosbench-run.1 and so on, from
# the program's own --help. Needs help2man.
set -euo pipefail
[ $# = 2 ] || { echo "usage: man_pages.sh MOSBENCH FOLDER" >&2; exit 2; }
mosbench=$1 folder=$2
version=$("$mosbench" --version | cut -d' ' -f2)
mkdir -p "$folder"

# page NAME DESCRIPTION WORDS...: writes the page of a command line. The edits name it as man does, and keep
# the lines of the examples apart.
page() {
  local name=$1 description=$2
  shift 2
  help2man --no-info --help-option=--help-all --name "$description" --version-string "$version" --source "mosbench $version" "$*" |
    sed -E -e "s/^\.TH MOSBENCH/.TH ${name^^}/" \
      -e "/^\.SH NAME/ { n; s/^.* \\\\-/$name \\\\-/ }" \
      -e '/^\.SH EXAMPLES/,$ { s/^\.IP/.IP\n.nf/; s/^\.PP/.fi\n.PP/ }' >"$folder/$name.1"
}

page mosbench "moving object segmentation in LiDAR scans" "$mosbench"
"$mosbench" help --completion commands | while IFS=$'\t' read -r name description; do
  page "mosbench-$name" "$description" "$mosbench" "$name"
done
