#!/usr/bin/env bash
# Guess: the position controller of a quadcopter package, with its default gains on its default craft, holds the point
# that it is told.
# Observed: told (1, 1, 2) from (0, 0, 0), the package's own first example, its craft is below the start after 4
# s, after having been 15 m above it, and hundreds of metres away after 10 s. Nothing is reported. Its hover
# controller stays where it was put. (Installed alone it does not even import: it needs typing-extensions and
# gymnasium and asks for neither.)
# Why it matters: as a peer or a baseline in a comparison such a loop makes any controller look good: a baseline has
# to be flown before it is quoted.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile quadcopter-sim==0.3.0 typing-extensions==4.16.0 gymnasium==1.4.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import os

os.environ['MPLBACKEND'] = 'Agg'
from importlib.metadata import version
import numpy as np
from quadcopter import HoverController, simulate
from quadcopter.utils import create_pid_position_controller

print('quadcopter-sim', version('quadcopter-sim'))
target = np.array([1.0, 1.0, 2.0])
hover = simulate(4.0, 0.02, HoverController())[1][-1, :3]
print('hover controller after 4 s:', hover)
assert np.abs(hover).max() < 1e-6
for duration, least in ((4.0, 3.0), (10.0, 100.0)):
    states = simulate(duration, 0.02, create_pid_position_controller(list(target)))[1][:, :3]
    miss = np.linalg.norm(states[-1] - target)
    print(f'told {target} m: after {duration:.0f} s at {np.round(states[-1], 1)}, {miss:.0f} m away, highest {states[:, 2].max():.1f} m')
    assert miss > least
EOF
