"""The episode on show goes into a data set."""

import dataclasses

import numpy as np
import pytest

from editor import actions
from editor.actions import run
from editor.actions.files import datasets
from editor.base.prompts import FileQuestion
from editor.documents.commands.level import ReplaceLevel
from editor.play.mode import Mode
from editor.worker.requests import AddEpisode, Advance, StartEpisode
from editor.worker.snapshots import Trace
from kinetix.datasets.episode import solution_episode
from kinetix.datasets.folder import read_dataset
from kinetix.errors import CommandError, KinetixError
from kinetix.level.codec import load_level
from tests.editor.core.helpers import Unheard, a_level, texts


@pytest.fixture
def played(session):
    session.document.commit(ReplaceLevel(level=a_level(), label="Start"))
    session.playback.simulator.ends_at = 10
    run(session, "run.play_human")
    assert actions.refusal(session, actions.BY_ID["file.add_to_dataset"])
    for _ in range(60):
        actions.update(session, 1 / 60)
    assert session.mode is Mode.ENDED
    return session


def test_an_episode_without_an_end_is_not_asked_for(session):
    with pytest.raises(CommandError, match="to its end"):
        datasets.ask_dataset(session)


def test_where_it_goes_is_asked_and_remembered(played, tmp_path, monkeypatch):
    asked = []
    monkeypatch.setattr(
        played.worker, "submit", lambda request, **options: asked.append((request, options))
    )
    run(played, "file.add_to_dataset")
    question = played.prompts[-1]
    assert isinstance(question, FileQuestion) and question.fresh
    question.answer(tmp_path / "mine")
    ((request, options),) = asked
    assert isinstance(request, AddEpisode)
    assert request.trace.snapshots[-1].step == 10
    done = type("Done", (), {"state": datasets.JobState.DONE, "result": "Added. All is well."})
    options["done"](done)
    assert "Added. All is well." in texts(played)
    assert played.settings.dataset == str((tmp_path / "mine").resolve())


def test_only_data_sets_and_empty_folders_will_do(tmp_path):
    assert "begins here" in datasets.about_dataset(tmp_path)
    assert datasets.about_dataset(tmp_path / "nowhere") == ""
    (tmp_path / "dataset.json").write_text("{")
    assert datasets.about_dataset(tmp_path) == ""
    (tmp_path / "dataset.json").unlink()
    (tmp_path / "letter.txt").write_text("x")
    assert datasets.about_dataset(tmp_path) == ""


@pytest.mark.slow(seconds=40)
def test_a_played_episode_becomes_data_once(tmp_path):
    from editor.worker import simulation
    from editor.worker.snapshots import channels_of

    def perform(request):
        return simulation.perform(request, Unheard())

    level = load_level("s/first_flight").replace(max_timesteps=12)
    snapshots = [perform(StartEpisode(run=1, level=level, physics="balanced"))]
    snapshots += perform(Advance(run=1, actions=((0, 0, 0, 0, 1, 0),) * 12))
    channels = tuple(channels_of(snapshot.action) for snapshot in snapshots[1:])
    trace = Trace(physics="balanced", perturbed=False, snapshots=tuple(snapshots), actions=channels)
    folder = tmp_path / "mine"
    told = perform(AddEpisode(level=level, trace=trace, folder=folder))
    assert told.startswith("Added. ") and "1 episode, 12 steps" in told
    again = perform(AddEpisode(level=level, trace=trace, folder=folder))
    assert again.startswith("It is there already.")
    (episode,) = read_dataset(folder)
    assert (episode.source, episode.outcome, episode.length) == ("person", "timeout", 12)
    assert episode.replays and episode.level == level
    assert "1 episode, " in datasets.about_dataset(folder)
    broken = Trace(physics="balanced", perturbed=False, snapshots=tuple(snapshots[3:]), actions=())
    with pytest.raises(KinetixError, match="does not begin at the level's start"):
        perform(AddEpisode(level=level, trace=broken, folder=folder))


def test_what_a_data_set_cannot_hold_is_told(tmp_path, monkeypatch):
    from editor.worker.simulation import dataset

    level = load_level("s/goalkeeper")
    episode = solution_episode(level)
    unfit = dataclasses.replace(episode, control=episode.control * np.nan)
    monkeypatch.setattr(dataset, "checked", lambda episode: episode)
    monkeypatch.setattr(dataset, "episode_of_arrays", lambda *of: unfit)
    trace = Trace(physics="balanced", perturbed=False, snapshots=(), actions=())
    monkeypatch.setattr(Trace, "arrays", lambda trace: {})
    with pytest.raises(KinetixError, match="Goalkeeper: left out: control"):
        dataset.add_episode(AddEpisode(level=level, trace=trace, folder=tmp_path), Unheard())
