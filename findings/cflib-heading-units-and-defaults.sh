#!/usr/bin/env bash
# Guess: a heading has one unit throughout cflib, and a take-off or a go-to that names none keeps the one the craft
# has.
# Observed: the low-level send_position_setpoint takes degrees, the high-level go_to radians, so go_to(.., 90, ..)
# asks for 14.3 turns. takeoff() and land() without a yaw turn the craft to yaw 0 (None keeps it). PositionHlCommander
# has no heading at all: each of its go_to and forward sends yaw 0, forward means along the room's x, and its take-off
# turns to 0 as well.
# Why it matters: a craft put down with another heading spins while it leaves the ground, when the propellers' wash is
# worst, and a controller tuned on straight take-offs is blamed for the drift.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile cflib==0.1.34
cd "$dir"
venv/bin/python - <<'EOF'
import math
import struct
import time
from importlib.metadata import version
from cflib.crazyflie.commander import Commander
from cflib.crazyflie.high_level_commander import HighLevelCommander
from cflib.positioning.position_hl_commander import PositionHlCommander


class Platform:
    def get_protocol_version(self):
        return 12


class Craft:
    platform = Platform()

    def is_connected(self):
        return True

    def send_packet(self, packet):
        self.data = bytes(packet.data)


craft = Craft()
high = craft.high_level_commander = HighLevelCommander(craft)
print('cflib', version('cflib'))

Commander(craft).send_position_setpoint(0, 0, 1, 90)
low_yaw = struct.unpack('<Bffff', craft.data)[4]
high.go_to(0, 0, 1, 90, 2)
high_yaw = struct.unpack('<BBBBfffff', craft.data)[7]
print('90 as sent: position setpoint', low_yaw, 'degrees, go_to', high_yaw, 'radians =', round(high_yaw / 2 / math.pi, 2), 'turns')
assert low_yaw == high_yaw == 90

yaws = {}
for name, call in (('takeoff', high.takeoff), ('land', high.land)):
    call(0.5, 2)
    yaws[name] = struct.unpack('<BBff?f', craft.data)[3:5]
    call(0.5, 2, yaw=None)
    yaws[name + ' yaw=None'] = struct.unpack('<BBff?f', craft.data)[3:5]
print('(yaw, keep the heading):', yaws)
assert yaws['takeoff'] == yaws['land'] == (0.0, False)
assert yaws['takeoff yaw=None'] == yaws['land yaw=None'] == (0.0, True)

time.sleep = lambda seconds: None  # the class waits while the craft would fly
simple = PositionHlCommander(craft)
simple.take_off()
assert struct.unpack('<BBff?f', craft.data)[3:5] == (0.0, False)
simple.forward(1)
x, y, z, yaw, _ = struct.unpack('<BBBBfffff', craft.data)[4:]
print('PositionHlCommander.forward(1): to', (x, y, z), 'with yaw', yaw)
assert (x, y, z, yaw) == (1, 0, 0.5, 0)
EOF
