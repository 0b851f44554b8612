#!/usr/bin/env bash
# Guess: on a linear model the cubature Kalman filter of a package gives the gains and covariances of its Kalman
# filter, as its unscented filter does: all three are exact there.
# Observed: after 30 steps of a position and a velocity with process noise 30, the Kalman filter and the unscented
# one give a variance of the position of 0.49 and the cubature filter 30.5. The update uses the points from before the
# process noise was added. The first gain after a start with small variances is therefore 0.02 instead of 0.98: the
# first measurement is ignored.
# Why it matters: a gate that rejects outliers by the covariance lets nearly all of them through, and a state whose
# process noise is the whole point (wind, bias after a bump) comes late.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps filterpy==2.0.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import math
from importlib.metadata import version
import numpy as np
from filterpy.kalman import CubatureKalmanFilter, KalmanFilter, MerweScaledSigmaPoints, UnscentedKalmanFilter

print('filterpy', version('filterpy'))
step, dt, noise = np.array([[1, 0.1], [0, 1]]), 0.1, 30.0


def move(x, dt):
    return step @ x


def measure(x):
    return x[:1]


plain = KalmanFilter(2, 1)
plain.F, plain.H, plain.x = step, np.array([[1.0, 0]]), np.zeros((2, 1))
cubature = CubatureKalmanFilter(2, 1, dt, measure, move)
cubature.x = np.zeros((2, 1))
unscented = UnscentedKalmanFilter(2, 1, dt, measure, move, MerweScaledSigmaPoints(2, 0.1, 2, 1))
for f in (plain, cubature, unscented):
    f.P, f.Q, f.R = 0.01 * np.eye(2), noise * np.eye(2), np.array([[0.5]])
for k in range(30):
    for f in (plain, cubature):
        f.predict()
        f.update(np.array([[math.sin(k)]]))
    unscented.predict()
    unscented.update(np.array([math.sin(k)]))
    if k == 0:
        first = [float(np.ravel(f.K)[0]) for f in (plain, unscented, cubature)]
variances = [float(f.P[0, 0]) for f in (plain, unscented, cubature)]
print('Kalman, unscented, cubature: first gain', np.round(first, 3), 'variance after 30 steps', np.round(variances, 3))
assert abs(first[0] - first[1]) < 1e-6 and abs(variances[0] - variances[1]) < 1e-6
assert first[0] > 0.98 and first[2] < 0.03 and variances[2] > 60 * variances[0]
EOF
