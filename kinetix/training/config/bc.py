"""Hyper-parameters of behavioural cloning."""

import dataclasses
from typing import ClassVar

from kinetix.errors import KinetixError
from kinetix.training.config.ppo import PpoConfig


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
    """Share that is measured and not learnt from: of many levels whole ones, else of the
    episodes."""
    total_timesteps: int = 8_388_608
    """Moments in all, repetitions included."""

    update_size: ClassVar[tuple[str, ...]] = ("minibatch_size", "num_minibatches")

    unread: ClassVar[frozenset[str]] = frozenset(
        {
            "bootstrap_on_timeout",
            "clip_eps",
            "critic_warmup",
            "demo_starts",
            "ent_coef",
            "full_minibatch_shuffle",
            "gae_lambda",
            "num_steps",
            "num_train_envs",
            "permute_state_during_training",
            "stagger_starts",
            "teacher_coef",
            "teacher_frac",
            "update_epochs",
        }
    )

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
        """Refuse settings that cannot work, as `PpoConfig.check` does."""
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
        for name in ("teacher_coef", "critic_warmup"):
            if getattr(self, name):
                raise KinetixError(f"{name}: imitation does not read it: leave it out")
        for name in ("label_smoothing", "held_out"):
            if not 0 <= getattr(self, name) < 1:
                raise KinetixError(f"{name}: expected 0 … below 1, got {getattr(self, name)}")
