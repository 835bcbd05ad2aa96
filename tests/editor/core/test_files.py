"""Saving, autosave, recovery and changes from outside."""

import errno
import json
import os

import pytest

from editor import actions
from editor.actions.files import external_change, file, folders
from editor.base.controls import Drive
from editor.base.settings import RECENTS_MAX, Settings, SettingsKeeper
from editor.documents import files, recovery
from editor.documents.commands.bodies import AddBody
from editor.documents.commands.fields import SetField, SetLevelField
from editor.documents.commands.group import Move, Scale
from editor.documents.document import Document
from kinetix.errors import CommandError, LevelError
from kinetix.level.codec import load_level, save_level
from kinetix.paths import levels_dir, user_levels_dir
from tests.editor.core.helpers import a_level, a_session, texts

MOVE = Move(ids=(3,), shift=(0.25, 0.0))


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "levels" / "mine.json"
    path.parent.mkdir()
    save_level(a_level(), path)
    return path


def test_a_save_keeps_the_previous_content_beside_it(path):
    before = path.read_bytes()
    document = files.open_document(path)
    document.commit(MOVE)
    files.save_document(document, path, "kinetix-level")
    assert not document.dirty
    assert path.with_name("mine.json.bak").read_bytes() == before
    assert load_level(path) == document.level


def test_what_was_added_and_undone_costs_a_save_nothing(path):
    save_level(load_level("m/segway"), path)
    document = files.open_document(path)
    opened = document.level
    document.commit(AddBody(body=opened.bodies[0]))
    document.undo()
    assert document.level is document.level
    files.save_document(document, path, "kinetix-level")
    saved = load_level(path)
    assert saved.solution == opened.solution is not None
    assert saved.size == opened.size == "m"
    assert saved.bodies == opened.bodies
    assert document.redo()  # what was undone can still be done again
    assert len(document.level.bodies) == len(opened.bodies) + 1


def an_outgrown_level():
    """A level of size s with more shapes than that has room for."""
    level = a_level()
    more = tuple(level.bodies[2].replace(id=100 + i, role="none") for i in range(9))
    return level.replace(bodies=level.bodies + more, size="s", next_id=200)


@pytest.mark.parametrize("format", ["kinetix-level", "kinetix-env"])
def test_a_level_that_outgrew_its_size_can_be_opened_again(path, format):
    session = a_session(level=an_outgrown_level())
    assert file.save_now(session, session.document, path, format) == ""
    assert any("does not fit size s" in text for text in texts(session))
    assert not session.document.dirty
    assert len(load_level(path).bodies) == len(session.document.level.bodies)


def test_a_failed_save_of_a_level_that_outgrew_its_size_changes_nothing(path, monkeypatch):
    session = a_session(level=an_outgrown_level())

    def full(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    entries = len(session.document.history.entries)
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        assert "No space" in file.save_now(session, session.document, path, "kinetix-level")
    assert session.document.level.size == "s"
    assert len(session.document.history.entries) == entries
    assert file.save_now(session, session.document, path, "kinetix-level") == ""
    assert any("does not fit size s" in text for text in texts(session))


@pytest.mark.parametrize(
    ("command", "says"),
    [
        (Scale(ids=(1,), factor=0.01, pivot=(2.0, 2.0)), "area"),
        (SetLevelField(field="tags", value=["jump", "jump"]), "each tag once"),
    ],
)
def test_what_no_file_could_hold_is_refused_at_once(path, command, says):
    document = files.open_document(path)
    before = document.level
    with pytest.raises(CommandError, match=f"{says}.* Nothing was changed"):
        document.commit(command)
    assert document.level == before
    files.save_document(document, path, "kinetix-level")
    assert load_level(path) == before


def test_fixed_shapes_can_be_set_free_and_free_ones_fixed():
    for name in ("m/trebuchet", "l/rover_ridge", "l/clockwork", "s/wheelie"):
        document = Document(load_level(name))
        for body in document.level.bodies:
            document.commit(SetField(ids=(body.id,), field="fixed", value=not body.fixed))
            assert document.level.body(body.id).fixed != body.fixed


def test_the_copy_of_a_level_that_outgrew_its_size_can_be_restored(tmp_path):
    session = a_session(level=a_level().replace(size="s"))
    for number in range(9):
        session.execute(AddBody(body=an_outgrown_level().bodies[4 + number]))
    session.save_aside()
    session.autosaves.flush()
    (left,) = [recovery._read(copy) for copy in session.autosaves.folder.glob("*[0-9].json")]
    assert len(left.level.bodies) == len(session.document.level.bodies)


def test_a_failed_save_leaves_the_old_file_and_the_changes(path, monkeypatch):
    before = path.read_bytes()
    document = files.open_document(path)
    document.commit(MOVE)

    def full(*args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(LevelError, match="No space left"):
        files.save_document(document, path, "kinetix-level")
    assert path.read_bytes() == before
    assert document.dirty
    assert sorted(p.name for p in path.parent.iterdir()) == ["mine.json"]


def test_a_read_only_file_is_not_replaced(path, monkeypatch):
    document = files.open_document(path)
    document.commit(MOVE)
    monkeypatch.setattr(os, "access", lambda *args: False)
    with pytest.raises(LevelError, match="read-only"):
        files.save_document(document, path, "kinetix-level")
    assert document.dirty


def test_a_failed_save_is_told(path):
    session = a_session()
    actions.handle(session, actions_drop(path))
    session.execute(MOVE)
    path.unlink()
    path.parent.rmdir()
    actions.run(session, "file.save")
    assert session.document.dirty
    told = f"{path}: cannot be saved: its folder is gone"
    assert any(told in line for line in session.log.lines)
    assert session.prompts[-1].error.endswith("its folder is gone"), "where it can be read"


def test_what_cannot_be_saved_there_may_be_saved_elsewhere(path, tmp_path, monkeypatch):
    session = a_session()
    actions.handle(session, actions_drop(path))
    session.execute(MOVE)
    with monkeypatch.context() as context:
        context.setattr(os, "access", lambda *args: False)
        actions.run(session, "file.save")
        question = session.prompts[-1]
    assert question.purpose == "save" and question.folder == user_levels_dir()
    assert "read-only" in question.error
    session.prompts.pop().answer(tmp_path / "elsewhere.json")
    assert not session.document.dirty
    assert session.document.path == tmp_path / "elsewhere.json"


def actions_drop(path):
    from editor.base.events import DropEvent

    return DropEvent(path=str(path))


def change_outside(path, level):
    stamp = path.stat().st_mtime_ns
    save_level(level, path)
    os.utime(path, ns=(stamp + 10**9, stamp + 10**9))


def outside_session(path):
    session = a_session()
    actions.handle(session, actions_drop(path))
    return session


def test_a_file_that_comes_back_is_looked_at_again(path):
    session = outside_session(path)
    before, mine = path.read_bytes(), session.document.level
    path.unlink()
    actions.update(session, 2.1)
    assert session.document.dirty and session.document.outside == ""
    save_level(mine.replace(name="theirs", thrusters=()), path)
    actions.update(session, 4.2)
    assert "1 gone" in session.document.outside
    assert "settings of the level" in session.document.outside
    path.write_bytes(before)
    actions.update(session, 6.3)
    assert session.document.outside == "" and not session.document.dirty


@pytest.mark.parametrize("meanwhile", ["a shape was drawn and undone", "an old name waits"])
def test_a_file_that_comes_back_the_same_is_no_change(path, tmp_path, meanwhile):
    if meanwhile == "an old name waits":
        (tmp_path / "state").mkdir()
        names = {str(path.resolve()): {"3": "Ball"}}
        (tmp_path / "state" / "names.json").write_text(json.dumps(names))
    session = outside_session(path)
    if meanwhile == "an old name waits":
        assert session.document.level.body(3).name == "Ball"
    else:
        session.execute(AddBody(body=a_level().body(3)))
        actions.run(session, "edit.undo")
    before = path.read_bytes()
    path.unlink()
    actions.update(session, 2.1)
    assert session.document.dirty
    path.write_bytes(before)
    actions.update(session, 4.2)
    assert session.document.outside == "" and not session.document.dirty


def test_a_change_from_outside_is_told_and_can_be_taken(path):
    session = outside_session(path)
    theirs = MOVE.apply(a_level())
    change_outside(path, theirs)
    assert not actions.run(session, "file.reload")
    actions.update(session, 2.1)
    assert "shapes: 0 new, 0 gone, 1 changed" in session.document.outside
    assert session.prompts == []  # nothing stands in the way of working on
    assert actions.run(session, "file.reload")
    assert session.document.outside == ""
    assert session.document.level.body(3) == theirs.body(3)
    assert not session.document.dirty
    actions.run(session, "edit.undo")
    assert session.document.level.body(3) == a_level().body(3)


def test_keeping_mine_makes_it_unsaved(path):
    session = outside_session(path)
    change_outside(path, MOVE.apply(a_level()))
    actions.update(session, 2.1)
    assert actions.run(session, "file.keep_mine")
    assert session.document.dirty
    actions.update(session, 2.1)
    assert session.document.outside == ""


def test_the_differences_are_listed_and_select(path):
    session = outside_session(path)
    theirs = MOVE.apply(a_level())
    more = theirs.body(4).replace(id=9, position=(2.0, 3.0))
    change_outside(path, theirs.replace(bodies=(*theirs.bodies, more), thrusters=(), next_id=10))
    actions.update(session, 2.1)
    actions.run(session, "file.differences")
    prompt = session.prompts[-1]
    told = {choice.id: choice.detail for choice in prompt.choices}
    assert told == {"9": "new", "6": "gone", "3": "changed"}
    session.answer(prompt, "3")
    assert session.selection == (3,)
    actions.run(session, "file.differences")
    session.answer(session.prompts[-1], "9")  # what is not here cannot be selected
    assert session.selection == ()


def test_a_file_that_cannot_be_read_any_more_is_told(path):
    session = outside_session(path)
    path.write_text("{")
    os.utime(path, ns=(10**18, 10**18))
    actions.update(session, 2.1)
    plain = "this is no level, or a damaged one: not JSON, line 1"
    assert f"It cannot be read now: {plain}" in session.document.outside
    for action in ("reload", "differences"):
        assert not actions.run(session, f"file.{action}")
    with pytest.raises(CommandError, match=f"^{path.name}: {plain}"):
        external_change.take(session, session.document)
    assert session.document.level.body(3) == a_level().body(3)
    session.execute(MOVE)
    actions.run(session, "file.save")
    assert f"It cannot be read: {plain}" in session.prompts[-1].message
    session.answer(session.prompts[-1], "cancel")
    save_level(a_level().replace(name="Mended"), path)
    os.utime(path, ns=(10**18, 2 * 10**18))
    actions.update(session, 2.1)
    assert actions.run(session, "file.reload")


def test_touching_a_file_is_no_change(path):
    session = outside_session(path)
    os.utime(path, ns=(10**18, 10**18))
    actions.update(session, 2.1)
    assert session.document.outside == ""


def test_a_removed_file_makes_its_document_unsaved(path):
    session = outside_session(path)
    path.unlink()
    actions.update(session, 2.1)
    assert session.document.dirty
    assert any("removed" in text for text in texts(session))


def test_recent_files_are_few_and_newest_first(tmp_path):
    settings = Settings()
    for k in range(RECENTS_MAX + 5):
        settings.remember(tmp_path / f"{k}.json")
    settings.remember(tmp_path / "10.json")
    assert len(settings.recents) == RECENTS_MAX
    assert settings.recents[0] == str(tmp_path / "10.json")
    assert len(set(settings.recents)) == RECENTS_MAX


def test_settings_survive_a_run(tmp_path):
    file = tmp_path / "settings.json"
    Settings(grid_step=0.25, snap_grid=False, keys={"tool.circle": ["o"]}).save(file)
    loaded = Settings.load(file)
    assert (loaded.grid_step, loaded.snap_grid) == (0.25, False)
    assert loaded.keys == {"tool.circle": ["o"]}


@pytest.mark.parametrize("text", ["", "[]", "{", '{"grid_step": "wide", "unknown": 1}'])
def test_broken_settings_are_the_defaults(tmp_path, text):
    file = tmp_path / "settings.json"
    file.write_text(text)
    assert Settings.load(file) == Settings()


@pytest.mark.parametrize("number", ["NaN", "1e999", "-1", "10000", "true", '"2"', "[2]"])
def test_a_scale_that_no_window_can_have_is_passed_over(tmp_path, number):
    file = tmp_path / "settings.json"
    file.write_text(f'{{"ui_scale": {number}, "text_scale": {number}, "wheel": "pan"}}')
    loaded = Settings.load(file)
    assert (loaded.ui_scale, loaded.text_scale, loaded.wheel) == (0.0, 1.0, "pan")


def test_what_only_a_later_version_offers_is_passed_over(tmp_path):
    file = tmp_path / "settings.json"
    controls = {"a": [99, 99], "left": [0, 2]}
    file.write_text(json.dumps({"physics": "quantum", "palette": "x", "controls": controls}))
    loaded = Settings.load(file)
    assert (loaded.physics, loaded.palette) == ("balanced", "kinetix")
    assert a_session(controls=loaded.controls).control_keys == {"left": Drive(channel=0, value=2)}
    keeper = SettingsKeeper(loaded, file)
    loaded.minimap = True
    keeper.save()
    assert json.loads(file.read_text())["physics"] == "quantum"  # which has it still


@pytest.mark.parametrize(
    "broken", [b'{"theme": "light", "keys": {},}', b"\xff\xfe no text", b"[1, 2]"]
)
def test_settings_that_cannot_be_read_are_told_and_stay_beside_the_new_ones(tmp_path, broken):
    path = tmp_path / "settings.json"
    path.write_bytes(broken)
    loaded = Settings.load(path)
    keeper = SettingsKeeper(loaded, path)
    assert keeper.fault.startswith(f"{path}: ")
    keeper.save()
    assert path.read_bytes() == broken  # nothing has changed yet
    loaded.minimap = not loaded.minimap
    keeper.save()
    assert (tmp_path / "settings.json.bak").read_bytes() == broken
    again = Settings.load(path)
    assert again == loaded and not SettingsKeeper(again, path).fault
    path.write_text("{")  # while the app runs
    loaded.volume = 0.25
    keeper.save()
    assert Settings.load(path) == loaded
    assert not SettingsKeeper(Settings(), tmp_path / "none.json").fault


@pytest.mark.parametrize("name", ["recents", "recent_agents"])
def test_what_is_forgotten_does_not_come_back_and_what_another_window_adds_stays(tmp_path, name):
    file = tmp_path / "settings.json"
    Settings(**{name: ["a", "b"]}).save(file)
    loaded = Settings.load(file)
    keeper = SettingsKeeper(loaded, file)
    Settings(**{name: ["theirs", "a", "b"]}).save(file)
    setattr(loaded, name, ["b"])
    keeper.save()
    assert getattr(Settings.load(file), name) == ["b", "theirs"]
    setattr(loaded, name, ["new", "b"])
    keeper.save()
    assert getattr(Settings.load(file), name) == ["new", "b", "theirs"]


def test_two_windows_keep_the_folders_keys_and_layouts_of_each_other(tmp_path):
    file = tmp_path / "settings.json"
    folders = [f"/{k}" for k in range(RECENTS_MAX + 2)]
    Settings(gallery_folders=folders, keys={"edit.undo": ["u"]}, layouts={"old": "1"}).save(file)
    windows = [(loaded, SettingsKeeper(loaded, file)) for loaded in map(Settings.load, [file] * 2)]
    for k, (loaded, keeper) in enumerate(windows):
        loaded.gallery_folders = [*folders[k + 1 :], f"/mine{k}"]
        loaded.keys[f"tool.{k}"] = ["o"]
        loaded.layouts[f"mine{k}"] = "2"
        keeper.save()
    first, first_keeper = windows[0]
    del first.layouts["old"], first.keys["edit.undo"]
    first_keeper.save()
    again = Settings.load(file)
    assert again.gallery_folders == [*folders[2:], "/mine0", "/mine1"]
    assert again.keys == {"tool.0": ["o"], "tool.1": ["o"]}
    assert again.layouts == {"mine0": "2", "mine1": "2"}


def test_what_no_setting_can_be_is_not_taken_over_from_the_file(tmp_path):
    file = tmp_path / "settings.json"
    file.write_text(json.dumps({"keys": {"edit.copy": 3}, "gallery_folders": 7}))
    loaded = Settings.load(file)
    keeper = SettingsKeeper(loaded, file)
    loaded.keys["edit.cut"], loaded.gallery_folders = ["x"], ["/a"]
    keeper.save()
    assert Settings.load(file) == loaded


def test_settings_that_could_not_be_written_go_with_the_next_change(tmp_path, monkeypatch):
    file = tmp_path / "settings.json"
    loaded = Settings()
    keeper = SettingsKeeper(loaded, file)
    tries = []

    def full(*_):
        tries.append(0)
        raise LevelError("No space left")

    with monkeypatch.context() as patched:
        patched.setattr("editor.base.settings.write_state", full)
        loaded.theme = "light"
        for again in (False, True):
            with pytest.raises(LevelError):
                keeper.save(again=again)
            keeper.save()  # not in every second
        assert len(tries) == 2
    keeper.save()
    assert not file.exists()
    loaded.volume = 0.25
    keeper.save()
    assert Settings.load(file) == loaded


def test_folders_that_cannot_be_reached_keep_no_dialog_away(tmp_path):
    unreachable = tmp_path / ("x" * 300)  # an error for everybody, as a locked folder is for most
    session = a_session()
    session.settings.recents = [str(unreachable / "a.json")]
    session.settings.save_folder = str(unreachable)
    session.settings.recent_agents = [str(unreachable)]
    assert folders.to_open(session) == levels_dir()
    assert folders.to_save(session) == user_levels_dir()
    assert actions.run(session, "agent.choose_a")
    assert session.prompts


def test_a_file_whose_name_is_no_unicode_is_refused_and_no_recent_one(tmp_path):
    """Nothing on the screen can show it."""
    path = tmp_path / "latin\udce9.json"
    save_level(a_level(), path)
    with pytest.raises(LevelError, match="no Unicode text; rename it"):
        files.open_document(path)
    file = tmp_path / "settings.json"
    Settings(recents=["/a/latin\udce9.json"]).save(file)
    assert Settings.load(file).recents == []
    file.write_text(json.dumps({"palette": "\ud800", "physics": "\ud800", "minimap": True}))
    assert Settings.load(file).minimap


def test_settings_that_are_nested_too_deeply_or_of_other_types_do_not_stop_a_start(tmp_path):
    file = tmp_path / "settings.json"
    file.write_text("[" * 100_000)
    assert Settings.load(file) == Settings()
    file.write_text('{"recents": [1, {}], "keys": {"a": [{}]}, "layouts": [], "grid_step": 1}')
    assert Settings.load(file) == Settings(grid_step=1.0)
