"""A row of dominoes falls: the speed of the wave, measured and by a formula.

Formula: J. M. J. van Leeuwen, "The domino effect", American Journal of Physics 78, 721 (2010), for
dominoes that do not slip on the floor and slide on each other without friction. Each turns about
its lower front edge, hits the next without bouncing and stays in touch with it. Contact at angles θ
(of the domino in front) and θ' (of the one that leans on it) means
h sin(θ' − θ) = (s + d) cos θ − d, with the height h, the thickness d and the gap s.
"""

import argparse

import numpy as np

import kinetix
from kinetix.errors import one_sentence

GRAVITY = 9.81
FEWEST = 30
"""Dominoes: in the second half of a shorter row the push is still in the wave."""


def wave_speed(height: float, thickness: float, gap: float, dominoes: int = 60) -> float:
    """Return the speed of the wave far from its start by the formula [m/s]."""
    pitch = gap + thickness
    mass_free_inertia = (height**2 + thickness**2) / 3
    hit = np.arcsin(gap / height)
    angles = np.linspace(0, hit, 2001)
    speed = 1.0
    duration = np.inf
    for count in range(1, dominoes):
        # From the front to the tail: the angles, and how fast each turns beside the first.
        angle, rate = angles, np.ones_like(angles)
        inertia, potential = np.zeros_like(angles), np.zeros_like(angles)
        for _ in range(count):
            inertia += mass_free_inertia * rate**2
            potential += GRAVITY * (height * np.cos(angle) + thickness * np.sin(angle)) / 2
            lean = np.arcsin(np.clip((pitch * np.cos(angle) - thickness) / height, -1, 1))
            rate = rate * (1 - pitch * np.sin(angle) / (height * np.cos(lean)))
            angle = angle + lean
        energy = inertia[0] * speed**2 / 2 + potential[0]
        speeds = np.sqrt(np.maximum(2 * (energy - potential) / inertia, 1e-12))
        duration = np.trapezoid(1 / speeds, angles)
        # The blow: what all of them have of momentum is shared with the next, which was at rest.
        speed = speeds[-1] * inertia[-1] / (inertia[-1] + mass_free_inertia)
    return pitch / float(duration)


def measured_speed(
    height: float, thickness: float, gap: float, dominoes: int = 40, physics: str = "balanced"
) -> float:
    """Return the speed of the wave over the second half of a row [m/s]."""
    pitch = gap + thickness
    builder = kinetix.LevelBuilder("Dominoes", gravity=(0.0, -GRAVITY), arena=False)
    # Friction is 0.4·√(f_a² + f_b²): plenty on the floor, none between dominoes.
    length = (dominoes + 10) * pitch
    builder.rectangle(length / 2 - 1, -0.5, length + 2, 1, fixed=True, friction=5)
    row = [
        builder.rectangle(k * pitch, height / 2, thickness, height, friction=0)
        for k in range(dominoes)
    ]
    level = builder.build()
    # The first one gets a push: it turns about its lower front edge.
    spin = -3.0
    first = level.body(row[0]).replace(
        angular_velocity=spin, velocity=(-spin * height / 2, -spin * thickness / 2)
    )
    level = level.replace(bodies=(level.bodies[0], first, *level.bodies[2:]))
    run = kinetix.simulate(level, 0.15 * dominoes, physics=physics)
    # A domino is hit when it begins to turn; between two steps it turns evenly.
    turned = -run.rotation[:, [run.index(body) for body in row]]
    threshold = 0.02
    arrival = []
    for angle in turned.T[dominoes // 2 : -2]:
        after = int(np.argmax(angle > threshold))
        share = (threshold - angle[after - 1]) / (angle[after] - angle[after - 1])
        arrival.append(run.time[after - 1] + share * (run.time[after] - run.time[after - 1]))
    return pitch * (len(arrival) - 1) / (arrival[-1] - arrival[0])


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dominoes", type=int, default=40)
    parser.add_argument("--physics", default="balanced")
    arguments = parser.parse_args()
    if arguments.dominoes < FEWEST:
        parser.error(f"--dominoes {arguments.dominoes}: expected at least {FEWEST}")
    height, thickness = 0.4, 0.05
    print("gap [m]  formula [m/s]  measured [m/s]  difference")
    for gap in (0.1, 0.15, 0.2):
        wanted = wave_speed(height, thickness, gap)
        found = measured_speed(height, thickness, gap, arguments.dominoes, arguments.physics)
        print(f"{gap:7.2f}  {wanted:13.3f}  {found:14.3f}  {found / wanted - 1:+10.1%}")


if __name__ == "__main__":
    with one_sentence():
        main()
