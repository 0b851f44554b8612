#!/usr/bin/env bash
# Guess: filter_sequence(measurements, dt=0.01) runs a filter at 100 Hz, and predict(dt=..) predicts over that time.
# Observed: the alpha-beta-gamma filter gets dt for its prediction and 1 s for its correction: a ramp of 2 m/s reads
# as 0.55 m/s after 3 s, where the same filter stepped by hand with dt in both calls has 2.00. The Kalman filter
# ignores dt in silence: predict(dt=1.0) and predict_only(dt=5.0) move 2 m/s by the 0.02 m of its matrix.
# Why it matters: a vertical speed that is four times too small damps nothing in a height hold, and a prediction over
# a gap in the radio link stays where the link broke.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps kalbee==1.0.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
from kalbee import AlphaBetaGammaFilter, KalmanFilter
from kalbee.models import constant_velocity

print('kalbee', version('kalbee'))
dt = 0.01
heights = 2 * dt * np.arange(1, 301)
by_sequence, by_hand = (AlphaBetaGammaFilter(np.zeros((3, 1)), alpha=0.2, beta=0.02, gamma=0.002) for _ in range(2))
by_sequence.filter_sequence(heights, dt=dt)
for height in heights:
    by_hand.predict(dt=dt)
    by_hand.update(np.array([[height]]), dt=dt)
speeds = by_sequence.x[1, 0], by_hand.x[1, 0]
print('speed of a ramp of 2 m/s after 3 s: filter_sequence %.2f m/s, by hand %.2f m/s' % speeds)
assert abs(speeds[0] - 0.55) < 0.01 and abs(speeds[1] - 2) < 0.01

F, Q = constant_velocity(dt=dt)
f = KalmanFilter(np.array([[0.0], [2.0]]), np.eye(2), F, Q, np.array([[1.0, 0.0]]), np.eye(1))
gap = float(f.predict_only(dt=5.0)[0, 0])
f.predict(dt=1.0)
print(f'2 m/s from 0: predict_only(dt=5.0) says {gap:.2f} m, predict(dt=1.0) {f.x[0, 0]:.2f} m')
assert abs(gap - 0.02) < 1e-12 and abs(f.x[0, 0] - 0.02) < 1e-12
EOF
