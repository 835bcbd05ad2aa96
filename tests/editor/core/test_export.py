"""Exports of a level in another program's format."""

import pytest

from editor import actions
from editor.documents import files
from editor.documents.commands.group import Move
from kinetix.level.codec import load_document, save_level
from tests.editor.core.helpers import a_level, a_session, texts


@pytest.fixture
def session(tmp_path):
    session = a_session(a_level())
    save_level(a_level(), tmp_path / "mine.json")
    session.open_tab(files.open_document(tmp_path / "mine.json"))
    return session


def export(session, path):
    """File, Export…, Level for kinetix-env, and a name."""
    actions.run(session, "file.export")
    session.answer(session.prompts[-1], "json")
    session.answer(session.prompts[-1], path)


def test_a_level_is_exported_for_kinetix_env_as_it_stands(session, tmp_path):
    session.document.commit(Move(ids=(3,), shift=(0.25, 0.0)))
    export(session, tmp_path / "theirs.json")
    loaded = load_document(tmp_path / "theirs.json")
    assert loaded.format == "kinetix-env"
    assert loaded.level.bodies[2].position == pytest.approx((4.25, 3.0), abs=1e-3)
    assert session.document.dirty and session.document.path == tmp_path / "mine.json"
    assert "Wrote" in texts(session)[-1]


def test_what_kinetix_env_cannot_hold_is_told(session, tmp_path):
    export(session, tmp_path / "theirs.json")
    assert "kinetix-env has no place for: " in texts(session)[-1]


def test_a_level_that_is_open_is_not_replaced(session, tmp_path):
    before = (tmp_path / "mine.json").read_bytes()
    export(session, tmp_path / "mine.json")
    assert (tmp_path / "mine.json").read_bytes() == before
    assert "choose another name" in texts(session)[-1]


def test_a_file_that_was_there_stays_beside_the_export(session, tmp_path):
    (tmp_path / "theirs.json").write_text("something")
    export(session, tmp_path / "theirs.json")
    assert (tmp_path / "theirs.json.bak").read_text() == "something"
