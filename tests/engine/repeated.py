"""Levels played twice in a batch and alone; prints how far the results are apart."""

import functools
import json
import math
import sys

import numpy as np

from kinetix.engine.presets import solver_named
from tests.engine import scenes

levels = [scenes.stack(2), scenes.pendulum(math.pi / 4), scenes.bouncing_ball(1.0)]
play = functools.partial(scenes.play, solver_named("balanced"), seconds=0.5, spec=scenes.FEW)
first, again = play(levels)[0], play(levels)[0]
apart = [
    float(np.abs(play([level])[0].position[0] - first.position[number]).max())
    for number, level in enumerate(levels)
]
same_bits = first.position.tobytes() == again.position.tobytes()
sys.stdout.write(json.dumps({"same_bits": same_bits, "apart": apart}))
