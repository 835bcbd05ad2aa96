"""Solve again what kinetix/bench/references.json keeps: the answers that take seconds to find."""

import json
import math
from pathlib import Path

from kinetix.bench import references

FILE = Path(references.__file__).with_name("references.json")


def main() -> None:
    """Write the file."""
    known = json.loads(FILE.read_text()) if FILE.exists() else {}
    solved = {
        "pendulum": {
            str(degrees): float(references.pendulum_angle(math.radians(degrees), 1 / 60, 300)[-1])
            for degrees in (45, 90)
        },
        "double_pendulum": references.double_pendulum_tip(1 / 60, 90).tolist(),
        "offset_thrust": references.offset_thrust_tip(1 / 60, 120).tolist(),
        "car": known.get("car", [-3.4, -1.2]),
    }
    FILE.write_text(json.dumps(solved) + "\n")


if __name__ == "__main__":
    main()
