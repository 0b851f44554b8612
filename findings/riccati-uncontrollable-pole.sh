#!/usr/bin/env bash
# Guess: a Riccati equation of a plant with a state that no input moves (a bias, a heading that nothing turns), which
# has no stabilising solution, is refused, and if it is once it is always.
# Observed: solve_continuous_are raises for a double integrator with such a state as it is written down. In other
# coordinates of the same plant it returns a matrix in two of three cases: no warning, a residual of 0.6 and more, and
# a gain that leaves the pole at 0. python-control's care with slycot refuses more of them, 25 of 40, and answers the
# rest.
# Why it matters: an LQR design of a craft with an integrator too many 'works', and its closed loop drifts. Whether it
# is found depends on round-off: test controllability, and the residual, oneself.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps scipy==1.17.1 control==0.10.2 slycot==0.7.1 numpy==2.4.6 matplotlib==3.11.2 pyparsing==3.3.3 cycler==0.12.1 python-dateutil==4.0.0 kiwisolver==1.5.1 packaging==26.4 pillow==13.0.0 contourpy==1.3.3 fonttools==4.68.0 six==1.17.0
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import control
import numpy as np
from scipy.linalg import solve_continuous_are

print('scipy', version('scipy'), 'control', version('control'), 'slycot', version('slycot'))
A = np.array([[0.0, 1, 0], [0, 0, 0], [0, 0, 0]])  # position, velocity, and a bias that nothing moves
B = np.array([[0.0], [1], [0]])
Q, R = np.eye(3), np.eye(1)


def residual(X, a, b):
    return np.abs(a.T @ X + X @ a - X @ b @ b.T @ X + Q).max()


try:
    solve_continuous_are(A, B, Q, R)
except np.linalg.LinAlgError as error:
    print('as written down:', error)
else:
    raise SystemExit('solve_continuous_are returns an answer now')

returned, refused, slycot_refused = [], 0, 0
random = np.random.default_rng(0)
for _ in range(40):
    T = random.standard_normal((3, 3))
    a, b = T @ A @ np.linalg.inv(T), T @ B
    try:
        X = solve_continuous_are(a, b, Q, R)
        poles = np.linalg.eigvals(a - b @ b.T @ X)
        returned.append((residual(X, a, b), poles.real.max()))
    except np.linalg.LinAlgError:
        refused += 1
    try:
        control.care(a, b, Q, R, method='slycot')
    except Exception:
        slycot_refused += 1
print(f'in 40 other coordinates: solve_continuous_are refuses {refused}, returns {len(returned)}, with residuals of '
      f'{min(r for r, _ in returned):.1f} to {max(r for r, _ in returned):.1f} and the slowest pole within '
      f'{max(abs(p) for _, p in returned):.0e} of 0; slycot refuses {slycot_refused}')
assert refused >= 3 and len(returned) >= 3 and slycot_refused > refused
assert min(r for r, _ in returned) > 0.05 and max(abs(p) for _, p in returned) < 1e-6
EOF
