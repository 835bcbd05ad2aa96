"""Build a level in code, save it, and train an agent on it for a moment."""

import argparse
from pathlib import Path
from typing import Final

from kinetix import save_level
from kinetix.cli import main as kinetix
from kinetix.errors import one_sentence
from kinetix.files.folders import made_folder
from kinetix.level.model import Body, Circle, Joint, Level, Motor, Polygon

BUDGET: Final = 262_144
"""Environment steps to train for: about a minute on a laptop; 2 million show what is learnt."""


def ramp_roller() -> Level:
    """Return a motorised wheel with a green rider; the blue ball waits on the right."""
    board = Polygon(vertices=((0.3, 0.08), (-0.3, 0.08), (-0.3, -0.08), (0.3, -0.08)))
    return Level(
        name="Ramp roller",
        description="Roll to the right.",
        size="s",
        next_id=5,
        bodies=(
            Body(id=1, shape=board, position=(1.5, 0.75), role="green"),
            Body(id=2, shape=Circle(radius=0.2), position=(1.5, 0.6)),
            Body(id=3, shape=Circle(radius=0.3), position=(4.2, 0.7), role="blue", fixed=True),
        ),
        joints=(
            Joint(
                id=4,
                kind="revolute",
                a=1,
                b=2,
                anchor_a=(0.0, -0.15),
                anchor_b=(0.0, 0.0),
                motor=Motor(on=True, speed=2.0, power=2.0, binding=0),
            ),
        ),
    )


def main() -> int:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("ramp_roller"))
    parser.add_argument("arguments", nargs="*", help="more arguments for `kinetix train ppo`")
    given = parser.parse_args()

    file = made_folder(given.out) / "ramp_roller.json"
    save_level(ramp_roller(), file)
    if kinetix(["validate", str(file)]):
        return 1
    run = ["train", "ppo", "--preset", "small", "--out", str(given.out / "run")]
    run += ["--levels", str(file), "--total-timesteps", str(BUDGET), "--eval-freq", "0"]
    return kinetix([*run, *given.arguments])


if __name__ == "__main__":
    with one_sentence():
        raise SystemExit(main())
