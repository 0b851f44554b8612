#!/usr/bin/env bash
# Guess: set_gyroscope(offset=..) of a simulator of inertial sensors sets the sensor's offset, and a second call sets
# another. Called without arguments, it gives the ideal sensor back. random_walk=.. adds a random walk.
# Observed: each call adds to what the last one made: twice 1 degree/s is 2, and no offset leaves 2. The accelerometer
# does the same. A random walk is made only if a bias instability is given beside it, however small: alone it is 0.
# Why it matters: a loop over a table of sensors compares the first sensor with the sum of all, and a filter's bias
# states are tuned on a bias that never moves.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps imusim==1.1.2 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import sys, types
from importlib.metadata import version
import numpy as np

for name in ('matplotlib', 'matplotlib.pyplot', 'matplotlib.animation'):  # its plots' home
    sys.modules[name] = types.ModuleType(name)
sys.modules['matplotlib'].pyplot, sys.modules['matplotlib'].animation = (sys.modules[f'matplotlib.{name}'] for name in ('pyplot', 'animation'))
import imusim

print('imusim', version('imusim'))
t = np.arange(1001) / 100
np.savetxt('still.csv', np.column_stack([t, np.zeros((1001, 6))]), delimiter=',', header='time, x, y, z, roll, pitch, yaw')
simulator = imusim.Simulator('still.csv')
got = [simulator.gyroscope[500, 0]]
for offset in ([1.0, 0, 0], [1.0, 0, 0], [0.0, 0, 0]):
    simulator.set_gyroscope(offset=np.array(offset))
    got.append(simulator.gyroscope[500, 0])
print('gyroscope of a craft at rest, degrees/s: ideal, offset of 1, of 1 again, of 0:', [round(float(x), 6) for x in got])
assert np.allclose(got, [0, 1, 2, 2])
for _ in range(2):
    simulator.set_accelerometer(offset=np.array([0.1, 0, 0]))
print('accelerometer after an offset of 0.1 g twice:', round(float(simulator.accelerometer[500, 0]), 6))
assert np.isclose(simulator.accelerometer[500, 0], 0.2)

np.random.seed(1)
walks = []
for more in ({}, dict(bias_instability=np.full(3, 1e-9))):
    simulator = imusim.Simulator('still.csv')
    simulator.set_gyroscope(random_walk=np.ones(3), **more)
    walks.append(float(simulator.gyroscope.std()))
print(f'random walk of 1 for 10 s: spread {walks[0]:.3f} alone, {walks[1]:.3f} with a bias instability of 1e-9')
assert walks[0] == 0 and walks[1] > 0.3
EOF
