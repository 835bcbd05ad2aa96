"""The evaluation: which agents on which levels, how far it is, the table of solve rates."""

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions.evaluation import comparison, measure
from editor.actions.evaluation.save_table import ask_save
from editor.agents.attempt_paths import Ways
from editor.base.language import tr
from editor.base.prompts import FileQuestion
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons, alpha, u32
from editor.toolkit.modes import OUTCOME_LOOK
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel
from editor.window.panels.results_table import MOST_AGENTS, MOST_WIDE, ResultsTable
from editor.worker.requests import BUILT_IN
from kinetix.agents.results import EpisodeResult
from kinetix.engine.names import PHYSICS
from kinetix.paths import levels_dir
from kinetix.wording import listed, plural

if TYPE_CHECKING:
    from editor.session import Session

_SOURCES: Final = (
    ("this", "The level in front"),
    ("s", "The app's levels of size s"),
    ("m", "The app's levels of size m"),
    ("l", "The app's levels of size l"),
    ("chosen", "What is chosen in the gallery"),
    ("folder", "A folder…"),
    ("set", "A file or level set…"),
)
MOST_ATTEMPTS: Final = 1000
_MOST_WORDS: Final = 60
"""Letters of the names of agents that are shown; the tooltip has the rest."""
_NAMED: Final = 12
"""So many attempts of an ending are named."""
_ATTEMPTS: Final = 250.0
"""Width of the attempts beside the table [px at 100 %]."""


def _label(words: str) -> None:
    """Draw the label of the next field."""
    imgui.align_text_to_frame_padding()
    widgets.muted(words)
    imgui.same_line(0, px(6))


class EvaluatePanel(Panel):
    """A form, a bar, a table; double-clicking a result opens one of its episodes."""

    id, title, icon = "evaluate", "Evaluate", Icons.trophy
    height = 330.0
    measures = True

    def __init__(self) -> None:
        self._table = ResultsTable()

    def draw(self, session: "Session") -> None:
        """Draw the form, then what is known."""
        self._fields(session)
        self._run(session)
        evaluation = session.viewer.evaluation
        if evaluation.error:
            widgets.wrapped(evaluation.error, COLOURS.bad)
        if evaluation.standing is not None:
            for number, error in evaluation.standing.errors:
                assert evaluation.plan is not None
                name = evaluation.plan.agents[number].name
                widgets.wrapped(f"{name}: {error}", COLOURS.bad)
        if evaluation.plan is None:
            widgets.small(
                "Every agent plays every level several times; a row a level, a column an agent."
            )
            return
        self._head(session)
        space = imgui.get_content_region_avail()
        chosen = self._table.chosen(evaluation.plan)
        beside = min(px(_ATTEMPTS), 0.38 * space.x) if chosen is not None else 0.0
        size = (space.x - beside - (px(10) if beside else 0.0), max(space.y, px(64)))
        self._table.draw(session, size, session.viewer.form.wanted)
        if chosen is not None:
            imgui.same_line(0, px(10))
            imgui.begin_child("attempts", (0.0, size[1]))
            self._attempts(session, *chosen)
            imgui.end_child()

    def _head(self, session: "Session") -> None:
        """Draw the filter and the means."""
        imgui.set_next_item_width(px(210))
        form = session.viewer.form
        _, form.wanted = widgets.input_line("wanted", "Filter levels", form.wanted)
        widgets.probe(session, "evaluate.filter")
        self._summary(session)

    def _fields(self, session: "Session") -> None:
        """Draw what is played, who plays, how often: a line each where there is room."""
        form = session.viewer.form
        imgui.set_next_item_width(px(210))
        picked = widgets.choice(session, "evaluate.source", form.source, _SOURCES)
        if picked is not None:
            self._choose_source(session, picked)
        played = session.gallery.selection if form.source == "chosen" else form.paths
        widgets.tooltip("Levels", ", ".join(played) or "What is played.")
        widgets.beside(215, gap=8)
        imgui.set_next_item_width(px(215))
        options = [("", "Agents' own physics"), *((name, name) for name in PHYSICS)]
        picked = widgets.choice(session, "evaluate.physics", form.physics, options)
        form.physics = form.physics if picked is None else picked
        self._who(session)
        self._scripted(session)
        _label("Attempts")
        imgui.set_next_item_width(px(96))
        changed, attempts = imgui.input_int("###attempts", form.attempts)
        widgets.probe(session, "evaluate.attempts")
        if changed:
            form.attempts = min(max(attempts, 1), MOST_ATTEMPTS)
        widgets.tooltip("Attempts", "Independent episodes for each level and agent.")
        widgets.beside(170, gap=12)
        _label("Seed")
        imgui.set_next_item_width(px(96))
        changed, seed = imgui.input_int("###seed", form.seed)
        widgets.probe(session, "evaluate.seed")
        if changed:
            form.seed = max(seed, 0)
        widgets.tooltip("Seed", "Equal seeds give equal results, to the bit.")

    def _scripted(self, session: "Session") -> None:
        """The scripted agents; one that is measured as A or B anyway is ticked and stays so."""
        viewer, form = session.viewer, session.viewer.form
        anyway = {agent.ref.path for agent in (*viewer.agents, *viewer.contenders)}
        for name in BUILT_IN:
            widgets.beside(90, gap=12)
            on = name in form.scripted or name in anyway
            changed, on = widgets.checkbox(
                session, f"evaluate.{name}", name, on, enabled=name not in anyway
            )
            if changed:
                kept = tuple(other for other in form.scripted if other != name)
                form.scripted = (*kept, name) if on else kept

    def _who(self, session: "Session") -> None:
        """The agents that are measured, and more of them."""
        viewer = session.viewer
        names = [agent.name for agent in session.viewer.measured]
        words = f"Agents: {', '.join(names) or 'none loaded'}"
        shown = words if len(words) < _MOST_WORDS else f"{words[:_MOST_WORDS]}… ({len(names)})"
        imgui.align_text_to_frame_padding()
        widgets.muted(shown)
        if shown != words:
            widgets.tooltip("Agents", ", ".join(names))
        imgui.same_line(0, px(8))
        if widgets.button(session, "evaluate.more", "Add…"):
            session.queue(lambda: measure.ask_contender(session))
        widgets.tooltip("Measure too", "Another agent, or every checkpoint of a training run.")
        if viewer.contenders:
            widgets.beside_words("Only A and B", gap=4)
            if widgets.button(session, "evaluate.fewer", "Only A and B"):
                viewer.contenders = ()

    def _choose_source(self, session: "Session", picked: str) -> None:
        form = session.viewer.form
        form.source, form.paths = picked, ()
        if picked in ("s", "m", "l"):
            form.paths = (str(levels_dir() / picked),)
        elif picked in ("folder", "set"):
            self._ask(session, folder=picked == "folder")

    def _ask(self, session: "Session", *, folder: bool) -> None:
        def answer(path: Path | None) -> None:
            if path is None:
                session.viewer.form.source = "this"
            else:
                session.viewer.form.paths = (str(path),)

        session.ask(
            FileQuestion(
                purpose="folder" if folder else "open",
                title="Folder of levels" if folder else "Level or level set",
                folder=levels_dir(),
                answer=answer,
            )
        )

    def _run(self, session: "Session") -> None:
        form, evaluation = session.viewer.form, session.viewer.evaluation
        who = session.viewer.measured
        widgets.beside(130, gap=16)
        if evaluation.running:
            if widgets.button(session, "evaluate.cancel", "Cancel"):
                session.queue(evaluation.cancel)
            job = evaluation.job
            fraction = job.fraction if job is not None and job.fraction is not None else 0.0
            imgui.same_line()
            imgui.progress_bar(fraction, (px(240), 0), tr(evaluation.stage))
            return
        with widgets.disabled(not who):
            pressed = widgets.primary_button(session, "evaluate.run", f"{Icons.play}  Evaluate")
        if not who:
            widgets.tooltip("Evaluate", "Choose an agent first: Add…, or tick a name beside it.")
        if pressed:
            session.queue(
                lambda: measure.start_evaluation(
                    session,
                    who,
                    measure.sources_asked(session),
                    attempts=form.attempts,
                    seed=form.seed,
                    physics=form.physics,
                    deterministic=session.viewer.deterministic,
                )
            )
        widgets.beside_words("Open…")
        if widgets.button(session, "evaluate.open", "Open…"):
            session.queue(lambda: comparison.ask_comparison(session))
        widgets.tooltip("Open a comparison", "A .json that was saved here or by kinetix compare.")
        standing = evaluation.standing
        if standing is not None and (standing.scores or standing.failures):
            widgets.beside_words("Save the table…")
            if widgets.button(session, "evaluate.save", "Save the table…"):
                session.queue(lambda: ask_save(session))
            widgets.tooltip("Save the table", "CSV, or the lines of kinetix eval --json.")
            if evaluation.cancelled:
                widgets.beside_words("Cancelled; what was done stays.")
                widgets.muted("Cancelled; what was done stays.")

    def _summary(self, session: "Session") -> None:
        evaluation = session.viewer.evaluation
        assert evaluation.plan is not None
        words = []
        for number in range(len(evaluation.plan.agents)):
            summary = evaluation.summary(number)
            if summary is not None and summary["levels"]:
                rate = f"{summary['mean_solve_rate']:.3f}"
                words.append(f"{summary['agent']} under {summary['physics']}: {rate}")
        agents = len(evaluation.plan.agents)
        if agents > MOST_AGENTS:
            widgets.wrapped(
                f"The table shows the first {MOST_AGENTS} of {agents} agents; a saved one has all."
            )
        if words and len(evaluation.plan.agents) <= MOST_WIDE:  # else the table has them
            means = f"Mean solve rate   {'    '.join(words)}"
            widgets.beside(imgui.calc_text_size(tr(means)).x / px(1), gap=14)
            widgets.wrapped(means)
        if len(evaluation.plan.agents) > 1 and len(words) == len(evaluation.plan.agents):
            self._differences(session)

    def _differences(self, session: "Session") -> None:
        """Draw how far the best is ahead of the others, on equal seeds, and if that is certain."""
        best_label, pairs = session.viewer.evaluation.differences()
        told, certain = [], []
        for pair in pairs:
            if pair.difference is None or pair.low is None:
                continue
            span = f"{pair.low:+.2f} to {pair.high:+.2f}"
            told.append(f"{pair.difference:+.2f} ({span}) over {pair.second}")
            if pair.low > 0:
                certain.append(told[-1])
        if told:
            shown = certain or told
            what = f"{best_label} leads" if certain else f"No difference is certain. {best_label}"
            parts = ", ".join(map(tr, shown[:2]))
            more = tr(f", and {len(shown) - 2} more") if len(shown) > 2 else ""
            widgets.small(f"{what}: {parts}{more}")
            widgets.tooltip("Paired differences, 95 %", "\n".join(told))

    def _attempts(self, session: "Session", level: int, agent: int) -> None:
        """The attempts of the chosen result one by one; a click opens one."""
        evaluation = session.viewer.evaluation
        plan = evaluation.plan
        assert plan is not None
        name = plan.levels[level].name
        result = evaluation.result(agent, name)
        if result is None:
            return
        widgets.small(f"{name}, {plan.agents[agent].name}: click an attempt to watch it")
        self._ways(session, level, agent)
        if session.viewer.ways is not None:
            session.viewer.ways.lit = None
        wide, step = imgui.get_content_region_avail().x, px(26)
        columns = max(1, int(wide / step))
        clipper = imgui.ListClipper()
        clipper.begin(-(-len(result.episodes) // columns), step)
        while clipper.step():
            for row in range(clipper.display_start, clipper.display_end):
                first = row * columns
                for number in range(first, min(first + columns, len(result.episodes))):
                    if number > first:
                        imgui.same_line(0, px(3))
                    self._attempt(session, (level, agent, number), result.episodes[number])
        clipper.end()

    def _ways(self, session: "Session", level: int, agent: int) -> None:
        """Show where all attempts went, and which of them; another result's are forgotten."""
        viewer = session.viewer
        if viewer.ways_of(level, agent) is None:
            viewer.ways = None
        if viewer.ways_pending:
            widgets.spinner(7)
            imgui.same_line(0, px(8))
            widgets.muted("Playing the attempts …")
            return
        ways = viewer.ways_of(level, agent)
        label, does = "Show Paths", "Where the green shape went in each attempt, over the level."
        if ways is not None:
            label, does = "Hide Paths", "The level without the paths of the attempts."
        if widgets.button(session, "evaluate.ways", label):
            session.queue(lambda: measure.show_paths(session, level, agent))
        widgets.tooltip(label, does)
        if ways is None:
            return
        for outcome in dict.fromkeys(ways.paths.outcomes):
            widgets.beside(70, gap=8)
            shown = not ways.outcomes or outcome in ways.outcomes
            changed, on = widgets.checkbox(session, f"evaluate.ways.{outcome}", outcome, shown)
            if changed:
                kept = ways.outcomes or tuple(dict.fromkeys(ways.paths.outcomes))
                others = tuple(one for one in kept if one != outcome)
                ways.outcomes = (*others, outcome) if on else others
        self._endings(session, ways)

    def _endings(self, session: "Session", ways: Ways) -> None:
        """The attempts grouped by how they end; a click shows one group and opens its first."""
        widgets.small("Attempts by outcome. Click one to open it where it leaves the wins:")
        for number, ending in enumerate(ways.paths.endings):
            icon, _, name = OUTCOME_LOOK[ending.outcome]
            x, y = ending.place
            words = f"{len(ending.attempts)} {ending.outcome} near {x:.1f}, {y:.1f}"
            if ending.parting is not None:
                words += f", parts at {ending.parting}"
            words = f"{icon}  {tr(words)}"
            shown = ways.ending == number
            with widgets.coloured(text=COLOURS.of(name)):
                pressed = imgui.selectable(f"{words}###ending{number}", shown)[0]
            widgets.probe(session, f"evaluate.ending.{number}")
            which = listed(ending.attempts, _NAMED)
            told = f"About {plural(ending.length, 'step')}. Attempts {which}."
            if ending.parting is not None:
                told += f"\nIt leaves the path of the wins at step {ending.parting}."
            widgets.tooltip(f"{len(ending.attempts)} {ending.outcome}", told)
            if pressed and shown:
                ways.ending = None
            elif pressed:
                ways.ending = number
                opens = measure.open_attempt
                which = (ways.level, ways.agent, ending.attempts[0])
                session.queue(functools.partial(opens, session, *which, at=ending.parting))

    def _attempt(
        self, session: "Session", which: tuple[int, int, int], episode: EpisodeResult
    ) -> None:
        icon, _, name = OUTCOME_LOOK[episode.outcome]
        colour = COLOURS.of(name)
        at, side = imgui.get_cursor_screen_pos(), px(23)
        pressed = imgui.invisible_button(f"attempt{which}", (side, side))
        widgets.probe(session, f"evaluate.attempt.{which[2]}")
        draw = imgui.get_window_draw_list()
        fill = 0.34 if imgui.is_item_hovered() else 0.16
        high = (at.x + side, at.y + side)
        draw.add_rect_filled((at.x, at.y), high, u32(alpha(colour, fill)), px(4))
        with widgets.font(FONTS.regular, SMALL - 1):
            extent = imgui.calc_text_size(icon)
            place = (at.x + (side - extent.x) / 2, at.y + (side - extent.y) / 2)
            draw.add_text(place, u32(colour), icon)
        told = f"{episode.outcome} after {plural(episode.length, 'step')}"
        widgets.tooltip(f"Attempt {which[2]}", f"{told}, return {episode.total_reward:.3f}")
        ways = session.viewer.ways_of(which[0], which[1])
        if ways is not None and imgui.is_item_hovered():
            ways.lit = which[2]
        if pressed:
            at = None if ways is None else ways.parting(which[2])
            session.queue(lambda: measure.open_attempt(session, *which, at=at))
