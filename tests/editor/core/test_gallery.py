"""The gallery's core: cards, thumbnails, wishes, file work, level sets."""

import dataclasses
import errno
import json
import os
import shutil
import time
from pathlib import Path

import numpy as np
import pytest

from editor import actions
from editor.actions.files import unsaved
from editor.actions.files.file import open_path
from editor.actions.gallery import gallery as doing
from editor.actions.gallery import gallery_files, level_sets
from editor.agents.evaluation import Evaluation
from editor.base.events import DropEvent
from editor.base.prompts import FileQuestion, TextQuestion
from editor.base.state_file import write_state
from editor.gallery import filing
from editor.gallery.card import read_card
from editor.gallery.export import SetPlan, export_set
from editor.gallery.library import Library
from editor.gallery.results import HUMAN, Record, Results, Trial
from editor.gallery.search import Wish, tag_counts, wanted
from editor.gallery.thumbnail import SIDE, draw_thumbnail
from kinetix.cli import main
from kinetix.errors import CommandError, LevelError
from kinetix.level.codec import dumps, level_hash, load_level, save_level
from kinetix.level.model import Body, Circle, Level, Polygon, Thruster
from kinetix.level.sets import load_set
from kinetix.paths import levels_dir
from kinetix.render.palette import KINETIX
from tests.editor.core.helpers import a_session, texts
from tests.editor.core.test_viewer import a_summary

SQUARE = Polygon(vertices=((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)))


def playable(name, x=1.0, **changes):
    """A level without errors; `x` makes levels that differ."""
    return Level(
        name=name,
        next_id=5,
        bodies=(
            Body(id=1, shape=Circle(radius=0.3), position=(x, 2.0), role="green"),
            Body(id=2, shape=SQUARE, position=(4.0, 3.0), role="blue", fixed=True),
        ),
        thrusters=(Thruster(id=3, body=1, position=(0.0, -0.2), angle=1.5),),
    ).replace(**changes)


@pytest.fixture
def folder(tmp_path):
    """Four levels: two for play, one without a green shape, one that cannot be read."""
    place = tmp_path / "mine"
    (place / "carts").mkdir(parents=True)
    save_level(playable("Hill cart", tags=("wheels",)), place / "carts" / "hill_cart.json")
    save_level(playable("Rocket", 1.5, description="Land softly."), place / "rocket.json")
    save_level(Level(name="Nothing"), place / "nothing.json")
    (place / "broken.json").write_text('{"format": "kinetix-level", "version": 1}')
    (place / "package.json").write_text('{"name": "not a level"}')
    return place


@pytest.fixture
def library(tmp_path):
    made = Library(tmp_path / "cache")
    yield made
    made.stop()


def look(library, *folders):
    library.look(folders)
    assert library.wait(20)
    return {card.name: card for card in library.cards}


def test_a_thumbnail_shows_roles_where_the_bodies_are():
    picture = draw_thumbnail(playable("A"))
    assert picture.shape == (SIDE, SIDE, 3) and picture.dtype == np.uint8

    def pixel(x, y):
        return tuple(picture[round(SIDE * (1 - y / 5)), round(SIDE * x / 5)])

    assert pixel(1.2, 2.1) == KINETIX.fill(1)
    assert pixel(4.14, 3.14) == KINETIX.fill(2, fixed=True)
    assert pixel(3.0, 4.0) == KINETIX.background
    assert pixel(3.0, 0.2) == KINETIX.fill(0, fixed=True)


def test_every_bundled_level_has_a_thumbnail():
    for path in sorted(levels_dir().glob("*/*.json"))[::8]:
        picture = draw_thumbnail(load_level(path))
        assert (picture != KINETIX.background[0]).any()


def test_the_library_finds_levels_and_leaves_other_files_out(library, folder):
    cards = look(library, folder)
    assert set(cards) == {"Hill cart", "Rocket", "Nothing", "broken"}
    rocket = cards["Rocket"]
    assert rocket.sha256 == level_hash(load_level(folder / "rocket.json"))
    assert (rocket.size, rocket.bodies, rocket.thrusters, rocket.errors) == ("s", 2, 1, 0)
    assert cards["Nothing"].errors == 2
    assert "version" not in cards["broken"].name and "name" in cards["broken"].fault


@pytest.mark.parametrize("content", [b"", b"\n", bytes(5000)], ids=["empty", "blank", "zeros"])
def test_a_file_that_has_lost_its_content_is_shown_as_broken(library, folder, content):
    (folder / "lost.json").write_bytes(content)
    fault = look(library, folder)["lost"].fault
    assert fault.startswith("lost.json: this ")
    assert ("is empty" in fault) == (not content)


def test_what_the_library_passes_over_is_said(library, folder, monkeypatch):
    look(library, folder)
    assert library.passed_over == ""
    odd = folder / "latin\udce9.json"
    odd.write_text("{}")
    look(library, folder)
    assert "no Unicode" in library.passed_over
    odd.unlink()
    look(library, folder)
    assert library.passed_over == ""
    monkeypatch.setattr("editor.gallery.walk.MAX_FILES", 2)
    assert len(look(library, folder)) == 2
    assert "first 2 files" in library.passed_over


def test_folders_behind_links_and_names_in_capitals_are_shown(library, folder, tmp_path):
    (folder / "rocket.json").rename(folder / "ROCKET.JSON")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    save_level(playable("Linked", 2.5), elsewhere / "linked.json")
    (folder / "link").symlink_to(elsewhere)
    (folder / "round").symlink_to(folder)
    assert {"Rocket", "Linked"} <= set(look(library, folder))
    assert len(library.cards) == 5


def test_the_name_on_a_card_is_one_line(folder):
    save_level(playable("Rocket", 1.7).replace(name="a\nb"), folder / "rocket.json")
    assert read_card(folder / "rocket.json")[0].name == "a b"


def test_a_link_to_too_many_folders_is_told(library, folder, tmp_path, monkeypatch):
    for k in range(3):
        (tmp_path / "disk" / str(k)).mkdir(parents=True)
    (folder / "link").symlink_to(tmp_path / "disk")
    monkeypatch.setattr("kinetix.files.walk.MOST_LINKED", 2)
    assert len(look(library, folder)) == 4
    assert "what links lead to" in library.passed_over


def test_a_second_look_reads_only_what_changed(library, folder, tmp_path, monkeypatch):
    look(library, folder)
    read = []

    def noting(path):
        read.append(path.name)
        return read_card(path)

    monkeypatch.setattr("editor.gallery.library.read_card", noting)
    again = Library(tmp_path / "cache")
    time.sleep(0.01)
    save_level(playable("Rocket", 1.7), folder / "rocket.json")
    (folder / "carts" / "hill_cart.json").unlink()
    cards = look(again, folder)
    again.stop()
    assert read == ["rocket.json"]
    assert set(cards) == {"Rocket", "Nothing", "broken"}


def test_a_look_that_another_one_replaces_has_not_read_in_vain(library, folder, monkeypatch):
    """Asked again before it has ended, on a slow disk or with many levels, it ends all the same."""
    read = Library._read
    names = []

    def read_and_ask(self, path):
        if self is not library:  # of another test, whose thread has not ended yet
            return read(self, path)
        names.append(path.name)
        if len(names) <= 4:
            library.look([folder])
        return read(self, path)

    monkeypatch.setattr(Library, "_read", read_and_ask)
    look(library, folder)
    assert len(library.cards) == 4
    assert sorted(names) == sorted(set(names))


def test_thumbnails_come_from_the_cache_the_second_time(library, folder, tmp_path, monkeypatch):
    card = look(library, folder)["Rocket"]
    library.want([card])
    assert library.wait(20)
    first = library.picture(card.sha256)
    assert (first == draw_thumbnail(load_level(folder / "rocket.json"))).all()
    monkeypatch.setattr("editor.gallery.library.draw_thumbnail", None)
    again = Library(tmp_path / "cache")
    again.want([card])
    assert again.wait(20)
    assert (again.picture(card.sha256) == first).all()
    again.stop()


@pytest.mark.parametrize(
    "content",
    [
        b'{"version": 1, "files": [{}',
        b'{"version": 1, "files": [{"kind": "\xee',
        b'{"version": 1, "files": ' + b"[" * 5000,
    ],
)
def test_a_broken_index_is_made_anew(library, folder, tmp_path, content):
    (tmp_path / "cache" / "gallery").mkdir(parents=True)
    (tmp_path / "cache" / "gallery" / "index.json").write_bytes(content)
    assert len(look(library, folder)) == 4


def test_a_fault_of_ours_does_not_end_the_gallerys_thread(library, folder, monkeypatch):
    def broken():
        raise RuntimeError("a fault")

    with monkeypatch.context() as patch:
        patch.setattr(library, "_index", broken)
        look(library, folder)
    assert len(look(library, folder)) == 4


@pytest.mark.parametrize(
    ("wish", "names"),
    [
        (Wish(words="cart"), ["Hill cart"]),
        (Wish(words="land ROCK"), ["Rocket"]),
        (Wish(tags=frozenset({"wheels"})), ["Hill cart"]),
        (Wish(thruster=False), ["broken", "Nothing"]),
        (Wish(problems=False), ["Hill cart", "Rocket"]),
        (Wish(solution=True), []),
        (Wish(sizes=frozenset({"m"})), []),
        (Wish(solved_by="walker"), ["Rocket"]),
        (Wish(unsolved_by="walker", problems=False), ["Hill cart"]),
        (Wish(sort="solve rate", problems=False), ["Rocket", "Hill cart"]),
        (Wish(descending=True, problems=False), ["Rocket", "Hill cart"]),
    ],
)
def test_wishes(library, folder, tmp_path, wish, names):
    look(library, folder)
    results = Results(tmp_path / "results.json")
    sha256 = level_hash(load_level(folder / "rocket.json"))
    results.record(Trial(player="walker"), {sha256: Record(attempts=20, solved=3)})
    assert [card.name for card in wanted(library.cards, wish, results)] == names
    assert tag_counts(library.cards) == [("wheels", 1)]


def test_results_outlive_the_app_and_broken_ones_do_no_harm(tmp_path):
    path = tmp_path / "state" / "results.json"
    first = Results(path)
    first.record(Trial(player="walker"), {"a" * 64: Record(attempts=20, solved=3)})
    first.add_episode(HUMAN, "a" * 64, won=True)
    first.add_episode(HUMAN, "a" * 64, won=False)
    again = Results(path)
    assert again.players == ("walker", HUMAN)
    assert again.of("a" * 64)[Trial(player=HUMAN)] == Record(attempts=2, solved=1)
    tree = json.loads(path.read_text()) | {"b": 7, "c": {"x": [1, 2]}, "d": {"y": "z"}, "e": [[1]]}
    path.write_text(json.dumps(tree))
    assert Results(path).players == ("walker", HUMAN)
    path.write_text("{")
    assert Results(path).players == ()


def test_two_windows_keep_the_results_of_each_other(tmp_path):
    path = tmp_path / "results.json"
    first, second = Results(path), Results(path)
    assert first.players == second.players == ()  # both have read the file
    walker = Trial(player="walker")
    first.record(walker, {"a": Record(attempts=20, solved=10)})
    second.add_episode(HUMAN, "a", won=True)
    first.add_episode(HUMAN, "a", won=False)
    records = {walker: Record(attempts=20, solved=10)}
    records[Trial(player=HUMAN)] = Record(attempts=2, solved=1)
    assert Results(path).of("a") == first.of("a") == records
    second.record(walker, {"a": Record(attempts=40, solved=30)})
    first.record(walker, {"b": Record(attempts=1, solved=1)})
    assert Results(path).of("a")[walker].attempts == 40


def test_what_another_window_writes_right_after_a_write_stays(tmp_path, monkeypatch):
    path = tmp_path / "results.json"
    results = Results(path)

    def overtaken(*args, **options):
        written = write_state(*args, **options)
        Results(path).add_episode("another", "b", won=True)
        return written

    with monkeypatch.context() as patch:
        # The other one writes through the patched name too, once.
        patch.setattr(
            "editor.gallery.results.write_state",
            lambda *args, **options: (patch.undo(), overtaken(*args, **options))[1],
        )
        results.add_episode(HUMAN, "a", won=True)
    results.add_episode(HUMAN, "a", won=True)
    assert Results(path).players == ("another", HUMAN)


def test_the_file_of_results_is_read_once_unless_others_write_it(tmp_path, monkeypatch):
    path = tmp_path / "results.json"
    results = Results(path)
    results.add_episode(HUMAN, "a" * 64, won=True)
    with monkeypatch.context() as patch:
        patch.setattr("editor.base.state_file.read_text", None)
        results.add_episode(HUMAN, "a" * 64, won=True)
    Results(path).add_episode(HUMAN, "a" * 64, won=False)
    results.add_episode(HUMAN, "a" * 64, won=True)
    (record,) = Results(path).of("a" * 64).values()
    assert (record.attempts, record.solved) == (4, 3)


def test_results_that_could_not_be_written_go_with_the_next(tmp_path, monkeypatch):
    path = tmp_path / "results.json"
    results = Results(path)

    def full(*_, **__):
        raise LevelError("No space left")

    with monkeypatch.context() as patched:
        patched.setattr("editor.gallery.results.write_state", full)
        for level in "aab":
            with pytest.raises(LevelError):
                results.add_episode(HUMAN, level, won=True)
    Results(path).add_episode(HUMAN, "c", won=True)
    results.add_episode(HUMAN, "b", won=False)
    again = Results(path)
    you = [again.of(level)[Trial(player=HUMAN)] for level in "abc"]
    assert [(each.attempts, each.solved) for each in you] == [(2, 2), (2, 1), (1, 1)]
    path.write_text("{")  # while the app runs
    results.add_episode(HUMAN, "c", won=True)
    assert Results(path).of("c")[Trial(player=HUMAN)].attempts == 2


def test_results_of_other_parameters_physics_modes_and_seeds_stand_beside_each_other(tmp_path):
    path, level = tmp_path / "results.json", "a" * 64
    trials = [
        Trial(player="run@40960", digest="1" * 64, physics="balanced"),
        Trial(player="run@40960", digest="2" * 64, physics="balanced"),
        Trial(player="run@40960", digest="2" * 64, physics="jax2d"),
        Trial(player="run@40960", digest="2" * 64, physics="jax2d", deterministic=True),
        Trial(player="run@40960", digest="2" * 64, physics="jax2d", seed=1),
        Trial(player="run@40960", digest="2" * 64, physics="jax2d", card="3" * 16),
        Trial(player="run@40960", digest="2" * 64, physics="jax2d", card="4" * 16),
    ]
    results = Results(path)
    for k, trial in enumerate(trials):
        results.record(trial, {level: Record(attempts=20, solved=k)})
    again = Results(path)
    replaced = trials.pop(2)
    assert replaced not in again.of(level)
    assert [again.of(level)[trial].solved for trial in trials] == [0, 1, 3, 4, 5, 6]
    assert again.players == ("run@40960",)
    assert len({trial.words for trial in trials}) == 6


def test_results_of_a_version_without_cards_are_read_and_replaced(tmp_path):
    path, level = tmp_path / "results.json", "a" * 64
    path.write_text(json.dumps({level: [["walker", "1" * 64, "balanced", False, 0, 20, 3]]}))
    old = Trial(player="walker", digest="1" * 64, physics="balanced")
    assert Results(path).of(level) == {old: Record(attempts=20, solved=3)}
    new = dataclasses.replace(old, card="2" * 16)
    Results(path).record(new, {level: Record(attempts=20, solved=5)})
    assert Results(path).of(level) == {new: Record(attempts=20, solved=5)}


def test_results_of_the_first_version_are_read(tmp_path):
    path = tmp_path / "results.json"
    path.write_text(json.dumps({"a": {"walker": [20, 3], "bad": [1]}}))
    assert Results(path).of("a") == {Trial(player="walker"): Record(attempts=20, solved=3)}


def test_rename_changes_name_and_file(folder):
    target = filing.rename(folder / "rocket.json", "Second  Try!")
    assert target == folder / "second_try.json"
    assert load_level(target).name == "Second Try!"
    assert not (folder / "rocket.json").exists()
    assert filing.rename(folder / "nothing.json", "Second try").name == "second_try_2.json"
    with pytest.raises(LevelError, match="1 to 120"):
        filing.rename(target, " ")


def test_duplicates_stand_beside_the_level_and_the_apps_go_to_the_user(folder):
    copy = filing.duplicate(folder / "rocket.json")
    assert copy == folder / "rocket_copy.json"
    assert load_level(copy).name == "Rocket copy"
    assert filing.duplicate(folder / "rocket.json").name == "rocket_copy_2.json"
    own = next(levels_dir().glob("s/*.json"))
    assert filing.duplicate(own).parent == folder


def test_what_is_thrown_away_lies_in_the_trash_and_comes_back(folder, tmp_path):
    text = (folder / "rocket.json").read_text()
    thrown = filing.throw_away(folder / "rocket.json")
    assert not (folder / "rocket.json").exists()
    assert thrown.file.is_relative_to(tmp_path / "data" / "Trash")
    note = thrown.note.read_text()
    assert f"Path={folder}/rocket.json" in note and "DeletionDate=" in note
    filing.bring_back(thrown)
    assert (folder / "rocket.json").read_text() == text
    assert not thrown.note.exists()


def on_another_disk(source, target):
    raise OSError(errno.EXDEV, "Invalid cross-device link")


def denied_twice(source, target):
    raise PermissionError(13, "Permission denied")


def test_a_folder_is_thrown_away_to_another_disk_or_stays_whole(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    agent = tmp_path / "agent"
    (agent / "checkpoints").mkdir(parents=True)
    (agent / "checkpoints" / "params").write_text("1")
    monkeypatch.setattr("editor.gallery.filing.os.rename", denied_twice)
    with pytest.raises(LevelError, match="cannot be deleted: Permission denied"):
        filing.throw_away(agent)
    assert (agent / "checkpoints" / "params").read_text() == "1"
    assert [path for path in (tmp_path / "data").rglob("*") if path.is_file()] == []
    monkeypatch.setattr("editor.gallery.filing.os.rename", on_another_disk)
    thrown = filing.throw_away(agent)
    assert not agent.exists()
    filing.bring_back(thrown)
    assert (agent / "checkpoints" / "params").read_text() == "1"


def on_a_full_disk(source, target, symlinks):
    """Fail as `shutil.copytree` does there: one error lists every file with its reason."""
    Path(target).mkdir(parents=True)
    reason = f"[Errno {errno.ENOSPC}] {os.strerror(errno.ENOSPC)}"
    raise shutil.Error([(str(file), str(target), reason) for file in Path(source).iterdir()])


def test_a_folder_that_fits_on_no_disk_is_told_in_a_few_words(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    agent = tmp_path / "agent"
    agent.mkdir()
    for name in ("params", "meta"):
        (agent / name).write_text("1")
    monkeypatch.setattr("editor.gallery.filing.os.rename", on_another_disk)
    with monkeypatch.context() as patched:
        patched.setattr("shutil.copytree", on_a_full_disk)
        with pytest.raises(LevelError, match=r"agent: cannot be deleted: No space left on device$"):
            filing.throw_away(agent)
    thrown = filing.throw_away(agent)
    with monkeypatch.context() as patched:
        patched.setattr("shutil.copytree", on_a_full_disk)
        told = rf"cannot be brought back: No space left on device; it stays in {thrown.file}$"
        with pytest.raises(LevelError, match=told):
            filing.bring_back(thrown)
    filing.bring_back(thrown)
    assert (agent / "params").read_text() == "1"


def test_a_delete_that_fails_leaves_nothing_in_the_trash(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    before = (folder / "rocket.json").read_bytes()

    monkeypatch.setattr("editor.gallery.filing.os.rename", denied_twice)
    with pytest.raises(LevelError, match="cannot be deleted: Permission denied"):
        filing.throw_away(folder / "rocket.json")
    assert (folder / "rocket.json").read_bytes() == before
    assert [path for path in (tmp_path / "data").rglob("*") if path.is_file()] == []


def test_names_of_every_length_are_copied_and_thrown_away(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    longest = folder / f"{'é' * 125}.json"
    save_level(playable("Long"), longest)
    copies = [filing.duplicate(longest), filing.duplicate(longest)]
    assert len({longest, *copies}) == 3
    thrown = [filing.throw_away(path) for path in (longest, *copies)]
    for one in thrown:
        filing.bring_back(one)
    assert all(load_level(path) for path in (longest, *copies))


@pytest.mark.parametrize("form", ["file", "folder"])
def test_a_set_splits_weighs_and_leaves_doubles_out(folder, tmp_path, form):
    for k in range(8):
        save_level(playable(f"L{k}", 1.0 + 0.1 * k), folder / f"l{k}.json")
    save_level(playable("Double", 1.0), folder / "z.json")
    levels = {folder / f"l{k}.json": 1.0 + k for k in range(8)} | {folder / "z.json": 1.0}
    target = tmp_path / ("set.json" if form == "file" else "exported")
    plan = SetPlan(name="Mine", form=form, split=0.75, seed=3)
    export_set(levels, plan, target)
    loaded = load_set(target if form == "file" else target / "set.json")
    assert [each.weight for each in loaded.levels] == [1.0 + k for k in range(8)]
    splits = [each.split for each in loaded.levels]
    assert splits.count("train") == 6 and loaded.manifest.seed == 3
    again = export_set(levels, plan, tmp_path / "again.json" if form == "file" else target)
    assert [each.split for each in again.levels] == splits
    assert (form == "file") == all(each.path is None for each in loaded.levels)


def test_of_equal_levels_the_largest_weight_stays_and_is_told(session, folder, tmp_path):
    save_level(load_level(folder / "rocket.json"), folder / "again.json")
    weights = {"rocket": 1.0, "again": 5.0, "carts/hill_cart": 2.0}
    session.gallery.tray = {str(folder / f"{name}.json"): w for name, w in weights.items()}
    level_sets.ask_export(session)
    level_sets.export_now(session)
    session.answer(session.prompts[-1], tmp_path / "x.json")
    assert sorted(each.weight for each in load_set(tmp_path / "x.json").levels) == [2.0, 5.0]
    assert texts(session)[-1].endswith(
        ", 1 left out because they equal others, the largest weight stays"
    )


def test_what_one_file_does_not_carry_of_kinetix_env_s_is_told(session, folder, tmp_path):
    paths = [folder / name for name in ("peer.json", "other.json")]
    for k, path in enumerate(paths):
        tree = json.loads(dumps(playable(path.stem, 1.0 + k), format="kinetix-env"))
        slots = tree["env_state"]["polygon"]
        row = next(k for k, each in enumerate(slots) if k > 3 and each["active"])
        slots[row]["highlighted"] = True
        path.write_text(json.dumps(tree))
    session.gallery.tray = dict.fromkeys(map(str, paths), 1.0)
    level_sets.ask_export(session)
    level_sets.export_now(session)
    session.answer(session.prompts[-1], tmp_path / "x.json")
    assert texts(session)[-1] == (
        f"{paths[0]}: put into the set; not carried: highlights (and 1 more, see the log)"
    )


def test_one_file_of_the_app_is_what_the_command_puts_inline(folder, tmp_path):
    paths = [folder / f"l{k}.json" for k in range(4)]
    for k, path in enumerate(paths):
        save_level(playable(f"L{k}", 1.0 + 0.1 * k), path)
    app, command = tmp_path / "app.json", tmp_path / "command.json"
    export_set(dict.fromkeys(paths, 1.0), SetPlan(seed=3), app)
    words = ["levelset", "build", str(command), "--levels", *map(str, paths)]
    assert main([*words, "--seed", "3", "--inline"]) == 0
    mine, theirs = load_set(app).levels, load_set(command).levels
    assert [(e.level, e.split, e.path) for e in mine] == [
        (e.level, e.split, e.path) for e in theirs
    ]


def test_a_set_with_a_bad_level_is_refused_and_nothing_is_written(library, folder, tmp_path):
    look(library, folder)
    levels = {folder / "rocket.json": 1.0, folder / "nothing.json": 1.0}
    with pytest.raises(LevelError, match=r"nothing\.json.*E101"):
        export_set(levels, SetPlan(form="folder"), tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.fixture
def session(folder, monkeypatch):
    monkeypatch.setattr("editor.actions.gallery.gallery.levels_dir", lambda: folder)
    made = a_session()
    actions.run(made, "level.gallery")
    assert made.library.wait(20)
    yield made
    made.library.stop()


def choose(session, *names):
    by_name = {card.name: card.path for card in session.library.cards}
    session.gallery.selection = tuple(by_name[name] for name in names)


def names_of(session):
    assert session.library.wait(20)
    return {card.name for card in session.library.cards}


def test_the_gallery_never_touches_what_is_open(session):
    before = session.document.hash, len(session.tabs)
    assert session.gallery.open
    assert not actions.run(session, "edit.delete")
    assert not actions.run(session, "run.play_human")
    actions.run(session, "gallery.close")
    assert not session.gallery.open
    assert (session.document.hash, len(session.tabs)) == before


def test_opening_shows_the_levels_in_tabs(session, folder):
    choose(session, "Rocket", "Hill cart")
    actions.run(session, "gallery.open")
    assert not session.gallery.open
    assert [tab.document.title for tab in session.tabs][1:] == ["rocket.json", "hill_cart.json"]


def test_arrows_walk_through_the_cards(session):
    shown = [card.path for card in session.gallery.shown(session.library, session.results)]
    for action, at in (("right", 0), ("right", 1), ("last", 3), ("left", 2), ("first", 0)):
        actions.run(session, f"gallery.move_{action}")
        assert session.gallery.selection == (shown[at],)


def test_clicks_choose_as_in_lists(session):
    gallery = session.gallery
    cards = gallery.shown(session.library, session.results)
    a, b, c, _ = (card.path for card in cards)
    gallery.click(cards, a, toggle=False, extend=False)
    gallery.click(cards, c, toggle=False, extend=True)
    assert gallery.selection == (a, b, c)
    gallery.click(cards, b, toggle=True, extend=False)
    assert gallery.selection == (a, c)


def test_delete_and_bring_back(session, folder):
    choose(session, "Rocket")
    actions.run(session, "gallery.delete")
    assert session.toasts[-1].action == "gallery.restore"
    assert "Rocket" not in names_of(session)
    actions.run(session, "gallery.restore")
    assert "Rocket" in names_of(session)


def test_every_deletion_comes_back_the_last_one_first(session, folder):
    for name in ("Rocket", "Hill cart"):
        choose(session, name)
        actions.run(session, "gallery.delete")
        assert name not in names_of(session)
    actions.run(session, "gallery.restore")
    assert "Hill cart" in names_of(session) and not (folder / "rocket.json").exists()
    actions.run(session, "gallery.restore")
    assert {"Rocket", "Hill cart"} <= names_of(session)
    assert not gallery_files.can_restore(session)


def test_what_cannot_come_back_keeps_nothing_else_away_and_waits(session, folder):
    choose(session, "Rocket", "Hill cart")
    actions.run(session, "gallery.delete")
    (folder / "rocket.json").write_text("another one")
    actions.run(session, "gallery.restore")
    assert any("another file of this name" in text for text in texts(session))
    assert "Hill cart" in names_of(session)
    (folder / "rocket.json").unlink()
    actions.run(session, "gallery.restore")
    assert "Rocket" in names_of(session)


def test_renaming_follows_into_the_open_tab(session, folder):
    choose(session, "Rocket")
    actions.run(session, "gallery.open")
    actions.run(session, "level.gallery")
    choose(session, "Rocket")
    actions.run(session, "gallery.rename")
    (prompt,) = session.prompts
    assert isinstance(prompt, TextQuestion)
    session.answer(prompt, "Feather")
    assert session.document.path == folder / "feather.json"
    assert session.document.level.name == "Feather" and not session.document.dirty
    assert "Feather" in names_of(session)


def test_unsaved_changes_and_the_apps_own_levels_are_not_taken_away(session, folder, monkeypatch):
    choose(session, "Rocket")
    actions.run(session, "gallery.open")
    session.document.mark_unsaved()
    actions.run(session, "level.gallery")
    choose(session, "Rocket")
    actions.run(session, "gallery.delete")
    assert "unsaved changes" in texts(session)[-1]
    monkeypatch.setattr("editor.gallery.filing.levels_dir", lambda: folder)
    choose(session, "Hill cart")
    actions.run(session, "gallery.delete")
    assert "came with the app" in texts(session)[-1]
    assert names_of(session) >= {"Rocket", "Hill cart"}


def test_a_set_is_put_together_and_exported(session, tmp_path):
    actions.run(session, "gallery.select_all")
    actions.run(session, "gallery.add_to_set")
    actions.run(session, "level.export_set")
    session.gallery.tray[str(tmp_path / "gone.json")] = 1.0
    assert set(level_sets.refused_in_set(session).values()) == {"Nothing", "broken", "gone"}
    with pytest.raises(CommandError, match="has an error"):
        level_sets.export_now(session)
    level_sets.leave_out_refused(session)
    session.gallery.plan = dataclasses.replace(session.gallery.plan, split=0.5)
    level_sets.export_now(session)
    (prompt,) = session.prompts
    assert isinstance(prompt, FileQuestion) and prompt.purpose == "save"
    session.answer(prompt, tmp_path / "set.json")
    loaded = load_set(tmp_path / "set.json")
    assert sorted(each.split for each in loaded.levels) == ["eval", "train"]
    assert "1 to train on, 1 to evaluate on" in texts(session)[-1]
    assert session.gallery.plan is None


def test_chosen_levels_are_evaluated_and_one_is_played_by_the_agent(session):
    choose(session, "Rocket")
    assert actions.run(session, "gallery.evaluate")
    assert "Choose an agent first" in texts(session)[-1]
    session.prompts.clear()
    session.viewer.slots["a"].summary = a_summary()
    choose(session, "Rocket")
    actions.run(session, "gallery.evaluate")
    plan = session.viewer.evaluation.plan
    assert [Path(level.source).stem for level in plan.levels] == ["rocket"]
    assert (plan.attempts, plan.physics_of(0)) == (20, "jax2d")
    assert not session.gallery.open
    session.viewer.evaluation.cancel()
    actions.run(session, "level.gallery")
    choose(session, "Rocket")
    actions.run(session, "gallery.play_agent")
    assert session.document.level.name == "Rocket"
    assert session.playback.player == "Tester"


def test_no_agent_plays_behind_the_question_about_another_window(session, monkeypatch):
    monkeypatch.setattr(session.autosaves, "open_elsewhere", lambda path: True)
    choose(session, "Rocket")
    actions.run(session, "gallery.play_agent")
    assert "another window" in session.prompts[-1].title
    assert session.gallery.open and session.expected is None


def test_the_gallery_evaluates_as_the_form_says_that_is_shown_then(session):
    form = session.viewer.form
    form.attempts, form.seed, form.physics, form.scripted = 200, 5, "fast", ("noop",)
    session.viewer.slots["a"].summary = a_summary()
    choose(session, "Rocket")
    actions.run(session, "gallery.evaluate")
    plan = session.viewer.evaluation.plan
    session.viewer.evaluation.cancel()
    assert (plan.attempts, plan.seed, plan.physics) == (200, 5, "fast")
    assert [agent.name for agent in plan.agents] == ["Tester", "noop"]


def test_unsaved_changes_that_a_set_or_an_evaluation_leaves_out_are_told(session):
    session.viewer.slots["a"].summary = a_summary()
    choose(session, "Rocket")
    actions.run(session, "gallery.open")
    tray = [str(session.document.path), "/levels/other.json"]
    assert unsaved.unsaved_among(session, tray) == []
    session.document.mark_unsaved()
    assert unsaved.unsaved_among(session, tray) == ["Rocket"]
    path = session.document.path
    assert unsaved.unsaved_among(session, [f"{path.parent}/x/../{path.name}"]) == ["Rocket"]
    assert unsaved.unsaved_among(session, tray[1:]) == []
    assert unsaved.listed(["a", "b", "c", "d", "e", "f"]) == "a, b, c, d and 2 more"
    actions.run(session, "level.gallery")
    choose(session, "Rocket")
    actions.run(session, "gallery.evaluate")
    session.viewer.evaluation.cancel()
    assert texts(session)[-1] == "Measured without their unsaved changes: Rocket"


def test_an_evaluation_under_way_is_stopped_only_after_a_question(session, monkeypatch):
    evaluation = session.viewer.evaluation
    session.viewer.slots["a"].summary = a_summary()
    choose(session, "Rocket")
    actions.run(session, "gallery.evaluate")
    first = evaluation.plan
    monkeypatch.setattr(Evaluation, "running", True)
    for choice, kept in (("cancel", True), ("stop", False)):
        session.gallery.open = True
        choose(session, "Rocket")
        actions.run(session, "gallery.evaluate")
        (prompt,) = session.prompts
        assert (prompt.default, prompt.cancel) == ("cancel", "cancel")
        session.answer(prompt, choice)
        assert (evaluation.plan is first) is kept
        assert session.gallery.open is kept


def test_folders_come_and_go(session, tmp_path):
    other = tmp_path / "other"
    other.mkdir()
    save_level(playable("Guest", 2.2), other / "guest.json")
    actions.run(session, "gallery.add_folder")
    session.answer(session.prompts[0], other)
    assert "Guest" in names_of(session)
    assert [card.name for card in session.gallery.shown(session.library, session.results)] == [
        "Guest"
    ]
    doing.remove_folder(session, other)
    assert "Guest" not in names_of(session)
    assert session.gallery.folder is None


def test_a_folder_that_cannot_be_reached_stays_in_the_list_and_hides_no_other(session, tmp_path):
    unreachable = tmp_path / ("x" * 300)  # an error for everybody, as a locked folder is for most
    session.settings.gallery_folders.append(str(unreachable))
    doing.look(session)
    assert "Rocket" in names_of(session)
    assert doing.unreachable(session) == [unreachable]
    doing.remove_folder(session, unreachable)
    assert doing.unreachable(session) == []


def test_an_exported_set_comes_back_into_the_tray(session, folder, tmp_path):
    export_set({folder / "rocket.json": 2.5}, SetPlan(form="folder"), tmp_path / "set")
    level_sets.load_into_set(session, tmp_path / "set" / "set.json")
    assert session.gallery.tray == {str(tmp_path / "set" / "rocket.json"): 2.5}


def test_a_set_that_is_taken_and_exported_again_keeps_its_name_and_split(session, tmp_path):
    there = tmp_path / "there"
    there.mkdir()
    for index in range(8):
        save_level(playable(f"Level {index}", 2 + 0.1 * index), there / f"{index}.json")
    words = ["levelset", "build", str(there / "class.json"), "--split", ".5", "--seed", "3"]
    assert main([*words, "--levels", str(there)]) == 0
    level_sets.load_into_set(session, there / "class.json")
    for name in ("again.json", "once_more.json"):
        level_sets.ask_export(session)
        level_sets.export_now(session)
        session.answer(session.prompts[-1], tmp_path / name)
        made, first = load_set(tmp_path / name), load_set(there / "class.json")
        assert {each.sha256: each.split for each in made.levels} == {
            each.sha256: each.split for each in first.levels
        }
        assert (made.manifest.name, made.manifest.seed) == ("class", 3)
    level_sets.empty_set(session)
    assert session.gallery.proposed == SetPlan()


def test_a_set_that_is_dropped_on_the_window_comes_into_the_gallery(session, folder, tmp_path):
    export_set({folder / "rocket.json": 2.5}, SetPlan(form="folder"), tmp_path / "other")
    file = tmp_path / "other" / "set.json"
    session.gallery.open = False
    actions.handle(session, DropEvent(path=str(file)))
    assert session.gallery.open and not session.prompts
    assert session.gallery.tray == {str(tmp_path / "other" / "rocket.json"): 2.5}
    # As a level it cannot be opened: it says where it can.
    assert not open_path(session, file)
    assert "this is a level set; drop it on the window" in session.prompts.pop().message
    (tmp_path / "other" / "rocket.json").unlink()
    session.gallery.open = False
    actions.handle(session, DropEvent(path=str(file)))
    assert "rocket.json" in session.prompts[-1].message and not session.gallery.open


def test_the_levels_of_a_set_are_those_of_the_gallery(session, folder):
    """A set in a folder of its own names levels by way of `..`."""
    (folder / "sets").mkdir()
    words = ["levelset", "build", str(folder / "sets" / "near.json")]
    assert main([*words, "--levels", str(folder / "rocket.json")]) == 0
    level_sets.load_into_set(session, folder / "sets" / "near.json")
    assert set(session.gallery.tray) <= {card.path for card in session.library.cards}
    level_sets.put_in_set(session, [str(folder / "rocket.json")])
    assert len(session.gallery.tray) == 1


def test_a_set_with_a_damaged_level_gives_the_others(session, folder, tmp_path):
    save_level(playable("Other", 2.5), folder / "other.json")
    levels = {folder / "rocket.json": 2.5, folder / "other.json": 1.0}
    export_set(levels, SetPlan(form="folder"), tmp_path / "class")
    (tmp_path / "class" / "other.json").write_text('{"format":')
    actions.handle(session, DropEvent(path=str(tmp_path / "class" / "set.json")))
    told = session.prompts[-1].message
    assert "\n• other.json: this is no level, or a damaged one" in told
    assert str(tmp_path) not in told and "$" not in told
    session.answer(session.prompts[-1], "others")
    assert session.gallery.tray == {str(tmp_path / "class" / "rocket.json"): 2.5}


def test_a_set_that_another_one_takes_the_place_of_comes_back(session, folder, tmp_path):
    export_set({folder / "rocket.json": 2.5}, SetPlan(form="folder"), tmp_path / "other")
    mine = {str(folder / "rocket.json"): 5.0, str(folder / "hill_cart.json"): 1.0}
    session.gallery.tray = dict(mine)
    level_sets.load_into_set(session, tmp_path / "other" / "set.json")
    assert texts(session)[-1] == "1 level of other"
    assert session.toasts[-1].action == "gallery.set_back"
    actions.run(session, "gallery.set_back")
    assert session.gallery.tray == mine
    level_sets.empty_set(session)
    assert session.gallery.tray == {}
    actions.run(session, "gallery.set_back")
    assert session.gallery.tray == mine


def test_a_deleted_level_comes_back_into_the_set(session, folder):
    session.gallery.tray = {str(folder / "rocket.json"): 5.0}
    choose(session, "Rocket")
    actions.run(session, "gallery.delete")
    assert session.gallery.tray == {}
    actions.run(session, "gallery.restore")
    assert session.gallery.tray == {str(folder / "rocket.json"): 5.0}


def test_a_set_that_carries_its_levels_is_unpacked(session, folder, tmp_path):
    export_set({folder / "rocket.json": 2.5}, SetPlan(), tmp_path / "whole.json")
    (tmp_path / "whole").mkdir()
    other = tmp_path / "whole" / "rocket.json"
    other.write_text("mine")
    for _ in range(2):  # what is there already is taken as it is
        level_sets.load_into_set(session, tmp_path / "whole.json")
        session.answer(session.prompts[-1], "unpack")
        assert session.gallery.tray == {str(tmp_path / "whole" / "rocket_2.json"): 2.5}
    assert other.read_text() == "mine"
    assert sorted(path.name for path in (tmp_path / "whole").iterdir()) == [
        "rocket.json",
        "rocket_2.json",
    ]


def test_no_level_of_a_set_is_left_out_where_it_carries_some_itself(session, folder, tmp_path):
    save_level(playable("Other", 2.5), folder / "other.json")
    file = tmp_path / "both.json"
    for form in ("folder", "file"):
        levels = dict.fromkeys((folder / "rocket.json", folder / "other.json"), 1.0)
        export_set(levels, SetPlan(form=form), tmp_path / "as folder" if form == "folder" else file)
    by_path = json.loads((tmp_path / "as folder" / "set.json").read_text())
    inline = json.loads(file.read_text())
    (kept, *_), (_, carried) = by_path["levels"], inline["levels"]
    inline["levels"] = [kept, carried]
    file = tmp_path / "as folder" / "both.json"
    file.write_text(json.dumps(inline))
    level_sets.load_into_set(session, file)
    session.answer(session.prompts[-1], "unpack")
    assert len(session.gallery.tray) == 2


def test_an_export_that_fails_leaves_no_new_file(folder, tmp_path, monkeypatch):
    from editor.gallery import export

    written = []

    def full(path, data, **_):
        if len(written) == 1:
            raise LevelError(f"{path}: cannot be saved: No space left on device")
        written.append(path)
        path.write_bytes(data)

    monkeypatch.setattr(export, "write_with_backup", full)
    save_level(playable("Other", 2.5), folder / "other.json")
    levels = dict.fromkeys((folder / "rocket.json", folder / "other.json"), 1.0)
    with pytest.raises(LevelError, match="No space"):
        export_set(levels, SetPlan(form="folder"), tmp_path / "out")
    assert written and not (tmp_path / "out").exists()


def test_only_one_level_is_renamed(session):
    choose(session, "Rocket", "Hill cart")
    actions.run(session, "gallery.rename")
    assert session.prompts == []
    assert texts(session)[-1] == "Choose one level to be renamed."


@pytest.mark.parametrize("pulled", [False, True])
def test_the_users_own_episodes_count_once(pulled):
    session = a_session()
    session.playback.simulator.ends_at = 8
    actions.run(session, "run.play_human")
    actions.update(session, 0.01)
    session.playback.current.perturbed = pulled
    for _ in range(60):
        actions.update(session, 1 / 60)
    assert session.playback.outcome == "timeout"
    records = session.results.of(level_hash(session.document.level))
    assert records == ({} if pulled else {Trial(player=HUMAN): Record(attempts=1, solved=0)})
