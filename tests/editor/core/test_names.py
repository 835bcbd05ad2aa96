"""Names that the user gives: beside the level, not in it."""

import pytest

from editor.actions import file, run
from editor.base.prompts import TextQuestion
from editor.documents.commands.level import ReplaceLevel
from editor.documents.names import Names
from kinetix.level.codec import save_level
from tests.editor.core.helpers import a_level, a_session


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "cart.json"
    save_level(a_level(), path)
    return path


def rename(session, entity, name):
    session.selection = (entity,)
    assert run(session, "edit.rename")
    prompt = session.prompts[-1]
    assert isinstance(prompt, TextQuestion)
    session.answer(prompt, name)


def test_a_name_is_seen_everywhere_and_changes_no_level(session, path):
    assert file.open_path(session, path)
    before = path.read_bytes()
    rename(session, 1, "Chassis")
    assert session.document.name_of(1) == "Chassis"
    assert session.document.name_of(2) == "Circle 2"
    assert not session.document.dirty
    assert run(session, "file.save")
    assert path.read_bytes() == before


def test_a_name_comes_back_with_its_file(session, path):
    file.open_path(session, path)
    rename(session, 5, "Rear axle")
    again = a_session()
    assert file.open_path(again, path)
    assert again.document.name_of(5) == "Rear axle"
    rename(again, 5, "Joint 5")  # its plain name takes the other one away
    assert again.document.names == {}
    assert Names().of(path) == {}


def test_a_level_without_a_file_keeps_its_names_when_it_gets_one(session, tmp_path):
    session.document.commit(ReplaceLevel(level=a_level(), label="Start"))
    rename(session, 3, "Ball")
    target = tmp_path / "new.json"
    assert file.save_now(session, session.document, target, "kinetix-level")
    assert Names().of(target) == {3: "Ball"}


def test_arena_parts_and_several_things_have_no_name_to_change(session, path):
    file.open_path(session, path)
    for selection in ((), (1, 2), ("floor",)):
        session.selection = selection
        assert not run(session, "edit.rename")


@pytest.mark.parametrize("text", ["", "[]", '{"a": 1}', '{"a": {"x": "y", "3": 4}}'])
def test_a_broken_file_of_names_is_passed_over(tmp_path, text):
    stored = tmp_path / "names.json"
    stored.write_text(text)
    assert Names(stored).of(tmp_path / "a") == {}


def test_scripted_runs_leave_no_names(tmp_path):
    stored = tmp_path / "names.json"
    names = Names(stored, stored=False)
    names.keep(tmp_path / "a", {1: "One"})
    assert names.of(tmp_path / "a") == {1: "One"}
    assert not stored.exists()
