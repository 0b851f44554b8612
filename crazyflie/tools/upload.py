#!/usr/bin/env python3
"""Sends gain tables, crafts and trajectories to a Crazyflie that flies quatrack, stores parameters, and names the law in the air. Needs
cflib (0.1.34).

    upload.py status
    upload.py table my-craft.bin                  # from `quatrack gains design`
    upload.py craft my-craft.bin                  # a craft with its table, from `quatrack gains craft --out my-craft.bin`
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
OWN, SENT = 0, 5
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
REMAKE = ": make the file again with `quatrack gains craft`"
REMEDIES = {
    11: ": design one of the cascade, `quatrack gains design` with method = \"cascade\"",
    13: REMAKE,
    14: REMAKE,
    15: ": widen region.motor_lag_ms of the design, or mend motors.lag_s of the vehicle",
    16: ": build the firmware with -DARM_LENGTH, or mend motors.arm_m of the vehicle",
    17: ": build the firmware with -DTHRUST_MAX, or mend motors.thrust_max_n of the vehicle",
    18: ": build the firmware with -DTHRUST2TORQUE, or mend motors.torque_per_thrust_m of the vehicle",
}
# How each file begins, and the command that writes it.
FILES = {"table": (b"QTGT", "binary gain table"), "craft": (b"QTCR", "craft of `quatrack gains craft --out NAME.bin`")}
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
    _send(cf, table)
    return _fly(cf, SENT, "sent, but not flown")


def send_craft(cf, craft):
    """Sends the bytes of a craft with its table, motors off; from then on it is this craft, until it is switched off."""
    _send(cf, craft)
    return _fly(cf, OWN, "sent, and flown for the lag of its table's design")


def _send(cf, table):
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


def _fly(cf, table, otherwise):
    """Asks for a table, and waits until it is the one that is flown."""
    before = look(cf)["quatrackN.refused"]
    cf.param.set_value("quatrack.table", table)
    for _ in range(10):
        values = look(cf)
        if values["quatrackN.refused"] != before:
            raise Refused(f"{otherwise}: {REFUSALS[values['quatrackN.refusal']]}")
        if values["quatrack.table"] == table:
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


def sent_file(command, path):
    """The bytes of a binary table or of a craft, or which file is meant."""
    magic, meant = FILES[command]
    data = Path(path).read_bytes()
    if data[:4] == magic:
        return data
    beside, hint = Path(path).with_suffix(".bin"), ""
    for other, (begins, _) in FILES.items():
        if data[:4] == begins:
            hint = f"; send it with `upload.py {other}`"
        elif other == command and beside != Path(path) and beside.exists() and beside.read_bytes()[:4] == magic:
            hint = f"; {beside} beside it is one"
    raise Refused(f"{path} is no {meant}{hint}")


def run(cf, arguments):
    if arguments.command == "status":
        values = look(cf)
        print(flown(values))
        if values["quatrackN.refused"]:
            print(f"refused so far: {values['quatrackN.refused']}; the last: {REFUSALS[values['quatrackN.refusal']]}")
        return
    if look(cf)["quatrack.mode"] == 1:
        raise Refused("it flies, and closing this link would turn its motors off: land first, or send from the script that flies")
    if arguments.command in FILES:
        data = sent_file(arguments.command, arguments.file)
        send = {"table": send_table, "craft": send_craft}[arguments.command]
        print(f"sent, {len(data)} bytes: {flown(send(cf, data))}")
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
    commands.add_parser("craft", help="send a craft with its table and fly it, until it is switched off").add_argument("file")
    trajectory = commands.add_parser("trajectory", help="write a trajectory into the craft's memory")
    trajectory.add_argument("file")
    trajectory.add_argument("--number", type=int, default=1, help="by which it is started (1)")
    trajectory.add_argument("--address", type=int, default=0, help="of the memory's bytes the first (0)")
    commands.add_parser("store", help="keep parameters").add_argument("pairs", nargs="+", type=pair, metavar="NAME=VALUE")
    arguments = parser.parse_args(arguments)
    try:
        if arguments.command in FILES:
            sent_file(arguments.command, arguments.file)
        cflib.crtp.init_drivers()
        with SyncCrazyflie(arguments.uri, cf=Crazyflie(rw_cache=None)) as craft:
            run(craft.cf, arguments)
    except (Refused, OSError) as refused:
        sys.exit(f"upload.py: {refused}")


if __name__ == "__main__":
    main()
