"""Random corruption of files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

ODD_NUMBERS = (
    *("0", "-0.0", "-1", "1e308", "1e-308", "1e999", "5e-324", "nan", "inf", "-inf", "007", "1_0"),
    *("9" * 25, "9" * 400, "9" * 5000, "0x" + "f" * 300, "1e99999999999999999999", "1.", ".5"),
)
ODD_BYTES = (
    *(
        b"\x00",
        b"\xff\xfe",
        b"\xef\xbb\xbf",
        b"\xed\xa0\x80",
        b"\r",
        b"\r\n",
        b"\x1b[2J",
        b"\xe2\x80\xae",
    ),
    *("°".encode(), "🦾".encode(), b'"""', b"'''", b"\\u0000", b"\\U0010ffff", b"\\ud800", b"%s{}"),
    *(b"[" * 3000, b"{" * 50, b"a." * 2000, b"#", b"=", b'"', b"]", b"}", b",", b"\n\n", b"\\"),
)
ODD_VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 10**30, 10**400, 0.5, 1e308, 5e-324, float("nan"), float("inf")),
    *("", "x", "L", "\ud800", "\x00", "a" * 10_000, "../../etc", "1e400", [], [[]], {}, {"": 0}),
    *([0] * 1000, [None], [1.0], {"a": {"b": 1}}),
)


def damaged_text(content: bytes, others: Sequence[bytes], random: np.random.Generator) -> bytes:
    """Damage a text file in one to four places.

    Parameters
    ----------
    content
        The file.
    others
        Files to take pieces from.
    random
        Decides.
    """
    for _ in range(int(random.integers(1, 5))):
        kinds = (_bits, _cut, _doubled, _inserted, _lines, _tokens, _tokens, _numbers, _pasted)
        kind = kinds[int(random.integers(len(kinds)))]
        content = kind(content, others, random)
    return content


def damaged_json(content: bytes, random: np.random.Generator) -> bytes:
    """Replace, remove or double one value of a JSON file by its structure."""
    document = json.loads(content)
    for _ in range(int(random.integers(1, 4))):
        table = document
        while True:
            keys = list(table) if isinstance(table, dict) else list(range(len(table)))
            if not keys:
                break
            key = keys[int(random.integers(len(keys)))]
            below = table[key]
            if isinstance(below, (dict, list)) and below and random.uniform() < 0.7:
                table = below
                continue
            what = random.integers(4)
            if what == 0:
                del table[key]
            elif what == 1 and isinstance(table, list):
                table.append(below)
            elif what == 1:
                table[f"{key}?"] = below
            else:
                table[key] = ODD_VALUES[int(random.integers(len(ODD_VALUES)))]
            break
    return json.dumps(document).encode("utf-8")


def damaged_binary(content: bytes, random: np.random.Generator) -> bytes:
    """Damage a binary file: bits, cuts, zeros, pages in the wrong place."""
    data = bytearray(content)
    for _ in range(int(random.integers(1, 5))):
        if not data:
            break
        place, what = int(random.integers(len(data))), int(random.integers(6))
        if what == 0:
            data[place] ^= 1 << int(random.integers(8))
        elif what == 1:
            data[place] = int(random.integers(256))
        elif what == 2:
            del data[place:]
        elif what == 3:
            length = int(random.integers(1, 5000))
            data[place : place + length] = bytes(len(data[place : place + length]))
        elif what == 4:
            data[place:place] = random.bytes(int(random.integers(1, 200)))
        else:
            page = place // 4096 * 4096
            other = int(random.integers(len(data))) // 4096 * 4096
            data[page : page + 4096] = data[other : other + 4096]
    return bytes(data)


def _bits(content: bytes, others: Sequence[bytes], random: np.random.Generator) -> bytes:
    data = bytearray(content)
    for _ in range(int(random.integers(1, 4))):
        if data:
            data[int(random.integers(len(data)))] ^= 1 << int(random.integers(8))
    return bytes(data)


def _cut(content: bytes, others: Sequence[bytes], random: np.random.Generator) -> bytes:
    first, last = _piece(content, random)
    return content[:first] if random.uniform() < 0.1 else content[:first] + content[last:]


def _doubled(content: bytes, others: Sequence[bytes], random: np.random.Generator) -> bytes:
    first, last = _piece(content, random)
    return content[:last] + content[first:]


def _inserted(content: bytes, others: Sequence[bytes], random: np.random.Generator) -> bytes:
    place = int(random.integers(len(content) + 1))
    return content[:place] + ODD_BYTES[int(random.integers(len(ODD_BYTES)))] + content[place:]


def _lines(content: bytes, others: Sequence[bytes], random: np.random.Generator) -> bytes:
    lines = content.splitlines(keepends=True)
    if len(lines) < 2:
        return content
    one, other = (int(i) for i in random.integers(len(lines), size=2))
    what = random.integers(3)
    if what == 0:
        lines[one], lines[other] = lines[other], lines[one]
    elif what == 1:
        del lines[one]
    else:
        lines.insert(other, lines[one])
    return b"".join(lines)


def _tokens(content: bytes, others: Sequence[bytes], random: np.random.Generator) -> bytes:
    """Replace a word by another one."""
    words = content.split(b" ")
    one, other = (int(i) for i in random.integers(len(words), size=2))
    source = words
    if others and random.uniform() < 0.5:
        source = others[int(random.integers(len(others)))].split(b" ")
        other = int(random.integers(len(source)))
    words[one] = source[other]
    return b" ".join(words)


def _numbers(content: bytes, others: Sequence[bytes], random: np.random.Generator) -> bytes:
    """Replace a number by an odd one."""
    places = [i for i, byte in enumerate(content) if 48 <= byte < 58]
    if not places:
        return content
    first = last = places[int(random.integers(len(places)))]
    while last < len(content) and 48 <= content[last] < 58:
        last += 1
    odd = ODD_NUMBERS[int(random.integers(len(ODD_NUMBERS)))]
    return content[:first] + odd.encode() + content[last:]


def _pasted(content: bytes, others: Sequence[bytes], random: np.random.Generator) -> bytes:
    if not others:
        return content
    source = others[int(random.integers(len(others)))]
    first, last = _piece(source, random)
    place = int(random.integers(len(content) + 1))
    return content[:place] + source[first:last] + content[place:]


def _piece(content: bytes, random: np.random.Generator) -> tuple[int, int]:
    first = int(random.integers(len(content) + 1))
    return first, min(len(content), first + int(random.geometric(0.02)))
