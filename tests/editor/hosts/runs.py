"""Training runs as they lie on disk, without the training: entity agents, metrics, a curriculum."""

import json
import math
from pathlib import Path

import jax

from kinetix.agents.agent import Agent, save_agent
from kinetix.agents.card import AgentCard, CapacityCard
from kinetix.agents.from_card import init_parameters
from kinetix.level.codec import load_level
from kinetix.training.curricula.pages import GoneLevel, ListedLevel, PageHead, write_page
from tests.agents.tiny import NETWORK

UPDATES, STEPS = 12, 256
LEVELS = ("s/goalkeeper", "s/hang_on", "s/first_flight", "s/plank_dash")
RATE = "eval_avg/hand_designed_episode_solve_rate_s/hang_on"


def write_run(folder: Path, seed: int) -> None:
    """Write a run of ACCEL with three checkpoints and three pages of its level buffer."""
    folder.mkdir(parents=True)
    rows = [_row(update, seed) for update in range(1, UPDATES + 1)]
    (folder / "metrics.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    for update in (4, 8, 12):
        card = AgentCard(
            name="accel",
            network=NETWORK,
            capacity=CapacityCard(
                polygons=5, circles=2, joints=1, thrusters=1, motor_bindings=4, thruster_bindings=2
            ),
            training={"algorithm": "accel", "seed": seed, "env_steps": update * STEPS},
        )
        parameters = init_parameters(card, jax.random.key(100 * seed + update))
        save_agent(Agent(card, parameters), folder / "checkpoints" / str(update * STEPS))
    for update in (4, 8, 12):
        _write_page(folder, update)


def _row(update: int, seed: int) -> dict[str, float]:
    rate = 1 / (1 + math.exp(3 - update / 2 + seed))
    return {
        "timing/num_updates": update,
        "timing/num_env_steps": update * STEPS,
        "episode_return": 2 * rate - 0.5 + 0.1 * math.sin(5 * update + seed),
        "episode_solved": rate,
        "loss/entropy": 1.5 - 0.05 * update,
    } | ({RATE: rate} if update % 4 == 0 else {})


def _write_page(folder: Path, update: int) -> None:
    chosen = LEVELS if update < UPDATES else tuple(reversed(LEVELS))
    listed = tuple(
        ListedLevel(
            serial=10 * update + k,
            score=0.4 - 0.1 * k,
            learnability=0.25 - 0.05 * k,
            solve_rate=0.5,
            episodes=8,
            born=update - k,
            kind="mutated" if k else "new",
            ancestry=(3, 1) if k else (),
        )
        for k in range(len(chosen))
    )
    gone = (GoneLevel(serial=7, update=update, reason="outscored", by=9, score=0.1, solve_rate=1),)
    head = PageHead(
        algorithm="accel",
        update=update,
        env_steps=update * STEPS,
        capacity=16,
        filled=len(listed),
        entered=2,
        left=1,
        score_quartiles=(0.1, 0.2, 0.3),
        levels=listed,
        gone=gone,
    )
    write_page(folder, head, [load_level(name) for name in chosen], {})
