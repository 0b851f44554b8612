#!/usr/bin/env python3
"""record.py against the stand-in: needs cflib (0.1.34), no radio.

    python3 crazyflie/tools/test_record.py [LOG.csv [OUT.csv]]

With a log in the columns of `cflib` (`quatrack fly --scenario S --log LOG.csv`) the stand-in plays that flight back, so that OUT.csv is
the same flight as it would have come over the radio.
"""

import csv
import io
import math
import sys

import record
import stand_in

VARIABLES = record.NAMES[1:]
FASTER = 20.0
FIRST_MS = 5000


def made_up(count=600):
    """A flight of its own where there is no log: every variable a wave."""
    rows = []
    for k in range(count):
        row = {name: math.sin(0.01 * k * (1 + j)) for j, name in enumerate(VARIABLES)}
        row.update({f"motor.m{m}": 40000 + 100 * m + k for m in (1, 2, 3, 4)})
        rows.append(row)
    return rows


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [{name: float(row[name] or 3.9) for name in VARIABLES} for row in csv.DictReader(file)]


class Flight(stand_in.Craft):
    """A flight, a row every 10 ms from when both blocks run."""

    def __init__(self, rows):
        super().__init__()
        self.rows, self.at, self.period_s = rows, -1, 0.01 / FASTER
        for name in VARIABLES:
            # Two bytes for the motors; the firmware stores the rest as floats.
            kind = 2 if name.startswith("motor.") else 7
            self.logs[name] = stand_in.Variable(kind, lambda name=name: self.rows[self.at][name])

    def tick(self, running):
        if (self.at < 0 and running < len(record.BLOCKS)) or self.at + 1 >= len(self.rows):
            return None
        self.at += 1
        return FIRST_MS + 10 * self.at


def main():
    rows = read(sys.argv[1]) if len(sys.argv) > 1 else made_up()
    stand_in.link_to(Flight(rows))
    text = io.StringIO(newline="")
    recorder = record.record(stand_in.URI, text, 2.0 + len(rows) * 0.02 / FASTER + len(rows) * 0.001)
    if len(sys.argv) > 2:
        with open(sys.argv[2], "w", newline="", encoding="utf-8") as file:
            file.write(text.getvalue())
    recorded = list(csv.DictReader(io.StringIO(text.getvalue())))
    assert not recorder.failed.is_set(), recorder.reason
    for block, variables in record.BLOCKS.items():
        count = recorder.counts[block]
        assert count > 0.98 * len(rows), f"{block}: {count} of {len(rows)} rows"
        own = [row for row in recorded if row[variables[0][0]]]
        for row in own:
            sent = rows[(int(row["timestamp"]) - FIRST_MS) // 10]
            for name, kind in variables:
                # Half precision has 11 bits, single 24.
                slack = {"uint16_t": 0.5, "FP16": 2**-11 * abs(sent[name]) + 1e-7, "float": 1e-6 * abs(sent[name]) + 1e-6}[kind]
                assert abs(float(row[name]) - sent[name]) <= slack, (name, row[name], sent[name])
    print(f"record.py has every packet that was sent: {recorder.counts}")


if __name__ == "__main__":
    main()
