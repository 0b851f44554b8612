#!/usr/bin/env bash
# Guess: MotionCommander.take_off lifts the craft from where it is and leaves the position estimate alone.
# Observed: it resets the Kalman filter first and waits 2.1 s, so that with a motion capture system or Lighthouse
# position and heading are found anew while the propellers are about to start. Its heights count from 0 wherever the
# craft is: up(0.3) from a table of 0.7 m asks for 0.3 m. turn_left(90) is a rate for 1.25 s, with nothing that looks
# at the heading.
# Why it matters: a position controller sees a jump of its estimate at each take-off and starts below its table; and a
# turn is as long as the radio was good.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile cflib==0.1.34
cd "$dir"
venv/bin/python - <<'EOF'
import struct
import time
from importlib.metadata import version
from types import SimpleNamespace
from cflib.crazyflie.commander import Commander
from cflib.positioning.motion_commander import MotionCommander

print('cflib', version('cflib'))
waits, sleep = [], time.sleep
time.sleep = lambda seconds: (waits.append(seconds), sleep(0.3 if seconds >= 0.2 else 0.01))[0]


class Craft:
    platform = SimpleNamespace(get_protocol_version=lambda: 12)
    told, parameters = [], []

    def __init__(self):
        self.param = SimpleNamespace(set_value=lambda name, value: self.parameters.append((name, value)))
        self.commander = Commander(self)

    def is_connected(self):
        return True

    def send_packet(self, packet):
        if len(packet.data) == 17 and packet.data[0] == 10:
            self.told.append(struct.unpack('<Bffff', bytes(packet.data))[1:])


craft = Craft()
motion = MotionCommander(craft)
motion.take_off(0.3)
print('parameters set by take_off:', craft.parameters, '- waits, s:', waits[:2])
assert craft.parameters == [('kalman.resetEstimation', '1'), ('kalman.resetEstimation', '0')] and waits[:2] == [0.1, 2]
print('first height told:', round(craft.told[0][3], 3), 'm')
assert craft.told[0][3] < 0.1
before = len(waits)
motion.turn_left(90)
print('turn_left(90): yaw rate', max(told[2] for told in craft.told), 'degrees/s, waits', waits[before:][0], 's')
assert 1.25 in waits[before:] and max(told[2] for told in craft.told) == 72
motion.land()
EOF
