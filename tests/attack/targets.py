"""Readers of files: one row per reader."""

import random
from pathlib import Path

from tests.attack import agents, app, calls, levels, runs
from tests.attack.command_lines import run_words
from tests.attack.mutate import Mutator
from tests.attack.target import Target


def _nothing() -> tuple[bytes, ...]:
    return (b"",)


def _seed(mutator: Mutator, sample: bytes) -> bytes:
    return mutator.random.randbytes(8)


def _run_words(data: bytes, folder: Path) -> None:
    run_words(random.Random(data), folder)


def _build(data: bytes, folder: Path) -> None:
    calls.build(random.Random(data))


TARGETS: dict[str, Target] = {
    "level": Target(samples=levels.native_levels, read=levels.read_level, weight=800),
    "level of kinetix-env": Target(
        samples=levels.kinetix_env_levels, read=levels.read_level, weight=200
    ),
    "schema beside reader": Target(samples=levels.native_levels, read=levels.agree, weight=400),
    "level set": Target(samples=levels.level_sets, read=levels.read_set),
    "settings": Target(samples=app.settings, read=app.read_settings, weight=200),
    "autosave": Target(samples=app.autosaves, read=app.read_autosave),
    "script": Target(samples=app.scripts, read=app.read_script, weight=500),
    "clipboard": Target(samples=app.clips, read=app.read_clip, weight=200),
    "gallery": Target(samples=app.gallery, read=app.read_gallery, weight=4),
    "episode": Target(
        samples=app.traces, read=app.read_trace, damage=app.damaged_arrays, weight=200
    ),
    "page of an episode": Target(
        samples=app.traces, read=app.read_page, damage=app.damaged_arrays, weight=100
    ),
    "agent.json": Target(samples=agents.agents, read=agents.read_card, weight=300),
    "agent": Target(samples=agents.agents, read=agents.read_agent, weight=1),
    "arrays of an agent": Target(samples=agents.agent_arrays, read=agents.read_arrays, weight=1),
    "agent of kinetix-env": Target(
        samples=agents.kinetix_env_agents, read=agents.read_kinetix_env_agent, weight=10
    ),
    "metrics of a run": Target(samples=runs.metrics, read=runs.read_rows),
    "state of a run": Target(samples=runs.stored_state, read=runs.read_state, weight=10),
    "config.toml of a run": Target(samples=runs.configs, read=runs.read_config, weight=300),
    "command line": Target(samples=_nothing, read=_run_words, damage=_seed, weight=30),
    "level builder": Target(samples=_nothing, read=_build, damage=_seed, weight=200),
}
"""Every reader, by name."""
