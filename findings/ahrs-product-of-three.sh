#!/usr/bin/env bash
# Guess: with a class for quaternions, yaw * pitch * roll is the product of the three.
# Observed: the product of two Quaternions of ahrs is right and is a plain array. The third factor is therefore
# multiplied entry by entry: 30, 20 and 10 degrees become (0.948, -0.004, 0, 0), of length 0.948, with no error. yaw *
# (pitch * roll) is right, and so is wrapping each product in Quaternion again.
# Why it matters: a chain of frames (room, craft, sensor) is three factors. The result looks like a quaternion
# near level, and a normalisation on the way makes it one.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps ahrs==0.4.0 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
import math
from importlib.metadata import version
import numpy as np
from ahrs import Quaternion

print('ahrs', version('ahrs'))
yaw, pitch, roll = (Quaternion(np.r_[math.cos(math.radians(a) / 2), math.sin(math.radians(a) / 2) * np.array(axis)])
                    for a, axis in ((30, (0, 0, 1)), (20, (0, 1, 0)), (10, (1, 0, 0))))
left, right = np.asarray(yaw * pitch * roll), np.asarray(yaw * (pitch * roll))
want = np.asarray(Quaternion(rpy=np.radians([10, 20, 30])))
print('type of a product:', type(yaw * pitch).__name__)
print('yaw * pitch * roll:', np.round(left, 3), 'length', round(float(np.linalg.norm(left)), 3))
print('yaw * (pitch * roll):', np.round(right, 3), 'expected', np.round(want, 3))
assert type(yaw * pitch) is np.ndarray
assert np.allclose(left, np.asarray(yaw * pitch) * np.asarray(roll)) and abs(np.linalg.norm(left) - 0.948) < 1e-3
assert np.allclose(right, want)
EOF
