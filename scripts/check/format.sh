#!/usr/bin/env bash
# format.sh: checks that every tracked C++ file is formatted as .clang-format says, by clang-format 14
# (other versions format differently), and that what begins with #! can be started.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
version=$(clang-format --version)
[[ $version == *"version 14."* ]] || { echo "clang-format 14 is needed, this is: $version" >&2; exit 1; }
mapfile -t sources < <(git ls-files '*.cpp' '*.hpp')
[ ${#sources[@]} -gt 0 ] || { echo "no sources are tracked" >&2; exit 1; }
clang-format --dry-run -Werror "${sources[@]}"
while read -r file; do
  if [ "$(head -c 2 "$file")" = '#!' ] && [ ! -x "$file" ]; then
    echo "$file: cannot be started, expected chmod +x" >&2
    exit 1
  fi
done < <(git grep -lI '^#!')
echo "format of ${#sources[@]} files checked"
