"""Gymnasium's own checks, its modes of starting anew, its films."""

import copy
import pickle
import re
import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import kinetix
from kinetix.errors import KinetixError
from kinetix.gymnasium import KinetixGymEnv, KinetixVectorEnv, vector
from tests.isolated import python_with, run_with

LEVEL = {"level": "s/goalkeeper", "physics": "jax2d"}


@pytest.fixture(scope="module")
def same():
    return KinetixVectorEnv(3, **LEVEL, autoreset_mode="SameStep", render_mode="rgb_array")


def noop(env):
    return np.zeros(env.action_space.shape, int)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("action_type", "observation_type"),
    [
        ("multi_discrete", "symbolic_flat"),
        ("discrete", "symbolic_flat_padded"),
        ("continuous", "symbolic_entity"),
        ("multi_discrete", "pixels"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*value is -?infinity")  # positions have no bounds
def test_the_checker_is_content(action_type, observation_type):
    env = KinetixGymEnv(
        **LEVEL,
        action_type=action_type,
        observation_type=observation_type,
        render_mode="rgb_array",
    )
    check_env(env, skip_render_check=True)
    assert env.render().shape == (125, 125, 3)


def test_ids_are_registered():
    assert {f"Kinetix/{size}-random-v0" for size in "sml"} <= set(gymnasium.registry)
    env = gymnasium.make("Kinetix/level-v0", **LEVEL)
    assert env.observation_space.shape == (140,)
    assert kinetix.gymnasium.KinetixGymEnv is KinetixGymEnv


def test_equal_seeds_give_equal_episodes():
    env = KinetixGymEnv(**LEVEL)
    runs = []
    for _ in range(2):
        env.reset(seed=5)
        env.action_space.seed(5)
        runs.append([env.step(env.action_space.sample())[1] for _ in range(8)])
    assert runs[0] == runs[1]


def play_to_the_end(env, mode):
    """Steps until the first end, then one more."""
    rows = []
    env.reset(seed=0)
    for _ in range(300):
        rows.append(env.step(noop(env)))
        if (rows[-1][2] | rows[-1][3]).any():
            rows.append(env.step(noop(env)))
            return rows
    raise AssertionError(mode)


@pytest.mark.slow
def test_modes_of_starting_anew(same):
    first, _ = same.reset(seed=0)
    rows = play_to_the_end(same, "same")
    observation, _, terminated, truncated, info = rows[-2]
    ended = terminated | truncated
    np.testing.assert_array_equal(info["_final_obs"], ended)
    np.testing.assert_allclose(observation[ended], first[ended])
    assert not np.allclose(info["final_obs"][ended], first[ended])
    np.testing.assert_array_equal(info["_final_info"], ended)
    np.testing.assert_array_equal(info["final_info"]["is_success"], info["solved"])

    following = KinetixVectorEnv(3, **LEVEL)
    assert following.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    rows = play_to_the_end(following, "next")
    ended = rows[-2][2] | rows[-2][3]
    np.testing.assert_allclose(rows[-1][0][ended], first[ended])
    assert (rows[-1][1][ended] == 0).all() and not (rows[-1][2] | rows[-1][3])[ended].any()

    never = KinetixVectorEnv(3, **LEVEL, autoreset_mode=AutoresetMode.DISABLED)
    with pytest.warns(UserWarning, match="are over, and rewards repeat"):
        rows = play_to_the_end(never, "disabled")
    assert not np.allclose(rows[-1][0][0], first[0])
    observation, _ = never.reset(options={"reset_mask": np.array([True, False, False])})
    np.testing.assert_allclose(observation[0], first[0])
    assert not np.allclose(observation[1], first[1])


@pytest.mark.parametrize(("skip", "rate"), [(1, 60), (2, 30), (7, 8.571), (8, 7.5)])
def test_films_are_told_how_many_steps_a_second_has(skip, rate):
    for make in (KinetixGymEnv, KinetixVectorEnv):
        env = make(**LEVEL, frame_skip=skip)
        assert env.metadata["render_fps"] == rate
        assert isinstance(env.metadata["render_fps"], type(rate))


def test_a_row_that_begins_anew_tells_nothing_as_in_gymnasiums_own_batch():
    """In the step after an end its action is ignored, and the old episode is not played on."""
    options = {**LEVEL, "observation_type": "blind", "num_envs": 2, "max_episode_steps": 3}
    ours = gymnasium.make_vec("Kinetix/level-v0", **options)
    theirs = gymnasium.make_vec("Kinetix/level-v0", **options, vectorization_mode="sync")
    for env in (ours, theirs):
        env.reset(seed=0)
    still = np.zeros(ours.action_space.shape, int)
    for _ in range(5):
        mine, other = ours.step(still)[-1], theirs.step(still)[-1]
        assert set(mine) == set(other)
        for name in mine:
            np.testing.assert_allclose(mine[name], other[name], atol=1e-5)
    ours.reset(seed=0)
    for _ in range(2):
        ours.step(still)
    ours.unwrapped._ended[0] = True  # as where one level ends before the other
    info = ours.step(still)[-1]
    assert info["_distance"].tolist() == info["_is_success"].tolist() == [False, True]
    assert info["distance"][0] == 0 < info["distance"][1]


RECORD = """
import sys
from gymnasium.wrappers import RecordVideo
from kinetix.gymnasium import KinetixGymEnv

env = RecordVideo(
    KinetixGymEnv(level="s/goalkeeper", physics="jax2d", render_mode="rgb_array"),
    sys.argv[1],
    video_length=4,
)
env.reset(seed=0)
for _ in range(5):
    env.step(env.action_space.sample())
env.close()
"""


@pytest.mark.slow
def test_a_film_is_recorded(tmp_path):
    # Gymnasium writes films with moviepy.
    python = python_with(tmp_path / "venv", "moviepy")
    (tmp_path / "record.py").write_text(RECORD)
    run_with(python, tmp_path / "record.py", str(tmp_path / "films"))
    (film,) = (tmp_path / "films").glob("*.mp4")
    assert film.read_bytes()[4:8] == b"ftyp"


def test_pictures_of_all(same):
    same.reset(seed=1)
    frames = same.render()
    asked = same.call("render")  # as skrl does
    assert all((one == other).all() for one, other in zip(asked, frames, strict=True))
    assert same.get_attr("render_mode") == ("rgb_array",) * 3
    assert len(frames) == 3
    assert frames[0].shape == (125, 125, 3)
    assert frames[0].dtype == np.uint8
    # The floor is below: dark at the bottom, white at the top.
    assert frames[0][-1].mean() < frames[0][20].mean()


def test_pictures_may_be_written_into(same):
    env = KinetixGymEnv(**LEVEL, render_mode="rgb_array")
    env.reset(seed=0)
    same.reset(seed=0)
    for frame in (env.render(), *same.render()):
        assert frame.flags.c_contiguous
        frame[:5] = 0


def test_pictures_have_the_size_that_is_asked_for():
    words = {**LEVEL, "observation_type": "pixels", "render_mode": "rgb_array", "render_size": 300}
    env, batch = KinetixGymEnv(**words), KinetixVectorEnv(1, **words)
    usual = KinetixGymEnv(**words | {"render_size": None})
    observation = env.reset(seed=0)[0]["image"]
    batch.reset(seed=0)
    usual.reset(seed=0)
    assert observation.shape == (125, 125, 3)  # of the agent, whatever the pictures are
    assert env.render().shape == (300, 300, 3)
    np.testing.assert_array_equal(env.render(), batch.render()[0])
    # The same part of the world.
    small, large = (each.render().mean(axis=(1, 2)) for each in (usual, env))
    np.testing.assert_allclose(large[6::12], small[2::5], atol=25)


def test_each_environment_of_a_batch_has_the_spaces_of_one(same):
    for name in ("action_space", "observation_space"):
        assert same.get_attr(name) == (getattr(same, f"single_{name}"),) * 3
    for name in ("reset", "step"):
        with pytest.raises(KinetixError, match="plays the whole batch"):
            same.call(name)


def test_an_attribute_is_set_for_all_or_refused(same):
    for values in (None, ["rgb_array"] * 3, "rgb_array"):
        same.set_attr("render_mode", values)
        expected = "rgb_array" if values else None
        assert same.get_attr("render_mode") == (expected,) * 3
    for values in (["rgb_array", None, None], ["rgb_array"] * 2, []):
        with pytest.raises(KinetixError, match=r"'render_mode' is one for all .* 3 equal ones"):
            same.set_attr("render_mode", values)
    assert same.render_mode == "rgb_array"


def test_what_is_wrong_is_said(same):
    with pytest.raises(KinetixError, match="did you mean 's/goalkeeper'"):
        KinetixGymEnv(level="s/goalkeper")
    with pytest.raises(KinetixError, match="'xl-random': expected one of s-random"):
        KinetixGymEnv(level="xl-random")
    for make in (KinetixGymEnv, KinetixVectorEnv):
        with pytest.raises(KinetixError, match="'human': expected rgb_array or None"):
            make(**LEVEL, render_mode="human")
    with pytest.raises(KinetixError, match="'Never': expected NextStep"):
        KinetixVectorEnv(2, **LEVEL, autoreset_mode="Never")
    with pytest.raises(KinetixError, match="call reset first"):
        KinetixGymEnv(**LEVEL).step(0)
    with pytest.raises(KinetixError, match=r"num_envs=2\.5: expected a whole number from 1"):
        KinetixVectorEnv(2.5, **LEVEL)
    with pytest.raises(KinetixError, match="num_envs=True: expected a whole number from 1"):
        KinetixVectorEnv(True, **LEVEL)
    with pytest.raises(KinetixError, match="2 seeds: expected 3, or one for all"):
        same.reset(seed=[1, 2])
    same.reset(seed=0)
    with pytest.raises(KinetixError, match="expected 3 of them"):
        same.step(np.zeros((2, 6), int))


def test_observations_may_be_written_into(same):
    env = KinetixGymEnv(**LEVEL)
    for observation, _ in (env.reset(seed=0), same.reset(seed=0)):
        observation[:] = 0.0


def test_rewards_may_be_clipped_in_place(same):
    clipped = gymnasium.wrappers.vector.ClipReward(same, -0.1, 0.1)
    clipped.reset(seed=0)
    _, reward, terminated, truncated, _ = clipped.step(clipped.action_space.sample())
    assert (np.abs(reward) <= 0.1).all()
    terminated[:] = truncated[:] = False


def test_equal_environments_compile_once():
    first, second = (KinetixGymEnv(**LEVEL).kinetix_env for _ in range(2))
    assert first == second and hash(first) == hash(second)
    # Searches copy environments to try something out.
    assert copy.deepcopy(KinetixGymEnv(**LEVEL)).kinetix_env == first


def test_a_level_with_more_in_it_than_the_environments_own_is_played_whole():
    """`s/goalkeeper` has no thrusters, and its step computes none."""
    env = KinetixGymEnv(level="s/goalkeeper", physics="fast")
    env.reset(seed=0, options={"level": "s/first_flight"})
    own = KinetixGymEnv(level="s/first_flight", physics="fast")
    own.reset(seed=0)
    hold, over = np.array([1, 1, 1, 1, 1, 1]), False
    while not over:
        *_, over, truncated, info = env.step(hold)
        assert not truncated and "level" not in info  # it is none of the environment's own
        assert own.step(hold)[-1] == pytest.approx(info | {"level": 0}, abs=1e-4)
    assert info["solved"]


def test_several_levels_are_played(tmp_path):
    flight = kinetix.load_level("s/first_flight")
    for name in ("a", "b"):
        kinetix.save_level(flight.replace(name=name), tmp_path / f"{name}.json")
    given = (flight, ["s/goalkeeper", flight], tmp_path, str(tmp_path), "sets/s", "s")
    drawn = [len(KinetixGymEnv(level).kinetix_env.reset_fn.edges) + 1 for level in given]
    assert drawn[:4] == [1, 2, 2, 2] and drawn[4] == drawn[5] > 2
    assert KinetixGymEnv(flight).level_names == (flight.name,)
    assert KinetixGymEnv("s-random").level_names == ()
    for wrong in (3, [3], []):
        with pytest.raises(KinetixError, match="level"):
            KinetixGymEnv(wrong)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
def test_each_of_a_batch_plays_the_levels_that_one_alone_with_its_seed_plays(mode):
    options = {
        "level": ["s/goalkeeper", "s/first_flight", "s/wheelie"],
        "physics": "jax2d",
    }
    alone = KinetixGymEnv(**options)
    batch = KinetixVectorEnv(3, **options, autoreset_mode=mode, max_episode_steps=2)
    assert alone.level_names == batch.level_names == tuple(options["level"])
    firsts = []
    observation, info = batch.reset(seed=7)
    firsts.append((observation.copy(), info["level"]))
    still = noop(batch)
    for _ in range(2):
        for _ in range(2):
            told = batch.step(still)
        assert told[3].all()
        ended = told[-1].get("final_info", told[-1])
        np.testing.assert_array_equal(ended["level"], firsts[-1][1])
        if mode == "NextStep":
            told = batch.step(still)
        elif mode == "Disabled":
            told = batch.reset(options={"reset_mask": np.ones(3, bool)})
        firsts.append((told[0].copy(), told[-1]["level"]))
    assert len({place for _, places in firsts for place in places.tolist()}) > 1
    for row in range(3):
        seeds = (7 + row, None, None)
        for k, seed in enumerate(seeds):
            expected, info = alone.reset(seed=seed)
            np.testing.assert_array_equal(firsts[k][0][row], expected)
            assert info == {"level": firsts[k][1][row]}


def test_those_that_are_left_alone_keep_their_draws():
    options = {"level": ["s/goalkeeper", "s/first_flight", "s/wheelie"], "physics": "jax2d"}
    one = KinetixVectorEnv(2, **options, autoreset_mode="Disabled")
    other = KinetixVectorEnv(2, **options, autoreset_mode="Disabled")
    one.reset(seed=3)
    other.reset(seed=3)
    for _ in range(3):
        one.reset(options={"reset_mask": np.array([True, False])})
    for _ in range(4):
        left, _ = one.reset(options={"reset_mask": np.array([False, True])})
        right, _ = other.reset(options={"reset_mask": np.array([False, True])})
        np.testing.assert_array_equal(left[1], right[1])


def test_a_seed_each_decides_what_comes_later_too():
    runs = []
    for _ in range(2):
        env = KinetixVectorEnv(2, "s-random", physics="jax2d")
        env.reset(seed=[1, 2])
        runs.append(env._draws.keys())
    assert (runs[0] == runs[1]).all()


@pytest.mark.parametrize("seed", ["a", 2**40, -1, 1.5, [1, "b"], [1]])
def test_seeds_that_cannot_be_are_refused(same, seed):
    with pytest.raises(KinetixError, match="seed"):
        same.reset(seed=seed)
    same.reset(seed=np.int64(3))


def test_a_step_after_the_end_is_warned_of():
    env = KinetixGymEnv(**LEVEL)
    env.reset(seed=0)
    over = False
    while not over:
        _, _, terminated, truncated, _ = env.step(noop(env))
        over = terminated or truncated
    with pytest.warns(UserWarning, match="the episode is over"):
        env.step(noop(env))
    env.reset()
    env.step(noop(env))


def test_a_batch_warns_once_of_each_episode_that_is_stepped_on():
    env = KinetixVectorEnv(2, **LEVEL, autoreset_mode="Disabled", max_episode_steps=3)

    def warnings_of(steps):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            for _ in range(steps):
                env.step(noop(env))
        return [str(warning.message) for warning in caught]

    env.reset(seed=0)
    assert warnings_of(3) == []
    (told,) = warnings_of(4)
    assert "environments [0, 1] are over" in told and "reset_mask" in told
    env.reset(options={"reset_mask": [False, True]})
    (told,) = warnings_of(5)
    assert "environments [1] are over" in told
    env.reset(options={"reset_mask": [True, True]})
    assert warnings_of(3) == []
    env.reset()
    assert warnings_of(3) == []


def test_options_and_actions_that_mean_nothing_are_refused(same):
    env = KinetixGymEnv(**LEVEL)
    env.reset(seed=0)
    for options in ({"lvl": 1}, 3):
        with pytest.raises(KinetixError, match="level"):
            env.reset(options=options)
    for action in (None, "x", [None] * 6):
        with pytest.raises(KinetixError, match="numbers"):
            env.step(action)
    same.reset(seed=0)
    for one, shape in ((env, ()), (same, (3,))):
        wrong = f"{(*shape, 5)}: expected {(*shape, 6)}, as env.action_space.sample()"
        with pytest.raises(KinetixError, match=re.escape(wrong)):
            one.step(np.zeros((*shape, 5), int))
        with pytest.raises(KinetixError, match=r'type float64: .* action_type="continuous"'):
            one.step(np.zeros((*shape, 6)))
    with pytest.raises(KinetixError, match="reset_mask"):
        same.reset(options={"level": "s/goalkeeper"})
    same.reset(seed=1)
    with pytest.raises(KinetixError, match="whole numbers from 0 and below"):
        same.step(np.full((3, 6), 7))
    with pytest.raises(KinetixError, match="3 truth values"):
        same.reset(options={"reset_mask": [True]})
    for mask in (["False", "x", ""], [1, 2, 0], [None, True, True]):
        with pytest.raises(KinetixError, match="expected truth values, True or False each"):
            same.reset(options={"reset_mask": mask})
    same.reset(options={"reset_mask": [1, 0, 0]})


def test_a_batch_can_be_pickled(same):
    first, _ = same.reset(seed=4)
    again, _ = pickle.loads(pickle.dumps(same)).reset(seed=4)
    np.testing.assert_array_equal(first, again)


def test_equal_batches_share_what_is_compiled(same):
    same.reset(seed=1)
    same.step(np.zeros((3, 6), int))
    again = KinetixVectorEnv(3, **LEVEL, autoreset_mode=same.mode)
    compiled = vector._advance._cache_size()
    again.reset(seed=1)
    again.step(np.zeros((3, 6), int))
    assert vector._advance._cache_size() == compiled


FORK = """
import gymnasium
import kinetix.gymnasium

fork = {"context": "fork"}
gymnasium.make_vec(
    "Kinetix/level-v0", num_envs=2, vectorization_mode="async", vector_kwargs=fork
)
"""


FORK_WITH_A_BATCH = """
import multiprocessing, sys
from kinetix.gymnasium import KinetixVectorEnv

batch = KinetixVectorEnv(2)
batch.reset(seed=0)
process = multiprocessing.get_context("fork").Process(target=batch.reset)
process.start()
process.join()
sys.exit(process.exitcode)
"""


@pytest.mark.slow
@pytest.mark.parametrize("script", [FORK, FORK_WITH_A_BATCH], ids=["single", "batch"])
def test_a_forked_process_is_refused_rather_than_waiting_for_ever(script):
    command = [sys.executable, "-W", "ignore", "-c", script]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert ended.returncode
    assert "would hang" in ended.stderr and "spawn" in ended.stderr


def test_a_word_that_means_nothing_is_named():
    for make in (KinetixGymEnv, KinetixVectorEnv):
        with pytest.raises(KinetixError, match="colour: no keyword of this environment; it has"):
            make(**LEVEL, colour="red")
        for size in (0, 12.5, 10**6):
            with pytest.raises(KinetixError, match=f"render_size={size}: expected a whole number"):
                make(**LEVEL, render_size=size)


@pytest.mark.parametrize("most", [0, 2.5, "many"])
def test_episodes_are_cut_after_whole_steps(most):
    with pytest.raises(KinetixError, match=r"max_episode_steps=.*: expected a whole number"):
        KinetixVectorEnv(2, **LEVEL, max_episode_steps=most)


@pytest.mark.slow
def test_a_batch_is_cut_where_gymnasium_is_told_so():
    env = gymnasium.make_vec("Kinetix/level-v0", num_envs=2, **LEVEL, max_episode_steps=3)
    env.reset(seed=0)
    for step in range(1, 4):
        *_, terminated, truncated, _ = env.step(np.zeros(env.action_space.shape, int))
        assert truncated.tolist() == [step == 3] * 2 and not terminated.any()
