"""The options of the locomotion family.

Q11 and Q12 are quirks of `LocomotionParams.kinetix_quirks`.
"""

from kinetix.level.model import InertiaModel
from kinetix.pytree import hashable, pytree, static

Exclude = tuple[float, float]


@pytree
class LocomotionParams:
    """The options of the locomotion family. Hashable and never traced, like `UEDParams`.

    A dimension is (width, height) [m]; it is drawn uniform in default·(1 ± ratio) per component,
    without the part default·(1 ± exclude) where that is set.
    """

    random_motors: bool = static(default=False)
    """True if the limbs' channels are drawn; otherwise each limb has its own."""
    body_rotation_range: float = static(default=0.0)
    """The body is turned by up to this much to either side [rad]."""
    body_dim_default: Exclude = static(default=(0.6, 0.2))
    leg_dim_default: Exclude = static(default=(0.1, 0.3))
    ankle_dim_default: Exclude = static(default=(0.1, 0.2))
    body_dim_sampling_ratio: float = static(default=0.5)
    leg_dim_sampling_ratio: float = static(default=0.5)
    ankle_dim_sampling_ratio: float = static(default=0.5)
    body_dim_exclude: float | None = static(default=None)
    leg_dim_exclude: float | None = static(default=None)
    ankle_dim_exclude: float | None = static(default=None)
    add_ankles: bool = static(default=True)
    num_random_legs_min: int = static(default=1)
    num_random_legs_max: int = static(default=1)
    """Limbs added at random, if there is room."""
    friction_default: float = static(default=1.0)
    friction_range: float = static(default=0.0)
    friction_exclude: float | None = static(default=None)
    """Friction is uniform in default ± range, outside default ± exclude."""
    density_default: float = static(default=1.0)
    density_range: float = static(default=0.0)
    density_exclude: float | None = static(default=None)
    """Density [kg/m²] is uniform in default ± range, outside default ± exclude."""
    ensure_leg_dims_equal: bool = static(default=False)
    ensure_ankle_dims_equal: bool = static(default=False)
    ensure_limb_thickness_equal: bool = static(default=False)
    fix_goal_position: bool = static(default=False)
    """True if the goal is in the middle of its range."""
    do_permute_state: bool = static(default=False)
    kinetix_quirks: bool = static(default=True)
    inertia_model: InertiaModel = static(default="kinetix")
    legacy_ceiling: bool = static(default=False)

    def __post_init__(self) -> None:
        """Keep lists and arrays of dimensions as tuples, which can be hashed."""
        for name in ("body_dim_default", "leg_dim_default", "ankle_dim_default"):
            object.__setattr__(self, name, hashable(getattr(self, name)))
