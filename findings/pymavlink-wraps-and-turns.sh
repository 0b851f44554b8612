#!/usr/bin/env bash
# Guess: wrap_180 and wrap_360, which graphs of a log use, give an angle between -180 and 180, or 0 and 360;
# lowpass(value, key, 0.1) lets a tenth of a new value in; a rotation matrix that is turned by steps, or about an
# axis, stays one.
# Observed: they take off one turn at most: 550 degrees wraps to 190, 730 to 370. The factor 0.1 of lowpass is the
# weight of the old value: a step is at 0.9 after one sample. Matrix3.rotate by 1 rad turns by 45 degrees and makes
# the rows 1.41 long, a hundred steps of 0.01 rad make them 1.005, and only normalize puts it right; from_axis_angle
# about (0, 0, 2) by 0.5 rad turns by 0.83 and stretches by 1.3.
# Why it matters: a yaw that was summed up from a gyro, in a flight with two turns, is plotted beside the other one a
# turn off, and a smoothed channel is not smooth. A matrix whose rows grow half a percent per radian scales the
# acceleration that is turned by it.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps pymavlink==2.4.50 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import math

print('pymavlink', version('pymavlink'))
from pymavlink import mavextra
from pymavlink.rotmat import Matrix3, Vector3

wrapped = [mavextra.wrap_180(550.0), mavextra.wrap_360(730.0), mavextra.wrap_180(190.0)]
print('wrap_180(550), wrap_360(730), wrap_180(190):', wrapped)
assert wrapped == [190.0, 370.0, -170.0]
passed = [round(mavextra.lowpass(x, 'step', 0.1), 3) for x in (0.0, 1.0, 1.0)]
print('lowpass with 0.1 of a step:', passed)
assert passed == [0.0, 0.9, 0.99]
once, steps, about = Matrix3(), Matrix3(), Matrix3()
once.rotate(Vector3(0, 0, 1.0))
for _ in range(100):
    steps.rotate(Vector3(0, 0, 0.01))
about.from_axis_angle(Vector3(0, 0, 2.0), 0.5)
for name, matrix, yaw, length in (('rotate by 1', once, math.pi / 4, math.sqrt(2)), ('rotate by 0.01, 100 times', steps, 1.0, 1.005), ('0.5 about (0, 0, 2)', about, 0.83, 1.3)):
    print(f'{name}: yaw {matrix.to_euler()[2]:.3f}, length of a row {matrix.a.length():.4f}')
    assert abs(matrix.to_euler()[2] - yaw) < 2e-3 and abs(matrix.a.length() - length) < 2e-3
EOF
