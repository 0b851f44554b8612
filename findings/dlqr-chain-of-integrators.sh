#!/usr/bin/env bash
# Guess: a sampled chain of integrators is controllable, so that dlqr gives a gain that stabilises it, or an error where it is too
# long for double precision.
# Observed, A = I + 0.1 S, B = 0.1 e_n, Q = I, R = 1: with 30 states solve_discrete_are returns a P that leaves 8 % of itself in the
# equation, with 40 one that is not positive (smallest eigenvalue -7e15), and the gain of it makes the loop unstable: spectral radius
# 1.10. Its check of the result passes, as it looks for symmetry alone. dlqr of python-control returns gain and eigenvalues likewise.
# Neither warns.
# Why it matters: a model with observers, delays and lags as states is such a chain, if a shorter one. Look at the eigenvalues
# that dlqr returns, and at the residual, before the gain goes anywhere.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile control==0.10.2 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import os

os.environ['OPENBLAS_NUM_THREADS'] = '1'
import warnings
from importlib.metadata import version
import control
import numpy as np
from scipy.linalg import solve_discrete_are

warnings.simplefilter('error')
print('scipy', version('scipy'), 'control', version('control'))
found = {}
for n in (20, 30, 40):
    a, b = np.eye(n) + 0.1 * np.eye(n, k=1), 0.1 * np.eye(n)[:, -1:]
    q, r = np.eye(n), np.eye(1)
    p = solve_discrete_are(a, b, q, r)
    k = np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a)
    left = np.linalg.norm(a.T @ p @ a - p - a.T @ p @ b @ k + q) / np.linalg.norm(p)
    least = np.linalg.eigvalsh(p)[0]
    radius, of_control = abs(np.linalg.eigvals(a - b @ k)).max(), abs(control.dlqr(a, b, q, r)[2]).max()
    found[n] = left, least, radius, of_control
    print(f'{n} states: {left:.1e} of P is left over, least eigenvalue {least:.1e}, spectral radius {radius:.3f}; dlqr: {of_control:.3f}')
assert found[20][0] < 1e-6 and found[20][2] < 1
assert found[30][0] > 1e-3
left, least, radius, of_control = found[40]
assert left > 1e-2 and least < 0 and radius > 1 and of_control > 1
EOF
