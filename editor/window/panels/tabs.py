"""The open documents as tabs over the canvas, and what there is to say about the one in front."""

import contextlib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions.files import file
from editor.actions.files.tab_menu import open_tab_menu
from editor.base.language import tr
from editor.documents.document import Document
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, SMALL, Icons, alpha
from editor.toolkit.widgets import px
from editor.window.hints import key_of
from kinetix.wording import plural

if TYPE_CHECKING:
    from editor.session import Session, Tab


_MOMENT: Final = {
    "run.play_human": "Play On",
    "run.keep_moment": "Keep as Start",
    "run.drop_moment": "Discard",
}
"""Choices for a paused episode that is being changed."""


_MANY: Final = 6
"""Open levels that get a button which lists them."""


class DocumentTabs:
    """A tab bar; a click brings to the front, the cross closes (and asks first)."""

    def __init__(self) -> None:
        self._front: Tab | None = None
        """The tab in front in the last frame; another may have taken its place since."""
        self._name = ""
        """Its name in the last frame."""

    def draw(self, session: "Session") -> None:
        """Draw the bar at the top of the canvas's window."""
        imgui.push_style_var(imgui.StyleVar_.frame_padding, imgui.ImVec2(px(10), px(6)))
        imgui.dummy((0, 0))
        flags = (
            imgui.TabBarFlags_.fitting_policy_scroll.value
            | imgui.TabBarFlags_.no_close_with_middle_mouse_button.value
        )
        if len(session.tabs) >= _MANY:
            flags |= imgui.TabBarFlags_.tab_list_popup_button.value
        if imgui.begin_tab_bar("documents", flags):
            self._tabs(session)
            if imgui.tab_item_button(Icons.plus, imgui.TabItemFlags_.trailing.value):
                session.queue("file.new")
            widgets.probe(session, "tabs.new")
            widgets.tooltip("New level", keys="Ctrl+N")
            imgui.end_tab_bar()
        imgui.pop_style_var()
        self._moment(session)
        self._outside(session)
        self._warnings(session)

    def _tabs(self, session: "Session") -> None:
        brought = self._front is not session.tab
        front = session.tabs.index_in_front
        names = _told_apart([tab.document for tab in session.tabs])
        for index, (tab, name) in enumerate(zip(list(session.tabs), names, strict=True)):
            document = tab.document
            flags = imgui.TabItemFlags_.unsaved_document.value if document.dirty else 0
            if brought and index == session.tabs.index_in_front:
                flags |= imgui.TabItemFlags_.set_selected.value
            title, short = document.title, widgets.shortened(name)
            opened, kept = imgui.begin_tab_item(
                widgets.labelled(short, f"tab-{id(tab)}"), True, flags
            )
            widgets.probe(session, f"tabs.{index}")
            if document.path is not None or short != title:
                widgets.tooltip(title, str(document.path or ""), own=True)
            if imgui.is_item_clicked(imgui.MouseButton_.right.value):
                at = imgui.get_mouse_pos()
                session.queue(lambda tab=tab, at=(at.x, at.y): open_tab_menu(session, tab, at))
            if opened:
                if not brought:
                    front = index
                imgui.end_tab_item()
            if not kept:
                session.queue(lambda tab=tab: file.close_tab(session, tab))
        if not brought and self._name != session.document.title:
            _scroll_to_front()
        self._front, self._name = session.tab, session.document.title
        if front != session.tabs.index_in_front:
            session.queue(lambda: session.show_tab(front))

    def _warnings(self, session: "Session") -> None:
        """Draw the parts of the file that the document does not hold: once, until it is closed."""
        document = session.document
        if not document.warnings:
            return
        with _strip("warnings"):
            _words("  ".join(document.warnings), px(36))
            imgui.same_line(imgui.get_window_width() - px(36))
            if widgets.icon_button(session, "banner.close", Icons.close, height=px(20)):
                session.queue(lambda: setattr(document, "warnings", ()))

    def _moment(self, session: "Session") -> None:
        """Draw the notice that a paused episode is being changed, and its choices."""
        moment = session.tab.moment
        if moment is None or not session.editing:
            return
        with _strip("moment"):
            count = len(moment.document.history.entries) - 1
            changes = plural(count, "change") if moment.changed else "nothing changed yet"
            _words(f"The episode at {moment.begin}: {changes}.", px(12), icon=Icons.rename)
            for number, (name, label) in enumerate(_MOMENT.items()):
                if number:
                    widgets.beside(imgui.calc_text_size(tr(label)).x / px(1) + 24, gap=8)
                action = actions.BY_ID[name]
                if widgets.button(session, f"moment.{name}", label):
                    session.queue(name)
                widgets.tooltip(
                    action.label if number else label,
                    action.tooltip if number else "",
                    key_of(session, name),
                )

    def _outside(self, session: "Session") -> None:
        """Draw the notice that another program has changed the file, and its choices."""
        if not (session.editing and session.document.outside):
            return
        with _strip("outside"):
            _words(session.document.outside, px(12))
            for number, name in enumerate(("file.reload", "file.keep_mine", "file.differences")):
                if number:
                    imgui.same_line(0, px(8))
                action = actions.BY_ID[name]
                with widgets.disabled(not actions.available(session, action)):
                    if widgets.button(session, f"outside.{name}", action.label):
                        session.queue(name)
                widgets.tooltip(action.label, action.tooltip)


def _told_apart(documents: Sequence[Document]) -> list[str]:
    """Return what tabs are called: equal titles with the folder of their file, or a number."""
    titles = [document.title for document in documents]
    names = []
    for index, document in enumerate(documents):
        name, number = titles[index], titles[: index + 1].count(titles[index])
        if document.path is not None and titles.count(name) > 1:
            name = f"{name} · {document.path.parent.name}"
        elif document.path is None and number > 1:
            name = f"{name} {number}"
        names.append(name)
    return names


def _scroll_to_front() -> None:
    """Bring the tab in front of the current bar into sight again: a longer name may leave it."""
    bar = imgui.internal.get_current_tab_bar()
    if bar is not None and not bar.next_selected_tab_id:
        bar.next_selected_tab_id = bar.selected_tab_id


@contextlib.contextmanager
def _strip(name: str) -> Iterator[None]:
    """A coloured strip over the level, as high as what is in it."""
    imgui.push_style_color(imgui.Col_.child_bg, imgui.ImVec4(*alpha(COLOURS.warn, 0.14)))
    imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(12), px(6)))
    imgui.push_style_var(imgui.StyleVar_.item_spacing, imgui.ImVec2(px(8), px(6)))
    flags = (
        imgui.ChildFlags_.auto_resize_y.value | imgui.ChildFlags_.always_use_window_padding.value
    )
    imgui.begin_child(f"banner-{name}", (0, 0), flags)
    try:
        yield
    finally:
        imgui.end_child()
        imgui.pop_style_var(2)
        imgui.pop_style_color()


def _words(words: str, room: float, *, icon: str = Icons.warning) -> None:
    """Write a sentence in small letters that leaves some room at the right [px]."""
    with widgets.font(None, SMALL):
        widgets.text(icon, COLOURS.warn)
        imgui.same_line(0, px(8))
        width = imgui.get_content_region_avail().x - room
        imgui.push_text_wrap_pos(imgui.get_cursor_pos_x() + width)
        widgets.text(words)
        imgui.pop_text_wrap_pos()
