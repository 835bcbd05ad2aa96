from kinetix.bench.accuracy import metrics_of
from kinetix.engine.presets import solver_named
from kinetix.scenes import SCENES


def test_a_rotor_with_a_bob_stays_closed_and_keeps_its_speed():
    """At 25 rad/s and one substep the bob turns by .4 rad in each."""
    gap, spin = metrics_of(SCENES["U26"], solver_named("fast"), "fast")
    assert (gap.name, spin.name) == ("joint gap", "spin error")
    assert gap.value is not None and gap.value < 1e-3
    assert spin.value is not None and spin.value < 0.03
