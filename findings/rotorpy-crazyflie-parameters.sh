#!/usr/bin/env bash
# Guess: RotorPy's two Crazyflies turn in yaw as the firmware expects, count motors as it does, and a vehicle starts
# from numbers of its own.
# Observed: their yaw torque per thrust is 33.9 mm for the 2.1 and 19.2 mm for the Brushless; the firmware's own
# figures are 7.35 and 5.69 mm, so that yaw answers 4.6 and 3.4 times as strongly. The first motor is front left (the
# firmware's M1 is front right). The default initial position and attitude are arrays of integers in one dictionary
# for every vehicle: 0.6 m becomes 0, 1.7 m becomes 1, and a position written for one craft is the start of all
# others.
# Why it matters: a yaw gain tuned there is several times too small on the craft, and two vehicles of one test start
# from the same wrong place.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile rotorpy==3.0.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
from rotorpy.vehicles.crazyflie_params import quad_params as brushed
from rotorpy.vehicles.crazyfliebrushless_params import quad_params as brushless
from rotorpy.vehicles.multirotor import Multirotor

print('rotorpy', version('rotorpy'))
for name, p, firmware in (('2.1', brushed, 7.35), ('Brushless', brushless, 5.69)):
    arm = 1e3 * p['k_m'] / p['k_eta']
    print(f'{name}: yaw torque per thrust {arm:.1f} mm, {arm / firmware:.1f} times the firmware\'s; first motor at', p['rotor_pos']['r1'])
    assert arm > 3 * firmware
    assert p['rotor_pos']['r1'][0] > 0 and p['rotor_pos']['r1'][1] > 0  # x forward, y left

one, other = Multirotor(brushed), Multirotor(brushless)
print('types of the initial state:', {key: value.dtype.name for key, value in one.initial_state.items()})
assert one.initial_state['x'].dtype.kind == one.initial_state['q'].dtype.kind == 'i'
one.initial_state['x'][:] = [0.6, 0.0, 1.7]
print('0.6, 0, 1.7 m written for one vehicle; the other starts at', other.initial_state['x'], 'a later one at', Multirotor(brushed).initial_state['x'])
assert list(other.initial_state['x']) == list(Multirotor(brushed).initial_state['x']) == [0, 0, 1]
EOF
