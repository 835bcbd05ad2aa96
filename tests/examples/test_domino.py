import importlib.util
from pathlib import Path

import pytest

FILE = Path(__file__).resolve().parents[2] / "examples" / "domino.py"


def example():
    spec = importlib.util.spec_from_file_location("domino", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_formula_scales_as_the_law_of_similarity_says():
    domino = example()
    speed = domino.wave_speed(0.4, 0.05, 0.15)
    # Speeds of similar rows go with the root of their size; a closer row is faster.
    assert domino.wave_speed(1.6, 0.2, 0.6) == pytest.approx(2 * speed, rel=1e-6)
    assert domino.wave_speed(0.4, 0.05, 0.1) > speed > domino.wave_speed(0.4, 0.05, 0.2)
    # The wave has forgotten its start.
    assert domino.wave_speed(0.4, 0.05, 0.15, 40) == pytest.approx(speed, rel=1e-3)


@pytest.mark.slow
def test_the_shortest_row_is_long_enough_for_the_push_to_be_forgotten():
    domino = example()
    short, usual = (domino.measured_speed(0.4, 0.05, 0.1, n) for n in (domino.FEWEST, 40))
    assert short == pytest.approx(usual, rel=0.03)


@pytest.mark.slow
def test_the_engine_s_wave_runs_as_the_formula_says():
    domino = example()
    wanted = domino.wave_speed(0.4, 0.05, 0.15)
    assert domino.measured_speed(0.4, 0.05, 0.15, 40) == pytest.approx(wanted, rel=0.05)


def test_a_row_that_is_too_short_to_measure_is_refused(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["domino.py", "--dominoes", "29"])
    with pytest.raises(SystemExit):
        example().main()
    assert "--dominoes 29: expected at least 30" in capsys.readouterr().err
