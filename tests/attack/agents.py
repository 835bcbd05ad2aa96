"""Readers of agents: ours and kinetix-env's."""

import functools
import shutil
import tempfile
from pathlib import Path

from kinetix.paths import checkpoints_dir

AGENT = "unicyclist"


@functools.cache
def agents() -> tuple[bytes, ...]:
    return ((checkpoints_dir() / AGENT / "agent.json").read_bytes(),)


def read_agent(data: bytes, folder: Path) -> None:
    from kinetix.agents.agent import load_agent

    shutil.copytree(checkpoints_dir() / AGENT, folder / "agent", dirs_exist_ok=True)
    (folder / "agent" / "agent.json").write_bytes(data)
    load_agent(folder / "agent")


def read_card(data: bytes, folder: Path) -> None:
    from kinetix.agents.card import read_card, write_card

    (folder / "agent.json").write_bytes(data)
    write_card(folder / "again.json", *read_card(folder / "agent.json"))


def agent_arrays() -> tuple[bytes, ...]:
    files = [p for p in sorted((checkpoints_dir() / AGENT / "params").rglob("*")) if p.is_file()]
    root = checkpoints_dir() / AGENT
    return tuple(f"{path.relative_to(root)}\n".encode() + path.read_bytes() for path in files)


def read_arrays(data: bytes, folder: Path) -> None:
    from kinetix.agents.agent import load_agent

    name, _, content = data.partition(b"\n")
    agent = folder / "agent"
    shutil.rmtree(agent, ignore_errors=True)
    shutil.copytree(checkpoints_dir() / AGENT, agent)
    files = {str(p.relative_to(agent)): p for p in agent.rglob("*") if p.is_file()}
    path = files.get(name.decode(errors="replace"), agent / "params" / "_METADATA")
    path.write_bytes(content)
    load_agent(agent)


@functools.cache
def kinetix_env_agents() -> tuple[bytes, ...]:
    """The two files of an agent in kinetix-env's form, each with its name in the first line."""
    from kinetix.agents.checkpoint import read_checkpoint
    from kinetix.agents.kinetix_env import write_peer_checkpoint

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_peer_checkpoint(folder, *read_checkpoint(checkpoints_dir() / AGENT))
        return tuple(f"{p.name}\n".encode() + p.read_bytes() for p in sorted(folder.iterdir()))


def read_kinetix_env_agent(data: bytes, folder: Path) -> None:
    from kinetix.agents.kinetix_env import read_peer_checkpoint

    names = []
    for kept in (*kinetix_env_agents(), data):
        name, _, content = kept.partition(b"\n")
        names.append(name)
        (folder / (name if name in names[:2] else names[0]).decode()).write_bytes(content)
    read_peer_checkpoint(folder)
