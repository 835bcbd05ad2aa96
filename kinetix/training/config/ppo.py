"""Hyper-parameters of PPO, which every other algorithm has too."""

import dataclasses
import math
from typing import ClassVar, Final, Literal, get_args

from kinetix.agents.networks.config import OBSERVATIONS_OF_KIND, NetworkConfig
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.errors import KinetixError
from kinetix.training.ranges import check_ranges
from kinetix.wording import thousands

_MOST_UPDATES: Final = 2_000_000_000
"""More cannot be counted in 32 bits."""

LevelMode = Literal["random", "random_all", "locomotion", "empty", "list"]
ObservationName = Literal[
    "symbolic_entity", "symbolic_flat", "symbolic_flat_padded", "pixels", "blind"
]
ActionName = Literal["multi_discrete", "discrete", "continuous"]

_NETWORK = NetworkConfig()

RESUMABLE = frozenset(
    {
        "total_timesteps",
        "eval_freq",
        "eval_levels",
        "eval_num_attempts",
        "eval_sampled_levels",
        "checkpoint_save_freq",
        "video_frequency",
        "wandb_project",
        "wandb_entity",
        "wandb_group",
        "wandb_tags",
    }
)
"""Fields that may change when a run goes on: they do not alter what has been learnt so far."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class PpoConfig:
    """Training by PPO on levels that nothing chooses."""

    seed: int = 0
    """Seed of everything that is random."""
    size: str = "m"
    """s, m, l, locomotion, or four capacities such as 12,4,6,2."""
    level_mode: LevelMode = "random"
    """Levels at the start of episodes: random ones of the size, or of s, m and l; creatures; a
    list."""
    levels: tuple[str, ...] = ()
    """Folders, files, names or sets of levels; implies the mode `list`."""
    demo_starts: float = 0.0
    """Share of episodes that start from a state along a winning episode of `levels`: the recorded
    solution, or one that is searched for. Random levels have none."""
    physics: str = DEFAULT_PHYSICS
    """Physics preset or solver."""
    parity: Literal["kinetix-3"] | None = None
    """`kinetix-3`: everything as in kinetix-env 3.0.2."""
    dummy_env: bool = False
    """An environment that does nothing, to debug training code quickly."""
    frame_skip: int = 2
    """Physics steps an action is held for."""
    dense_reward_scale: float = 0.2
    """Weight of the distance reward."""
    action_type: ActionName = "multi_discrete"
    """Kind of action."""
    observation_type: ObservationName = "symbolic_entity"
    """Observation of the agent."""
    network: NetworkConfig = _NETWORK
    """The network; its options are flags of their own."""

    learning_rate: float = 5e-5
    """Step size of Adam, where it is constant or falls linearly."""
    anneal_lr: bool = False
    """Let the learning rate fall linearly to 0."""
    warmup_lr: bool = False
    """Let it rise from `initial_lr` to `peak_lr`, then fall to 0 by a cosine."""
    initial_lr: float = 1e-5
    """Learning rate at the start of the warm-up."""
    peak_lr: float = 3e-4
    """Learning rate at its end."""
    warmup_frac: float = 0.1
    """Share of the training that is warm-up."""
    max_grad_norm: float = 1.0
    """Gradients are scaled down to this norm."""
    num_train_envs: int = 2048
    """Environments, over all devices together."""
    num_steps: int = 64
    """Environment steps of a rollout."""
    num_minibatches: int = 32
    """Parts of a rollout, each of them one gradient step an epoch."""
    update_epochs: int = 8
    """Epochs of learning on each rollout."""
    gamma: float = 0.995
    """Discount of future reward a step."""
    gae_lambda: float = 0.9
    """Decay of the advantage estimate."""
    clip_eps: float = 0.2
    """Largest move of policy ratio and value on one rollout."""
    ent_coef: float = 0.01
    """Weight of the entropy bonus."""
    vf_coef: float = 0.5
    """Weight of the value loss."""
    teacher_coef: float = 0.0
    """Weight of the divergence from the agent of `--from`, which keeps what it can do; 0: none."""
    teacher_frac: float = 0.5
    """Share of the training over which that weight falls to 0 (at once, where it is 0)."""
    critic_warmup: int = 0
    """Updates, after `--from`, in which the critic alone learns: one from imitation knows wins
    only."""
    total_timesteps: int = 10_737_418_240
    """Environment steps in all. A larger number makes a run longer; where its learning rate falls,
    it goes on as in a run of the new length."""
    bootstrap_on_timeout: bool = True
    """Count the value of the last state where the time limit cut an episode."""
    stagger_starts: bool = True
    """Begin the very first episodes anywhere before their time limit, so that later ones do not all
    end in the same update (not under parity)."""
    rms_norm: bool = False
    """Normalise observations by their running mean and variance."""
    full_minibatch_shuffle: bool = False
    """Shuffle single steps, not whole environments, into minibatches."""
    permute_state_during_training: bool = False
    """Put the entities of every level into other slots of their kind whenever it is played."""

    filter_levels: bool = True
    """Leave out random levels that are won by doing nothing, where levels are chosen."""
    level_filter_n_steps: int = 64
    """Steps for which the filter does nothing [environment steps]."""
    level_filter_sample_ratio: int = 2
    """Levels drawn for each one that the filter keeps."""

    eval_freq: int = 64
    """Updates between two evaluations; 0: none."""
    eval_levels: tuple[str, ...] = ()
    """Levels to evaluate on; empty: the bundled ones that fit the size."""
    eval_num_attempts: int = 20
    """Episodes a level."""
    eval_sampled_levels: int = 0
    """Number of filtered random levels to evaluate on besides."""
    checkpoint_save_freq: int = 512
    """Updates between two checkpoints; the last update makes one in any case."""
    video_frequency: int = 0
    """Updates between two films of the first levels that are evaluated on, one episode each; 0:
    none. They lie in RUN/films and go wherever metrics go."""
    wandb_project: str = ""
    """Send metrics to this project of Weights & Biases too (needs the extra `wandb`)."""
    wandb_entity: str = ""
    """User or team there; empty: yours."""
    wandb_group: str = ""
    """Runs of one group are shown together there."""
    wandb_tags: tuple[str, ...] = ()
    """Words to find the run by there."""

    @property
    def num_updates(self) -> int:
        """Rollouts in the whole training."""
        return self.total_timesteps // self.steps_per_update

    update_size: ClassVar[tuple[str, ...]] = ("num_steps", "num_train_envs")
    """Fields whose product is `steps_per_update`."""

    unread: ClassVar[frozenset[str]] = frozenset()
    """Fields that the algorithm has and does not read."""

    @property
    def steps_per_update(self) -> int:
        """Environment steps of one update; moments, where demonstrations are learnt from."""
        return math.prod(getattr(self, name) for name in self.update_size)

    @property
    def rollouts_per_update(self) -> int:
        """Rollouts of one update, each of which is learnt from by itself."""
        return 1

    @property
    def learning_updates(self) -> int:
        """Updates of the whole training that learn."""
        return self.num_updates

    @property
    def rounded(self) -> str:
        """A sentence where the steps asked for are no whole number of updates; else nothing."""
        trained = self.num_updates * self.steps_per_update
        if trained == self.total_timesteps:
            return ""
        return (
            f"total_timesteps = {thousands(self.total_timesteps)} is no whole number of updates of "
            f"{thousands(self.steps_per_update)}: {thousands(trained)} are trained"
        )

    def uneven(self, devices: int) -> str:
        """Return what these devices cannot share equally; empty if they can share everything.

        Args:
            devices: How many, over all processes.
        """
        odd = self._no_multiple("num_train_envs", devices)
        if odd:
            return odd
        if self._shuffled_units() // devices % self.num_minibatches:
            return (
                f"num_train_envs = {self.num_train_envs} in num_minibatches = "
                f"{self.num_minibatches} parts: {devices} devices need a share of each part; "
                "use fewer (--cores) or smaller numbers of parts"
            )
        return ""

    def _no_multiple(self, name: str, devices: int) -> str:
        value = getattr(self, name)
        if value % devices == 0:
            return ""
        return f"{name} = {value} must be a multiple of the {devices} devices"

    def _shuffled_units(self) -> int:
        """Return the number of environments, or of steps, that are shuffled into minibatches."""
        return self.num_train_envs * (self.num_steps if self.full_minibatch_shuffle else 1)

    def fits_devices(self, devices: int) -> bool:
        """Return whether each of so many devices has an equal share.

        Args:
            devices: How many, over all processes.
        """
        return not self.uneven(devices)

    def check(self) -> None:
        """Refuse what cannot work, before anything is compiled.

        Raises:
            KinetixError: Fields have values that cannot work; one sentence that names them.
        """
        for field in dataclasses.fields(self):
            _check_choice(field, getattr(self, field.name))
        check_ranges(self)
        self._check_minibatches()
        if self.anneal_lr and self.warmup_lr:
            raise KinetixError("anneal_lr and warmup_lr: choose one of them")
        if self.num_updates < 1:
            raise KinetixError(
                f"total_timesteps = {self.total_timesteps} is less than one update of "
                f"{self.steps_per_update}: ask for that many at least, or make updates smaller "
                f"({', '.join(self.update_size)})"
            )
        if self.num_updates > _MOST_UPDATES:
            raise KinetixError(
                f"total_timesteps = {self.total_timesteps} is more than "
                f"{thousands(_MOST_UPDATES)} updates of {self.steps_per_update}"
            )
        if self.level_mode == "list" and not self.levels:
            raise KinetixError("level_mode = 'list' needs levels")
        reads = OBSERVATIONS_OF_KIND[self.network.kind]
        if self.observation_type not in reads:
            raise KinetixError(
                f"observation_type = {self.observation_type!r}: a network of the kind "
                f"{self.network.kind} reads {' or '.join(reads)}"
            )
        if self.rms_norm and self.network.kind == "relational":
            raise KinetixError(
                "rms_norm: the relational network finds roles and keys by columns that are 0 or 1, "
                "and an agent that was trained with it cannot be trained on; leave rms_norm off "
                "or choose another kind of network"
            )

    def _check_minibatches(self) -> None:
        if self.full_minibatch_shuffle and self.network.recurrent_model:
            raise KinetixError("full_minibatch_shuffle cannot be used with recurrent_model")
        if self._shuffled_units() % self.num_minibatches:
            units = f"num_train_envs = {self.num_train_envs}"
            if self.full_minibatch_shuffle:
                units += f" times num_steps = {self.num_steps}"
            raise KinetixError(f"num_minibatches = {self.num_minibatches} must divide {units}")

    @property
    def only_listed(self) -> bool:
        """True if nothing but the listed levels is ever played, every entity in its own slot.

        Then the step is compiled for what these levels have. With `parity` it is left as in
        kinetix-env.
        """
        shuffled = self.permute_state_during_training
        return self.level_mode == "list" and not shuffled and self.parity is None


def _check_choice(field: "dataclasses.Field[object]", value: object) -> None:
    choices = get_args(field.type)
    if choices and all(isinstance(choice, str) for choice in choices) and value not in choices:
        allowed = ", ".join(map(str, choices))
        raise KinetixError(f"{field.name}: expected one of {allowed}, got {value!r}")
