"""A small attack in every run of the tests; `make attack` goes on for an hour."""

import random
import zlib

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kinetix.errors import KinetixError
from kinetix.level.codec import loads
from tests.attack.kills import WRITERS, kill_writers
from tests.attack.mutate import Mutator
from tests.attack.tally import Tally
from tests.attack.targets import TARGETS

_INPUTS = {
    "agent": 3,
    "arrays of an agent": 3,
    "command line": 60,
    "state of a run": 4,
    "gallery": 4,
}
_MOST = 400
_SEEDS = ("command line", "level builder")
"""Targets made from a seed; there is no good sample."""


@pytest.mark.parametrize("name", TARGETS)
def test_damaged_files_end_in_one_sentence(name, tmp_path):
    tally, target = Tally(), TARGETS[name]
    samples = target.samples()
    for k in range(_INPUTS.get(name, min(target.weight, _MOST))):
        mutator = Mutator(zlib.crc32(f"{name} {k}".encode()))
        sample = samples[k % len(samples)]
        data = sample if k < len(samples) and sample else target.damage(mutator, sample)
        folder = tmp_path / str(k)
        folder.mkdir()
        tally.attempt(name, data, lambda data=data, folder=folder: target.read(data, folder))
    assert tally.wrong == [], tally.table()
    if name not in _SEEDS:
        assert tally.row(name).accepted > 0


@pytest.mark.parametrize("name", ["level", "metrics", "episode"])
def test_a_killed_writer_leaves_the_old_or_the_new(name, tmp_path):
    tally = Tally()
    kill_writers(tally, random.Random(0), tmp_path, (name,))
    assert tally.wrong == [], tally.table()
    assert tally.row(f"kills: {name}").tried == WRITERS[name].kills


@pytest.mark.parametrize("name", sorted({*WRITERS} - {"training", "unsaved work"}))
def test_a_writer_that_nobody_kills_is_read_as_it_wrote(name, tmp_path):
    for number in (1, 2):
        WRITERS[name].write(tmp_path, number)
    assert WRITERS[name].read(tmp_path) == 2


_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=20,
)


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.binary(max_size=200) | st.builds(lambda v: repr(v).encode(), _VALUES))
def test_any_bytes_end_in_one_sentence(data):
    try:
        loads(data)
    except KinetixError as error:
        assert str(error).isprintable()
