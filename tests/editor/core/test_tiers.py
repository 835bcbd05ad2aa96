"""Play begins in a quickly compiled step and goes on, in the next episode, in the better one."""

import jax
import numpy as np
import pytest

from editor.worker.requests import (
    Advance,
    AgentRef,
    Casting,
    GetReady,
    KeepPrograms,
    Restore,
    StartEpisode,
    Tailor,
    WarmUp,
)
from editor.worker.simulation import disk, stepping
from editor.worker.simulation.compiling import Programs
from tests.editor.core.helpers import Unheard
from tests.editor.core.test_tailored import LEFT, LEVEL

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def perform(tmp_path_factory):
    """The bridge with nothing compiled and an empty cache on disk."""
    from jax.experimental.compilation_cache import compilation_cache

    from editor.worker import simulation
    from editor.worker.simulation import cast

    folder, programs = tmp_path_factory.mktemp("cache"), Programs()
    stored, name = jax.config.jax_compilation_cache_dir, "jax_compilation_cache_dir"
    # What another test compiled comes from JAX's cache without the code that the file needs.
    jax.config.update(name, None)
    compilation_cache.reset_cache()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(disk, "cache_folder", lambda name: folder / name)
        for module in (stepping, cast):
            patch.setattr(module, "PROGRAMS", programs)
        yield lambda request: simulation.perform(request, Unheard())
    jax.config.update(name, stored)
    compilation_cache.reset_cache()


def play(perform, run, **options):
    start = StartEpisode(run=run, level=LEVEL, physics="fast", quick=True, **options)
    return [perform(start), *perform(Advance(run=run, actions=(LEFT,) * 30))]


@pytest.fixture(scope="module")
def episodes(perform):
    """The same played in the order in which steps get ready."""
    perform(GetReady(level=LEVEL, physics="fast"))
    quick = play(perform, 1)
    perform(WarmUp(sizes=("s",), physics="fast"))
    under_way = perform(Advance(run=1, actions=()))
    assert under_way == ()
    shared = play(perform, 2)
    perform(Tailor(level=LEVEL, physics="fast"))
    return quick, shared, play(perform, 3)


def test_each_episode_is_played_in_the_best_step_that_is_ready(episodes):
    kinds = [{(s.quick, s.tailored) for s in episode} for episode in episodes]
    assert kinds == [{(True, True)}, {(False, False)}, {(False, True)}]


def test_all_tiers_play_alike_up_to_rounding(episodes):
    position = np.array([[s.position for s in episode] for episode in episodes])
    angle = np.array([[s.angle for s in episode] for episode in episodes])
    assert np.abs(position[0, -1] - position[0, 0]).max() > 0.3
    for other in (1, 2):
        np.testing.assert_allclose(position[0], position[other], atol=1e-3)
        np.testing.assert_allclose(angle[0], angle[other], atol=1e-2)


def test_an_earlier_episode_goes_on_in_the_kind_of_step_that_it_began_with(perform, episodes):
    quick = episodes[0]
    perform(StartEpisode(run=4, level=LEVEL, physics="fast", quick=True))
    perform(Restore(run=4, snapshot=quick[10]))
    again = perform(Advance(run=4, actions=(LEFT,) * 5))
    np.testing.assert_allclose(again[-1].position, quick[15].position, atol=1e-3)


def test_what_has_to_be_the_same_again_never_plays_in_the_quick_tier(perform, episodes):
    first = perform(StartEpisode(run=5, level=LEVEL, physics="fast"))
    assert not first.quick


def test_on_the_second_day_nothing_is_compiled(perform, episodes, monkeypatch):
    perform(KeepPrograms())
    monkeypatch.setattr(stepping, "PROGRAMS", Programs())
    monkeypatch.setattr(stepping.PROGRAMS, "obtain", None)
    again = play(perform, 6)
    assert not again[0].quick
    for one, other in zip(again, episodes[2], strict=True):
        np.testing.assert_array_equal(one.position, other.position)


def test_an_agent_too_begins_in_a_step_that_was_compiled_quickly(perform):
    casting = Casting(agent=AgentRef(path="random"))
    options = {"level": LEVEL, "physics": "fast", "casting": casting}
    quick = perform(StartEpisode(run=7, quick=True, **options))
    quick = [quick, *perform(Advance(run=7, actions=(None,) * 20))]
    full = perform(StartEpisode(run=8, **options))
    full = [full, *perform(Advance(run=8, actions=(None,) * 20))]
    assert {s.quick for s in quick} == {True} and {s.quick for s in full} == {False}
    assert [s.action for s in quick] == [s.action for s in full]
    np.testing.assert_allclose(quick[-1].position, full[-1].position, atol=1e-3)
    assert not perform(StartEpisode(run=9, quick=True, **options)).quick
