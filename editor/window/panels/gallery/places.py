"""The left of the gallery: folders, level sets, tags."""

import collections
import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions.gallery import gallery as doing
from editor.actions.gallery import gallery_files, level_sets
from editor.actions.training import train
from editor.base.language import tr
from editor.gallery.card import Card
from editor.gallery.named_levels import set_name
from editor.gallery.search import SIZE_ORDER, tag_counts
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons, u32
from editor.toolkit.widgets import px
from editor.window.panels.gallery.dragging import let_go_here
from kinetix.paths import levels_dir, user_levels_dir

if TYPE_CHECKING:
    from editor.session import Session

_TAGS: Final = 24
_WITH_LEVELS: Final = (
    ("Choose All Its Levels", ""),
    ("Put Its Levels into the Set", "gallery.add_to_set"),
    ("Evaluate", "gallery.evaluate"),
    ("Train on Them", "gallery.train"),
)
"""Entries of a folder's menu, with actions that work once all its levels are chosen."""


def draw_places(session: "Session") -> None:
    """Folders, sets and tags at the left."""
    gallery, cards = session.gallery, session.library.cards
    _heading("Folders")
    _place(session, None, "All levels", len(cards))
    counts = _folder_counts(cards)
    for folder in doing.folders(session):
        own = {levels_dir(): "That came with the app", user_levels_dir(): "My levels"}
        label = own.get(folder, folder.name)
        _place(session, folder, label, counts.get(str(folder), 0))
        for inner in _inner(folder, counts):
            _place(session, inner, inner.name, counts[str(inner)], indent=1)
    for folder in doing.unreachable(session):
        _place(session, folder, folder.name, None)
    imgui.dummy((0, px(2)))
    if widgets.icon_button(session, "gallery.add_folder", Icons.plus, label="Add a folder…"):
        session.queue("gallery.add_folder")
    if session.library.sets:
        imgui.dummy((0, px(8)))
        _heading("Level sets")
        for path in session.library.sets:
            name = set_name(path)
            label = widgets.labelled(f"{Icons.level}  {name}", f"set-{path}")
            if imgui.selectable(label, False)[0]:
                session.queue(lambda path=path: level_sets.load_into_set(session, path))
            widgets.probe(session, f"gallery.set.{name}")
            if imgui.begin_popup_context_item(f"set-menu-{path}"):
                _set_menu(session, path)
                imgui.end_popup()
            detail = tr(f"{path}. A click puts its levels into the set.")
            widgets.tooltip(path.name, detail, own=True)
    tags = tag_counts([c for c in cards if gallery.folder is None or _below(c, gallery.folder)])
    if tags:
        imgui.dummy((0, px(8)))
        _heading("Tags")
        _tags(session, tags[:_TAGS])


def listed(session: "Session", folder: Path) -> bool:
    """Return whether a folder has a line: one that is chosen has none once it is gone."""
    roots = [*doing.folders(session), *doing.unreachable(session)]
    if folder in roots:
        return True
    return folder.parent in roots and str(folder) in _folder_counts(session.library.cards)


def _place(
    session: "Session", folder: Path | None, label: str, count: int | None, *, indent: int = 0
) -> None:
    """Draw the line of a folder.

    Args:
        session: The session.
        folder: What a click shows alone; None: everything.
        label: Its name.
        count: Levels in it; None: it cannot be looked into now.
        indent: Levels of folders above it.
    """
    gallery = session.gallery
    start, width = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x
    height = imgui.get_text_line_height() + px(9)
    chosen = gallery.folder == folder
    # A folder that was added may stand below another one as well.
    place = f"{indent}-{folder}"
    if imgui.selectable(f"###place-{place}", chosen, 0, (0, height))[0]:
        gallery.folder = folder
    widgets.probe(session, f"gallery.folder.{folder.name if folder else 'all'}")
    if folder is not None:
        if count is not None and let_go_here():
            copies = imgui.get_io().key_ctrl
            session.queue(lambda: gallery_files.put_into(session, folder, copies=copies))
        gone = "" if count is not None else f"\n{tr('It cannot be reached now.')}"
        widgets.tooltip(label, f"{folder}{gone}")
        if imgui.begin_popup_context_item(f"place-menu-{place}"):
            _folder_menu(session, folder, levels=bool(count))
            imgui.end_popup()
    draw = imgui.get_window_draw_list()
    top = start.y + px(4)
    left = start.x + px(8 + 16 * indent)
    icon = Icons.folder if folder is not None else Icons.gallery
    draw.add_text((left, top), u32(COLOURS.info if folder else COLOURS.muted), icon)
    draw.add_text(
        (left + px(24), top), u32(COLOURS.faint if count is None else COLOURS.text), tr(label)
    )
    words = "–" if count is None else str(count)
    right = start.x + width - px(8) - imgui.calc_text_size(words).x
    draw.add_text((right, top), u32(COLOURS.faint), words)


def _folder_menu(session: "Session", folder: Path, *, levels: bool) -> None:
    """Draw the menu of a folder, with entries for its levels if it has some."""
    for label, action_id in _WITH_LEVELS:
        if imgui.menu_item_simple(tr(label), enabled=levels):
            session.queue(lambda: doing.choose_folder(session, folder))
            if action_id:
                session.queue(action_id)
        widgets.probe(session, f"gallery.place.{action_id}")
    if str(folder) in session.settings.gallery_folders:
        imgui.separator()
        if imgui.menu_item_simple(tr("Show It No More")):
            session.queue(lambda: doing.remove_folder(session, folder))


def _set_menu(session: "Session", path: Path) -> None:
    """Draw the menu of a level set."""
    if imgui.menu_item_simple(tr("Put Its Levels into the Set")):
        session.queue(lambda: level_sets.load_into_set(session, path))
    if imgui.menu_item_simple(tr("Evaluate")):
        session.queue(lambda: doing.evaluate_set(session, path))
    if imgui.menu_item_simple(tr("Train on Them")):
        session.queue(lambda: train.train_on_set(session, path))


def _tags(session: "Session", tags: Sequence[tuple[str, int]]) -> None:
    gallery, wish = session.gallery, session.gallery.wish
    edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    for number, (tag, count) in enumerate(tags):
        words = f"{tag} {count}"
        width = imgui.calc_text_size(words).x + 2 * px(8)
        if number:
            after = imgui.get_item_rect_max().x + px(5)
            if after + width < edge:
                imgui.same_line(0, px(5))
        if widgets.icon_button(
            session, f"gallery.tag.{tag}", words, on=tag in wish.tags, height=px(24)
        ):
            gallery.wish = dataclasses.replace(wish, tags=wish.tags ^ {tag})


def _heading(words: str) -> None:
    with widgets.font(FONTS.bold, SMALL):
        widgets.raw(tr(words).upper(), COLOURS.muted)


def _below(card: Card, folder: Path) -> bool:
    return card.file.is_relative_to(folder)


class _Counted:
    """The list of cards that was counted last, and the levels below each folder."""

    cards: tuple[Card, ...] = ()
    found: Mapping[str, int] = MappingProxyType({})


def _folder_counts(cards: tuple[Card, ...]) -> Mapping[str, int]:
    """Count the levels below each folder; once for each list of cards."""
    if _Counted.cards is not cards:
        _Counted.cards = cards
        parents = (str(parent) for card in cards for parent in card.file.parents)
        _Counted.found = collections.Counter(parents)
    return _Counted.found


def _inner(folder: Path, counts: Mapping[str, int]) -> list[Path]:
    """Return the folders right below one that hold levels, small sizes first."""
    inner = [path for name in counts if (path := Path(name)).parent == folder]
    order = {name: number for number, name in enumerate(SIZE_ORDER)}
    return sorted(inner, key=lambda path: (order.get(path.name, len(order)), path.name))
