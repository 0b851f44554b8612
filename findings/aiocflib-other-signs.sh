#!/usr/bin/env bash
# Guess: two Python libraries for one craft give one meaning to the same call.
# Observed: aiocflib's hover, velocity and height setpoints use the packet types whose yaw rate the firmware turns
# round, and do not turn it: +30 degrees/s turns the craft clockwise, with cflib (same packet type for old firmware,
# and the new ones) counter-clockwise. go_to takes degrees (cflib: radians); takeoff without a yaw keeps the heading
# (cflib: turns to 0). A log variable fetched as fp16 comes as its bits, 1.0 as 15360 (cflib: 1.0).
# Why it matters: a script that is moved from one library to the other flies, and turns the wrong way. A yaw
# controller that is judged by it looks unstable in sign.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile aiocflib==5.0.2 cflib==0.1.34
cd "$dir"
venv/bin/python - <<'EOF'
import asyncio
import struct
import warnings
from importlib.metadata import version
from aiocflib.crazyflie.commander import Commander as AioCommander
from aiocflib.crazyflie.high_level_commander import HighLevelCommander as AioHigh
from aiocflib.crazyflie.log import VariableType
from cflib.crazyflie.commander import Commander
from cflib.crazyflie.high_level_commander import HighLevelCommander
from cflib.crazyflie.log import LogTocElement

warnings.simplefilter('ignore')
print('aiocflib', version('aiocflib'), 'cflib', version('cflib'))


class Platform:
    def get_protocol_version(self):
        return 8


class Craft:
    platform = Platform()

    def send_packet(self, packet):
        self.data = bytes(packet.data)


class AioCraft:
    async def send_packet(self, *, port, data, **rest):
        self.data = bytes(data)


old, aio = Craft(), AioCraft()
a, b = Commander(old), AioCommander(aio)
for name, arguments in (('hover', (0, 0, 30, 1)), ('velocity_world', (0, 0, 0, 30)), ('zdistance', (0, 0, 30, 1))):
    getattr(a, f'send_{name}_setpoint')(*arguments)
    asyncio.run(getattr(b, f'send_{name.replace("zdist", "z_dist")}_setpoint')(*arguments))
    ours, theirs = struct.unpack('<Bffff', old.data), struct.unpack('<Bffff', aio.data)
    print(f'{name} with yaw rate 30: cflib sends {ours}, aiocflib {theirs}')
    assert ours[0] == theirs[0] and [x for x, y in zip(ours, theirs) if x != y] == [-30]

high = AioHigh(aio)


async def run(self, *, command, data=b'', **rest):
    aio.data = bytes(data)


AioHigh._run_command = run
asyncio.run(high.go_to(0, 0, 1, yaw=90, duration=2))
aio_yaw = struct.unpack('<Bfffff', aio.data)[4]
HighLevelCommander(old).go_to(0, 0, 1, 90, 2)
cf_yaw = struct.unpack('<BBBBfffff', old.data)[7]
print('go_to with yaw 90: cflib sends', cf_yaw, 'rad, aiocflib', round(aio_yaw, 4), 'rad')
assert cf_yaw == 90 and abs(aio_yaw - 1.5708) < 1e-4
asyncio.run(high.takeoff(0.5, duration=2))
keeps = struct.unpack('<ff?f', aio.data)[2]
HighLevelCommander(old).takeoff(0.5, 2)
print('takeoff keeps the heading: cflib', struct.unpack('<BBff?f', old.data)[4], 'aiocflib', keeps)
assert keeps and not struct.unpack('<BBff?f', old.data)[4]

bits = struct.pack('<e', 1.0)
aio_value = VariableType.to_type('fp16').struct.unpack(bits)[0]
cf_value = struct.unpack(LogTocElement.get_unpack_string_from_id(8), bits)[0]
print('1.0 logged as fp16: cflib', cf_value, 'aiocflib', aio_value)
assert (cf_value, aio_value) == (1.0, 15360)
EOF
