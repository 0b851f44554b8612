#!/usr/bin/env bash
# Guess: an interior-point solver calls a small, well-scaled problem solved or infeasible, and the objective has
# no say in whether there is a solution.
# Observed: a cart is moved to rest over a distance under a bound on its acceleration, 40 unknowns. Up to the
# largest distance that is possible Clarabel is done after ten iterations. From 1e-8 to 1e-6 beyond it, relative, it
# gives no verdict: 200 iterations, MaxIterations. At 1e-5 the answer depends on the objective: infeasible when jumps
# of the acceleration are minimised, none when its square is.
# Why it matters: a planner that searches for the shortest duration, or prints how much is missing, bisects into
# exactly this band. It needs a margin of its own, and must not read 'no verdict' as either.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps clarabel==0.11.1 numpy==2.4.6 scipy==1.17.1 cffi==2.1.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import clarabel
import numpy as np
from scipy import sparse

print('clarabel', version('clarabel'))
steps, dt = 40, 0.05
moved = np.array([dt * dt * (steps - k - 0.5) for k in range(steps)])
farthest = dt * dt * (steps / 2)**2  # half of the time at +1, half at -1 m/s^2
jumps = np.diff(np.eye(steps), axis=0)
objectives = {'square': np.eye(steps), 'jumps': jumps.T @ jumps, 'none': np.zeros((steps, steps))}


def solve(beyond, objective):
    rows = np.vstack([moved, np.full(steps, dt), np.eye(steps), -np.eye(steps)])
    right = np.concatenate([[farthest * (1 + beyond), 0.0], np.ones(2 * steps)])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.ZeroConeT(2), clarabel.NonnegativeConeT(2 * steps)]
    P = sparse.triu(sparse.csc_matrix(objectives[objective])).tocsc()
    solution = clarabel.DefaultSolver(P, np.zeros(steps), sparse.csc_matrix(rows), right, cones, settings).solve()
    return str(solution.status), solution.iterations


for beyond in (-1e-4, -1e-8, 0.0, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4):
    print(f'{beyond:+.0e} beyond the edge:', {name: solve(beyond, name) for name in objectives})
for name in objectives:
    assert solve(-1e-8, name)[0] == 'Solved' and solve(-1e-8, name)[1] < 20
    assert solve(1e-2, name)[0] == 'PrimalInfeasible'
    for beyond in (1e-8, 1e-7, 1e-6):
        assert solve(beyond, name)[0] not in ('Solved', 'PrimalInfeasible')
assert solve(1e-5, 'jumps')[0] == 'PrimalInfeasible' and solve(1e-5, 'square')[0] != 'PrimalInfeasible'
EOF
