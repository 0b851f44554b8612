"""How many flight seconds a second RotorPy flies on this core: the eight under its SE3 controller at 500 Hz, vehicle, controller and
trajectory alone, without the sensors and records of its own loop. Times are processor times of this process.

    python rotorpy_rate.py [--flight-s 3] [--repeat 3]
"""

import argparse
import time
from importlib.metadata import version

import numpy as np
from rotorpy.controllers.quadrotor_control import SE3Control
from rotorpy.trajectories.lissajous_traj import TwoDLissajous
from rotorpy.vehicles.crazyfliebrushless_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor

arguments = argparse.ArgumentParser()
arguments.add_argument("--flight-s", type=float, default=3.0)
arguments.add_argument("--repeat", type=int, default=3)
asked = arguments.parse_args()

RATE_HZ = 500
rate = 2.1 / np.sqrt(2.0)
trajectory = TwoDLissajous(A=1.0, B=0.5, a=rate, b=2 * rate, height=1.0)
hover = np.sqrt(quad_params["mass"] * 9.81 / 4 / quad_params["k_eta"])


def fly():
    vehicle = Multirotor(quad_params, aero=False)
    controller = SE3Control(quad_params)
    flat = trajectory.update(0.0)
    state = {
        "x": flat["x"].astype(float),
        "v": flat["x_dot"].astype(float),
        "q": np.array([0.0, 0.0, 0.0, 1.0]),
        "w": np.zeros(3),
        "wind": np.zeros(3),
        "rotor_speeds": np.full(4, hover),
    }
    most, begun = 0.0, time.process_time()
    for step in range(int(asked.flight_s * RATE_HZ)):
        flat = trajectory.update(step / RATE_HZ)
        control = controller.update(step / RATE_HZ, state, flat)
        state = vehicle.step(state, control, 1 / RATE_HZ)
        most = max(most, float(np.linalg.norm(state["x"] - flat["x"])))
    return time.process_time() - begun, most


flights = [fly() for _ in range(asked.repeat)]
best, most = min(flights)
print(
    f"rotorpy {version('rotorpy')}: {1e3 * best * 30.0 / asked.flight_s:.0f} ms for 30 s, {asked.flight_s / best:.2f} flight seconds a second; "
    f"at most {most:.2f} m off"
)
