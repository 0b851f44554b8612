#!/usr/bin/env bash
# Guess: a light-show package for the Crazyflie sends the heading that its MoveTo documents in degrees, and its
# collision check covers the show that it flies.
# Observed: MoveTo(yaw=90) goes to cflib's go_to as it is, which takes radians: the craft is told to turn 14.3
# times within the move. The check ends at the start of the last action: two craft whose last moves cross pass it, and
# the same two are refused when a Hover is added after the crossing.
# Why it matters: a controller that gets 45 rad/s of yaw from a planner saturates its motors, and the planner, not the
# controller, is where to look.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile flaight==0.1.0 cflib==0.1.34 ollama==0.6.3
cd "$dir"
venv/bin/python - <<'EOF'
import struct
import types
from importlib.metadata import version

from flaight import Hover, MoveTo, Show, Takeoff
from flaight.runner import DroneController, _execute_action
from flaight.validate import CollisionError, validate
from cflib.crazyflie.high_level_commander import HighLevelCommander

print('flaight', version('flaight'), 'cflib', version('cflib'))


class Craft:
    platform = types.SimpleNamespace(get_protocol_version=lambda: 12)

    def send_packet(self, packet):
        self.data = bytes(packet.data)


craft = Craft()
craft.high_level_commander = HighLevelCommander(craft)
_execute_action(DroneController(types.SimpleNamespace(cf=craft)), MoveTo(0, 0, 1, yaw=90, duration=2))
yaw = struct.unpack('<BBBBfffff', craft.data)[7]
print('MoveTo(yaw=90) sends', yaw, 'rad =', round(yaw / 6.283185, 1), 'turns')
assert yaw == 90


def crossing(hover_after):
    show = Show()
    for name, x in (('one', -1.0), ('two', 1.0)):
        track = show.add_drone(name, uri='radio://0/80/2M/' + name)
        track.at(0, Takeoff(1, 2)).at(2, MoveTo(x, 0, 1)).at(4, MoveTo(-x, 0, 1, duration=4))
        if hover_after:
            track.at(8, Hover(1))
    try:
        validate(show)
    except CollisionError:
        return 'refused'
    return 'passed'


print('two that cross in their last move:', crossing(False), '- with a hover after it:', crossing(True))
assert (crossing(False), crossing(True)) == ('passed', 'refused')
EOF
