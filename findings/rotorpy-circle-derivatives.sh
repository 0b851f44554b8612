#!/usr/bin/env bash
# Guess: a trajectory's jerk is the derivative of its acceleration and its snap that of its jerk, and a craft in the package has an
# inertia that a body can have.
# What happens: along z the circle's jerk and snap have the wrong sign, as has the second derivative of its yaw; the other
# trajectories are right. The inertia of the Crazyflie 2.1 about z, 2.89e-5 kg m^2, exceeds the sum of those about x and y, 2.86e-5,
# which is that of no arrangement of masses; the Brushless's and the Hummingbird's are sound.
# Why it matters: a controller that feeds the jerk forward does on a circle that goes up and down what takes it off the course, and
# comes out worse than one that does not. A tool that checks its inertia refuses the package's first craft.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile rotorpy==3.0.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
from rotorpy.trajectories.circular_traj import ThreeDCircularTraj
from rotorpy.trajectories.lissajous_traj import TwoDLissajous
from rotorpy.vehicles.crazyflie_params import quad_params as brushed
from rotorpy.vehicles.crazyfliebrushless_params import quad_params as brushless
import numpy as np

print('rotorpy', version('rotorpy'))
h, t = 1e-5, 0.6
circle = ThreeDCircularTraj(np.zeros(3), np.array([1.0, 1.0, 0.5]), np.array([0.2, 0.2, 0.3]), yaw_bool=True)
eight = TwoDLissajous(A=1, B=0.5, a=1.5, b=3.0, height=1)
slope = lambda course, key: (course.update(t + h)[key] - course.update(t - h)[key]) / (2 * h)
for below, key in (('x_dot', 'x_ddot'), ('x_ddot', 'x_dddot'), ('x_dddot', 'x_ddddot')):
    given, true = circle.update(t)[key], slope(circle, below)
    print(f'circle {key}: true {np.round(true, 3)}, given {np.round(given, 3)}')
    assert np.allclose(given[:2], true[:2], atol=1e-6)
    assert np.isclose(given[2], true[2] if key == 'x_ddot' else -true[2], atol=1e-6)
    assert np.allclose(eight.update(t)[key], slope(eight, below), atol=1e-6)
given, true = circle.update(t)['yaw_ddot'], slope(circle, 'yaw_dot')
print(f'circle yaw_ddot: true {true:.3f}, given {given:.3f}')
assert np.isclose(given, -true, atol=1e-5)
for name, p in (('Crazyflie 2.1', brushed), ('Brushless', brushless)):
    print(f'{name}: about x and y together {p["Ixx"] + p["Iyy"]:.3g} kg m^2, about z {p["Izz"]:.3g}')
assert brushed['Izz'] > brushed['Ixx'] + brushed['Iyy'] and brushless['Izz'] < brushless['Ixx'] + brushless['Iyy']
EOF
