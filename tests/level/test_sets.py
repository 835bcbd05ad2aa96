"""Level sets: building, loading, splitting, refusing."""

import dataclasses
import json
import os
import time
from collections import Counter
from pathlib import Path

import pytest

from kinetix.errors import LevelError
from kinetix.level.codec import level_hash, load_level, loads, save_level
from kinetix.level.model import Body, Circle, Level, Thruster
from kinetix.level.sets import (
    MAX_LEVELS,
    SetLevel,
    build_set,
    common_capacity,
    distinct,
    draw_split,
    dumps_set,
    evaluation_part,
    gather_levels,
    is_set_file,
    level_files,
    load_set,
    read_set,
    save_set,
    split_set,
    training_part,
)
from kinetix.level.sets.gather import _told_apart
from kinetix.level.sizes import SIZES

FIXTURES = Path(__file__).parent / "fixtures"


def game(k):
    return Level(
        name=f"game {k}",
        tags=("difficulty-1",),
        bodies=(
            Body(id=1, shape=Circle(radius=0.2), position=(1 + 0.1 * k, 2), role="green"),
            Body(id=2, shape=Circle(radius=0.2), position=(4, 2), role="blue"),
        ),
        thrusters=(Thruster(id=3, body=1, position=(0, 0)),),
    )


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "levels" / "s").mkdir(parents=True)
    for k in range(6):
        save_level(game(k), tmp_path / "levels" / "s" / f"g{k}.json")
    save_level(game(6), tmp_path / "levels" / "peer.json", format="kinetix-env")
    return tmp_path / "levels"


@pytest.fixture
def made(folder):
    return build_set(gather_levels([folder]), name="games", folder=folder)


def test_levels_of_one_name_are_told_apart(tmp_path):
    for k, name in enumerate(("p/x", "q/x", "q/x (2)", "r/x")):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        save_level(game(k), tmp_path / f"{name}.json")
    found = gather_levels([tmp_path / "p", tmp_path / "q", tmp_path / "r"])
    assert [each.name for each in found] == ["x", "x (2)", "x (3)", "x (4)"]
    assert [each.path.parent.name for each in found] == ["p", "q", "q", "r"]


def test_a_folder_is_every_level_below_it_but_no_set(folder, made):
    save_set(made, folder / "set.json")
    assert [path.name for path in level_files(folder)] == [
        "peer.json",
        *(f"g{k}.json" for k in range(6)),
    ]
    assert is_set_file(folder / "set.json")
    assert not is_set_file(folder / "peer.json")
    found = gather_levels([folder])
    assert [each.name for each in found] == ["peer", *(f"s/g{k}" for k in range(6))]
    assert found[1].tags == ("difficulty-1",)
    assert [each.sha256 for each in gather_levels([folder / "set.json"])] == [
        each.sha256 for each in found
    ]
    (folder / "empty").mkdir()
    with pytest.raises(LevelError, match="found none"):
        gather_levels([folder / "empty"])


@pytest.mark.parametrize("inline", [False, True])
def test_a_set_loads_the_levels_that_went_in(folder, made, inline):
    path = folder / "sets.json"
    save_set(made, path, inline=inline)
    loaded = load_set(path)
    assert [each.level for each in loaded.levels] == [each.level for each in made.levels]
    assert [each.split for each in loaded.levels] == [each.split for each in made.levels]
    assert loaded.capacity == SIZES["s"]
    assert loaded.manifest.engine_version
    tree = json.loads(path.read_text())
    assert ("path" in tree["levels"][0]) != inline
    assert ("level" in tree["levels"][0]) == inline
    assert dumps_set(loaded, inline=inline) == path.read_text()


def test_equal_levels_go_in_once(folder):
    renamed = game(2).replace(name="another name")
    save_level(renamed, folder / "z.json")
    made = build_set(gather_levels([folder]), name="games", folder=folder)
    assert len(made.levels) == 7
    assert [each.name for each in made.levels if each.sha256 == level_hash(renamed)] == ["s/g2"]


def test_agents_runs_and_hidden_folders_among_levels_are_left_out(folder):
    before = [each.path for each in gather_levels([folder])]
    for place in ("agent", "run/checkpoints/128", ".venv/lib"):
        (folder / place).mkdir(parents=True)
        (folder / place / "agent.json").write_text('{"format": "kinetix-agent"}')
        (folder / place / "progress.json").write_text("{}")
    (folder / "run" / "config.toml").write_text("")
    (folder / ".venv" / "lib" / "odd.json").write_text("{}")
    assert [each.path for each in gather_levels([folder])] == before
    with pytest.raises(LevelError, match="found none"):
        gather_levels([folder / "agent"])


def test_a_level_may_be_called_agent(folder):
    (folder / "s" / "g0.json").rename(folder / "agent.json")
    assert [each.name for each in gather_levels([folder])] == [
        "agent",
        "peer",
        *(f"s/g{k}" for k in range(1, 6)),
    ]


def test_folders_behind_links_and_names_in_capitals_are_found_once(folder, tmp_path):
    (folder / "s" / "g0.json").rename(folder / "s" / "G0.JSON")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    save_level(game(7), elsewhere / "g7.json")
    for name, target in (("a", folder / "s"), ("round", folder), ("z", elsewhere)):
        (folder / name).symlink_to(target)
    (elsewhere / "back").symlink_to(folder)
    assert [str(path.relative_to(folder)) for path in level_files(folder)] == [
        "peer.json",
        "s/G0.JSON",
        *(f"s/g{k}.json" for k in range(1, 6)),
        "z/g7.json",
    ]


def test_a_link_to_too_many_folders_is_refused(folder, tmp_path, monkeypatch):
    for k in range(3):
        (tmp_path / "disk" / str(k)).mkdir(parents=True)
    (folder / "link").symlink_to(tmp_path / "disk")
    monkeypatch.setattr("kinetix.files.walk.MOST_LINKED", 2)
    with pytest.raises(LevelError, match="link: the link leads past 2 folders"):
        level_files(folder).__next__()


def test_folders_without_numbers_are_told_apart(folder, monkeypatch):
    expected = list(level_files(folder))
    real = os.stat

    def numberless(path, **options):
        found = real(path, **options)
        return os.stat_result((found[0], 0, *found[2:]))

    monkeypatch.setattr("kinetix.files.walk.os.stat", numberless)
    assert list(level_files(folder)) == expected and len(expected) > 2


def test_many_levels_of_one_name_are_told_apart_in_time_that_grows_with_them():
    each = SetLevel(name="Untitled", level=Level(name="Untitled"))

    def seconds(count: int) -> float:
        start = time.process_time()
        _told_apart([each] * count)
        return time.process_time() - start

    few, many = (min(seconds(count) for _ in range(3)) for count in (1000, 8000))
    assert many < 24 * few  # 8 times where it grows with them, 64 times where with their square
    names = [one.name for one in _told_apart([each] * 8000)]
    assert (names[1], names[-1]) == ("Untitled (2)", "Untitled (8000)")


def test_levels_with_an_error_are_refused(folder):
    save_level(Level(name="empty"), folder / "bad.json")
    with pytest.raises(LevelError, match=r"bad\.json: \$: E101 No green"):
        build_set(gather_levels([folder]), name="games", folder=folder)
    save_level(Level(name="nothing either", gravity=(0.0, 1.0)), folder / "worse.json")
    with pytest.raises(LevelError, match="2 of 9 levels have errors") as told:
        build_set(gather_levels([folder]), name="games", folder=folder)
    assert "bad.json: $: E101" in str(told.value) and "worse.json: $: E101" in str(told.value)


def test_the_common_size_must_fit(folder):
    levels = gather_levels([folder, FIXTURES / "v1" / "cart_and_bell.json"])
    assert common_capacity(each.level for each in levels) == SIZES["m"]
    with pytest.raises(LevelError, match=r"cart_and_bell\.json: does not fit"):
        build_set(levels, name="x", folder=folder, size="s")
    assert build_set(levels, name="x", folder=folder, size="l").capacity == SIZES["l"]
    with pytest.raises(LevelError, match="at least one level"):
        common_capacity([])


def test_a_set_is_built_in_time_that_grows_with_its_levels(monkeypatch):
    asked = []
    monkeypatch.setattr(
        "kinetix.level.sets.manifest.capacity_of", lambda level: asked.append(1) or SIZES["s"]
    )
    levels = [SetLevel(name=str(k), level=game(k)) for k in range(10)]
    build_set(levels, name="games", folder=Path())
    assert len(asked) == len(levels)


def unreadable(made, name):
    levels, manifest = made.levels, made.manifest
    match name:
        case "long name":
            manifest = manifest.replace(name="x" * 121)
        case "no name":
            manifest = manifest.replace(name="")
        case "heavy level":
            entries = (manifest.levels[0].replace(weight=1e9), *manifest.levels[1:])
            manifest = manifest.replace(levels=entries)
        case "broken text":
            manifest = manifest.replace(name="caf\udce9")
        case "many levels":
            manifest = manifest.replace(levels=manifest.levels[:1] * (MAX_LEVELS + 1))
            levels = levels[:1] * (MAX_LEVELS + 1)
    return dataclasses.replace(made, manifest=manifest, levels=levels)


@pytest.mark.parametrize(
    "name", ["long name", "no name", "heavy level", "broken text", "many levels"]
)
def test_no_set_is_written_that_cannot_be_read(made, folder, name):
    with pytest.raises(LevelError, match=r"^set '.*': \$\.(name|levels)"):
        save_set(unreadable(made, name), folder / "set.json")
    assert not (folder / "set.json").exists()


@pytest.mark.skipif(os.name != "posix", reason="names of files are text elsewhere")
def test_a_level_whose_file_name_is_no_text_stands_in_the_set(folder):
    odd = Path(os.fsdecode(os.fsencode(folder) + b"/caf\xe9.json"))
    (folder / "s" / "g0.json").rename(odd)
    made = build_set(gather_levels([folder]), name="games", folder=folder)
    save_set(made, folder / "set.json")
    assert sum(each.path is None for each in load_set(folder / "set.json").levels) == 1


def test_the_split_depends_on_hashes_and_seed_alone():
    hashes = [f"{k:064x}" for k in range(40)]
    split = draw_split(hashes, share=0.8, seed=3)
    assert Counter(split.values()) == {"train": 32, "eval": 8}
    assert draw_split(hashes[::-1], share=0.8, seed=3) == split
    assert draw_split(hashes, share=0.8, seed=4) != split
    assert set(draw_split(hashes[:2], share=0.99, seed=0).values()) == {"train", "eval"}
    assert set(draw_split(hashes, share=1.0, seed=0).values()) == {"train"}
    assert set(draw_split(hashes, share=0.0, seed=0).values()) == {"eval"}
    with pytest.raises(LevelError, match="0 ≤ x ≤ 1"):
        draw_split(hashes, share=1.5, seed=0)


def test_a_set_can_be_split_anew(made):
    again = split_set(made, split=0.5, seed=9)
    assert again.manifest.seed == 9
    assert Counter(each.split for each in again.levels) == {"train": 4, "eval": 3}
    assert [e.sha256 for e in again.manifest.levels] == [e.sha256 for e in made.manifest.levels]


def test_a_changed_level_is_noticed(folder, made):
    save_set(made, folder / "set.json")
    level = load_level(folder / "s" / "g3.json")
    save_level(level.replace(name="renamed"), folder / "s" / "g3.json")
    load_set(folder / "set.json")
    save_level(level.replace(max_timesteps=9), folder / "s" / "g3.json")
    with pytest.raises(LevelError, match=r"set\.json: \$\.levels\[4\]\.sha256: expected the level"):
        load_set(folder / "set.json")


def test_levels_of_a_set_that_cannot_be_read_do_not_keep_the_others_away(folder, made):
    save_set(made, folder / "set.json")
    whole, unreadable = read_set(folder / "set.json")
    assert whole.levels == load_set(folder / "set.json").levels and not unreadable
    (folder / "s" / "g3.json").write_text("{")
    save_level(game(2).replace(max_timesteps=9), folder / "s" / "g2.json")
    rest, unreadable = read_set(folder / "set.json")
    assert list(unreadable) == ["s/g3.json"]
    assert len(rest.levels) == len(whole.levels) - 1
    assert 9 in {each.level.max_timesteps for each in rest.levels}


def entry(**changes):
    return {"path": "s/g0.json", "sha256": level_hash(game(0))} | changes


BAD = {
    "format": ({"format": "kinetix-level"}, r"\$: expected an object with \"format\""),
    "version": ({"version": 2}, r"\$\.version: .*newer"),
    "no version": ({"version": None}, r"\$\.version: expected a whole number"),
    "unknown": ({"sizes": 1}, r"\$\.sizes: unknown key"),
    "list": ({"levels": {}}, r"\$\.levels: expected an array"),
    "many": ({"levels": [0] * 10_001}, r"\$\.levels: expected .* got an array of 10001"),
    "entry": ({"levels": [3]}, r"\$\.levels\[0\]: expected an object"),
    "both": ({"levels": [entry(level={})]}, r'\$\.levels\[0\]: expected either "path" or "level"'),
    "neither": ({"levels": [{"sha256": "0" * 64}]}, 'expected either "path" or "level"'),
    "inline": ({"levels": [{"level": 3, "sha256": "0" * 64}]}, r"\[0\]\.level: expected an object"),
    "level": (
        {"levels": [{"level": {"format": "kinetix-level", "version": 1}, "sha256": "0" * 64}]},
        r"\$\.levels\[0\]\.level: the key \"name\"",
    ),
    "hash": ({"levels": [entry(sha256="0")]}, r"\[0\]\.sha256: expected 64 to 64 characters"),
    "other hash": ({"levels": [entry(sha256="0" * 64)]}, r"\[0\]\.sha256: expected the level"),
    "twice": ({"levels": [entry(), entry()]}, r"levels\[1\]\.sha256: .* levels\[0\] has it"),
    "weight": ({"levels": [entry(weight=0)]}, r"\[0\]\.weight: expected 1e-06 ≤ x"),
    "split": ({"levels": [entry(split="test")]}, r'\[0\]\.split: expected "eval" or "train"'),
    "missing": ({"levels": [entry(path="none.json")]}, r"none\.json: there is no such file"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_sets_get_one_sentence(folder, name):
    change, sentence = BAD[name]
    tree = {"format": "kinetix-levelset", "version": 1, "name": "x", "levels": [entry()]}
    path = folder / "set.json"
    path.write_text(json.dumps(tree))
    assert load_set(path).levels[0].level == game(0)
    path.write_text(json.dumps(tree | change))
    with pytest.raises(LevelError, match=sentence) as caught:
        load_set(path)
    assert "\n" not in str(caught.value)


def test_a_set_where_a_level_is_expected_has_its_own_sentence(folder, made):
    with pytest.raises(LevelError, match="this is a level set, expected a single level"):
        loads(dumps_set(made))


def test_the_parts_of_a_set_and_of_what_has_none(tmp_path):
    for index in range(6):
        save_level(game(index), tmp_path / f"{index}.json")
    plain = gather_levels([tmp_path])
    assert training_part(plain) == evaluation_part(plain) == plain
    made = build_set(plain, name="parts", folder=tmp_path, split=0.5, seed=1)
    parts = [training_part(made.levels), evaluation_part(made.levels)]
    assert [len(part) for part in parts] == [3, 3]
    assert {each.sha256 for part in parts for each in part} == {each.sha256 for each in plain}
    assert distinct([*plain, *made.levels]) == plain


def test_a_set_without_levels_to_train_on_is_refused(folder):
    made = build_set(gather_levels([folder]), name="held back", folder=folder, split=0.0)
    with pytest.raises(LevelError, match="7 levels for evaluation, none to train on"):
        training_part(made.levels)


@pytest.mark.parametrize(("share", "part"), [(0.5, "train"), (0.1, "train"), (0.0, "eval")])
def test_a_level_alone_is_for_training(share, part):
    assert draw_split(["0" * 64], share=share, seed=0) == {"0" * 64: part}
