#!/usr/bin/env bash
# Guess: a Poly4D made with its x alone has three more polynomials of its own, all zero.
# Observed: the default list of Poly's eight coefficients is one object for all. A height written into z.values
# appears in y and yaw, and in every piece that is made later without coefficients: the craft is told to climb to 1 m,
# to fly 1 m to its left and to turn by 1 rad.
# Why it matters: filling a trajectory piece by piece is the way of every exporter, and nothing on the way to the
# firmware notices.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile cflib==0.1.34
cd "$dir"
venv/bin/python - <<'EOF'
import struct
from importlib.metadata import version
from cflib.crazyflie.mem import Poly4D

print('cflib', version('cflib'))
first = Poly4D(2.0)
first.z.values[0] = 1.0
later = Poly4D(2.0)


def start(piece):
    floats = struct.unpack('<33f', piece.pack())
    return dict(zip(('x', 'y', 'z', 'yaw'), floats[0:32:8]))


print('first piece starts at', start(first))
print('later piece starts at', start(later))
assert start(first) == start(later) == dict(x=1, y=1, z=1, yaw=1)
apart = Poly4D(2.0, z=Poly4D.Poly([1.0] + 7 * [0.0]), x=Poly4D.Poly(8 * [0.0]), y=Poly4D.Poly(8 * [0.0]), yaw=Poly4D.Poly(8 * [0.0]))
print('with lists given:', start(apart))
assert start(apart) == dict(x=0, y=0, z=1, yaw=0)
EOF
