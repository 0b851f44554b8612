#!/usr/bin/env bash
# Guess: a pose or a frame of Foxglove's messages whose rotation is left out, or made with Quaternion(), is level.
# Observed: Quaternion() is (0, 0, 0, 0), which is no rotation. Quaternion(x=0.1) keeps w at 0 and is a half turn.
# Fields that hold zero are not written at all, so that a default quaternion takes no byte in the log, and one that is
# level takes nine.
# Why it matters: a logger that fills in position alone writes poses with a quaternion that cannot be normalised. A reader
# of the log divides by zero or draws nothing, and a small roll that is set as x alone comes out upside down.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile foxglove-sdk==0.30.3
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
from foxglove.messages import Pose, Quaternion, Vector3

print('foxglove-sdk', version('foxglove-sdk'))
print('Quaternion() is', Quaternion(), 'and takes', len(Quaternion().encode()), 'bytes; w=1 takes', len(Quaternion(w=1.0).encode()))
assert repr(Quaternion()) == 'Quaternion(x=0.0, y=0.0, z=0.0, w=0.0)'
assert Quaternion().encode() == b'' and len(Quaternion(w=1.0).encode()) == 9
print('Quaternion(x=0.1) is', Quaternion(x=0.1))
assert repr(Quaternion(x=0.1)) == 'Quaternion(x=0.1, y=0.0, z=0.0, w=0.0)'
posed = Pose(position=Vector3(z=1.0), orientation=Quaternion())
print('a pose with it:', posed, posed.encode().hex())
assert posed.encode().endswith(b'\x12\x00')  # field 2, the orientation, present and empty
EOF
