"""The agents: who plays, with which draws, what is shown of it, and whom it is compared with."""

from pathlib import Path
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions.watching import agents
from editor.agents.folders import checkpoints_of
from editor.agents.viewer import COMPARE_LABELS, SlotName, mismatch
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, Icons
from editor.toolkit.keys import label as chord_label
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel
from editor.worker.requests import About, AgentSummary
from kinetix.wording import plural, thousands

if TYPE_CHECKING:
    from editor.session import Session

OVERLAYS: Final[dict[str, tuple[str, str]]] = {
    "heat": ("Actions on joints and thrusters", "Colour: where the policy leans. Arrow: chosen."),
    "futures": ("Futures", "Where the green shape would go in what a planner tries."),
    "numbers": (
        "Value, entropy, probabilities",
        "What it expects of the future, how unsure it is, and each control's choices.",
    ),
    "attention": (
        "Attention",
        "Entity networks: the share of attention that each body gets over all layers.",
    ),
    "saliency": (
        "What matters to it",
        "Rings: how far the number would go if the entity were moved by 10 cm, turned by "
        "0.1 rad and 1 m/s faster; motors and thrusters twice as strong.",
    ),
    "places": (
        "Value of places",
        "The value if the chosen body (or the one that was dragged last) stood elsewhere, with "
        "what is jointed to it. Red: more than now, blue: less.",
    ),
}
"""Names in the settings, labels and explanations."""


_LOOK_SECONDS: Final = 3.0
"""Interval at which a run is searched for new checkpoints."""
_ABOUT: Final[dict[About, str]] = {"value": "its value", "action": "its choice"}


class AgentsPanel(Panel):
    """Two slots, the draws, the comparison, the overlays."""

    id, title, icon = "agents", "Agents", Icons.agent

    def __init__(self) -> None:
        self._listed: dict[str, tuple[float, list[Path]]] = {}
        """Checkpoints by agent, and when they were looked for [s]."""

    def draw(self, session: "Session") -> None:
        """Draw the sections."""
        viewer = session.viewer
        self._slot(session, "a")
        if viewer.slots["a"].summary is not None:
            self._play(session)
            if widgets.section("Draws"):
                self._draws(session)
        if widgets.section("Compare with"):
            self._slot(session, "b")
            self._compare(session)
        if widgets.section("Shown while it plays"):
            self._overlays(session)
        if widgets.section("Measure and watch", opened=False):
            self._more(session)

    def _slot(self, session: "Session", slot: SlotName) -> None:
        place = session.viewer.slots[slot]
        summary = place.summary
        width = imgui.get_content_region_avail().x
        if summary is None and not place.loading:
            hint = "Let an agent play" if slot == "a" else "A second agent, same level and seed"
            widgets.small(hint)
        label = summary.name if summary is not None else "Choose an agent…"
        if place.loading:
            widgets.spinner(7)
            imgui.same_line(0, px(8))
            widgets.muted("Loading …")
        elif widgets.button(
            session, f"agents.choose.{slot}", f"{slot.upper()}:  {label}", width=width
        ):
            session.queue(f"agent.choose_{slot}")
        if place.error:
            widgets.small(place.error, COLOURS.bad)
        if place.passed_over is not None:
            name = place.passed_over.name
            widgets.small(f"It plays for {name}, which comes back where it can play.")
        if summary is not None:
            self._summary(session, summary, slot)

    def _summary(self, session: "Session", summary: AgentSummary, slot: SlotName) -> None:
        lines = [summary.network]
        if summary.parameters:
            memory = ", with memory" if summary.recurrent else ""
            lines.append(f"{thousands(summary.parameters)} parameters{memory}")
        seen = summary.observation.replace("_", " ")
        lines.append(f"sees {seen}, says {summary.action.replace('_', ' ')}")
        trained = [
            f"{summary.physics} physics",
            f"an action holds {plural(summary.frame_skip, 'step')}",
        ]
        if summary.steps is not None:
            trained.append(f"{thousands(summary.steps)} steps of training")
        lines.append(", ".join(trained))
        if summary.parameters:
            if summary.description:
                widgets.small(summary.description, COLOURS.text)
            for line in lines:
                widgets.small(line)
        playback = session.playback
        level = playback.level if playback.active else session.document.level
        problem = mismatch(summary, level) if level is not None else ""
        if problem:
            widgets.small(problem, COLOURS.warn if summary.any_size else COLOURS.bad)
        if slot == "a" and summary.parameters and playback.next_physics != summary.physics:
            words = f"It plays under {playback.next_physics} now, and was trained under "
            widgets.small(f"{words}{summary.physics}.", COLOURS.warn)
        self._checkpoints(session, summary, slot)
        if widgets.button(session, f"agents.clear.{slot}", "Take out"):
            session.queue(lambda: agents.clear_slot(session, slot))

    def _checkpoints(self, session: "Session", summary: AgentSummary, slot: SlotName) -> None:
        """A slider over the checkpoints of the agent's training run."""
        known = self._known_checkpoints(session, summary)
        if len(known) < 2:
            return
        path = Path(summary.folder or summary.ref.path)
        place = known.index(path) if path in known else len(known) - 1
        steps = f"{thousands(int(known[place].name))} steps"
        widgets.small(f"Checkpoint {place + 1} of {len(known)}, at {steps}")
        imgui.set_next_item_width(imgui.get_content_region_avail().x)
        moved, chosen = imgui.slider_int(f"###checkpoint.{slot}", place, 0, len(known) - 1, "")
        widgets.probe(session, f"agents.checkpoint.{slot}")
        widgets.tooltip(
            "Checkpoint",
            f"{len(known)} of this run. The episode restarts with the same level and the same "
            "random numbers.",
        )
        if moved and chosen != place and not session.viewer.slots[slot].loading:
            target = known[chosen]
            session.queue(lambda: agents.show_checkpoint(session, slot, target))

    def _known_checkpoints(self, session: "Session", summary: AgentSummary) -> list[Path]:
        """Return the run's checkpoints; the disk is asked now and then, not in every frame."""
        key, now = summary.ref.path, session.time
        known = self._listed.get(key)
        if known is None or now - known[0] > _LOOK_SECONDS:
            known = self._listed[key] = (now, checkpoints_of(Path(key)))
        return known[1]

    def _play(self, session: "Session") -> None:
        label = f"{Icons.play}  Let it play"
        widgets.beside_words(label)
        keys = chord_label("f6")
        summary = session.viewer.slots["a"].summary
        playback = session.playback
        level = playback.level if playback.active else session.document.level
        able = summary is None or level is None or summary.any_size or not mismatch(summary, level)
        with widgets.disabled(not able):
            pressed = widgets.primary_button(session, "agents.play", label)
        if pressed and able:
            session.queue("run.play_agent")
        widgets.tooltip("Let the agent play", actions.BY_ID["run.play_agent"].tooltip, keys)

    def _draws(self, session: "Session") -> None:
        draws = session.viewer.draws
        with widgets.property_table("draws") as opened:
            if not opened:
                return
            widgets.row("Actions", "Drawn from the policy, as in training, or the likeliest ones.")
            options = [("drawn", "Drawn"), ("likeliest", "Likeliest")]
            now = "likeliest" if draws.deterministic else "drawn"
            picked = widgets.choice(session, "agents.mode", now, options)
            if picked is not None and picked != now:
                session.queue("agent.deterministic")
            widgets.row("Seed", "Equal seeds give equal draws, here and in kinetix eval.")
            changed, seed = imgui.input_int("###seed", draws.seed)
            widgets.probe(session, "agents.seed")
            if changed:
                session.queue(lambda: agents.set_draws(session, seed=max(seed, 0)))
            widgets.row("Attempt", "Each has draws of its own. N and B go on and back.")
            changed, attempt = imgui.input_int("###attempt", draws.attempt)
            widgets.probe(session, "agents.attempt")
            if changed:
                session.queue(lambda: agents.set_draws(session, attempt=max(attempt, 0)))

    def _compare(self, session: "Session") -> None:
        viewer = session.viewer
        if viewer.slots["b"].summary is None:
            return
        for index, (kind, label) in enumerate(COMPARE_LABELS.items()):
            if index:
                imgui.same_line()
            on = viewer.compare == kind
            if widgets.radio(session, f"agents.compare.{kind}", label, on):
                session.queue(f"agent.compare_{kind}")
        widgets.small("F6 plays A against B; Space plays you against B.")
        rival = viewer.rival
        if rival.failure:
            widgets.small(rival.failure, COLOURS.bad)

    def _overlays(self, session: "Session") -> None:
        settings = session.settings
        for name, (label, detail) in OVERLAYS.items():
            on = name in settings.agent_overlay
            changed, on = widgets.checkbox(session, f"agents.overlay.{name}", label, on)
            widgets.tooltip(label, detail)
            if changed:
                kept = [other for other in settings.agent_overlay if other != name]
                settings.agent_overlay = [*kept, name] if on else kept
            if name == "saliency" and on:
                self._about(session)
        if session.viewer.reasons.error:
            widgets.small(session.viewer.reasons.error, COLOURS.bad)

    def _about(self, session: "Session") -> None:
        """Draw the meaning of the rings."""
        reasons = session.viewer.reasons
        imgui.indent(px(22))
        for index, (about, label) in enumerate(_ABOUT.items()):
            if index:
                imgui.same_line()
            if widgets.radio(session, f"agents.about.{about}", label, reasons.about == about):
                reasons.about = about
        imgui.unindent(px(22))

    def _more(self, session: "Session") -> None:
        run = session.viewer.run
        if widgets.button(session, "agents.evaluate", "Evaluate…"):
            session.queue("level.evaluate")
        widgets.beside_words("Watch a training run…")
        if widgets.button(session, "agents.watch", "Watch a training run…"):
            session.queue("agent.watch_run")
        if run.path:
            with widgets.font(FONTS.mono, 0.0):
                widgets.small(run.path)
