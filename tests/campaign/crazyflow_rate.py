"""How many flight seconds a second crazyflow flies on this core: the eight at its own state controller, Runge-Kutta 4 at 500 Hz, whole
flights in one compiled scan.

    python crazyflow_rate.py [--flight-s 30] [--batch 1000] [--repeat 3]
"""

import argparse
import os
import time
from importlib.metadata import version

arguments = argparse.ArgumentParser()
arguments.add_argument("--flight-s", type=float, default=30.0)
arguments.add_argument("--batch", type=int, default=1000)
arguments.add_argument("--repeat", type=int, default=3)
asked = arguments.parse_args()
os.environ["JAX_PLATFORMS"] = "cpu"
# One core: it runs under taskset.
os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")

import jax
import jax.numpy as jnp
import numpy as np
from crazyflow.control import Control
from crazyflow.dynamics import Dynamics
from crazyflow.sim import Sim
from crazyflow.sim import functional
from crazyflow.sim.integration import Integrator

RATE_HZ, SETPOINTS_HZ = 500, 100
sim = Sim(
    n_worlds=asked.batch,
    drone="cf21B_500",
    dynamics=Dynamics.first_principles,
    control=Control.state,
    integrator=Integrator.rk4,
    freq=RATE_HZ,
    state_freq=SETPOINTS_HZ,
    attitude_freq=RATE_HZ,
)
sim.reset()

# The eight at 2.1 m/s: x = sin(w t), y = sin(2 w t) / 2, at 1 m.
rate = 2.1 / np.sqrt(2.0)
times = np.arange(int(asked.flight_s * SETPOINTS_HZ)) / SETPOINTS_HZ
command = np.zeros((len(times), 16), dtype=np.float32)
command[:, 0], command[:, 1], command[:, 2] = np.sin(rate * times), 0.5 * np.sin(2 * rate * times), 1.0
command[:, 3], command[:, 4] = rate * np.cos(rate * times), rate * np.cos(2 * rate * times)
command[:, 6], command[:, 7] = -(rate**2) * np.sin(rate * times), -2 * rate**2 * np.sin(2 * rate * times)
command[:, 12] = 1.0  # level: the last component of the quaternion
pipeline = tuple(sim.step_pipeline.values())


@jax.jit
def fly(data, commands):
    def setpoint(data, row):
        data = functional.state_control(data, jnp.broadcast_to(row, (asked.batch, 1, 16)))

        def step(data, _):
            for part in pipeline:
                data = part(data)
            return data, None

        data, _ = jax.lax.scan(step, data, length=RATE_HZ // SETPOINTS_HZ)
        return data, data.states.pos[0, 0]

    return jax.lax.scan(setpoint, data, commands)


states = sim.data.states
start = sim.data.replace(states=states.replace(pos=states.pos.at[..., 2].set(1.0)))
commands = jnp.asarray(command)
flown, places = jax.block_until_ready(fly(start, commands))
error = float(jnp.max(jnp.linalg.norm(places[300:] - commands[300:, :3], axis=-1)))
best = min(
    (lambda begun: (jax.block_until_ready(fly(start, commands)), time.perf_counter() - begun)[1])(time.perf_counter())
    for _ in range(asked.repeat)
)
print(
    f"crazyflow {version('crazyflow')}: batch of {asked.batch}, {1e3 * best / asked.batch * 30.0 / asked.flight_s:.3f} ms for 30 s, "
    f"{asked.batch * asked.flight_s / best:.0f} flight seconds a second; at most {error:.2f} m off after 3 s"
)
