"""How many flight seconds a second crazyflow flies on this core: the eight at its own state controller, Runge-Kutta 4 at 500 Hz, whole
flights in one compiled scan. Times are processor times of this process, without compilation.

    python crazyflow_rate.py [--flight-s 30] [--batch 1000] [--repeat 3]
"""

import argparse
import os
import time
from importlib.metadata import version

arguments = argparse.ArgumentParser()
arguments.add_argument("--flight-s", type=float, default=30.0, help="more than 5")
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

# The eight at 2.1 m/s: x = sin(phase), y = sin(2 phase) / 2, at 1 m, after 2 s of hover and 3 s in which it gathers speed.
FROM_S = 5.0
rate = 2.1 / np.sqrt(2.0)
times = np.arange(int(asked.flight_s * SETPOINTS_HZ)) / SETPOINTS_HZ
share = np.clip((times - 2.0) / 3.0, 0.0, 1.0)
speed = rate * (10 * share**3 - 15 * share**4 + 6 * share**5)
quickening = rate * (30 * share**2 - 60 * share**3 + 30 * share**4) / 3.0
phase = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) / SETPOINTS_HZ)])
command = np.zeros((len(times), 16), dtype=np.float32)
command[:, 0], command[:, 1], command[:, 2] = np.sin(phase), 0.5 * np.sin(2 * phase), 1.0
command[:, 3], command[:, 4] = speed * np.cos(phase), speed * np.cos(2 * phase)
command[:, 6] = quickening * np.cos(phase) - speed**2 * np.sin(phase)
command[:, 7] = quickening * np.cos(2 * phase) - 2 * speed**2 * np.sin(2 * phase)
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
error = float(jnp.max(jnp.linalg.norm(places - commands[:, :3], axis=-1)[times >= FROM_S]))


def processor_s():
    begun = time.process_time()
    jax.block_until_ready(fly(start, commands))
    return time.process_time() - begun


best = min(processor_s() for _ in range(asked.repeat))
print(
    f"crazyflow {version('crazyflow')}: batch of {asked.batch}, {1e3 * best / asked.batch * 30.0 / asked.flight_s:.3f} ms for 30 s, "
    f"{asked.batch * asked.flight_s / best:.0f} flight seconds a second; at most {error:.2f} m off once it has its speed"
)
