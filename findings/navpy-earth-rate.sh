#!/usr/bin/env bash
# Guess: earthrate(lat) of a navigation package is the Earth's rotation in north, east and down, as its documentation
# says, and an option that takes the latitude in radians gives the same as the latitude in degrees.
# Observed: the down part is in the place of east, and down is 0: at 47 degrees (49.7, -53.3, 0) microrad/s where
# (49.7, 0, -53.3) is right. navrate with lat_unit='rad' converts the latitude for the radii of curvature and takes it
# for degrees in the tangent: its down part is 75 times too small. ecef2lla of a point 100 m above the pole gives a
# height of -6400 km.
# Why it matters: a gyro at rest measures this rate, and an inertial filter subtracts it. In the wrong axis
# it is a bias of 11 degrees/hour about east and leaves one about down; a gyrocompass finds another north.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps navpy==1.0 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
import navpy

print('navpy', version('navpy'))
assert 'NED' in navpy.earthrate.__doc__
got = 1e6 * navpy.earthrate(47.0)
want = 72.92115 * np.array([np.cos(np.radians(47)), 0, -np.sin(np.radians(47))])
print('earthrate at 47 degrees, microrad/s:', np.round(got, 2), 'expected', np.round(want, 2))
assert np.allclose(got, want[[0, 2, 1]], atol=1e-3)
degrees, radians = (navpy.navrate(0, 50, 0, lat, 500, lat_unit=unit) for lat, unit in ((47.0, 'deg'), (np.radians(47.0), 'rad')))
print('navrate of 50 m/s east, microrad/s:', np.round(1e6 * degrees, 3), 'with the latitude in radians', np.round(1e6 * radians, 3))
assert np.allclose(degrees[:2], radians[:2]) and degrees[2] / radians[2] > 50
pole = float(navpy.ecef2lla([0, 0, 6356752.3142 + 100])[2])
print('100 m above the pole, height', round(pole))
assert pole < -6.3e6
EOF
