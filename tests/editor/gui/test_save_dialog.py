"""The dialog that asks where a level is to be: the folder that it proposes, keys and buttons."""

from pathlib import Path

import pytest

from editor.base.prompts import FileQuestion
from editor.documents.commands.fields import SetField
from editor.window.browser import FileBrowser
from kinetix.errors import LevelError
from kinetix.level.codec import load_level
from kinetix.paths import levels_dir, user_levels_dir


def asked(gui) -> FileQuestion:
    gui.frames(4)
    (question,) = gui.session.prompts
    assert isinstance(question, FileQuestion)
    return question


def type_name(gui, name: str | Path) -> None:
    gui.key("ctrl+a")
    gui.text(str(name))
    gui.key("return")
    gui.frames(4)


@pytest.fixture
def drawn(gui):
    """A new level, begun while a level of the app is open and the last file that was opened."""
    gui.open(levels_dir() / "l" / "rover_ridge.json")
    gui.key("ctrl+n")
    gui.key("c")
    gui.drag((2.0, 2.0), (2.5, 2.5))
    return gui


def test_a_first_level_goes_to_the_users_folder(drawn):
    drawn.session.settings.save_folder = ""
    drawn.key("ctrl+s")
    assert asked(drawn).folder == user_levels_dir()
    type_name(drawn, "first")
    assert load_level(user_levels_dir() / "first.json").bodies == drawn.level.bodies
    assert drawn.session.document.path == user_levels_dir() / "first.json"


def test_the_next_level_goes_where_the_user_saved_last(drawn, tmp_path):
    (tmp_path / "mine").mkdir()
    drawn.key("ctrl+s")
    drawn.frames(4)
    type_name(drawn, tmp_path / "mine" / "one.json")
    drawn.open(levels_dir() / "s" / "first_flight.json")
    drawn.key("ctrl+n")
    drawn.key("ctrl+s")
    assert asked(drawn).folder == tmp_path / "mine"
    drawn.click("browser.cancel")
    (tmp_path / "mine" / "one.json").unlink()
    (tmp_path / "mine").rmdir()
    drawn.key("ctrl+s")
    assert asked(drawn).folder == user_levels_dir()


def test_a_level_of_the_app_is_saved_as_a_file_of_the_users(gui):
    gui.session.settings.save_folder = str(levels_dir() / "m")
    gui.open(levels_dir() / "l" / "rover_ridge.json")
    gui.session.queue("file.save_as")
    question = asked(gui)
    assert question.folder == user_levels_dir() and question.name == "rover_ridge.json"


def test_saving_a_level_of_the_app_makes_a_copy_of_the_users(gui):
    """Else the app's would be gone for good, and the user's work with the app's next version."""
    path = levels_dir() / "s" / "first_flight.json"
    before = path.read_bytes()
    user_levels_dir().mkdir(parents=True)
    (user_levels_dir() / "first_flight.json").write_text("somebody's")
    gui.open(path)
    gui.session.execute(SetField(ids=(1,), field="friction", value=0.9))
    gui.key("ctrl+s")
    question = asked(gui)
    assert question.folder == user_levels_dir() and question.name == "first_flight_2.json"
    assert "came with the app" in question.title
    gui.frames(4)
    gui.key("return")
    gui.frames(4)
    assert gui.session.document.path == user_levels_dir() / "first_flight_2.json"
    assert path.read_bytes() == before
    gui.key("ctrl+s")
    assert not gui.session.prompts


def test_a_button_leads_to_the_users_folder_and_return_saves_there(drawn, tmp_path):
    drawn.session.settings.save_folder = str(tmp_path)
    drawn.key("ctrl+s")
    drawn.frames(4)
    assert not user_levels_dir().is_dir()
    drawn.click("browser.place.1")
    drawn.frames(2)
    assert not user_levels_dir().is_dir()
    drawn.key("return")
    drawn.frames(4)
    assert not drawn.session.prompts
    assert drawn.session.document.path == user_levels_dir() / "untitled.json"


def test_return_saves_after_a_click_in_the_list(drawn, tmp_path):
    (tmp_path / "inner").mkdir()
    drawn.session.settings.save_folder = str(tmp_path)
    drawn.key("ctrl+s")
    drawn.frames(4)
    drawn.click("browser.inner")
    drawn.frames(2)
    drawn.key("return")
    drawn.frames(4)
    assert (tmp_path / "inner" / "untitled.json").is_file()


def test_a_link_that_leads_nowhere_does_not_keep_a_dialog_from_saving(drawn, tmp_path):
    (tmp_path / "gone.json").symlink_to(tmp_path / "nowhere")
    drawn.session.settings.save_folder = str(tmp_path)
    drawn.key("ctrl+s")
    drawn.frames(4)
    type_name(drawn, tmp_path / "mine.json")
    assert not drawn.session.prompts
    assert (tmp_path / "mine.json").is_file()


def test_names_that_are_no_unicode_are_counted(drawn, tmp_path):
    (tmp_path / "latin\udce9.json").write_text("{}")
    (tmp_path / "inner\udce9").mkdir()
    drawn.session.settings.save_folder = str(tmp_path)
    drawn.key("ctrl+s")
    drawn.frames(4)
    assert drawn.host.ui._dialogs._browser._choice.hidden.startswith("2 here")
    type_name(drawn, "mine")
    assert (tmp_path / "mine.json").is_file()


def test_a_level_is_saved_where_the_folder_of_the_process_is_gone(drawn, tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    drawn.session.settings.save_folder = str(tmp_path)
    drawn.key("ctrl+s")
    drawn.frames(4)
    type_name(drawn, "mine")
    assert (tmp_path / "mine.json").is_file()


def test_a_users_folder_that_cannot_be_made_is_told(drawn):
    parent = user_levels_dir().parent
    parent.parent.mkdir(parents=True, exist_ok=True)
    if parent.is_dir():
        user_levels_dir().write_text("a file where the folder would be")
    else:
        parent.write_text("a file where the folder would be")
    drawn.session.settings.save_folder = ""
    drawn.key("ctrl+s")
    drawn.frames(4)
    drawn.key("return")
    drawn.frames(4)
    assert drawn.session.prompts, "still asking"
    assert not [line for line in drawn.session.log.lines if "Traceback" in line]


def test_a_dialog_that_cannot_be_drawn_does_not_lock_the_app(drawn, monkeypatch):
    def fails(*_):
        raise OSError("broken")

    monkeypatch.setattr(FileBrowser, "draw", fails)
    drawn.key("ctrl+s")
    drawn.frames(4)
    assert not drawn.session.prompts
    drawn.key("ctrl+n")
    assert len(drawn.session.tabs) == 3


def test_a_long_name_leaves_the_buttons_in_the_dialog(drawn, tmp_path):
    drawn.session.settings.save_folder = str(tmp_path)
    drawn.key("ctrl+o")
    drawn.frames(4)
    type_name(drawn, "o" * 300)
    x, _ = drawn.probe("browser.accept").centre
    assert asked(drawn) and x < drawn.host.size[0]
    type_name(drawn, "p" * 300)
    assert drawn.probe("browser.accept").centre[0] == x


def test_a_save_that_fails_asks_again_with_the_name_that_was_typed(drawn, tmp_path, monkeypatch):
    drawn.session.settings.save_folder = str(tmp_path)
    drawn.key("ctrl+s")
    drawn.frames(4)

    def full(*_, **__):
        raise LevelError("the disk is full")

    with monkeypatch.context() as patch:
        patch.setattr("editor.documents.files.write_with_backup", full)
        type_name(drawn, "long_to_type")
    assert asked(drawn).name == "long_to_type.json"
    drawn.key("return")
    drawn.frames(4)
    assert (tmp_path / "long_to_type.json").is_file()


@pytest.mark.parametrize("name", ["nowhere/one.json", ".json"])
def test_a_name_that_cannot_be_is_told_in_the_dialog(drawn, name):
    drawn.key("ctrl+s")
    drawn.frames(4)
    type_name(drawn, name)
    assert isinstance(drawn.session.prompts[0], FileQuestion)  # what was typed can be mended
    type_name(drawn, "one")
    assert drawn.session.document.path == user_levels_dir() / "one.json"
