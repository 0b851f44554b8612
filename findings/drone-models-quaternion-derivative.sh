#!/usr/bin/env bash
# Guess: the derivative of the quaternion that a model returns beside its other derivatives is that of its quaternion, x y
# z w, at its body rates: integrated, it turns the craft as the body rates do.
# Observed: it is the derivative of a quaternion whose scalar part comes first, of the same four numbers, in NumPy and
# in CasADi. At the identity a roll rate of 1 rad/s gives (0, 0, 0.5, 0) instead of (0.5, 0, 0, 0): it turns about z. A pitch rate
# gives a turn back about y. The docstring warns of the length of such a quaternion, not of its direction.
# Why it matters: the CasADi model is there for optimal control, which integrates exactly that: its craft does not turn where it
# is rotated. A loop that integrates it in NumPy falls within a second under any controller.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile drone-models==0.1.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import inspect
from importlib.metadata import version
from drone_models import parametrize
from drone_models.core import load_params
from drone_models.first_principles import dynamics, symbolic_dynamics
import casadi as cs
import numpy as np
from scipy.spatial.transform import Rotation

print('drone-models', version('drone-models'))
model = parametrize(dynamics, 'cf21B_500')
figures = load_params('first_principles', 'cf21B_500')
known = {key: figures[key] for key in inspect.signature(symbolic_dynamics).parameters if key in figures}
slope, x, u, _ = symbolic_dynamics(model_rotor_vel=True, **known)
symbolic = cs.Function('slope', [x, u], [slope])
still, speeds, h = np.zeros(3), np.full(4, 15000.0), 1e-6
for name, rate in (('roll', [1.0, 0, 0]), ('pitch', [0, 1.0, 0]), ('yaw', [0, 0, 1.0])):
    quat, rate = np.array([0.0, 0, 0, 1]), np.array(rate)
    turned = [(Rotation.from_quat(quat) * Rotation.from_rotvec(sign * h * rate)).as_quat() for sign in (1, -1)]
    true = (turned[0] - turned[1]) / (2 * h)
    given = model(still, quat, still, rate, speeds, rotor_vel=speeds)[1]
    casadi = np.array(symbolic(np.concatenate([still, quat, still, rate, speeds]), speeds)).ravel()[3:7]
    print(f'{name} rate of 1 rad/s: true {np.round(true, 3)}, NumPy {np.round(given, 3)}, CasADi {np.round(casadi, 3)}')
    assert np.abs(given - casadi).max() < 1e-12 and np.abs(given - true).max() > 0.4
EOF
