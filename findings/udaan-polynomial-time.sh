#!/usr/bin/env bash
# Guess: the velocity and acceleration that a trajectory returns beside its position are the derivatives of that
# position.
# Observed: in udaan's circles and sines they are. In its polynomials (SmoothTraj1, 3, 5 and PolyTraj5) they are
# derivatives by the share of the duration and not by time: for a move of 4 s the velocity is 4 times and the
# acceleration 16 times that of the position, and a move of half a second reports half and a quarter of them.
# Why it matters: the two are the feed-forward of a geometric controller. A 3 m move in 4 s, which needs 1.4 m/s, is
# fed 5.6 m/s, and the tracking error that follows looks like bad gains.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps udaan==1.3.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import sys
import types
from importlib.metadata import version
from importlib.util import find_spec
import numpy as np

# The trajectories alone: the packages around them import viewers and simulators.
folder = find_spec('udaan').submodule_search_locations[0]
for name, path in (('udaan', folder), ('udaan.utils', folder + '/utils')):
    sys.modules[name] = types.ModuleType(name)
    sys.modules[name].__path__ = [path]
from udaan.utils.trajectory import CircularTraj, PolyTraj5, SmoothTraj1, SmoothTraj3, SmoothTraj5

print('udaan', version('udaan'))


def ratio(curve, duration):
    """Of the velocity and acceleration given to those of the position, at a third of the way."""
    t, h = duration / 3, 1e-4 * duration
    before, now, after = ([np.asarray(part)[-1] for part in curve.get(t + k * h)] for k in (-1, 0, 1))
    speed, acceleration = (after[0] - before[0]) / (2 * h), (after[0] - 2 * now[0] + before[0]) / h**2
    return now[1] / speed, now[2] / acceleration if abs(acceleration) > 1e-3 else np.nan


start, end = np.zeros(3), np.array([1.0, 2.0, 3.0])
for duration in (4.0, 0.5):
    for make in (SmoothTraj1, SmoothTraj3, SmoothTraj5, PolyTraj5):
        speed, acceleration = ratio(make(start, end, duration), duration)
        print(f'{make.__name__} over {duration} s: velocity {speed:.3f}, acceleration {acceleration:.3f} times that of its position')
        assert abs(speed / duration - 1) < 1e-3
        assert np.isnan(acceleration) or abs(acceleration / duration**2 - 1) < 1e-2
circle = CircularTraj(radius=2, speed=1.5)
h = 1e-5
numeric = (np.asarray(circle.get(1 + h)[0]) - np.asarray(circle.get(1 - h)[0])) / (2 * h)
print('circle: velocity off by', np.abs(numeric - circle.get(1)[1]).max())
assert np.abs(numeric - circle.get(1)[1]).max() < 1e-6
EOF
