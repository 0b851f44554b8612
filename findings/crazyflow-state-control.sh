#!/usr/bin/env bash
# Guess: a Crazyflie that starts at rest on its setpoint, one metre up, with its motors' model and controller from one
# package, stays there.
# Observed: the motors start at 0 rpm, so that it falls at once: 5 cm with the Brushless, 47 cm with the 2.x
# before it is caught. It does not come back to 1 m: after 3 s it is at 1.09 m (Brushless), 0.98 m (2.x), 1.05 m
# (upgrade kit), since the position controller's mass and thrust scale are not the model's and its integrator is
# bounded.
# Why it matters: the first second of a comparison measures the start of the motors and not the controller, and a
# height error of centimetres is the simulator's.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile crazyflow==0.4.0 jax==0.10.1 mujoco==4.0.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import os

os.environ['JAX_PLATFORMS'] = 'cpu'
from importlib.metadata import version
from crazyflow.control import Control
from crazyflow.dynamics import Dynamics
from crazyflow.sim import Sim
import numpy as np

print('crazyflow', version('crazyflow'))
expected = {'cf21B_500': (0.95, 1.09), 'cf2x_L250': (0.53, 0.98), 'cf2x_T350': (0.89, 1.05)}
for drone, (lowest, last) in expected.items():
    sim = Sim(drone=drone, control=Control.state, dynamics=Dynamics.first_principles)
    sim.reset()
    states = sim.data.states
    sim.data = sim.data.replace(states=states.replace(pos=states.pos.at[..., 2].set(1.0)))
    rpm = float(np.abs(states.rotor_vel).max())
    command = np.zeros((1, 1, 16))
    command[..., 2] = 1.0
    command[..., 12] = 1.0  # level: the last component of the quaternion
    heights = []
    for _ in range(30):
        sim.state_control(command)
        sim.step(sim.freq // 10)
        heights.append(float(sim.data.states.pos[0, 0, 2]))
    print(f'{drone}: rotors start at {rpm:.0f} rpm; started at 1 m and told 1 m: lowest {min(heights):.2f} m, after 3 s {heights[-1]:.2f} m')
    assert rpm == 0 and abs(min(heights) - lowest) < 0.02 and abs(heights[-1] - last) < 0.01
EOF
