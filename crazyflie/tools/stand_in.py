"""A Crazyflie that is not there, for tests of programs that speak to one: cflib's packets in, the firmware's answers out. Needs cflib (0.1.34).

It answers cflib's requests as it connects (protocol version 12, tables of contents, memories), takes parameters, log blocks, memories and
packets of the app channel as the firmware does, and sends log blocks by its own clock. Behind it is a `Craft`.
"""

import itertools
import queue
import struct
import threading

import cflib.crtp
from cflib.crtp.crtpdriver import CRTPDriver
from cflib.crtp.crtpstack import CRTPPacket
from cflib.crtp.exceptions import WrongUriType

PARAM, MEM, LOGGING, COMMANDER_HL, PLATFORM, LINK = 2, 4, 5, 8, 13, 15
PROTOCOL = 12
URI = "standin://"

# Types by the firmware's codes: of parameters, and of log variables.
PARAMETER_TYPES = {0x08: "B", 0x09: "H", 0x0A: "I", 0x00: "b", 0x01: "h", 0x02: "i", 0x06: "f"}
LOG_TYPES = {1: "B", 2: "H", 3: "I", 4: "b", 5: "h", 6: "i", 7: "f", 8: "e"}
EXTENDED, READ_ONLY = 0x10, 0x40
NOT_FOUND, TOO_LARGE = 2, 7


class Variable:
    """A parameter or log variable: its type (a code of the firmware's) and how to get and set it."""

    def __init__(self, kind, get, put=None, persistent=False):
        self.kind, self.get, self.put, self.persistent = kind, get, put, persistent


class Craft:
    """The craft that the stand-in represents; a test makes its own of it."""

    def __init__(self):
        self.parameters = {}
        self.logs = {}
        # By type, as the firmware numbers them; 0x12 is that of trajectories.
        self.memories = {}
        # The orders to the high-level commander, and the names of stored parameters.
        self.commands = []
        self.stored = []
        self.period_s = 0.01

    def app_packet(self, packet):
        """A packet of the app channel; the app's answer, if there is one."""

    def tick(self, running):
        """Ten milliseconds, with so many log blocks running; the time in ms, or nothing while the craft waits."""
        raise NotImplementedError

    def changed(self):
        """A parameter has been set."""


class StandIn(CRTPDriver):
    """The link to it."""

    craft = None

    def __init__(self):
        super().__init__()
        self.outbox = queue.Queue()
        self.blocks, self.running = {}, {}
        self.closed = threading.Event()

    def connect(self, uri, _statistics, _error):
        if not uri.startswith(URI):
            raise WrongUriType(uri)
        self.needs_resending = False
        threading.Thread(target=self.play, daemon=True).start()

    def send_packet(self, pk):
        data = bytes(pk.data)
        take = {
            (LINK, 1): self.link,
            (PLATFORM, 1): self.platform,
            (PLATFORM, 2): self.app,
            (LOGGING, 0): self.contents,
            (LOGGING, 1): self.settings,
            (PARAM, 0): self.contents,
            (PARAM, 1): self.read,
            (PARAM, 2): self.write,
            (PARAM, 3): self.extra,
            (MEM, 0): self.memory_info,
            (MEM, 2): self.memory_write,
            (COMMANDER_HL, 0): self.command,
        }.get((pk.port, pk.channel))
        if take:
            answer = take(data, pk.port)
            if answer is not None:
                self.send(pk.port, pk.channel, answer)

    def send(self, port, channel, data):
        packet = CRTPPacket()
        packet.set_header(port, channel)
        packet.data = data
        self.outbox.put(packet)

    def link(self, _data, _port):
        return b"Bitcraze Crazyflie\0"

    def platform(self, data, _port):
        return struct.pack("<Bi", data[0], PROTOCOL)

    def app(self, data, _port):
        return self.craft.app_packet(data)

    def contents(self, data, port):
        variables = self.craft.logs if port == LOGGING else self.craft.parameters
        if data[0] == 3:
            # A sum of its own each time: nothing is to be kept from one craft to the next.
            return struct.pack("<BHI", 3, len(variables), len(variables))
        (index,) = struct.unpack("<H", data[1:3])
        name, variable = list(variables.items())[index]
        kind = variable.kind
        if port == PARAM:
            kind |= (EXTENDED if variable.persistent else 0) | (0 if variable.put else READ_ONLY)
        return struct.pack("<BHB", 2, index, kind) + name.replace(".", "\0").encode() + b"\0"

    def parameter(self, data):
        (index,) = struct.unpack("<H", data[:2])
        name, variable = list(self.craft.parameters.items())[index]
        return name, variable, PARAMETER_TYPES[variable.kind]

    def read(self, data, _port):
        _, variable, code = self.parameter(data)
        return data[:2] + b"\0" + struct.pack("<" + code, variable.get())

    def write(self, data, _port):
        _, variable, code = self.parameter(data)
        if not variable.put:
            return None
        variable.put(struct.unpack("<" + code, data[2:])[0])
        self.craft.changed()
        return data[:2] + struct.pack("<" + code, variable.get())

    def extra(self, data, _port):
        name, variable, _ = self.parameter(data[1:])
        if data[0] == 7:
            return data[:3] + bytes([0, int(variable.persistent)])
        if data[0] == 3:
            if variable.persistent:
                self.craft.stored.append(name)
            return data[:3] + bytes([0 if variable.persistent else NOT_FOUND])
        return None

    def settings(self, data, _port):
        command, status = data[0], 0
        if command in (6, 7):
            # As the firmware: whole settings of three bytes, a remainder is not one.
            settings = [struct.unpack("<BH", data[i : i + 3]) for i in range(2, len(data) - 2, 3)]
            block = self.blocks.setdefault(data[1], [])
            variables = list(self.craft.logs.values())
            block.extend((LOG_TYPES[kind & 0x0F], variables[index]) for kind, index in settings)
            if sum(struct.calcsize(code) for code, _ in block) > 26:
                status = TOO_LARGE
        elif command == 3:
            self.running[data[1]] = max(data[2], 1)
        elif command == 4:
            self.running.pop(data[1], None)
        elif command == 5:
            self.blocks.clear()
            self.running.clear()
        return bytes([command, data[1] if len(data) > 1 else 0, status])

    def memory_info(self, data, _port):
        memories = list(self.craft.memories.items())
        if data[0] == 1:
            return bytes([1, len(memories)])
        kind, memory = memories[data[1]]
        return struct.pack("<BBBI", 2, data[1], kind, len(memory)) + bytes(8)

    def memory_write(self, data, _port):
        number, at = struct.unpack("<BI", data[:5])
        memory = list(self.craft.memories.values())[number]
        fits = at + len(data) - 5 <= len(memory)
        if fits:
            memory[at : at + len(data) - 5] = data[5:]
        return data[:5] + bytes([0 if fits else TOO_LARGE])

    def command(self, data, _port):
        self.craft.commands.append(data)

    def play(self):
        for step in itertools.count():
            if self.closed.wait(self.craft.period_s):
                return
            stamp_ms = self.craft.tick(len(self.running))
            if stamp_ms is None:
                continue
            for block, periods in list(self.running.items()):
                if step % periods == 0:
                    values = [(code, variable.get()) for code, variable in self.blocks[block]]
                    values = [value if code in "fe" else round(value) for code, value in values]
                    body = struct.pack("<" + "".join(code for code, _ in self.blocks[block]), *values)
                    self.send(LOGGING, 2, bytes([block]) + struct.pack("<I", stamp_ms)[:3] + body)

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


def link_to(craft):
    """Lets cflib find the craft at `URI`."""
    StandIn.craft = craft
    if StandIn not in cflib.crtp.CLASSES:
        cflib.crtp.CLASSES.append(StandIn)
