#!/usr/bin/env bash
# Guess: an orientation filter fed an exact gyro and a level accelerometer turns by the gyro's reading, at any rate.
# Observed: VQF with its defaults does from 2.5 degrees/s upwards. A steady turn of 1.9 degrees/s, for a minute,
# is taken for a sensor at rest with a bias: 114 degrees turned, 3.2 reported, and the bias that is given back is the
# turn.
# Why it matters: a craft that creeps round in yaw in a simulation without vibration is just such a sensor. The log of
# a yaw drift, the thing looked for, is where it vanishes; switch the rest detection off for flights.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps vqf==2.1.2 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
from vqf import VQF

print('vqf', version('vqf'))
seconds, dt = 60, 0.01
for rate, share in ((0.5, 0.03), (1.9, 0.03), (2.5, 1.0), (5.0, 1.0)):
    gyro = np.tile([0.0, 0.0, np.radians(rate)], (int(seconds / dt), 1))
    accelerometer = np.tile([0.0, 0.0, 9.81], (int(seconds / dt), 1))
    out = VQF(dt).updateBatch(gyro, accelerometer)
    w, z = out['quat6D'][:, 0], out['quat6D'][:, 3]
    turned = np.degrees(np.unwrap(2 * np.arctan2(z, w)))[-1]
    print(f'{rate} degrees/s for a minute: turned {rate * seconds:.0f}, reported {turned:.1f} degrees, bias {np.degrees(out["bias"][-1][2]):.2f} degrees/s')
    assert abs(turned / (rate * seconds) - share) < 0.01
EOF
