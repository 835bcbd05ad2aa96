"""Policies beside each other, against numbers worked out by hand."""

import csv
import dataclasses
import io
import json
import os

import pytest

from kinetix.agents.compare import (
    Contender,
    common_levels,
    differences,
    labels_of,
    leaderboard,
    paired,
    unlike,
)
from kinetix.agents.comparison_files import (
    _EPISODE_BYTES,
    _LEVEL_BYTES,
    check_size,
    misfit_of,
    signed,
    text_of,
)
from kinetix.agents.results import EpisodeResult, LevelFailure, LevelResult, Provenance
from kinetix.agents.stored_comparison import check_replaced, is_comparison, read_comparison
from kinetix.cli import main
from kinetix.cli.compare import _print
from kinetix.errors import KinetixError
from kinetix.files.limits import LIMITS


def _whence(agent="a", digest="1" * 64, physics="balanced", **known):
    return Provenance(
        agent=agent,
        digest=digest,
        physics=physics,
        seed=0,
        attempts=4,
        deterministic=False,
        **known,
    )


def _level(name, outcomes):
    episodes = [
        EpisodeResult(outcome="won" if o == "w" else "lost", total_reward=0.0, length=9)
        for o in outcomes
    ]
    return LevelResult.of(name, episodes)


def _contender(label, *results):
    return Contender(label=label, provenance=_whence(label), results=results)


A = _contender("a", _level("s/x", "wwww"), _level("s/y", "wwll"))
B = _contender("b", _level("s/x", "wlll"), LevelFailure(level="s/y", error="too <large>"))
C = _contender("c", _level("s/x", "wwww"), _level("s/y", "llww"))


def test_equal_attempts_are_compared():
    pair = paired(A, C)
    assert (pair.levels, pair.difference, pair.better, pair.worse) == (2, 0.0, 2, 2)
    # x: (0.5 + 0.5)/6 discordant; y: 5/6; variances (1/6)/6 and (5/6)/6; z/2 times their root.
    half = 1.959964 * ((1 / 6 + 5 / 6) / 6) ** 0.5 / 2
    assert (pair.low, pair.high) == pytest.approx((-half, half))


def test_a_level_that_one_cannot_play_counts_for_nobody():
    pair = paired(A, B)
    assert (pair.levels, pair.difference) == (1, 0.75)
    assert common_levels([A, B, C]) == ["s/x"]
    board = leaderboard([B, A, C])
    assert [(row["rank"], row["label"]) for row in board] == [(1, "a"), (2, "c"), (3, "b")]
    assert [row["mean_solve_rate"] for row in board] == [1.0, 1.0, 0.25]
    assert [row["played"] for row in board] == [2, 2, 1]
    assert [(d.first, d.second) for d in differences([A, B, C])] == [
        ("a", "b"),
        ("a", "c"),
        ("b", "c"),
    ]


def test_policies_of_one_name_are_told_apart():
    same = [_whence(), _whence(digest="2" * 64), _whence("other"), _whence()]
    assert labels_of(same) == ["a 111111", "a 222222", "other", "a 111111 (2)"]


def test_files_have_everything():
    hashes = {"s/x": "f" * 64, "s/y": "e" * 64}
    document = json.loads(text_of(".json", [A, B], hashes, "1.2"))
    assert document["levels"] == hashes
    first = document["policies"][0]
    assert (first["digest"], first["physics"], first["seed"]) == ("1" * 64, "balanced", 0)
    assert first["results"][1]["episodes"][0] == ["won", 9, 0.0]
    rows = list(csv.DictReader(io.StringIO(text_of(".csv", [A, B], hashes, "1.2"))))
    assert [(row["label"], row["level"], row["error"]) for row in rows][-1] == (
        "b",
        "s/y",
        "too <large>",
    )
    page = text_of(".html", [A, B], hashes, "1.2")
    assert "too &lt;large&gt;" in page
    assert ">0.25</td>" in page


@pytest.mark.parametrize(
    ("value", "told"), [(-0.0001, "+0.000"), (-0.001, "-0.001"), (0.5, "+0.500"), (None, "–")]
)
def test_what_rounds_to_nothing_has_no_minus(value, told):
    assert signed(value) == told


@pytest.mark.slow
def test_the_command_measures_prints_and_writes(tmp_path, capsys):
    command = ["compare", "--agents", "noop", "random", "--levels", "s/first_flight"]
    out = tmp_path / "a" / "page.html"
    assert main([*command, "--attempts", "3", "--json", "--out", str(out)]) == 0
    *lines, pair, board = map(json.loads, capsys.readouterr().out.splitlines())
    assert [line["agent"] for line in lines] == ["noop", "random"]
    assert (pair["first"], pair["second"], pair["levels"]) == ("noop", "random", 1)
    assert len(board["leaderboard"]) == 2
    assert out.read_text().startswith("<!doctype html>")
    assert main([*command, "--out", "x.txt"]) == 1


def test_a_stored_comparison_is_read_again(tmp_path):
    """Everything that it holds comes back; written again it is the same file."""
    hashes = {"s/x": "1" * 64, "s/y": "2" * 64}
    text = text_of(".json", [A, B, C], hashes, "1.0")
    path = tmp_path / "compared.json"
    path.write_text(text)
    assert is_comparison(path)
    found = read_comparison(path)
    assert found.contenders == (A, B, C) and found.hashes == hashes
    assert text_of(".json", found.contenders, found.hashes, "1.0") == text


def test_settings_that_are_not_known_are_not_guessed(tmp_path):
    """Of an older file nothing is said; of a newer one all that was known comes back."""
    known = _whence("c", frame_skip=4, dense_reward_scale=0.1, card_digest="3" * 16)
    told = dataclasses.replace(C, provenance=known)
    path = tmp_path / "compared.json"
    path.write_text(text_of(".json", [A, told], {"s/x": "1", "s/y": "2"}, "1.0"))
    old, new = read_comparison(path).contenders
    assert (old.provenance, new.provenance) == (A.provenance, known)
    assert not {"frame_skip", "dense_reward_scale", "card_digest"} & set(old.provenance.as_dict())
    assert not unlike([old, new])


def test_settings_that_differ_are_told(capsys):
    one = dataclasses.replace(
        A, provenance=_whence("a", frame_skip=2, dense_reward_scale=0.2, card_digest="2" * 16)
    )
    other = dataclasses.replace(
        C, provenance=_whence("c", frame_skip=4, dense_reward_scale=0.2, card_digest="3" * 16)
    )
    sentences = unlike([one, other, B])
    assert sentences == [
        "frame skip: a 2, c 4, b not known; their steps are of different lengths",
        "a and c have the same parameters, and cards that differ",
    ]
    assert not unlike([one, one, B])
    page = text_of(".html", [one, other], {"s/x": "1", "s/y": "2"}, "1.0")
    assert "<p>frame skip: a 2, c 4; their" in page
    _print([one, other], [], as_json=False)
    assert "    frame skip: a 2, c 4; their" in capsys.readouterr().out


def test_a_comparison_that_could_not_be_read_again_is_refused_before_it_is_measured(tmp_path):
    """An episode takes no more than the check allows for it."""
    outcome = EpisodeResult(outcome="timeout", total_reward=-0.12345678901234567, length=4096)
    many = _contender("a", LevelResult.of("s/x" * 20, [outcome] * 10_000))
    size = len(text_of(".json", [many], {}, "1.0"))
    assert size < 10_000 * _EPISODE_BYTES + _LEVEL_BYTES
    with pytest.raises(KinetixError, match=r"a\.json: expected at most 64 MiB, 2000000 attempts"):
        check_size(tmp_path / "a.json", 1, ["x"], 2_000_000)
    check_size(tmp_path / "a.csv", 1, ["x"], 2_000_000)
    check_size(tmp_path / "a.json", 1, ["x"], 1_000_000)


def test_the_names_of_levels_count_for_the_size_of_a_file(tmp_path, monkeypatch):
    outcome = EpisodeResult(outcome="timeout", total_reward=-0.12345678901234567, length=4096)
    names = [f"{'é' * 120}{k}" for k in range(300)]
    one = _contender("a", *(LevelResult.of(name, [outcome]) for name in names))
    text = text_of(".json", [one], dict.fromkeys(names, "f" * 64), "1.0")
    path = tmp_path / "a.json"
    assert misfit_of(path, text) is None
    limit = dataclasses.replace(LIMITS["kept"], largest=len(text) - 1)
    monkeypatch.setitem(LIMITS, "kept", limit)
    with pytest.raises(KinetixError, match="1 attempt of 1 policy in 300 levels"):
        check_size(path, 1, names, 1)
    assert (misfit_of(path, text) or "").startswith(f"{path}: has ")
    assert misfit_of(tmp_path / "a.csv", text) is None


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with names are of POSIX systems")
def test_a_pipe_is_no_comparison_and_nothing_waits_for_it(tmp_path):
    os.mkfifo(tmp_path / "pipe.json")
    assert not is_comparison(tmp_path / "pipe.json")


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda tree: tree.update(format="x"), "expected a comparison"),
        (lambda tree: tree.update(version=9), "version: expected 1"),
        (lambda tree: tree["policies"][0]["results"].pop(), r"policies\[0\].results"),
        (lambda tree: tree["policies"][0]["results"][0]["episodes"].pop(), "4 attempts, got 3"),
        (lambda tree: tree["policies"][0]["results"][0]["episodes"][0].pop(), "episodes"),
        (lambda tree: tree["policies"][1].update(seed=5), "one seed"),
        (lambda tree: tree.update(policies=[]), "at least one policy"),
    ],
)
def test_a_bad_comparison_is_one_sentence(tmp_path, change, sentence):
    tree = json.loads(text_of(".json", [A, B], {"s/x": "1", "s/y": "2"}, "1.0"))
    change(tree)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(tree))
    with pytest.raises(KinetixError, match=sentence):
        read_comparison(path)


def test_what_is_written_is_there_before_anything_is_printed(tmp_path, monkeypatch):
    out, there = tmp_path / "all.json", []
    for name, value in (
        ("levels_to_measure", lambda levels: []),
        ("named", lambda levels: []),
        ("_players", lambda name, every: []),
        ("_measured", lambda *of: [A, C]),
        ("_print", lambda *of, as_json: there.append(out.exists())),
    ):
        monkeypatch.setattr(f"kinetix.cli.compare.{name}", value)
    assert main(["compare", "--agents", "noop", "--levels", "s", "--out", str(out)]) == 0
    assert there == [True]


def test_a_level_is_not_replaced_by_a_comparison(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("kinetix.cli.compare.levels_to_measure", None)  # refused before
    out = tmp_path / "mine.json"
    out.write_text('{"format": "kinetix-level"}')
    assert main(["compare", "--agents", "noop", "--levels", str(out), "--out", str(out)]) == 1
    assert "mine.json: is no comparison, and stays" in capsys.readouterr().err
    assert out.read_text() == '{"format": "kinetix-level"}'
    out.write_text('{"format": "kinetix-comparison"}')
    check_replaced(out)
