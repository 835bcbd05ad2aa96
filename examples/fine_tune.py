"""Train on one level twice: from the bundled general agent, and from nothing. Which is faster?"""

import argparse
from pathlib import Path

from kinetix.cli import main as kinetix
from kinetix.paths import checkpoints_dir
from kinetix.training.logging import read_metrics

Curve = list[tuple[float, float]]
"""Environment steps, and the solve rate of the episodes that ended about then."""


def curve(run: Path, window: int = 5) -> Curve:
    """A run's learning curve: the share of solved episodes over a few updates."""
    rows = [row for row in read_metrics(run) if "episode_solved" in row]
    points = []
    for index in range(len(rows)):
        seen = rows[max(index - window + 1, 0) : index + 1]
        solved = sum(row["episode_solved"] * row["episodes"] for row in seen)
        episodes = sum(row["episodes"] for row in seen)
        points.append((rows[index]["timing/num_env_steps"], solved / episodes))
    return points


def draw(curves: dict[str, Curve], title: str, file: Path) -> None:
    """A chart of all curves."""
    import matplotlib as mpl

    mpl.use("agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    for name, points in curves.items():
        axes.plot(*zip(*points, strict=True), label=name, linewidth=2)
    axes.set(xlabel="environment steps", ylabel="solve rate", title=title, ylim=(0, 1))
    axes.legend()
    axes.grid(alpha=0.3)
    figure.savefig(file, dpi=120)
    plt.close(figure)


def main() -> int:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--agent", type=Path, default=checkpoints_dir() / "general")
    parser.add_argument("--level", default="s/wheelie")
    parser.add_argument("--out", type=Path, default=Path("fine_tuning"))
    parser.add_argument("arguments", nargs="*", help="more arguments for `kinetix train ppo`")
    given = parser.parse_args()

    starts = {"from the general agent": ["--from", str(given.agent)], "from nothing": []}
    curves: dict[str, Curve] = {}
    for name, start in starts.items():
        run = given.out / name.replace(" ", "_")
        command = ["train", "ppo", "--preset", "small", "--size", "s", "--levels", given.level]
        command += ["--eval-freq", "0", "--out", str(run), *start, *given.arguments]
        if status := kinetix(command):
            return status
        curves[name] = curve(run)
        last = f"{curves[name][-1][1]:.2f}" if curves[name] else "no episode ended"
        print(f"{name}: solve rate at the end {last}")
    if all(curves.values()):
        try:
            draw(curves, given.level, given.out / "fine_tuning.png")
        except ImportError:
            print("the chart needs matplotlib: pip install 'kinetix-editor[bench]'")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
