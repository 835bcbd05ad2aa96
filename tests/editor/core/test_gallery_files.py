"""Work on several files of the gallery at once, and on files that level sets name."""

import pytest

from editor import actions
from editor.actions.gallery import gallery, many_files
from editor.gallery.export import SetPlan, export_set
from editor.window.panels.under_way import under_way
from kinetix.level.codec import save_level
from tests.editor.core.helpers import texts
from tests.editor.core.test_gallery import (  # noqa: F401
    choose,
    folder,
    names_of,
    playable,
    session,
)

# The fixtures `folder` and `session` are those of the gallery's tests.


def test_copies_are_made_of_all_that_can_be_read(session, folder):  # noqa: F811
    choose(session, "Hill cart", "broken", "Rocket")
    actions.run(session, "gallery.duplicate")
    assert {path.name for path in folder.rglob("*_copy*.json")} == {
        "hill_cart_copy.json",
        "rocket_copy.json",
    }
    assert "Made 2 copies" in texts(session)
    assert any("broken.json" in text for text in texts(session))
    assert {"Hill cart copy", "Rocket copy"} <= names_of(session)
    chosen = session.gallery.chosen(session.library, session.results)
    assert {card.name for card in chosen} == {"Hill cart copy", "Rocket copy"}


@pytest.fixture
def slow(monkeypatch):
    """Files take so long that a frame has time for one."""
    monkeypatch.setattr(many_files, "AT_ONCE", 0)
    monkeypatch.setattr(many_files, "_SLICE", 0.0)


def test_many_files_are_worked_on_frame_by_frame(session, folder, slow):  # noqa: F811
    choose(session, "Hill cart", "Rocket", "Nothing")
    actions.run(session, "gallery.duplicate")
    assert session.gallery.work.done == 1 and len(list(folder.rglob("*_copy*.json"))) == 1
    (part,) = [part for part in under_way(session) if part.action == "gallery.stop"]
    assert part.words.endswith("Copying levels 33%")
    actions.run(session, "gallery.delete")
    assert texts(session)[-1] == many_files.BUSY
    for _ in range(4):
        actions.update(session, 0.01)
    assert session.gallery.work is None and "Made 3 copies" in texts(session)


def test_escape_stops_the_work_on_files_and_what_is_done_stays(session, folder, slow):  # noqa: F811
    choose(session, "Hill cart", "Rocket")
    actions.run(session, "gallery.delete")
    actions.run(session, "gallery.close")
    assert session.gallery.open and session.gallery.work is None
    assert len(names_of(session) & {"Hill cart", "Rocket"}) == 1
    actions.run(session, "gallery.restore")
    actions.update(session, 0.01)
    assert {"Hill cart", "Rocket"} <= names_of(session)


@pytest.fixture
def with_sets(session, folder):  # noqa: F811
    """A set that names `rocket.json` beside it, and one that carries its levels."""
    rocket = {folder / "rocket.json": 1.0}
    export_set(rocket, SetPlan(form="folder"), folder)
    export_set(rocket, SetPlan(), folder / "whole.json")
    save_level(playable("Other", 2.5), folder / "other.json")
    gallery.look(session)
    assert session.library.wait(20) and len(session.library.sets) == 2
    return session


def rename(session, name):  # noqa: F811
    actions.run(session, "gallery.rename")
    session.answer(session.prompts[-1], name)


def delete(session, name):  # noqa: F811
    actions.run(session, "gallery.delete")


@pytest.mark.parametrize("act", [rename, delete])
def test_level_sets_that_miss_a_level_are_told(with_sets, folder, act):  # noqa: F811
    choose(with_sets, "Other")
    act(with_sets, "Another")
    assert not any("miss a level" in text for text in texts(with_sets))
    choose(with_sets, "Rocket")
    act(with_sets, "Feather")
    assert texts(with_sets)[-1] == f"Level sets that miss a level now: {folder.name}"
