"""Random levels, exports and sets leave the user's files; files that do not open are told."""

import errno
import os
import re
import time
from pathlib import Path

import pytest

from editor import actions
from editor.actions.files import file
from editor.actions.files.tab_menu import open_tab_menu
from editor.base.events import DropEvent, QuitEvent
from editor.documents import files
from editor.documents.commands.group import Move, Remove
from editor.documents.document import Document
from editor.gallery.export import SetPlan, export_set
from editor.play.mode import Mode
from editor.play.trace_files import read_trace, write_trace
from editor.session import Session
from editor.worker.jobs import Worker
from kinetix.errors import CommandError, KinetixError, LevelError
from kinetix.level.codec import dumps, load_level, save_level
from kinetix.level.model import MAX_ENTITIES
from kinetix.level.sets import load_set
from tests.editor.core.helpers import a_level, a_session, texts
from tests.editor.core.test_traces import played  # noqa: F401 - a fixture

MOVE = Move(ids=(3,), shift=(0.25, 0.0))


@pytest.fixture
def drawing(path):
    """A session with a file open, whose random levels are a level of the tests."""
    session = Session(worker=Worker(perform=lambda request, progress: a_level()))
    file.open_path(session, path)
    yield session
    session.worker.stop()


def draw(session, action="level.random"):
    actions.run(session, action)
    while not session.worker.idle:  # what is finished is taken by the update
        time.sleep(0.005)
        actions.update(session, 0.01)


def test_a_random_level_leaves_the_open_file_alone(drawing, path):
    drawing.execute(MOVE)
    mine = drawing.document
    draw(drawing)
    assert drawing.tabs[0].document is mine
    assert (mine.path, mine.dirty) == (path, True)
    assert drawing.document.path is None
    assert drawing.document.title == "Random 1"
    actions.run(drawing, "file.save")  # asks for a name: it has none
    assert drawing.prompts[-1].purpose == "save"
    assert load_level(path) == a_level()


def test_random_levels_that_nobody_changed_share_a_tab(drawing):
    draw(drawing)
    draw(drawing)
    assert [tab.document.title for tab in drawing.tabs] == ["mine.json", "Random 2"]
    drawing.execute(MOVE)
    draw(drawing, "level.random_machine")
    assert [tab.document.title for tab in drawing.tabs][2:] == ["Machine 3"]


def test_a_random_level_takes_the_place_of_no_other_level(drawing):
    draw(drawing)
    drawing.open_tab(Document(a_level().replace(name="An example")))
    draw(drawing)
    titles = [tab.document.title for tab in drawing.tabs]
    assert titles == ["mine.json", "Random 1", "An example", "Random 2"]
    drawing.show_tab(1)
    draw(drawing)
    assert drawing.tabs[1].document.title == "Random 3" and len(drawing.tabs) == 4


@pytest.mark.parametrize("way", ["file.close_tab", "file.quit"])
def test_a_pasted_level_is_asked_about_before_it_is_gone(session, way):
    session.clipboard.set(dumps(a_level().replace(name="From a friend")))
    actions.run(session, "edit.paste")
    actions.run(session, way)
    assert session.prompts[-1].title == "Unsaved changes" and not session.quitting
    assert session.document.title == "From a friend"


def test_closing_twice_asks_once(drawing):
    drawing.execute(MOVE)
    for _ in range(2):
        actions.handle(drawing, QuitEvent())
    (question,) = drawing.prompts
    drawing.answer(question, "cancel")
    actions.handle(drawing, QuitEvent())
    drawing.answer(drawing.prompts[-1], "discard")
    assert drawing.quitting


def test_a_failed_trace_leaves_the_old_one(played, tmp_path, monkeypatch):  # noqa: F811
    path = tmp_path / "episode.npz"
    trace, level = played.playback.trace, played.playback.level
    write_trace(trace, level, path)

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("kinetix.files.atomic.os.fsync", full)
    with pytest.raises(KinetixError, match=r"episode\.npz: cannot be saved: No space"):
        write_trace(trace, level, path)
    assert read_trace(path).level == level
    assert [p.name for p in tmp_path.iterdir() if p.is_file()] == ["episode.npz"]


def test_a_set_overwrites_no_level_in_its_folder(path, tmp_path):
    there = tmp_path / "set" / "mine.json"
    there.parent.mkdir()
    save_level(MOVE.apply(a_level()), there)
    old = there.read_bytes()
    export_set({path: 1.0}, SetPlan(form="folder"), there.parent)
    first = there.with_name("mine_2.json").read_bytes()
    save_level(a_level().replace(max_timesteps=99), path)
    (third,) = export_set({path: 1.0}, SetPlan(form="folder"), there.parent).levels
    assert third.path == there.with_name("mine_3.json")
    assert there.read_bytes() == old
    assert there.with_name("mine_2.json").read_bytes() == first


@pytest.mark.parametrize("form", ["folder", "file"])
def test_a_set_takes_the_place_of_sets_alone(path, tmp_path, form):
    target = tmp_path / "set"
    manifest = target / "set.json" if form == "folder" else target
    manifest.parent.mkdir(exist_ok=True)
    save_level(MOVE.apply(a_level()), manifest)
    before, content = sorted(manifest.parent.iterdir()), manifest.read_bytes()
    with pytest.raises(LevelError, match="a file that is no level set"):
        export_set({path: 1.0}, SetPlan(form=form), target)
    assert manifest.read_bytes() == content
    assert sorted(manifest.parent.iterdir()) == before


def test_copies_of_a_set_differ_in_more_than_case(path, tmp_path):
    upper = tmp_path / "MINE.json"
    save_level(a_level().replace(max_timesteps=99), upper)
    made = export_set({path: 1.0, upper: 1.0}, SetPlan(form="folder"), tmp_path / "set")
    assert [each.name for each in made.levels] == ["mine", "MINE_2"]


def test_a_set_in_the_folder_of_its_levels_leaves_them_as_they_are(path):
    before = path.read_bytes() + b"\n"
    path.write_bytes(before)  # the same level, written by hand
    export_set({path: 1.0}, SetPlan(form="folder"), path.parent)
    assert path.read_bytes() == before
    assert not path.with_name("mine.json.bak").exists()
    assert [each.level for each in load_set(path.parent / "set.json").levels] == [a_level()]


def test_saving_the_same_again_keeps_the_older_backup(path):
    from editor.documents import files

    before = path.read_bytes()
    document = files.open_document(path)
    document.commit(MOVE)
    files.save_document(document, path, "kinetix-level")
    files.save_document(document, path, "kinetix-level")
    assert path.with_name("mine.json.bak").read_bytes() == before


def test_a_file_that_cannot_be_opened_is_told_until_it_is_read(session, tmp_path):
    bad = tmp_path / "bad.json"
    bad.write_text("{")
    for each in (bad, tmp_path / "none.json", tmp_path / "none.npz"):
        actions.handle(session, DropEvent(path=str(each)))
    (prompt,) = session.prompts
    assert all(name in prompt.message for name in ("bad.json", "none.json", "none.npz"))
    assert [tab.document.title for tab in session.tabs] == ["Test"]
    session.answer(prompt, "ok")
    assert not session.prompts


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("bad.json", b'{"format": 1 2}', "this is no level, or a damaged one: not JSON, line 1"),
        ("bad.json", b"\x89\xcc", "this is no text; a level is a text file in JSON"),
        ("bad.json", b"[]", "this is JSON, but no level"),
        ("empty.json", b"", "this file is empty"),
        ("bad.png", b"", "this is no level; a level is a file that ends in .json"),
        ("none.json", None, "there is no such file"),
    ],
)
def test_why_a_file_cannot_be_opened_is_told_by_its_name_first(
    session, tmp_path, name, content, told
):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    assert not file.open_path(session, path)
    (prompt,) = session.prompts
    assert prompt.message.startswith(f"{name}: {told}")
    assert prompt.message.endswith(f"\n{tmp_path}")
    assert str(path) in session.log.lines[-1]


def test_the_folder_of_a_file_is_told_from_the_root_on(session, tmp_path, monkeypatch):
    (tmp_path / "class").mkdir()
    (tmp_path / "class" / "bad.json").write_text("{")
    monkeypatch.chdir(tmp_path)
    assert not file.open_path(session, Path("class/bad.json"))
    assert session.prompts[-1].message.endswith(f"\n{tmp_path / 'class'}")


def test_many_bad_files_do_not_fill_the_screen(session, tmp_path):
    for k in range(200):
        actions.handle(session, DropEvent(path=str(tmp_path / f"{'n' * 100}{k}.json")))
    assert len(session.prompts) == 1
    assert len(session.prompts[0].message) < 3000


def test_the_command_line_opens_no_empty_tab(tmp_path, capsys):
    from editor.__main__ import Options, _open_files

    session = Session()
    names = [tmp_path / "a.json", tmp_path / "b.json"]
    with pytest.raises(KinetixError, match=r"b\.json: there is no such file"):
        _open_files(Options(files=tuple(names)), session)
    assert re.fullmatch(r".*a\.json: there is no such file[^\n]*\n", capsys.readouterr().err)
    save_level(a_level(), names[0])
    session = Session()
    _open_files(Options(files=tuple(names)), session)
    assert [tab.document.path for tab in session.tabs] == [Path(names[0])]
    assert "b.json" in session.prompts[-1].message


def test_a_shape_goes_no_farther_than_a_file_can_hold(tmp_path):
    document = Document(load_level("s/first_flight"))
    bodies = document.level.bodies
    ids = tuple(body.id for body in bodies[-2:])
    document.commit(Move(ids=ids, shift=(40.0, -40.0)))
    moved = [body for body in document.level.bodies if body.id in ids]
    assert max(body.position[0] for body in moved) == 15.0
    assert min(body.position[1] for body in moved) == -15.0
    apart = [a.position[0] - b.position[0] for a, b in (bodies[-2:], moved)]
    assert apart[0] == pytest.approx(apart[1], abs=1e-5)
    files.save_document(document, tmp_path / "x.json", "kinetix-level")
    assert files.open_document(tmp_path / "x.json").level == document.level


class _OneMore:
    label, merge_key = "Add", None

    def apply(self, level):
        body = level.bodies[-1].replace(id=level.next_id)
        return level.replace(bodies=(*level.bodies, body), next_id=level.next_id + 1)


def test_no_more_is_made_than_a_file_can_hold():
    document = Document(load_level("s/first_flight"))
    like = document.level.bodies[-1]
    start = document.level.next_id
    many = tuple(like.replace(id=start + k) for k in range(MAX_ENTITIES))
    full = (*document.level.bodies, *many)[:MAX_ENTITIES]
    document = Document(document.level.replace(bodies=full, joints=(), thrusters=(), next_id=9999))
    before = document.level
    with pytest.raises(CommandError, match="at most 1024 shapes; this would make 1025"):
        document.commit(_OneMore())
    assert document.level == before
    document.commit(Remove(ids=(full[-1].id,)))
    assert len(document.level.bodies) == MAX_ENTITIES - 1


def test_a_folder_dropped_on_the_window_is_in_the_gallery(path):
    session = Session()
    actions.handle(session, DropEvent(path=str(path.parent)))
    assert session.gallery.open and session.gallery.folder == path.parent.resolve()
    assert session.settings.gallery_folders == [str(path.parent.resolve())]
    assert not session.prompts


def test_a_file_that_is_open_already_comes_out_of_the_gallery(path):
    session = Session()
    file.open_path(session, path)
    session.open_tab(Document(a_level()))
    for _ in range(2):  # behind another tab, and in front
        actions.run(session, "level.gallery")
        assert session.gallery.open
        actions.handle(session, DropEvent(path=str(path)))
        assert not session.gallery.open and session.document.path == path


def test_a_level_that_has_outgrown_its_size_is_not_played_and_says_what_is_too_much(path):
    session = Session()
    level = load_level("s/first_flight").replace(size="s")
    extra = tuple(
        level.bodies[-1].replace(id=level.next_id + k, position=(1.0, 1.0)) for k in range(20)
    )
    session.open_tab(
        Document(level.replace(bodies=(*level.bodies, *extra), next_id=level.next_id + 20))
    )
    actions.run(session, "run.play_human")
    assert session.editing
    (said,) = [text for text in texts(session) if "does not fit" in text]
    assert "Problems" in said


@pytest.mark.parametrize("content", [b"hello", b"GIF89a\xf4\xff", b""])
def test_a_file_of_another_kind_is_told_in_plain_words(tmp_path, content):
    session = Session()
    other = tmp_path / "a.txt"
    other.write_bytes(content)
    actions.handle(session, DropEvent(path=str(other)))
    assert session.prompts[-1].message == (
        f"a.txt: this is no level; a level is a file that ends in .json\n{tmp_path}"
    )


@pytest.mark.parametrize("way", ["close", "others"])
def test_closing_another_level_leaves_the_game_in_front_alone(way):
    session = a_session()
    behind = session.tab
    session.open_tab(Document(a_level().replace(name="In front")))
    assert actions.run(session, "run.play_human")
    for _ in range(20):
        actions.update(session, 1 / 60)
    open_tab_menu(session, behind if way == "close" else session.tab, (0.0, 0.0))
    session.answer(session.prompts[-1], way)
    actions.update(session, 1 / 60)
    assert [tab.document.level.name for tab in session.tabs] == ["In front"]
    assert session.mode is Mode.PLAYING
    open_tab_menu(session, session.tab, (0.0, 0.0))
    session.answer(session.prompts[-1], "close")
    assert session.editing
