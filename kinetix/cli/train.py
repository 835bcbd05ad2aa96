"""Train an agent without a window; the same --out goes on where it stopped."""

import dataclasses
import math
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Union

import tyro

from kinetix.agents.networks.config import NetworkConfig
from kinetix.cli.shared.terminal import Terminal, announced
from kinetix.command_line.paths import NamedPath
from kinetix.cores import narrow_cores
from kinetix.errors import KinetixError
from kinetix.training.averages import PREFIX
from kinetix.training.config import CONFIGS, BcConfig
from kinetix.training.progress_text import say_nothing
from kinetix.training.settings import CONFIG, SOURCES, field_notes, preset_values, settings_of
from kinetix.training.sweep import SweepRun, lines, read_sweep, table, write_table
from kinetix.wording import plural, thousands

_SMALL: Final = "small"
_SUMMARIES = {
    "ppo": "PPO on random levels, or on the levels of --levels.",
    "sfl": "Sampling for learnability: random levels that are solved sometimes.",
    "plr": "Prioritised level replay: levels that look worth replaying.",
    "accel": "PLR with mutations of what was replayed.",
    "bc": "Imitation of wins: a teacher's data, exported episodes, recorded solutions.",
    "dr": "Domain randomisation: fresh random levels every time.",
}


@dataclasses.dataclass(frozen=True, kw_only=True)
class Common:
    """Options of every algorithm besides its hyper-parameters."""

    out: Annotated[NamedPath, tyro.conf.arg(metavar="RUN")]
    """The run's directory: config.toml, metrics, checkpoints."""
    config: Annotated[Path | None, tyro.conf.arg(metavar="FILE.toml")] = None
    """Hyper-parameters by name; flags win over it."""
    preset: str | None = None
    """Named hyper-parameters: small, specialist, general, paper, kinetix-3; the file and flags win
    over them. Without preset and file: small, which fits a laptop; its values are in brackets."""
    seeds: int = 1
    """Train so many times, with the seeds seed, seed + 1, …, into RUN/seed_…"""
    sweep: Annotated[Path | None, tyro.conf.arg(metavar="FILE.toml")] = None
    """Train once for every combination of values in the file's tables [grid], [random] and [[run]],
    into RUN/NAME; RUN/sweep.csv compares them."""
    from_agent: Annotated[str | None, tyro.conf.arg(name="from", metavar="AGENT")] = None
    """Fine-tune this agent instead of starting from nothing; a run that has a checkpoint goes on
    from that."""
    dummy_env: bool = False
    """An environment that does nothing, to debug training code quickly."""
    coordinator: Annotated[str | None, tyro.conf.arg(metavar="HOST:PORT")] = None
    """Train together with other machines: where the first of them is reached, or `auto` under a
    scheduler that reports it. Every machine is given the same command and a directory that all
    share."""
    num_processes: int | None = None
    """Number of processes that train together."""
    process_id: int | None = None
    """Number of this process, from 0."""
    cores: int | None = None
    """Processor cores to use, if they get equal shares (KINETIX_CORES, else all)."""


def _arguments(algorithm: str) -> type[Common]:
    """The flags of an algorithm: every hyper-parameter that it reads, not given by default."""
    fields: list[Any] = []
    small = preset_values(algorithm, _SMALL)
    for owner in (CONFIGS[algorithm], NetworkConfig):
        notes = field_notes(owner)
        for field in dataclasses.fields(owner):
            if field.name in {"network", "dummy_env", *CONFIGS[algorithm].unread}:
                continue
            default = small.get(field.name, field.default)
            text = notes[field.name] + (f" ({default})" if default not in (None, "", ()) else "")
            kind: Any = Annotated[field.type | None, tyro.conf.arg(help=text)]  # pyright: ignore
            fields.append((field.name, kind, None))
    made = dataclasses.make_dataclass(
        algorithm.capitalize(), fields, bases=(Common,), frozen=True, kw_only=True
    )
    made.__doc__ = _SUMMARIES[algorithm]
    return made


_ARGUMENTS = {name: _arguments(name) for name in CONFIGS}

Train: Any = Union[  # noqa: UP007 (made at run time)
    tuple(
        Annotated[kind, tyro.conf.subcommand(name, description=_SUMMARIES[name])]
        for name, kind in _ARGUMENTS.items()
    )
]


def run(command: Common) -> int:
    """Train to the end; 0 when that is reached, 1 if runs of a sweep failed."""
    # Imported here, so that a wrong command line fails before JAX loads.
    from kinetix.training.devices import is_leader, join

    algorithm = next(name for name, kind in _ARGUMENTS.items() if type(command) is kind)
    if command.seeds < 1:
        raise KinetixError(f"--seeds {command.seeds}: expected at least 1")
    values = _values(command)
    sweep = None if command.sweep is None else read_sweep(command.sweep)
    runs = _runs(algorithm, command, values, sweep)
    with announced("reading the levels"):
        configs = [_configured(algorithm, command, own, out) for out, own in runs.items()]
    narrow_cores(
        lambda cores: all(
            config.fits_devices(cores * (command.num_processes or 1)) for config in configs
        )
    )
    if command.coordinator is not None:
        join(
            command.coordinator,
            num_processes=command.num_processes,
            process_id=command.process_id,
        )
    terminal = Terminal()
    teachers = _teachers(command, runs, terminal)
    like = {out: settings_of(agent.card) for out, agent in teachers.items()}
    configs = [
        _configured(algorithm, command, like[out] | own, out) if out in like else config
        for (out, own), config in zip(runs.items(), configs, strict=True)
    ]
    if is_leader():
        _tell_preset(command, runs, terminal)
    failed = 0
    for number, (out, config) in enumerate(zip(runs, configs, strict=True), start=1):
        if is_leader() and len(runs) > 1:
            terminal.say(f"{number}/{len(runs)}: {out}")
        try:
            _train(algorithm, config, out, teachers.get(out), terminal)
        except KinetixError as error:
            if sweep is None:
                raise
            failed += 1
            terminal.say(f"{out}: {error}")
        if sweep is not None and is_leader():
            write_table(command.out, sweep)
    if sweep is not None and is_leader():
        print("\n".join(lines(table(command.out, sweep))))
    return 1 if failed else 0


def _teachers(command: Common, runs: Iterable[Path], terminal: Terminal) -> dict[Path, Any]:
    """Return the agent to start from, of every run that is at its beginning.

    It wakes JAX: the number of devices has to be settled before.
    """
    from kinetix.agents.agent import load_agent
    from kinetix.training.devices import is_leader
    from kinetix.training.origin import still_needed

    if command.from_agent is None:
        return {}
    say = terminal.say if is_leader() else say_nothing
    beginning = [out for out in runs if still_needed(out, say)]
    return dict.fromkeys(beginning, load_agent(command.from_agent)) if beginning else {}


def _values(command: Common) -> dict[str, Any]:
    """Return the hyper-parameters that flags name."""
    own = {field.name for field in dataclasses.fields(Common)}
    for name in SOURCES:
        if getattr(command, name, None) == ():
            flag = name.replace("_", "-")
            raise KinetixError(f"--{flag}: expected names, files or folders, got no word")
    values: dict[str, Any] = {"dummy_env": True} if command.dummy_env else {}
    return values | {
        field.name: getattr(command, field.name)
        for field in dataclasses.fields(command)
        if field.name not in own and getattr(command, field.name) is not None
    }


def _runs(
    algorithm: str, command: Common, values: dict[str, Any], sweep: list[SweepRun] | None
) -> dict[Path, dict[str, Any]]:
    """Return the directory of every run, and its hyper-parameters.

    Raises:
        KinetixError: Several runs share an option that is for one run only.
    """
    if os.path.isfile(command.out / CONFIG) and (sweep is not None or command.seeds > 1):
        raise KinetixError(
            f"{command.out}: holds a training run, and several runs would mix with it; choose "
            "another directory"
        )
    runs = {command.out: values}
    if sweep is not None:
        for name in sorted({name for run in sweep for name in run.values} & set(values)):
            flag = name.replace("_", "-")
            raise KinetixError(f"{command.sweep} sets {name}, and so does --{flag}: leave one out")
        runs = {command.out / run.name: values | dict(run.values) for run in sweep}
    if command.seeds == 1:
        return runs
    seeds: dict[Path, dict[str, Any]] = {}
    for out, own in runs.items():
        first = _configured(algorithm, command, own, out).seed
        for seed in range(first, first + command.seeds):
            seeds[out / f"seed_{seed}"] = dict(own) | {"seed": seed}
    return seeds


def _configured(algorithm: str, command: Common, values: dict[str, Any], out: Path) -> Any:
    """Return the configuration of one run.

    Raises:
        KinetixError: The configuration is wrong; in a sweep the message begins with the run.
    """
    from kinetix.training.settings import make_config

    preset = _default_preset(command, out) or command.preset
    try:
        return make_config(algorithm, preset=preset, file=command.config, values=values, run=out)
    except KinetixError as error:
        where = "" if command.sweep is None else f"{command.sweep}: {out.name}: "
        raise KinetixError(f"{where}{error}") from None


def _default_preset(command: Common, out: Path) -> str | None:
    """Return the small preset for a new run where nothing is chosen."""
    chosen = command.preset or command.config or os.path.isfile(out / CONFIG)
    return None if chosen else _SMALL


def _tell_preset(command: Common, runs: Iterable[Path], terminal: Terminal) -> None:
    """Report the agent that is taken if none was chosen."""
    if any(_default_preset(command, out) for out in runs):
        terminal.say(
            f"preset {_SMALL}, which fits a laptop; --preset paper has the paper's numbers"
        )


def _train(algorithm: str, config: Any, out: Path, teacher: Any, terminal: Terminal) -> None:
    """Train once, and report the progress."""
    from kinetix.training.devices import is_leader
    from kinetix.training.run import train

    last = train(
        algorithm,
        config,
        out,
        teacher=teacher,
        announce=lambda setup: terminal.say(_announcement(algorithm, setup)),
        report=lambda report: terminal.say(_line(report)),
        say=terminal.say,
        status=terminal.status,
    )
    terminal.close()
    if is_leader():
        print(last)


def _announcement(algorithm: str, setup: Any) -> str:
    import jax

    config, devices = setup.config, jax.devices()
    told = (
        f"{algorithm} on {config.size}, {config.physics}, {len(devices)} × {devices[0].platform}: "
        f"{plural(config.num_updates, 'update')} of {config.steps_per_update} "
    )
    if isinstance(config, BcConfig):
        return f"{told}moments"
    return f"{told}steps; {_room(setup)}"


def _room(setup: Any) -> str:
    """Report how many environments fit into memory."""
    from kinetix.training.memory_estimate import estimate

    need = estimate(setup)
    return (
        f"about {need.per_environment / 2**20:.2f} MiB per environment, so that up to "
        f"{need.largest_num_train_envs} of them fit (num_train_envs is "
        f"{setup.config.num_train_envs})"
    )


def _line(report: Any) -> str:
    """Return a report for people; returns and solve rates are those of many episodes."""
    metrics, rate = report.metrics, report.steps_per_second
    parts = [
        f"{report.update}/{report.updates}",
        f"{thousands(report.env_steps)} steps",
        f"{'–' if rate is None else thousands(round(rate))}/s",
        *_learnt(metrics),
    ]
    if report.seconds_left is not None:
        parts.append(f"{_duration(report.seconds_left)} left")
    evaluated = metrics.get("eval/hand_designed_episode_solve_rate")
    if evaluated is not None:
        parts.append(f"evaluation {evaluated:.3f}")
    return "  ".join(parts)


def _learnt(metrics: Mapping[str, float]) -> list[str]:
    """Return an update's results in words: of episodes, or of imitation its agreement."""
    if "loss/agreement" not in metrics:
        return [
            f"return {_mean(metrics.get(f'{PREFIX}episode_return'))}",
            f"solved {_mean(metrics.get(f'{PREFIX}episode_solved'))}",
        ]
    held_out = metrics.get("held_out/loss/agreement")
    kept_back = [] if held_out is None else [f"held out {_mean(held_out)}"]
    return [
        f"loss {_mean(metrics.get('loss/policy'))}",
        f"agreement {_mean(metrics['loss/agreement'])}",
        *kept_back,
    ]


def _mean(value: float | None) -> str:
    """Return a mean over the episodes that ended; a dash where none did."""
    return "–" if value is None or math.isnan(value) else f"{value:.3f}"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}"
