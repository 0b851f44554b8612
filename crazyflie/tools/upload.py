#!/usr/bin/env python3
"""Sends gain tables and trajectories to a Crazyflie that flies quatrack, stores parameters, and names the law in the air. Needs cflib (0.1.34).

    upload.py status
    upload.py table my-craft.bin                  # from `quatrack gains design`
    upload.py trajectory w.csv                    # from `quatrack refit --csv`, or the form of `--compressed`
    upload.py store motorLag=0.058 drag=0.31      # parameters of the group quatrack, kept when it is switched off

Each takes --uri, and answers in words; the exit code is 1 where something was refused. cflib turns the motors off as it closes a link, so
that nothing is sent to a craft in flight: there call `send_table` and `send_trajectory` from the script that flies.

With cflib2 (0.1.0) the calls are, after `cf = await Crazyflie.connect_from_uri(context, uri)`:

    appchannel.send_packet, packet_received     channel = await cf.platform().get_app_channel(); channel.send(bytes); await channel.receive()
    param.set_value, persistent_store           await cf.param().set(name, value); await cf.param().persistent_store(name)
    SyncLogger(cf, LogConfig)                   block = await cf.log().create_block(); await block.add_variable(name)
                                                stream = await block.start(period_ms); (await stream.next()).data
    TrajectoryMemory.write_data_sync            await cf.memory().write_trajectory([Poly4D(duration, x, y, z, yaw), ...], address)
    high_level_commander.define_trajectory      await cf.high_level_commander().define_trajectory(number, address, pieces, None)
"""

import argparse
import csv
import queue
import struct
import sys
import threading
import time
from pathlib import Path

import cflib.crtp
from cflib.crazyflie import Crazyflie
from cflib.crazyflie.log import LogConfig
from cflib.crazyflie.mem import MemoryElement, Poly4D
from cflib.crazyflie.syncCrazyflie import SyncCrazyflie
from cflib.crazyflie.syncLogger import SyncLogger

MODES = {
    0: "motors off, as asked",
    1: "flying as asked",
    2: "to rest and slowly down: the setpoint makes no sense",
    3: "motors off: the estimate or the gyroscope is not to be flown on",
    4: "motors off: there is no table for the craft that the firmware was built for",
}
TABLES = {0: "the cascade", 1: "LYAP-E", 2: "LQR-E", 3: "LYAP-F", 4: "LQR-F", 5: "the table that was sent"}
SENT = 5
REFUSALS = {
    0: "nothing has been refused",
    1: "there is no table of that number: 0 to 5",
    2: "no table has been sent since the craft was switched on, or the last upload was refused",
    3: "the motors' lag is outside the table's certificate: set quatrack.motorLag to the measured one, or design a table for it",
    4: "it is no sound table with a certificate: send the file with the ending .bin that `quatrack gains design` wrote",
    5: "it is for another craft or another control rate: `quatrack gains show FILE` says for which",
    6: "its law is not flown here: design it with method = \"cascade\"",
}
LOGGED = ("quatrack.mode", "quatrack.table", "quatrackN.refused", "quatrackN.refusal")
# By status of the upload, where the words in the packet have no room for it.
REMEDIES = {11: ": design one of the cascade, `quatrack gains design` with method = \"cascade\""}
BEGIN, CHUNK, COMMIT = 1, 2, 3
TAKEN, ALREADY_THERE = 0, 4
CHUNK_BYTES = 27
PIECE_BYTES = 132
# Shorts of an axis by the two bits of its type in the compressed form.
COMPRESSED_SHORTS = (0, 1, 3, 7)


class Refused(Exception):
    """A refusal by the craft or for the file: one sentence."""


def look(cf, names=LOGGED):
    """Values of log variables, as they are now."""
    block = LogConfig("quatrack", period_in_ms=100)
    for name in names:
        if cf.log.toc.get_element_by_complete_name(name) is None:
            raise Refused(f"the firmware has no {name}: was it built with quatrack's app?")
        block.add_variable(name)
    with SyncLogger(cf, block) as logger:
        # The first block may be older than the request: it is dropped.
        next(logger)
        return next(logger)[1]


def flown(values):
    """The mode and the table, in words."""
    table = values["quatrack.table"]
    return f"{MODES[values['quatrack.mode']]}; table {table}, {TABLES[table]}"


def send_table(cf, table):
    """Sends the bytes of a table, whole or not at all, and flies it from then on."""
    answers = queue.Queue()
    cf.appchannel.packet_received.add_callback(answers.put)
    try:
        at = _exchange(cf, answers, struct.pack("<BH", BEGIN, len(table)) + table[-4:])
        while at < len(table):
            chunk = struct.pack("<BH", CHUNK, at) + table[at : at + CHUNK_BYTES]
            # Bytes that are there already: an answer got lost.
            at = _exchange(cf, answers, chunk, (TAKEN, ALREADY_THERE))
        _exchange(cf, answers, bytes([COMMIT]))
    finally:
        cf.appchannel.packet_received.remove_callback(answers.put)
    before = look(cf)["quatrackN.refused"]
    cf.param.set_value("quatrack.table", SENT)
    for _ in range(10):
        values = look(cf)
        if values["quatrackN.refused"] != before:
            raise Refused(f"sent, but not flown: {REFUSALS[values['quatrackN.refusal']]}")
        if values["quatrack.table"] == SENT:
            return values
    raise Refused(f"sent, but not flown yet: {flown(values)}")


def _exchange(cf, answers, packet, taken=(TAKEN,)):
    """Sends a packet until it is answered; where the next bytes belong."""
    for _ in range(5):
        cf.appchannel.send_packet(packet)
        try:
            kind, status, at, words = _parsed(answers.get(timeout=0.5))
        except queue.Empty:
            continue
        if kind != packet[0]:
            continue
        if status in taken:
            return at
        remedy = REMEDIES.get(status, "")
        raise Refused(f"refused: {words or 'the controller does not say why'} (status {status}){remedy}")
    raise Refused("no answer: is quatrack's app in the firmware, and the link good?")


def _parsed(answer):
    kind, status, at = struct.unpack("<BBH", bytes(answer[:4]))
    return kind, status, at, bytes(answer[4:]).decode()


def read_trajectory(path):
    """Bytes as the firmware stores them, how many pieces, their duration in s, and whether they are compressed."""
    raw = Path(path).read_bytes()
    if b"\0" in raw:
        return (raw, *_compressed(raw), True)
    rows = list(csv.reader(raw.decode().splitlines()))
    if not rows or len(rows[0]) != 33:
        raise Refused(f"{path}: rows of 33 numbers are wanted, as `quatrack refit --csv` writes them")
    data, duration_s = bytearray(), 0.0
    for line, row in enumerate(rows[1:], 2):
        try:
            numbers = [float(cell) for cell in row]
            # A polynomial of its own for each axis: cflib's default is one list for all.
            x, y, z, yaw = (Poly4D.Poly(numbers[at : at + 8]) for at in (1, 9, 17, 25))
            data += Poly4D(numbers[0], x, y, z, yaw).pack()
        except (ValueError, IndexError, struct.error) as error:
            raise Refused(f"{path}: line {line}: {error}") from error
        duration_s += numbers[0]
    return bytes(data), len(rows) - 1, duration_s, False


def _compressed(raw):
    at, pieces, duration_s = 8, 0, 0.0
    while at + 3 <= len(raw):
        types, duration_ms = struct.unpack_from("<BH", raw, at)
        at += 3 + 2 * sum(COMPRESSED_SHORTS[(types >> shift) & 3] for shift in (0, 2, 4, 6))
        pieces, duration_s = pieces + 1, duration_s + duration_ms / 1e3
    if at != len(raw) or pieces == 0:
        raise Refused("the file ends within a piece: write it again with `quatrack refit --compressed`")
    return pieces, duration_s


def send_trajectory(cf, data, pieces, compressed=False, number=1, address=0):
    """Writes a trajectory into the craft's memory and defines it, to be started by its number."""
    memories = cf.mem.get_mems(MemoryElement.TYPE_TRAJ)
    if not memories:
        raise Refused("the firmware has no memory for trajectories")
    if address + len(data) > memories[0].size:
        raise Refused(
            f"{address} + {len(data)} bytes are more than the craft's {memories[0].size}: "
            f"`quatrack refit --pieces {(memories[0].size - address) // PIECE_BYTES}` fits it in, or --compressed"
        )
    # The bytes are packed: the memory's own write packs the entries of its list.
    memories[0].trajectory = [_Packed(data)]
    if not memories[0].write_data_sync(address):
        raise Refused("the craft did not take all of it: send it again")
    cf.high_level_commander.define_trajectory(number, address, pieces, int(compressed))


class _Packed:
    def __init__(self, data):
        self.data = data

    def pack(self):
        return self.data


def store(cf, name, value):
    """Sets a parameter and keeps it for when the craft is switched on again."""
    element = cf.param.toc.get_element_by_complete_name(name)
    if element is None:
        raise Refused(f"{name}: the firmware has no such parameter")
    if not element.is_persistent():
        raise Refused(f"{name} cannot be stored: it is set anew at each start")
    cf.param.set_value(name, value)
    answered, kept = threading.Event(), []

    def answer(_, is_kept):
        kept.append(is_kept)
        answered.set()

    cf.param.persistent_store(name, answer)
    if not answered.wait(5.0) or not kept[0]:
        raise Refused(f"{name}: the craft did not store it")


def table_file(path):
    """The bytes of a binary table, or which file is meant."""
    data = Path(path).read_bytes()
    if data[:4] != b"QTGT":
        beside = Path(path).with_suffix(".bin")
        hint = f"; {beside} beside it is one" if beside.exists() and beside != Path(path) else ""
        raise Refused(f"{path} is no binary gain table{hint}")
    return data


def run(cf, arguments):
    if arguments.command == "status":
        values = look(cf)
        print(flown(values))
        if values["quatrackN.refused"]:
            print(f"refused so far: {values['quatrackN.refused']}; the last: {REFUSALS[values['quatrackN.refusal']]}")
        return
    if look(cf)["quatrack.mode"] == 1:
        raise Refused("it flies, and closing this link would turn its motors off: land first, or send from the script that flies")
    if arguments.command == "table":
        data = table_file(arguments.file)
        print(f"sent, {len(data)} bytes: {flown(send_table(cf, data))}")
    elif arguments.command == "trajectory":
        data, pieces, duration_s, compressed = read_trajectory(arguments.file)
        send_trajectory(cf, data, pieces, compressed, arguments.number, arguments.address)
        print(
            f"trajectory {arguments.number}: {pieces} pieces, {duration_s:.2f} s, {len(data)} bytes from {arguments.address} on; "
            f"start it with high_level_commander.start_trajectory({arguments.number}, relative_position=True)"
        )
    else:
        for name, value in arguments.pairs:
            store(cf, name, value)
            print(f"{name} = {value:g}, stored")


def pair(text):
    name, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text}: NAME=VALUE is wanted")
    return (name if "." in name else f"quatrack.{name}"), float(value)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--uri", default="radio://0/80/2M/E7E7E7E7E7")
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("status", help="the law in the air, and why the last table that does not was refused")
    commands.add_parser("table", help="send a gain table and fly it").add_argument("file")
    trajectory = commands.add_parser("trajectory", help="write a trajectory into the craft's memory")
    trajectory.add_argument("file")
    trajectory.add_argument("--number", type=int, default=1, help="by which it is started (1)")
    trajectory.add_argument("--address", type=int, default=0, help="of the memory's bytes the first (0)")
    commands.add_parser("store", help="keep parameters").add_argument("pairs", nargs="+", type=pair, metavar="NAME=VALUE")
    arguments = parser.parse_args(arguments)
    try:
        if arguments.command == "table":
            table_file(arguments.file)
        cflib.crtp.init_drivers()
        with SyncCrazyflie(arguments.uri, cf=Crazyflie(rw_cache=None)) as craft:
            run(craft.cf, arguments)
    except (Refused, OSError) as refused:
        sys.exit(f"upload.py: {refused}")


if __name__ == "__main__":
    main()
