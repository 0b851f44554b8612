#!/usr/bin/env bash
# Guess: a simulated quadcopter turns about r x F: with its rotors' places in metres and their thrusts up, more thrust
# at the two rotors with x > 0 lifts that end, and the craft accelerates to -x. Body rates, as a comment calls them,
# turn the craft about its own axes.
# Observed: the torques about x and y are in each other's place, and the sign of one with it: 2 % more at the rotors
# with x > 0 gives (0.035, 0, 0) N m where r x F is (0, -0.035, 0), and the craft goes to -y. The rates turn it about
# the world's axes: at a heading of 90 degrees a roll rate of 1 rad/s pitches the nose by 11.5 degrees in 0.2 s. The
# lower end of the wind's range is not used: a wind of 4 to 5 m/s starts at 0 and does not reach 4 in a minute.
# Why it matters: a controller learned or tuned on it has a mixer that no craft has, which rolls when it should pitch,
# and a loop about roll and pitch that is right at a heading of 0 only.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps drone-rl-env==0.1.0 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
import sys, types
from importlib.metadata import version
from importlib.util import find_spec
import numpy as np

package = types.ModuleType('drone_env')  # without its __init__, which loads the environment and its window
package.__path__ = find_spec('drone_env').submodule_search_locations
sys.modules['drone_env'] = package
from drone_env.drone import Drone
from drone_env.wind import Wind

print('drone-rl-env', version('drone-rl-env'))
still = dict(k_w=0, k_w2=0, motor_tau=1e-4)
drone = Drone(**still)
drone.reset(initial_orientation=np.zeros(3))
throttle = np.full(4, drone.get_hover_thrust_cmd())
more = np.where(drone.rotor_positions[:, 0] > 0, 1.02, 1.0) * throttle
drone.update(more, 0.01)
got = drone.angular_acceleration * drone.inertia
thrusts = drone.max_thrust_per_motor * drone.motor_thrusts**2
want = sum(np.cross(place, [0, 0, thrust]) for place, thrust in zip(drone.rotor_positions, thrusts))
for _ in range(20):
    drone.update(more, 0.01)
print('more thrust at x > 0: torque', np.round(got, 4), 'r x F', np.round(want, 4), 'velocity after 0.2 s', np.round(drone.velocity, 3))
assert abs(want[1] + 0.035) < 1e-3 and abs(want[0]) < 1e-6
assert abs(got[0] - 0.035) < 1e-3 and abs(got[1]) < 1e-6
assert drone.velocity[1] < -0.02 and abs(drone.velocity[0]) < 1e-6

angles = {}
for heading in (0, 90):
    drone = Drone(**still)
    drone.reset(initial_orientation=np.radians([0, 0, heading]))
    drone.angular_velocity[:] = [1, 0, 0]
    for _ in range(20):
        drone.update(throttle, 0.01)
    angles[heading] = np.degrees(drone.get_euler())
    print(f'1 rad/s of roll for 0.2 s at a heading of {heading}: roll, pitch, yaw', np.round(angles[heading], 2))
assert np.allclose(angles[0], [11.46, 0, 0], atol=0.05) and np.allclose(angles[90], [0, -11.46, 90], atol=0.05)

np.random.seed(1)
wind = Wind(strength_range=(4.0, 5.0), enabled=True)
speeds = []
for _ in range(6000):
    wind.update(0.01)
    speeds.append(float(np.linalg.norm(wind.get_vector())))
print(f'wind of 4 to 5 m/s: starts at {speeds[0]:.2f} m/s, at most {max(speeds):.2f} m/s in a minute')
assert speeds[0] < 0.5 and max(speeds) < 4
EOF
