#!/usr/bin/env bash
# Guess: an attitude filter without a magnetometer counts every turn of its gyro from the first sample on; at worst
# its heading starts from 0.
# Observed: for the first 3 s the heading is put back to 0 at each update. Turning at 30 degrees/s for 10 s it
# ends at 210 degrees and not at 300; turning in the first second only it shows nothing. skip_startup, or 3 s at rest,
# give all of the turn. Fed m/s^2 instead of the g that it wants, it gives the same attitude, and 8.8 as the linear
# acceleration of a craft at rest.
# Why it matters: a log that starts at arming, or a test of three seconds, has no heading at all, and one that starts
# while the craft turns has an offset that stays. A yaw controller that is judged on it answers nothing.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps imufusion==1.3.3 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import imufusion
import numpy as np

print('imufusion', version('imufusion'))
still, turning, level = np.zeros(3), np.array([0, 0, 30.0]), np.array([0, 0, 1.0])


def heading(seconds_still, seconds_turning, skip=False):
    ahrs = imufusion.Ahrs()
    if skip:
        ahrs.skip_startup()
    for rate, seconds in ((still, seconds_still), (turning, seconds_turning)):
        for _ in range(round(100 * seconds)):
            ahrs.update_no_magnetometer(rate, level)
    return imufusion.quaternion_to_euler(ahrs.get_quaternion())[2] % 360


for case, want in (((0, 1), 0), ((0, 10), 210.3), ((1, 1), 0), ((3, 1), 30), ((0, 10, True), 300)):
    got = heading(*case)
    print(f'{case[0]} s still, {case[1]} s at 30 degrees/s{", startup skipped" if len(case) > 2 else ""}: {got:.1f} degrees')
    assert abs(got - want) < 0.2
ahrs = imufusion.Ahrs()
for _ in range(1000):
    ahrs.update_no_magnetometer(still, 9.81 * level)
print('at rest, fed m/s^2: linear acceleration', ahrs.get_linear_acceleration()[2])
assert abs(ahrs.get_linear_acceleration()[2] - 8.81) < 0.01
EOF
