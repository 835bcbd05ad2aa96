"""Measures peers for the chart and keeps the rows where the chart finds them."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from kinetix.bench.chart.build import BATCHES
from kinetix.bench.chart.points import (
    PEER_ACCURACY,
    append_rows,
    file_name,
    missing_scenes,
    write_speeds,
)
from kinetix.bench.peers.accuracy import measure_peer
from kinetix.bench.peers.catalogue import PEERS, SWEPT, peer_named
from kinetix.bench.peers.launch import Peer
from kinetix.bench.peers.scenes import measure_peer_scenes


def chosen_peers(text: str) -> tuple[Peer, ...]:
    """Return the peers named on a command line: by their names, or `defaults`, `all` or `none`.

    Of `defaults` and `all`, those that are not installed are left out.

    Raises:
        KinetixError: A name is unknown.
    """
    groups = {"none": (), "defaults": PEERS, "all": (*PEERS, *SWEPT)}
    if text in groups:
        return tuple(peer for peer in groups[text] if peer.installed)
    return tuple(peer_named(name.strip()) for name in text.split(","))


def measure_for_chart(peer: Peer, results: Path, cores: int) -> Iterator[dict[str, Any]]:
    """Errors where there are none yet, speeds anew; yields the rows of speed as they are stored.

    Args:
        peer: The engine.
        results: Folder of the measured rows.
        cores: Processor cores that many worlds are spread over.

    Raises:
        KinetixError: The engine is not installed or its program failed.
    """
    errors = results / PEER_ACCURACY / f"{file_name(peer.name)}.jsonl"
    # Those at their defaults stand in the documentation's table.
    missing = missing_scenes(errors, "all" if peer in PEERS else "core,built")
    for row in measure_peer(peer, missing) if missing else ():
        append_rows(errors, [row])
    rows = list(measure_peer_scenes(peer, BATCHES, cores))
    write_speeds(results, peer.name, peer.family, rows)
    yield from ({"engine": peer.name, **row} for row in rows)
