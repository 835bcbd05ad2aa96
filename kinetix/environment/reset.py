"""Starts of episodes: levels from files, lists of levels, random levels, the empty level."""

import dataclasses
import operator
import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import jax
import jax.numpy as jnp
import msgspec
import numpy as np
from jaxtyping import Array, Float

from kinetix.aliases import also_named
from kinetix.bounds import LAST_SEED
from kinetix.bundled import named_levels, permutation_of
from kinetix.engine.spec import Features, SceneSpec
from kinetix.environment.arguments import kind_of
from kinetix.environment.checks import check_draw, check_static_params
from kinetix.environment.feature_check import check_features
from kinetix.environment.params import (
    EnvParams,
    Parity,
    PhysicsEngine,
    StaticEnvParams,
    static_env_params_of,
    with_parity,
)
from kinetix.environment.params import physics_engine as physics_engine_of
from kinetix.environment.rearrange import check_bindings, expand_state, permute_state
from kinetix.environment.sharing import digest, shared, shared_partial
from kinetix.environment.state import EnvState, stack_states, state_of
from kinetix.errors import KinetixError, LevelError
from kinetix.forks import refuse_forked_process
from kinetix.level.codec import LoadedLevel, check_computable, load_document
from kinetix.level.compile import compile_level
from kinetix.level.features import features_of, features_union
from kinetix.level.kinetix_env.compile import compile_kinetix_env
from kinetix.level.kinetix_env.document import STANDARD_GRAVITY
from kinetix.level.model import Level
from kinetix.level.sets import (
    LoadedSet,
    SetLevel,
    gather_levels,
    is_set_file,
    load_set,
    place_of,
)
from kinetix.level.sizes import capacity_of
from kinetix.pytree import on_device

if TYPE_CHECKING:
    from kinetix.environment.generators.locomotion import LocomotionParams
    from kinetix.environment.generators.params import UEDParams

ResetFunction = Callable[[Array], EnvState]
"""Draws the state in which an episode starts from a key; works under jit and vmap."""

Source = Literal["file", "fixed"]
"""True if a number comes from the file or is the one that kinetix-env always uses."""

LevelLike = str | Path | Level | LoadedLevel | EnvState
"""A level in any form: file, bundled name, document, what was read of a file, state."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class _OneOf:
    """Draws one of some levels; it can be pickled."""

    levels: EnvState
    """The levels, stacked."""
    edges: Float[np.ndarray, " n"]
    """Sums of the probabilities of all levels up to each but the last."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Name what makes it, so that a copy is the shared one."""
        return _one_of, (self.levels, self.edges)

    def __repr__(self) -> str:
        """Return the number of levels."""
        return f"<reset function: one of {len(self.edges) + 1} levels>"

    def __call__(self, key: Array) -> EnvState:
        """Draw the start of an episode."""
        refuse_forked_process()
        index = self.index(key)
        return jax.tree.map(lambda x: x[index], self.levels)

    def index(self, key: Array) -> Any:
        """Return the place of the level that a key draws."""
        if not self.edges.size:
            return 0
        check_draw(key)
        drawn = jax.random.uniform(key)
        return jnp.sum(drawn >= jnp.asarray(self.edges, drawn.dtype), dtype=jnp.int32)


def _one_of(levels: EnvState, edges: Float[np.ndarray, " n"]) -> _OneOf:
    return shared(_OneOf(levels=levels, edges=edges), digest((levels, edges)))


@also_named(filename="path")
def load_from_json_file(
    path: str | Path | Level,
    *,
    static_env_params: StaticEnvParams | None = None,
    gravity: Source = "file",
    time_limit: Source = "file",
    physics: str | None = None,
    parity: Parity | None = None,
) -> tuple[EnvState, StaticEnvParams, EnvParams]:
    """Return a level file, ready for the environment.

    A file of kinetix-env keeps its slots, gaps and stored inverse masses; a native file is compiled
    without gaps.

    Args:
        path: A file of either format, the name of a bundled level such as `s/name`, or a level.
        static_env_params: The sizes to compile to; by default the file's own.
        gravity: `"fixed"`: (0, −9.81) whatever the file has.
        time_limit: `"fixed"`: 256 steps whatever the file has.
        physics: Physics preset of the result; by default that of `static_env_params`.
        parity: `"kinetix-3"`: everything as kinetix-env does (physics `jax2d`, both `"fixed"`).

    Returns:
        The state at the start, of JAX's arrays, and the parameters that fit it.

    Raises:
        LevelError: The file is missing or bad, or the level does not fit.
        KinetixError: `gravity`, `time_limit`, `physics` or `parity` is none of what it may be.
    """
    refuse_forked_process()
    state, static, params = _loaded(path, static_env_params, gravity, time_limit, physics, parity)
    with jax.ensure_compile_time_eval():
        return on_device(state), static, params


def _loaded(
    path: str | Path | Level | LoadedLevel,
    static_env_params: StaticEnvParams | None,
    gravity: Source = "file",
    time_limit: Source = "file",
    physics: str | None = None,
    parity: Parity | None = None,
) -> tuple[EnvState, StaticEnvParams, EnvParams]:
    """`load_from_json_file`, as numpy arrays: many levels are stacked without a device."""
    if isinstance(path, Level):
        loaded, name = LoadedLevel(level=path, format="kinetix-level"), f"level {path.name!r}"
        check_computable(path)
    else:
        loaded = path if isinstance(path, LoadedLevel) else load_document(path)
        name = _file_of(path)
    for option, word in (("gravity", gravity), ("time_limit", time_limit)):
        if word not in get_args(Source):
            raise KinetixError(f"{option}={word!r}: expected 'file' or 'fixed'")
    if parity is not None:
        gravity = time_limit = "fixed"
    static = static_env_params or _static_of(loaded)
    if physics is not None:
        static = dataclasses.replace(static, physics=physics)
    static = with_parity(static, parity)
    state = _compiled(loaded, static, gravity=gravity, time_limit=time_limit)
    check_bindings(state, static, name=name)
    if isinstance(path, str | Path):
        state = _permuted(state, path)
    return state, static, _env_params_of(loaded, time_limit)


def level_state(level: LevelLike, static_env_params: StaticEnvParams) -> EnvState:
    """Return a level in any form as a state of the given sizes.

    Args:
        level: A file, a bundled name (with a suffix `.permuteN`, its entities are permuted with
            the seed N), a document, what was read of a file, or a state.
        static_env_params: The sizes and the physics.

    Raises:
        LevelError: The file is bad, or the level does not fit.
        KinetixError: The state does not fit, or has something that a step for other levels leaves
            out (`static_env_params_for_levels`).
    """
    if isinstance(level, EnvState):
        name = "the level"
        state = expand_state(level, static_env_params)
    elif isinstance(level, Level):
        check_computable(level)
        return _document_state(level, static_env_params)
    else:
        _refuse_no_level("level", level)
        name = _file_of(level)
        state, _, _ = _loaded(level, static_env_params)
    return _fitting(state, static_env_params, name)


def _file_of(level: str | Path | LoadedLevel) -> str:
    return str(level.path if isinstance(level, LoadedLevel) else level)


def _document_state(level: Level, static_env_params: StaticEnvParams) -> EnvState:
    """Return a level that was found computable as a state of the given sizes."""
    engine = physics_engine_of(static_env_params)
    state = state_of(compile_level(level, spec=engine.spec, solver=engine.solver))
    return _fitting(state, static_env_params, f"level {level.name!r}")


def _fitting(state: EnvState, static_env_params: StaticEnvParams, name: str) -> EnvState:
    check_bindings(state, static_env_params, name=name)
    check_features(state.world, static_env_params.features, name)
    return state


def make_reset_fn_list_of_levels(
    levels: Sequence[LevelLike] | LevelLike | Any, static_env_params: StaticEnvParams
) -> ResetFunction:
    """Return a reset function that picks one of some levels.

    Args:
        levels: Files, folders (all levels below them), bundled names of either, documents or states
            (also a batch of them), one of those, or a level set (its file or the loaded one, whose
            weights are the probabilities), or levels of one.
        static_env_params: The common sizes; every level is expanded to them.

    Returns:
        A function of a key; every level is equally likely where no weights are given.

    Raises:
        KinetixError: No level is given, or one does not fit; the message says which and why.
    """
    check_static_params(
        static_env_params, "the order is make_reset_fn_list_of_levels(levels, static_env_params)"
    )
    entries, weights = _entries(levels)
    if not entries:
        raise KinetixError("levels is empty: expected at least one level")
    stacked = stack_states([_entry_state(level, static_env_params) for level in entries])
    return _one_of(stacked, (np.cumsum(weights) / np.sum(weights))[:-1])


def static_env_params_for_levels(
    levels: Sequence[LevelLike] | LevelLike | Any, static_env_params: StaticEnvParams
) -> StaticEnvParams:
    """Return the same sizes, with only what some levels use: their step computes nothing else.

    Args:
        levels: In any form that `make_reset_fn_list_of_levels` takes. No others may be played.
        static_env_params: The common sizes.

    Raises:
        KinetixError: A level does not fit; the message says which and why.
    """
    entries, _ = _entries(levels)
    generic = dataclasses.replace(static_env_params, features=Features())
    used = (features_of(_entry_state(level, generic).world) for level in entries)
    features = features_union(used, static_env_params.capacity)
    return dataclasses.replace(static_env_params, features=features)


def static_env_params_with_level(
    level: LevelLike, static_env_params: StaticEnvParams
) -> StaticEnvParams:
    """Return the same sizes, for a level too: itself where their step leaves out nothing of it.

    Args:
        level: In any form.
        static_env_params: Those of `static_env_params_for_levels`, or others.

    Raises:
        KinetixError: The level does not fit; the message says why.
    """
    mine = static_env_params.features
    generic = dataclasses.replace(static_env_params, features=Features())
    needed = features_of(level_state(level, generic).world)
    if not mine.lacks(needed):
        return static_env_params
    features = features_union((mine, needed), static_env_params.capacity)
    return dataclasses.replace(static_env_params, features=features)


def make_reset_fn_sample_kinetix_level(
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    ued_params: "UEDParams | None" = None,
    physics_engine: PhysicsEngine | None = None,
) -> ResetFunction:
    """Return a reset function that draws a random level of the given sizes.

    Args:
        env_params: Parameters.
        static_env_params: Sizes and physics.
        ued_params: Options of the random levels; None: the usual ones.
        physics_engine: `env.physics_engine`; None: that of `static_env_params`.

    Raises:
        KinetixError: The two kinds of parameters are swapped, or one has a number that cannot be.
    """
    from kinetix.environment.generators.params import checked_drawing
    from kinetix.environment.generators.sample import sample_kinetix_level

    order = "the order is make_reset_fn_sample_kinetix_level(env_params, static_env_params)"
    engine, ued = checked_drawing(physics_engine, env_params, static_env_params, ued_params, order)
    options: dict[str, Any] = {
        "physics_engine": engine,
        "env_params": env_params,
        "static_env_params": static_env_params,
        "ued_params": ued,
    }
    return shared_partial(sample_kinetix_level, **options)


def make_reset_fn_sample_sizes(
    static_env_params: StaticEnvParams, ued_params: "UEDParams | None" = None
) -> ResetFunction:
    """A reset function that draws random levels of the sizes s, m and l, all in the given slots.

    Args:
        static_env_params: Sizes that all three fit, and physics.
        ued_params: Options of the random levels; None: the usual ones.

    Raises:
        KinetixError: An argument is something else, or has a number that cannot be.
    """
    from kinetix.environment.generators.params import checked_options
    from kinetix.environment.generators.starts import mixed_sampler

    order = "the order is make_reset_fn_sample_sizes(static_env_params, ued_params)"
    check_static_params(static_env_params, order)
    options = checked_options(ued_params)
    return shared_partial(_draw, mixed_sampler, physics_engine_of(static_env_params), options)


def make_reset_fn_locomotion(
    static_env_params: StaticEnvParams, locomotion_params: "LocomotionParams | None" = None
) -> ResetFunction:
    """Return a reset function that draws walkers with a goal to reach.

    Args:
        static_env_params: Sizes and physics.
        locomotion_params: Options of the walkers; None: the usual ones.
    """
    from kinetix.environment.generators.locomotion import LocomotionParams, locomotion_sampler

    options = LocomotionParams() if locomotion_params is None else locomotion_params
    return shared_partial(_draw, locomotion_sampler, physics_engine_of(static_env_params), options)


def make_reset_fn_empty(static_env_params: StaticEnvParams) -> ResetFunction:
    """Return a reset function that always gives the level without any body but the arena."""
    return make_reset_fn_list_of_levels(Level(name="empty"), static_env_params)


def _draw(
    sampler: Callable[..., ResetFunction], engine: PhysicsEngine, options: Any, key: Array
) -> EnvState:
    """Return a level from a sampler that is made where it is used: it cannot be pickled."""
    return sampler(engine, options)(key)


def _entries(levels: Any) -> tuple[list[LevelLike | SetLevel], np.ndarray]:
    """The levels, and how likely each is (not normalised)."""
    if isinstance(levels, (str, Path)) and _names_set(levels):
        levels = load_set(levels)
    if isinstance(levels, LoadedSet):
        levels = levels.levels
    if isinstance(levels, LevelLike):
        levels = [levels]
    if not isinstance(levels, Iterable):
        kind = type(levels).__name__
        raise KinetixError(f"levels: expected levels, their files or a level set, got {kind}")
    levels = list(levels)
    for index, entry in enumerate(levels):
        _refuse_no_level(f"levels[{index}]", entry)
    entries = [one for entry in levels for one in _each_level(entry)]
    if entries and all(isinstance(one, SetLevel) for one in entries):
        return entries, np.array([one.weight for one in entries])
    return entries, np.ones(len(entries))


def _refuse_no_level(name: str, value: Any) -> None:
    if isinstance(value, LevelLike | SetLevel | os.PathLike):
        return
    hint = ""
    if isinstance(value, tuple | StaticEnvParams | EnvParams):
        hint = ": of load_from_json_file(path) take the first of three, the state"
    raise LevelError(
        f"{name}: expected a level (its file, its name, a kinetix.Level or an EnvState), got "
        f"{kind_of(value)}{hint}"
    )


def _each_level(entry: Any) -> Iterable[Any]:
    """Return the levels of a folder or a batch of states; anything else as the only one."""
    if isinstance(entry, str | Path) and os.path.isdir(place_of(entry)):
        return gather_levels([entry])
    if not isinstance(entry, EnvState) or not np.ndim(entry.timestep):
        return [entry]
    states = jax.tree.map(np.asarray, entry)
    return (
        one
        for index in range(len(states.timestep))
        for one in _each_level(jax.tree.map(operator.itemgetter(index), states))
    )


def _entry_state(entry: LevelLike | SetLevel, static_env_params: StaticEnvParams) -> EnvState:
    """Like `level_state`; what was read from a file was checked there."""
    if not isinstance(entry, SetLevel):
        return level_state(entry, static_env_params)
    if entry.path is None or not entry.native:
        return level_state(entry.played, static_env_params)
    return _document_state(entry.level, static_env_params)


def _names_set(path: str | Path) -> bool:
    file = Path(path) if os.path.isfile(Path(path)) else named_levels(path)
    return file is not None and os.path.isfile(file) and is_set_file(file)


def _static_of(loaded: LoadedLevel) -> StaticEnvParams:
    if loaded.source is None:
        return static_env_params_of(capacity_of(loaded.level))
    names = {field.name for field in dataclasses.fields(StaticEnvParams)}
    block = {name: value for name, value in loaded.source.static.items() if name in names}
    return StaticEnvParams(**block | {"screen_dim": (500, 500), "downscale": 4})


def _env_params_of(loaded: LoadedLevel, time_limit: Source) -> EnvParams:
    block = {} if loaded.source is None else dict(loaded.source.parameters)
    limit = EnvParams().max_timesteps if time_limit == "fixed" else loaded.level.max_timesteps
    return EnvParams(**block | {"max_timesteps": limit})


def _compiled(
    loaded: LoadedLevel, static: StaticEnvParams, *, gravity: Source, time_limit: Source
) -> EnvState:
    engine = physics_engine_of(static)
    if loaded.source is not None:
        own = SceneSpec(capacity=loaded.source.capacity)
        scene = compile_kinetix_env(
            loaded.source, spec=own, solver=engine.solver, gravity=gravity, time_limit=time_limit
        )
        return expand_state(state_of(scene), static, name=loaded.source.file)
    level = loaded.level
    if gravity == "fixed":
        level = msgspec.structs.replace(level, gravity=STANDARD_GRAVITY)
    if time_limit == "fixed":
        level = msgspec.structs.replace(level, max_timesteps=EnvParams().max_timesteps)
    return state_of(compile_level(level, spec=engine.spec, solver=engine.solver))


def _permuted(state: EnvState, path: str | Path) -> EnvState:
    number = permutation_of(path)
    if number is None:
        return state
    if number > LAST_SEED:
        raise LevelError(f"{path}: expected .permuteN with N from 0 to {LAST_SEED}")
    return permute_state(jax.random.key(number), state)
