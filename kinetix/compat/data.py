"""kinetix-env's records of imitation learning."""

from typing import Any, NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Bool

from kinetix.environment.params import StaticEnvParams
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError


class ActionEnvStateMask(NamedTuple):
    """A batch of steps to imitate."""

    action: Array
    env_state: Any
    mask: Array
    action_mask: Array | None = None
    done: Array | None = None


class TrainAndValData(NamedTuple):
    """Batches to learn from, and to check with."""

    train_data: ActionEnvStateMask
    val_data: ActionEnvStateMask


class RunnerState(NamedTuple):
    """State of a training."""

    train_state: Any
    update_step: Any
    rng: Any


class RunnerStateAndData(NamedTuple):
    """State of a training, and the data it learns from next."""

    runner_state: RunnerState
    batch_of_data: Any


def get_valid_action_mask(
    env_state: EnvState, static_env_params: StaticEnvParams, action: Array | None = None
) -> Bool[Array, "*n u"]:
    """Return which entries of a multi-discrete action move anything in a level.

    Args:
        env_state: A state, or a batch of them.
        static_env_params: How many bindings there are.
        action: Taken for kinetix-env's sake.

    Returns:
        One truth value per motor binding, then one per thruster binding.
    """
    del action
    joints, thrusters, labels = env_state.world.joints, env_state.world.thrusters, env_state.labels
    driven = joints.active & joints.motor_on & ~joints.fixed & ~labels.motor_auto

    def used(binding: Array, active: Array, count: int) -> Array:
        each = binding[..., None, :] == jnp.arange(count)[:, None]
        return jnp.any(each & active[..., None, :], axis=-1)

    return jnp.concatenate(
        [
            used(labels.motor_binding, driven, static_env_params.num_motor_bindings),
            used(
                labels.thruster_binding, thrusters.active, static_env_params.num_thruster_bindings
            ),
        ],
        axis=-1,
    )


class _ZarrDataset:
    """A data set in zarr shards, which is not read here."""

    def __init__(self, dataset_dir: str = "", *arguments: Any, **options: Any) -> None:
        raise KinetixError(
            f"{dataset_dir}: zarr data sets are not read here; record episodes with "
            "kinetix.environment.episode.play_episode, or levels with `kinetix levelset build`"
        )

    def load_next_batch(self) -> ActionEnvStateMask:
        """Return the next batch."""
        raise NotImplementedError


class ShuffledDatasetManager(_ZarrDataset):
    """kinetix-env's data set of single steps."""


class TrajectoryDatasetManager(_ZarrDataset):
    """kinetix-env's data set of whole episodes."""
