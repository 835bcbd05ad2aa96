"""Damage, drawn from a seed: to parsed JSON, to its text, and to any bytes."""

import copy
import json
import random
import re
from typing import Any

NASTY: tuple[Any, ...] = (
    None,
    True,
    False,
    0,
    -1,
    1,
    2,
    3,
    10**9,
    2**31,
    2**53 + 1,
    2**63,
    -(2**64),
    10**40,
    0.5,
    -0.0,
    1e-45,
    1e-300,
    1e30,
    3.5e38,
    1e300,
    float("inf"),
    float("-inf"),
    float("nan"),
    "",
    "a",
    "s",
    "0",
    "../../../etc/passwd",
    "/etc/passwd",
    "\x1b[2J\x07",
    "\u202egnp.exe",
    "\ud800",
    "x" * 7000,
    "\0",
    [],
    {},
    [[]],
    [None],
    {"0": 1.0, "1": 2.0},
    {"": {}},
    {"type": "size", "size": "s", "params": {}},
    {"type": "full", "params": 3},
)
"""Values that readers forget."""
_PIECES = (b"\0", b"\xff", b"[" * 200, b"{", b"}", b'"', b"\\", b"NaN", b"1e999", b"-", b"\n", b",")


_MOST_PLACES = 200_000
"""Of a tree that is made larger; beyond, damaging takes longer than reading."""


class Mutator:
    """Equal seeds do equal damage."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def damaged(self, sample: bytes) -> bytes:
        """A sample with some damage; JSON mostly stays JSON."""
        if self.random.random() < 0.75 and sample[:1] in (b"{", b"["):
            try:
                tree = json.loads(sample)
            except (ValueError, RecursionError):
                return self._bytes(sample)
            for _ in range(self._few()):
                tree = self.tree(tree)
            text = json.dumps(tree, ensure_ascii=self.random.random() < 0.5)
            data = text.encode("utf-8", errors="surrogatepass")
            return self._bytes(data) if self.random.random() < 0.1 else data
        return self._bytes(sample)

    def tree(self, tree: Any) -> Any:
        """Parsed JSON in which one thing is wrong; the tree itself is changed."""
        places = _places(tree)
        if not places:
            return self.random.choice(NASTY)
        holder, key = self.random.choice(places)
        match self.random.randrange(8):
            case 0 | 1 | 2:
                holder[key] = copy.deepcopy(self.random.choice(NASTY))
            case 3:
                holder[key] = self._near(holder[key])
            case 4:
                del holder[key]
            case 5:
                other, from_key = self.random.choice(places)
                holder[key] = copy.deepcopy(other[from_key])
            case 6 if isinstance(holder, dict):
                holder[self.random.choice(("x", key + "x", "", "format", "\x1b"))] = 1
            case 6:
                times = self.random.choice((1, 2, 1100))
                times = min(times, _MOST_PLACES // len(places))
                holder[key:key] = [copy.deepcopy(holder[key])] * times
            case _:
                holder[key] = self._nested(holder[key])
        return tree

    def _near(self, value: Any) -> Any:
        """A value of the same type."""
        match value:
            case bool():
                return not value
            case int():
                return value + self.random.choice((-1, 1, 2, 100, -(10**6), 10**6))
            case float():
                return value * self.random.choice((-1.0, 0.0, 1e-6, 0.999, 1.001, 10.0, 1e6, 1e38))
            case str():
                return self.random.choice((value[:-1], value + "é", value.upper(), value * 9))
            case list():
                self.random.shuffle(value)
        return value

    def _nested(self, value: Any) -> Any:
        for _ in range(self.random.choice((1, 2, 40, 70))):
            value = [value] if self.random.random() < 0.5 else {"a": value}
        return value

    def _few(self) -> int:
        return self.random.choice((1, 1, 1, 2, 2, 3, 5))

    def _bytes(self, data: bytes) -> bytes:
        for _ in range(self._few()):
            at = self.random.randrange(len(data) + 1)
            end = min(len(data), at + self.random.choice((1, 1, 4, 40, 400)))
            match self.random.randrange(8):
                case 0:
                    data = data[:at]
                case 1:
                    data = data[:at] + data[end:]
                case 2:
                    data = data[:end] + data[at:]
                case 3:
                    flipped = bytes(byte ^ (1 << self.random.randrange(8)) for byte in data[at:end])
                    data = data[:at] + flipped + data[end:]
                case 4:
                    data = data[:at] + self.random.choice(_PIECES) + data[at:]
                case 5:
                    data = data[:at] + self.random.randbytes(end - at) + data[end:]
                case 6:
                    data = self._other_number(data)
                case _:
                    data = self._line_twice(data)
        return data

    def _other_number(self, data: bytes) -> bytes:
        numbers = list(re.finditer(rb"-?\d+(?:\.\d+)?", data))
        if not numbers:
            return data
        found = self.random.choice(numbers)
        text = self.random.choice(
            (b"0", b"-1", b"1e999", b"9" * 5000, b"1E400", b"00", b"0x10", b"1_0")
        )
        return data[: found.start()] + text + data[found.end() :]

    def _line_twice(self, data: bytes) -> bytes:
        lines = data.split(b"\n")
        at = self.random.randrange(len(lines))
        return b"\n".join([*lines[: at + 1], *lines[at:]])


def _places(tree: Any) -> list[tuple[Any, Any]]:
    """Return every (container, key) of a tree."""
    places, left = [], [tree]
    while left:
        holder = left.pop()
        if isinstance(holder, dict):
            places += [(holder, key) for key in holder]
            left += [value for value in holder.values() if isinstance(value, dict | list)]
        elif isinstance(holder, list):
            places += [(holder, k) for k in range(len(holder))]
            left += [value for value in holder if isinstance(value, dict | list)]
    return places
