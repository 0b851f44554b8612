#!/usr/bin/env bash
# Guess: fp16_to_float, which cflib decodes Lighthouse angles with, agrees with the half-precision numbers of IEEE 754
# (Python's struct has them as 'e').
# Observed: it does for all numbers but one: minus zero comes out as 2147483648. Both infinities come out as
# integers of billions, and NaN as another integer.
# Why it matters: the angle streams send small differences between four sensors in this format. A difference that is a
# hair below zero rounds to minus zero in it, and the sensor's angle is then two billion radians. A filter on finite
# numbers lets that pass.
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
from cflib.crazyflie.localization import Localization
from cflib.utils.encoding import fp16_to_float

print('cflib', version('cflib'))
equal = 0
for bits in range(65536):
    true = struct.unpack('<e', struct.pack('<H', bits))[0]
    equal += fp16_to_float(bits) == true
print('patterns decoded as IEEE 754 has them:', equal)
for name, bits in (('-0', 0x8000), ('inf', 0x7c00), ('-inf', 0xfc00), ('nan', 0x7e00), ('-1', 0xbc00)):
    print(name, 'becomes', fp16_to_float(bits))
assert fp16_to_float(0x8000) == 2147483648 and fp16_to_float(0x7c00) == 2139095040
assert math.isfinite(fp16_to_float(0x7e00))


class Craft:
    def add_port_callback(self, port, callback):
        pass


# One base station, first sensor at 0.5 rad, the second 1e-9 rad above it: the difference rounds to -0.
tiny = struct.unpack('<h', struct.pack('<e', -1e-9))[0]
packet = struct.pack('<Bfhhhfhhh', 0, 0.5, tiny, 0, 0, 0.5, 0, 0, 0)
angles = Localization(Craft())._decode_lh_angle(packet)
print('horizontal angles of the four sensors, rad:', angles['x'])
assert angles['x'] == [0.5, 0.5 - 2147483648, 0.5, 0.5]
EOF
