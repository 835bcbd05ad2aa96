"""The app's command line: `kinetix-editor`, also `python -m editor`."""

import dataclasses
import importlib.util
import os
import signal
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import tyro

from editor.actions.files import reopen
from editor.actions.watching.agents import load_agent
from editor.base.settings import LARGEST_SIDE, SCALES, USUAL_SIZE, Settings, SettingsKeeper
from editor.documents.autosaves import Autosaves
from editor.documents.old_names import OldNames
from editor.gallery.kept_set import KeptSet
from editor.gallery.results import Results
from editor.session import Session
from editor.worker.bridge import keep_what_was_compiled
from kinetix.command_line.parse import parse
from kinetix.errors import KinetixError
from kinetix.failures import Terminated, ending_signals, guarded, leave, signals_to, terminable
from kinetix.files.compiled import mended_programs
from kinetix.paths import levels_dir, working_dir
from kinetix.version import __version__

if TYPE_CHECKING:
    from editor.hosts.pygame_host import PygameHost

_TOOLKIT: Final = ("pygame", "imgui_bundle")
"""Packages of the extra `editor`; training and evaluation do without."""
_DIGITS: Final = 9
"""Most digits of a size."""
_PARTING_SECONDS: Final = 0.3
"""Time that cancelled jobs get to leave when the app closes [s]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Options:
    """Draw, edit and play 2D physics levels."""

    files: Annotated[
        tyro.conf.Positional[tuple[str, ...]], tyro.conf.arg(metavar="FILE|ADDRESS …")
    ] = ()
    """Levels in either format, episodes (`.npz`), comparisons (`.json`); files or addresses."""
    agent: Path | None = None
    """An agent to load: its folder, a training run, or planner; F6 lets it play."""
    offscreen: bool = False
    """Draw in software into memory: no display is needed."""
    replay: Path | None = None
    """Feed the events of this file, then quit."""
    record: Path | None = None
    """Write what is done in the window to this file, for `--replay`; with the usual settings."""
    size: Annotated[str | None, tyro.conf.arg(metavar="WxH")] = None
    """Size of the window; by default the last one, at first 1440x900, as the screen has room."""
    scale: float | None = None
    """Scale of the interface, 0.75 to 3; by default as Preferences or the display say."""
    serve: bool = False
    """Show the app on a page in a browser instead of a window: no display is needed."""
    port: int | None = None
    """With --serve: the port; by default 8570, or a free one where that is taken."""
    address: str = "127.0.0.1"
    """With --serve: what to listen on; by default only this machine can open the page."""
    bench: bool = False
    """Measure how fast the app is, print the table, then quit."""


def _size(text: str | None) -> tuple[int, int]:
    if text is None:
        return USUAL_SIZE
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise KinetixError(f"--size {text}: expected WIDTHxHEIGHT, such as 1440x900")
    if max(len(width), len(height)) > _DIGITS or max(int(width), int(height)) > LARGEST_SIDE:
        raise KinetixError(f"--size {text}: expected at most {LARGEST_SIDE}x{LARGEST_SIDE}")
    return max(int(width), 320), max(int(height), 240)


def _welcome() -> Path | None:
    """Return the level that the app opens on when none is named, and none was open last time."""
    for name in ("l/rover_ridge", "s/first_flight"):
        path = levels_dir() / f"{name}.json"
        if os.path.isfile(path):
            return path
    return next(iter(sorted(levels_dir().glob("*/*.json"))), None)


def _host(options: Options, session: Session) -> "PygameHost":
    size = _size(options.size)
    if options.serve:
        from editor.hosts.web.host import WebHost

        return WebHost(
            session, size=size, scale=options.scale, address=options.address, port=options.port
        )
    if options.offscreen:
        from editor.hosts.offscreen import OffscreenHost

        return OffscreenHost(session, size=size, scale=options.scale or 1.0)
    from editor.hosts.pygame_host import PygameHost

    return PygameHost(session, size=None if options.size is None else size, scale=options.scale)


def _check(options: Options) -> None:
    """Refuse options that contradict each other or are out of range, before anything is opened.

    Raises:
        KinetixError: The options contradict each other or are out of range.
    """
    if options.serve and (options.replay is not None or options.bench):
        raise KinetixError("--serve shows the app to a person: leave out --replay and --bench")
    if not options.serve and (options.port is not None or options.address != "127.0.0.1"):
        raise KinetixError("--port and --address belong to --serve")
    if options.port is not None and not 0 <= options.port < 65536:
        raise KinetixError(f"--port {options.port}: expected 0 to 65535")
    low, high = SCALES
    if options.scale is not None and not low <= options.scale <= high:
        raise KinetixError(f"--scale {options.scale:g}: expected {low:g} to {high:g}, such as 1.5")


def _run(options: Options) -> int:
    _check(options)
    _stand_somewhere()
    if options.bench:
        from editor.hosts.bench import print_table

        print_table(_size(options.size))
        return 0
    scripted = options.replay is not None
    alone = scripted or (options.offscreen and not options.serve)
    # The usual settings, which nobody changes: a replay has the same language, panels and keys.
    usual = alone or options.record is not None
    settings = Settings() if usual else Settings.load()
    session = Session(
        settings=settings,
        keeper=SettingsKeeper(settings, stored=not usual),
        autosaves=Autosaves(stored=not alone),
        results=Results(stored=not alone),
        old_names=OldNames(stored=not alone),
        kept_set=KeptSet(stored=not usual),
    )
    host = _host(options, session)
    host.ui.asked_scale = options.scale
    status = 0
    try:
        _show(options, session, host)
    except KinetixError as error:
        sys.stderr.write(f"{error}\n")
        status = 1
    finally:
        session.autosaves.end()
        host.close()
        stop(session)
        if not alone:
            keep_what_was_compiled()
    return status


def stop(session: Session) -> None:
    """Call everything off that goes on in the background, and wait a moment for it to end."""
    for each in (session.worker, session.evaluator, session.library):
        each.stop(0.0)
    for each in (session.worker, session.evaluator):
        each.stop(_PARTING_SECONDS)


def end(status: int) -> int:
    """Leave, at once where a thread still works.

    Returns:
        The status, where none does.
    """
    if threading.active_count() > 1:
        # A compilation cannot be interrupted, and must not keep the app from closing.
        leave(status)
    return status


def _show(options: Options, session: Session, host: "PygameHost") -> None:
    _open_files(options, session)
    if options.agent is not None:
        load_agent(session, options.agent)
    if options.replay is not None:
        from editor.hosts.replay import Replayer

        Replayer(host, options.replay).run()
    elif options.offscreen and not options.serve:
        raise KinetixError(
            "--offscreen shows nothing by itself: give it --replay or --bench, or use --serve"
        )
    else:
        host.ui.warm_up = True
        _tell_of_settings(session)
        if options.record is None:
            session.play_quickly()
        else:
            # When a level's own step is ready is chance: the replay would play another one.
            host.ui.preparation.tailors = False
            from editor.hosts.recorder import Recorder

            host.recorder = Recorder(session, options.record)
        _until_closed(session, host)


def _until_closed(session: Session, host: "PygameHost") -> None:
    """Show the window until it is closed.

    Raises:
        Terminated: A signal closed it, without a question; unsaved levels are copied.
        KeyboardInterrupt: Ctrl+C in the terminal did the same.
    """
    told: list[BaseException] = []

    def close(number: int, _: object) -> None:
        if told:
            raise told[0]
        told.append(KeyboardInterrupt() if number == signal.SIGINT else Terminated())
        session.closing.done = True

    with signals_to(close, signal.SIGINT, *ending_signals()):
        try:
            host.run()
        except Exception:
            session.save_aside()
            raise
    if told:
        session.save_aside()
        session.training.stop()
    host.ui.save_layout()
    host.keep_size()
    reopen.note(session)
    session.keeper.save()
    session.kept_set.keep(session.gallery.tray)
    if told:
        raise told[0]


def _open_files(options: Options, session: Session) -> None:
    from editor.actions import guide
    from editor.actions.files import address, recover

    # Replays are asked nothing, so recordings are not either.
    asks = options.replay is None and options.record is None
    if not options.files:
        if asks:
            guide.offer(session)
        welcome = _welcome() if options.replay is None else None
        if not (asks and reopen.reopen(session)) and welcome is not None:
            with session.guard():
                reopen.open_quietly(session, welcome)
        if asks:
            recover.offer(session)
        return
    mark = session.log.serial
    opened = [address.open_any(session, words) for words in options.files]
    if not any(opened):
        *others, last = session.log.since(mark)
        for fault in others:
            sys.stderr.write(f"{fault}\n")
        raise KinetixError(last)
    if asks:
        recover.offer(session)


def _tell_of_settings(session: Session) -> None:
    """Report which of the user's settings and languages could not be read.

    The first change of a setting replaces its file.
    """
    from editor.actions.files import file
    from editor.base import language

    for fault in language.own_faults():
        session.toast(fault, "warning")
    if session.keeper.fault:
        told = (
            f"{session.keeper.fault}. The app starts with the default settings. Repair the file "
            "now: it will be replaced, and the old one is then kept as a .bak file beside it"
        )
        file.tell(session, "Preferences cannot be read", told)


def _stand_somewhere() -> None:
    """Go to the user's folder where the current one has been deleted."""
    try:
        Path.cwd()
    except FileNotFoundError:
        home = working_dir()
        os.chdir(home)
        sys.stderr.write(f"kinetix-editor: the current folder is gone; {home} takes its place\n")


def main() -> int:
    """Run the app.

    Returns:
        0, or 1 when what was asked for cannot be done (the reason is on stderr); 130 after Ctrl+C,
        143 after SIGTERM. With --serve both are the ordinary end: 0.
    """
    if sys.argv[1:] == ["--version"]:
        sys.stdout.write(f"{__version__}\n")
        return 0
    missing = [name for name in _TOOLKIT if importlib.util.find_spec(name) is None]
    if missing:
        sys.stderr.write(
            f"kinetix-editor: {' and '.join(missing)} not installed: "
            "pip install 'kinetix-editor[editor]'\n"
        )
        return 1
    # XLA warns on stderr about every compiled function that it finds in its cache.
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
    with terminable(), mended_programs():
        status = guarded(
            lambda: _run(parse(Options, program="kinetix-editor")),
            name="kinetix-editor",
            words=sys.argv[1:],
        )
        return end(status)


if __name__ == "__main__":
    sys.exit(main())
