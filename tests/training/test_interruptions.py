"""Runs that are damaged, stopped, written to by others, or find the disk full."""

import json
import os
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest

from kinetix.agents.checkpoint import steps_of_run
from kinetix.agents.evaluate import Progress
from kinetix.errors import KinetixError
from kinetix.failures import Terminated
from kinetix.files.lock import locked_folder
from kinetix.training.logging import read_metrics
from kinetix.training.ppo.train import Ppo
from kinetix.training.ppo.update import GRADIENT
from kinetix.training.resume import PROGRESS, StoredProgress, read_newest, write_state
from kinetix.training.run import train
from kinetix.training.stopping import stop_requests
from tests.training.tiny import same_parameters, tiny_config, without_time

pytestmark = pytest.mark.usefixtures("shared_trainers")


def _flip_a_number(checkpoint):
    """Four bytes of the state are others, and nothing of the file format can tell."""
    progress = json.loads((checkpoint / PROGRESS).read_text())
    assert StoredProgress(**progress).digest
    (checkpoint / PROGRESS).write_text(json.dumps(progress | {"digest": "0" * 64}))


_DAMAGES = {
    "digest": _flip_a_number,
    "progress cut": lambda folder: (folder / "progress.json").write_text('{"updates": 6, "se'),
    "progress of another type": lambda folder: (folder / "progress.json").write_text('{"a": []}'),
    "progress gone": lambda folder: (folder / "progress.json").unlink(),
    "arrays gone": lambda folder: shutil.rmtree(folder / "state" / "d"),
    "arrays cut": lambda folder: [
        path.write_bytes(path.read_bytes()[:20])
        for path in (folder / "state").rglob("*")
        if path.is_file()
    ],
    "card gone": lambda folder: ((folder / "agent.json").unlink(), shutil.rmtree(folder / "state")),
}


@pytest.mark.parametrize("damage", _DAMAGES.values(), ids=_DAMAGES)
def test_a_damaged_checkpoint_is_named_and_the_one_before_resumes(finished, tmp_path, damage):
    run = shutil.copytree(finished, tmp_path / "run")
    damage(run / "checkpoints" / "192")
    said = []
    train("ppo", tiny_config("ppo", dummy_env=True), run, say=said.append)
    assert any("192" in text and "damaged" in text for text in said), said
    assert "resuming from update 4 of 6" in said
    assert without_time(read_metrics(run)) == without_time(read_metrics(finished))
    same_parameters(finished, run)
    assert (run / "checkpoints" / "192.damaged").is_dir()


def test_a_training_that_diverges_ends_and_keeps_what_it_had(tmp_path, monkeypatch):
    norms, usual = iter([1.0, float("nan")]), Ppo.update

    def update(self, state):
        state, metrics = usual(self, state)
        return state, metrics | {GRADIENT: next(norms)}

    monkeypatch.setattr(Ppo, "update", update)
    with pytest.raises(KinetixError, match="update 2: the gradient is not finite"):
        train("ppo", tiny_config("ppo", dummy_env=True, checkpoint_save_freq=1), tmp_path / "run")
    assert steps_of_run(tmp_path / "run") == [32]


def test_no_run_starts_again_where_its_states_are_damaged(finished, tmp_path):
    run = shutil.copytree(finished, tmp_path / "run")
    for step in ("128", "192"):
        (run / "checkpoints" / step / "progress.json").write_text("")
    with pytest.raises(KinetixError, match="none of its training states can be read"):
        train("ppo", tiny_config("ppo", dummy_env=True), run)
    assert read_metrics(run) == read_metrics(finished)
    assert steps_of_run(run) == [64, 128, 192]


def test_states_of_other_levels_are_not_called_damaged(tmp_path):
    folder = tmp_path / "checkpoints" / "32"
    folder.mkdir(parents=True)
    stored = StoredProgress(updates=1, seconds=0.0, levels="before")
    write_state(folder, {"a": np.zeros(3)}, stored)
    for shape, levels in ((3, "before"), (3, "now")):
        found = read_newest(tmp_path, lambda n=shape: {"a": np.zeros(n)}, print, levels=levels)
        assert found is not None and found[1].on_others(levels) is (levels == "now")
    said = []
    with pytest.raises(KinetixError, match="the files of the levels have changed"):
        read_newest(tmp_path, lambda: {"a": np.zeros(4)}, said.append, levels="now")
    assert "damaged" not in " ".join(said)
    with pytest.raises(KinetixError, match="being damaged or of another version"):
        read_newest(tmp_path, lambda: {"a": np.zeros(4)}, print, levels="before")


def test_two_trainings_do_not_write_to_one_run(finished):
    with locked_folder(finished, "another training"):
        code = (
            "import sys; from pathlib import Path; from kinetix.errors import KinetixError\n"
            "from kinetix.files.lock import locked_folder\n"
            "try:\n    locked_folder(Path(sys.argv[1]), 'another training').__enter__()\n"
            "except KinetixError as error: print(error)\n"
        )
        done = subprocess.run(
            [sys.executable, "-c", code, str(finished)], capture_output=True, text=True, check=True
        )
    assert "another training writes here now" in done.stdout


_DAMAGES_OF_AGENTS = {
    "parameters cut": lambda folder: [
        path.write_bytes(path.read_bytes()[:20])
        for path in (folder / "params").rglob("*")
        if path.is_file()
    ],
    "card gone": lambda folder: (folder / "agent.json").unlink(),
}


@pytest.mark.parametrize("damage", _DAMAGES_OF_AGENTS.values(), ids=_DAMAGES_OF_AGENTS)
def test_a_damaged_agent_is_named_and_made_again_from_the_state(finished, tmp_path, damage):
    run = shutil.copytree(finished, tmp_path / "run")
    damage(run / "checkpoints" / "192")
    said = []
    train("ppo", tiny_config("ppo", dummy_env=True), run, say=said.append)
    assert any("192" in text and "damaged agent" in text for text in said), said
    assert "all 6 updates are done; more total_timesteps go on from here" in said
    same_parameters(finished, run)


def test_a_hang_up_that_nohup_ignores_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with stop_requests(print) as request:
            os.kill(os.getpid(), signal.SIGHUP)
            assert request.signal is None
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_second_interruption_says_where_the_run_goes_on():
    told = []
    with pytest.raises(KeyboardInterrupt), stop_requests(told.append):
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)
    first, second = told
    assert "once more stops at once" in first
    assert "the same command goes on from the last checkpoint" in second


@pytest.mark.parametrize(
    "numbers",
    [
        [signal.SIGINT],
        [signal.SIGTERM],
        [signal.SIGHUP],
        # As the editor closes: its own, then the system's, as it is gone.
        [signal.SIGTERM, signal.SIGTERM, signal.SIGHUP],
    ],
)
def test_a_training_that_is_asked_to_stop_saves_and_says_so(finished, tmp_path, numbers):
    said = []

    def report(progress):
        if progress.update == 3:
            for number in numbers:
                os.kill(os.getpid(), number)

    config = tiny_config("ppo", dummy_env=True)
    with pytest.raises(KeyboardInterrupt if numbers[0] == signal.SIGINT else Terminated):
        train("ppo", config, tmp_path / "run", report=report, say=said.append)
    told = " ".join(said)
    assert "stopping after this update" in told
    assert "stopped after update 4; saved" in told
    # Four is a regular checkpoint; what comes next must not depend on that.
    assert len(read_metrics(tmp_path / "run")) == 4
    train("ppo", config, tmp_path / "run", say=said.append)
    assert "resuming from update 4 of 6" in said
    assert without_time(read_metrics(tmp_path / "run")) == without_time(read_metrics(finished))
    same_parameters(finished, tmp_path / "run")


@pytest.mark.parametrize("when", ["before", "between stages"])
def test_who_stops_a_training_does_not_wait_for_an_evaluation(tmp_path, monkeypatch, when):
    stages = []

    def evaluate(agent, levels, settings):
        for done in range(3):
            stages.append(done)
            if when == "between stages":
                os.kill(os.getpid(), signal.SIGTERM)
            yield Progress(done=done, total=3, results=(), failures=())

    monkeypatch.setattr("kinetix.training.evaluation.evaluate", evaluate)

    def report(progress):
        if progress.update == 1 and when == "before":
            os.kill(os.getpid(), signal.SIGTERM)

    config = tiny_config("ppo", dummy_env=True, eval_freq=2, video_frequency=2)
    with pytest.raises(Terminated):
        train("ppo", config, tmp_path / "run", report=report)
    assert stages == ([] if when == "before" else [0])
    assert steps_of_run(tmp_path / "run") == [64]
    assert not (tmp_path / "run" / "films").exists()


def test_a_disk_that_is_full_is_one_sentence(finished, tmp_path, monkeypatch):
    run = shutil.copytree(finished, tmp_path / "run")

    def full(*_, **__):
        raise ValueError("RESOURCE_EXHAUSTED: [tensorstore] No space left on device [page] [page]")

    monkeypatch.setattr("orbax.checkpoint.StandardCheckpointer.save", full)
    longer = tiny_config("ppo", dummy_env=True, total_timesteps=8 * 4 * 8)
    with pytest.raises(KinetixError) as caught:
        train("ppo", longer, run)
    assert str(caught.value).startswith(
        f"{run / 'checkpoints' / '256'}: cannot be written: No space left on device; once"
    )
    assert steps_of_run(run) == [64, 128, 192]
