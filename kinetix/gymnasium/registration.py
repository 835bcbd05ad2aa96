"""Names in Gymnasium's registry.

`import kinetix.gymnasium` enters them; Gymnasium before 1.4 also does so by itself, through the
entry point of the package.
"""

from kinetix.errors import KinetixError


def register_envs() -> None:
    """Register `Kinetix/s-random-v0`, `m-`, `l-` and `Kinetix/level-v0` (keyword `level`).

    Raises:
        KinetixError: Gymnasium is not installed.
    """
    try:
        from gymnasium.envs.registration import register, registry
    except ImportError:
        raise KinetixError(
            "Gymnasium is not installed: pip install 'kinetix-editor[gymnasium]'"
        ) from None
    levels = {f"{size}-random": f"{size}-random" for size in "sml"} | {"level": "s/first_flight"}
    for name, level in levels.items():
        if f"Kinetix/{name}-v0" not in registry:
            register(
                id=f"Kinetix/{name}-v0",
                entry_point="kinetix.gymnasium.env:KinetixGymEnv",
                vector_entry_point="kinetix.gymnasium.vector:KinetixVectorEnv",
                kwargs={"level": level},
            )
