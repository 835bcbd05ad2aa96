"""The problems of the level, live, each with the button that mends it."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions.editing.fixes import fix_of
from editor.actions.watching.compatible import agents_stamp, compatible_agents
from editor.agents.random_play import fitting
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons, u32
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel
from kinetix.level.validate import Issue, has_errors

if TYPE_CHECKING:
    from editor.session import Session

_LOOK: Final[dict[str, tuple[str, str]]] = {
    "error": (Icons.error, "bad"),
    "warning": (Icons.warning, "warn"),
    "info": (Icons.info, "info"),
}


class ProblemsPanel(Panel):
    """The same list that `kinetix validate` prints."""

    id, title, icon = "problems", "Problems", Icons.problems

    def __init__(self) -> None:
        self._fits: tuple[object, Issue] | None = None

    def draw(self, session: "Session") -> None:
        """Draw the list; a click selects what is meant."""
        document = session.document
        issues = document.problems
        if not issues:
            imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + px(4))
            words = "No problems: this level can be played, won and used for training."
            widgets.wrapped(f"{Icons.good}  {words}", COLOURS.good)
        for index, issue in enumerate(issues):
            self._issue(session, index, issue)
        if has_errors(issues):
            return
        findings = (*session.trial.findings(document.level), self._fitting(session))
        for index, issue in enumerate(findings, start=len(issues)):
            self._issue(session, index, issue)
        self._try_out(session)

    def _fitting(self, session: "Session") -> Issue:
        """I303, worked out again only when the level or the agents are others."""
        level = session.document.level
        recent = tuple(session.settings.recent_agents)
        known = (level, recent, session.viewer.agents, agents_stamp())
        if self._fits is None or self._fits[0] != known:
            self._fits = (known, fitting(level, compatible_agents(session, level)))
        return self._fits[1]

    def _try_out(self, session: "Session") -> None:
        """The button that plays the level without a plan, and how far that is."""
        trial = session.trial
        imgui.dummy((0, px(2)))
        if trial.running and trial.job is not None:
            widgets.spinner(7)
            imgui.same_line(0, px(8))
            widgets.muted(f"{trial.job.message or trial.job.title} …")
            imgui.same_line(0, px(12))
            if widgets.button(session, "problems.cancel", "Cancel"):
                session.queue(trial.cancel)
            return
        action = actions.BY_ID["level.try_out"]
        with widgets.disabled(not actions.available(session, action)):
            label = f"{Icons.dice}  {action.label}"
            if widgets.button(session, "problems.try_out", label):
                session.queue(action.id)
        widgets.tooltip(action.label, action.tooltip)
        if trial.error:
            imgui.same_line(0, px(12))
            widgets.text(trial.error, COLOURS.bad)

    def _issue(self, session: "Session", index: int, issue: Issue) -> None:
        icon, name = _LOOK[issue.severity]
        colour = COLOURS.of(name)
        fix = fix_of(session, issue) if session.editing else None
        imgui.push_id(index)
        start = imgui.get_cursor_screen_pos()
        space = imgui.get_content_region_avail().x
        room = imgui.calc_text_size(tr(fix.label)).x + px(28) if fix is not None else 0.0
        lines = widgets.broken(tr(issue.message), max(space - room - px(86), px(80)))
        height = imgui.get_text_line_height() * len(lines) + px(8)
        flags = imgui.SelectableFlags_.allow_overlap.value
        if imgui.selectable("###issue", False, flags, (0, height))[0] and issue.ids:
            session.queue(lambda: setattr(session, "selection", tuple(issue.ids)))
        widgets.probe(session, f"problems.{issue.code}")
        if imgui.is_item_hovered():
            session.highlighted = tuple(issue.ids)
        draw = imgui.get_window_draw_list()
        top = start.y + px(4)
        draw.add_text((start.x + px(4), top), u32(colour), icon)
        with widgets.font(FONTS.mono, SMALL):
            draw.add_text((start.x + px(28), top + px(1)), u32(COLOURS.faint), issue.code)
        for number, line in enumerate(lines):
            at = (start.x + px(74), top + number * imgui.get_text_line_height())
            draw.add_text(at, u32(COLOURS.text), line)
        if fix is not None:
            imgui.set_cursor_screen_pos((start.x + space - room + px(8), start.y + px(2)))
            if imgui.small_button(tr(fix.label)):
                session.queue(fix.command)
            widgets.probe(session, f"problems.{issue.code}.fix")
            imgui.set_cursor_screen_pos((start.x, start.y + height + px(2)))
            imgui.dummy((0, 0))
        imgui.pop_id()
