"""Build hook: carries the bundled levels and agents into the wheel as the package's data."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class DataHook(BuildHookInterface):
    """Maps `levels/` and `checkpoints/` to where `kinetix.paths` finds them in an installation."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the folders to an ordinary wheel.

        An editable installation reads them from the checkout, where a copy would go stale.

        Args:
            version: `standard` or `editable`.
            build_data: What hatchling lets a hook change.
        """
        if version != "standard":
            return
        for name in ("levels", "checkpoints"):
            folder = Path(self.root) / name
            if folder.is_dir():
                build_data["force_include"][str(folder)] = f"kinetix/_data/{name}"
