"""Does imitation save training? PPO from an agent that learnt wins, beside PPO from nothing.

Usage: python -m scripts.from_imitation [LEVEL …] [--out FOLDER] > bench/from_imitation.jsonl

For each level the planner plays until it has wins to imitate, an agent learns them (`kinetix train
bc`), and PPO goes on from it and begins from nothing with equal settings but for the step size.
What counts is the number of environment steps until an evaluation of 20 attempts wins nine of ten;
who never does gets all steps there are. What has been made below FOLDER is not made again.
"""

import argparse
import json
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Final

from kinetix.training.logging import read_metrics

LEVELS: Final = (
    *("s/first_flight", "s/goalkeeper", "s/plank_dash", "s/ring_the_bell", "s/ski_jump"),
    *("s/tugboat", "s/wheelbarrow"),
    *("m/bee_line", "m/catcher", "m/high_five", "m/speed_bump", "m/torch_bearer"),
)
GOAL: Final = 0.9
WINS: Final = 24
"""Attempts of the planner that are imitated, as far as it wins them."""
MOMENTS: Final = 400_000
"""Moments of imitation, repetitions included."""
STEPS: Final = 524_288
"""Environment steps of PPO."""
EVALUATED: Final = 1
"""Updates of 16 384 steps between two evaluations."""
WARM_UP: Final = 2
"""Updates in which the critic of an imitator learns alone, as it knows wins only."""
# What an agent can do is lost in large steps.
GENTLY: Final = ("--learning-rate", "3e-4", "--critic-warmup", str(WARM_UP))


def run(*words: str) -> None:
    """Run a command of `kinetix`, in a process of its own: compiled programs pile up in one."""
    command = [sys.executable, "-m", "kinetix", *words]
    if status := subprocess.run(command, check=False, stdout=subprocess.DEVNULL).returncode:
        sys.exit(status)


def imitator(level: str, folder: Path) -> Path:
    """Return an agent that learnt the planner's wins of a level."""
    data, agent = folder / "data", folder / "imitation"
    if not data.exists():
        record = ("dataset", "record", str(data), "--agent", "planner", "--levels", level)
        run(*record, "--attempts", str(WINS), "--wins")
    # A training that was interrupted goes on, and one that is over is over.
    learn = ("train", "bc", "--preset", "small", "--data", str(data), "--levels", level)
    kept = ("--held-out", "0", "--eval-freq", "0", "--total-timesteps", str(MOMENTS))
    kept += ("--learning-rate", "1e-3")
    run(*learn, *kept, "--eval-levels", level, "--out", str(agent))
    return agent


def steps_to_goal(level: str, agent: Path | None, seeds: int, folder: Path) -> list[float]:
    """Return the steps that each of several runs took, all of them where it did not get there."""
    start = ("--from", str(agent), *GENTLY) if agent else ()
    learn = ("train", "ppo", "--preset", "small", "--levels", level, "--eval-levels", level)
    measured = ("--eval-freq", str(EVALUATED), "--total-timesteps", str(STEPS))
    run(*learn, *measured, *start, "--seeds", str(seeds), "--out", str(folder))
    idle = WARM_UP if agent else 0
    return [reached(folder / f"seed_{seed}", idle) for seed in range(seeds)]


def reached(folder: Path, idle: int) -> float:
    """Return the first step at which a run's evaluation won as often as it should.

    In the first `idle` updates the policy is as it came: what it wins then has taken no steps.
    """
    for number, row in enumerate(read_metrics(folder), 1):
        if row.get("eval/hand_designed_episode_solve_rate", 0.0) >= GOAL:
            return row["timing/num_env_steps"] if number > idle else 0
    return STEPS


def main() -> None:
    """Measure and print a row a level, then the median of their ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("levels", nargs="*", default=LEVELS)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--out", type=Path, default=Path("from_imitation"))
    given = parser.parse_args()
    ratios = []
    for level in given.levels:
        folder = given.out / level
        starts = {"nothing": None, "imitation": imitator(level, folder)}
        steps = {
            name: steps_to_goal(level, agent, given.seeds, folder / f"from_{name}")
            for name, agent in starts.items()
        }
        ratios.append(statistics.median(steps["imitation"]) / statistics.median(steps["nothing"]))
        print(json.dumps({"level": level, **steps, "ratio": ratios[-1]}), flush=True)
    print(json.dumps({"median_ratio": statistics.median(ratios)}))


if __name__ == "__main__":
    main()
