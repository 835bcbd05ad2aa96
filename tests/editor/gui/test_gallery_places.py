"""The places at the left of the gallery: folders below folders, folders that are gone."""

import shutil

from imgui_bundle import imgui

from editor.base.events import DropEvent
from kinetix.level.codec import save_level
from tests.editor.core.test_gallery import playable
from tests.editor.gui.browsing import cards, settle


def with_inner(gallery, mine):
    """Make a folder below the user's own, and show it alone."""
    inner = mine / "in"
    inner.mkdir()
    save_level(playable("Inner", 2.5), inner / "inner.json")
    gallery.key("escape")
    gallery.key("ctrl+g")
    settle(gallery)
    gallery.click("gallery.folder.in")
    settle(gallery)
    assert cards(gallery) == {"gallery.card.inner"}
    return inner


def test_all_levels_are_shown_once_the_folder_is_gone(gallery, mine):
    shutil.rmtree(with_inner(gallery, mine))
    gallery.key("escape")
    gallery.key("ctrl+g")
    settle(gallery)
    assert gallery.session.gallery.folder is None and len(cards(gallery)) == 3


def test_a_narrow_window_names_the_folder_that_is_shown(gallery, mine):
    with_inner(gallery, mine)
    assert not gallery.shows("gallery.all_folders")
    gallery.host.resize((740, 600))
    settle(gallery)
    assert not gallery.shows("gallery.folder.in")
    assert gallery.probe("gallery.all_folders").high[0] < 740
    gallery.click("gallery.all_folders")
    settle(gallery)
    assert gallery.session.gallery.folder is None and "gallery.card.rocket" in cards(gallery)


def test_a_narrow_window_has_the_folders_and_tags_in_a_list(gallery, mine):
    inner = with_inner(gallery, mine)
    gallery.click("gallery.folder.all")
    assert not gallery.shows("gallery.places")
    gallery.host.resize((700, 420))
    settle(gallery)
    assert not gallery.shows("gallery.folder.in")
    gallery.click("gallery.places")
    gallery.frames(3)
    gallery.click("gallery.folder.in")
    settle(gallery)
    assert gallery.session.gallery.folder == inner and cards(gallery) == {"gallery.card.inner"}
    assert not gallery.shows("gallery.folder.in")
    gallery.click("gallery.places")
    gallery.frames(3)
    gallery.key("escape")
    gallery.frames(3)
    assert gallery.session.gallery.open and not gallery.shows("gallery.folder.in")


def test_a_folder_below_another_one_has_two_lines_and_both_can_be_clicked(gallery, mine):
    inner = mine / "in"
    inner.mkdir()
    save_level(playable("Inner", 2.5), inner / "inner.json")
    gallery.host.frames(1, DropEvent(path=str(inner)))
    settle(gallery)
    x, own = gallery.probe("gallery.folder.in").centre
    low, high = gallery.probe("gallery.folder.Kinetix").low, gallery.probe("gallery.folder.in").low
    lines = {"its own": own, "below the other": low[1] + (high[1] - low[1]) * 3 / 4}
    for name, y in lines.items():
        gallery.click("gallery.folder.all")
        gallery.click_at(x, y)
        assert gallery.session.gallery.folder == inner, name
        assert cards(gallery) == {"gallery.card.inner"}, name


def test_no_message_for_programmers_is_on_the_screen(gui):
    assert not imgui.get_io().config_debug_highlight_id_conflicts


def test_a_card_is_dragged_onto_a_folder_which_it_goes_to(gallery, mine):
    with_inner(gallery, mine)
    gallery.click("gallery.folder.all")
    settle(gallery)
    x, y = gallery.probe("gallery.card.rocket").centre
    to = gallery.probe("gallery.folder.in").centre
    gallery.move(x, y)
    gallery.button(x, y, pressed=True)
    for k in range(1, 9):
        gallery.move(x + (to[0] - x) * k / 8, y + (to[1] - y) * k / 8)
    gallery.button(*to, pressed=False)
    settle(gallery)
    assert (mine / "in" / "rocket.json").exists() and not (mine / "rocket.json").exists()
    gallery.key("ctrl+z")
    settle(gallery)
    assert (mine / "rocket.json").exists()


def test_the_menu_of_a_folder_takes_all_its_levels_into_the_set(gallery, mine):
    with_inner(gallery, mine)
    gallery.text("rocket")
    gallery.frames(3)
    x, y = gallery.probe("gallery.folder.in").centre
    gallery.click_at(x, y, button=3)
    gallery.frames(3)
    gallery.click("gallery.place.gallery.add_to_set")
    settle(gallery)
    assert list(gallery.session.gallery.tray) == [str(mine / "in" / "inner.json")]
