#!/usr/bin/env bash
# Guess: a rotation matrix made from a pitch of 90 degrees gives back 90 degrees, with roll and yaw in doubt at most.
# Observed: pymavlink's Matrix3.to_euler returns a pitch of -180 degrees at +90, and +180 at -90, and correct
# figures a millionth of a degree away. Its Quaternion class, which logs and scripts use beside it, returns 90.
# Why it matters: a vertical attitude is where flips, throws and crash detection are looked at in a log. The one
# sample that is exactly vertical reads as upside down.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps pymavlink==2.4.50 fastcrc==0.5.0 lxml==6.1.3 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
from math import degrees, radians
from pymavlink.quaternion import Quaternion
from pymavlink.rotmat import Matrix3

print('pymavlink', version('pymavlink'))


def through_matrix(pitch):
    matrix = Matrix3()
    matrix.from_euler(radians(10), radians(pitch), radians(20))
    return [round(degrees(angle), 3) for angle in matrix.to_euler()]


for pitch in (89.999, 90, -90):
    q = Quaternion([radians(10), radians(pitch), radians(20)])
    print('roll 10, pitch', pitch, 'yaw 20: through Matrix3', through_matrix(pitch), 'through Quaternion', [round(degrees(a), 3) for a in q.euler])
assert through_matrix(90)[1] == -180 and through_matrix(-90)[1] == 180 and abs(through_matrix(89.999)[1] - 89.999) < 2e-3
EOF
