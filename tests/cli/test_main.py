import dataclasses
import importlib
import json
import os
import resource
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest

from kinetix import cli
from kinetix.cli.shared.examples import EXAMPLES
from kinetix.command_line.options import _whole
from kinetix.errors import LevelError
from kinetix.failures import KEPT_REPORTS, TERMINATED, interrupts_later
from kinetix.level.codec import load_level, save_level


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


def test_an_unknown_command_of_the_second_level_is_one_sentence(capsys):
    assert cli.main(["train", "foo", "--out", "r2"]) == 2
    said = capsys.readouterr().err
    assert said == "kinetix train: 'foo' is not a command; there are accel, bc, dr, plr, ppo, sfl\n"
    assert cli.main(["levelset", "bulid"]) == 2
    said = capsys.readouterr().err
    assert said == "kinetix levelset: 'bulid' is not a command; did you mean 'build'?\n"


def test_a_mistyped_option_points_to_the_help_of_its_command(capsys):
    assert cli.main(["train", "ppo", "--out", "r0", "--lerning-rate", "1e-3"]) == 2
    said = capsys.readouterr().err
    assert "--learning-rate" in said and "kinetix train ppo --help" in said
    assert "kinetix ppo" not in said


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["validate", ""], 1),
        (["eval", "--agent", "noop", "--levels", ""], 1),
        (["levelset", "build", "x.json", "--levels", ""], 1),
        (["levelset", "build", "", "--levels", "s"], 2),
        (["dataset", "gather", "x", "--sources", ""], 1),
        (["dataset", "verify", ""], 2),
        (["sample", "--size", "s", "--count", "1", "--seed", "0", ""], 2),
        (["train", "ppo", "--levels", "s/goalkeeper", "--out", ""], 2),
        (["teach", "--size", "s", "--count", "1", "--out", ""], 2),
    ],
)
def test_an_empty_word_is_no_path(words, status, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(words) == status
    assert "got an empty word" in " ".join(capsys.readouterr().err.split())
    assert list(tmp_path.iterdir()) == []


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


def test_an_interrupted_process_ends_whatever_its_threads_still_do(tmp_path):
    """XLA compiles on after Ctrl+C, and crashes an interpreter that is taken down around it."""
    code = """
import sys, threading
from kinetix import cli

def run(words):
    threading.Thread(target=threading.Event().wait).start()  # as one that compiles
    raise KeyboardInterrupt

cli._main = run
sys.exit(cli.main())
"""
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, capture_output=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (130, b"interrupted\n")


def test_a_bug_is_one_sentence_and_a_report_without_personal_paths(
    command, capsys, tmp_path, monkeypatch
):
    home = tmp_path / "home" / "ada"
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))

    def run(words):
        raise ZeroDivisionError(f"{home}/private/level.json")

    command(run)
    assert cli.main(["validate", "/srv/ada/letters/x.json"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("kinetix: something went wrong that should not have (ZeroDivisionErr")
    report = Path(line.rsplit(" ", 1)[1]).read_text()
    assert "kinetix-editor" in report
    assert "ZeroDivisionError" in report
    assert 'File "' in report
    assert "x.json" in report
    assert not {word for word in ("ada", "private", "letters") if word in report}


def test_only_the_newest_reports_are_kept(command, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))

    def run(words):
        raise ZeroDivisionError

    command(run)
    for _ in range(KEPT_REPORTS + 3):
        cli.main(["validate"])
    assert len(list((tmp_path / "kinetix-editor" / "crashes").iterdir())) == KEPT_REPORTS


def test_nothing_that_a_file_says_steers_the_terminal(tmp_path, capsys):
    level = {
        "format": "kinetix-level",
        "version": 1,
        "name": "\x1b[2Jx\x9b3A\u202e\r",
        "next_id": 1,
    }
    (tmp_path / "x.json").write_text(json.dumps(level | {"\x1b]0;x\x07": 1}))
    cli.main(["validate", str(tmp_path / "x.json")])
    cli.main(["validate", str(tmp_path / "\x1b[31mx.json")])
    captured = capsys.readouterr()
    for text in (captured.out, captured.err):
        assert all(character.isprintable() or character == "\n" for character in text)


def _shell(line, **variables):
    environment = os.environ | variables
    command = f'set -o pipefail; kinetix() {{ {sys.executable} -m kinetix "$@"; }}; {line}'
    return subprocess.run(
        ["bash", "-c", command], capture_output=True, env=environment, check=False, timeout=60
    )


def test_a_reader_that_leaves_early_is_no_error():
    done = _shell("kinetix --help | head -1")
    assert done.stdout.startswith(b"usage: kinetix")
    assert done.stderr == b""
    done = _shell("kinetix validate s m l s m l | head -c 1")
    assert done.stderr == b""
    assert done.returncode in (0, 141)  # 1 would say that the levels are bad


@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-", "<&-"])
def test_a_command_without_its_streams_ends_as_with_them(closed, tmp_path):
    for name, status in (("s/first_flight", 0), ("s/nothing", 1)):
        shell = f"exec {shlex.quote(sys.executable)} -m kinetix validate {name} {closed}"
        done = subprocess.run(
            ["sh", "-c", shell],
            env=os.environ | {"XDG_STATE_HOME": str(tmp_path)},
            capture_output=True,
            check=False,
        )
        assert done.returncode == status
    assert not list(tmp_path.rglob("crashes"))


def test_an_ascii_terminal_gets_everything_too(tmp_path):
    level = {"format": "kinetix-level", "version": 1, "name": "Lämpe 灯", "next_id": 1, "ä": 1}
    (tmp_path / "灯.json").write_text(json.dumps(level))
    ascii_only = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"}
    done = _shell(f"kinetix validate {tmp_path}/*.json", **ascii_only)
    assert b"E005" in done.stdout
    assert done.stderr == b""
    done = _shell("kinetix validate --help", **ascii_only)
    assert done.returncode == 0
    assert b"Traceback" not in done.stderr


def test_the_help_ends_in_a_terminal_without_room():
    assert _shell("kinetix validate --help", COLUMNS="1").returncode == 0


def test_a_device_that_is_not_here_gets_one_sentence(tmp_path):
    line = "kinetix play s/first_flight --agent noop"
    done = _shell(line, JAX_PLATFORMS="cuda", XDG_STATE_HOME=str(tmp_path))
    assert done.returncode == 1
    told = done.stderr.splitlines()[-1]  # after what a slow machine says while it works
    assert told.startswith(b"kinetix: JAX_PLATFORMS=cuda: JAX does not run on that here")
    assert not list(tmp_path.rglob("crashes"))


def test_a_cache_that_cannot_be_written_is_left_alone(tmp_path):
    (tmp_path / "cache").write_text("a file")
    line = "kinetix sample --size s --count 1 --seed 1 out"
    alone = f"cd {tmp_path}; unset JAX_COMPILATION_CACHE_DIR; {line}"
    done = _shell(alone, XDG_CACHE_HOME=str(tmp_path / "cache"))
    assert done.returncode == 0
    assert b"Warning" not in done.stderr


@pytest.mark.parametrize("word", ["help", "version"])
def test_help_and_version_are_words_too(word, capsys):
    assert cli.main([f"--{word}"]) == 0
    expected = capsys.readouterr().out
    assert cli.main([word]) == 0
    assert capsys.readouterr().out == expected


def test_help_of_a_command(capsys):
    assert cli.main(["help", "convert"]) == 0
    assert "usage: kinetix convert" in capsys.readouterr().out


def test_a_path_from_home_is_meant_as_a_shell_takes_it(tmp_path, monkeypatch, capsys):
    """A shell expands no `~` in quotes, nor after `=`: it made a folder of that name."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    assert cli.main(["convert", "s/first_flight", "~/x.json"]) == 0
    assert (tmp_path / "x.json").exists() and not list((tmp_path / "here").iterdir())
    capsys.readouterr()
    assert cli.main(["validate", "~/x.json", "~/y.json"]) == 1
    assert f"{tmp_path / 'y.json'}" in capsys.readouterr().out


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


@pytest.mark.parametrize("seed", ["-1", "99999999999999999999"])
@pytest.mark.parametrize("words", [["solve", "s/first_flight"], ["play", "s/first_flight"]])
def test_a_seed_that_cannot_be_is_refused_before_anything_starts(words, seed, capsys):
    assert cli.main([*words, "--seed", seed]) == 1
    assert f"--seed {seed}: expected a whole number" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("word", "number"), [("12", 12), ("-3", -3), ("1e6", 1_000_000), ("2.5e3", 2500), ("1E+2", 100)]
)
def test_whole_numbers_are_read_as_people_write_them(word, number):
    assert _whole(word) == number


@pytest.mark.parametrize("word", ["1e-6", "1.5", "2.55e1", "one", "", "1e999"])
def test_what_is_no_whole_number_is_none(word):
    with pytest.raises(ValueError, match=f"expected a whole number, got '{word}'"):
        _whole(word)


def test_the_help_shows_what_an_option_takes_and_no_word_for_nothing(capsys):
    assert cli.main(["train", "ppo", "--help"]) == 0
    told = capsys.readouterr().out
    assert "--seed INT" in told and "--kind {entity_transformer," in told
    assert "{None" not in told
    assert cli.main(["convert", "a.json", "b.json", "--format", "foo"]) == 2
    assert "None" not in capsys.readouterr().err


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_are_command_lines(name):
    program, command, *words = shlex.split(EXAMPLES[name])
    assert program == "kinetix" and f"{command} {words[0]}".startswith(name)
    assert cli._parse(importlib.import_module(f"kinetix.cli.{command}"), command, words)


@pytest.mark.parametrize(
    ("words", "example"),
    [(["train"], "train"), (["train", "bc"], "train bc"), (["train", "ppo"], "train")],
)
def test_the_help_ends_with_an_example(words, example, capsys):
    assert cli.main([*words, "--help"]) == 0
    assert capsys.readouterr().out.endswith(f"\nExample: {EXAMPLES[example]}\n")
    assert cli.main([*words, "--no-such"]) == 2
    assert "Example" not in "".join(capsys.readouterr())


@pytest.mark.parametrize("words", [["validate"], ["levelset", "build"], ["train", "bc"]])
def test_the_help_shows_only_defaults_that_say_something(words, capsys):
    assert cli.main([*words, "--help"]) == 0
    told = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert ("(default: 0.8)" in told) == (words[-1] == "build")
    for nothing in ("(default: )", "(default: None)", "(default: False)", "(())", " ()", "(None)"):
        assert nothing not in told


def test_the_help_of_a_training_shows_the_values_that_it_takes_by_itself(capsys):
    assert cli.main(["train", "bc", "--help"]) == 0
    told = " ".join(capsys.readouterr().out.replace("│", " ").split())
    for name, value in {
        "anneal-lr": "True",
        "kind": "flat_mlp",
        "observation-type": "symbolic_flat",
        "learning-rate": "0.0005",
    }.items():
        assert f"({value})" in told.partition(f"--{name} ")[2].partition(" --")[0], name


def test_the_help_of_a_choice_says_what_each_word_means(capsys):
    assert cli.main(["train", "sfl", "--help"]) == 0
    told = " ".join(capsys.readouterr().out.replace("│", " ").split())
    said = told.partition("--learnability-mode")[2].partition("--rollout-episodes")[0]
    assert "True" not in said
    assert "for rollout_steps (timesteps)" in said.replace("`", "")


def test_an_interrupt_waits_for_imports():
    done = []
    with pytest.raises(KeyboardInterrupt), interrupts_later():
        os.kill(os.getpid(), signal.SIGINT)
        done.append(1)
    assert done == [1]


def test_a_search_for_data_that_the_system_ends_says_what_is_kept(tmp_path, monkeypatch, capsys):
    def ended(*_: object, **__: object) -> None:
        os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr("kinetix.training.imitation.teach.teach", ended)
    words = ["teach", "--size", "s", "--count", "20", "--out", str(tmp_path / "data")]
    assert cli.main(words) == TERMINATED
    assert "the same command goes on with the 256 levels under way" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["compare", "--agents", "--levels", "s/goalkeeper"], "--agents: expected an agent"),
        (["train", "ppo", "--levels", "--out", "runs/x"], "--levels: expected names"),
        (["convert", "", "x.json"], '"": expected a level, got an empty word'),
        (["eval", "--agent", "solution", "--levels", "s/first_flight"], "kinetix render"),
        (
            [
                "train",
                "plr",
                "--num-train-envs",
                "8",
                "--num-steps",
                "16",
                "--total-timesteps",
                "256",
                "--out",
                "x",
            ],
            "(num_steps, num_train_envs, outer_rollout_steps)",
        ),
    ],
)
def test_wrong_words_get_a_sentence_that_helps(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(words) == 1
    told = capsys.readouterr().err
    assert said in told and "should not have" not in told
    assert list(tmp_path.iterdir()) == []


def test_an_evaluation_says_what_it_does_where_nobody_looks(capsys):
    assert cli.main(["eval", "--agent", "noop", "--levels", "s/goalkeeper", "--attempts", "1"]) == 0
    told = capsys.readouterr().err
    assert "compiling" in told and "of 1 episode" in told


def test_a_recorded_solution_is_played(capsys, tmp_path):
    assert cli.main(["play", "s/first_flight", "--agent", "solution", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["outcome"] == "won"
    bare = tmp_path / "bare.json"
    save_level(load_level("s/first_flight").replace(solution=None), bare)
    assert cli.main(["play", str(bare), "--agent", "solution"]) == 1
    assert "bare.json: this level records no solution" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [["play"], ["render", "--steps", "2"]], ids=lambda words: words[0]
)
def test_a_solution_of_unknown_physics_is_told_with_its_place(capsys, tmp_path, words):
    level, file = load_level("s/first_flight"), tmp_path / "odd.json"
    assert level.solution is not None
    save_level(level.replace(solution=level.solution.replace(physics="foo")), file)
    out = [str(tmp_path / "out.png")] if words[0] == "render" else []
    assert cli.main([words[0], str(file), *out, *words[1:], "--agent", "solution"]) == 1
    said = "odd.json: $.solution.physics: unknown physics 'foo': expected one of"
    assert said in capsys.readouterr().err


def test_a_flag_that_no_algorithm_has_points_to_the_flags_of_this_one(capsys):
    assert cli.main(["train", "ppo", "--checkpoint-frequency", "4", "--out", "r0"]) == 2
    assert "kinetix train ppo --help" in capsys.readouterr().err


def test_of_an_unknown_observation_all_are_listed(capsys):
    assert cli.main(["bench", "speed", "--observation", "nope"]) == 1
    said = "observation 'nope': expected one of none, pixels, symbolic_flat,"
    assert said in capsys.readouterr().err


def test_every_command_takes_a_number_of_cores(capsys):
    for name in cli.COMMANDS:
        module = importlib.import_module(f"kinetix.cli.{name}")
        form = getattr(module, name.capitalize())
        for each in get_args(form) or (form,):
            kind = get_args(each)[0] if get_args(each) else each
            assert "cores" in {field.name for field in dataclasses.fields(kind)}, kind
    assert cli.main(["cache", "--cores", "1"]) == 0
    assert cli.main(["cache", "--cores", "0"]) == 1
    assert "cores = 0: expected a number of cores, at least 1" in capsys.readouterr().err
