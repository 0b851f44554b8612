#!/usr/bin/env bash
# Guess: PropellerParams(diameter=6), in inches, has a radius of 76 mm. set_params(resolution=..) of a trajectory sets
# the resolution.
# Observed: its R, documented as the radius in metres, is the diameter, 152 mm, and its disc area four times too
# large. The package's blade element thrust at 500 rad/s is 10 times that of the same propeller with half of R.
# set_params(resolution=0.5) leaves the resolution as it was and makes 0.5 m the distance at which a waypoint counts
# as reached.
# Why it matters: a thrust curve for a simulation or a vehicle file that is computed from the propeller's size, which
# is used before there is a thrust stand, is an order of magnitude off.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps multirotor==0.5.0 numpy==2.4.6 scipy==1.17.1 numba==0.68.1 llvmlite==0.50.0
cd "$dir"
venv/bin/python - <<'EOF'
import types
from importlib.metadata import version
import sys
import numpy as np

print('multirotor', version('multirotor'))
from multirotor.physics import thrust
from multirotor.vehicle import PropellerParams

p = PropellerParams(moment_of_inertia=1e-5, diameter=6, pitch=3, use_thrust_constant=False)
rest = (1.225, p.a, p.b, p.c, p.eta, p.theta0, p.theta1)
as_given = thrust(500.0, np.full(3, 1e-6), p.R, p.A, *rest)
halved = thrust(500.0, np.full(3, 1e-6), p.R / 2, p.A / 4, *rest)
print(f'6 inches across: R = {1e3 * p.R:.1f} mm, area {1e4 * p.A:.0f} cm^2; thrust {as_given:.2f} N, with half of R {halved:.2f} N')
assert abs(p.R - 6 * 0.0254) < 1e-12 and as_given > 9 * halved

sys.modules['multirotor.simulation'] = types.ModuleType('multirotor.simulation')  # a type hint's home, with heavy imports
sys.modules['multirotor.simulation'].Multirotor = object
from multirotor.trajectories import Trajectory

course = Trajectory(None, [[0, 0, 0], [1, 0, 0]], proximity=0.1, resolution=0.35)
course.set_params(resolution=0.5)
print('after set_params(resolution=0.5):', course.get_params())
assert course.get_params() == dict(proximity=0.5, resolution=0.35)
EOF
