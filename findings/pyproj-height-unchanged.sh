#!/usr/bin/env bash
# Guess: asked for heights above the sea (EGM96 or EGM2008) of heights above the ellipsoid, as GPS gives them, pyproj
# either converts them or says that it has not got the table of the geoid, which its package does not contain.
# Observed: it returns the height as it was, 500 m for 500 m, with no warning, though the two are tens of metres
# apart in most of the world. only_best=True changes nothing. Only the transformer's accuracy of -1 and the word
# ballpark in its description tell; allow_ballpark=False refuses.
# Why it matters: an altitude from GPS is compared with a terrain model, or with a barometer set to the sea level. Off
# by the geoid, a height limit is a limit somewhere else; it is the same everywhere in one log, so that it passes for
# a bias of the sensor.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps pyproj==3.7.2 certifi
cd "$dir"
venv/bin/python - <<'EOF'
import os
import warnings
from importlib.metadata import version

os.environ['PROJ_NETWORK'] = 'OFF'
from pyproj import Transformer
from pyproj.exceptions import ProjError

print('pyproj', version('pyproj'))
warnings.simplefilter('error')
for name, target in (('EGM96', 'EPSG:4326+5773'), ('EGM2008', 'EPSG:4326+3855')):
    for how in ({}, dict(only_best=True)):
        transformer = Transformer.from_crs('EPSG:4979', target, always_xy=True, **how)
        height = transformer.transform(8.5, 47.4, 500.0)[2]
        print(f'{name} {how}: 500 m above the ellipsoid is {height} m, accuracy {transformer.accuracy}, ballpark in its description: {"ballpark" in transformer.description}')
        assert height == 500.0 and transformer.accuracy == -1 and 'ballpark' in transformer.description
    try:
        Transformer.from_crs('EPSG:4979', target, always_xy=True, allow_ballpark=False)
    except ProjError as error:
        print(f'{name}, allow_ballpark=False: {error}')
    else:
        raise SystemExit('it has a table now')
EOF
