#!/usr/bin/env bash
# Guess: a time-optimal parameterisation under a limit of the acceleration stays under it, to a part in a thousand or
# so.
# Observed: with the default way of turning the result into a trajectory (a spline through it), a square of 1 m
# under 3 m/s^2 per axis is flown with up to 3.22 m/s^2, and above 3.03 for 3 % of the time. With 21 grid points it is
# 3.95. parametrizer='ParametrizeConstAccel' stays at 3.00, in the same time of 3.49 s.
# Why it matters: the limit that is given is the one of the motors. The seven percent are taken where the trajectory
# is at its limit already, so that a planner's feasible trajectory saturates, and a check at the grid points does not
# see it.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile toppra==0.6.10 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
import toppra
from toppra.algorithm import TOPPRA
from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint

print('toppra', version('toppra'))
toppra.setup_logging('ERROR')
square = toppra.SplineInterpolator([0, 1, 2, 3, 4], np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0.0]]))
limits = [JointVelocityConstraint(np.array([[-2.0, 2]] * 2)), JointAccelerationConstraint(np.array([[-3.0, 3]] * 2))]
worst = {}
for name, how in (('default', {}), ('21 grid points', dict(gridpoints=np.linspace(0, 4, 21))), ('ParametrizeConstAccel', dict(parametrizer='ParametrizeConstAccel'))):
    trajectory = TOPPRA(limits, square, **how).compute_trajectory(0, 0)
    acceleration = abs(trajectory(np.linspace(0, trajectory.duration, 20001), 2)).max(axis=1)
    worst[name] = acceleration.max()
    print(f'{name}: {trajectory.duration:.3f} s, up to {acceleration.max():.3f} m/s^2, above 3.03 for {100 * (acceleration > 3.03).mean():.1f} % of the time')
assert worst['default'] > 3.1 and worst['21 grid points'] > 3.5 and worst['ParametrizeConstAccel'] < 3.01
EOF
