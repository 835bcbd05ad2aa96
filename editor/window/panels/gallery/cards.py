"""The middle of the gallery: a card for each level, drawn only where it is in sight."""

import functools
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.gallery.card import Card
from editor.gallery.results import HUMAN
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, SMALL, Icons, Rgba, alpha, u32
from editor.toolkit.textures import TextureStore
from editor.toolkit.thumbnails import Thumbs
from editor.toolkit.widgets import px
from editor.window.panels.gallery import dragging
from editor.window.panels.gallery.head import SIZE_LABELS
from editor.window.panels.menu import item
from kinetix.wording import plural

if TYPE_CHECKING:
    from editor.session import Session

_SIDE: Final = 148.0
"""Least width and height of a thumbnail [px at 100 %]; it grows until the row is full."""
_CAPTION: Final = 44.0
_PAD: Final = 7.0


class CardGrid:
    """Draws the cards and asks for the pictures that are missing."""

    def __init__(self, textures: TextureStore) -> None:
        self._thumbs = Thumbs(textures)
        self._chosen: frozenset[str] = frozenset()
        """Paths of the cards that are selected."""
        self.missing = False
        """True if a picture in sight was not there in the last frame."""

    def begin_frame(self) -> None:
        """Let the next few pictures be uploaded."""
        self._thumbs.begin_frame()
        self.missing = False

    def draw(self, session: "Session", cards: Sequence[Card]) -> None:
        """Draw the rows in sight, or say why there are none."""
        gallery = session.gallery
        if not cards:
            self._nothing(session)
            return
        self._chosen = frozenset(gallery.selection)
        gap = px(6)
        space = imgui.get_content_region_avail()
        columns = max(1, int((space.x + gap) / (px(_SIDE + 2 * _PAD) + gap)))
        width = min((space.x + gap) // columns - gap, px(1.5 * _SIDE))
        height = width + px(_CAPTION)
        rows = -(-len(cards) // columns)
        gallery.columns, gallery.rows = columns, max(1, int(space.y / (height + gap)))
        if gallery.scroll:
            gallery.scroll = False
            _scroll_to(_row_of(cards, gallery.focus, columns), height + gap, space.y)
        imgui.push_style_var(imgui.StyleVar_.item_spacing, imgui.ImVec2(gap, gap))
        clipper = imgui.ListClipper()
        clipper.begin(rows, height + gap)
        wanted = []
        while clipper.step():
            for row in range(clipper.display_start, clipper.display_end):
                for column, card in enumerate(cards[row * columns : (row + 1) * columns]):
                    if column:
                        imgui.same_line()
                    if not self._card(session, cards, card, (width, height)):
                        wanted.append(card)
        clipper.end()
        imgui.pop_style_var()
        self.missing = bool(wanted)
        session.library.want(wanted)

    def _nothing(self, session: "Session") -> None:
        if session.library.busy:
            widgets.empty_state(Icons.search, "Looking for levels", "")
        elif session.gallery.wish.words or session.gallery.wish.filters:
            widgets.empty_state(
                Icons.search,
                "No level is like that",
                "Take a word out of the search, or switch a filter off.",
            )
        else:
            widgets.empty_state(
                Icons.level,
                "No levels here",
                "Levels saved below this folder appear here by themselves.",
            )

    def _card(
        self, session: "Session", cards: Sequence[Card], card: Card, size: tuple[float, float]
    ) -> bool:
        """One card; returns whether its picture is there."""
        gallery = session.gallery
        at = imgui.get_cursor_screen_pos()
        pressed = imgui.invisible_button(f"card-{card.path}", size)
        widgets.probe(session, f"gallery.card.{card.file.stem}")
        hovered = imgui.is_item_hovered()
        chosen = card.path in self._chosen
        if pressed:
            io = imgui.get_io()
            gallery.click(cards, card.path, toggle=io.key_ctrl, extend=io.key_shift)
        if hovered and imgui.is_mouse_double_clicked(0):
            gallery.selection = (card.path,)
            session.queue("gallery.open")
        self._menu(session, card)
        dragging.take_up(session, card)
        draw = imgui.get_window_draw_list()
        low, high = (at.x, at.y), (at.x + size[0], at.y + size[1])
        if chosen or hovered:
            colour = alpha(COLOURS.accent, 0.26) if chosen else COLOURS.field
            draw.add_rect_filled(low, high, u32(colour), px(8))
        if chosen:
            draw.add_rect(low, high, u32(COLOURS.accent), px(8), px(1.5))
        side = size[0] - 2 * px(_PAD)
        corner = (at.x + px(_PAD), at.y + px(_PAD))
        shown = self._picture(session, card, corner, side)
        self._caption(session, card, (corner[0], corner[1] + side + px(5)), side)
        if card.fault and hovered:
            widgets.tooltip(card.name, tr(card.fault), own=True)
        return shown

    def _picture(
        self, session: "Session", card: Card, low: tuple[float, float], side: float
    ) -> bool:
        draw = imgui.get_window_draw_list()
        high = (low[0] + side, low[1] + side)
        if card.fault:
            draw.add_rect_filled(low, high, u32(COLOURS.field), px(4))
            with widgets.font(None, 30):
                size = imgui.calc_text_size(Icons.warning)
                middle = (low[0] + (side - size.x) / 2, low[1] + (side - size.y) / 2)
                draw.add_text(middle, u32(COLOURS.warn), Icons.warning)
            return True
        texture = self._thumbs.texture(session, card.sha256)
        if texture is None:
            draw.add_rect_filled(low, high, u32(COLOURS.field), px(4))
            return False
        white = (1.0, 1.0, 1.0, 1.0)
        draw.add_image_rounded(texture, low, high, (0, 0), (1, 1), u32(white), px(4))
        return True

    def _caption(
        self, session: "Session", card: Card, at: tuple[float, float], width: float
    ) -> None:
        draw = imgui.get_window_draw_list()
        draw.add_text(at, u32(COLOURS.text), _fitted(card.name, width, _text_size()))
        signs = _signs(session, card)
        with widgets.font(None, SMALL):
            top = at[1] + px(20)
            room = width
            for sign, colour in reversed(signs):
                room -= imgui.calc_text_size(sign).x
                draw.add_text((at[0] + room, top), u32(colour), sign)
                room -= px(6)
            words = _fitted(tr(_detail(card)), max(room, 1.0), _text_size())
            draw.add_text((at[0], top), u32(COLOURS.muted), words)

    def _menu(self, session: "Session", card: Card) -> None:
        if not imgui.begin_popup_context_item(f"menu-{card.path}"):
            return
        if card.path not in session.gallery.selection:
            session.gallery.selection = (card.path,)
            session.gallery.focus = card.path
        for action_id in ("open", "play_agent", "evaluate", "train"):
            item(session, f"gallery.{action_id}")
        imgui.separator()
        item(session, "gallery.add_to_set")
        imgui.separator()
        for action_id in ("rename", "duplicate", "move_to", "delete"):
            item(session, f"gallery.{action_id}")
        imgui.end_popup()


def _row_of(cards: Sequence[Card], path: str | None, columns: int) -> int:
    at = next((k for k, card in enumerate(cards) if card.path == path), 0)
    return at // columns


def _scroll_to(row: int, height: float, view: float) -> None:
    """Scroll just as far as is needed to see a row."""
    top, bottom = row * height, (row + 1) * height
    scroll = imgui.get_scroll_y()
    if top < scroll:
        imgui.set_scroll_y(top)
    elif bottom > scroll + view:
        imgui.set_scroll_y(bottom - view)


def _text_size() -> float:
    return imgui.get_font_size()


@functools.lru_cache(maxsize=8192)
def _fitted(words: str, room: float, size: float) -> str:
    """Return the words, cut off with an ellipsis where they are wider than the room [px]."""
    del size  # part of the key only: the width depends on it
    return widgets.fitted(words, room)


def _detail(card: Card) -> str:
    if card.fault:
        return "cannot be read"
    label = SIZE_LABELS[card.size_class] if card.size_class != "other" else card.size
    return f"{label}   {plural(card.bodies, 'shape')}"


def _signs(session: "Session", card: Card) -> list[tuple[str, Rgba]]:
    """Marks at the right of a card's second line."""
    signs: list[tuple[str, Rgba]] = []
    if card.path in session.gallery.tray:
        signs.append((Icons.reorder, COLOURS.accent))
    if card.errors or card.fault:
        signs.append((Icons.error, COLOURS.bad))
    elif card.warnings:
        signs.append((Icons.warning, COLOURS.warn))
    records = session.results.of(card.sha256)
    measured = [one.solve_rate for trial, one in records.items() if trial.player != HUMAN]
    if measured:
        # What the best agent makes of it: how hard the level is.
        best = max(measured)
        signs.append((f"{Icons.agent} {best:.0%}", COLOURS.good if best else COLOURS.warn))
    elif any(record.solved for record in records.values()):
        signs.append((Icons.trophy, COLOURS.good))
    elif card.solved:
        signs.append((Icons.good, COLOURS.faint))
    return signs
