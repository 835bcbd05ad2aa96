"""A trained agent: load it, ask it for actions, save it."""

import functools
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool

from kinetix.agents.card import AgentCard
from kinetix.agents.checkpoint import newest_checkpoint, read_checkpoint, write_checkpoint
from kinetix.agents.kinetix_env import (
    is_peer_checkpoint,
    read_peer_checkpoint,
    write_peer_checkpoint,
)
from kinetix.agents.networks.build import build_network
from kinetix.agents.networks.distributions import Distribution, action_head
from kinetix.agents.networks.recurrent import Carry, initial_carry
from kinetix.agents.normalisation import Normalisation, from_card, normalise
from kinetix.agents.player import Decision, sample_each
from kinetix.agents.shapes import static_env_params_of_card
from kinetix.errors import CheckpointError


class Agent:
    """A network with parameters, and everything needed to feed it as in training.

    Attributes:
        card: What it sees and says, its network, where it was trained, its results.
        params: Its variables and its normalisation, as one pytree.
    """

    def __init__(self, card: AgentCard, params: Mapping[str, Any]) -> None:
        """Put an agent together.

        Args:
            card: Its description.
            params: Parameters of the network (the tree below "params").
        """
        self.card = card
        self.params: dict[str, Any] = {
            "params": jax.tree.map(jnp.asarray, dict(params)),
            "normalisation": from_card(card.normalisation),
        }
        static_env_params = static_env_params_of_card(card)
        head = action_head(
            card.action.type,
            motor_bindings=static_env_params.num_motor_bindings,
            thruster_bindings=static_env_params.num_thruster_bindings,
        )
        self._network = build_network(card.network, head)

    @property
    def frame_skip(self) -> int:
        """Physics steps that the agent holds an action for."""
        return self.card.environment.frame_skip

    def init_carry(self, batch: int) -> Carry:
        """Memory at the start of `batch` episodes."""
        return initial_carry(batch)

    def act(
        self,
        carry: Carry,
        obs: Any,
        key: Array,
        deterministic: bool = False,
        done: Bool[Array, " n"] | None = None,
    ) -> Decision:
        """Choose actions for a batch of environments.

        Args:
            carry: From `init_carry` or the last call.
            obs: Observations with a leading axis of environments.
            key: Random key.
            deterministic: Take the likeliest action instead of drawing one.
            done: Where true, an episode has just begun and the carry starts anew.

        Returns:
            Actions, the next carry, and a dictionary with `logits`, `log_prob`, `value`, `entropy`.
        """
        batch = carry[0].shape[0]
        keys = jax.random.split(key, batch)
        done = jnp.zeros(batch, bool) if done is None else jnp.asarray(done)
        return self._act(self.params, carry, obs, keys, done, deterministic=deterministic)

    def decide(
        self,
        params: Any,
        carry: Carry,
        observation: Any,
        keys: Array,
        done: Bool[Array, " n"],
        *,
        deterministic: bool = False,
    ) -> Decision:
        """See `player.Player`."""
        carry, policy, value = self._policy(params, carry, observation, done)
        action = policy.mode() if deterministic else sample_each(policy, keys)
        info = {
            "logits": policy.logits,
            "log_prob": policy.log_prob(action),
            "value": value,
            "entropy": policy.entropy(),
        }
        return action, carry, info

    def _policy(
        self, params: Any, carry: Carry, observation: Any, done: Array
    ) -> tuple[Carry, Distribution, Array]:
        statistics: Normalisation | None = params["normalisation"]
        inputs = (normalise(statistics, observation), done)
        inputs = jax.tree.map(lambda x: x[None], inputs)
        variables = {"params": params["params"]}
        output: Any = self._network.apply(variables, carry, inputs)
        carry, policy, value = output
        return carry, policy.replace(logits=policy.logits[0]), value[0]

    @functools.cached_property
    def _act(self) -> Callable[..., Decision]:
        return jax.jit(self.decide, static_argnames="deterministic")


def load_agent(directory: str | Path, accept: Callable[[AgentCard], None] | None = None) -> Agent:
    """Load an agent: ours, the peer's, or the newest of a training run.

    Args:
        directory: A directory with `agent.json` and `params/`, or with `params.safetensors` and
            `config.json`, or a run of `kinetix train`.
        accept: Looks at the description before any array is read; raises if it does not fit.

    Raises:
        CheckpointError: It is none of these, is damaged, or does not fit; one sentence.
    """
    directory = Path(directory)
    if not directory.is_dir():
        raise CheckpointError(f"{directory}: expected the directory of an agent, found none")
    if is_peer_checkpoint(directory):
        return Agent(*read_peer_checkpoint(directory, accept))
    return Agent(*read_checkpoint(newest_checkpoint(directory), accept))


def save_agent(
    agent: Agent,
    directory: str | Path,
    format: Literal["kinetix-agent", "kinetix-env"] = "kinetix-agent",
) -> None:
    """Save an agent.

    Args:
        agent: The agent.
        directory: Where to; an agent that is there is replaced.
        format: "kinetix-agent" (ours) or "kinetix-env" (the peer's form).

    Raises:
        CheckpointError: It cannot be written, or the format cannot say it.
    """
    match format:
        case "kinetix-agent":
            write_checkpoint(Path(directory), agent.card, agent.params["params"])
        case "kinetix-env":
            if agent.card.normalisation is not None:
                raise CheckpointError(
                    f"{directory}: the kinetix-env form cannot carry the normalisation of "
                    "observations that this agent was trained with"
                )
            write_peer_checkpoint(Path(directory), agent.card, agent.params["params"])
        case _:
            raise CheckpointError(
                f"format: expected 'kinetix-agent' or 'kinetix-env', got {format!r}"
            )
