"""All hyper-parameters, as plain frozen values free of JAX.

The names are those of the published configurations; the defaults are those of kinetix-env 3.0.0,
except that `parity` is off (see `presets/kinetix-3.toml`).
"""

import dataclasses
import math
from typing import ClassVar, Final, Literal, get_args

from kinetix.agents.networks.config import OBSERVATIONS_OF_KIND, NetworkConfig
from kinetix.errors import KinetixError
from kinetix.training.ranges import check_ranges
from kinetix.wording import thousands

_MOST_UPDATES: Final = 2_000_000_000
"""More cannot be counted in 32 bits."""

Algorithm = Literal["ppo", "sfl", "plr", "accel", "dr", "bc"]
LevelMode = Literal["random", "random_all", "locomotion", "empty", "list"]
ObservationName = Literal[
    "symbolic_entity", "symbolic_flat", "symbolic_flat_padded", "pixels", "blind"
]
ActionName = Literal["multi_discrete", "discrete", "continuous"]
ScoreFunction = Literal["MaxMC", "pvl", "learnability"]
Prioritization = Literal["rank", "topk"]
LearnabilityMode = Literal["timesteps", "episodes"]

_NETWORK = NetworkConfig()


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
    """Share of the episodes that begin somewhere on the way of a win of `levels`: the recorded
    solution, or one that is searched for. Random levels have none."""
    physics: str = "balanced"
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

    @property
    def steps_per_update(self) -> int:
        """Environment steps of one update; moments, where demonstrations are learnt from."""
        return math.prod(getattr(self, name) for name in self.update_size)

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
        """Say what has no equal shares on so many devices; nothing where everything has.

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
        """Number of environments, or of single steps, that are shuffled into minibatches."""
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
            KinetixError: One sentence that names the fields.
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


@dataclasses.dataclass(frozen=True, kw_only=True)
class SflConfig(PpoConfig):
    """Sampling for learnability: train on levels that are sometimes solved."""

    num_steps: int = 256
    """Environment steps of a rollout."""
    sampled_envs_ratio: float = 0.5
    """Share of the environments that play levels of the buffer; 0 is domain randomisation."""
    batch_size: int = 16_384
    """Random levels that are scored at once."""
    num_batches: int = 16
    """Number of such batches in a scoring."""
    rollout_steps: int = 512
    """Length of each of their rollouts [environment steps]."""
    num_to_save: int = 8192
    """Size of the buffer."""
    buffer_update_frequency: int = 50
    """Updates between two scorings."""
    learnability_mode: LearnabilityMode = "timesteps"
    """A level is played for `rollout_steps` (`timesteps`), or for its first `rollout_episodes`
    episodes (`episodes`)."""
    rollout_episodes: int = 10
    """Episodes a level in the mode `episodes`."""
    learnability_correction: bool = True
    """p(1 − p)·n/(n + 1) instead of p(1 − p), for n finished episodes."""
    train_on_buffer: bool = False
    """Take all levels from a fixed set of random ones instead of drawing ever new ones."""
    train_buffer_size: int = 8192
    """Size of that set."""
    put_eval_levels_in_buffer: bool = False
    """Let the evaluation levels take the last places of the buffer; results on them are then no
    longer those of unseen levels."""
    log_learnability_before_after: bool = False
    """Play the buffer's levels once more before and after they are trained on, for the metrics."""

    def uneven(self, devices: int) -> str:
        """See `PpoConfig`; levels are scored on all devices too."""
        odd = super().uneven(devices)
        if not self.drawn_envs:
            return odd
        odd = odd or self._no_multiple("batch_size", devices)
        if self.log_learnability_before_after:
            odd = odd or self._no_multiple("num_to_save", devices)
        return odd

    def check(self) -> None:
        """See `PpoConfig.check`."""
        super().check()
        if self.num_to_save > self.batch_size * self.num_batches:
            raise KinetixError(
                f"num_to_save = {self.num_to_save} is more than the batch_size × num_batches = "
                f"{self.batch_size * self.num_batches} levels that are scored"
            )
        if self.sampled_envs_ratio and not self.drawn_envs:
            raise KinetixError(
                f"sampled_envs_ratio = {self.sampled_envs_ratio:g} of num_train_envs = "
                f"{self.num_train_envs} is less than one environment: none would play levels that "
                "were scored; expected more of either, or 0 for domain randomisation"
            )

    @property
    def drawn_envs(self) -> int:
        """Environments that play levels of the buffer."""
        return int(self.sampled_envs_ratio * self.num_train_envs)

    @property
    def only_listed(self) -> bool:
        """See `PpoConfig`; evaluation levels in the buffer are played too."""
        return super().only_listed and not self.put_eval_levels_in_buffer


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReplayConfig(PpoConfig):
    """Prioritised level replay; with `replay_prob` 0 it is domain randomisation (DR)."""

    size: str = "s"
    """s, m, l, locomotion, or four capacities such as 12,4,6,2."""
    outer_rollout_steps: int = 4
    """Rollouts (and updates) on the same levels before they are scored."""
    use_accel: bool = False
    """Mutate the levels of every replay."""
    num_edits: int = 2
    """Edits of a mutation."""
    score_function: ScoreFunction = "MaxMC"
    """Score that makes a level worth replaying."""
    level_buffer_capacity: int = 4000
    """Size of the buffer."""
    replay_prob: float = 0.5
    """Probability of a replay, once the buffer is full enough."""
    staleness_coeff: float = 0.3
    """Weight of not having been replayed for long."""
    prioritization: Prioritization = "rank"
    """Mapping from scores to weights."""
    temperature: float = 1.0
    """Weights are proportional to (1/rank) to the power 1/temperature."""
    topk_k: int = 8
    """Number of the best levels, which share the weight under `topk`."""
    minimum_fill_ratio: float = 0.5
    """Share of the buffer that must be filled before the first replay."""
    exploratory_grad_updates: bool = True
    """Learn on new and mutated levels too (else only on replayed ones)."""
    buffer_duplicate_check: bool = False
    """Keep no level twice."""
    accel_start_from_empty: bool = True
    """Let ACCEL's new levels be nearly empty ones (false where `levels` or `level_mode` name
    others)."""

    eval_freq: int = 50
    """Updates between two evaluations; 0: none."""

    update_size: ClassVar[tuple[str, ...]] = (*PpoConfig.update_size, "outer_rollout_steps")

    @property
    def only_listed(self) -> bool:
        """See `PpoConfig`; mutations make levels that have other things."""
        return super().only_listed and not self.use_accel


@dataclasses.dataclass(frozen=True, kw_only=True)
class BcConfig(PpoConfig):
    """Behavioural cloning: learn what was done in wins."""

    data: tuple[str, ...] = ()
    """Data sets of `kinetix teach` or `kinetix dataset`, `.npz` files, levels with a solution."""
    learning_rate: float = 5e-4
    """Step size of Adam, where it is constant or falls linearly."""
    minibatch_size: int = 1024
    """Moments of a gradient step."""
    label_smoothing: float = 0.05
    """Share of the target that is spread over all choices."""
    held_out: float = 0.05
    """Share of the episodes that is measured and not learnt from."""
    total_timesteps: int = 8_388_608
    """Moments in all, repetitions included."""

    update_size: ClassVar[tuple[str, ...]] = ("minibatch_size", "num_minibatches")

    def uneven(self, devices: int) -> str:
        """Nothing is shared out, so that no number of devices is refused."""
        return ""

    def fits_devices(self, devices: int) -> bool:
        """One device learns; others would have nothing to do."""
        return devices == 1

    @property
    def only_listed(self) -> bool:
        """See `PpoConfig`; demonstrations may be of other levels."""
        return False

    def _check_minibatches(self) -> None:
        """Nothing is played, so `minibatch_size` alone counts."""

    def check(self) -> None:
        """See `PpoConfig.check`."""
        super().check()
        if not self.data:
            raise KinetixError(
                "data: expected demonstrations: data of `kinetix teach` or `kinetix dataset`, "
                "episodes that the editor saved, or levels with a recorded solution"
            )
        if self.dummy_env:
            raise KinetixError(
                "dummy_env: imitation plays its demonstrations again, and must win: leave it out"
            )
        if self.action_type != "multi_discrete":
            raise KinetixError(
                f"action_type: demonstrations are multi_discrete, got {self.action_type!r}"
            )
        if self.network.recurrent_model:
            raise KinetixError("recurrent_model: imitation learns from single moments")
        if self.minibatch_size < 1:
            raise KinetixError(f"minibatch_size: expected at least 1, got {self.minibatch_size}")
        for name in ("label_smoothing", "held_out"):
            if not 0 <= getattr(self, name) < 1:
                raise KinetixError(f"{name}: expected 0 … below 1, got {getattr(self, name)}")


CONFIGS: dict[str, type[PpoConfig]] = {
    "bc": BcConfig,
    "ppo": PpoConfig,
    "sfl": SflConfig,
    "plr": ReplayConfig,
    "accel": ReplayConfig,
    "dr": ReplayConfig,
}
"""The kind of configuration that each algorithm takes."""

ALGORITHM_DEFAULTS: dict[str, dict[str, object]] = {
    "accel": {"use_accel": True, "num_edits": 5},
    "dr": {"replay_prob": 0.0},
}
"""Settings in which algorithms that share a kind of configuration differ."""


def algorithm_of(config: PpoConfig) -> str:
    """Return the name of the algorithm that a configuration is for."""
    if isinstance(config, SflConfig):
        return "sfl"
    if isinstance(config, BcConfig):
        return "bc"
    if isinstance(config, ReplayConfig):
        if config.use_accel:
            return "accel"
        return "plr" if config.replay_prob else "dr"
    return "ppo"


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


def _check_choice(field: "dataclasses.Field[object]", value: object) -> None:
    choices = get_args(field.type)
    if choices and all(isinstance(choice, str) for choice in choices) and value not in choices:
        allowed = ", ".join(map(str, choices))
        raise KinetixError(f"{field.name}: expected one of {allowed}, got {value!r}")
