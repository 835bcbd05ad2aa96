"""The decisions of the file browser, without a window."""

import pytest

from editor.base.prompts import FileQuestion
from editor.window.file_choice import FileChoice


def choice(folder, purpose="save", **more):
    asked = FileQuestion(purpose=purpose, title="?", folder=folder, answer=lambda _: None, **more)
    return FileChoice(asked)


def test_a_name_gets_its_ending_and_what_is_there_is_replaced_at_the_second_answer(tmp_path):
    chosen = choice(tmp_path)
    chosen.enter("car")
    assert chosen.accept() == (True, tmp_path / "car.json")
    (tmp_path / "car.json").write_text("{}")
    assert chosen.accept() == (False, None)
    assert chosen.overwrite == tmp_path / "car.json"
    assert chosen.accept() == (True, tmp_path / "car.json")
    chosen.enter("cart")
    assert chosen.overwrite is None


def test_what_is_there_in_one_folder_is_not_warned_of_in_another(tmp_path):
    (tmp_path / "car.json").write_text("{}")
    (tmp_path / "other").mkdir()
    chosen = choice(tmp_path)
    chosen.enter("car")
    chosen.accept()
    chosen.go(tmp_path / "other")
    assert (chosen.name, chosen.overwrite) == ("car", None)
    assert chosen.accept() == (True, tmp_path / "other" / "car.json")


@pytest.mark.parametrize(
    ("name", "told"),
    [
        (".json", "A name belongs before"),
        ("no/car", "There is no folder no."),
        ("   ", "A name needs more than blanks."),
        ("n" * 251, "nnnnnnnnnnnnnnnnnnnn…: this name is too long"),
    ],
)
def test_what_cannot_be_saved_is_told(tmp_path, name, told):
    chosen = choice(tmp_path)
    chosen.enter(name)
    assert not chosen.accept()[0]
    assert chosen.told("Save").startswith(told)
    chosen.enter("car")
    assert chosen.told("Save") == ""


def test_blanks_around_a_name_are_no_part_of_it_and_what_failed_before_is_told(tmp_path):
    chosen = choice(tmp_path, error="the disk is full")
    assert chosen.told("Save") == "the disk is full"
    for name in (" car ", "no/../car"):
        chosen.enter(name)
        assert chosen.told("Save") == ""
        assert chosen.accept() == (True, tmp_path.resolve() / "car.json")


def test_a_folder_that_is_not_there_is_made_at_the_second_answer(tmp_path):
    chosen = choice(tmp_path)
    chosen.enter("new/inner/car")
    assert not chosen.accept()[0]
    assert chosen.told("Save") == "There is no folder inner. Press Save to make it."
    assert chosen.entries() == [] and chosen.unreadable == ""
    assert chosen.accept() == (True, tmp_path / "new" / "inner" / "car.json")
    assert (tmp_path / "new" / "inner").is_dir()
    (tmp_path / "file").write_text("")
    chosen.enter("file/car")
    chosen.accept()
    assert not chosen.accept()[0]
    assert "cannot be made" in chosen.told("Save")


def test_a_folder_that_cannot_be_listed_says_so_in_its_list(tmp_path):
    chosen = choice(tmp_path / "gone", "open")
    chosen.folder = tmp_path / "gone"
    assert chosen.entries() == [] and "gone" in chosen.unreadable
    assert chosen.told("Open") == ""


def test_the_name_of_a_folder_leads_into_it(tmp_path):
    (tmp_path / "mine").mkdir()
    chosen = choice(tmp_path, "open")
    chosen.enter("mine")
    assert chosen.accept() == (False, None)
    assert (chosen.folder, chosen.name) == (tmp_path / "mine", "")
    chosen.enter("none.json")
    assert not chosen.accept()[0]
    assert "There is no file none.json" in chosen.error


def test_folders_come_first_and_other_files_are_left_out(tmp_path):
    (tmp_path / "z").mkdir()
    for name in ("b.json", "a.JSON", "c.png", ".hidden.json"):
        (tmp_path / name).write_text("")
    assert [path.name for path in choice(tmp_path).entries()] == ["z", "a.JSON", "b.json"]
    assert [path.name for path in choice(tmp_path, as_folder=True).entries()] == ["z"]


def test_a_new_folder_may_be_named_where_that_is_allowed(tmp_path):
    chosen = choice(tmp_path, "folder", fresh=True)
    chosen.enter("new")
    assert chosen.fresh() == tmp_path / "new"
    chosen.enter("not/there")
    assert chosen.fresh() is None
    assert choice(tmp_path, "folder").fresh() is None
