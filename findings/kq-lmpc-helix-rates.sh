#!/usr/bin/env bash
# Guess: references made from a flat course have the body rates that go with their attitudes.
# Observed: those of the lemniscate have. Those of both helices have rates of 0, while their attitudes turn with 0.22
# and 0.09 rad/s: two samples of the course are taken at the same time instead of a step apart, and the reference is
# also a step late.
# Why it matters: a tracking controller damps the very motion that it should follow, and the error that it keeps is
# tuned away with gains that other courses do not bear.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps kq-lmpc-quadrotor==1.1.2 pyquaternion==0.9.9 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'EOF'
import sys, types
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
import numpy as np

for name in ('casadi', 'matplotlib', 'matplotlib.pyplot'):  # its solver's and plots' home
    sys.modules[name] = types.ModuleType(name)
home = find_spec('kq_lmpc_quadrotor').submodule_search_locations[0]
for name, path in (('kq_lmpc_quadrotor', home), ('kq_lmpc_quadrotor.Utils', home + '/Utils')):  # without demonstrations
    sys.modules[name] = types.ModuleType(name)
    sys.modules[name].__path__ = [path]
references = import_module('kq_lmpc_quadrotor.Utils.Reference_Generator_DFB')

print('kq-lmpc-quadrotor', version('kq-lmpc-quadrotor'))
told, turning = {}, {}
for task, course in ((3, 'lemniscate'), (4, 'helix along x'), (5, 'helix along z')):
    made = references.Gen_ref_dfb(task_id=task)
    attitude = [made.gen_ref(t)[0][6:15].reshape(3, 3, order='F') for t in (1.99, 2.0, 2.01)]
    spin = attitude[1].T @ (attitude[2] - attitude[0]) / 0.02
    x, _ = made.gen_ref(2.0)
    told[course], turning[course] = x[15:18, 0], np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    print(f'{course}: rates', np.round(told[course], 3) + 0, 'attitudes turn with', np.round(turning[course], 3) + 0)
    if task != 3:
        assert np.all(told[course] == 0)
assert np.allclose(told['lemniscate'], turning['lemniscate'], atol=0.02)
assert abs(np.linalg.norm(turning['helix along z']) - 0.22) < 0.01 and abs(np.linalg.norm(turning['helix along x']) - 0.09) < 0.01
ahead = {task: references.Gen_ref_dfb(task_id=task) for task in (3, 5)}
steps = {3: ahead[3].lemniscate_flat_vars, 5: ahead[5].helics_flat_vars_5}
for task, at in ((3, 2.01), (5, 2.0)):
    assert np.allclose(ahead[task].gen_ref(2.0)[0][:3], steps[task](at)[1][:3])
print('reference at 2 s: the lemniscate of 2.01 s, the helix of 2.00 s')
EOF
