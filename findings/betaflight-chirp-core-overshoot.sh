#!/usr/bin/env bash
# Guess: the step response that an analysis of Betaflight logs finds is that of the craft. A rate that follows the
# stick as a lag of first order of 20 ms rises in 44 ms, from 10 to 90 %, never overshoots, and is the same at any
# logging rate.
# Observed: logged without noise at 1, 2 and 4 kHz it rises in 23, 13 and 6 ms and overshoots by 8, 21 and 48 %. The
# diagnosis at 4 kHz is a too fast rise and a high overshoot, "lower P or raise D". The window of 64 to 256 ms is
# shorter than what it should show, and is scaled to 1 at its own end.
# Why it matters: a slow craft is tuned slower still. The coherence beside it stays at 0.8 and more, as of a good log.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps betaflight-chirp-core==0.4.1 numpy==2.4.6 scipy==1.17.1 pandas==2.3.3 python-dateutil==2.9.0.post0 six==1.17.0 pytz==2025.2 tzdata==2025.2
cd "$dir"
venv/bin/python - <<'EOF'
from importlib.metadata import version
import numpy as np
import pandas as pd
from scipy.signal import lfilter
from betaflight_chirp_core.analysis import step

print('betaflight-chirp-core', version('betaflight-chirp-core'))
lag, found = 0.02, {}
for rate in (1000, 2000, 4000):
    keep = np.exp(-1 / (rate * lag))

    def follow(stick):
        return lfilter([1 - keep], [1, -keep], stick)

    true = follow(np.ones(rate))
    rise = 1e3 * (np.argmax(true >= 0.9) - np.argmax(true >= 0.1)) / rate
    stick = np.repeat(np.random.default_rng(2).uniform(-300, 300, 200), int(0.3 * rate))
    log = pd.DataFrame({'setpoint[0]': stick, 'gyroADC[0]': follow(stick)})
    found[rate] = step.analyse(log, rate)['roll']
    r = found[rate]
    print(f'{rate} Hz: true rise {rise:.0f} ms, overshoot {100 * max(0, true.max() - 1):.0f} %; found {r["rise_time_ms"]:.0f} ms, {r["overshoot_pct"]:.0f} %, coherence {r["mean_coherence"]:.2f}')
    assert abs(rise - 44) < 1.5 and true.max() <= 1
print('said at 4 kHz:', found[4000]['diagnosis'])
rises, overshoots = ([found[rate][key] for rate in found] for key in ('rise_time_ms', 'overshoot_pct'))
assert rises[0] < 30 and rises[1] < 16 and rises[2] < 8
assert overshoots[0] > 5 and overshoots[1] > 15 and overshoots[2] > 40
assert any('lower P' in said for said in found[4000]['diagnosis'])
EOF
