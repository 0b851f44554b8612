#!/usr/bin/env bash
# Guess: a simulated inertial sensor that takes its place and its attitude on the craft measures rates and
# accelerations in its own axes, the same at any heading of the craft.
# Observed: RotorPy's Imu turns the acceleration into the sensor's axes and leaves the rates in the craft's:
# mounted with a quarter turn about z it reports a roll rate as roll. The centripetal part of a sensor 10 cm in front
# of the centre mixes the body's rates with the arm in the world's axes: pitching at 3 rad/s it is -0.9 m/s^2 along x
# at a heading of 0 and 0 at a heading of 90 degrees.
# Why it matters: a filter or a calibration that finds the mounting from accelerations and rates gets two answers, and
# a fast manoeuvre's accelerations depend on the compass. At the centre and unrotated, the defaults, all is well.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps rotorpy==3.0.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import importlib.util
import math
from importlib.metadata import distribution, version
import numpy as np

print('rotorpy', version('rotorpy'))
# the sensor's file alone: the packages around it import viewers
spec = importlib.util.spec_from_file_location('imu', distribution('rotorpy').locate_file('rotorpy/sensors/imu.py'))
imu = importlib.util.module_from_spec(spec)
spec.loader.exec_module(imu)
quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
level, hovering = np.array([0.0, 0, 0, 1]), dict(vdot=np.zeros(3), wdot=np.zeros(3))
headed = np.array([0, 0, math.sin(math.pi / 4), math.cos(math.pi / 4)])

mounted = imu.Imu(R_BS=quarter)
tilt = np.array([math.sin(0.1), 0, 0, math.cos(0.1)])
reading = mounted.measurement(dict(q=tilt, w=np.array([1.0, 0, 0])), hovering, with_noise=False)
print('mounted with a quarter turn, rolled by 0.2 rad: accelerations', np.round(reading['accel'], 2) + 0.0, 'rates', reading['gyro'])
assert np.allclose(reading['accel'], quarter.T @ [0, 9.81 * math.sin(0.2), 9.81 * math.cos(0.2)])
assert np.allclose(reading['gyro'], [1, 0, 0]) and not np.allclose(reading['gyro'], quarter.T @ [1, 0, 0])

forward = imu.Imu(p_BS=np.array([0.1, 0, 0]))
along = [float(forward.measurement(dict(q=q, w=np.array([0, 3.0, 0])), hovering, with_noise=False)['accel'][0]) for q in (level, headed)]
print('10 cm in front, pitching at 3 rad/s: along x at headings of 0 and 90 degrees', np.round(along, 3) + 0.0)
assert abs(along[0] + 0.9) < 1e-9 and abs(along[1]) < 1e-9
EOF
