#!/usr/bin/env bash
# Guess: a log resampled to 400 Hz has 400 rows per second, each with the values of its time, and topics limited to
# 100 Hz come at most at 100 Hz.
# Observed: the period is rounded to whole milliseconds: 400 Hz and 600 Hz give 500, 150 Hz gives 143, 300 Hz 333. Each
# row has the last value of the period that follows its time: at 50 Hz, values of a log of 1 kHz are 19 ms newer than
# the time beside them. A limit of 100 Hz leaves topics of 120, 140 and 149 Hz as they are, and makes 87 of 260.
# Why it matters: delays and gains identified from such a table are off by up to a period: the answer comes before
# the command, and derivatives over the 1/400 s of the settings are 0.8 of the true ones.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps px4-log-tool==0.6.4 numpy==1.26.1 pandas==2.1.2 python-dateutil==2.9.0.post0 six==1.17.0 pytz==2025.2 tzdata==2025.2
cd "$dir"
venv/bin/python - <<'EOF'
import warnings
from importlib.metadata import version
import numpy as np
import pandas as pd
from px4_log_tool.processing_modules.resampler import adjust_topic_rate, resample_data

print('px4-log-tool', version('px4-log-tool'))
warnings.simplefilter('ignore')
t = np.arange(0, 1_000_000, 1000)
rates, newer = {}, {}
for asked in (50, 100, 150, 300, 400, 600):
    log = pd.DataFrame(dict(timestamp=t, seconds=t * 1e-6, mode=1))
    table = resample_data(log, asked, num_columns=['seconds'], cat_columns=['mode'], cat_method='ffill')
    times = (table['timestamp'] - pd.Timestamp(0)).dt.total_seconds()
    rates[asked], newer[asked] = 1 / times.diff().mean(), (table['seconds'] - times).iloc[10]
    print(f'{asked} Hz asked for: {rates[asked]:.1f} Hz, a row at {times[10]:.3f} s has the value of {table["seconds"][10]:.3f} s')
assert [round(rate) for rate in rates.values()] == [50, 100, 143, 333, 500, 500]
assert abs(newer[50] - 0.019) < 1e-9 and abs(newer[100] - 0.009) < 1e-9

limited = {}
for rate in (120, 140, 149, 260):
    pd.DataFrame(dict(timestamp=(np.arange(5 * rate) / rate * 1e6).astype(int), value=0)).to_csv('topic.csv', index=False)
    adjust_topic_rate('topic.csv', max_frequency=100)
    limited[rate] = 1e6 / pd.read_csv('topic.csv')['timestamp'].diff().mean()
print('limited to 100 Hz:', {rate: round(float(got), 1) for rate, got in limited.items()})
assert all(abs(limited[rate] - rate) < 0.1 for rate in (120, 140, 149)) and abs(limited[260] - 86.7) < 0.1
EOF
