"""The words of the interface in another language."""

import ast
import json
import re
from pathlib import Path

import pytest

import editor
import kinetix
from editor.actions import ACTIONS
from editor.base import language
from editor.base.language import Language, languages, own_faults, read_words, tr, use
from editor.toolkit.appearance import Icons

HOLE = re.compile(r"\{\d\}")
OWN = [code for code, _ in languages() if code != "en"]
WORDS = {
    "Save": "Speichern",
    "Circle {0}": "Kreis {0}",
    "Name of {0}": "Name von {0}",
    "{0} of {1}": "{1} davon {0}",
    "Step {0}": "Schritt {0}",
    "Step Back": "Zurück",
    "{0} in Play": "{0} im Spiel",
    "{0} of {1} won": "{0} von {1} gewonnen",
    "Wrote {0!}": "{0!} geschrieben",
}


@pytest.fixture(autouse=True)
def english():
    yield
    use("en")


@pytest.mark.parametrize(
    ("english", "expected"),
    [
        ("Step Back in Play", "Zurück im Spiel"),
        ("Save", "Speichern"),
        ("\uf0c7  Save", "\uf0c7  Speichern"),
        ("  Save ", "  Speichern "),
        ("Circle 12", "Kreis 12"),
        ("Name of Circle 12", "Name von Kreis 12"),
        ("Name of My car", "Name von My car"),
        ("3 of 4", "4 davon 3"),
        ("3 of 4 won", "3 von 4 gewonnen"),
        ("Nothing of the kind", "the kind davon Nothing"),
        ("Unknown words", "Unknown words"),
        ("Step by step. We come nearer.", "Step by step. We come nearer."),
        ("Circle the word that fits best here", "Circle the word that fits best here"),
        ("Wrote Save", "Save geschrieben"),
        ("", ""),
        ("12.5", "12.5"),
        ("Save\nMy car\n\nStep 2", "Speichern\nMy car\n\nSchritt 2"),
        ("Name of 100 % (a+b)", "Name von 100 % (a+b)"),
        ("Circle 1\nName of Circle 2", "Kreis 1\nName von Kreis 2"),
    ],
)
def test_words_are_found_whole_and_by_their_form(english, expected):
    assert Language(WORDS).translate(english) == expected


def test_what_was_translated_is_not_translated_again():
    spoken = Language({"Save": "Open", "Open": "Zu"})
    assert spoken.translate(spoken.translate("Save")) == "Open"


def test_ids_stay_and_english_is_as_it_is(monkeypatch):
    assert tr("Save###file.save") == "Save###file.save"
    monkeypatch.setattr(language, "read_words", lambda code: WORDS)
    use("xx")
    assert tr("Save###file.save") == "Speichern###file.save"
    use("en")
    assert tr("Save") == "Save"


def test_a_language_can_be_added_and_corrected_by_one_file(tmp_path, monkeypatch):
    folder = tmp_path / "config"
    monkeypatch.setattr("editor.base.language.config_dir", lambda: folder)
    (folder / "languages").mkdir(parents=True)
    own = {"name": "Plattdüütsch", "words": {"Save": "Wohren", "{0} selected": "{1} utsöcht"}}
    (folder / "languages" / "nds.json").write_text(json.dumps(own))
    (folder / "languages" / "de.json").write_text(
        json.dumps({"name": "Deutsch", "words": {"Save": "Sichern"}})
    )
    languages.cache_clear()
    try:
        assert ("nds", "Plattdüütsch") in languages()
        assert read_words("nds") == {"Save": "Wohren"}  # a form with another hole is passed over
        assert read_words("de")["Save"] == "Sichern"
        assert read_words("de")["Open"] == "Öffnen"
    finally:
        languages.cache_clear()


def test_what_is_offered_can_be_read(tmp_path, monkeypatch):
    monkeypatch.setattr("editor.base.language.config_dir", lambda: tmp_path)
    (tmp_path / "languages").mkdir()
    own = json.dumps({"name": "Español", "words": {"Save": "Guardar"}})
    for code in ("es-419", "a b", "x" * 17):
        (tmp_path / "languages" / f"{code}.json").write_text(own)
    languages.cache_clear()
    try:
        offered = {code for code, _ in languages()} - {"en", *OWN}
        assert offered == {"es-419"}
        assert read_words("es-419") == {"Save": "Guardar"}
    finally:
        languages.cache_clear()


@pytest.mark.parametrize("code", ["zz", "../settings", "", "x" * 40])
def test_a_language_that_there_is_not_is_english(code):
    use(code)
    assert tr("Save") == "Save"


@pytest.mark.parametrize("text", ["", "[]", "{", '{"name": 3, "words": 4}', '{"words": {"a": 1}}'])
def test_a_damaged_file_is_english(tmp_path, monkeypatch, text):
    monkeypatch.setattr("editor.base.language._OWN", tmp_path)
    (tmp_path / "xx.json").write_text(text)
    use("xx")
    assert tr("Save") == "Save"


@pytest.mark.parametrize(
    "name, text, told",
    [
        ("xx", "{", "JSON"),
        ("xx", '{"words": {}}', r"\$\.name"),
        ("xx", '{"name": "X", "words": 4}', r"\$\.words"),
        ("xx", '{"name": "X", "words": {"Save": 4}}', r'\$\.words\["Save"\]'),
        ("xx", '{"name": "X", "words": {"a": "{0}", "b": 1, "c": "d"}}', "and of 1 more"),
        ("en", '{"name": "X", "words": {}}', "code of a language"),
        ("a b", '{"name": "X", "words": {}}', "code of a language"),
        ("xx", '{"name": "X", "words": {"Save": "S", "{0} selected": "{0} s"}}', None),
    ],
)
def test_what_a_file_of_the_users_lacks_is_told(tmp_path, monkeypatch, name, text, told):
    monkeypatch.setattr("editor.base.language.config_dir", lambda: tmp_path)
    path = tmp_path / "languages" / f"{name}.json"
    assert own_faults() == []
    path.parent.mkdir()
    path.write_text(text)
    if told is None:
        assert own_faults() == []
    else:
        (fault,) = own_faults()
        assert fault.startswith(f"{path}: ")
        assert re.search(told, fault)


@pytest.mark.parametrize("code", OWN)
def test_every_command_is_in_it(code):
    spoken = Language(read_words(code))
    for action in ACTIONS:
        for words in (action.label, action.tooltip, action.refusal, action.menu):
            spoken.translate(words)
    assert sorted(spoken.missing) == []


SENTENCES = (
    "Export 1 level as a set",
    "Export 3 levels as a set",
    f"{Icons.warning}  Ctrl+S is taken: Save. Give it to Open…?",
    f"{Icons.error}  Car: with an error or gone, no set takes it.",
    f"{Icons.error}  Car, Bus and 3 more: with an error or gone, no set takes it.",
    f"{Icons.close}  only one",
    "8 updates, 7 000 000 environment steps, newest agent at 7 000 000",
    "1 update, 100 environment steps",
    "10 parameters",
    "Forget 1 recent file",
    "10 parameters, with memory",
    "It can play, but this level has 3 circles (it knows 2).",
    "Car: It cannot play this level: it sees one size only, and this level is of a size with "
    "9 circles (it knows 8) and 1 joint (it knows 0). The planner plays instead.",
    "Update 5, SFL, 1 000 environment steps: the best 3 of 10 levels; "
    "2 came, 3 left since the page before",
    "#3   Update 5: learnt; the buffer was refilled. It was won 95% of the time by then.",
    "#3   Update 5: #4 took its place with a better score, its own was 0.300.",
    "score 0.1\nlearnability 0.100\nwon 50% of 3 episodes\ncame in at update 3, 2 ago\n"
    "edited from #3, from #4, from #5\nClick: the newest agent plays it.",
    "score unknown\nno episode ended on its last visit",
    "random: undecided after 12 steps",
    "random goes on: step 33 / 256",
    "random: time is up",
    "flat mlp, actor 2 × 128",
    "entity transformer, 2 layers of 128, actor 5 × 128, with memory",
    "sees symbolic flat, says multi discrete",
    "No folders and no .gif or .mp4 files here.",
    "preparing the levels",
    "compiling: start",
    "compiling: update",
    "evaluating 3/100 episodes",
    "ppo on list levels of size s",
)
"""Texts that are composed, with the signs before them."""


@pytest.mark.parametrize("code", OWN)
@pytest.mark.parametrize("words", SENTENCES)
def test_composed_sentences_are_in_it(code, words):
    spoken = Language(read_words(code))
    spoken.translate(words)
    assert sorted(spoken.missing) == []


@pytest.mark.parametrize("code", OWN)
def test_every_form_has_the_holes_of_the_english_one(code):
    for english, other in read_words(code).items():
        assert set(HOLE.findall(english)) == set(HOLE.findall(other)), english


FROM_ELSEWHERE = {
    "is a directory",
    "no such file or directory",
    "not a directory",
    "permission denied",
    "read-only file system",
    "it can play, but this level is of a size with",
    "it cannot play this level: it sees one size only, and this level is of a size with",
    "it cannot play this level: it sees one size only, and this level has",
    "wins leave the others at step",
    "a click opens it there",
    "carries its levels itself: there are no files to choose",
}
"""Reasons of the system, and sentences that are composed of more than two texts."""


def trees():
    """Yield every module of the app, parsed."""
    folders = [Path(editor.__file__).parent, Path(kinetix.__file__).parent]
    for path in (path for folder in folders for path in folder.rglob("*.py")):
        yield ast.parse(path.read_text(encoding="utf-8"))


def is_text(node):
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def bare(text):
    """Return a text in small letters, without the signs around it."""
    return text.lower().replace("_", " ").strip(" :;,.°")


def written(tree):
    """Texts of a module, pieces of composed ones included; docstrings are none."""
    nodes = list(ast.walk(tree))
    docstrings = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
    texts = (node.value for node in nodes if is_text(node) and id(node) not in docstrings)
    return [bare(text) for text in texts]


def counted(tree):
    """Nouns that a module counts, as in `1 level` and `3 levels`."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "plural":
            for word in filter(is_text, node.args[1:]):
                yield from (word.value, f"{word.value}s")


def stands(words, said):
    """Return whether words occur, and are no part of longer words."""
    at = said.find(words)
    while at >= 0:
        if not said[at - 1].isalpha() and not said[at + len(words) : at + len(words) + 1].isalpha():
            return True
        at = said.find(words, at + 1)
    return False


def composed(piece, said):
    """Return whether a piece occurs, or is the end of one text and the start of another."""
    cuts = [match.start() for match in re.finditer(r"[ :;,.]", piece)]
    halves = ((bare(piece[:at]), bare(piece[at:])) for at in cuts)
    return stands(piece, said) or any(
        first and second and f"\0{second}" in said and stands(f"{first}\0", said)
        for first, second in halves
    )


@pytest.mark.parametrize("code", OWN)
def test_nothing_is_in_it_that_the_app_never_says(code):
    """Every piece between the holes of a form stands in the source."""
    modules = list(trees())
    nouns = {noun for tree in modules for noun in counted(tree)}
    longest = "|".join(sorted(map(re.escape, nouns), key=len, reverse=True))
    holes = re.compile(rf"(?:\b\d+|\{{\d!?\}}) (?:{longest})\b|\{{\d!?\}}|\n")
    said = "\0" + "\0\0".join({text for tree in modules for text in written(tree)}) + "\0"
    stale = [
        english
        for english in read_words(code)
        for piece in map(bare, holes.split(english))
        if piece and piece not in FROM_ELSEWHERE and not composed(piece, said)
    ]
    assert stale == []


@pytest.mark.parametrize(
    "words",
    [
        "Made {}",
        "Moved {} to the trash",
        "{} was removed; the level is only here now.",
        "{} has unsaved changes: save or close it first.",
        "{}: newer parameters loaded.",
        "{} is called {} now.",
        "{} is open in another window",
        "Handed back to {}.",
        "3 levels of {}",
        "The set leaves unsaved changes out: {} and 3 more",
    ],
)
def test_names_in_sentences_are_left_as_they_are(words):
    use("de")
    for name in ("Circle", "Leap of faith"):
        said = tr(words.replace("{}", name))
        assert name in said and said != words.replace("{}", name)


def test_reasons_of_the_system_are_no_negations():
    use("de")
    said = tr("/x: cannot be made: No such file or directory")
    assert said == "/x: kann nicht angelegt werden: Datei oder Ordner nicht gefunden"
