#!/usr/bin/env bash
# Guess: the first-principles model has one motor lag per craft, and the gyroscopic torque of its spinning rotors
# turns the craft's rotation without adding energy, as a torque at right angles to the body rate does.
# Observed: each craft has two lags, one for a rising and one for a falling command, with a step between them at
# the command itself: 136 and 108 ms for the 2.x with its first propellers, 57 and 62 ms for the Brushless. The
# gyroscopic torque has the same sign in roll and pitch instead of opposite ones: with the body turning about (1, 1,
# 0) it does work, 0.36 mW at 7 rad/s and 2000 rpm of difference between the two directions.
# Why it matters: a design that is certified over one lag is tried on two, and at hover every small correction crosses
# the step. An adaptive or learned controller finds the energy that the second one hands out.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile drone-models==0.1.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
from drone_models import parametrize
from drone_models.first_principles import dynamics
import numpy as np

print('drone-models', version('drone-models'))
expected = {'cf2x_L250': (136, 108), 'cf2x_P250': (112, 103), 'cf2x_T350': (88, 69), 'cf21B_500': (57, 62)}
still, level = np.zeros(3), np.array([0.0, 0, 0, 1])
for craft, lags in expected.items():
    model = parametrize(dynamics, craft)
    p = model.keywords
    c0, c1, c2 = np.asarray(p['rpm2thrust'])
    weight = float(p['mass']) * 9.81
    hover = (-c1 + np.sqrt(c1**2 - 4 * c2 * (c0 - weight / 4))) / (2 * c2)

    def step(rpm):
        change = model(pos=still, quat=level, vel=still, ang_vel=still, cmd=np.full(4, hover + rpm), rotor_vel=np.full(4, hover))
        return round(1e3 * rpm / change[4][0])

    print(craft, 'hovers at', round(hover), 'rpm; time constant of a rising command', step(1.0), 'ms, falling', step(-1.0), 'ms')
    assert (step(1.0), step(-1.0)) == lags

model = parametrize(dynamics, 'cf2x_L250')
J = np.asarray(model.keywords['J'])
rate = np.array([5.0, 5.0, 0.0])
spin = np.array([20000.0, 19000.0, 20000.0, 19000.0])


def torque(body_rate):
    accel = model(pos=still, quat=level, vel=still, ang_vel=body_rate, cmd=spin, rotor_vel=spin)[3]
    return J @ accel + np.cross(body_rate, J @ body_rate)


gyroscopic = torque(rate) - torque(still)
power = rate @ gyroscopic
print('gyroscopic torque at body rate', rate, 'rad/s:', gyroscopic, 'N m; power', power, 'W')
assert gyroscopic[0] == gyroscopic[1] > 0 and abs(power - 3.6e-4) < 1e-5
EOF
