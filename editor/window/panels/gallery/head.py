"""The head of the gallery: title, search, filters, order."""

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.gallery.card import Card
from editor.gallery.search import SIZE_ORDER, SORTS, Sort
from editor.gallery.view import GalleryView
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, Icons
from editor.toolkit.widgets import px
from editor.window.panels.gallery.places import draw_places

if TYPE_CHECKING:
    from editor.session import Session

SIZE_LABELS: Final = {
    "s": "S",
    "m": "M",
    "l": "L",
    "locomotion": "Locomotion",
    "other": "Other",
}
"""Names of the classes of size."""
_SWITCH: Final = 136.0
_WINNERS: Final = 190.0
_CLEAR: Final = 100.0
"""Widths of what filters [px at 100 %]."""
_LEAST: Final = 136.0
"""Room that the shortest search and the arrow of the order take [px at 100 %]."""
_LIST: Final = 240.0
"""Width of the list of folders, sets and tags where they have no column [px at 100 %]."""
_PLACES: Final = "###places"
_COUNT: Final = 116.0
"""Room for the number of levels, so that nothing moves as it changes [px at 100 %]."""


def draw_head(session: "Session", cards: Sequence[Card], *, places: bool) -> None:
    """Title, search, order, number of levels; filters below.

    Args:
        session: The session.
        cards: The levels that are shown.
        places: Whether the folders are on the screen: else the chosen one is named here.
    """
    gallery, wish = session.gallery, session.gallery.wish
    with widgets.font(FONTS.bold, 18):
        imgui.align_text_to_frame_padding()
        widgets.text(f"{Icons.gallery}  Gallery")
    imgui.same_line(0, px(18))
    close, free = px(34), imgui.get_content_region_avail().x
    beside = imgui.get_cursor_pos()
    imgui.set_cursor_pos_x(imgui.get_window_width() - close - px(10))
    if widgets.icon_button(session, "gallery.close", Icons.close):
        session.queue("gallery.close")
    widgets.tooltip("Back to the level", keys="Esc")
    order = px(150) if free > px(420) else px(112)
    if free < px(_LEAST) + order + close:  # The search and the order have a line of their own.
        free = imgui.get_content_region_avail().x
    else:
        imgui.set_cursor_pos(beside)
    room = free - close - order - px(60 + _COUNT)
    searched = bool(wish.words)
    cross = widgets.icon_width(Icons.close) + px(2) if searched else 0.0
    imgui.set_next_item_width(max(min(room, px(420)), px(80)) - cross)
    _search(gallery, cards)
    widgets.probe(session, "gallery.search")
    if searched and widgets.clear_button(session, "gallery.search"):
        gallery.wish = dataclasses.replace(gallery.wish, words="")
    imgui.same_line(0, px(8))
    imgui.set_next_item_width(order)
    picked = widgets.choice(
        session, "gallery.sort", wish.sort, [(sort, f"By {sort}") for sort in SORTS]
    )
    if picked is not None:
        sort: Sort = next(s for s in SORTS if s == picked)
        gallery.wish = dataclasses.replace(wish, sort=sort)
    imgui.same_line(0, px(2))
    if widgets.icon_button(
        session, "gallery.order", Icons.down if not wish.descending else Icons.up
    ):
        gallery.wish = dataclasses.replace(wish, descending=not wish.descending)
    widgets.tooltip("The other way round")
    _count(session, len(cards))
    _filters(session)
    if not places:
        _folder(session)
    imgui.dummy((0, px(2)))


def _search(gallery: GalleryView, cards: Sequence[Card]) -> None:
    """Draw the field; Enter and Down go from it to the cards."""
    if gallery.searching:
        imgui.set_keyboard_focus_here()
        gallery.searching = False
    hint = f"{Icons.search}  Name, tag or word of the description"
    changed, typed = widgets.input_line("gallery.search", hint, gallery.wish.words)
    if changed:
        gallery.wish = dataclasses.replace(gallery.wish, words=typed)
    if gallery.begun and imgui.is_item_active():
        imgui.get_io().add_input_characters_utf8(gallery.begun)
        gallery.begun = ""
    down = imgui.is_item_active() and imgui.is_key_pressed(imgui.Key.down_arrow)
    if down:
        imgui.internal.clear_active_id()
    enter = imgui.is_item_deactivated() and imgui.is_key_pressed(imgui.Key.enter)
    if down or enter:
        gallery.to_cards(cards)


def _count(session: "Session", count: int) -> None:
    """Draw the number of levels, and a warning sign where some were left out."""
    imgui.same_line(0, px(10))
    noun = "level" if count == 1 else "levels"
    words = f"{count} {noun}" if not session.library.busy else f"{count} {noun} …"
    imgui.align_text_to_frame_padding()
    widgets.muted(words)
    if session.library.passed_over:
        imgui.same_line(0, px(8))
        widgets.text(Icons.warning, COLOURS.warn)
        widgets.probe(session, "gallery.passed_over")
        widgets.tooltip(session.library.passed_over)


def _filters(session: "Session") -> None:
    gallery, wish = session.gallery, session.gallery.wish
    imgui.align_text_to_frame_padding()
    widgets.small("Size")
    for size in SIZE_ORDER:
        imgui.same_line(0, px(6))
        on = size in wish.sizes
        name = f"gallery.size.{size}"
        if widgets.icon_button(session, name, tr(SIZE_LABELS[size]), on=on):
            sizes = wish.sizes ^ {size}
            gallery.wish = dataclasses.replace(wish, sizes=sizes)
    for field, label in (
        ("thruster", "thruster"),
        ("problems", "problems"),
        ("solution", "solution"),
    ):
        widgets.beside(_SWITCH, gap=10)
        _switch(session, field, label)
    players = session.results.players
    if players:
        widgets.beside(_WINNERS, gap=10)
        _winners(session, players)
    if wish.filters:
        widgets.beside(_CLEAR, gap=10)
        if widgets.icon_button(session, "gallery.clear", Icons.close, label="No filters"):
            gallery.wish = dataclasses.replace(
                type(wish)(), words=wish.words, sort=wish.sort, descending=wish.descending
            )


def _folder(session: "Session") -> None:
    """A list for what has no column here; the folder that is shown alone: a click shows all."""
    widgets.beside(_CLEAR, gap=10)
    if widgets.icon_button(session, "gallery.places", Icons.folder, label="Folders"):
        imgui.open_popup(_PLACES)
    widgets.tooltip("Folders, level sets and tags")
    tallest = imgui.get_main_viewport().work_size.y - imgui.get_cursor_screen_pos().y - px(20)
    imgui.set_next_window_size_constraints((px(_LIST), 0), (px(_LIST), max(tallest, px(120))))
    if imgui.begin_popup(_PLACES):
        draw_places(session)
        imgui.end_popup()
    folder = session.gallery.folder
    if folder is None:
        return
    widgets.beside(_CLEAR, gap=10)
    label = widgets.fitted(folder.name, px(_CLEAR))
    if widgets.icon_button(session, "gallery.all_folders", Icons.close, label=label):
        session.gallery.folder = None
    widgets.tooltip("All levels", str(folder))


def _switch(session: "Session", field: str, label: str) -> None:
    """A three-way choice: with, without, either."""
    gallery = session.gallery
    options = [("any", f"Any {label}"), ("with", f"With {label}"), ("without", f"No {label}")]
    if label.endswith("s"):
        options[0] = ("any", f"All {label}")
    value = getattr(gallery.wish, field)
    current = "any" if value is None else ("with" if value else "without")
    imgui.set_next_item_width(px(_SWITCH))
    picked = widgets.choice(session, f"gallery.{field}", current, options)
    if picked is not None:
        wanted = {"any": None, "with": True, "without": False}[picked]
        gallery.wish = dataclasses.replace(gallery.wish, **{field: wanted})


def _winners(session: "Session", players: Sequence[str]) -> None:
    """Solved, or not yet solved, by a player with recorded results."""
    gallery, wish = session.gallery, session.gallery.wish
    options = [("", "All results")]
    options += [(f"+{name}", f"Solved by {name}") for name in players]
    options += [(f"-{name}", f"Not solved by {name}") for name in players]
    current = f"+{wish.solved_by}" if wish.solved_by else ""
    current = f"-{wish.unsolved_by}" if wish.unsolved_by else current
    imgui.set_next_item_width(px(_WINNERS))
    picked = widgets.choice(session, "gallery.solved", current, options)
    if picked is not None:
        gallery.wish = dataclasses.replace(
            wish,
            solved_by=picked[1:] if picked.startswith("+") else "",
            unsolved_by=picked[1:] if picked.startswith("-") else "",
        )
