"""The controller's object behind the stand-in: its own parameters, log variables and app channel, as `quatrack_app.c` declares them.

The object is built for this machine as a shared library:

    cargo rustc --release --package quatrack-crazyflie --lib --crate-type cdylib
"""

import ctypes
import re
from pathlib import Path

import stand_in

SOURCES = Path(__file__).resolve().parent.parent / "app" / "src"
C_TYPES = {
    "float": ctypes.c_float,
    "uint8_t": ctypes.c_uint8,
    "int16_t": ctypes.c_int16,
    "uint16_t": ctypes.c_uint16,
}
PARAMETER_KINDS = {"UINT8": 0x08, "FLOAT": 0x06}
LOG_KINDS = {"LOG_UINT8": 1, "LOG_UINT16": 2, "LOG_INT16": 5, "LOG_FLOAT": 7}
TRAJECTORY_MEMORY, TRAJECTORY_BYTES = 0x12, 4096


def structs():
    """The structs of the header, by name."""
    header = re.sub(r"/\*.*?\*/", "", (SOURCES / "quatrack.h").read_text(), flags=re.S)
    found = dict(C_TYPES)
    for body, name in re.findall(r"typedef struct \{(.*?)\} (\w+);", header, re.S):
        fields = []
        for kind, field, count in re.findall(r"([\w ]+?)\s*\b(\w+)(?:\[(\d+)\])?;", body):
            c_type = found[kind.strip()]
            fields.append((field, c_type * int(count) if count else c_type))
        found[name] = type(name, (ctypes.Structure,), {"_fields_": fields})
    return found


def declared(prefix, macro):
    """Name, types and place of each variable that the app declares: of PARAM or LOG."""
    source = (SOURCES / "quatrack_app.c").read_text()
    source = re.sub(r"#define OWN_(\w+) .*", "", source)
    source = re.sub(r"\bOWN_(\w+)", r"PARAM_\1 | PARAM_PERSISTENT", source)
    source = re.sub(r"^GAIN\((\w+), (\d+)\)", r"PARAM_ADD(PARAM_FLOAT | PARAM_RONLY, \1, &quatrack.gains.gains[\2])", source, flags=re.M)
    for group, body in re.findall(rf"^{prefix}_GROUP_START\((\w+)\)\n(.*?)^{prefix}_GROUP_STOP", source, re.S | re.M):
        for types, name, place in re.findall(rf"^{macro}\(([^,]+), (\w+), &quatrack\.([\w.\[\]]+)\)", body, re.M):
            yield f"{group}.{name}", [each.strip() for each in types.split("|")], place


class Object(stand_in.Craft):
    """A craft that the object controls; it stands on the ground."""

    def __init__(self, library, mass_kg, arm_m, thrust_max_n, torque_per_thrust_m):
        super().__init__()
        types = structs()
        self.library = ctypes.CDLL(str(library))
        self.shared = types["quatrack_t"].in_dll(self.library, "quatrack")
        self.packet = types["quatrackPacket_t"]
        self.memories[TRAJECTORY_MEMORY] = bytearray(TRAJECTORY_BYTES)
        for name, kinds, place in declared("PARAM", "PARAM_ADD"):
            kind = next(PARAMETER_KINDS[each.removeprefix("PARAM_")] for each in kinds if each.removeprefix("PARAM_") in PARAMETER_KINDS)
            get, put = self.at(place)
            put = None if "PARAM_RONLY" in kinds else put
            self.parameters[name] = stand_in.Variable(kind, get, put, "PARAM_PERSISTENT" in kinds)
        for name, kinds, place in declared("LOG", "LOG_ADD"):
            self.logs[name] = stand_in.Variable(LOG_KINDS[kinds[0]], self.at(place)[0])
        platform = types["quatrackPlatform_t"](mass_kg, arm_m, thrust_max_n, torque_per_thrust_m)
        self.library.quatrackPlatform.restype = ctypes.c_bool
        self.has_tables = self.library.quatrackPlatform(ctypes.byref(platform))
        self.library.quatrackService()
        self.time_ms = 0

    def at(self, place):
        """Getter and setter of the value at a place within the shared struct."""
        *path, last = re.findall(r"\w+", place)
        owner = self.shared
        for step in path:
            owner = owner[int(step)] if step.isdigit() else getattr(owner, step)
        if last.isdigit():
            return lambda: owner[int(last)], lambda value: owner.__setitem__(int(last), value)
        return lambda: getattr(owner, last), lambda value: setattr(owner, last, value)

    def app_packet(self, packet):
        sent, answer = self.packet(len(packet), (ctypes.c_uint8 * 30)(*packet)), self.packet()
        self.library.quatrackPacket(ctypes.byref(sent), ctypes.byref(answer))
        return bytes(answer.bytes[: answer.length])

    def tick(self, _running):
        self.time_ms += 10
        return self.time_ms

    def changed(self):
        self.library.quatrackService()
