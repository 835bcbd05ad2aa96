"""What is chosen in the gallery is what can be seen to be chosen."""

import dataclasses

import pytest

from editor.gallery.results import Record, Trial
from kinetix.level.codec import save_level
from tests.editor.core.test_gallery import playable
from tests.editor.gui.browsing import cards, settle


@pytest.fixture
def elsewhere(gallery, tmp_path):
    """Another folder of the gallery, with one level."""
    folder = tmp_path / "other"
    folder.mkdir()
    save_level(playable("Delta", 2.2), folder / "delta.json")
    gallery.session.settings.gallery_folders.append(str(folder))
    gallery.key("escape")
    gallery.key("ctrl+g")
    settle(gallery)
    return folder


@pytest.mark.parametrize("act", ["delete", "ctrl+d", "ctrl+shift+a"])
def test_nothing_is_done_to_levels_of_the_folder_that_was_left(gallery, mine, elsewhere, act):
    gallery.click("gallery.folder.Kinetix")
    gallery.key("ctrl+a")
    assert len(gallery.session.gallery.selection) == 3
    gallery.click("gallery.folder.other")
    settle(gallery)
    assert cards(gallery) == {"gallery.card.delta"}
    gallery.key(act)
    settle(gallery)
    assert len(list(mine.glob("*.json"))) == 3
    assert gallery.session.gallery.tray == {}


def test_what_a_search_hides_is_chosen_no_more(gallery, mine):
    gallery.key("ctrl+a")
    gallery.key("ctrl+f")
    gallery.text("rocket")
    gallery.key("down")
    gallery.key("delete")
    settle(gallery)
    assert {path.name for path in mine.glob("*.json")} == {"hill_cart.json", "moon_cart.json"}


def test_what_goes_out_of_sight_by_itself_is_not_deleted(gallery, mine):
    """A level that was solved meanwhile leaves the list of those that are not."""
    session = gallery.session
    session.gallery.wish = dataclasses.replace(session.gallery.wish, unsolved_by="Tester")
    gallery.key("ctrl+a")
    (card,) = [card for card in session.library.cards if card.name == "Rocket"]
    session.results.record(Trial(player="Tester"), {card.sha256: Record(attempts=1, solved=1)})
    gallery.key("delete")
    settle(gallery)
    assert [path.name for path in mine.glob("*.json")] == ["rocket.json"]
