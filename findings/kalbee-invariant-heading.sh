#!/usr/bin/env bash
# Guess: an invariant Kalman filter that knows its heading to 0.1 rad flies 10 m ahead, gets a fix of its position 1 m
# to the left, and turns its heading to the left by 0.1 rad: it flew there. Its position becomes the measured one.
# Observed: the heading turns to the right by 5.7 degrees, and the position stays at 0.00 m beside the line. The
# covariance between sideways and heading is -0.1 where 20000 samples of the motion have +0.1. Eleven legs with a fix
# each take a heading that was 5.7 degrees off to 100 degrees off; a plain filter of x, y and heading finds it.
# Why it matters: a position fix turns a heading without a compass away from the truth. What reads as a bad
# magnetometer or a too large gain is a sign.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps kalbee==1.0.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
from kalbee import InvariantEKF

print('kalbee', version('kalbee'))
ahead = np.array([10.0, 0, 0, 0, 0, 0])


def start():
    return InvariantEKF(np.eye(4), np.diag([1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 0.01]), 1e-9 * np.eye(6), 1e-4 * np.eye(3))


def heading(f):
    return float(np.arctan2(f.rotation[1, 0], f.rotation[0, 0]))


f = start()
f.predict(dt=1.0, twist=ahead)
off = 0.1 * np.random.default_rng(0).standard_normal(20000)
sampled = float(np.mean(10 * np.sin(off) * off))
print(f'covariance of sideways and heading after 10 m: {f.P[1, 5]:.3f}, of samples of the motion {sampled:.3f}')
assert abs(f.P[1, 5] + 0.1) < 1e-3 and abs(sampled - 0.1) < 5e-3
f.update(np.array([10.0, 1.0, 0.0]))
print(f'after a fix 1 m to the left: heading {np.degrees(heading(f)):.1f} degrees, {f.position[1, 0]:.2f} m to the left')
assert heading(f) < -0.09 and abs(f.position[1, 0]) < 0.01

f = start()
x, P = np.zeros(3), np.diag([1e-6, 1e-6, 0.01])  # x, y and heading of a plain filter by hand
truth, place = 0.1, np.zeros(3)
for _ in range(11):
    place = place + 10 * np.array([np.cos(truth), np.sin(truth), 0])
    f.predict(dt=1.0, twist=ahead)
    f.update(place)
    c, s = np.cos(x[2]), np.sin(x[2])
    x = x + [10 * c, 10 * s, 0]
    F = np.array([[1, 0, -10 * s], [0, 1, 10 * c], [0, 0, 1]])
    P = F @ P @ F.T + 1e-9 * np.eye(3)
    K = P[:, :2] @ np.linalg.inv(P[:2, :2] + 1e-4 * np.eye(2))
    x, P = x + K @ (place[:2] - x[:2]), P - K @ P[:2]
error, plain = (np.degrees(np.angle(np.exp(1j * (h - truth)))) for h in (heading(f), x[2]))
print(f'eleven legs from a heading {np.degrees(truth):.1f} degrees off, a fix after each: {error:.1f} degrees off, plain filter {plain:.2f}')
assert abs(error) > 90 and abs(plain) < 0.5
EOF
