#!/usr/bin/env bash
# Guess: phi, theta and psi of a simulated quadcopter are roll, pitch and yaw, as in the list of initial states that
# it is given; a second craft is a craft of its own; a wind from 90 degrees blows from the side.
# Observed: given a roll of 0.1, a pitch of 0.2 and a yaw of 0.3 rad, it reports phi 0.3 and psi, which is also
# its heading, 0.1: psi goes to the controller as the yaw. The parameters of all craft are one dictionary with the
# mixer in it, so that making a second one with z upwards turns the signs of the first one's pitch and yaw. The wind's
# heading, in degrees by its comment, goes into a cosine as it is: at 90 it blows with 45 % of its speed from the
# front.
# Why it matters: a controller that holds a heading of 0 sees the roll as its heading's error. Level flight hides it,
# and so does a test of one craft.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps quad-sim-python==0.0.2 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
from quad_sim_python.quad import Quadcopter

print('quad-sim-python', version('quad-sim-python'))
craft = Quadcopter(0, [0, 0, 0, 0.1, 0.2, 0.3, 0, 0, 0, 0, 0, 0])
print(f'roll 0.1, pitch 0.2, yaw 0.3: phi {craft.phi:.1f}, theta {craft.theta:.1f}, psi {craft.psi:.1f}, heading {craft.heading:.1f}')
assert np.allclose([craft.phi, craft.theta, craft.psi, craft.heading], [0.3, 0.2, 0.1, 0.1])
mixer = craft.params['mixerFM'].copy()
Quadcopter(0, orient='ENU')
sign = [float(x) for x in np.sign(craft.params['mixerFM'][:, 0] * mixer[:, 0])]
print('signs of thrust, roll, pitch and yaw of the first craft, after a second was made:', sign)
assert sign == [1, 1, -1, -1]
rest = Quadcopter(0)
hover = [rest.params['w_hover']] * 4
for heading in (90, np.pi / 2):
    x, y = rest.state_dot(0, rest.state, hover, [5.0, heading, 0.0])[7:9]
    print(f'wind of 5 m/s from {heading:.2f}: accelerates by {x:.2f} along x, {y:.2f} along y, m/s^2')
    assert np.allclose([x, y], [-0.418, 1.665] if heading == 90 else [0, 2.083], atol=1e-3)
EOF
