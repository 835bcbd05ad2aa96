"""The gallery: all levels as pictures, over the whole window; search, filters, sets."""

import dataclasses
import datetime
import functools
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions, widgets
from editor.actions import gallery as doing
from editor.browser import peek, thumbnail
from editor.gallery.card import Card
from editor.gallery.filing import bundled
from editor.gallery.search import SIZE_ORDER, SORTS, Sort, tag_counts
from editor.keys import label as chord_label
from editor.look import COLOURS, FONTS, SMALL, Icons, Rgba, alpha, u32
from editor.panels.gallery_set import SetTray
from editor.panels.menu import item
from editor.textures import TextureStore
from editor.thumbs import Thumbs
from editor.widgets import px
from kinetix.paths import levels_dir, user_levels_dir

if TYPE_CHECKING:
    from editor.session import Session

_SIDE: Final = 148.0
"""Width and height of a thumbnail [px at 100 %]."""
_CAPTION: Final = 44.0
_PAD: Final = 7.0
_LEFT: Final = 214.0
_RIGHT: Final = 300.0
_LOOK_SECONDS: Final = 5.0
"""How often the folders are looked through while the gallery is open."""
_TAGS: Final = 24
_SIZE_LABELS: Final = {
    "s": "S",
    "m": "M",
    "l": "L",
    "locomotion": "Locomotion",
    "other": "Other",
}
_FLAGS: Final = (
    imgui.WindowFlags_.no_decoration.value
    | imgui.WindowFlags_.no_move.value
    | imgui.WindowFlags_.no_docking.value
    | imgui.WindowFlags_.no_saved_settings.value
)
_PAYLOAD: Final = "level"


class GalleryPage:
    """Fills the window's middle while `session.gallery.open`."""

    def __init__(self, textures: TextureStore) -> None:
        self._thumbs = Thumbs(textures)
        self._tray = SetTray()
        self._looked = -_LOOK_SECONDS
        self._was_open = False
        self._missing = False
        self._revision = -1

    def animating(self, session: "Session") -> bool:
        """Whether the next frame differs: levels are looked for, or pictures are on their way."""
        library = session.library
        return library.busy or self._missing or self._revision != library.revision

    def draw(self, session: "Session") -> None:
        """Draw it over everything between the bars."""
        appearing = not self._was_open
        self._was_open = True
        self._thumbs.begin_frame()
        if session.time - self._looked > _LOOK_SECONDS:
            self._looked = session.time
            doing.look(session)
        viewport = imgui.get_main_viewport()
        imgui.set_next_window_pos(viewport.work_pos)
        imgui.set_next_window_size(viewport.work_size)
        imgui.push_style_color(imgui.Col_.window_bg, imgui.ImVec4(*COLOURS.surface))
        imgui.push_style_var(imgui.StyleVar_.window_rounding, 0.0)
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(16), px(12)))
        opened = imgui.begin("###gallery", None, _FLAGS)[0]
        imgui.pop_style_var(2)
        imgui.pop_style_color()
        if opened:
            if appearing and not session.prompts:
                imgui.set_window_focus()
            with session.guard():
                self._page(session)
        imgui.end()

    def closed(self) -> None:
        """Note that the gallery is not on the screen."""
        self._was_open = False

    def _page(self, session: "Session") -> None:
        gallery = session.gallery
        self._revision, self._missing = session.library.revision, False
        cards = gallery.shown(session.library, session.results)
        self._head(session, len(cards))
        space = imgui.get_content_region_avail()
        gap = imgui.get_style().item_spacing.x
        left = px(_LEFT) if space.x > px(760) else 0.0
        right = px(_RIGHT) if space.x > px(980) or gallery.tray else 0.0
        if left:
            imgui.begin_child("places", (left, space.y))
            self._places(session)
            imgui.end_child()
            imgui.same_line()
        middle = max(space.x - left - right - gap * ((left > 0) + (right > 0)), px(180))
        imgui.begin_child("cards", (middle, space.y))
        self._grid(session, cards)
        imgui.end_child()
        if right:
            imgui.same_line()
            imgui.begin_child("side", (right, space.y))
            self._side(session)
            imgui.end_child()
        self._tray.dialog(session)

    def _head(self, session: "Session", count: int) -> None:
        """Title, search, filters and order."""
        gallery, wish = session.gallery, session.gallery.wish
        with widgets.font(FONTS.bold, 18):
            imgui.align_text_to_frame_padding()
            widgets.text(f"{Icons.gallery}  Gallery")
        imgui.same_line(0, px(14))
        noun = "level" if count == 1 else "levels"
        words = f"{count} {noun}" if not session.library.busy else f"{count} {noun} …"
        imgui.align_text_to_frame_padding()
        widgets.muted(words)
        imgui.same_line(0, px(18))
        close = px(34)
        order = px(150)
        room = imgui.get_content_region_avail().x - close - order - px(40)
        imgui.set_next_item_width(max(min(room, px(420)), px(120)))
        hint = f"{Icons.search}  Name, tag or word of the description"
        changed, typed = imgui.input_text_with_hint("###gallery.search", hint, wish.words)
        widgets.probe(session, "gallery.search")
        if changed:
            gallery.wish = dataclasses.replace(wish, words=typed)
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
        imgui.same_line(imgui.get_window_width() - close - px(10))
        if widgets.icon_button(session, "gallery.close", Icons.close):
            session.queue("gallery.close")
        widgets.tooltip("Back to the level", keys="Esc")
        self._filters(session)
        imgui.dummy((0, px(2)))

    def _filters(self, session: "Session") -> None:
        gallery, wish = session.gallery, session.gallery.wish
        imgui.align_text_to_frame_padding()
        widgets.small("Size")
        for size in SIZE_ORDER:
            imgui.same_line(0, px(6))
            on = size in wish.sizes
            name = f"gallery.size.{size}"
            if widgets.icon_button(session, name, _SIZE_LABELS[size], on=on):
                sizes = wish.sizes ^ {size}
                gallery.wish = dataclasses.replace(wish, sizes=sizes)
        for field, label in (
            ("thruster", "thruster"),
            ("problems", "problems"),
            ("solution", "solution"),
        ):
            imgui.same_line(0, px(10))
            self._switch(session, field, label)
        players = session.results.players
        if players:
            imgui.same_line(0, px(10))
            self._winners(session, players)
        if wish.filters:
            imgui.same_line(0, px(10))
            if widgets.icon_button(session, "gallery.clear", Icons.close, label="No filters"):
                gallery.wish = dataclasses.replace(
                    type(wish)(), words=wish.words, sort=wish.sort, descending=wish.descending
                )

    def _switch(self, session: "Session", field: str, label: str) -> None:
        """A three-way choice: with, without, either."""
        gallery = session.gallery
        options = [("any", f"Any {label}"), ("with", f"With {label}"), ("without", f"No {label}")]
        if label.endswith("s"):
            options[0] = ("any", f"All {label}")
        value = getattr(gallery.wish, field)
        current = "any" if value is None else ("with" if value else "without")
        imgui.set_next_item_width(px(136))
        picked = widgets.choice(session, f"gallery.{field}", current, options)
        if picked is not None:
            wanted = {"any": None, "with": True, "without": False}[picked]
            gallery.wish = dataclasses.replace(gallery.wish, **{field: wanted})

    def _winners(self, session: "Session", players: Sequence[str]) -> None:
        """Solved, or not yet solved, by a player with recorded results."""
        gallery, wish = session.gallery, session.gallery.wish
        options = [("", "Solved by anybody or nobody")]
        options += [(f"+{name}", f"Solved by {name}") for name in players]
        options += [(f"-{name}", f"Not solved by {name}") for name in players]
        current = f"+{wish.solved_by}" if wish.solved_by else ""
        current = f"-{wish.unsolved_by}" if wish.unsolved_by else current
        imgui.set_next_item_width(px(190))
        picked = widgets.choice(session, "gallery.solved", current, options)
        if picked is not None:
            gallery.wish = dataclasses.replace(
                wish,
                solved_by=picked[1:] if picked.startswith("+") else "",
                unsolved_by=picked[1:] if picked.startswith("-") else "",
            )

    def _places(self, session: "Session") -> None:
        """Folders, sets and tags at the left."""
        gallery, cards = session.gallery, session.library.cards
        _heading("Folders")
        self._place(session, None, "All levels", len(cards))
        counts = _folder_counts(cards)
        for folder in doing.folders(session):
            own = {levels_dir(): "That came with the app", user_levels_dir(): "My levels"}
            label = own.get(folder, folder.name)
            self._place(session, folder, label, counts.get(str(folder), 0))
            for inner in _inner(folder, counts):
                self._place(session, inner, inner.name, counts[str(inner)], indent=1)
        imgui.dummy((0, px(2)))
        if widgets.icon_button(session, "gallery.add_folder", Icons.plus, label="Add a folder…"):
            session.queue("gallery.add_folder")
        if session.library.sets:
            imgui.dummy((0, px(8)))
            _heading("Level sets")
            for path in session.library.sets:
                if imgui.selectable(f"{Icons.level}  {path.stem}###set-{path}", False)[0]:
                    session.queue(lambda path=path: doing.load_into_set(session, path))
                widgets.tooltip(path.name, f"{path}. A click puts its levels into the set.")
        tags = tag_counts([c for c in cards if gallery.folder is None or _below(c, gallery.folder)])
        if tags:
            imgui.dummy((0, px(8)))
            _heading("Tags")
            self._tags(session, tags[:_TAGS])

    def _place(
        self, session: "Session", folder: Path | None, label: str, count: int, *, indent: int = 0
    ) -> None:
        gallery = session.gallery
        start, width = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x
        height = imgui.get_text_line_height() + px(9)
        chosen = gallery.folder == folder
        if imgui.selectable(f"###place-{folder}", chosen, 0, (0, height))[0]:
            gallery.folder = folder
        widgets.probe(session, f"gallery.folder.{folder.name if folder else 'all'}")
        if folder is not None:
            widgets.tooltip(label, str(folder))
            added = str(folder) in session.settings.gallery_folders
            if added and imgui.begin_popup_context_item(f"place-menu-{folder}"):
                if imgui.menu_item_simple("Show it no more"):
                    session.queue(lambda: doing.remove_folder(session, folder))
                imgui.end_popup()
        draw = imgui.get_window_draw_list()
        top = start.y + px(4)
        left = start.x + px(8 + 16 * indent)
        icon = Icons.folder if folder is not None else Icons.gallery
        draw.add_text((left, top), u32(COLOURS.info if folder else COLOURS.muted), icon)
        draw.add_text((left + px(24), top), u32(COLOURS.text), label)
        words = str(count)
        right = start.x + width - px(8) - imgui.calc_text_size(words).x
        draw.add_text((right, top), u32(COLOURS.faint), words)

    def _tags(self, session: "Session", tags: Sequence[tuple[str, int]]) -> None:
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

    def _grid(self, session: "Session", cards: Sequence[Card]) -> None:
        gallery = session.gallery
        if not cards:
            self._nothing(session)
            return
        width, height = px(_SIDE + 2 * _PAD), px(_SIDE + _CAPTION + 2 * _PAD)
        gap = px(6)
        space = imgui.get_content_region_avail()
        columns = max(1, int((space.x + gap) / (width + gap)))
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
        self._missing = bool(wanted)
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
        chosen = card.path in gallery.selection
        if pressed:
            io = imgui.get_io()
            gallery.click(cards, card.path, toggle=io.key_ctrl, extend=io.key_shift)
        if hovered and imgui.is_mouse_double_clicked(0):
            gallery.selection = (card.path,)
            session.queue("gallery.open")
        self._menu(session, card)
        self._drag(session, card)
        draw = imgui.get_window_draw_list()
        low, high = (at.x, at.y), (at.x + size[0], at.y + size[1])
        if chosen or hovered:
            colour = alpha(COLOURS.accent, 0.26) if chosen else COLOURS.field
            draw.add_rect_filled(low, high, u32(colour), px(8))
        if chosen:
            draw.add_rect(low, high, u32(COLOURS.accent), px(8), px(1.5))
        side = px(_SIDE)
        corner = (at.x + px(_PAD), at.y + px(_PAD))
        shown = self._picture(session, card, corner, side)
        self._caption(session, card, (corner[0], corner[1] + side + px(5)), side)
        if card.fault and hovered:
            widgets.tooltip(card.name, card.fault)
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
            words = _fitted(_detail(card), max(room, 1.0), _text_size())
            draw.add_text((at[0], top), u32(COLOURS.muted), words)

    def _menu(self, session: "Session", card: Card) -> None:
        if not imgui.begin_popup_context_item(f"menu-{card.path}"):
            return
        if card.path not in session.gallery.selection:
            session.gallery.selection = (card.path,)
            session.gallery.focus = card.path
        for action_id in ("gallery.open", "gallery.add_to_set"):
            item(session, action_id)
        imgui.separator()
        for action_id in ("gallery.rename", "gallery.duplicate", "gallery.delete"):
            item(session, action_id)
        imgui.end_popup()

    def _drag(self, session: "Session", card: Card) -> None:
        """Let the card, or all that are chosen with it, be dragged into the set."""
        if not imgui.begin_drag_drop_source():
            return
        gallery = session.gallery
        if card.path not in gallery.selection:
            gallery.selection = (card.path,)
            gallery.focus = card.path
        imgui.set_drag_drop_payload_py_id(_PAYLOAD, 1)
        count = len(gallery.selection)
        widgets.text(card.name if count == 1 else f"{count} levels")
        imgui.end_drag_drop_source()

    def _side(self, session: "Session") -> None:
        """What is chosen, and the set being put together."""
        with widgets.coloured(tab=COLOURS.surface, tab_selected=COLOURS.field):
            self._tabs(session)
        if imgui.get_drag_drop_payload_py_id() is not None:
            self._whole_side_takes(session)

    def _tabs(self, session: "Session") -> None:
        gallery = session.gallery
        if imgui.begin_tab_bar("side"):
            opened = imgui.begin_tab_item(f"{Icons.info}  Level###level")[0]
            widgets.probe(session, "gallery.tab.level")
            if opened:
                self._details(session)
                imgui.end_tab_item()
            count = f" ({len(gallery.tray)})" if gallery.tray else ""
            opened = imgui.begin_tab_item(f"{Icons.reorder}  Set{count}###set")[0]
            widgets.probe(session, "gallery.tab.set")
            if imgui.begin_drag_drop_target():
                self._drop(session)
                imgui.end_drag_drop_target()
            if opened:
                self._tray.draw(session)
                imgui.end_tab_item()
            imgui.end_tab_bar()

    def _whole_side_takes(self, session: "Session") -> None:
        """While a card is dragged the whole side is where it can be dropped."""
        low = imgui.get_window_pos()
        size = imgui.get_window_size()
        rect = imgui.internal.ImRect((low.x, low.y), (low.x + size.x, low.y + size.y))
        if imgui.internal.begin_drag_drop_target_custom(rect, imgui.get_id("side-target")):
            self._drop(session)
            imgui.end_drag_drop_target()

    def _drop(self, session: "Session") -> None:
        if imgui.accept_drag_drop_payload_py_id(_PAYLOAD) is not None:
            session.queue(lambda: doing.put_in_set(session, list(session.gallery.selection)))

    def _details(self, session: "Session") -> None:
        chosen = session.gallery.chosen(session.library)
        if not chosen:
            widgets.empty_state(
                Icons.level,
                "Choose a level",
                "A double click opens it. Ctrl and Shift choose several; drag them onto Set.",
            )
            return
        if len(chosen) > 1:
            with widgets.font(FONTS.bold, 17):
                widgets.text(f"{len(chosen)} levels")
        else:
            self._one(session, chosen[0])
        imgui.dummy((0, px(6)))
        buttons = (
            ("gallery.open", "Open", Icons.open),
            ("gallery.add_to_set", "Add to the set", Icons.reorder),
            ("gallery.rename", "Rename…", Icons.rename),
            ("gallery.duplicate", "Duplicate", Icons.duplicate),
            ("gallery.delete", "Delete", Icons.trash),
        )
        for number, (action_id, label, icon) in enumerate(buttons):
            enabled = actions.available(session, actions.BY_ID[action_id])
            if action_id in ("gallery.rename", "gallery.delete"):
                enabled = enabled and not any(bundled(card.file) for card in chosen)
            if number % 2:
                imgui.same_line(0, px(6))
            if widgets.icon_button(session, action_id, icon, label=label, enabled=enabled):
                session.queue(action_id)
            action = actions.BY_ID[action_id]
            widgets.tooltip(action.label, action.tooltip, _keys(session, action_id))

    def _one(self, session: "Session", card: Card) -> None:
        side = min(imgui.get_content_region_avail().x, px(280))
        level = peek(str(card.file.resolve()), card.modified_ns)
        if not isinstance(level, str):
            thumbnail(level, side)
        with widgets.font(FONTS.bold, 17):
            widgets.wrapped(card.name)
        if card.fault:
            widgets.small(card.fault, COLOURS.bad)
            return
        widgets.small(_summary(card))
        if card.description:
            widgets.wrapped(card.description)
        if card.tags:
            widgets.small("  ".join(f"#{tag}" for tag in card.tags), COLOURS.info)
        if card.errors or card.warnings:
            kinds = ((card.errors, "error"), (card.warnings, "warning"))
            parts = [_count(number, noun) for number, noun in kinds if number]
            colour = COLOURS.bad if card.errors else COLOURS.warn
            widgets.small(f"{Icons.warning}  {', '.join(parts)}", colour)
        for player, record in sorted(session.results.of(card.sha256).items()):
            words = f"{player}: won {record.solved} of {record.attempts}"
            widgets.small(words, COLOURS.good if record.solved else COLOURS.muted)
        when = datetime.datetime.fromtimestamp(card.modified_ns / 1e9)
        widgets.small(f"{card.file.name}   {when:%Y-%m-%d %H:%M}", COLOURS.faint)
        widgets.tooltip(card.file.name, card.path)


def _heading(words: str) -> None:
    with widgets.font(FONTS.bold, SMALL):
        widgets.text(words.upper(), COLOURS.muted)


def _below(card: Card, folder: Path) -> bool:
    return card.file.is_relative_to(folder)


_COUNTS: Final[dict[int, dict[str, int]]] = {}


def _folder_counts(cards: tuple[Card, ...]) -> dict[str, int]:
    """How many levels lie below each folder; worked out once for each list of cards."""
    found = _COUNTS.get(id(cards))
    if found is None:
        found = {}
        for card in cards:
            for parent in card.file.parents:
                found[str(parent)] = found.get(str(parent), 0) + 1
        _COUNTS.clear()
        _COUNTS[id(cards)] = found
    return found


def _inner(folder: Path, counts: dict[str, int]) -> list[Path]:
    """The folders right below one that hold levels, small sizes first."""
    inner = [path for name in counts if (path := Path(name)).parent == folder]
    order = {name: number for number, name in enumerate(SIZE_ORDER)}
    return sorted(inner, key=lambda path: (order.get(path.name, len(order)), path.name))


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
    """The words, cut off with an ellipsis where they are wider than the room [px]."""
    del size  # part of the key only: the width depends on it
    if imgui.calc_text_size(words).x <= room:
        return words
    while words and imgui.calc_text_size(words + "…").x > room:
        words = words[:-1]
    return words.rstrip() + "…"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _detail(card: Card) -> str:
    if card.fault:
        return "cannot be read"
    label = _SIZE_LABELS[card.size_class] if card.size_class != "other" else card.size
    return f"{label}   {_count(card.bodies, 'shape')}"


def _summary(card: Card) -> str:
    """Size and content in one line."""
    if card.fault:
        return card.fault
    parts = [
        _count(number, noun)
        for number, noun in (
            (card.bodies, "shape"),
            (card.joints, "joint"),
            (card.thrusters, "thruster"),
        )
        if number
    ]
    return f"Size {card.size}: {', '.join(parts) or 'empty'}"


def _signs(session: "Session", card: Card) -> list[tuple[str, Rgba]]:
    """Marks at the right of a card's second line."""
    signs: list[tuple[str, Rgba]] = []
    if card.path in session.gallery.tray:
        signs.append((Icons.reorder, COLOURS.accent))
    if card.errors or card.fault:
        signs.append((Icons.error, COLOURS.bad))
    elif card.warnings:
        signs.append((Icons.warning, COLOURS.warn))
    if any(record.solved for record in session.results.of(card.sha256).values()):
        signs.append((Icons.trophy, COLOURS.good))
    elif card.solved:
        signs.append((Icons.good, COLOURS.faint))
    return signs


def _keys(session: "Session", action_id: str) -> str:
    chords = actions.chords(session, actions.BY_ID[action_id])
    return chord_label(chords[0]) if chords else ""
