#!/usr/bin/env bash
# Guess: LogConfig logs a raw memory address as its add_memory says, and at the period that it was given.
# Observed: a block with add_memory dies in create() with TypeError before anything is sent: bytes are appended
# where an integer is wanted. Periods are cut to whole 10 ms without a word: 15 ms becomes 10, 19 ms becomes 10, 25 ms
# becomes 20, while period_in_ms keeps the requested value. 9 ms becomes 0.
# Why it matters: an identification of a motor's lag from a log takes the period for the sample time. 15 for 10 stretches
# the time axis by half, and every rate, lag and drag with it. Take the craft's own timestamps.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile cflib==0.1.34
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
from cflib.crazyflie.log import Log, LogConfig

print('cflib', version('cflib'))


class Craft:
    link = 'up'
    sent = 0

    def add_port_callback(self, port, callback):
        pass

    def send_packet(self, packet, expected_reply=()):
        self.sent += 1


craft = Craft()
craft.log = Log(craft)
block = LogConfig('memory', 100)
block.cf, block.id, block.useV2 = craft, 1, True
block.add_memory('raw', 'float', 'float', 0x20000000)
try:
    block.create()
except TypeError as error:
    print('add_memory, then create():', error, '- packets sent:', craft.sent)
else:
    raise SystemExit('add_memory works now')
assert craft.sent == 0

periods = {asked: LogConfig('period', asked).period * 10 for asked in (9, 10, 15, 19, 25, 100)}
print('period asked: sent, ms:', periods)
assert periods == {9: 0, 10: 10, 15: 10, 19: 10, 25: 20, 100: 100}
assert LogConfig('period', 15).period_in_ms == 15
EOF
