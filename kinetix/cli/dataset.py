"""Record episodes of people, agents and the search as one data set, for imitation learning."""

import contextlib
import dataclasses
import json as json_module
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import tyro
from tyro.conf import Positional

from kinetix.cli.shared.one_core import OneCore
from kinetix.cli.shared.terminal import Terminal, counted
from kinetix.command_line.paths import NamedPath
from kinetix.environment.outcome import Outcome
from kinetix.errors import KinetixError
from kinetix.wording import plural

if TYPE_CHECKING:
    from kinetix.datasets.episode import RecordedEpisode

_FIRST: Final = "compiling the step"


@dataclasses.dataclass(frozen=True, kw_only=True)
class RecordEpisodes:
    """Let an agent play, and add its episodes: the attempts of `kinetix eval` to the bit."""

    out: Annotated[Positional[NamedPath], tyro.conf.arg(metavar="DATASET")]
    """The data set's folder; made where there is none, added to otherwise."""
    agent: Annotated[str, tyro.conf.arg(metavar="DIR|NAME|planner|noop|random")]
    """Directory or name of an agent or a training run, or planner, noop or random."""
    levels: Annotated[tuple[str, ...], tyro.conf.arg(metavar="DIR|FILE|SET …")]
    """Folders of levels, level files, names of bundled levels, level sets."""
    attempts: int = 20
    """Episodes per level."""
    seed: int = 0
    """Equal seeds give equal episodes."""
    physics: str | None = None
    """Physics preset or solver; by default what the agent was trained under."""
    deterministic: bool = False
    """Take the likeliest action instead of drawing one."""
    wins: bool = False
    """Keep only episodes that are won."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class GatherEpisodes(OneCore):
    """Add episodes that the editor saved, and the recorded solutions of levels."""

    out: Annotated[Positional[NamedPath], tyro.conf.arg(metavar="DATASET")]
    """The data set's folder; made where there is none, added to otherwise."""
    sources: Annotated[tuple[str, ...], tyro.conf.arg(metavar="DIR|EPISODE.npz|FILE|SET …")]
    """Episodes (.npz), folders of them, levels and sets with solutions, data sets."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class VerifyDataset(OneCore):
    """Check hashes and levels, play every episode again, and say what the data set holds."""

    folder: Annotated[Positional[NamedPath], tyro.conf.arg(metavar="DATASET")]
    """The data set."""
    json: bool = False
    """Print one JSON object on stdout, and nothing else there."""
    no_replay: bool = False
    """Check files alone; otherwise the episodes are played again."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ExportDataset(OneCore):
    """Write states and actions in kinetix-env's layout, trajectories of 256 steps."""

    folder: Annotated[Positional[NamedPath], tyro.conf.arg(metavar="DATASET")]
    """The data set."""
    out: Annotated[Positional[NamedPath], tyro.conf.arg(metavar="OUT")]
    """A new folder for the shards."""
    size: str = "l"
    """Size of all states: s, m, l or four capacities; larger levels are left out and told."""
    outcomes: tuple[Outcome, ...] = ("won",)
    """Outcomes of the episodes to take."""


Dataset = (
    Annotated[RecordEpisodes, tyro.conf.subcommand("record")]
    | Annotated[GatherEpisodes, tyro.conf.subcommand("gather")]
    | Annotated[VerifyDataset, tyro.conf.subcommand("verify")]
    | Annotated[ExportDataset, tyro.conf.subcommand("export")]
)


def run(command: RecordEpisodes | GatherEpisodes | VerifyDataset | ExportDataset) -> int:
    """Run one of the four.

    Returns:
        0 done, 1 nothing was added, or an episode does not replay.
    """
    with contextlib.closing(Terminal()) as terminal:
        match command:
            case RecordEpisodes():
                return _add(command.out, _recorded(command, terminal), terminal)
            case GatherEpisodes():
                _check(command.sources, terminal)
                return _add(command.out, _gathered(command.sources, terminal), terminal)
            case VerifyDataset():
                return _verify(command, terminal)
            case ExportDataset():
                return _export(command)


def _add(out: Path, episodes: "Iterator[RecordedEpisode]", terminal: Terminal) -> int:
    from kinetix.datasets.folder import add_episodes, read_manifest

    untold = 0

    def noticed() -> "Iterator[RecordedEpisode]":
        nonlocal untold
        for episode in counted(episodes, _FIRST, _so_many, terminal):
            untold += not episode.replays
            yield episode

    try:
        told = add_episodes(out, noticed())
    except KeyboardInterrupt:
        print(f"{out}: keeps the episodes that were there until now", file=sys.stderr)
        raise
    for sentence in told.unfit:
        print(sentence, file=sys.stderr)
    manifest = read_manifest(out) if told.added or told.known else None
    if manifest is None:
        print(f"{out}: nothing to add", file=sys.stderr)
        return 1
    known = f", {told.known} were there already" if told.known else ""
    print(
        f"{out}: {plural(told.added, 'episode')} added{known}; now "
        f"{plural(manifest.episodes, 'episode')}, {plural(manifest.steps, 'step')} in "
        f"{plural(len(manifest.shards), 'shard')}"
    )
    _tell_untold(out, untold)
    return 0


def _so_many(episodes: int) -> str:
    return f"{plural(episodes, 'episode')} played"


def _tell_untold(folder: Path, count: int) -> None:
    """Report how many episodes of a data set no export can take."""
    if count:
        print(
            f"{folder}: {plural(count, 'episode')} cannot be played again from the controls "
            "alone: `kinetix dataset export` leaves out what it cannot play",
            file=sys.stderr,
        )


def _recorded(command: RecordEpisodes, terminal: Terminal) -> "Iterator[RecordedEpisode]":
    from kinetix.agents.evaluate import NamedLevel, Settings
    from kinetix.agents.named import load_player
    from kinetix.agents.recording import recorded_attempts
    from kinetix.level.sets import gather_levels

    if command.attempts < 1:
        raise KinetixError(f"--attempts {command.attempts}: expected at least 1")
    player = load_player(command.agent)
    settings = Settings(
        attempts=command.attempts,
        seed=command.seed,
        physics=command.physics or "",
        deterministic=command.deterministic,
    )
    for level in gather_levels(command.levels):
        source = level.level if level.path is None else str(level.path)
        named = NamedLevel(name=level.name, source=source)
        outcomes = ("won",) if command.wins else ()
        try:
            count = 0
            for episode in recorded_attempts(player, named, settings, outcomes=outcomes):
                if episode is not None:
                    count += 1
                    yield episode
            terminal.say(f"{level.name}: {plural(count, 'episode')}")
        except KinetixError as error:
            terminal.say(f"{level.name}: left out: {error}")


def _check(sources: tuple[str, ...], terminal: Terminal) -> None:
    """Refuse a wrong name now, before the names before it take their time; tell of other files."""
    from kinetix.datasets.sources import check_source

    for source in sources:
        for sentence in check_source(source):
            terminal.say(f"left out: {sentence}")


def _gathered(sources: tuple[str, ...], terminal: Terminal) -> "Iterator[RecordedEpisode]":
    from kinetix.datasets.replays import checked, up_to_the_win
    from kinetix.datasets.sources import episodes_of

    for source in sources:
        for found in episodes_of(source, lambda told: terminal.say(f"left out: {told}")):
            if found.place == "dataset":
                yield found.episode
                continue
            told = up_to_the_win if found.place == "solution" else checked
            episode = told(found.episode)
            if found.place == "trace" and not episode.replays:
                terminal.say(
                    f"{found.name}: left out: a body was pulled at, or it was played in a step "
                    "that rounds differently; its controls alone do not tell it"
                )
                continue
            yield episode


def _verify(command: VerifyDataset, terminal: Terminal) -> int:
    from collections import Counter

    from kinetix.datasets.folder import read_dataset, read_manifest, unlisted_shards

    manifest = read_manifest(command.folder)
    unlisted = unlisted_shards(command.folder)
    for path in unlisted:
        print(f"{path}: lies there, but dataset.json does not name it", file=sys.stderr)
    counts: dict[str, Counter[str]] = {name: Counter() for name in ("source", "outcome", "physics")}
    levels: set[str] = set()
    differ: list[str] = []
    untold = 0
    played = (_played_again(one, command) for one in read_dataset(command.folder))
    for episode, same in counted(played, _FIRST, _so_many, terminal):
        for name, counter in counts.items():
            counter[getattr(episode, name)] += 1
        levels.add(episode.level.name)
        untold += not episode.replays
        if not same:
            differ.append(episode.identity)
    told: dict[str, Any] = {
        "episodes": manifest.episodes,
        "steps": manifest.steps,
        "shards": len(manifest.shards),
        "levels": len(levels),
        **{name: dict(counter) for name, counter in counts.items()},
        "differ": None if command.no_replay else differ,
        "untold": untold,
    }
    if command.json:
        print(json_module.dumps(told))
    else:
        for name, value in told.items():
            print(f"{name:9} {_briefly(value)}")
        _tell_untold(command.folder, untold)
    if differ:
        print(
            f"{command.folder}: {plural(len(differ), 'episode')} of `differ` end otherwise when "
            "they are played again, as steps are computed otherwise on this machine or in this "
            "version; --json lists them. `kinetix dataset record` or `kinetix teach` makes them "
            "anew",
            file=sys.stderr,
        )
    return 1 if differ or unlisted else 0


def _played_again(
    episode: "RecordedEpisode", command: VerifyDataset
) -> tuple["RecordedEpisode", bool]:
    """An episode, and whether it ends as it did, as far as that is asked for."""
    if command.no_replay or not episode.replays:
        return episode, True
    from kinetix.datasets.replays import checked

    return episode, checked(episode).replays


def _briefly(value: Any) -> Any:
    if value is None:
        return "not checked"
    return len(value) if isinstance(value, list) else value


def _export(command: ExportDataset) -> int:
    from kinetix.datasets.folder import read_dataset
    from kinetix.datasets.offline import write_offline

    told = write_offline(
        command.out,
        (one for one in read_dataset(command.folder) if one.outcome in command.outcomes),
        size=command.size,
    )
    for sentence in told.left_out:
        print(sentence, file=sys.stderr)
    print(
        f"{command.out}: {plural(told.trajectories, 'trajectory', 'trajectories')} in "
        f"{plural(told.shards, 'shard')}"
    )
    return 0 if told.trajectories else 1
