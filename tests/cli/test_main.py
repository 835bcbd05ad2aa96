import resource
import subprocess
import sys

import pytest

from kinetix import cli
from kinetix.errors import LevelError


@pytest.fixture
def command(monkeypatch):
    """Lets a test stand in for the module of the sub-command `validate`."""

    def install(run):
        monkeypatch.setattr(cli, "_parse", lambda module, name, words: words)
        monkeypatch.setattr("kinetix.cli.validate.run", run)

    return install


def test_overview_names_every_command(capsys):
    assert cli.main(["--help"]) == 0
    text = capsys.readouterr().out
    assert [name for name in cli.COMMANDS if f"\n  {name} " not in text] == []


def test_no_command_is_wrong_usage_and_says_so_on_stderr(capsys):
    assert cli.main([]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "usage: kinetix COMMAND" in captured.err


def test_unknown_command_proposes_the_nearest(capsys):
    assert cli.main(["vaildate"]) == 2
    assert "did you mean 'validate'?" in capsys.readouterr().err


def test_unknown_argument_is_wrong_usage(capsys):
    assert cli.main(["validate", "--no-such-option"]) == 2
    assert "no-such-option" in capsys.readouterr().err


def test_help_of_a_command_is_no_failure(capsys):
    assert cli.main(["validate", "--help"]) == 0
    assert "usage: kinetix validate" in capsys.readouterr().out


def test_our_errors_are_one_sentence_and_status_one(command, capsys):
    def run(words):
        raise LevelError("lamp.json: $.bodies[3]: expected a body")

    command(run)
    assert cli.main(["validate"]) == 1
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", "lamp.json: $.bodies[3]: expected a body\n")


def test_file_errors_name_the_file(command, capsys, tmp_path):
    command(lambda words: (tmp_path / "none.json").read_text())
    assert cli.main(["validate"]) == 1
    assert capsys.readouterr().err == f"{tmp_path / 'none.json'}: No such file or directory\n"


def test_an_interrupt_ends_quietly(command, capsys):
    def run(words):
        raise KeyboardInterrupt

    command(run)
    assert cli.main(["validate"]) == 130
    assert capsys.readouterr().err == "interrupted\n"


def test_a_bug_is_not_hidden(command):
    def run(words):
        raise ZeroDivisionError

    command(run)
    with pytest.raises(ZeroDivisionError):
        cli.main(["validate"])


def test_overview_is_fast_and_free_of_jax():
    code = (
        "import sys; from kinetix.cli import main; main(['--help']); "
        "sys.exit(bool({'jax', 'tyro', 'numpy'} & set(sys.modules)))"
    )
    # Processor time, so that a busy machine does not fail the test.
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before < 0.4


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(cli.COMMANDS))
def test_every_command_describes_itself(name, capsys):
    assert cli.main([name, "--help"]) == 0
    assert f"usage: kinetix {name}" in capsys.readouterr().out
