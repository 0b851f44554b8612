"""Where the repository's files are, and crafts to step."""

from pathlib import Path

import numpy as np
import pytest

import quatrack as q

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def brushless():
    """The eight in air of the README."""
    return ROOT / "docs" / "scenarios" / "brushless-eight.toml"


def random_crafts(count, seed=1):
    """States and references of crafts near their references."""
    rng = np.random.default_rng(seed)
    near = lambda width, spread: rng.normal(scale=spread, size=(count, width))
    attitude = np.hstack([np.ones((count, 1)), near(3, 0.1)])
    attitude /= np.linalg.norm(attitude, axis=1, keepdims=True)
    position, velocity = near(3, 0.5), near(3, 0.5)
    state = q.State(
        position + near(3, 0.02), attitude, velocity + near(3, 0.02), near(3, 0.5), near(3, 0.2) + [0, 0, 9.81]
    )
    reference = q.Reference(
        position, velocity, near(3, 1.0), near(3, 2.0), near(3, 4.0), near(3, 8.0), heading=rng.uniform(-0.5, 0.5, count)
    )
    return state, reference


def row_of(state, reference, row):
    """One craft of them."""
    one_state = q.State(
        *[getattr(state, name)[row] for name in ("position", "attitude", "velocity", "body_rates", "specific_force")]
    )
    one_reference = q.Reference(
        *[getattr(reference, name)[row] for name in ("position", "velocity", "acceleration", "jerk", "snap", "crackle")],
        heading=reference.heading[row],
    )
    return one_state, one_reference
