"""`kinetix sample`: files of its names that hold something else; the generator stands in."""

import pytest

from kinetix.cli import main
from kinetix.environment.generators import documents
from kinetix.level.codec import load_level, save_level

NAMES = ["random_s_7_0000.json", "random_s_7_0001.json", "random_s_7_0002.json"]


@pytest.fixture
def sample(monkeypatch, tmp_path):
    level = load_level("s/first_flight")

    def random_levels(seed, size, count):
        return (level.replace(name=f"random {seed} {k}") for k in range(count))

    monkeypatch.setattr(documents, "random_levels", random_levels)
    arguments = ["sample", str(tmp_path), "--size", "s", "--count", "3", "--seed", "7"]
    return lambda *more: main([*arguments, *more])


def test_the_same_call_again_changes_nothing(sample, tmp_path):
    assert sample() == 0
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert sorted(before) == NAMES
    assert sample() == 0
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_level_that_was_edited_is_kept(sample, tmp_path, capsys):
    sample()
    edited = tmp_path / NAMES[1]
    save_level(load_level(edited).replace(name="mine"), edited)
    assert sample() == 1
    assert load_level(edited).name == "mine"
    told = capsys.readouterr().err
    assert NAMES[1] in told and "--overwrite" in told and "Traceback" not in told
    assert sample("--overwrite") == 0
    assert load_level(edited).name == "random 7 1"
    assert load_level(edited.with_name(f"{NAMES[1]}.bak")).name == "mine"


def test_every_edited_level_is_kept(sample, tmp_path):
    sample()
    edited = tmp_path / NAMES[1]
    for name in ("first", "second"):
        save_level(load_level(edited).replace(name=name), edited)
        assert sample("--overwrite") == 0
    assert load_level(f"{edited}.bak").name == "second"
    assert load_level(f"{edited}.bak2").name == "first"


def test_levels_that_are_over_as_they_begin_are_counted(sample, tmp_path, capsys, monkeypatch):
    assert sample() == 0
    assert capsys.readouterr().err == f"{tmp_path}: 3 levels\n"
    fair = load_level("s/first_flight")
    (blue,) = (body for body in fair.bodies if body.role == "blue")
    bodies = [
        body.replace(position=blue.position) if body.role == "green" else body
        for body in fair.bodies
    ]
    decided = fair.replace(bodies=tuple(bodies))
    monkeypatch.setattr(documents, "random_levels", lambda *_: iter([fair, decided, fair]))
    assert sample("--overwrite") == 0
    assert ", 1 of them over as they begin" in capsys.readouterr().err
