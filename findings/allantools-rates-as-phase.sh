#!/usr/bin/env bash
# Guess: oadev(rates, rate=200) of a gyro's log gives the Allan deviation of those rates, from which the noise density
# is read at 1 s.
# Observed: the default says that the data are phases, the integral of the rates. White noise of 0.0001 rad/s per
# root hertz, sampled at 200 Hz, reads as 0.0025 at 1 s, 25 times too much, and falls with the time instead of its
# root. data_type='freq' gives 0.0001. Times that are no multiple of the sample time are cut to one: 0.1017 s becomes
# 0.1, which the returned times say and the asked ones do not.
# Why it matters: the figure goes into a Kalman filter's gyro noise. A variance 600 times too large makes the filter
# believe the accelerometer, in a craft that vibrates.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps AllanTools==2024.6 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import allantools
import numpy as np

print('allantools', version('AllanTools'))
rate, density = 200.0, 1e-4
gyro = np.random.default_rng(0).normal(size=int(rate * 1200)) * density * np.sqrt(rate)
times, as_phase, _, _ = allantools.oadev(gyro, rate=rate, taus=[0.1, 1, 10])
_, as_rate, _, _ = allantools.oadev(gyro, rate=rate, data_type='freq', taus=[0.1, 1, 10])
print('times', times, '\ndefault', as_phase, '\ndata_type freq', as_rate)
assert abs(as_rate[1] / density - 1) < 0.1 and 22 < as_phase[1] / density < 27
assert abs(as_rate[0] / as_rate[2] / 10 - 1) < 0.3 and abs(as_phase[0] / as_phase[2] / 100 - 1) < 0.3
print('asked for 0.1017 s:', allantools.oadev(gyro, rate=rate, data_type='freq', taus=[0.1017])[0])
assert abs(allantools.oadev(gyro, rate=rate, data_type='freq', taus=[0.1017])[0][0] - 0.1) < 1e-12
EOF
