"""crazyflow's simulation, and its own state control."""

import numpy as np

from needed import need

need("crazyflow")

from crazyflow.sim import Sim

import quatrack as q
from quatrack.integrations import _table
from quatrack.integrations.crazyflow import RotorControl


def test_worlds_of_drones_hover_where_they_are_told():
    control = RotorControl("cf21B_500")
    sim = Sim(n_worlds=3, n_drones=2, drone="cf21B_500", control="rotor_vel", dynamics="first_principles")
    sim.reset()
    goals = np.asarray(sim.data.states.pos).reshape(-1, 3) + [0.0, 0.0, 1.0]
    control.start(sim)
    for _ in range(1500):
        control.step(sim, q.Reference(goals))
    # Three seconds on, within a centimetre.
    assert np.abs(np.asarray(sim.data.states.pos).reshape(-1, 3) - goals).max() < 0.01


def test_the_eight_flies_nearer_than_under_its_own_controller():
    rows = list(_table.crazyflow(_table.Flown.eight(6.0)))
    assert len(rows) == 4 and all(row.is_won() for row in rows), rows
