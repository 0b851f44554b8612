#!/usr/bin/env bash
# Guess: a Mellinger controller that is told to hold its place at rest commands the weight of its own craft, and one
# drone of a batch does not feel the others.
# Observed: at rest on its setpoint it commands 0.97 times the weight of the mass in its own parameters for the
# 2.x, 1.45 for the craft with the thrust upgrade and 1.61 for the Brushless: a factor of the 2.x's firmware converts
# newtons to PWM for all of them. A drone that is told no thrust keeps its motors off alone; beside one that flies in
# the same batch they turn at four times the speed, and its force becomes 0.05 to 0.09 N, because the test for a stop
# looks at the whole batch.
# Why it matters: it is the peer that others compare a Crazyflie controller with. Its climb of 45 % is no property of
# the firmware, and a batch is not N single flights.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile drone-controllers==0.1.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
from drone_controllers import parametrize
from drone_controllers.mellinger import control
import numpy as np

print('drone-controllers', version('drone-controllers'))
zero, level = np.zeros(3), np.array([0.0, 0, 0, 1])
two_zeros, two_level = np.zeros((2, 3)), np.array([level, level])
expected = {'cf2x_L250': 0.967, 'cf2x_P250': 0.967, 'cf2x_T350': 1.450, 'cf21B_500': 1.611}
for craft, ratio in expected.items():
    position = parametrize(control.state2attitude, craft)
    attitude = parametrize(control.attitude2force_torque, craft)
    motors = parametrize(control.force_torque2rotor_vel, craft)
    command, _ = position(zero, level, zero, zero, np.zeros(13))
    force = attitude(zero, level, zero, zero, command)[0][0]
    weight = 9.81 * position.keywords['mass']
    off, on = np.array([0.1, 0, 0, 0.0]), np.array([0, 0, 0, 0.3])
    alone = attitude(zero, level, zero, zero, off)[0][0]
    beside = attitude(two_zeros, two_level, two_zeros, two_zeros, np.array([off, on]))[0][0][0]
    rpm_alone = motors(np.array([0.0]), zero)[0]
    rpm_beside = motors(np.array([[0.0], [0.3]]), two_zeros)[0][0]
    print(f'{craft}: at rest {force / weight:.3f} of the weight; told no thrust: alone {alone:.3f} N, {rpm_alone:.0f} rpm, '
          f'beside one that flies {beside:.3f} N, {rpm_beside:.0f} rpm')
    assert abs(force / weight - ratio) < 1e-3
    assert alone == 0 and beside > 0.05 and rpm_beside > 3 * rpm_alone
EOF
