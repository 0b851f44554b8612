#!/usr/bin/env bash
# Guess: Euler angles to a matrix and back, in a quadcopter library, is exact to single precision away from a pitch of
# 90 degrees, and still the same rotation at it.
# Observed: at a pitch of 90 degrees, and of 89.99 already, roll comes back as 0 and yaw takes the sum with the
# wrong sign: roll 10, yaw 30 become roll 0, yaw -20, a rotation 40 degrees away from the one that went in. At 80
# degrees all is well.
# Why it matters: a flip or a throw passes there. A controller that stores its attitude as angles between two steps
# gets a jump of 40 degrees for one sample.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps mini-quadlib==0.2.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import mini_quadlib
import numpy as np
from scipy.spatial.transform import Rotation

print('mini-quadlib', version('mini-quadlib'))
off = {}
for pitch in (80, 89, 89.9, 89.99, 90):
    matrix = mini_quadlib.euler_to_rotation_matrix(np.radians([10, pitch, 30]))
    angles = mini_quadlib.rotation_matrix_to_euler(matrix)
    back = mini_quadlib.euler_to_rotation_matrix(angles)
    difference = Rotation.from_matrix(matrix.to_array().astype(float).T @ back.to_array().astype(float))
    off[pitch] = np.degrees(difference.magnitude())
    print(f'roll 10, pitch {pitch}, yaw 30 come back as {np.round(np.degrees(angles), 2)}: {off[pitch]:.2f} degrees away')
assert off[80] < 1e-3 and off[89] < 0.1
assert abs(off[89.99] - 40) < 0.1 and abs(off[90] - 40) < 0.1
EOF
