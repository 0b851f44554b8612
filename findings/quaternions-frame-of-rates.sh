#!/usr/bin/env bash
# Guess: a package that integrates an angular velocity into a quaternion takes a gyro's measurement, the rate in the
# body's frame, and one that gives the angular velocity of a series of attitudes gives that.
# Observed: numpy-quaternion's integrate_angular_velocity and pytransform3d's quaternion_integrate take it in the
# world's frame, and quaternion_gradient and angular_velocity return it there; pyquaternion's integrate takes the
# body's. Rolled by 90 degrees and turning about the body's z axis by 1 rad, the first two end 1.38 rad away from the
# attitude that the gyro turned to. Level craft see no difference.
# Why it matters: a test that starts level and turns in yaw passes with either frame. A filter's reference, or the
# feed-forward rates of a trajectory, that are made this way are wrong as soon as the craft tilts.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile numpy-quaternion==2024.0.13 pytransform3d==3.17.0 pyquaternion==0.9.9 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import math
from importlib.metadata import version
import numpy as np
import pytransform3d.rotations as pr
import quaternion
from pyquaternion import Quaternion

for name in ('numpy-quaternion', 'pytransform3d', 'pyquaternion'):
    print(name, version(name))


def apart(a, b):
    return 2 * math.acos(min(1.0, abs(float(np.dot(a, b)))))


rate, times = np.tile([0.0, 0, 1], (101, 1)), np.linspace(0, 1, 101)
for roll in (0, 90):
    start = Quaternion(axis=[1, 0, 0], degrees=roll)
    want = (start * Quaternion(axis=[0, 0, 1], radians=1.0)).elements
    stepped = Quaternion(start)
    for _ in range(100):
        stepped.integrate([0, 0, 1.0], 0.01)
    _, turned = quaternion.integrate_angular_velocity((times, rate), 0.0, 1.0, R0=quaternion.quaternion(*start.elements))
    off = {
        'pyquaternion': apart(stepped.elements, want),
        'numpy-quaternion': apart(quaternion.as_float_array(turned[-1]), want),
        'pytransform3d': apart(pr.quaternion_integrate(rate, start.elements, dt=0.01)[-1], want),
    }
    print(f'rolled by {roll}, 1 rad about the body z axis; rad off:', {name: round(angle, 3) for name, angle in off.items()})
    assert off['pyquaternion'] < 1e-6
    assert all((abs(off[name] - 1.383) < 0.005) if roll else off[name] < 1e-4 for name in ('numpy-quaternion', 'pytransform3d'))

series = np.array([(Quaternion(axis=[1, 0, 0], degrees=90) * Quaternion(axis=[0, 0, 1], radians=t)).elements for t in times])
print('rate of the turn about the body z axis:', 'pytransform3d', np.round(pr.quaternion_gradient(series, dt=0.01)[50], 3) + 0.0,
      'numpy-quaternion', np.round(quaternion.angular_velocity(quaternion.as_quat_array(series), times)[50], 3) + 0.0)
assert abs(pr.quaternion_gradient(series, dt=0.01)[50][1] + 1) < 1e-3
assert abs(quaternion.angular_velocity(quaternion.as_quat_array(series), times)[50][1] + 1) < 1e-3
EOF
