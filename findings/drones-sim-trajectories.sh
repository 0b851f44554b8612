#!/usr/bin/env bash
# Guess: a minimum-snap generator without times chooses some that suit the distance; a trajectory for testing
# estimators has rates in the frame of a gyro, and positions that are the integral of its velocities.
# Observed: without times each leg gets one second on average, however long: 1 m at 2.2 m/s at most, 100 m at 219
# m/s. The body rates of its circle are in the world's frame, and the package's simulated gyro reports them as they
# are: x and y differ by up to 0.5 rad/s from the rates of the attitudes in the same rows. The 'canonical' trajectory
# jumps in height by 0.2 m at the end of its cruise.
# Why it matters: a filter that is tuned on these rows learns biases that no sensor has, and a planner's first answer
# is one that nothing can fly.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps drones-sim==0.2.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import sys
import types
from importlib.metadata import version
from importlib.util import find_spec
import numpy as np
from scipy.spatial.transform import Rotation

# The package without its __init__, which imports the plots and their dependencies.
package = types.ModuleType('drones_sim')
package.__path__ = list(find_spec('drones_sim').submodule_search_locations)
sys.modules['drones_sim'] = package
from drones_sim.trajectory import generate_circular, generate_hover_accel_cruise, generate_minimum_snap

print('drones-sim', version('drones-sim'))
fastest = {}
for leg in (1, 100):
    plan = generate_minimum_snap([(0, 0, 1), (leg, 0, 1), (2 * leg, 0, 1)])
    fastest[leg] = np.abs(plan.velocity).max()
    print(f'two legs of {leg} m: {plan.t[-1]:.2f} s, up to {fastest[leg]:.1f} m/s')
assert abs(fastest[100] / fastest[1] - 100) < 0.1

circle = generate_circular()
dt = circle.t[1] - circle.t[0]
attitude = Rotation.from_quat(np.roll(circle.orientation_quat, -1, axis=1))
body = (attitude[:-1].inv() * attitude[1:]).as_rotvec() / dt
world = (attitude[1:] * attitude[:-1].inv()).as_rotvec() / dt
given = circle.angular_velocity[1:]
off_body, off_world = np.abs(given - body)[1:].max(axis=0), np.abs(given - world)[1:].max(axis=0)
print('circle: rates given differ from those of its attitudes by up to', np.round(off_body, 3), 'in the body frame,', np.round(off_world, 3), 'in the world\'s, rad/s')
assert off_body[:2].min() > 0.2 and off_world.max() < 0.01

test = generate_hover_accel_cruise()
dt = test.t[1] - test.t[0]
jump = np.abs(np.diff(test.position, axis=0) - dt * test.velocity[1:]).max(axis=0)
print('canonical trajectory: largest step of position that its velocity does not explain', np.round(jump, 3), 'm')
assert abs(jump[2] - 0.198) < 0.01
EOF
