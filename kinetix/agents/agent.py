"""A trained agent: load it, ask it for actions, save it."""

import dataclasses
import functools
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final, Literal

import jax
import jax.numpy as jnp
import numpy as np
from flax import linen as nn
from jaxtyping import Array, Bool

from kinetix.agents.arrays import digest
from kinetix.agents.card import AgentCard
from kinetix.agents.checkpoint import (
    newest_checkpoint,
    read_checkpoint,
    write_checkpoint,
)
from kinetix.agents.directories import surviving
from kinetix.agents.from_card import network_of_card
from kinetix.agents.identity import name_in_run
from kinetix.agents.input_checks import check_observations, parts_of_observation
from kinetix.agents.kinetix_env import (
    is_peer_checkpoint,
    read_peer_checkpoint,
    write_peer_checkpoint,
)
from kinetix.agents.networks.recurrent import Carry, initial_carry
from kinetix.agents.normalisation import from_card, normalise
from kinetix.agents.player import PLANNER, ROWS, Decision, sample_each
from kinetix.agents.scripted import SCRIPTED
from kinetix.bundled import agent_hint, named_agent
from kinetix.environment.checks import check_key
from kinetix.errors import CheckpointError, KinetixError
from kinetix.forks import refuse_forked_process
from kinetix.pytree import on_device

_TOLD: Final = ("logits", "log_prob", "value", "entropy")
"""Facts about an action that `Agent.act` returns."""


@dataclasses.dataclass(frozen=True)
class NetworkPolicy:
    """Chooses by a network; see `player.Policy`. Its params are "params" and "normalisation"."""

    network: nn.Module

    rows = ROWS

    def init_carry(self, batch: int) -> Carry:
        """Return a memory of zeros."""
        return initial_carry(batch)

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
        """Choose actions, as `player.Policy` describes."""
        inputs = (normalise(params["normalisation"], observation), done)
        inputs = jax.tree.map(lambda x: x[None], inputs)
        output: Any = self.network.apply({"params": params["params"]}, carry, inputs)
        carry, policy, value = output
        policy = policy.replace(logits=policy.logits[0])
        action = policy.mode() if deterministic else sample_each(policy, keys)
        info = {
            "logits": policy.logits,
            "log_prob": policy.log_prob(action),
            "value": value[0],
            "entropy": policy.entropy(),
            "policy": policy,
        }
        return action, carry, info


class Agent:
    """A network with parameters, and everything needed to feed it as in training.

    Attributes:
        card: Observation, action, network, training and results of the agent.
        params: Its variables and its normalisation, as one pytree.
        policy: How it chooses.
    """

    def __init__(self, card: AgentCard, params: Mapping[str, Any]) -> None:
        """Put an agent together.

        Args:
            card: Its description.
            params: Parameters of the network (the tree below "params").

        Raises:
            KinetixError: `params` is the whole tree, as `Agent.params` and Flax's variables are.
        """
        if "params" in params:
            raise KinetixError(
                "params: expected the parameters of the network alone; pass params['params']"
            )
        self.card = card
        self.params: dict[str, Any] = {
            "params": on_device(dict(params)),
            "normalisation": from_card(card.normalisation),
        }
        self.policy = NetworkPolicy(network_of_card(card))

    @functools.cached_property
    def _parts(self) -> dict[str, Any]:
        """Spaces of what it sees, as every action is checked against them."""
        return parts_of_observation(self.card)

    @functools.cached_property
    def digest(self) -> str:
        """SHA-256 over the names, shapes and bytes of its parameters, as `agent.json` has it."""
        return digest(self.params["params"])

    def __repr__(self) -> str:
        """Name, what it sees and what it does."""
        card = self.card
        return f"<Agent {card.name!r}: {card.observation.type} → {card.action.type}>"

    @property
    def frame_skip(self) -> int:
        """Physics steps that the agent holds an action for."""
        return self.card.environment.frame_skip

    def init_carry(self, batch: int) -> Carry:
        """Return the memory at the start of episodes.

        Args:
            batch: How many episodes.

        Raises:
            KinetixError: `batch` is not a number of episodes.
        """
        if not isinstance(batch, int | np.integer) or batch < 0:
            raise KinetixError(f"batch={batch!r}: expected a number of episodes")
        return self.policy.init_carry(int(batch))

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
            done: True where an episode has just begun: the carry is reset.

        Returns:
            Actions, the next carry, and a dictionary with `logits`, `log_prob`, `value`, `entropy`.
            Log-probability and entropy are those of all controls, whatever the level has.

        Raises:
            KinetixError: The observations are of another kind or size, no batch, or not as many as
                the carry; or there is no key.
        """
        refuse_forked_process()
        if not (isinstance(carry, tuple) and carry and np.ndim(carry[0]) == 2):
            raise KinetixError("carry: expected what init_carry(batch) or the last call returned")
        batch = carry[0].shape[0]
        check_key(key, "the order is act(carry, obs, key)")
        check_observations(self.card, self._parts, obs, batch)
        keys = jax.random.split(key, batch)
        done = jnp.zeros(batch, bool) if done is None else jnp.asarray(done)
        action, carry, info = _decide(
            self.policy, self.params, carry, obs, keys, done, deterministic=deterministic
        )
        return action, carry, {name: info[name] for name in _TOLD}

    def decide(self, *arguments: Any, deterministic: bool = False) -> Decision:
        """Return the policy's own `decide`; see `player.Policy`."""
        return self.policy.decide(*arguments, deterministic=deterministic)


@functools.partial(jax.jit, static_argnums=0, static_argnames="deterministic")
def _decide(policy: NetworkPolicy, *arguments: Any, deterministic: bool) -> Decision:
    return policy.decide(*arguments, deterministic=deterministic)


def load_agent(directory: str | Path, accept: Callable[[AgentCard], None] | None = None) -> Agent:
    """Load an agent: ours, kinetix-env's, or the newest of a training run.

    Args:
        directory: A directory with `agent.json` and `params/`, or with `params.safetensors` and
            `config.json`, or a run of `kinetix train`; or the name of a bundled agent (`general`).
        accept: Looks at the description before any array is read; raises if it does not fit.

    Raises:
        CheckpointError: The directory holds no agent, or one that is damaged or does not fit; one
            sentence.
    """
    refuse_forked_process()
    _check_directory(directory)
    named = str(directory)
    directory = surviving(Path(named))
    if not os.path.isdir(directory):
        directory = named_agent(named) or directory
    if not os.path.isdir(directory):
        raise CheckpointError(f"{named}: {_no_agent(named)}")
    if is_peer_checkpoint(directory):
        return Agent(*read_peer_checkpoint(directory, accept))
    checkpoint = newest_checkpoint(directory)
    card, params = read_checkpoint(checkpoint, accept)
    return Agent(card.replace(name=name_in_run(checkpoint) or card.name), params)


def _check_directory(directory: Any) -> None:
    """Refuse what names no directory.

    Raises:
        CheckpointError: `directory` is empty, or not a path.
    """
    if not isinstance(directory, str | Path) or not str(directory):
        raise CheckpointError(f"directory={directory!r}: expected the directory of an agent")


def _no_agent(named: str) -> str:
    """Explain why a name is not that of an agent with a network."""
    if named in (PLANNER, *SCRIPTED):
        return f"plays without a network, so nothing can be read of it; {agent_hint(named)}"
    if os.path.exists(named):
        return "is a file; expected the directory of an agent or of a training run"
    near = agent_hint(named, (PLANNER, *SCRIPTED))
    return f"there is no such directory, nor a bundled agent of this name; {near}"


def save_agent(
    agent: Agent,
    directory: str | Path,
    format: Literal["kinetix-agent", "kinetix-env"] = "kinetix-agent",
) -> None:
    """Save an agent.

    Args:
        agent: The agent.
        directory: Where to; an agent that is there is replaced.
        format: "kinetix-agent" (ours) or "kinetix-env" (kinetix-env's form).

    Raises:
        CheckpointError: `agent` is not an agent, cannot be written, or has something that the
            format cannot hold.
    """
    if not isinstance(agent, Agent):
        raise CheckpointError(
            f"agent: expected a kinetix agent, got {type(agent).__name__}; the order is "
            "save_agent(agent, directory)"
        )
    _check_directory(directory)
    match format:
        case "kinetix-agent":
            write_checkpoint(Path(directory), agent.card, agent.params["params"])
        case "kinetix-env":
            if agent.card.normalisation is not None:
                raise CheckpointError(
                    f"{directory}: the kinetix-env form cannot carry the normalisation of "
                    "observations that this agent was trained with"
                )
            if options := agent.card.observation.options:
                raise CheckpointError(
                    f"{directory}: the kinetix-env form cannot carry the options of observations "
                    f"that this agent was trained with ({', '.join(options)}); "
                    "format='kinetix-agent' can"
                )
            if agent.card.network.kind == "relational":
                raise CheckpointError(
                    f"{directory}: kinetix-env has no relational network, so its form cannot carry "
                    "this agent; format='kinetix-agent' can"
                )
            write_peer_checkpoint(Path(directory), agent.card, agent.params["params"])
        case _:
            raise CheckpointError(
                f"format: expected 'kinetix-agent' or 'kinetix-env', got {format!r}"
            )
