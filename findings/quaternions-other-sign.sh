#!/usr/bin/env bash
# Guess: q and -q are one attitude, so that the attitude half of the way between two attitudes, and the mean of them,
# does not depend on the signs that they are stored with.
# Observed: half of the way from level to a yaw of 0.2 rad that is stored as -q is a yaw of 0.1 for pyquaternion
# and for numpy-quaternion's slerp, and -3.04 rad for quaternionic and pytransform3d. The mean of yaws of 0.1 and 0.2
# with one sign turned is -2.99 rad by numpy-quaternion's mean_rotor_in_chordal_metric, and its squad, at half of the
# way between them, is at 0.54. Its rotation vector of -q for a yaw of 0.1 is -6.18 rad.
# Why it matters: logs and motion capture change the sign in flight. A resampled, smoothed or averaged attitude then
# points backwards for one sample, or for the mean of a whole hover, and each library needs another precaution: unflip
# the signs first.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile numpy-quaternion==2024.0.13 quaternionic==1.0.18 pytransform3d==3.17.0 pyquaternion==0.9.9 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import math
from importlib.metadata import version
import numpy as np
import pytransform3d.rotations as pr
import quaternion
import quaternionic
from pyquaternion import Quaternion

for name in ('numpy-quaternion', 'quaternionic', 'pytransform3d', 'pyquaternion'):
    print(name, version(name))


def yaw(w, z):
    return 2 * math.atan2(z, w)


level, turned = np.array([1.0, 0, 0, 0]), -np.array([math.cos(0.1), 0, 0, math.sin(0.1)])
half = {
    'pyquaternion': Quaternion.slerp(Quaternion(level), Quaternion(turned), 0.5).elements,
    'numpy-quaternion': quaternion.as_float_array(quaternion.slerp_evaluate(quaternion.quaternion(*level), quaternion.quaternion(*turned), 0.5)),
    'quaternionic': quaternionic.slerp(quaternionic.array(level), quaternionic.array(turned), 0.5).ndarray,
    'pytransform3d': pr.quaternion_slerp(level, turned, 0.5),
}
half = {name: (yaw(q[0], q[3]) + math.pi) % (2 * math.pi) - math.pi for name, q in half.items()}
print('half of the way from 0 to a yaw of 0.2, rad:', {name: round(angle, 2) for name, angle in half.items()})
for name, angle in half.items():
    assert abs(angle - (0.1 if name in ('pyquaternion', 'numpy-quaternion') else 0.1 - math.pi)) < 1e-9

attitudes = quaternion.from_rotation_vector(np.array([[0, 0, 0.0], [0, 0, 0.1], [0, 0, 0.2]]))
attitudes[2] = -attitudes[2]
mean = quaternion.as_rotation_vector(quaternion.mean_rotor_in_chordal_metric(attitudes[1:]))[2]
between = quaternion.as_rotation_vector(quaternion.squad(attitudes, np.array([0.0, 1, 2]), np.array([1.5])))[0, 2]
vector = quaternion.as_rotation_vector(-attitudes[1])[2]
print(f'numpy-quaternion: mean of 0.1 and 0.2 {mean:.2f}, squad half of the way between them {between:.2f}, rotation vector of -q for 0.1 {vector:.2f}')
assert abs(mean + 2.99) < 0.01 and abs(between - 0.54) < 0.01 and abs(vector + 6.18) < 0.01
EOF
