#!/usr/bin/env bash
# Guess: a table that is asked beyond its last point holds its end, goes on as it was going, or complains, and does so
# alike for both kinds of interpolation that one function offers.
# Observed: casadi.interpolant of a thrust curve with linear goes on in a straight line, on both sides and without
# bound: 14 one step beyond its last point of 9. With bspline it is 0 on both sides, with a jump at the last point,
# from 9 to nothing. No word by either.
# Why it matters: a motor's thrust over its command, or a rotor's coefficient over its advance ratio, is such a table.
# A solver steps over the end during its search; with one kind the motor gains thrust that it has not got, with the
# other it loses all, and the derivative is 0, so that nothing leads back.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps casadi==3.8.2 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import casadi as ca

print('casadi', version('casadi'))
commands, thrusts = [0.0, 1, 2, 3], [0.0, 1, 4, 9]
tables = {kind: ca.interpolant('thrust', kind, [commands], thrusts) for kind in ('linear', 'bspline')}
asked = (-0.5, 0, 2.999, 3, 3.001, 4)
values = {kind: [round(float(table(x)), 3) for x in asked] for kind, table in tables.items()}
print('asked at', asked)
for kind, got in values.items():
    print(kind, got)
assert values['linear'][0] == -0.5 and values['linear'][5] == 14
assert values['bspline'][0] == 0 and abs(values['bspline'][2] - 9) < 0.01 and values['bspline'][4] == values['bspline'][5] == 0
x = ca.SX.sym('x')
slope = float(tables['bspline'].jacobian()(4, 0))
print('slope of the bspline at 4:', slope)
assert slope == 0
EOF
