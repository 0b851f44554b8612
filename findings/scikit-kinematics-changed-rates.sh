#!/usr/bin/env bash
# Guess: a recording is evaluated with one filter, with another, and with the first again, which gives the first
# result. Units of acceleration and field do not matter to a filter, as its documentation says. A filter's result is
# relative to gravity and north, as documented, and its noise parameters count.
# Observed: Mahony writes its corrections into the recorded rates, the caller's own array too: the same integration
# before and after differs by 8.9 degrees. Its Update takes the units for gains: a sensor at rest is found to 2 degrees
# with unit vectors, and with m/s^2 and microtesla it spins with thousands of rad/s. The result of kalman() starts
# at no rotation: a craft that stands rolled by 30 degrees reads as level. Its parameter D is not used.
# Why it matters: a comparison of filters depends on their order, and a bias that the gyro has is gone from the data
# that a later fit is made on.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps scikit-kinematics==0.10.4 numpy==2.4.6 scipy==1.17.1 sympy==1.14.0 mpmath==1.4.1 pandas==2.3.3 python-dateutil==2.9.0.post0 six==1.17.0 pytz==2025.2 tzdata==2025.2
cd "$dir"
venv/bin/python - <<'EOF'
import contextlib, io, sys, types
from importlib.metadata import version
import numpy as np
from scipy.spatial.transform import Rotation

for name in ('matplotlib', 'matplotlib.pyplot', 'tkinter', 'tkinter.filedialog'):  # its plots' and file dialogues' home
    sys.modules[name] = types.ModuleType(name)
from skinematics import imus
from skinematics.sensors.manual import MyOwnSensor

print('scikit-kinematics', version('scikit-kinematics'))
rate, n = 100.0, 1000
t = np.arange(n) / rate
craft = Rotation.from_euler('z', 0.5 * np.sin(t)[:, None])
rates = np.column_stack([0 * t, 0 * t, 0.5 * np.cos(t) + 0.05])  # with a bias
mine = dict(rate=rate, acc=craft.inv().apply([0, 0, 9.81]), omega=rates.copy(), mag=craft.inv().apply([0.5, 0, -0.866]))
sensor = MyOwnSensor(in_file='own', in_data=mine)
first = sensor.quat.copy()
with contextlib.redirect_stdout(io.StringIO()):
    sensor.set_qtype('mahony')
sensor.set_qtype('analytical')
turn = Rotation.from_quat(np.roll(first, -1, axis=1)).inv() * Rotation.from_quat(np.roll(sensor.quat, -1, axis=1))
apart, changed = np.degrees(turn.magnitude().max()), np.abs(mine['omega'] - rates).max()
print(f'integration before and after Mahony: {apart:.1f} degrees apart; the own rates changed by up to {changed:.3f} rad/s')
assert apart > 5 and changed > 0.01

attitude = Rotation.from_euler('xyz', [30, 0, 40], degrees=True)
up, field = attitude.inv().apply([0, 0, 1.0]), attitude.inv().apply([0.5, 0, -0.866])
assert "so units don't matter" in ' '.join(imus.Mahony.Update.__doc__.split())
errors, fastest = [], []
for acceleration, magnet in ((1, 1), (9.81, 50)):
    f = imus.Mahony(rate=rate, Kp=1.0, Quaternion=np.array([1.0, 0, 0, 0]))
    for _ in range(2000):
        gyro = np.zeros(3)
        f.Update(gyro, acceleration * up, magnet * field)
    q = np.ravel(f.Quaternion)
    errors.append(np.degrees((Rotation.from_quat([*q[1:], q[0]]).inv() * attitude).magnitude()))
    fastest.append(np.abs(gyro).max())
print(f'at rest for 20 s: {errors[0]:.0f} degrees off with unit vectors, with m/s^2 and microtesla {errors[1]:.0f}, at {fastest[1]:.0f} rad/s')
assert errors[0] < 3 and fastest[0] < 0.1 and fastest[1] > 500

still = (np.tile(9.81 * up, (500, 1)), np.zeros((500, 3)), np.tile(field, (500, 1)))
q = imus.kalman(rate, *still)
print('kalman of a craft at rest, rolled by 30 degrees: first', np.round(q[0], 6) + 0, 'last', np.round(q[-1], 6) + 0)
assert np.allclose(q[[0, -1]], [1, 0, 0, 0], atol=1e-9) and 'gravity' in imus.kalman.__doc__
noisy = (still[0], 0.3 * np.random.default_rng(0).standard_normal((500, 3)), still[2])
a, b, c = (imus.kalman(rate, *noisy, **more) for more in ({}, dict(D=[400.0] * 3), dict(tau=[5.0] * 3)))
print(f'a thousand times the noise D changes the result by {np.abs(a - b).max():.3f}, ten times tau by {np.abs(a - c).max():.3f}')
assert np.abs(a - b).max() == 0 and np.abs(a - c).max() > 1e-3
EOF
