#!/usr/bin/env bash
# Guess: one package has one meaning of rpy, roll first, and a rotation matrix that it turns into a quaternion is the
# same rotation.
# Observed: Quaternion(rpy=(10, 20, 30) degrees) rolls by 10 and yaws by 30. DCM(rpy=..) of the same three rolls
# by 30 and yaws by 10, in spite of its own 'Array with roll->pitch->yaw angles'; an example further down reverses
# them. Of the five methods of DCM.to_quaternion three (chiaverini, sarabandi, hughes) turn a half turn about (1, -1,
# 0) into a rotation 180 degrees away; at 179.9 degrees all are right.
# Why it matters: setpoints are made by one class and compared with logs by the other. A test in pitch, or with equal
# angles, sees no difference; a roll that is flown as a yaw is a craft that goes straight on.
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
from ahrs import DCM, Quaternion

print('ahrs', version('ahrs'))


def apart(a, b):
    return math.degrees(2 * math.acos(min(1.0, abs(float(np.dot(a, b))))))


def about(axis, degrees):
    half = math.radians(degrees) / 2
    return np.r_[math.cos(half), math.sin(half) * np.array(axis) / np.linalg.norm(axis)]


def by_matrix(angles):
    return np.array(DCM(rpy=np.radians(angles)).to_quaternion(method='shepperd'))


for angles, want in (((0, 20, 0), 0), ((10, 20, 10), 0), ((10, 0, 0), 14.1), ((10, 20, 30), 32.7)):
    off = apart(np.array(Quaternion(rpy=np.radians(angles))), by_matrix(angles))
    print(f'rpy {angles}: Quaternion and DCM are {off:.1f} degrees apart')
    assert abs(off - want) < 1
yaw, pitch, roll = (Quaternion(about(axis, angle)) for axis, angle in (((0, 0, 1), 30), ((0, 1, 0), 20), ((1, 0, 0), 10)))
built = np.array(yaw * (pitch * roll))
assert apart(np.array(Quaternion(rpy=np.radians([10, 20, 30]))), built) < 1e-4
assert apart(by_matrix([30, 20, 10]), built) < 1e-4
assert 'roll->pitch->yaw' in DCM.__doc__
axis = np.array([1.0, -1, 0]) / math.sqrt(2)
cases = {'179.9 degrees': (about(axis, 179.9), Quaternion(about(axis, 179.9)).to_DCM()), 'a half turn': (np.r_[0, axis], 2 * np.outer(axis, axis) - np.eye(3))}
for name, (q, matrix) in cases.items():
    off = {method: apart(np.array(DCM(matrix).to_quaternion(method=method)), q) for method in ('chiaverini', 'sarabandi', 'hughes', 'itzhack', 'shepperd')}
    print(f'{name} about (1, -1, 0), off by', {method: round(angle, 1) for method, angle in off.items()})
    for method, angle in off.items():
        assert abs(angle - 180) < 0.1 if name == 'a half turn' and method in ('chiaverini', 'sarabandi', 'hughes') else angle < 0.01
EOF
