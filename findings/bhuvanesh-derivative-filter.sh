#!/usr/bin/env bash
# Guess: a PID controller whose derivative_filter_hz is 30, as it is by default, lets 0.71 of a sine's derivative
# through at 30 Hz.
# Observed: 0.16. Its 0.71 is at 4.8 Hz: the factor of 2 pi between a frequency and the gain per step, time step
# times frequency, is left out. From a rate of 30 Hz downwards, the factor is 1 and nothing is filtered. A step of the
# setpoint goes into the derivative as well, since it is that of the error.
# Why it matters: the derivative is there for its phase, and at 10 Hz, where an attitude loop needs it, it has 46
# degrees less than planned. A gain found in this simulation is too large for a loop whose filter has the stated
# frequency.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps bhuvanesh-aerospace-controls==0.6.0 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
import cmath
import math
from importlib.metadata import version
import numpy as np
from bhuvanesh.controllers import PIDController

print('bhuvanesh-aerospace-controls', version('bhuvanesh-aerospace-controls'))


def derivative(frequency, step=1e-4, count=40000):
    controller = PIDController(0.0, 0.0, 1.0, derivative_filter_hz=30.0)
    times = np.arange(count) * step
    output = np.array([controller.update(-math.sin(2 * math.pi * frequency * t), step) for t in times])[count // 2:]
    sine = 2 * np.mean(output * np.exp(-2j * math.pi * frequency * times[count // 2:]))
    return sine / (2 * math.pi * frequency)


for frequency, want in ((30 / (2 * math.pi), 0.707), (10.0, 0.43), (30.0, 0.157)):
    got = derivative(frequency)
    print(f'derivative at {frequency:.2f} Hz: {abs(got):.3f} of the true one, {math.degrees(cmath.phase(got)):.0f} degrees')
    assert abs(abs(got) - want) < 0.005
coarse = PIDController(0.0, 0.0, 1.0, derivative_filter_hz=30.0)
steps = [coarse.update(-x, 1 / 30) for x in (0.0, 1.0, 1.0)]
print('at 30 Hz, a step of 1:', [round(x, 6) for x in steps])
assert abs(steps[1] - 30) < 1e-9 and abs(steps[2]) < 1e-9
kick = PIDController(0.0, 0.0, 1.0, derivative_filter_hz=None)
kicks = [kick.update(0.0, 0.01, setpoint=s) for s in (0.0, 1.0)]
print('a step of the setpoint, unfiltered:', kicks)
assert abs(kicks[1] - 100) < 1e-9
EOF
