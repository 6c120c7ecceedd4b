"""Takes rights from this process, so that no defect of the program can harm the machine."""

import ctypes
import os
import pathlib

import program

NOBODY = 65534
_NEW_MOUNTS, _NEW_USER = 0x00020000, 0x10000000
_PRIVATE_AND_BELOW = 1 << 18 | 1 << 14
_DUMPABLE = 4
_SMALL_DISK = b"size=3m,mode=0777"


def share(folder):
    """Makes a folder that all may write to."""
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    os.chmod(folder, 0o777)


def _mount_small_disk(folder):
    """Mounts a small file system that only this process and its children see; '' where that is not allowed."""
    libc = ctypes.CDLL(None)
    user, group = os.getuid(), os.getgid()
    if libc.unshare(_NEW_MOUNTS | (0 if user == 0 else _NEW_USER)) != 0:
        return ""
    if user != 0:
        for name, text in (("setgroups", "deny"), ("uid_map", f"0 {user} 1"), ("gid_map", f"0 {group} 1")):
            pathlib.Path(f"/proc/self/{name}").write_text(text)
    os.makedirs(folder, exist_ok=True)
    libc.mount(b"none", b"/", None, _PRIVATE_AND_BELOW, None)
    mounted = libc.mount(b"tmpfs", os.fsencode(folder), b"tmpfs", 0, _SMALL_DISK) == 0
    return folder if mounted else ""


def enter(bench, number):
    """Gives this process a folder of its own, a small disk, limits, and the rights of nobody."""
    # Deep enough that ../../x stays in the scratch folder.
    top = os.path.join(bench.scratch, str(number))
    bench.case = os.path.join(top, "a/b/c/case")
    is_root = os.getuid() == 0
    os.makedirs(os.path.dirname(bench.case), mode=0o777)
    bench.small_disk = _mount_small_disk(os.path.join(top, "small"))
    bench.full_device = os.open("/dev/full", os.O_WRONLY)
    program.limit_this_process(bench.program)
    if not is_root:
        return
    for folder in (top, f"{top}/a", f"{top}/a/b", f"{top}/a/b/c"):
        os.chown(folder, NOBODY, NOBODY)
    os.setgroups([])
    os.setgid(NOBODY)
    os.setuid(NOBODY)
    # Else /proc of this process and its children belongs to root.
    ctypes.CDLL(None).prctl(_DUMPABLE, 1, 0, 0, 0)
