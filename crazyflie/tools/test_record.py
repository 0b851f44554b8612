#!/usr/bin/env python3
"""record.py against a stand-in that speaks the Crazyflie's protocol over cflib's own packets: needs cflib (0.1.34), no radio.

    python3 crazyflie/tools/test_record.py [LOG.csv [OUT.csv]]

The stand-in answers what cflib asks as it connects (protocol version, tables of contents, memories), takes log blocks as the firmware
does, and sends them every 10 ms of its own clock. With a log in the columns of `cflib` (`quatrack fly --scenario S --log LOG.csv`) it
plays that flight back, so that OUT.csv is the same flight as it would have come over the radio.
"""

import csv
import io
import math
import queue
import struct
import sys
import threading
import time

import cflib.crtp
from cflib.crtp.crtpdriver import CRTPDriver
from cflib.crtp.crtpstack import CRTPPacket
from cflib.crtp.exceptions import WrongUriType

import record

MEM, LOGGING, PARAM, PLATFORM, LINK = 4, 5, 2, 13, 15
STORED = {"motor.m1": 2, "motor.m2": 2, "motor.m3": 2, "motor.m4": 2}
SIZES = {1: "B", 2: "H", 3: "I", 4: "b", 5: "h", 6: "i", 7: "f", 8: "e"}
VARIABLES = record.NAMES[1:]
FASTER = 20.0


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


class StandIn(CRTPDriver):
    """A link to a craft that is not there."""

    rows = []

    def __init__(self):
        super().__init__()
        self.outbox = queue.Queue()
        self.blocks = {}
        self.running = {}
        self.closed = threading.Event()

    def connect(self, uri, _statistics, _error):
        if not uri.startswith("standin://"):
            raise WrongUriType(uri)
        self.needs_resending = False
        threading.Thread(target=self.play, daemon=True).start()

    def send_packet(self, pk):
        data = bytes(pk.data)
        if pk.port == LINK and pk.channel == 1:
            self.answer(pk, b"Bitcraze Crazyflie\0")
        elif pk.port == PLATFORM and pk.channel == 1:
            self.answer(pk, bytes([data[0], 10]))
        elif pk.port in (LOGGING, PARAM) and pk.channel == 0:
            self.contents(pk, data)
        elif pk.port == MEM:
            self.answer(pk, bytes([data[0], 0]))
        elif pk.port == LOGGING and pk.channel == 1:
            self.settings(pk, data)

    def contents(self, pk, data):
        names = VARIABLES if pk.port == LOGGING else []
        if data[0] == 3:
            self.answer(pk, struct.pack("<BHI", 3, len(names), 0x51))
        elif data[0] == 2:
            (index,) = struct.unpack("<H", data[1:3])
            group, name = names[index].split(".")
            head = struct.pack("<BHB", 2, index, STORED.get(names[index], 7))
            self.answer(pk, head + group.encode() + b"\0" + name.encode() + b"\0")

    def settings(self, pk, data):
        command = data[0]
        status = 0
        if command in (6, 7):
            # As the firmware: whole settings of three bytes, what is left over is not one.
            settings = [struct.unpack("<BH", data[i : i + 3]) for i in range(2, len(data) - 2, 3)]
            block = self.blocks.setdefault(data[1], []) if command == 7 else self.blocks.setdefault(data[1], [])
            block.extend((kind & 0x0F, VARIABLES[index]) for kind, index in settings)
            if sum(struct.calcsize(SIZES[kind]) for kind, _ in block) > 26:
                status = 7
        elif command == 3:
            self.running[data[1]] = data[2]
        elif command == 4:
            self.running.pop(data[1], None)
        elif command == 5:
            self.blocks.clear()
            self.running.clear()
        self.answer(pk, bytes([command, data[1] if len(data) > 1 else 0, status]))

    def play(self):
        for k, row in enumerate(self.rows):
            while not self.closed.is_set() and len(self.running) < len(record.BLOCKS):
                time.sleep(0.01)
            if self.closed.wait(0.01 / FASTER):
                return
            for block in list(self.running):
                layout = self.blocks[block]
                values = [round(row[name]) if SIZES[kind] in "BHIbhi" else row[name] for kind, name in layout]
                body = struct.pack("<" + "".join(SIZES[kind] for kind, _ in layout), *values)
                stamp = struct.pack("<I", 5000 + 10 * k)[:3]
                packet = CRTPPacket()
                packet.set_header(LOGGING, 2)
                packet.data = bytes([block]) + stamp + body
                self.outbox.put(packet)

    def answer(self, pk, data):
        packet = CRTPPacket()
        packet.set_header(pk.port, pk.channel)
        packet.data = data
        self.outbox.put(packet)

    def receive_packet(self, wait=0):
        try:
            return self.outbox.get(block=wait != 0, timeout=None if wait < 0 else wait)
        except queue.Empty:
            return None

    def get_status(self):
        return "here"

    def get_name(self):
        return "stand-in"

    def scan_interface(self, address=None):
        return []

    def close(self):
        self.closed.set()


def main():
    StandIn.rows = read(sys.argv[1]) if len(sys.argv) > 1 else made_up()
    cflib.crtp.CLASSES.append(StandIn)
    text = io.StringIO(newline="")
    recorder = record.record("standin://", text, 2.0 + len(StandIn.rows) * 0.02 / FASTER + len(StandIn.rows) * 0.001)
    if len(sys.argv) > 2:
        with open(sys.argv[2], "w", newline="", encoding="utf-8") as file:
            file.write(text.getvalue())
    rows = list(csv.DictReader(io.StringIO(text.getvalue())))
    assert not recorder.failed.is_set(), recorder.reason
    for block, variables in record.BLOCKS.items():
        count = recorder.counts[block]
        assert count > 0.98 * len(StandIn.rows), f"{block}: {count} of {len(StandIn.rows)} rows"
        own = [row for row in rows if row[variables[0][0]]]
        for row in own:
            sent = StandIn.rows[(int(row["timestamp"]) - 5000) // 10]
            for name, kind in variables:
                # Half precision has 11 bits, single 24.
                slack = {"uint16_t": 0.5, "FP16": 2**-11 * abs(sent[name]) + 1e-7, "float": 1e-6 * abs(sent[name]) + 1e-6}[kind]
                assert abs(float(row[name]) - sent[name]) <= slack, (name, row[name], sent[name])
    print(f"record.py has what was sent: {recorder.counts}")


if __name__ == "__main__":
    main()
