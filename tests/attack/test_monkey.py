"""A few monkeys at the editor; `python -m tests.attack.monkey` lets them play for longer."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.attack.monkey import STEPS

ROOT = Path(__file__).parents[2]
MONKEYS = 6


@pytest.mark.slow
def test_monkeys_lose_nothing():
    command = [sys.executable, "-m", "tests.attack.monkey", "--monkeys", str(MONKEYS)]
    done = subprocess.run(
        [*command, "--minutes", "60"], capture_output=True, text=True, cwd=ROOT, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{MONKEYS} monkeys did {MONKEYS * STEPS:,} things, 0 went wrong" in done.stdout
