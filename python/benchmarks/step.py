"""Control steps of 10,000 crafts a second: laws of the core and drone-controllers' Mellinger in NumPy, in turns on one processor.

    python python/benchmarks/step.py [CRAFTS]

Both take states and setpoints in arrays and give forces or speeds of the motors in an array. The time is that of the calling thread, and
each has only one: other loads of the machine count for little.
"""

import os
import sys
import time

os.environ |= {"SCIPY_ARRAY_API": "1", "OPENBLAS_NUM_THREADS": "1"}

import numpy as np
from drone_controllers import parametrize
from drone_controllers.mellinger import control as mellinger

import quatrack as q

CRAFTS = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
ROUNDS = 15


def states():
    """Crafts near their references."""
    rng = np.random.default_rng(1)
    position, velocity, rates = (rng.normal(scale=s, size=(CRAFTS, 3)) for s in (0.05, 0.05, 0.1))
    attitude = np.hstack([np.ones((CRAFTS, 1)), rng.normal(scale=0.05, size=(CRAFTS, 3))])
    return position, attitude / np.linalg.norm(attitude, axis=1, keepdims=True), velocity, rates


position, attitude, velocity, rates = states()
# Their command has these too: position, velocity and acceleration of each craft.
setpoints = [np.zeros((CRAFTS, 3)) for _ in range(3)]
xyzw, command = np.roll(attitude, -1, axis=1), np.zeros((CRAFTS, 13))
outer, inner, motors = (
    parametrize(f, "cf21B_500") for f in (mellinger.state2attitude, mellinger.attitude2force_torque, mellinger.force_torque2rotor_vel)
)


def theirs():
    """Setpoints and states in arrays to rotor speeds in an array."""
    asked, _ = outer(position, xyzw, velocity, rates, command)
    force, torque, _ = inner(position, xyzw, velocity, rates, asked)
    return motors(force, torque)


def ours(controller):
    """Setpoints and states in arrays to motor forces in an array."""
    still = np.zeros(3)
    return lambda: controller.step(
        q.State(position, attitude, velocity, rates), q.Reference(*setpoints, jerk=still, snap=still)
    ).motor_forces


runs = {"drone-controllers Mellinger": theirs}
for law in ("quatrack", "lqr-e"):
    runs[f"quatrack {law}"] = ours(q.Controller(law, "crazyflie-2.1-brushless", threads=1))
times = {name: [] for name in runs}
for _ in range(ROUNDS):
    for name, run in runs.items():
        begun = time.thread_time()
        run()
        times[name].append(time.thread_time() - begun)
base = np.array(times["drone-controllers Mellinger"])
for name, taken in times.items():
    ratio = np.median(base / np.array(taken))
    print(f"{name:<36}{1e3 * np.median(taken):>9.2f} ms a step of all{CRAFTS / np.median(taken) / 1e6:>8.2f} M crafts/s{ratio:>8.1f} times")
