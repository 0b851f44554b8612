#!/usr/bin/env bash
# Guess: the checksum of MAVLink, which its sources call X.25, is the X-25 of libraries of checksums.
# Observed: pymavlink's x25crc of 123456789 is 6f91, and the X-25 of the catalogues (there as crc16.ibm_sdlc) is
# 906e, its complement. MAVLink's is the catalogue's MCRF4XX: the same polynomial and start, without the last
# inversion. It is taken over the message and one byte more, the CRC_EXTRA of its definition, which is not sent.
# Why it matters: a link of one's own, or a decoder for a log, that takes the one of the same name refuses every
# frame, and looks like a wrong baud rate.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps pymavlink==2.4.50 fastcrc==0.5.0
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import fastcrc
from pymavlink.generator.mavcrc import x25crc

print('pymavlink', version('pymavlink'), 'fastcrc', version('fastcrc'))
sums = {'x25crc': x25crc(b'123456789').crc, 'X-25': fastcrc.crc16.ibm_sdlc(b'123456789'), 'MCRF4XX': fastcrc.crc16.mcrf4xx(b'123456789')}
print({name: f'{value:04x}' for name, value in sums.items()})
assert sums == {'x25crc': 0x6F91, 'X-25': 0x906E, 'MCRF4XX': 0x6F91}
EOF
