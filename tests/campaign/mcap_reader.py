"""A flight's MCAP file as the official reader has it: topics, schemas and times, and its numbers beside those of the flight's CSV.

    python tests/campaign/mcap_reader.py FLIGHT.mcap FLIGHT.csv
"""

import csv
import json
import sys
from importlib.metadata import version

from mcap.reader import make_reader

SCHEMAS = {
    "/scene": "foxglove.SceneUpdate",
    "/tf": "foxglove.FrameTransform",
    "/pose": "foxglove.PoseInFrame",
    "/reference": "foxglove.PoseInFrame",
    "/flight": "quatrack.FlightSample",
}
# The CSV has nine digits behind the point, and times to the millisecond.
DIGITS = 1e-9

with open(sys.argv[2], newline="") as file:
    rows = list(csv.DictReader(file))
messages = {topic: [] for topic in SCHEMAS}
with open(sys.argv[1], "rb") as file:
    # It checks every checksum.
    reader = make_reader(file, validate_crcs=True)
    statistics = reader.get_summary().statistics
    for schema, channel, message in reader.iter_messages():
        assert (schema.name, schema.encoding) == (SCHEMAS[channel.topic], "jsonschema"), schema.name
        assert channel.message_encoding == "json", channel.topic
        value = json.loads(message.data)
        assert set(value) == set(json.loads(schema.data)["properties"]), (channel.topic, sorted(value))
        messages[channel.topic].append((message.log_time, value))

counts = {topic: len(found) for topic, found in messages.items()}
scenes = -(-len(rows) // 10)
assert counts == {topic: scenes if topic == "/scene" else len(rows) for topic in SCHEMAS}, counts
assert statistics.message_count == sum(counts.values())


def near(read, written):
    assert abs(read - float(written)) <= DIGITS, (read, written)


for row, (time_ns, flight), (_, turn), (_, goal) in zip(rows, messages["/flight"], messages["/tf"], messages["/reference"]):
    assert round(time_ns / 1e6) == round(1e3 * float(row["t_s"])), (time_ns, row["t_s"])
    for axis in "xyz":
        near(flight["position_m"][axis], row[f"{axis}_m"])
        near(flight["velocity_m_s"][axis], row[f"v_{axis}_m_s"])
        near(goal["pose"]["position"][axis], row[f"ref_{axis}_m"])
    for axis in "wxyz":
        near(turn["rotation"][axis], row[f"q_{axis}"])
    for motor in range(4):
        near(flight["commands_n"][motor], row[f"command_{motor + 1}_n"])
        near(flight["thrusts_n"][motor], row[f"thrust_{motor + 1}_n"])
print(f"mcap {version('mcap')}: {statistics.message_count} messages of {len(counts)} topics, each number as in the CSV of {len(rows)} rows")
