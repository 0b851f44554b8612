#!/usr/bin/env bash
# Guess: margins that are large, or infinite, belong to a loop that is stable, and a loop that is not gets negative
# ones, none, or a warning.
# Observed: for 0.5/(s - 1) with unit feedback, whose closed loop has a pole at +0.5, margin gives a gain margin
# of 2 and an infinite phase margin, for 0.001/(s - 1) a gain margin of 1000. disk_margins gives 6 dB and 37 degrees
# for the first, a good loop by any specification, and 60 dB for the second. A loop that is unstable by too much gain
# gets a gain margin of 0.6 and a phase margin of -13 degrees from the one, and positive margins from the other.
# Neither says a word.
# Why it matters: a sweep over gains of an airframe that is unstable without feedback, ranked by its margins, picks
# the weakest gain. Ask for the poles of the closed loop first.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile control==0.10.2 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import math
from importlib.metadata import version
import numpy as np
import control

print('control', version('control'))
s, grid = control.tf('s'), np.logspace(-3, 3, 2000)
for name, loop in (('0.5/(s-1)', 0.5 / (s - 1)), ('0.001/(s-1)', 0.001 / (s - 1)), ('10/(s(s+1)(s+2))', 10 / (s * (s + 1) * (s + 2)))):
    gain, phase, _, _ = control.margin(loop)
    disk, disk_gain, disk_phase = control.disk_margins(loop, grid)
    worst = max(control.feedback(loop, 1).poles().real)
    print(f'{name}: closed loop at {worst:+.3f}; gain margin {gain:.3g}, phase margin {phase:.3g} degrees; disk {disk_gain:.1f} dB, {disk_phase:.0f} degrees')
    assert worst > 0 and disk_gain > 1.5 and disk_phase > 10
    if name[0] == '0':
        assert gain >= 2 and math.isinf(phase)
    else:
        assert gain < 1 and phase < 0
EOF
