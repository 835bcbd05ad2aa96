"""Measure other JAX programs with the compiler options of `import kinetix` and without them.

Usage: python -m scripts.ordinary_programs [--rounds N]

Four programs that have nothing to do with Kinetix are compiled and run in processes of their own.
Printed are processor seconds to compile, and milliseconds a run: medians over all processes.
"""

import argparse
import collections
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

from kinetix.compiler import DECLINED

RUNS = 40


def programs() -> dict[str, tuple[Callable[..., Any], tuple[Any, ...]]]:
    """Return functions and their arguments."""
    import jax
    import jax.numpy as jnp

    def normal(seed: int, *shape: int) -> jax.Array:
        return jax.random.normal(jax.random.key(seed), shape) / shape[-1] ** 0.5

    def convolved(weights: Any, pictures: jax.Array) -> jax.Array:
        for kernel in weights:
            pictures = jax.nn.relu(jax.lax.conv(pictures, kernel, (1, 1), "SAME"))
        return jnp.mean(pictures**2)

    def attended(weights: Any, words: jax.Array) -> jax.Array:
        query, key, value, up, down = weights
        scores = jax.nn.softmax((words @ query) @ jnp.swapaxes(words @ key, -1, -2))
        words = words + scores @ (words @ value)
        return jnp.mean((words + jax.nn.gelu(words @ up) @ down) ** 2)

    def turned(weights: jax.Array, state: jax.Array) -> jax.Array:
        def turn(state: jax.Array, _: None) -> tuple[jax.Array, None]:
            return jnp.tanh(state @ weights), None

        return jnp.sum(jax.lax.scan(turn, state, None, length=200)[0] ** 2)

    kernels = tuple(normal(k, 16, 16, 3, 3) for k in range(3))
    block = (*(normal(k, 64, 64) for k in range(3)), normal(3, 64, 256), normal(4, 256, 64))
    square = normal(5, 64, 64)
    return {
        "three convolutions, 4 × 16 × 32 × 32": (convolved, (kernels, normal(6, 4, 16, 32, 32))),
        "transformer block, 16 × 64 × 64": (attended, (block, normal(7, 16, 64, 64))),
        "scan of 200 steps, vector of 64": (turned, (square, normal(8, 64))),
        "scan of 200 steps, 32 × 64": (turned, (square, normal(9, 32, 64))),
    }


def measure() -> None:
    """Compile and run each program's gradient here; prints a row each."""
    import kinetix  # noqa: F401, I001 (its options, before JAX starts)
    import jax

    for name, (function, arguments) in programs().items():
        before = time.process_time()
        program = jax.jit(jax.grad(function)).lower(*arguments).compile()
        compiled = time.process_time() - before
        jax.block_until_ready(program(*arguments))
        taken = []
        for _ in range(RUNS):
            before = time.process_time()
            jax.block_until_ready(program(*arguments))
            taken.append(time.process_time() - before)
        row = {"name": name, "compile_s": compiled, "run_ms": 1e3 * statistics.median(taken)}
        sys.stdout.write(json.dumps(row) + "\n")


def main() -> None:
    """Measure in turn, print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.here:
        measure()
        return
    told: dict[str, Any] = collections.defaultdict(lambda: collections.defaultdict(list))
    for _ in range(given.rounds):
        for asked in ("0", "1"):
            variables = os.environ | {
                DECLINED: asked,
                "JAX_PLATFORMS": "cpu",
                "JAX_ENABLE_COMPILATION_CACHE": "false",
            }
            done = subprocess.run(
                [sys.executable, "-m", "scripts.ordinary_programs", "--here"],
                env=variables,
                capture_output=True,
                text=True,
                check=True,
            )
            for line in done.stdout.splitlines():
                row = json.loads(line)
                for what in ("compile_s", "run_ms"):
                    told[row["name"]][what, asked].append(row[what])
    sys.stdout.write("| | compile, without / with [s] | run, without / with [ms] |\n")
    sys.stdout.write("| --- | ---: | ---: |\n")
    for name, row in told.items():
        cells = [
            " / ".join(f"{statistics.median(row[what, asked]):.2f}" for asked in ("0", "1"))
            for what in ("compile_s", "run_ms")
        ]
        sys.stdout.write(f"| {name} | {' | '.join(cells)} |\n")


if __name__ == "__main__":
    main()
