"""The set that is put together comes back after a restart; what was taken out, after Undo."""

import pytest

from editor.actions.files import quitting
from editor.actions.gallery import level_sets
from kinetix.level.codec import save_level
from kinetix.level.model import Level
from tests.editor.gui.browsing import settle


@pytest.fixture
def filled(gallery):
    """All three levels are in the set, which is in front."""
    gallery.key("ctrl+a")
    gallery.key("ctrl+shift+a")
    gallery.click("gallery.tab.set")
    return gallery


def test_the_set_is_there_again_after_a_restart(filled, make_gui):
    tray = filled.session.gallery.tray
    tray[next(iter(tray))] = 7.5
    quitting.quit_app(filled.session)
    assert filled.session.quitting and not filled.session.prompts
    again = make_gui()
    assert again.session.gallery.tray == tray and len(tray) == 3
    again.key("ctrl+g")
    settle(again)
    again.click("gallery.tab.set")
    assert again.shows("gallery.weight.Hill cart")


def test_the_set_is_kept_while_the_app_runs(filled, make_gui):
    """A killed app has no end at which it could write."""
    filled.frames(90)
    assert len(make_gui().session.gallery.tray) == 3


def test_a_level_that_was_taken_out_comes_back_with_its_weight_and_place(filled):
    gallery = filled.session.gallery
    path = next(iter(gallery.tray))
    gallery.tray[path] = 7.5
    before = list(gallery.tray.items())
    filled.frames(2)
    filled.click(f"gallery.drop.{path}")
    assert path not in gallery.tray
    assert filled.session.toasts[-1].text == "Hill cart is no longer in the set"
    filled.click("toast.gallery.set_back")
    assert list(gallery.tray.items()) == before


def test_undo_is_not_offered_once_the_set_was_changed_again(filled):
    gallery = filled.session.gallery
    path = next(iter(gallery.tray))
    filled.click(f"gallery.drop.{path}")
    assert filled.shows("toast.gallery.set_back")
    filled.click("gallery.card.hill_cart")
    filled.key("ctrl+shift+a")
    filled.frames(2)
    assert not filled.shows("toast.gallery.set_back")


def test_a_weight_before_the_last_change_comes_back(filled):
    gallery = filled.session.gallery
    before = dict(gallery.tray)
    filled.click("gallery.weight.Rocket")
    filled.key("ctrl+a")
    filled.text("2.5")
    filled.key("return")
    filled.frames(2)
    assert gallery.tray != before
    filled.session.queue("gallery.set_back")
    filled.frames(2)
    assert gallery.tray == before


def test_an_empty_set_is_not_exported(gallery, mine):
    save_level(Level(name="Nothing"), mine / "nothing.json")
    gallery.key("escape")
    gallery.key("ctrl+g")
    settle(gallery)
    gallery.click("gallery.card.nothing")
    gallery.session.queue("level.export_set")
    gallery.frames(4)
    gallery.click("export.leave_out")
    gallery.frames(4)
    assert gallery.session.gallery.tray == {}
    gallery.click("export.accept")
    gallery.frames(4)
    assert gallery.session.gallery.plan is not None and not gallery.shows("browser.accept")
    gallery.session.queue(lambda: level_sets.export_now(gallery.session))
    gallery.frames(2)
    assert not gallery.session.prompts
    assert gallery.session.toasts[-1].text == "No level is in the set: put some into it first."


def test_a_renamed_level_keeps_its_place_and_weight_also_in_the_set_before(filled, mine):
    gallery = filled.session.gallery
    gallery.tray[str(mine / "moon_cart.json")] = 2.5
    filled.click("gallery.empty")
    for card, name in (("moon_cart", "Sun cart"), ("sun_cart", "Star cart")):
        filled.click(f"gallery.card.{card}")
        filled.key("f2")
        filled.frames(3)
        filled.text(name)
        filled.click("line.accept")
        settle(filled)
        filled.session.queue("gallery.set_back")
        filled.frames(2)
    assert gallery.tray == {}
    filled.session.queue("gallery.set_back")
    filled.frames(2)
    assert list(gallery.tray.items()) == [
        (str(mine / "hill_cart.json"), 1.0),
        (str(mine / "star_cart.json"), 2.5),
        (str(mine / "rocket.json"), 1.0),
    ]
