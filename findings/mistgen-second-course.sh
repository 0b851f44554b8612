#!/usr/bin/env bash
# Guess: a generator of minimum-snap courses that is asked for a second course, with its own waypoints and duration,
# makes that course. Its first example's yaw is the direction of the flight.
# Observed: the times of the first course stay for all later ones. After 10 s a course of 5 s takes 10 s, and one of
# 20 s with one waypoint less ends after 6.9 s with 1.5 m/s, 2.2 m before its end. Nothing is said.
# calc_yaw(vy, vx) is called by the README's example with vx first: along x it gives 90 degrees. Without an order of
# the derivative it minimises the jerk, not the snap of its name.
# Why it matters: a planner that is kept between legs flies each leg with another leg's clock, and hands over a course
# that stops in the air.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps mistgen==0.2.6 cvxopt==1.3.3 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import sys, types
from importlib.metadata import metadata, version
import numpy as np

for name in ('matplotlib', 'matplotlib.pyplot'):  # its plots' home
    sys.modules[name] = types.ModuleType(name)
from mistgen.mist import mist_generator

print('mistgen', version('mistgen'))
rest = (np.zeros(2),) * 4
square = np.array([[0.0, 5, 5, 0], [0, 0, 6, 6]])
corner = np.array([[0.0, 1, 5], [0, 0, 6]])


def fly(planner, waypoints, duration):
    x, y, t = planner.mist_2d_gen(waypoints, *rest, T=duration)
    moves = planner.mist_2d_vaj_gen(x, y, t)
    speed = float(np.hypot(moves[0][-1], moves[3][-1]))
    print(f'  asked for {duration} s: ends after {t[-1]:.2f} s at ({x[-1]:.2f}, {y[-1]:.2f}) with {speed:.2f} m/s')
    return t[-1], np.hypot(x[-1] - waypoints[0, -1], y[-1] - waypoints[1, -1]), speed


print('each with its own generator:')
alone = [fly(mist_generator(), *leg) for leg in ((square, 10), (square, 5), (corner, 20))]
assert all(abs(got[0] - duration) < 0.02 and got[1] < 0.01 and got[2] < 0.05 for got, duration in zip(alone, (10, 5, 20)))
print('one after the other with the same:')
planner = mist_generator()
together = [fly(planner, *leg) for leg in ((square, 10), (square, 5), (corner, 20))]
assert abs(together[1][0] - 10) < 0.02
assert together[2][0] < 7 and together[2][1] > 1.5 and together[2][2] > 1

planner = mist_generator()
x, y, t = planner.mist_2d_gen(np.array([[0.0, 5, 10], [0, 0, 0]]), *rest, T=4)
moves = planner.mist_2d_vaj_gen(x, y, t)
yaw = planner.calc_yaw(moves[0], moves[3])[1][100]
assert 'calc_yaw(vaj_xy[0],vaj_xy[3])' in metadata('mistgen').get_payload()
print(f'yaw of a flight along x, called as in the README: {yaw:.0f} degrees; order of the derivative {planner.n_deri}')
assert abs(yaw - 90) < 1e-6 and planner.n_deri == 3
EOF
