"""Questions to the user: Save / Don't Save / Cancel, pop-up lists, the file browser."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.base.prompts import (
    FileQuestion,
    MenuQuestion,
    Prompt,
    Question,
    TextQuestion,
)
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS
from editor.toolkit.widgets import px
from editor.window.browser import FileBrowser, thumbnail
from editor.window.choice_list import ChoiceList

if TYPE_CHECKING:
    from editor.session import Session

_FLAGS: Final = (
    imgui.WindowFlags_.no_saved_settings.value
    | imgui.WindowFlags_.no_move.value
    | imgui.WindowFlags_.no_title_bar.value
    | imgui.WindowFlags_.no_docking.value
)
_PICTURE: Final = 205.0
"""Side of a level's picture in a question [px at 100 %]."""
_PADDING: Final = 20.0
"""Room beside the words of a question [px at 100 %]."""


def _width() -> float:
    """Return where the words of a question end at the latest [px from its left edge]."""
    return min(px(430), 0.96 * imgui.get_main_viewport().size.x - px(_PADDING))


class Dialogs:
    """Shows the uppermost of `session.prompts` and hands the answer back."""

    def __init__(self) -> None:
        self._browser: FileBrowser | None = None
        self._shown: object = None
        self._text = ""
        self._rows: ChoiceList | None = None

    def draw(self, session: "Session") -> None:
        """Draw it, if there is one."""
        if not session.prompts:
            self._browser = self._shown = None
            return
        prompt = session.prompts[-1]
        fresh = prompt is not self._shown
        self._shown = prompt
        try:
            self._draw(session, prompt, fresh)
        except Exception:
            # It could neither be answered nor left, and nothing else can be reached.
            session.prompts.remove(prompt)
            raise

    def _draw(self, session: "Session", prompt: Prompt, fresh: bool) -> None:
        match prompt:
            case Question():
                self._question(session, prompt, fresh)
            case TextQuestion():
                self._line(session, prompt, fresh)
            case FileQuestion():
                self._file(session, prompt, fresh)
            case MenuQuestion():
                self._list(session, prompt, fresh)

    def _modal(self, name: str, size: tuple[float, float] | None) -> bool:
        """Begin a window that stays until it is answered; whether it is on the screen."""
        viewport = imgui.get_main_viewport()
        centre = (
            viewport.pos.x + viewport.size.x / 2,
            viewport.pos.y + viewport.size.y * (0.5 if size else 0.42),
        )
        imgui.set_next_window_pos(centre, 0, (0.5, 0.5))
        if size is not None:
            imgui.set_next_window_size(size)
        if not imgui.is_popup_open(name):
            # A panel that comes to the front takes the pop-ups away.
            imgui.open_popup(name)
        flags = _FLAGS | (0 if size else imgui.WindowFlags_.always_auto_resize.value)
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(_PADDING), px(16)))
        opened = imgui.begin_popup_modal(name, None, flags)[0]
        imgui.pop_style_var()
        return opened

    def _question(self, session: "Session", prompt: Question, fresh: bool) -> None:
        if not self._modal("###question", None):
            return
        self._title(prompt.title)
        imgui.push_text_wrap_pos(_width())
        widgets.text(prompt.message, COLOURS.muted)
        imgui.pop_text_wrap_pos()
        self._pictures(session, prompt)
        imgui.dummy((px(300), px(8)))
        answer = self._buttons(session, prompt)
        if imgui.is_key_pressed(imgui.Key.escape, False) and not fresh:
            answer = prompt.cancel
        entered = imgui.is_key_pressed(imgui.Key.enter, False) or imgui.is_key_pressed(
            imgui.Key.keypad_enter, False
        )
        if entered and not fresh and answer is None:
            answer = prompt.default
        if answer is not None:
            imgui.close_current_popup()
            chosen = answer
            session.queue(lambda: session.answer(prompt, chosen))
        imgui.end_popup()

    def _title(self, words: str) -> None:
        imgui.push_text_wrap_pos(_width())
        with widgets.font(FONTS.bold, 18):
            widgets.text(words)
        imgui.pop_text_wrap_pos()

    def _pictures(self, session: "Session", prompt: Question) -> None:
        for index, (words, level) in enumerate(prompt.pictures):
            if index:
                imgui.same_line(0, px(14))
            imgui.begin_group()
            thumbnail(level, px(_PICTURE))
            widgets.small(words)
            imgui.end_group()
            widgets.probe(session, f"question.picture.{index}")

    def _buttons(self, session: "Session", prompt: Question) -> str | None:
        answer = None
        widths = [max(imgui.calc_text_size(tr(c.label)).x + px(30), px(92)) for c in prompt.choices]
        gap = imgui.get_style().item_spacing.x
        total = sum(widths) + gap * (len(widths) - 1)
        space = imgui.get_content_region_avail().x
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(space - total, 0))
        # The default stands at the right, where the eye ends.
        ordered = sorted(
            zip(prompt.choices, widths, strict=True), key=lambda pair: pair[0].id == prompt.default
        )
        for index, (choice, width) in enumerate(ordered):
            if index:
                imgui.same_line()
            name = f"question.{choice.id}"
            if choice.id == prompt.default:
                pressed = widgets.primary_button(session, name, choice.label, width=width)
            else:
                pressed = widgets.button(session, name, choice.label, width=width)
            if choice.detail:
                widgets.tooltip(choice.label, choice.detail)
            if pressed:
                answer = choice.id
        return answer

    def _line(self, session: "Session", prompt: TextQuestion, fresh: bool) -> None:
        if fresh:
            self._text = prompt.text
        if not self._modal("###line", None):
            return
        self._title(prompt.title)
        imgui.set_next_item_width(min(px(360), _width() - px(_PADDING)))
        if imgui.is_window_appearing():
            imgui.set_keyboard_focus_here()
        flags = (
            imgui.InputTextFlags_.enter_returns_true.value
            | imgui.InputTextFlags_.auto_select_all.value
        )
        entered, self._text = imgui.input_text("###line.text", self._text, flags)
        widgets.probe(session, "line.text")
        imgui.dummy((0, px(4)))
        width = px(96)
        gap = imgui.get_style().item_spacing.x
        room = imgui.get_content_region_avail().x - 2 * width - gap
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(room, 0.0))
        cancelled = widgets.button(session, "line.cancel", "Cancel", width=width)
        imgui.same_line()
        accepted = widgets.primary_button(session, "line.accept", prompt.accept, width=width)
        cancelled = cancelled or (imgui.is_key_pressed(imgui.Key.escape, False) and not fresh)
        if cancelled or ((accepted or entered) and self._text.strip()):
            imgui.close_current_popup()
            answer = None if cancelled else self._text.strip()
            session.queue(lambda: session.answer(prompt, answer))
        imgui.end_popup()

    def _file(self, session: "Session", prompt: FileQuestion, fresh: bool) -> None:
        if fresh:
            self._browser = FileBrowser(prompt)
        view = imgui.get_main_viewport().size
        size = (min(px(820), view.x * 0.92), min(px(560), view.y * 0.88))
        if not self._modal("###file", size):
            return
        assert self._browser is not None
        done, path = self._browser.draw(session)
        if not done and imgui.is_key_pressed(imgui.Key.escape, False) and not fresh:
            done, path = True, None
        if done:
            imgui.close_current_popup()
            session.queue(lambda: session.answer(prompt, path))
        imgui.end_popup()

    def _list(self, session: "Session", prompt: MenuQuestion, fresh: bool) -> None:
        name = "###list"
        if fresh or self._rows is None:
            imgui.open_popup(name)
            self._rows = ChoiceList(prompt.choices)
        viewport = imgui.get_main_viewport()
        if prompt.at is not None:
            imgui.set_next_window_pos(prompt.at, imgui.Cond_.appearing.value)
        else:
            centre = (viewport.pos.x + viewport.size.x / 2, viewport.pos.y + viewport.size.y / 2)
            imgui.set_next_window_pos(centre, imgui.Cond_.appearing.value, (0.5, 0.5))
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(8), px(8)))
        opened = imgui.begin_popup(name, imgui.WindowFlags_.no_nav.value)
        imgui.pop_style_var()
        if not opened:
            if not fresh:
                session.queue(lambda: session.answer(prompt, None))
            return
        widgets.small(prompt.title)
        imgui.separator()
        taken = self._rows.draw(session, fresh=fresh)
        if taken is not None:
            imgui.close_current_popup()
            session.queue(lambda: session.answer(prompt, taken))
        if imgui.is_key_pressed(imgui.Key.escape, False) and not fresh:
            imgui.close_current_popup()
        imgui.end_popup()
