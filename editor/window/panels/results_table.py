"""The table of an evaluation: a row per level, a column per agent; of many agents a heat map."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions.evaluation import measure
from editor.agents.evaluation import Column, Plan, Row, best
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons, alpha, u32
from editor.toolkit.widgets import px
from kinetix.agents.compare import labels_of
from kinetix.agents.results import LevelResult
from kinetix.wording import plural

if TYPE_CHECKING:
    from editor.session import Session

_HEADS: Final[dict[Column, str]] = {
    "level": "Level",
    "solve_rate": "Solved",
    "mean_return": "Return",
    "mean_length": "Steps",
}
MOST_WIDE: Final = 2
"""Agents with columns for return and length; of more only the rates are shown, as a heat map."""
MOST_AGENTS: Final = 200
"""Agents that have a column; Dear ImGui takes no more than 511 columns."""
_LEVEL: Final = 150.0
"""Width of the levels' names in a heat map [px at 100 %]."""
_CELL: Final = 66.0
"""Least width of a cell of a heat map [px at 100 %]; where there is less room it scrolls."""


def _columns(agents: int) -> tuple[Column, ...]:
    """Return the number of columns per agent."""
    return ("solve_rate", "mean_return", "mean_length") if agents <= MOST_WIDE else ("solve_rate",)


def end_of(words: str, width: float) -> str:
    """Return as much of the end of some words as fits: names of levels differ there."""
    if imgui.calc_text_size(words).x <= width:
        return words
    low, high = 0, len(words)
    while low < high:
        middle = (low + high) // 2
        if imgui.calc_text_size(f"…{words[middle:]}").x <= width:
            high = middle
        else:
            low = middle + 1
    return f"…{words[low:]}"


def _name(label: str, before: str) -> str:
    """Return the head of an agent's rates: its name, after a word where there is room for that."""
    room = imgui.get_content_region_avail().x - px(14)  # for the arrow of the sorting
    words = f"{before}  {label}".strip()
    return words if imgui.calc_text_size(words).x <= room else end_of(label, room)


class ResultsTable:
    """Sorts, and remembers which result's attempts are on show."""

    def __init__(self) -> None:
        self._chosen: tuple[Plan, int, int] | None = None
        """The result whose attempts are on show: of which evaluation, level and agent."""
        self._sort: Column = "level"
        self._sort_agent = 0
        self._descending = False

    def chosen(self, plan: Plan) -> tuple[int, int] | None:
        """Return the level and the agent of an evaluation whose attempts are on show."""
        chosen = self._chosen
        return chosen[1:] if chosen is not None and chosen[0] is plan else None

    def draw(self, session: "Session", size: tuple[float, float], wanted: str) -> None:
        """Draw the table.

        Args:
            session: What was evaluated.
            size: Width and height [px].
            wanted: Only levels whose name contains this.
        """
        evaluation = session.viewer.evaluation
        plan = evaluation.plan
        assert plan is not None
        count = min(len(plan.agents), MOST_AGENTS)
        shown, heat = _columns(count), count > MOST_WIDE
        flags = (
            imgui.TableFlags_.row_bg.value
            | imgui.TableFlags_.scroll_y.value
            | imgui.TableFlags_.sortable.value
            | imgui.TableFlags_.resizable.value
            | imgui.TableFlags_.borders_inner_h.value
        )
        inner = 0.0
        if heat:
            flags |= imgui.TableFlags_.scroll_x.value
            inner = max(size[0] - px(16), px(_LEVEL) + count * px(_CELL))
        columns = 1 + len(shown) * count
        if not imgui.begin_table(f"results{count}", columns, flags, size, inner):
            return
        # The head, and in a heat map the row of means, stay in sight.
        imgui.table_setup_scroll_freeze(1, 2 if heat else 1)
        self._setup(plan, level=px(_LEVEL) * count / max(inner - px(_LEVEL), 1) if heat else 1.2)
        self._heads(plan, heat=heat)
        self._take_sorting(len(shown))
        if heat:
            self._means(session, count)
        rows = evaluation.rows(
            sort=self._sort, agent=self._sort_agent, descending=self._descending, wanted=wanted
        )
        clipper = imgui.ListClipper()
        clipper.begin(len(rows))
        while clipper.step():
            for index in range(clipper.display_start, clipper.display_end):
                self._row(session, rows[index])
        imgui.end_table()

    def _setup(self, plan: Plan, level: float) -> None:
        """Set the columns' widths; that of the level's name by the width of a rate."""
        kind = imgui.TableColumnFlags_
        stretch, agents = kind.width_stretch.value, plan.agents[:MOST_AGENTS]
        imgui.table_setup_column(tr(_HEADS["level"]), kind.default_sort.value | stretch, level)
        rate = 1.0 if len(agents) > MOST_WIDE else 1.6
        for agent in agents:
            for column in _columns(len(agents)):
                share = rate if column == "solve_rate" else 0.7
                imgui.table_setup_column(f"###{agent.ref.path}{column}", stretch, share)

    def _heads(self, plan: Plan, *, heat: bool) -> None:
        """Draw the head: in a heat map the agents' names alone, as far as they fit."""
        labels = labels_of([plan.provenance(k) for k in range(len(plan.agents))])
        imgui.table_next_row(imgui.TableRowFlags_.headers.value)
        imgui.table_next_column()
        imgui.table_header(tr(_HEADS["level"]))
        for label in labels[:MOST_AGENTS]:
            for column in _columns(len(labels)):
                imgui.table_next_column()
                words = tr(_HEADS[column])
                if column == "solve_rate" and len(labels) > 1:
                    # The columns of an agent stand together: its name is over the first.
                    words = _name(label, "" if heat else words)
                imgui.table_header(widgets.labelled(words, f"{label}{column}"))
                widgets.tooltip(label, tr(_HEADS[column]), own=True)

    def _means(self, session: "Session", count: int) -> None:
        """Draw each agent's mean over all levels, once it has played them."""
        imgui.table_next_row()
        imgui.table_next_column()
        widgets.muted("Mean")
        for agent in range(count):
            imgui.table_next_column()
            summary = session.viewer.evaluation.summary(agent)
            if summary is None or not summary["levels"]:
                widgets.text("…", COLOURS.faint)
                continue
            rate = summary["mean_solve_rate"]
            _tint(rate)
            widgets.text(f"{rate:.3f}")
            told = tr(f"{plural(summary['levels'], 'level')} under {summary['physics']}")
            widgets.tooltip(summary["agent"], told, own=True)

    def _take_sorting(self, shown: int) -> None:
        # In each frame: a table that comes back with its old order does not call that a change.
        wish = imgui.table_get_sort_specs()
        if wish is None or wish.specs_count == 0:
            return
        spec = wish.get_specs(0)
        self._descending = spec.get_sort_direction() == imgui.SortDirection.descending
        if spec.column_index == 0:
            self._sort = "level"
        else:
            self._sort_agent, kind = divmod(spec.column_index - 1, shown)
            self._sort = ("solve_rate", "mean_return", "mean_length")[kind]
        wish.specs_dirty = False

    def _row(self, session: "Session", row: Row) -> None:
        imgui.table_next_row()
        imgui.table_next_column()
        shown = end_of(row.name, imgui.get_content_region_avail().x)
        widgets.raw(shown)
        if shown != row.name:
            widgets.tooltip(row.name, own=True)
        winner, wide = best(row.results), len(row.results) <= MOST_WIDE
        for agent, result in enumerate(row.results[:MOST_AGENTS]):
            imgui.table_next_column()
            if result is None:
                if row.errors[agent]:
                    widgets.text("cannot play", COLOURS.warn)
                    widgets.tooltip(row.name, tr(row.errors[agent]), own=True)
                else:
                    widgets.text("…", COLOURS.faint)
                if wide:
                    imgui.table_next_column()
                    imgui.table_next_column()
                continue
            if not wide:
                _tint(result.solve_rate)
            self._rate(session, row, agent, result, winner)
            if not wide:
                continue
            imgui.table_next_column()
            widgets.text(f"{result.mean_return:.3f}", COLOURS.muted)
            imgui.table_next_column()
            widgets.text(f"{result.mean_length:.1f}", COLOURS.muted)

    def _rate(
        self,
        session: "Session",
        row: Row,
        agent: int,
        result: LevelResult,
        winner: int | None,
    ) -> None:
        """The solve rate with its interval; a click shows the attempts, two open one."""
        low, high = result.bounds
        interval = f"{low:.2f}-{high:.2f}"
        rate, colour, mark = f"{result.solve_rate:.2f}", COLOURS.text, ""
        if len(row.results) > 1 and winner is not None:
            mark = f"{Icons.better if winner == agent else Icons.worse}  "
            # In a heat map the cell is green.
            leads = COLOURS.good if len(row.results) <= MOST_WIDE else COLOURS.text
            colour = leads if winner == agent else COLOURS.muted
        words = f"{mark}{rate}   {interval}"
        if imgui.calc_text_size(words).x > imgui.get_content_region_avail().x:
            words = f"{mark}{rate}"
        plan = session.viewer.evaluation.plan
        assert plan is not None
        chosen = self.chosen(plan) == (row.level, agent)
        with widgets.coloured(text=colour):
            flags = imgui.SelectableFlags_.allow_double_click.value
            pressed = imgui.selectable(f"{words}###{row.level}.{agent}", chosen, flags)[0]
        widgets.probe(session, f"evaluate.{row.name}.{agent}")
        detail = f"{result.solved} of {result.attempts} won ({interval})"
        if result.failures:
            detail += f"; otherwise {result.failures}"
        told = tr(f"{detail}. Double-click: watch the first attempt.")
        widgets.tooltip(row.name, told, own=True)
        if not pressed:
            return
        self._chosen = (plan, row.level, agent)
        if imgui.is_mouse_double_clicked(0):
            session.queue(lambda: measure.open_attempt(session, row.level, agent, 0))


def _tint(rate: float) -> None:
    """Colour the cell by a rate."""
    tint = u32(alpha(COLOURS.good, 0.5 * rate))
    imgui.table_set_bg_color(imgui.TableBgTarget_.cell_bg.value, tint)
