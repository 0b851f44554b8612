#!/usr/bin/env bash
# Guess: two poses are equal if they are the same pose, the exponential of a pose's logarithm is the pose, and
# (a b) / b is a.
# Observed: a pose is equal to the pose with the opposite translation: (1, 2, 3) and (-1, -2, -3) with the same turn.
# With a turn of 90 degrees about z the exponential of the logarithm moves to (-0.5, 1.5, 0) instead of (1, 2, 3). The
# quotient keeps the turn and moves to (1.17, 0.01, 1.48). The inverse, the powers and the interpolation are right.
# Why it matters: a pose of a camera or a marker that was to be compared with its last one is the same on the other
# side of the craft, and errors that are formed by logarithms lose the height.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps dual-quaternions==0.4.0 pyquaternion==0.9.9 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
from dual_quaternions import DualQuaternion
from pyquaternion import Quaternion

print('dual-quaternions', version('dual-quaternions'))


def pose(axis, degrees, place):
    return DualQuaternion.from_quat_pose_array([*Quaternion(axis=axis, degrees=degrees).elements, *place])


def at(p):
    return np.round(np.array(p.translation(), dtype=float), 3) + 0


a, b = pose([0, 0, 1], 90, [1, 2, 3]), pose([1, 0, 0], 40, [0, 5, 1])
other = pose([0, 0, 1], 90, [-1, -2, -3])
print('the poses at', at(a), 'and', at(other), 'are equal:', bool(a == other))
assert a == other and not a == pose([0, 0, 1], 90, [1, 2, 4])

by_matrix = a.homogeneous_matrix() @ b.homogeneous_matrix() @ np.linalg.inv(b.homogeneous_matrix())
back, quotient, right = a.log().exp(), (a * b) / b, (a * b) * b.inverse()
print('exp(log(a))', at(back), '(a b) / b', at(quotient), 'by the inverse', at(right), 'by matrices', np.round(by_matrix[:3, 3], 3))
assert np.allclose(by_matrix[:3, 3], [1, 2, 3]) and np.allclose(at(right), [1, 2, 3]) and np.allclose(at(a.pow(0.5) * a.pow(0.5)), [1, 2, 3])
assert np.allclose(at(back), [-0.5, 1.5, 0]) and np.allclose(at(quotient), [1.175, 0.013, 1.48], atol=2e-3)
assert np.isclose(quotient.q_r.degrees, 90) and np.isclose(back.q_r.degrees, 90)
EOF
