# Sourced by scripts that need a machine where nothing is installed: sets `root` to a new folder with
# Debian 12 (mmdebstrap, minbase), removed at exit, and defines in_root. Needs root and mmdebstrap.
# Packages come from where this machine takes them. Ends with exit code 77 where that cannot be done.
# shellcheck shell=bash
root=$(mktemp -d)
remove_root() {
  umount "$root/proc" 2>/dev/null || true
  rm -rf --one-file-system "$root" "$root.apt"
}
trap remove_root EXIT

mapfile -t sources < <(find /etc/apt/sources.list /etc/apt/sources.list.d -name '*.list' -o -name '*.sources' 2>/dev/null)
apt-config dump Acquire | grep -iE 'proxy|retries' >"$root.apt" || true
{
  mmdebstrap --quiet --variant=minbase --aptopt="$root.apt" bookworm "$root" "${sources[@]}" &&
    mount -t proc proc "$root/proc"
} || { echo "SKIPPED: this machine cannot make a clean root" >&2; exit 77; }
cp /etc/resolv.conf "$root/etc/resolv.conf"

# Runs a command in it, with nothing of this machine's environment.
in_root() {
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive chroot "$root" "$@"
}
