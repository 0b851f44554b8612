#!/usr/bin/env bash
# Guess: the headings of the points along a Dubins path mean the same as the headings that it was asked with: the
# first and the last are those of the start and the end, and each is the direction of the flight.
# Observed: the headings asked for count from x to y, those of the points from y to x, both in degrees. A path from
# 150 to 170 degrees starts at 300 and ends at 280. Only 45 and 225 degrees are the same in both. Nothing says so.
# Why it matters: the next leg is planned from the last point of this one. It starts across the direction of the
# flight, and 40 m straight on become a detour.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps easydubins==1.3.1 importlib-resources==7.1.0
cd "$dir"
venv/bin/python - <<'EOF'
import math
from importlib.metadata import version
from easydubins.dubin_path import get_curve

print('easydubins', version('easydubins'))


def length(points, start):
    return sum(math.dist(a[:2], b[:2]) for a, b in zip([start, *points], points))


points = get_curve(0, 0, 150, -100, 40, 170, 10, 0.5)
first, last = points[0], points[-1]
flown = [math.degrees(math.atan2(b[1] - a[1], b[0] - a[0])) for a, b in (points[:2], points[-2:])]
print(f'from 150 to 170 degrees: flown with {flown[0]:.1f} and {flown[1]:.1f}, the points have {first[2]:.1f} and {last[2]:.1f}')
assert abs(flown[0] - 150) < 5 and abs(flown[1] - 170) < 5
assert abs(first[2] - 300) < 5 and abs(last[2] - 280) < 1e-3
for a, b in zip(points, points[1:]):
    direction = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
    assert abs((b[2] - (90 - direction) + 180) % 360 - 180) < 5
goal = (last[0] + 40 * math.cos(math.radians(165)), last[1] + 40 * math.sin(math.radians(165)), 160)
legs = [length(get_curve(last[0], last[1], heading, *goal, 10, 0.5), last) for heading in (170, last[2])]
print(f'40 m further from the last point: {legs[0]:.1f} m with the heading asked for, {legs[1]:.1f} m with that of the point')
assert legs[0] < 41 and legs[1] > 45
EOF
