"""Rotor commands for crazyflow's `Sim`, for all of its worlds and drones at once.

    sim = Sim(n_worlds=100, drone="cf21B_500", dynamics="first_principles", control="rotor_vel")
    control = RotorControl("cf21B_500")
    for _ in range(500):
        control.step(sim, reference)      # commands the rotors and steps the simulation by 2 ms

The simulation runs at 500 Hz, as the law does. Its rotors start at rest: `control.start(sim)` gives them the speed of hover.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from quatrack import Reference
from quatrack.integrations import drone_models


class RotorControl(drone_models.RotorControl):
    """As for drone-models, with crazyflow's figures; `step` reads the states of a simulation and steps it."""

    def _figures(self, drone: str) -> dict[str, Any]:
        from crazyflow.dynamics import Dynamics, load_params

        return dict(load_params(Dynamics.first_principles, drone))

    def start(self, sim: Any) -> None:
        """Lets the rotors of all drones turn at hover."""
        states = sim.data.states
        sim.data = sim.data.replace(states=states.replace(rotor_vel=states.rotor_vel * 0 + self.hover_rpm))

    def step(self, sim: Any, reference: Reference) -> None:
        """Commands the rotors of all drones for their states, and steps the simulation once.

        reference: a row for each drone of each world, world by world, or one for all
        """
        if sim.freq != self.controller.rate_hz:
            raise ValueError(f"freq: {sim.freq}; the law is made for {self.controller.rate_hz} Hz")
        states = sim.data.states
        pos, quat, vel, ang_vel = (np.asarray(part) for part in (states.pos, states.quat, states.vel, states.ang_vel))
        sim.rotor_vel_control(self(pos, quat, vel, ang_vel, reference).astype(np.float32))
        sim.step(1)
