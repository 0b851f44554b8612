#!/usr/bin/env bash
# Guess: cflib's attitude setpoints take one sign of pitch, and 0 % of thrust stops the motors.
# Observed: send_setpoint and send_setpoint_manual put the pitch on the air with its sign turned,
# send_zdistance_setpoint as it was given: the same angle tilts the craft forwards by one call and backwards by
# another. 0 % of send_setpoint_manual is 10001 of 65535, 15 % of thrust, and 100 % is 60000: no percentage turns the
# motors off and none gives all of it.
# Why it matters: a test of a controller by hand with these calls reads a right answer as a wrong sign, and a landing
# by 0 % leaves four propellers turning.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile cflib==0.1.34
cd "$dir"
venv/bin/python - <<'EOF'
import struct
from importlib.metadata import version
from cflib.crazyflie.commander import Commander


class Platform:
    def get_protocol_version(self):
        return 12


class Craft:
    """Keeps the packets that would go to the radio."""
    platform = Platform()

    def send_packet(self, packet):
        self.data = bytes(packet.data)


craft = Craft()
commander = Commander(craft)
print('cflib', version('cflib'))

commander.send_setpoint(0, 10, 0, 30000)
classic = struct.unpack('<fffH', craft.data)[1]
commander.send_setpoint_manual(0, 10, 0, 50, False)
manual = struct.unpack('<BfffHB', craft.data)[2]
commander.send_zdistance_setpoint(0, 10, 0, 1)
height = struct.unpack('<Bffff', craft.data)[2]
print('pitch of 10 degrees as sent: send_setpoint', classic, 'manual', manual, 'zdistance', height)
assert (classic, manual, height) == (-10, -10, 10)

sent = {}
for percent in (0, 50, 100):
    commander.send_setpoint_manual(0, 0, 0, percent, False)
    sent[percent] = struct.unpack('<BfffHB', craft.data)[4]
print('thrust as sent of 65535:', sent)
assert sent == {0: 10001, 50: 35000, 100: 60000}
commander.send_stop_setpoint()
print('send_stop_setpoint:', craft.data.hex())
assert craft.data == b'\x00'
EOF
