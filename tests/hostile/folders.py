"""Trees of small files: held in memory, written for a case, read again for comparison."""

import json
import os
import pathlib
import re
import shutil
import stat

# Members of result.json that tell when and where it was made.
OWN_KEYS = ("timing", "wall_s", "places")
# Names of what an interrupted write may leave.
UNFINISHED = r"\.partial|\.replaced|\.mosbench"


def load(folder):
    """{path: bytes} of the regular files below a folder."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(pathlib.Path(folder).rglob("*"))
        if path.is_file()
    }


def write(folder, tree):
    """Writes {path: bytes} below a folder."""
    made = set()
    for name, data in tree.items():
        path = os.path.join(folder, name)
        parent = os.path.dirname(path)
        if parent not in made:
            os.makedirs(parent, exist_ok=True)
            made.add(parent)
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        os.write(descriptor, data)
        os.close(descriptor)


def renew(folder, tree=None):
    """Makes a folder that holds only `tree`."""
    if os.path.lexists(folder):
        shutil.rmtree(folder)
    os.makedirs(folder)
    write(folder, tree or {})


def below(tree, prefix):
    """The part of a tree below a folder, with paths from there."""
    return {name[len(prefix) + 1:]: data for name, data in tree.items() if name.startswith(prefix + "/")}


def at(prefix, tree):
    return {f"{prefix}/{name}": data for name, data in tree.items()}


def _all_names(folder):
    top = os.fsencode(folder)
    for parent, folders, files in os.walk(top):
        below = parent[len(top) + 1:]
        for name in folders + files:
            yield os.path.join(below, name)


def leftovers(folder):
    """What an interrupted write leaves behind."""
    names = map(os.fsdecode, _all_names(folder))
    return sorted(name for name in names if re.search(UNFINISHED, os.path.basename(name)))


def _without_clock(name, data):
    """The bytes of a file without what depends on the clock and on the machine's speed."""
    if os.path.basename(name) != "result.json":
        return data
    try:
        value = json.loads(data.decode())
    except (ValueError, RecursionError):
        return data
    for key in OWN_KEYS:
        value.pop(key, None)
    return json.dumps(value).encode()


def contents(folder):
    """{path: bytes, or what else is there} below a folder, apart from times and locks."""
    found = {}
    for name in _all_names(folder):
        path = os.path.join(os.fsencode(folder), name)
        mode = os.lstat(path).st_mode
        text = os.fsdecode(name)
        if stat.S_ISREG(mode):
            with open(path, "rb") as file:
                found[text] = _without_clock(text, file.read())
        else:
            found[text] = {stat.S_IFDIR: "folder", stat.S_IFLNK: "link"}.get(stat.S_IFMT(mode), "special")
    return found


def difference(expected, found):
    """A sentence about the first difference of two contents; None when there is none."""
    for name in sorted(expected.keys() | found.keys()):
        if name not in found:
            return f"{name} is missing"
        if name not in expected:
            return f"{name} is not expected"
        if expected[name] != found[name]:
            return f"{name} differs"
    return None
