#!/usr/bin/env bash
# Guess: a quadratic programme of four unknowns that is called solved is solved to three digits or so: four motors'
# thrusts for a wanted thrust and three torques, in newtons and newton metres, with no bound active.
# Observed: with its default tolerances OSQP is done after 25 iterations, status solved. The thrust is right; of a
# yaw torque of 0.5 mN m it gives 0.02, of a roll torque of 2 mN m 1.88, since its tolerance is as large as a
# millinewton metre. The motors' thrusts are 20 mN off. With 1e-9 it needs 75 iterations and is exact.
# Why it matters: these are the torques of a small craft. An allocation in SI units answers roll, and almost never
# yaw, and the status says that all is well; a yaw loop around it looks as if it had no authority.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile osqp==1.1.3 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
import osqp
import scipy.sparse as sparse

print('osqp', version('osqp'))
arm, drag = 0.046, 0.006
effect = np.array([[1, 1, 1, 1], [-arm, -arm, arm, arm], [-arm, arm, arm, -arm], [-drag, drag, -drag, drag]])
wanted = np.array([1.2, 0.002, -0.001, 0.0005])


def allocate(**settings):
    solver = osqp.OSQP()
    solver.setup(sparse.csc_matrix(effect.T @ effect), -effect.T @ wanted, sparse.eye(4, format='csc'), np.zeros(4), 0.6 * np.ones(4), verbose=False, **settings)
    return solver.solve()


exact = np.linalg.solve(effect, wanted)
assert exact.min() > 0 and exact.max() < 0.6
for name, settings in (('default', {}), ('1e-9', dict(eps_abs=1e-9, eps_rel=1e-9, max_iter=100000))):
    result = allocate(**settings)
    got = effect @ result.x
    print(f'{name}: {result.info.status}, {result.info.iter} iterations; thrust and torques', np.round(got, 6), 'wanted', wanted, '; motors off by', np.round(result.x - exact, 4))
    assert result.info.status == 'solved'
    if settings:
        assert np.allclose(got, wanted, atol=1e-7)
    else:
        assert abs(got[0] - 1.2) < 1e-3 and got[3] < 0.2 * wanted[3] and abs(result.x - exact).max() > 0.015
EOF
