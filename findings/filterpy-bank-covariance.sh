#!/usr/bin/env bash
# Guess: a bank of two filters that are the same has the estimate and the covariance of each of them. A control that
# is handed to predict acts, or is refused where there is no matrix for it.
# Observed: the estimate of MMAEFilterBank is theirs; its variance is larger, here by 42 %, since the spread that
# it adds is that from the bank's previous estimate, the motion, and not that between the filters. IMMEstimator is
# right. predict(u) of a KalmanFilter without B ignores u without a word.
# Why it matters: a bank is built to see when one of its models (with or without wind, three motors or four) becomes
# unlikely. A variance that grows with the speed hides that when it counts, in fast flight.
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
from filterpy.kalman import IMMEstimator, KalmanFilter, MMAEFilterBank

print('filterpy', version('filterpy'))


def single():
    f = KalmanFilter(2, 1)
    f.x, f.F, f.H = np.zeros((2, 1)), np.array([[1, 0.1], [0, 1]]), np.array([[1.0, 0]])
    f.P, f.R, f.Q = np.diag([2.0, 3.0]), np.array([[0.5]]), np.diag([0.01, 0.02])
    return f


alone = single()
bank = MMAEFilterBank([single(), single()], [0.5, 0.5], 2, H=alone.H)
mixed = IMMEstimator([single(), single()], np.array([0.5, 0.5]), np.array([[0.9, 0.1], [0.1, 0.9]]))
for k in range(60):
    for f in (alone, bank, mixed):
        f.predict()
        f.update(np.array([[math.sin(0.2 * k)]]))
for name, f in (('filter', alone), ('bank', bank), ('IMM', mixed)):
    print(f'{name}: estimate {np.round(np.ravel(f.x), 4)}, variances {np.round(np.diag(f.P), 4)}')
assert np.allclose(np.ravel(bank.x), np.ravel(alone.x)) and np.allclose(mixed.P, alone.P)
assert 1.35 < bank.P[0, 0] / alone.P[0, 0] < 1.5
still = single()
still.predict(u=np.array([[1.0]]))
print('predict(u=1) without B:', np.ravel(still.x))
assert not still.x.any()
EOF
