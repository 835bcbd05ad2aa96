"""Two windows that write one state file at the same moment lose nothing of each other's."""

import threading
import time

import pytest

from editor.base.settings import Settings, SettingsKeeper
from editor.base.state_file import read_state
from editor.gallery.kept_set import KeptSet
from editor.gallery.results import Record, Results, Trial
from kinetix.files.lock import held_briefly

ROUNDS = 12


def keeps_results(path, name):
    results = Results(path)
    for number in range(ROUNDS):
        results.record(Trial(player=name), {str(number): Record(attempts=1, solved=1)})
        yield


def keeps_settings(path, name):
    settings = Settings.load(path)
    keeper = SettingsKeeper(settings, path)
    for number in range(ROUNDS):
        settings.layouts[f"{name} {number}"] = "as it is"
        settings.layouts = dict(settings.layouts)
        keeper.save()
        yield


def keeps_a_set(path, name):
    kept = KeptSet(path)
    levels = kept.read()
    for number in range(ROUNDS):
        levels = {**levels, f"/{name} {number}": 1.0}
        kept.keep(levels)
        yield


@pytest.mark.parametrize(
    ("keeps", "count"),
    [
        (keeps_results, lambda path: sum(len(Results(path).of(str(n))) for n in range(ROUNDS))),
        (keeps_settings, lambda path: len(Settings.load(path).layouts)),
        (keeps_a_set, lambda path: len(KeptSet(path).read())),
    ],
)
def test_nothing_is_lost(tmp_path, keeps, count, monkeypatch):
    # A slow machine is not what is tested.
    monkeypatch.setattr("kinetix.files.lock._LONGEST_WAIT", 60.0)
    path = tmp_path / "kept.json"
    for module in ("base.settings", "gallery.results", "gallery.kept_set"):
        monkeypatch.setattr(f"editor.{module}.read_state", slow_read)
    windows = [threading.Thread(target=lambda n=n: list(keeps(path, n))) for n in "ab"]
    for window in windows:
        window.start()
    for window in windows:
        window.join()
    assert count(path) == 2 * ROUNDS
    assert [file.name for file in tmp_path.iterdir()] == ["kept.json"]


def slow_read(*args, **options):
    found = read_state(*args, **options)
    time.sleep(0.002)
    return found


def test_a_lock_that_is_never_given_back_stops_nobody(tmp_path, monkeypatch):
    monkeypatch.setattr("kinetix.files.lock._LONGEST_WAIT", 0.02)
    with held_briefly(tmp_path), held_briefly(tmp_path), held_briefly(tmp_path / "gone"):
        pass
