"""The words of the interface in another language, from one file for each.

Everything in the app is said in English; `tr` gives what a person reads, where it is drawn. A file
`languages/CODE.json`, among those of the app or in the user's settings folder, holds the name of
the language and its words by the English ones. `{0}`, `{1}` … stand for what changes, which is
translated too: `"{0} selected": "{0} ausgewählt"`; `{0!}` stands for a name, which is not:
`"Saved {0!}": "{0!} gespeichert"`. What a file lacks stays English.
"""

import functools
import heapq
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from editor.base.state_file import read_state, state_fault
from kinetix.paths import config_dir

ENGLISH: Final = "en"
_OWN: Final = Path(__file__).resolve().parents[1] / "languages"
_CODE: Final = re.compile(r"[A-Za-z][A-Za-z0-9_-]{1,15}")
"""The codes of languages that are offered and read."""
_MOST_KEPT: Final = 8192
"""Of more sentences that were translated once, all are forgotten: some change with every frame."""
_AROUND: Final = re.compile(r"^([\s\ue000-\uf8ff●]*)(.*?)(\s*)$", re.DOTALL)
"""Signs and room before some words, the words, room after them."""
_HOLE: Final = re.compile(r"\{(\d)(!?)\}")
_DEEPEST: Final = 3
"""Depth to which holes may contain holes."""
_SAYS_MUCH: Final = 12
"""Templates with fewer fixed characters are ignored: they match unrelated sentences."""
_LONGEST_NAME: Final = 5
"""Most words of a name."""
_SENTENCE: Final = re.compile(r"[.?!;:] ")
"""Punctuation inside a sentence or after it."""


class Language:
    """The words of one language by the English ones."""

    def __init__(self, words: Mapping[str, str]) -> None:
        self.missing: set[str] = set()
        """Keys that were asked for and are not among the words; for translators."""
        self._exact = {english: other for english, other in words.items() if "{" not in english}
        self._kept: dict[str, str] = {}
        self._said: set[str] = set()
        """Texts already translated, which are left alone."""
        self._forms: dict[str, list[tuple[int, str, re.Pattern[str], str]]] = {}
        # Of two forms that fit, the one that says more is meant.
        forms = [(-len(_HOLE.sub("", form)), form) for form in words if _HOLE.search(form)]
        for length, english in sorted(forms):
            row = (length, english, _pattern(english), words[english])
            self._forms.setdefault(english[:1], []).append(row)

    def translate(self, words: str) -> str:
        """Return words in this language; what it lacks as it is."""
        found = self._kept.get(words)
        if found is None:
            if words in self._said:
                return words
            if len(self._kept) >= _MOST_KEPT:
                self._kept.clear()
                self._said.clear()
            found = self._kept[words] = self._translated(words, _DEEPEST)
            if found != words:
                self._said.add(found)
        return found

    def _translated(self, words: str, depth: int) -> str:
        found = self._found(words, depth)
        if found is None:
            self.missing.add(_parts(words)[1])
            return words
        return found

    def _found(self, words: str, depth: int) -> str | None:
        """Return words in this language; None where it lacks them."""
        before, inner, after = _parts(words)
        if not any(map(str.isalpha, inner)):
            return words
        found = self._exact.get(inner)
        if found is None:
            found = self._filled(inner, depth)
        if found is None and "\n" in inner:
            found = "\n".join(self._translated(line, depth) for line in inner.split("\n"))
        return None if found is None else before + found + after

    def _filled(self, words: str, depth: int) -> str | None:
        """Return words that fit a form, what stands in its holes translated where it can be."""
        if depth == 0:
            return None
        rows = heapq.merge(*(self._forms.get(start, ()) for start in {words[:1], "{"}))
        for length, english, pattern, form in rows:
            fits = pattern.fullmatch(words)
            if fits is None:
                continue
            holes = {digit: fits[f"p{digit}"] for digit, name in _HOLE.findall(english) if not name}
            short = -length < _SAYS_MUCH
            if short and any(self._is_sentence(part, depth - 1) for part in holes.values()):
                continue
            parts = {digit: fits[f"p{digit}"] for digit, _ in _HOLE.findall(english)}
            parts |= {digit: self._translated(part, depth - 1) for digit, part in holes.items()}
            return _HOLE.sub(lambda hole, parts=parts: parts[hole[1]], form)
        return None

    def _is_sentence(self, words: str, depth: int) -> bool:
        """Return whether words are a sentence, or more than one, that this language lacks."""
        said = len(words.split()) > _LONGEST_NAME or _SENTENCE.search(words) is not None
        return said and self._found(words, depth) is None


def _parts(words: str) -> tuple[str, str, str]:
    """Return signs and room before some words, the words, and the room after them."""
    around = _AROUND.match(words)
    assert around is not None
    return around[1], around[2], around[3]


def _pattern(form: str) -> re.Pattern[str]:
    """Return what matches the words that a form stands for: of one line, unless it has more."""
    parts = _HOLE.split(form)
    seen: set[str] = set()
    pattern = re.escape(parts[0])
    for number, literal in zip(parts[1::3], parts[3::3], strict=True):
        pattern += f"(?P=p{number})" if number in seen else f"(?P<p{number}>.+?)"
        pattern += re.escape(literal)
        seen.add(number)
    return re.compile(pattern, re.DOTALL if "\n" in form else 0)


class _Current:
    """The language that is spoken; None: English."""

    code = ENGLISH
    language: Language | None = None


def use(code: str) -> None:
    """Speak a language from now on; one that there is not, or a damaged one, is English."""
    if code != _Current.code:
        _Current.code = code
        words = {} if code == ENGLISH else read_words(code)
        _Current.language = Language(words) if words else None


def spoken() -> Language | None:
    """Return the language that is spoken; None: English."""
    return _Current.language


def tr(words: str) -> str:
    """Return what a person reads for some English words; an id after `###` stays as it is."""
    language = _Current.language
    if language is None or not words:
        return words
    shown, mark, identity = words.partition("###")
    return language.translate(shown) + mark + identity


@functools.cache
def languages() -> tuple[tuple[str, str], ...]:
    """Return code and name of every language that there is a file for, English first."""
    found: dict[str, str] = {}
    for folder in (_OWN, config_dir() / "languages"):
        for path in sorted(folder.glob("*.json")):
            if path.stem == ENGLISH or not _CODE.fullmatch(path.stem):
                continue
            name = _content(path).get("name")
            if isinstance(name, str) and name:
                found[path.stem] = name
    return ((ENGLISH, "English"), *found.items())


def read_words(code: str) -> dict[str, str]:
    """Return the words of a language, the user's own before those of the app."""
    words: dict[str, str] = {}
    if _CODE.fullmatch(code):
        for folder in (_OWN, config_dir() / "languages"):
            stored = _content(folder / f"{code}.json").get("words")
            if isinstance(stored, dict):
                words |= {
                    str(english): other
                    for english, other in stored.items()
                    if isinstance(other, str) and other and _same_holes(str(english), other)
                }
    return words


def own_faults() -> list[str]:
    """Return a sentence about each file of the user's of which not everything can be used."""
    return [
        fault
        for path in sorted((config_dir() / "languages").glob("*.json"))
        if (fault := _fault(path))
    ]


def _fault(path: Path) -> str:
    if not _CODE.fullmatch(path.stem) or path.stem == ENGLISH:
        return (
            f"{path}: expected the code of a language as its name, 2 to 16 letters and digits, as "
            f"pt-BR, and not {ENGLISH}"
        )
    fault = state_fault(path)
    if fault:
        return fault
    content = _content(path)
    name, words = content.get("name"), content.get("words")
    if not isinstance(name, str) or not name:
        return f"{path}: $.name: expected the language's name"
    if not isinstance(words, dict):
        return (
            f"{path}: $.words: expected an object, the other language's words by the English ones"
        )
    passed_over = [
        english
        for english, other in words.items()
        if not isinstance(other, str) or not _same_holes(english, other)
    ]
    if passed_over:
        more = f", and of {len(passed_over) - 1} more" if passed_over[1:] else ""
        return (
            f'{path}: $.words["{passed_over[0]}"]: expected text with no other hole than the '
            f"English words have; these words stay English{more}"
        )
    return ""


def _same_holes(english: str, other: str) -> bool:
    """Return whether a translation has no hole that the English words lack."""
    return {digit for digit, _ in _HOLE.findall(other)} <= {
        digit for digit, _ in _HOLE.findall(english)
    }


def _content(path: Path) -> dict[str, Any]:
    return read_state(path)
