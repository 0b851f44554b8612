#!/usr/bin/env bash
# Guess: of a flight log whose writer was cut off before it could close the file, a reader gives the part that is there.
# Observed: mcap's NonSeekingReader gives nothing: it sorts by time first, runs into the end and raises before its
# first message. With log_time_order=False the same reader gives 986 of 1000 messages and raises then. The default
# reader for files, make_reader, raises at once, since it looks for the index that was never written.
# Why it matters: the log of a crash is the one that is not closed. It looks lost, and it is not.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps mcap==1.6.0 lz4==4.4.5 zstandard==0.25.0
cd "$dir"
venv/bin/python - <<'EOF'
import io
from importlib.metadata import version
from mcap.reader import NonSeekingReader, make_reader
from mcap.writer import Writer

print('mcap', version('mcap'))
file = io.BytesIO()
writer = Writer(file, chunk_size=1000)
writer.start()
schema = writer.register_schema('pose', 'jsonschema', b'{}')
channel = writer.register_channel('/pose', 'json', schema)
for step in range(1000):
    writer.add_message(channel, step * 10_000_000, b'{"z": 1}', step * 10_000_000)
log = file.getvalue()  # never finished, as when the power goes


def read(reader, **how):
    count = 0
    try:
        for _ in reader.iter_messages(**how):
            count += 1
    except Exception as error:
        return count, type(error).__name__
    return count, None


results = {
    'make_reader': read(make_reader(io.BytesIO(log))),
    'NonSeekingReader': read(NonSeekingReader(io.BytesIO(log))),
    'NonSeekingReader, log_time_order=False': read(NonSeekingReader(io.BytesIO(log)), log_time_order=False),
}
for name, (count, error) in results.items():
    print(f'{name}: {count} of 1000 messages, then {error}')
assert results['make_reader'][0] == 0 and results['make_reader'][1]
assert results['NonSeekingReader'][0] == 0 and results['NonSeekingReader'][1]
assert results['NonSeekingReader, log_time_order=False'][0] > 950
EOF
