#!/usr/bin/env bash
# Guess: the velocity, acceleration, jerk, snap and yaw acceleration that a trajectory of a simulator gives are
# derivatives of one another.
# Observed: in x and y they are. The three-dimensional circle has the jerk and the snap of its height with the
# sign turned, by its defaults 1.85 m/s^3 where the acceleration falls by as much. With yaw_bool its yaw acceleration
# has the sign turned, 5.4 rad/s^2 for -5.4, and that of the plane Lissajous curve is a cosine where it should be a
# negative sine: 4.6 for -6.3.
# Why it matters: jerk and snap are the feed-forward of a flatness-based controller: its torques. It flies worse with
# them than without, along the vertical alone, and the gains get the blame.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps rotorpy==3.0.0 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
import importlib.util
from importlib.metadata import distribution, version
import numpy as np

print('rotorpy', version('rotorpy'))


def load(name):  # the file alone: the packages around it import viewers
    spec = importlib.util.spec_from_file_location(name, distribution('rotorpy').locate_file(f'rotorpy/trajectories/{name}.py'))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def against_difference(trajectory, of, by, t=0.3, h=1e-5):
    slope = (np.asarray(trajectory.update(t + h)[of]) - np.asarray(trajectory.update(t - h)[of])) / (2 * h)
    return np.atleast_1d(slope), np.atleast_1d(trajectory.update(t)[by])


circle = load('circular_traj').ThreeDCircularTraj(yaw_bool=True)
curve = load('lissajous_traj').TwoDLissajous(yaw_bool=True)
for of, by in (('x', 'x_dot'), ('x_dot', 'x_ddot'), ('x_ddot', 'x_dddot'), ('x_dddot', 'x_ddddot'), ('yaw', 'yaw_dot'), ('yaw_dot', 'yaw_ddot')):
    true, given = against_difference(circle, of, by)
    print(f'circle, {by}: given {np.round(given, 3)}, by differences {np.round(true, 3)}')
    turned = {'x_dddot': [1, 1, -1], 'x_ddddot': [1, 1, -1], 'yaw_ddot': [-1]}.get(by, np.ones(len(given)))
    assert np.allclose(given, true * turned, atol=1e-3)
true, given = against_difference(curve, 'yaw_dot', 'yaw_ddot')
print(f'Lissajous curve, yaw_ddot: given {np.round(given, 3)}, by differences {np.round(true, 3)}')
assert abs(true[0] + 6.271) < 1e-2 and abs(given[0] - 4.556) < 1e-2
EOF
