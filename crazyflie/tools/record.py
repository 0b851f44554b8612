#!/usr/bin/env python3
"""Records a flight of a Crazyflie for `quatrack identify`: two log blocks at 100 Hz as one CSV. Needs cflib (0.1.34).

    record.py --uri radio://0/80/2M/E7E7E7E7E7 --out flight.csv [--duration 70]

Commands, gyroscope and accelerometer share a block of 22 bytes, since they are compared with each other: the firmware samples a block
at one instant. The pose has another, of 26 bytes. A row of the CSV holds one block, under the firmware's names and in its units, with the firmware's time in ms.
It sends nothing but the request that starts the log: fly with your usual program. Ctrl-C ends the recording.
"""

import argparse
import csv
import sys
import threading

import cflib.crtp
from cflib.crazyflie import Crazyflie
from cflib.crazyflie.log import LogConfig
from cflib.crazyflie.syncCrazyflie import SyncCrazyflie

PERIOD_MS = 10
BLOCKS = {
    "drive": [
        *((f"motor.m{k}", "uint16_t") for k in (1, 2, 3, 4)),
        *((f"gyro.{axis}", "FP16") for axis in "xyz"),
        *((f"acc.{axis}", "FP16") for axis in "xyz"),
        ("pm.vbat", "FP16"),
    ],
    "pose": [
        *((f"stateEstimate.{axis}", "float") for axis in "xyz"),
        *((f"stateEstimate.v{axis}", "FP16") for axis in "xyz"),
        *((f"stateEstimate.q{part}", "FP16") for part in "xyzw"),
    ],
}
NAMES = ["timestamp", *(name for block in BLOCKS.values() for name, _ in block)]


class Recorder:
    """Rows of all blocks, in the order of their arrival."""

    def __init__(self, file):
        self.writer = csv.DictWriter(file, NAMES, restval="", extrasaction="ignore")
        self.writer.writeheader()
        self.lock = threading.Lock()
        self.counts = dict.fromkeys(BLOCKS, 0)
        self.failed = threading.Event()
        self.reason = ""

    def row(self, timestamp, data, block):
        with self.lock:
            self.counts[block.name] += 1
            self.writer.writerow({"timestamp": timestamp, **{name: f"{value:.7g}" for name, value in data.items()}})

    def error(self, block, message):
        self.reason = f"{block.name}: {message}"
        self.failed.set()


def record(uri, file, duration):
    """Records from a craft until the duration is over, or for ever."""
    recorder = Recorder(file)
    with SyncCrazyflie(uri, cf=Crazyflie(rw_cache=None)) as craft:
        craft.cf.connection_lost.add_callback(lambda _, reason: recorder.error(LogConfig("link", PERIOD_MS), reason))
        blocks = []
        for name, variables in BLOCKS.items():
            block = LogConfig(name=name, period_in_ms=PERIOD_MS)
            for variable, kind in variables:
                block.add_variable(variable, kind)
            craft.cf.log.add_config(block)
            block.data_received_cb.add_callback(recorder.row)
            block.error_cb.add_callback(recorder.error)
            blocks.append(block)
        for block in blocks:
            block.start()
        try:
            recorder.failed.wait(duration)
        except KeyboardInterrupt:
            pass
        finally:
            for block in blocks:
                block.stop()
    return recorder


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--uri", default="radio://0/80/2M/E7E7E7E7E7")
    parser.add_argument("--out", required=True, help="the CSV to write")
    parser.add_argument("--duration", type=float, help="s; without it until Ctrl-C")
    arguments = parser.parse_args()
    cflib.crtp.init_drivers()
    with open(arguments.out, "w", newline="", encoding="utf-8") as file:
        recorder = record(arguments.uri, file, arguments.duration)
    print(", ".join(f"{name}: {count} rows" for name, count in recorder.counts.items()))
    if recorder.failed.is_set():
        sys.exit(f"the log ended early: {recorder.reason}")
    if not all(recorder.counts.values()):
        sys.exit("a block brought nothing: does the firmware have all of its variables?")


if __name__ == "__main__":
    main()
