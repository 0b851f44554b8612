#!/usr/bin/env bash
# Guess: a Dryden gust of intensity sigma blows with a standard deviation of sigma (m/s), at any
# step of the simulation.
# Observed: RotorPy's, asked for 0.5 m/s, blows with 6 mm/s at steps of 2 ms, and 2 to 3 times that at 10 ms. That
# of drones-sim, asked for 2 m/s, blows with 110 m/s at steps of 10 ms and 1100 m/s at 1 ms. Both put white noise into
# their filter without the factor that its variance needs for the length of a step.
# Why it matters: a disturbance test in the first is a test in still air, in the second in a wind that no craft
# survives, and neither says so. Measure the wind that a simulator makes before quoting its sigma.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps rotorpy==3.0.0 drones-sim==0.2.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import runpy
import sys
import types
from importlib.metadata import version
from importlib.util import find_spec
import numpy as np

sys.modules['torch'] = types.ModuleType('torch')  # imported by the module, used by its batched classes alone
from rotorpy.wind.dryden_utils import DrydenWind
folder = find_spec('drones_sim').submodule_search_locations[0]  # the file alone: the package's plots need matplotlib
DrydenGust = runpy.run_path(folder + '/dynamics/disturbances.py')['DrydenGust']

print('rotorpy', version('rotorpy'), 'drones-sim', version('drones-sim'))


def rotorpy_wind(sigma, dt, duration=300):
    np.random.seed(1)
    wind = DrydenWind(0, 0, 0, sigma, sigma, sigma, 2.0)
    return np.array([np.ravel(wind.getWind(dt)) for _ in range(int(duration / dt))])


def drones_sim_wind(sigma, dt, duration=600):
    gust, out = DrydenGust(intensity=sigma, seed=1), []
    for _ in range(int(duration / dt)):
        gust.advance(0.0, dt, None)
        out.append(gust.wind_velocity())
    return np.array(out)


for dt, low, high in ((0.002, 0.004, 0.010), (0.010, 0.010, 0.030)):
    deviation = rotorpy_wind(0.5, dt).std(axis=0)
    print(f'RotorPy, 0.5 m/s asked, step {1e3 * dt:.0f} ms: {np.round(deviation, 4)} m/s')
    assert (low < deviation).all() and (deviation < high).all()
for dt, low, high in ((0.01, 80, 150), (0.001, 800, 1500)):
    deviation = drones_sim_wind(2.0, dt).std(axis=0)
    print(f'drones-sim, 2 m/s asked, step {1e3 * dt:.0f} ms: {np.round(deviation)} m/s')
    assert (low < deviation).all() and (deviation < high).all()
EOF
