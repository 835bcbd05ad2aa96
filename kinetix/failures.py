"""The last resort of every command: output that cannot fail, one sentence, a crash report."""

import contextlib
import datetime
import os
import platform
import re
import signal
import sys
import threading
import traceback
import uuid
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final, NoReturn, TextIO

from kinetix.errors import KinetixError, plain
from kinetix.paths import state_dir

INTERRUPTED: Final = 130
"""Exit status after Ctrl+C."""
TERMINATED: Final = 143
"""Exit status after SIGTERM."""
UNREAD: Final = 141
"""Exit status where nobody reads what is printed any more, as of a process that SIGPIPE ends."""
KEPT_REPORTS: Final = 20
"""Of more crash reports the oldest are deleted."""
_PLATFORMS: Final = "JAX_PLATFORMS"
_LONGEST_REPORT: Final = 200_000
_UNSAFE: Final = {
    code: f"\\u{code:04x}"
    for code in (*range(0x20), *range(0x7F, 0xA0), *range(0x202A, 0x202F), *range(0x2066, 0x206A))
    if chr(code) not in "\n\t"
}
"""Characters that must not reach a terminal from a file; `plain` escapes the same in sentences."""
_ABSOLUTE: Final = re.compile(r"(?<![\w<.])(?:~|[A-Za-z]:)?(?:[/\\][^/\\\s'\":,;()<>]+){2,}")


class Terminated(BaseException):
    """The system asked the process to end (SIGTERM, or its terminal was closed)."""


def _terminate(*_: object) -> None:
    raise Terminated


@contextlib.contextmanager
def signals_to(handler: Callable[..., None], *numbers: int) -> Iterator[None]:
    """Install a handler for the block; the previous handlers are restored afterwards.

    Outside the main thread, where Python takes no signals, nothing changes. What is ignored stays
    so: closed terminals by `nohup`, Ctrl+C by shells that start a command in the background.

    Args:
        handler: Called with the signal's number and a stack frame.
        numbers: The signals.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard = [each for each in numbers if signal.getsignal(each) != signal.SIG_IGN]
    before: list[tuple[int, Any]] = [(each, signal.signal(each, handler)) for each in heard]
    try:
        yield
    finally:
        for number, had in before:
            # None: somebody installed it from C, and it cannot be put back.
            signal.signal(number, signal.SIG_DFL if had is None else had)


@contextlib.contextmanager
def signals_later(*numbers: int) -> Iterator[None]:
    """Let signals wait for the end of a block that an exception would leave half done.

    Imports and frames are such blocks. A second signal does not wait.

    Args:
        numbers: The signals.
    """
    asked: list[int] = []
    handlers = contextlib.ExitStack()

    def wait(number: int, _: object) -> None:
        asked.append(number)
        if len(asked) > 1:
            end()

    def end() -> None:
        handlers.close()
        if asked:
            number = asked[0]
            asked.clear()
            signal.raise_signal(number)

    handlers.enter_context(signals_to(wait, *numbers))
    try:
        yield
    finally:
        end()


def interrupts_later() -> contextlib.AbstractContextManager[None]:
    """Let Ctrl+C wait for the end of a block, as `signals_later` does."""
    return signals_later(signal.SIGINT)


def ending_signals() -> tuple[int, ...]:
    """Return the signals that ask a process to end: SIGTERM, and that of a terminal that closes.

    Windows has none of the second kind.
    """
    return tuple(filter(None, (signal.SIGTERM, getattr(signal, "SIGHUP", None))))


def terminable() -> contextlib.AbstractContextManager[None]:
    """Let `ending_signals` raise `Terminated`, which libraries with windows keep to themselves."""
    return signals_to(_terminate, *ending_signals())


class PlainStream:
    """A text stream whose text cannot steer the terminal."""

    def __init__(self, stream: TextIO, *, overwrites: bool = False) -> None:
        """Wrap a stream.

        Args:
            stream: The stream.
            overwrites: Whether carriage returns pass, as a line of progress needs them.
        """
        self._stream = stream
        self._table = {k: v for k, v in _UNSAFE.items() if not (overwrites and k == ord("\r"))}

    def write(self, text: str) -> int:
        """Write a text with control characters escaped."""
        self._stream.write(text.translate(self._table))
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


@contextlib.contextmanager
def plain_streams() -> Iterator[None]:
    """Let nothing that is printed inside steer the terminal or fail for want of a character."""
    before = sys.stdout, sys.stderr
    for stream in before:
        encodable(stream)
    sys.stdout, sys.stderr = PlainStream(before[0]), PlainStream(before[1], overwrites=True)  # pyright: ignore[reportAttributeAccessIssue]
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def encodable(stream: TextIO) -> None:
    """Make a stream escape what its encoding lacks: ASCII terminals, names that are not UTF-8."""
    reconfigure = getattr(stream, "reconfigure", None)
    if reconfigure is not None and getattr(stream, "errors", "") in ("strict", "surrogateescape"):
        reconfigure(errors="backslashreplace")


def guarded(command: Callable[[], int], *, name: str, words: Sequence[str]) -> int:
    """Run a command so that no exception leaves it as a traceback.

    Args:
        command: What to run.
        name: What the sentence begins with, such as `kinetix`.
        words: The command line, for the crash report.

    Returns:
        The exit status: the command's own, or 1 after an error, 130 after Ctrl+C, 141 if the
        process that read what is printed has had enough, 143 after SIGTERM.
    """
    _open_streams()
    for stream in (sys.stdout, sys.stderr):
        encodable(stream)
    try:
        status = command()
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader has had enough (`| head -1`). Python would complain once more at its end.
        mute(sys.stdout)
        return UNREAD
    except BaseException as error:
        sentence, status = _told(error, name, words)
        with contextlib.suppress(OSError):
            print(sentence, file=sys.stderr)  # noqa: T201 (a command's own output)
    return status


def leave(status: int) -> NoReturn:
    """End the process at once: nothing that another thread still does is waited for.

    XLA goes on compiling in threads of its own after Ctrl+C, and crashes an interpreter that is
    taken down around it.
    """
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(status)


def mute(stream: TextIO) -> None:
    """Let a stream lead nowhere from here on: nobody is there to read it."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def _open_streams() -> None:
    """Let what was closed before the start (`>&-`) lead nowhere.

    A file that is opened would take its number, and receive the messages of libraries.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the smallest free number is this one
    sys.stdout = sys.stdout or open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = sys.stderr or open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115


def _told(error: BaseException, name: str, words: Sequence[str]) -> tuple[str, int]:
    """Return one sentence for what ended a command, and the exit status."""
    match error:
        case SystemExit():
            raise error
        case KinetixError():
            return str(error), 1
        case KeyboardInterrupt():
            return "interrupted", INTERRUPTED
        case Terminated():
            return "terminated", TERMINATED
        case OSError():
            return plain(_file_error(error)), 1
        case MemoryError():
            return f"{name}: not enough memory", 1
    if "RESOURCE_EXHAUSTED" in str(error):  # JAX has a type of its own, and other words behind it
        return f"{name}: not enough memory: {plain(str(error), 200)}", 1
    if _cannot_compute():
        return (
            f"{name}: JAX_PLATFORMS={os.environ[_PLATFORMS]}: JAX does not run on that here; "
            "unset the variable, or set it to cpu"
        ), 1
    return crash_sentence(error, name, words), 1


def _cannot_compute() -> bool:
    """Return whether the user asked JAX for a device that is not here."""
    if "jax" not in sys.modules or not os.environ.get(_PLATFORMS):
        return False
    try:
        sys.modules["jax"].devices()
    except Exception:  # JAX raises errors of many types here, some without a word
        return True
    return False


def crash_sentence(error: BaseException, name: str, words: Sequence[str]) -> str:
    """Write a crash report and print its path.

    Args:
        error: What nobody expected.
        name: What the sentence begins with.
        words: The command line, or the last actions.
    """
    what = plain(f"{type(error).__name__}: {error}", 200)
    sentence = f"{name}: something went wrong that should not have ({what})"
    path = write_report(error, words)
    where = "no report could be written" if path is None else f"a report is in {path}"
    return f"{sentence}; {where}"


def write_report(error: BaseException, words: Sequence[str]) -> Path | None:
    """Write what is needed to find a fault: version, traceback, last words; no personal paths.

    Args:
        error: What nobody expected.
        words: The command line, or the last actions.

    Returns:
        The file, or None where none could be written.
    """
    folder = state_dir() / "crashes"
    now = datetime.datetime.now()
    path = folder / f"{now:%Y-%m-%d_%H-%M-%S}_{uuid.uuid4().hex[:6]}.txt"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for old in sorted(folder.glob("*.txt"))[: -KEPT_REPORTS + 1]:
            old.unlink(missing_ok=True)
        text = report_text(error, words)
        path.write_text(text, encoding="utf-8", errors="backslashreplace")
    except OSError:
        return None
    return path


def report_text(error: BaseException, words: Sequence[str]) -> str:
    """Return the text of a crash report.

    Args:
        error: What nobody expected.
        words: The command line, or the last actions.
    """
    import importlib.metadata

    versions = [f"Python {platform.python_version()} on {platform.system()} {platform.machine()}"]
    for package in ("kinetix-editor", "jax", "numpy", "imgui-bundle", "pygame"):
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):
            versions.append(f"{package} {importlib.metadata.version(package)}")
    trace = "".join(traceback.format_exception(error))
    if len(trace) > _LONGEST_REPORT:
        trace = f"{trace[: _LONGEST_REPORT // 2]}\n…\n{trace[-_LONGEST_REPORT // 2 :]}"
    lines = [*versions, "", "last words:", *(f"  {plain(word)}" for word in words), "", trace]
    return _without_paths("\n".join(lines))


def _without_paths(text: str) -> str:
    """Return a text in which paths reveal nothing about the machine and its user."""
    package = Path(__file__).resolve().parent
    known = {str(package.parent): "<kinetix>", sys.prefix: "<python>", sys.base_prefix: "<python>"}
    with contextlib.suppress(RuntimeError):
        known[str(Path.home())] = "~"
    for place, tag in sorted(known.items(), key=lambda pair: -len(pair[0])):
        if len(place) > 1:
            text = text.replace(place, tag)
    return _ABSOLUTE.sub(lambda match: "…/" + re.split(r"[/\\]", match[0])[-1], text)


def _file_error(error: OSError) -> str:
    reason = error.strerror or str(error) or type(error).__name__
    return f"{error.filename}: {reason}" if error.filename is not None else reason
