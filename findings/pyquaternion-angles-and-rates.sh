#!/usr/bin/env bash
# Guess: Quaternion.yaw_pitch_roll gives back the yaw, pitch and roll that the attitude was built from in the order
# that its documentation names (z, y', x''), and integrate takes rates about the axes that it documents.
# Observed: a yaw of 30, a pitch of 20 and a roll of 10 degrees, composed in that order, come back as 28.5, 22.2
# and -1.1: the formulae are those of the opposite order, in which roll turns first. Angles alone come back right one
# at a time, so that a test of each axis passes. integrate and derivative document rates about the global axes and
# take them about the body's.
# Why it matters: at a tilt of 20 degrees the heading that a log shows is wrong by degrees and the roll by ten, though
# the quaternion is right. Rates of a gyro may be handed over as they are, and those that were turned into the world's
# frame because the documentation asks for it may not.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps pyquaternion==0.9.9 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
import math
from importlib.metadata import version
from pyquaternion import Quaternion

print('pyquaternion', version('pyquaternion'))
yaw, pitch, roll = (Quaternion(axis=axis, degrees=angle) for axis, angle in (([0, 0, 1], 30), ([0, 1, 0], 20), ([1, 0, 0], 10)))
read = [math.degrees(angle) for angle in (yaw * pitch * roll).yaw_pitch_roll]
opposite = [math.degrees(angle) for angle in (roll * pitch * yaw).yaw_pitch_roll]
print('yaw 30, pitch 20, roll 10 read as', [round(angle, 2) for angle in read], '- composed the other way round as', [round(angle, 2) for angle in opposite])
assert all(abs(got - want) < 0.05 for got, want in zip(read, (28.45, 22.24, -1.12)))
assert all(abs(got - want) < 1e-9 for got, want in zip(opposite, (30, 20, 10)))

start, turn = Quaternion(axis=[1, 0, 0], degrees=90), Quaternion(axis=[0, 0, 1], radians=0.1)
after = Quaternion(start)
after.integrate([0, 0, 1.0], 0.1)
from_body, from_world = Quaternion.absolute_distance(after, start * turn), Quaternion.absolute_distance(after, turn * start)
print(f'a rate about z for 0.1 rad, rolled by 90 degrees: {from_body:.6f} from the turn about the body axis, {from_world:.6f} from that about the global one')
assert 'global' in Quaternion.integrate.__doc__
assert from_body < 1e-12 and from_world > 0.05
EOF
