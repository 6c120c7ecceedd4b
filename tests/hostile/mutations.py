"""Seeded damage to bytes and to trees of files."""

import json
import os
import re
import struct

WORDS = [
    b"", b" ", b"\n", b"\r\n", b"\0", b"\t", b",", b",,", b"-", b".", b"..", b"/", b"../../x", b"#", b'"', b"'", b"{", b"}",
    b"[", b"]", b":", b"null", b"true", b"{}", b"[]", b"nan", b"NaN", b"-nan", b"inf", b"-inf", b"Infinity", b"0x10", b"1e309", b"-1e309",
    b"1e-400", b"-0", b"0", b"-1", b"1", b"2", b"0.5", b"127", b"255", b"256", b"65535", b"65536", b"2147483647",
    b"-2147483648", b"4294967295", b"4294967296", b"9223372036854775807", b"-9223372036854775808",
    b"18446744073709551615", b"18446744073709551616", b"1e5", b"1e18", b"1e19", b"1e300", b"1e-300", b"99999999999",
    b"0000000000000000000001", b"+1", b"1.", b".1", b"1,5", b"1_000", b"\xff", b"\xc3\x28", b"\xef\xbb\xbf",
    b"\xe2\x80\xae", b"\x1b[31m", b"%s%n", b"$(x)", b"=1+1", b"a" * 300, b"9" * 400, b"Tr:", b"DATA", b"POINTS 4",
]
NUMBERS = [struct.pack(form, value) for form, values in (
    ("<f", [0.0, -0.0, float("nan"), float("inf"), float("-inf"), 1e38, -1e38, 1e-40, 1e9, 1e5]),
    ("<I", [0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x10000, 251, 9]),
    ("<Q", [0, 1, 0x7FFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF, 1 << 32]),
    ("<d", [float("nan"), float("inf"), 1e308, 5e-324]),
) for value in values]
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def flip_bits(random, data, other):
    changed = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 8)) if data else 0):
        changed[random.randrange(len(changed))] ^= 1 << random.randrange(8)
    return bytes(changed)


def truncate(random, data, other):
    return data[:random.randrange(len(data) + 1)]


def remove_piece(random, data, other):
    at = random.randrange(len(data) + 1)
    return data[:at] + data[at + random.choice((1, 2, 4, 16, 64, 1000)):]


def repeat_piece(random, data, other):
    at = random.randrange(len(data) + 1)
    return data[:at] + data[at:at + random.choice((1, 4, 16, 64, 1000))] * random.choice((2, 2, 3, 50)) + data[at:]


def splice(random, data, other):
    at, start = random.randrange(len(data) + 1), random.randrange(len(other) + 1)
    return data[:at] + other[start:start + random.choice((4, 16, 100, 5000))] + data[at:]


def swap_file(random, data, other):
    return other


def insert_word(random, data, other):
    at = random.randrange(len(data) + 1)
    return data[:at] + random.choice(WORDS) + data[at:]


def replace_word(random, data, other):
    """Replaces one of the words of a text."""
    words = list(re.finditer(rb"[^\s,:\[\]{}]+", data))
    if not words:
        return random.choice(WORDS)
    match = random.choice(words)
    return data[:match.start()] + random.choice(WORDS) + data[match.end():]


def replace_number(random, data, other):
    numbers = list(NUMBER.finditer(data))
    if not numbers:
        return overwrite_number(random, data, other)
    match = random.choice(numbers)
    return data[:match.start()] + random.choice(WORDS[WORDS.index(b"nan"):]) + data[match.end():]


def overwrite_number(random, data, other):
    """Writes an extreme binary number at a multiple of four bytes."""
    number = random.choice(NUMBERS)
    at = 4 * random.randrange(len(data) // 4 + 1)
    return data[:at] + number + data[at + len(number):]


def change_lines(random, data, other):
    lines = data.split(b"\n")
    a, b = random.randrange(len(lines)), random.randrange(len(lines))
    change = random.randrange(5)
    if change == 0:
        lines[a], lines[b] = lines[b], lines[a]
    elif change == 1:
        del lines[a]
    elif change == 2:
        lines.insert(a, lines[b])
    elif change == 3:
        lines.sort()
    else:
        lines[a] = lines[a] + b" " + lines[b]
    return b"\n".join(lines)


def change_encoding(random, data, other):
    return random.choice((
        lambda: b"\xef\xbb\xbf" + data,
        lambda: data.replace(b"\n", b"\r\n"),
        lambda: data.replace(b"\n", b"\r"),
        lambda: b"\xff\xfe" + b"".join(bytes([byte, 0]) for byte in data),
        lambda: data.upper(),
        lambda: data.replace(b" ", b"\t"),
        lambda: data.replace(b".", b","),
        lambda: data.rstrip(b"\n"),
    ))()


def nest_deeply(random, data, other):
    """Puts brackets or keys inside one another where a value stands."""
    depth = random.choice((10, 65, 1000, 20_000, 400_000))
    opening, closing = random.choice(((b"[", b"]"), (b'{"a":', b"}"), (b"[", b""), (b'{"config":[', b"]}")))
    numbers = list(NUMBER.finditer(data))
    match = random.choice(numbers) if numbers else None
    start, end = match.span() if match else (0, 0)
    return data[:start] + opening * depth + data[start:end] + closing * depth + data[end:]


def _members(value):
    """(holder, key) of every value in a JSON document."""
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, each in list(pairs):
        yield value, key
        yield from _members(each)


def change_json(random, data, other):
    """Gives a member of a JSON document another type or value, or removes it; a word where it is no JSON."""
    try:
        document = json.loads(data.decode())
    except (ValueError, RecursionError):
        return replace_word(random, data, other)
    members = list(_members(document))
    if not members:
        return replace_word(random, data, other)
    holder, key = random.choice(members)
    change = random.randrange(10)
    if change == 0:
        del holder[key]
    elif change == 1 and isinstance(holder, dict):
        holder[str(key) + "x"] = holder.pop(key)
    elif change == 2:
        from_holder, from_key = random.choice(members)
        holder[key] = json.loads(json.dumps(from_holder[from_key])) if from_key in _keys(from_holder) else None
    else:
        holder[key] = random.choice((
            None, True, False, 0, 1, -1, 0.5, -0.5, 1e308, 2**31, 2**32, 2**63, 2**64, -(2**63), 10**30, "", "x", "nan",
            "../../x", "/tmp", "a\nb", "\x1b[2J", "\u202e", "a" * 5000, [], {}, [[]], [None], {"a": 1}, [1, 2, 3],
            "hmm-mos", "semantickitti", float("nan"), float("inf"),
        ))
    return json.dumps(document).encode()


def _keys(holder):
    return holder.keys() if isinstance(holder, dict) else range(len(holder))


def fill(random, data, other):
    """Bytes of one value: as long as the file, empty, or very long."""
    byte = random.choice((b"\0", b"\xff", b"9", b" ", b"\n", b"a"))
    return byte * random.choice((0, 1, 3, len(data), len(data), 1_000_000))


OF_BYTES = (
    [flip_bits] * 4 + [truncate] * 2 + [remove_piece] * 2 + [repeat_piece] * 2 + [splice] * 2 + [insert_word] * 2
    + [replace_word] * 3 + [replace_number] * 5 + [overwrite_number] * 3 + [change_lines] * 2 + [change_json] * 5
    + [change_encoding, swap_file, nest_deeply, fill]
)


def damage(random, data, other):
    """Between one and three kinds of damage."""
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        data = random.choice(OF_BYTES)(random, data, other)
        data = data[:4_000_000]
    return data


def _in_place_of(path, make):
    if os.path.lexists(path):
        os.remove(path)
    make(path)


NAMES = [b"08.partial", b"labels", b"scores", b"reasons", b"x.replaced", b"\xff\xfe", b"a b", b"a\nb", b"-x", b"=cmd()", b"\x1b[31m",
         b"a" * 255, b"$(touch x)", b"000001 (copy).bin", b"999999.label", b"..x", b"con", b"a,b", b'a"b', b"a|b"]


def _rename(path, name):
    """Gives a file or a folder another name; leaves it where that name is taken."""
    try:
        os.rename(path, os.path.join(os.path.dirname(os.fsencode(path)), name))
    except OSError:
        pass


def change_file(random, top, name):
    """Puts something that is no plain file in place of a file, or gives it or its folder another name."""
    path = os.path.join(top, name)
    link_to = lambda target: lambda: _in_place_of(path, lambda link: os.symlink(target, link))  # noqa: E731
    random.choice((
        lambda: os.remove(path),
        lambda: _in_place_of(path, os.mkfifo),
        lambda: _in_place_of(path, os.mkdir),
        link_to("absent"),
        link_to(os.path.basename(path)),
        link_to("/dev/null"),
        link_to("/dev/zero"),
        link_to("/proc/self/mem"),
        lambda: os.truncate(path, random.choice((0, 1, 1 << 16, 1 << 26))),
        lambda: _rename(path, random.choice(NAMES)),
        lambda: _rename(path, os.fsencode(os.path.basename(path)) + random.choice((b".bak", b".bin", b".partial", b" "))),
        lambda: _rename(os.path.join(top, name.split("/")[0]) if "/" in name else path, random.choice(NAMES)),
        lambda: _rename(os.path.dirname(path) if "/" in name else path, random.choice(NAMES)),
    ))()
