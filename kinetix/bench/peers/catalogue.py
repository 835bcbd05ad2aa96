"""The peers and the settings under which they are measured."""

import dataclasses
from typing import Final

from kinetix.bench.peers.launch import Peer
from kinetix.errors import KinetixError

_JAX2D = Peer(
    name="jax2d",
    family="jax2d",
    environment="jax2d",
    program="run_jax2d.py",
    settings={"iterations": 10, "substeps": 1},
    compiled=True,
)
_JAX2D_TRUE = dataclasses.replace(_JAX2D, name="jax2d true inertia")
_BOX2D = Peer(
    name="box2d",
    family="box2d",
    environment="box2d",
    program="run_box2d.py",
    settings={"iterations": [8, 3], "substeps": 1, "bullets": False},
)
_PYMUNK = Peer(
    name="pymunk",
    family="pymunk",
    environment="pymunk",
    program="run_pymunk.py",
    settings={"iterations": 10, "substeps": 1},
)
_MUJOCO = Peer(
    name="mujoco",
    family="mujoco",
    environment="mujoco",
    program="run_mujoco.py",
    settings={"substeps": 1},
)

_MJX = Peer(
    name="mjx",
    family="mjx",
    environment="mjx",
    program="run_mjx.py",
    settings={"substeps": 1},
    compiled=True,
)
_BRAX = tuple(
    Peer(
        name=f"brax {pipeline}",
        family=f"brax {pipeline}",
        environment="brax",
        program="run_brax.py",
        settings={"pipeline": pipeline, "substeps": 1},
        compiled=True,
    )
    for pipeline in ("positional", "spring", "generalized")
)

KINETIX_ENV: Final = Peer(
    name="kinetix-env",
    family="kinetix-env",
    environment="jax2d",
    program="run_kinetix_env.py",
    settings={},
)
"""The engine's environment: levels only."""
NATIVE: Final = (_BOX2D, _PYMUNK)
"""Engines in C or C++ that are driven from Python, one world at a time."""


def _with(peer: Peer, suffix: str, **settings: object) -> Peer:
    return dataclasses.replace(
        peer, name=f"{peer.name} {suffix}", settings={**peer.settings, **settings}
    )


PEERS: Final[tuple[Peer, ...]] = (
    dataclasses.replace(_JAX2D, own_inertia=True),
    _JAX2D_TRUE,
    _BOX2D,
    _with(_BOX2D, "bullets", bullets=True),
    _PYMUNK,
    _MUJOCO,
    _MJX,
    *_BRAX,
)
"""Each at its defaults; jax2d with its own moments of inertia and with the true ones, Box2D also
with every body marked for continuous collision, Brax with each of its three pipelines."""

SWEPT: Final[tuple[Peer, ...]] = (
    *(_with(_BOX2D, f"{v}+{p}", iterations=[v, p]) for v, p in ((2, 1), (4, 2), (20, 8), (50, 20))),
    *(_with(_BOX2D, f"dt/{n}", substeps=n) for n in (2, 4, 8)),
    *(_with(_PYMUNK, f"×{n}", iterations=n) for n in (2, 5, 20, 50)),
    *(_with(_PYMUNK, f"dt/{n}", substeps=n) for n in (2, 4, 8)),
    *(_with(_MUJOCO, f"dt/{n}", substeps=n) for n in (2, 4, 8)),
)
"""The same engines with their knobs turned: iterations (×), steps a frame (dt/)."""

SLOW: Final[tuple[Peer, ...]] = (
    *(_with(_JAX2D_TRUE, f"×{n}", iterations=n) for n in (2, 5, 20, 40)),
    *(_with(_JAX2D_TRUE, f"dt/{n}", substeps=n) for n in (2, 4)),
    *(_with(peer, "dt/4", substeps=4) for peer in (_MJX, *_BRAX)),
)
"""Settings that are measured only when named: each takes minutes to compile."""


def peer_named(name: str) -> Peer:
    """Return a peer by its name.

    Raises:
        KinetixError: No peer has this name; the message lists those that exist.
    """
    every = {peer.name: peer for peer in (*PEERS, *SWEPT, *SLOW)}
    if name not in every:
        raise KinetixError(f"unknown peer {name!r}: expected one of {', '.join(every)}")
    return every[name]
