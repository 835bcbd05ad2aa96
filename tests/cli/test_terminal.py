"""Lines that stay and words that pass, on a terminal and in a file."""

import subprocess
import sys
import time
import types

from kinetix.cli.shared import terminal as terminals
from kinetix.cli.shared.measured import watched
from kinetix.cli.shared.terminal import Terminal, announced, counted
from kinetix.training import progress_text
from kinetix.training.progress_text import now_and_then


def test_on_a_terminal_passing_words_leave_nothing_behind(capsys, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    terminal = Terminal()
    terminal.status("scoring 1/4")
    terminal.status("scoring 2/4")
    terminal.say("1/8  512 steps")
    terminal.say("2/8  1,024 steps")
    terminal.status("evaluating 0/20 episodes")
    terminal.close()
    told = capsys.readouterr().err
    assert told == (
        "\r\x1b[Kscoring 1/4 …\r\x1b[Kscoring 2/4 …\r\x1b[K1/8  512 steps\n2/8  1,024 steps\n"
        "\r\x1b[Kevaluating 0/20 episodes …\r\x1b[K"
    )


def test_in_a_file_they_are_lines_without_escapes(capsys):
    terminal = Terminal()
    terminal.status("compiling: update")
    terminal.say("done")
    terminal.close()
    assert capsys.readouterr().err == "compiling: update\ndone\n"


def test_what_takes_long_is_counted(capsys, monkeypatch):
    monkeypatch.setattr(terminals, "PATIENCE", -1.0)
    terminal = Terminal()
    made = counted(iter("abc"), "compiling", lambda number: f"{number} letters", terminal)
    assert list(made) == ["a", "b", "c"]
    terminal.close()
    assert "2 letters\n" in capsys.readouterr().err
    assert list(counted(iter(""), "compiling", str, terminal)) == []


def test_each_kind_of_work_is_said_at_once_and_then_now_and_then(monkeypatch):
    clock, said = [100.0], []
    monkeypatch.setattr(progress_text.time, "monotonic", lambda: clock[0])
    status = now_and_then(said.append)
    for number in (1, 2, 3, 4, 4, 4, 4, 4):
        status(f"scoring {number}/4")
        clock[0] += 4.0
    status("compiling: start")
    status("compiling: update")
    assert said == ["scoring 1/4", "scoring 4/4", "compiling: start", "compiling: update"]


def test_what_takes_long_is_announced_and_what_does_not_is_not(capsys):
    with announced("compiling", after=0.01):
        time.sleep(0.2)
    assert capsys.readouterr().err == "compiling\n"
    with announced("compiling", after=5.0):
        pass
    assert "0 of 0" not in capsys.readouterr().err


def test_a_command_goes_on_when_nobody_reads_it_any_more(tmp_path):
    code = (
        "import sys; from pathlib import Path; from kinetix.cli.shared.terminal import Terminal\n"
        "terminal = Terminal()\n"
        "sys.stdin.readline()\n"
        "for _ in range(3): terminal.say('x')\n"
        "Path(sys.argv[1]).touch()\n"
    )
    ends = tmp_path / "ends"
    with subprocess.Popen(
        [sys.executable, "-c", code, str(ends)],
        stdin=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        process.stderr.close()
        process.stdin.write("\n")
        process.stdin.flush()
        assert process.wait() == 0
    assert ends.exists()


def test_of_a_measurement_of_nothing_there_is_no_progress(capsys):
    def measured(total):
        yield types.SimpleNamespace(done=0, total=total)

    assert watched(measured(0)).total == 0
    assert "0 of 0" not in capsys.readouterr().err
    watched(measured(2))
    assert "0 of 2 episodes" in capsys.readouterr().err
