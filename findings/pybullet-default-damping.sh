#!/usr/bin/env bash
# Guess: a body in free flight keeps its velocity and its turning until a damping is set; a damping that is there shows in
# getDynamicsInfo, and is a share of the velocity.
# Observed: without gravity, a fresh body loses 0.04 (1 + |v|) of its velocity a second: 0.06 1/s at 0.5 m/s, 0.20 1/s at 4 m/s. Turning is
# damped alike, 0.16 1/s at 3 rad/s. getDynamicsInfo has no entry for either, and prints the same before and after changeDynamics
# sets both to 0, which ends it.
# Why it matters: a quadrotor in this engine flies through a drag that no file of its model names: at hover as much as a tenth of the
# 0.35 1/s of a real Crazyflie, at 4 m/s more than half. A drag that is identified or tuned there holds the engine's too, and two
# simulators with one craft disagree. Set linearDamping and angularDamping to 0 where a model brings its own air.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --only-binary :all: pybullet==3.2.7 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import pybullet as p

STEP_S = 1e-3
print('pybullet', version('pybullet'))
p.connect(p.DIRECT)
p.setTimeStep(STEP_S)
p.setGravity(0, 0, 0)
body = p.createMultiBody(0.027, p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.05, 0.05, 0.01]))


def lost(linear, angular):
    """Share of the velocity and of the rate that one step takes, per second."""
    p.resetBasePositionAndOrientation(body, [0, 0, 1], [0, 0, 0, 1])
    p.resetBaseVelocity(body, [linear, 0, 0], [0, 0, angular])
    p.stepSimulation()
    (velocity, *_), (*_, rate) = p.getBaseVelocity(body)
    return (1 - velocity / linear) / STEP_S, (1 - rate / angular) / STEP_S


before = p.getDynamicsInfo(body, -1)
for speed, turning in ((0.5, 1.0), (1.0, 3.0), (2.0, 6.0), (4.0, 12.0)):
    of_speed, of_turning = lost(speed, turning)
    print(f'{speed} m/s loses {of_speed:.3f} 1/s, {turning} rad/s loses {of_turning:.3f} 1/s')
    assert abs(of_speed - 0.04 * (1 + speed)) < 1e-5 and abs(of_turning - 0.04 * (1 + turning)) < 1e-5
p.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
print('with both set to 0:', lost(4.0, 12.0))
assert lost(4.0, 12.0) == (0, 0) and p.getDynamicsInfo(body, -1) == before
EOF
