"""Train on one level twice: from the bundled general agent, and from nothing. Which is faster?"""

import argparse
import tomllib
from pathlib import Path

from kinetix.cli import main as kinetix
from kinetix.errors import one_sentence
from kinetix.level.sets import gather_levels
from kinetix.paths import checkpoints_dir
from kinetix.training.logging import read_metrics

Curve = list[tuple[float, float]]
"""Environment steps, and the solve rate of the episodes that ended about then."""


def first_step(run: Path, longest: int) -> int:
    """The step from which no first episode can be going on that lasts no longer than this."""
    settings = tomllib.loads((run / "config.toml").read_text())
    return settings["num_train_envs"] * longest


def curve(run: Path, begin: int, window: int = 5) -> Curve:
    """Return a run's learning curve: the share of solved episodes over a few updates.

    It begins at the step from which no first episode can be going on any more: until then those
    that are over are the short ones, which are mostly wins.
    """
    rows = [row for row in read_metrics(run) if "episode_solved" in row]
    points = []
    for index in range(len(rows)):
        seen = rows[max(index - window + 1, 0) : index + 1]
        solved = sum(row["episode_solved"] * row["episodes"] for row in seen)
        episodes = sum(row["episodes"] for row in seen)
        points.append((rows[index]["timing/num_env_steps"], solved / episodes))
    return [(steps, rate) for steps, rate in points if steps >= begin]


def draw(curves: dict[str, list[Curve]], title: str, file: Path) -> None:
    """A chart of all curves: one colour a start, one line a seed."""
    import matplotlib as mpl

    mpl.use("agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    for colour, (name, several) in zip(("tab:green", "tab:blue"), curves.items(), strict=True):
        for number, points in enumerate(several):
            label = name if number == 0 else None
            axes.plot(*zip(*points, strict=True), label=label, color=colour, linewidth=1.8)
    axes.xaxis.set_major_formatter(lambda steps, _: f"{steps / 1e6:g}")
    axes.set(xlabel="environment steps [millions]", ylabel="solve rate", title=title)
    axes.set(xlim=(0, None), ylim=(0, 1.02))
    axes.legend(loc="lower right")
    axes.grid(alpha=0.3)
    figure.savefig(file, dpi=120)
    plt.close(figure)


def main() -> int:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--agent", type=Path, default=checkpoints_dir() / "general")
    parser.add_argument("--level", default="m/salute")
    parser.add_argument("--out", type=Path, default=Path("fine_tuning"))
    parser.add_argument("--seeds", type=int, default=1, help="how many runs from each start")
    parser.add_argument("arguments", nargs="*", help="more arguments for `kinetix train ppo`")
    given = parser.parse_args()

    longest = max(each.level.max_timesteps for each in gather_levels([given.level]))
    # What an agent can do is lost in large steps, and while the critic knows nothing of the level.
    gently = ["--learning-rate", "3e-4", "--critic-warmup", "4"]
    starts = {"from the general agent": ["--from", str(given.agent), *gently], "from nothing": []}
    curves: dict[str, list[Curve]] = {name: [] for name in starts}
    for seed in range(given.seeds):
        for name, start in starts.items():
            run = given.out / f"{name.replace(' ', '_')}_{seed}"
            command = ["train", "ppo", "--preset", "small", "--levels", given.level]
            command += ["--seed", str(seed), "--eval-freq", "0", "--out", str(run)]
            if status := kinetix([*command, *start, *given.arguments]):
                return status
            begin = first_step(run, longest)
            points = curve(run, begin)
            unknown = f"unknown: it counts from step {begin}; train for longer"
            last = f"{points[-1][1]:.2f}" if points else unknown
            print(f"{name}, seed {seed}: solve rate at the end {last}")
            if points:
                curves[name].append(points)
    if all(curves.values()):
        try:
            draw(curves, Path(given.level).stem.replace("_", " "), given.out / "fine_tuning.png")
        except ImportError:
            print("the chart needs matplotlib: pip install 'kinetix-editor[bench]'")
    else:
        print("no chart: a run is too short for a curve")
    return 0


if __name__ == "__main__":
    with one_sentence():
        raise SystemExit(main())
