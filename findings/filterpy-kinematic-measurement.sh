#!/usr/bin/env bash
# Guess: kinematic_kf(dim=2, order=1), which is documented to measure the position in each dimension, measures the
# position in each dimension.
# Observed: its measurement matrix is (1, 0, 1, 0): one number, the sum of x and y. With dim_z=2 both rows are
# that sum. A craft that is at (1, 0) and measured so, exactly, is estimated at (0.5, 0.5). The rows are right with
# dim=1 alone, which is the case that a test takes.
# Why it matters: fed positions of motion capture in two or three axes the filter has too few measurements to see
# which axis moved. It does not complain: it converges, to the wrong place.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps filterpy==2.0.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
from filterpy.common import kinematic_kf

print('filterpy', version('filterpy'))
assert 'one per dimension' in kinematic_kf.__doc__
one, two = kinematic_kf(dim=2, order=1, dt=0.1), kinematic_kf(dim=2, order=1, dt=0.1, dim_z=2)
print('measurement matrix:', one.H, 'with dim_z=2:', two.H.tolist())
assert one.H.tolist() == [[1, 0, 1, 0]] and two.H.tolist() == [[1, 0, 1, 0]] * 2
where = np.array([[1.0], [0], [0], [0]])
one.Q *= 1e-6
for _ in range(500):
    one.predict()
    one.update(one.H @ where)
print('at (1, 0), estimated at', np.round(one.x[[0, 2], 0], 3))
assert np.allclose(one.x[[0, 2], 0], 0.5, atol=0.01)
assert kinematic_kf(dim=1, order=1, dt=0.1).H.tolist() == [[1, 0]]
EOF
