#!/usr/bin/env bash
# Guess: two logs of ArduPilot opened as two objects have each its own data. A flight mode's name can be compared with
# the name that it has.
# Observed: the tables belong to the class. What one object reads of a kind of message is the other's answer too: the
# heights and the gains of the second log are those of the first. A log that is opened while another is in use empties
# that one's tables, and fills them. GetPARAM alone reads its own log. 'STABILIZE ' has a blank at its end.
# Why it matters: before and after a change of a gain are compared, and the two flights agree to the last digit.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps mavdataflash==3.0.0 pymavlink==2.4.50 polars==1.33.1
cd "$dir"
venv/bin/python - <<'EOF'
import struct
from importlib.metadata import version
from MAVdataflash import DataFlash

print('mavdataflash', version('mavdataflash'))


def write(path, heights, gain):
    def define(kind, length, name, form, columns):
        return b'\xa3\x95\x80' + struct.pack('<BB4s16s64s', kind, length, name, form, columns)

    with open(path, 'wb') as f:
        f.write(define(0x80, 89, b'FMT', b'BBnNZ', b'Type,Length,Name,Format,Columns'))
        f.write(define(1, 15, b'BARO', b'Qf', b'TimeUS,Alt'))
        f.write(define(2, 31, b'PARM', b'QNf', b'TimeUS,Name,Value'))
        f.write(define(3, 14, b'MODE', b'QMBB', b'TimeUS,Mode,ModeNum,Rsn'))
        f.write(b'\xa3\x95\x02' + struct.pack('<Q16sf', 500, b'ATC_RAT_RLL_P', gain))
        f.write(b'\xa3\x95\x03' + struct.pack('<QBBB', 600, 0, 0, 0))
        for k, height in enumerate(heights):
            f.write(b'\xa3\x95\x01' + struct.pack('<Qf', 1000 * (k + 1), height))


write('before.bin', [1.0, 2.0, 3.0], 0.125)
write('after.bin', [10.0, 20.0, 30.0], 0.25)


def heights(log):
    return log.GetData('BARO', in_polars=True)['Alt'].to_list()


def gain(log):
    return log.GetPARAMS(in_polars=True)['Value'].to_list()


before, after = DataFlash('before.bin'), DataFlash('after.bin')
print('both opened: heights', heights(before), 'and', heights(after), 'gains', gain(before), 'and', gain(after))
assert heights(after) == heights(before) == [1, 2, 3] and gain(after) == gain(before) == [0.125]
print('GetPARAM of the second:', after.GetPARAM('ATC_RAT_RLL_P'))
assert after.GetPARAM('ATC_RAT_RLL_P') == 0.25

before = DataFlash('before.bin')
at_first = heights(before)
after = DataFlash('after.bin')
heights(after)
print('the first log before the second is opened:', at_first, 'and then:', heights(before))
assert at_first == [1, 2, 3] and heights(before) == [10, 20, 30]
mode = before.GetModes(in_polars=True)['ModeName'][0]
print('mode 0:', repr(mode))
assert mode == 'STABILIZE '
EOF
