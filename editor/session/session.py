"""All that the app currently is: open documents, selection, tool, camera, playback, what is asked.

Hosts feed events, panels read and queue, `editor.actions.update` applies the queue once a frame.
Nothing here knows a toolkit or JAX.
"""

import contextlib
import math
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import Any, TypeAlias

from editor.agents.local_training import LocalTraining
from editor.agents.random_play import Trial
from editor.agents.viewer import Viewer
from editor.base import controls
from editor.base.camera import Camera
from editor.base.events import NO_MODIFIERS, Modifiers, PointerEvent
from editor.base.journal import Journal
from editor.base.overlay import Mark
from editor.base.prompts import Prompt
from editor.base.settings import Settings, SettingsKeeper
from editor.base.wording import UNTITLED
from editor.documents.autosaves import Autosaves
from editor.documents.commands.base import Command, EntityId, Selection
from editor.documents.commands.bodies import posed
from editor.documents.document import Document, Outcome
from editor.documents.old_names import OldNames
from editor.editing.snapping import CATCH_PIXELS, RELEASE_PIXELS, Rules, Targets, targets
from editor.editing.tools import TOOLS
from editor.editing.tools.base import NOTHING, Driver, Tool
from editor.gallery.filing import MovedFile
from editor.gallery.kept_set import KeptSet
from editor.gallery.library import Library
from editor.gallery.results import Results
from editor.gallery.view import GalleryView
from editor.play.last_end import LastEnd
from editor.play.mode import Mode
from editor.play.motion import Motion
from editor.play.playback import Playback
from editor.play.simulator import Simulator
from editor.session.clipboard import Clipboard, MemoryClipboard
from editor.session.closing import Closing
from editor.session.films import Films
from editor.session.hands import Hands
from editor.session.messages import Kind, Messages, Toast
from editor.session.sound import Sound
from editor.session.tabs import Tab, Tabs
from editor.session.view import View
from editor.worker.fetches import Fetches
from editor.worker.jobs import Job, Worker, WorkerSimulator
from kinetix.errors import CommandError
from kinetix.level.model import Level

Queued: TypeAlias = str | Command | Callable[[], object]
"""An action's id, an edit, or a call."""


class Session:
    """The state of the app; see the module's docstring for who changes it when."""

    def __init__(  # noqa: PLR0913 - what tests replace
        self,
        *,
        settings: Settings | None = None,
        worker: Worker | None = None,
        simulator: Simulator | None = None,
        clipboard: Clipboard | None = None,
        level: Level | None = None,
        library: Library | None = None,
        results: Results | None = None,
        old_names: OldNames | None = None,
        evaluator: Worker | None = None,
        autosaves: Autosaves | None = None,
        keeper: SettingsKeeper | None = None,
        kept_set: KeptSet | None = None,
    ) -> None:
        self.settings = settings or Settings()
        self.worker = worker or Worker()
        self.evaluator = evaluator or Worker()
        """A second worker, so that an evaluation of minutes holds nothing up."""
        self.clipboard: Clipboard = clipboard or MemoryClipboard()
        self.playback = Playback(simulator or WorkerSimulator(self.worker))
        self.playback.physics = self.settings.physics
        self.motion = Motion()
        """Motion between two steps."""
        self.viewer = Viewer(self.worker, self.evaluator, WorkerSimulator(self.worker, "b"))
        """The agents, and how they are watched."""
        self.training = LocalTraining()
        """Training on the level in front."""
        self.trial = Trial(self.evaluator)
        """Findings about the level without a plan."""
        self.quick = False
        """True if Play may begin in a step that was compiled quickly; see `play_quickly`."""
        self.expected: Job | None = None
        """A job that the person waits for; its result is shown at once when it comes."""
        self.tabs = Tabs(Document(level or Level(name=UNTITLED)))
        self.tool: Tool = TOOLS["select"]
        self.tool_kept = False
        """True if the tool stays after it has made something (its key was pressed twice)."""
        self.driver = Driver(self)
        self.view = View()
        self.kept_set = kept_set or KeptSet(stored=False)
        """Writes the set that is put together in the gallery."""
        self.gallery = GalleryView(tray=self.kept_set.read())
        self.library = library or Library()
        """The levels that the gallery shows."""
        self.fetches = Fetches()
        """Levels that are being fetched from addresses."""
        self.results = results or Results()
        """Results of players on levels."""
        self.autosaves = autosaves or Autosaves(clock=lambda: self.time)
        """Copies of unsaved levels."""
        self.keeper = keeper or SettingsKeeper(self.settings, stored=False)
        """Writes the settings."""
        self.old_names = old_names or OldNames()
        """Names from earlier versions that no level file holds yet."""
        self.messages = Messages(lambda: self.time)
        self.hands = Hands()
        self.attended = False
        """True if a person sits before a window: sounds and effects are for people alone."""
        self.sound = Sound()
        self.hovered: EntityId | None = None
        """Entity under the pointer."""
        self.highlighted: Selection = ()
        """Entities that a panel or menu points at."""
        self.seed = 0
        """Seed of the last random level or mutation."""
        self.fps = 0.0
        """Frames a second, as the host measures."""
        self.time = 0.0
        """The session's clock [s]."""
        self.closing = Closing()
        """Its question, its wait, and whether the app may end."""
        self.last_end = LastEnd()
        """The last episode that ended."""
        self.films = Films()
        """Films that are not in their files yet."""
        self.discarded: tuple[MovedFile, ...] = ()
        """Copies of unsaved work that were discarded last, in the trash."""
        self.screenshot: Path | None = None
        """File for the host to save a picture of the window in; it clears this when done."""
        self.probe: dict[str, Any] = {}
        """Rectangles of widgets by id, for tests and replays; the window fills it."""
        self.last_click: PointerEvent | None = None
        """The last click that selected, to notice a second one at the same place."""
        self._queue: list[Queued] = []
        self._targets: tuple[Level, frozenset[EntityId], Targets] | None = None
        self._posed: tuple[Any, Level, Level] | None = None

    @property
    def tab(self) -> Tab:
        """The tab in front."""
        return self.tabs.front

    @property
    def prompts(self) -> list[Prompt]:
        """Questions to the user, the uppermost last; answer with `answer`."""
        return self.messages.prompts

    @property
    def toasts(self) -> list[Toast]:
        """Short messages on the screen."""
        return self.messages.toasts

    @property
    def log(self) -> Journal:
        """All messages."""
        return self.messages.log

    @property
    def document(self) -> Document:
        """The document in front: the level, or a moment of an episode that is being changed."""
        moment = self.tab.moment
        return self.tab.document if moment is None else moment.document

    @property
    def camera(self) -> Camera:
        """View of the canvas."""
        return self.tab.camera

    @camera.setter
    def camera(self, camera: Camera) -> None:
        self.tab.camera = camera

    @property
    def mode(self) -> Mode:
        """Edit, playing, paused, ended or replay."""
        return self.playback.mode

    @property
    def editing(self) -> bool:
        """True if the document can be changed."""
        return self.playback.mode is Mode.EDIT

    @property
    def selection(self) -> Selection:
        """Selected ids of the document in front."""
        return self.document.selection

    @selection.setter
    def selection(self, selection: Selection) -> None:
        self.document.selection = selection

    @property
    def scene(self) -> Level:
        """Level on the canvas: the document with a gesture's preview, or the simulated state."""
        playback = self.playback
        if not playback.active or playback.level is None:
            return self.document.shown
        shown = self.motion.moment or playback.snapshot
        if shown is None:
            return playback.level
        level, known = playback.level, self._posed
        if known is None or known[0] is not shown or known[1] is not level:
            known = self._posed = (shown, level, posed(level, shown))
        return known[2]

    @property
    def marks(self) -> tuple[Mark, ...]:
        """Marks of the tool on top."""
        return self.driver.feedback.marks if self.editing else ()

    @property
    def metres(self) -> float:
        """Metres per pixel of the canvas at 100 %."""
        return self.view.scale / self.camera.scale

    @property
    def angle_step(self) -> float:
        """Grid of angles [rad]."""
        return math.radians(self.settings.angle_step_deg)

    def rules(self, modifiers: Modifiers = NO_MODIFIERS) -> Rules:
        """Return active snaps; Ctrl inverts them."""
        smart = self.settings.snap_smart != modifiers.ctrl
        grid = self.settings.snap_grid != modifiers.ctrl
        return Rules(
            smart=smart,
            grid=self.settings.grid_step if grid else None,
            catch=CATCH_PIXELS * self.metres,
            release=RELEASE_PIXELS * self.metres,
        )

    def targets(self, moving: Collection[EntityId] = ()) -> Targets:
        """Points to snap to, hidden and moving bodies left out; kept while nothing changes."""
        level, without = self.document.level, frozenset(moving) | self.document.hidden
        if self._targets is None or self._targets[0] is not level or self._targets[1] != without:
            self._targets = (level, without, targets(level, without))
        return self._targets[2]

    @property
    def quitting(self) -> bool:
        """True if the app may end."""
        return self.closing.done

    @property
    def hint(self) -> str:
        """Instruction for the status bar."""
        return self.driver.feedback.hint or self.tool.hint

    @property
    def action(self) -> tuple[int, ...]:
        """Action of the held keys."""
        return controls.action_of(self.hands.held, {**self.control_keys, **controls.PAD})

    @property
    def control_keys(self) -> dict[str, controls.Drive]:
        """The play keys, rebound ones included."""
        stored = self.settings.controls.items()
        rebound = {
            key: drive
            for key, pair in stored
            for drive in controls.DEFAULT_KEYS.values()
            if pair == [drive.channel, drive.value]
        }
        return rebound or dict(controls.DEFAULT_KEYS)

    def queue(self, item: Queued) -> None:
        """Do something after this frame has been drawn: an action's id, a command or a call."""
        self._queue.append(item)

    def take_queue(self) -> list[Queued]:
        """Empty the queue; `editor.actions.update` does what it holds."""
        queued, self._queue = self._queue, []
        return queued

    def execute(self, command: Command, *, on: Document | None = None) -> Outcome:
        """Commit a command now; selects what it made; an error becomes a toast.

        Args:
            command: The edit.
            on: The level that was asked about, if another one may be in front by now; None: the
                one in front.
        """
        document = self.document if on is None else on
        self.messages.crashes.note(command.label)
        with self.guard():
            if document is self.document and not self.editing:
                raise CommandError("Stop playing first: only Edit changes the level.")
            if document is self.document:
                self.driver.settle()
            outcome = document.commit(command, time=self.time)
            if outcome.created:
                bodies = {body.id for body in document.level.bodies}
                made = tuple(i for i in outcome.created if i in bodies)
                document.selection = made or outcome.created
            for notice in outcome.notices:
                self.toast(notice)
            return outcome
        return Outcome(changed=False)

    def save_aside(self) -> None:
        """Copy every unsaved level now: what comes next may end the app."""
        try:
            for document in self.tabs.documents:
                self.autosaves.keep(document)
            self.autosaves.flush()
        except Exception as error:
            self.toast(str(error), "error")

    @contextlib.contextmanager
    def guard(self) -> Iterator[None]:
        """Turn an exception into a toast, and an unexpected one into a log entry besides."""
        try:
            yield
        except Exception as error:
            self.messages.report(error, before=self.save_aside)
            self.document.discard_preview()

    def toast(self, text: str, kind: Kind = "info", *, action: str | None = None) -> None:
        """Show a message for a few seconds; the same message is not stacked.

        One that offers to undo is about the latest edit of the level in front, and offers it until
        another edit is the latest or another level is in front.
        """
        document, level = self.document, self.document.level

        def offered() -> bool:
            unmoved = self.document is document and document.level is level
            return action != "edit.undo" or unmoved

        self.messages.toast(text, kind, action=action, offered=offered)

    def complain(self, text: str) -> None:
        """Show why something was not done."""
        self.toast(text, "warning")

    def ask(self, prompt: Prompt) -> None:
        """Put a question before the user."""
        self.driver.cancel()
        self.prompts.append(prompt)

    def answer(self, prompt: Prompt, value: Any) -> None:
        """Take a question away and hand its answer on (a choice's id, a path, or None)."""
        if prompt in self.prompts:
            self.prompts.remove(prompt)
            with self.guard():
                prompt.answer(value)

    def choose_tool(self, tool_id: str) -> None:
        """Take another tool; choosing the present one again keeps it for several uses."""
        tool = TOOLS[tool_id]
        self.driver.cancel()
        self.tool_kept = tool is self.tool and not self.tool_kept
        self.tool = tool
        self.driver.feedback = NOTHING

    def tool_done(self) -> None:
        """A tool has made something: Select takes over unless the tool is kept."""
        if not (self.tool_kept or self.settings.keep_tool):
            self.tool, self.tool_kept = TOOLS["select"], False

    def open_tab(self, document: Document) -> None:
        """Show a document in a new tab; an untouched empty one is replaced."""
        self.leave_play()
        self.gallery.open = False
        self.tabs.open(document)

    def show_tab(self, index: int) -> None:
        """Bring a tab to the front."""
        if index != self.tabs.index_in_front and 0 <= index < len(self.tabs):
            self.leave_play()
            self.tabs.index_in_front = index

    def close_tab(self, tab: Tab) -> None:
        """Take a tab away without asking; the last one leaves an empty level."""
        if tab is self.tab:
            self.leave_play()
        self.tabs.close(tab)

    def play_quickly(self) -> None:
        """Let episodes begin in a step that was compiled quickly, until a better one is ready.

        Which of the two an episode gets is chance, and they round differently: what has to come
        out the same again (scripts, films of them) does without.
        """
        self.quick = True
        for simulator in (self.playback.simulator, self.viewer.rival.simulator):
            if isinstance(simulator, WorkerSimulator):
                simulator.quick = True

    def leave_play(self) -> None:
        """Drop gestures, and what a field previews, and stop playing, an opened attempt too."""
        self.driver.cancel()
        self.document.discard_preview()
        self.hands.pull = self.expected = None
        if self.playback.active or self.playback.suspended:
            self.playback.stop()
        self.viewer.guest = None
        self.viewer.rival.stop()

    def take_expected(self, job: Job) -> bool:
        """Return whether the person waits for a job that has ended; from now on nobody does."""
        awaited = self.expected is job
        if awaited:
            self.expected = None
        return awaited

    def leave_moment(self, tab: Tab | None = None) -> None:
        """Go back to the level from a paused episode that was being changed.

        Args:
            tab: Whose episode; by default that of the tab in front.
        """
        leaving = tab or self.tab
        leaving.moment = None
        if leaving is self.tab and self.playback.suspended:
            self.playback.stop()

    def release_all(self) -> None:
        """The window lost the keyboard: nothing is held any more, nothing is under way."""
        self.hands.release()
        self.driver.cancel()

    def state_record(self) -> dict[str, Any]:
        """Return the record that a replay's `state` event writes."""
        document, playback = self.document, self.playback
        return {
            "mode": self.mode.value,
            "selection": list(self.selection),
            "dirty": document.dirty,
            "undo": document.history.undo_label,
            "redo": document.history.redo_label,
            "level_hash": document.hash,
            "step": playback.step_count,
            "outcome": playback.outcome,
            "fps": round(self.fps, 1),
            "problems": [issue.code for issue in document.problems],
        }
