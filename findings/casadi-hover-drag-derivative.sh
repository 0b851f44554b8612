#!/usr/bin/env bash
# Guess: the Jacobian of a quadratic drag, |v| v, is zero at rest: the force goes with the square of the speed.
# Observed: CasADi's is NaN in all nine entries at v = 0, with norm_2 as with the root of sumsqr, in SX and in MX,
# and right from 1e-9 m/s on. In one dimension fabs(v) * v is right at 0 too, and so is the root within
# if_else(sumsqr(v) > 0, .., 0).
# Why it matters: hover is where a quadcopter's model is linearised, and the guess from which its trajectory
# optimisation starts. An LQR design of a model with air, or the first iteration of an interior-point solver, dies of
# the term that is zero there.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps casadi==3.8.2 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import casadi as ca
import numpy as np

print('casadi', version('casadi'))
for kind in (ca.SX, ca.MX):
    v = kind.sym('v', 3)
    speed = ca.sqrt(ca.sumsqr(v))
    drags = {'norm_2': ca.norm_2(v) * v, 'root of sumsqr': speed * v, 'if_else': ca.if_else(ca.sumsqr(v) > 0, speed, 0) * v}
    for name, drag in drags.items():
        jacobian = ca.Function('jacobian', [v], [ca.jacobian(drag, v)])
        at_rest, moving = np.array(jacobian([0, 0, 0])), np.array(jacobian([1e-9, 0, 0]))
        print(f'{kind.__name__}, {name}: {np.isnan(at_rest).sum()} of 9 entries are NaN at rest; diagonal {np.diag(moving)} at 1e-9 m/s')
        assert np.isnan(at_rest).sum() == (0 if name == 'if_else' else 9) and np.allclose(np.diag(moving), [2e-9, 1e-9, 1e-9])
v = ca.SX.sym('v')
alone = float(ca.Function('jacobian', [v], [ca.jacobian(ca.fabs(v) * v, v)])(0))
print('in one dimension, fabs(v) * v:', alone)
assert alone == 0
EOF
