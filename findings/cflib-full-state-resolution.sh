#!/usr/bin/env bash
# Guess: send_full_state_setpoint carries body rates in degrees/s, as its documentation says, and rounds the rest to a
# millimetre and the attitude to something that does not matter.
# Observed: rates are multiplied by 1000 into 16 bits, so that 33 degrees/s raises struct.error: the firmware
# reads milliradians/s, and only radians/s fit (30 meant as degrees/s is flown as 30 rad/s). Lengths are cut toward
# zero, not rounded: 2.01 m goes out as 2.009 m, and -0.9 mm as 0. The attitude has steps of 0.16 degrees: a tilt of
# 0.05 degrees is sent as exactly level, one of 0.1 as 0.159.
# Why it matters: at 9.81 m/s^2 a step of 0.159 degrees is 27 mm/s^2 of feed-forward. A flatness-based setpoint at low
# speed arrives as a staircase, whose jumps the log shows as the controller's, and a trajectory that yaws at 60
# degrees/s ends the script.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile cflib==0.1.34
cd "$dir"
venv/bin/python - <<'EOF'
import math
import struct
from importlib.metadata import version
from cflib.crazyflie.commander import Commander
from cflib.utils.encoding import decompress_quaternion


class Craft:
    def send_packet(self, packet):
        self.data = bytes(packet.data)


craft = Craft()
commander = Commander(craft)
print('cflib', version('cflib'))


def sent(position=(0, 0, 1), tilt=0.0, yaw_rate=0.0):
    half = math.radians(tilt) / 2
    commander.send_full_state_setpoint(position, (0, 0, 0), (0, 0, 0), (math.sin(half), 0, 0, math.cos(half)), 0, 0, yaw_rate)
    return struct.unpack('<BhhhhhhhhhIhhh', craft.data)


assert 'degrees/s' in commander.send_full_state_setpoint.__doc__
print('yaw rate 30 as sent:', sent(yaw_rate=30)[-1])
assert sent(yaw_rate=30)[-1] == 30000
try:
    sent(yaw_rate=33)
except struct.error as error:
    print('yaw rate 33:', error)
else:
    raise SystemExit('a yaw rate of 33 is sent now')

cut = sent(position=(2.01, -0.0009, 1))[1:4]
print('2.01 m, -0.9 mm, 1 m as sent, in mm:', cut)
assert cut == (2009, 0, 1000)

tilts = {}
for tilt in (0.05, 0.1, 0.15, 0.2):
    x = decompress_quaternion(sent(tilt=tilt)[10])[0]
    tilts[tilt] = round(2 * math.degrees(math.asin(x)), 3)
print('tilt given: as sent, degrees:', tilts)
assert tilts == {0.05: 0.0, 0.1: 0.159, 0.15: 0.159, 0.2: 0.159}
EOF
