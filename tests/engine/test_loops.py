"""A loop around a step is not compiled as one machine routine, the loops of the step are."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.experimental import serialize_executable

from kinetix.engine.backend import whole_batches
from kinetix.engine.batch import worlds_last
from kinetix.engine.loops import in_parts

ROUTINE = "xla_cpu_small_call"
"""Attribute by which XLA marks a loop that it compiles as one machine routine."""

LARGEST = 'custom_call_target="TopK"'


def turns(step):
    """Ten steps, with what does not change first among the step's arguments."""

    def run(weights, state):
        return jax.lax.fori_loop(0, 10, lambda _, state: step(weights, state), state)

    return run


def compiled(run, *arguments):
    return jax.jit(run).lower(*arguments).compile().as_text()


def swing(weights, state):
    return {"speed": state["speed"] + weights * jnp.sin(state["speed"]), "at": state["at"] + 1}


STATE = {"speed": np.ones(3, np.float32), "at": np.zeros((), np.int32)}
WEIGHTS = np.full(3, 0.5, np.float32)


def test_in_parts_keeps_a_loop_from_becoming_a_routine_and_changes_nothing():
    plain, kept = turns(swing), turns(lambda *arguments: in_parts(swing(*arguments)))
    assert ROUTINE in compiled(plain, WEIGHTS, STATE)
    assert ROUTINE not in compiled(kept, WEIGHTS, STATE)
    one, other = plain(WEIGHTS, STATE), kept(WEIGHTS, STATE)
    np.testing.assert_array_equal(one["speed"], other["speed"])
    assert one["at"] == other["at"] == 10


def test_a_program_that_has_run_can_be_written_to_disk():
    program = jax.jit(turns(lambda *arguments: in_parts(swing(*arguments)))).lower(WEIGHTS, STATE)
    program = program.compile()
    one = program(WEIGHTS, STATE)
    code, takes, gives = serialize_executable.serialize(program)
    again = serialize_executable.deserialize_and_load(
        code, takes, gives, execution_devices=jax.devices()[:1]
    )
    np.testing.assert_array_equal(one["speed"], again(WEIGHTS, STATE)["speed"])


@pytest.mark.parametrize(
    "state", [{"at": np.zeros(2, np.int32)}, {"none": np.zeros((0, 4), np.float32)}, {}]
)
def test_without_floats_it_is_the_identity(state):
    assert in_parts(state) is state


def test_a_kernel_keeps_the_loop_around_it_in_parts_but_not_its_own():
    def kernel(weights, state):
        return jax.lax.fori_loop(0, 5, lambda _, state: swing(weights, state), state)

    text = compiled(turns(worlds_last(kernel)), WEIGHTS, STATE)
    assert text.count(f'{ROUTINE}="true"') == 1
    assert LARGEST in text


def test_an_accelerators_program_looks_for_no_largest_number():
    with whole_batches():
        text = compiled(turns(worlds_last(swing)), WEIGHTS, STATE)
    assert LARGEST not in text
