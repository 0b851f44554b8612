#!/usr/bin/env python3
"""upload.py against the object itself, behind the stand-in that serves its parameters and log variables: needs cflib (0.1.34), no radio.

    python3 crazyflie/tools/test_upload.py LIBRARY        # as in firmware_object.py
"""

import contextlib
import io
import re
import struct
import sys
import tempfile
import textwrap
from pathlib import Path

import firmware_object
import stand_in
import upload

ROOT = Path(__file__).resolve().parents[2]
GENERATED = ROOT / "gains" / "generated"
# `quatrack gains craft gains/vehicles/crazyflie-2.1-legacy.toml --out legacy-craft.bin`.
CRAFT = (ROOT / "tests" / "data" / "legacy-craft.bin").read_bytes()
# platform_defaults_cf2.h of the Crazyflie 2.1+, and of the Brushless.
CRAZYFLIE = (0.029, 0.046, 0.12, 0.0069928949)
BRUSHLESS = (0.0393, 0.05, 0.2, 0.0056927884)


def said(*arguments):
    """The script's output and its final message."""
    out, ending = io.StringIO(), None
    with contextlib.redirect_stdout(out):
        try:
            upload.main(["--uri", stand_in.URI, *map(str, arguments)])
        except SystemExit as exit_:
            ending = exit_.code
    return out.getvalue().strip(), ending


def craft(library, platform):
    made = firmware_object.Object(library, *platform)
    stand_in.link_to(made)
    return made


def tables_and_refusals(library):
    made = craft(library, CRAZYFLIE)
    assert made.has_tables
    # 44 parameters and 31 log variables, as the app declares them.
    assert "quatrackK.yawF" in made.parameters and "quatrackA.stands" in made.logs
    assert said("status") == ("motors off, as asked; table 0, the cascade", None)
    out, ending = said("table", GENERATED / "cascade-100ms.bin")
    assert (out, ending) == ("sent, 326 bytes: motors off, as asked; table 5, the table that was sent", None), (out, ending)
    for name, words in [
        ("cascade-brushless-50ms.bin", "refused: for another craft or rate (status 8)"),
        (ROOT / "tests/data/actuator-aware.bin", f"refused: actuator-aware: outdated (status 11){upload.REMEDIES[11]}"),
        ("along-mild.bin", "refused: gains along a trajectory (status 10)"),
        ("cascade-20ms.bin", f"sent, but not flown: {upload.REFUSALS[3]}"),
    ]:
        assert said("table", GENERATED / name) == ("", f"upload.py: {words}"), (name, said("table", GENERATED / name))
    # The one before goes on flying, and the craft says why.
    out, _ = said("status")
    assert out.splitlines()[0].endswith("table 5, the table that was sent") and upload.REFUSALS[3] in out, out
    # With a lag that it is certified for, the same table flies.
    assert said("store", "motorLag=0.02") == ("quatrack.motorLag = 0.02, stored", None)
    assert made.stored == ["quatrack.motorLag"]
    assert said("table", GENERATED / "cascade-20ms.bin")[1] is None
    _, ending = said("craft", GENERATED / "cascade-20ms.bin")
    assert ending.endswith("is no craft of `quatrack gains craft --out NAME.bin`; send it with `upload.py table`"), ending
    _, ending = said("table", GENERATED / "cascade-20ms.json")
    assert ending.endswith("is no binary gain table; " + str(GENERATED / "cascade-20ms.bin") + " beside it is one"), ending
    assert said("store", "feedForward=1")[1] == "upload.py: quatrack.feedForward cannot be stored: it is set anew at each start"
    assert said("store", "drug=1")[1] == "upload.py: quatrack.drug: the firmware has no such parameter"


def a_craft_without_tables(library):
    unknown = (0.06, *CRAZYFLIE[1:])
    assert not craft(library, unknown).has_tables
    out, ending = said("table", GENERATED / "cascade-100ms.bin")
    assert out == "" and ending.startswith("upload.py: refused: no craft"), ending
    assert craft(library, BRUSHLESS).has_tables


def crafts(library, folder):
    """A craft with other propellers, which there is no table for, and how each that does not fit is refused."""
    figures = struct.unpack("<15f", CRAFT[6:66])
    legacy = (figures[0], figures[7], figures[9], figures[10])
    file = Path(folder) / "craft.bin"
    file.write_bytes(CRAFT)
    made = craft(library, legacy)
    assert not made.has_tables
    # A lag that was stored for another craft is refused, and the table flies for its own.
    assert said("craft", file)[1] == f"upload.py: sent, and flown for the lag of its table's design: {upload.REFUSALS[3]}"
    assert said("store", "motorLag=0")[1] is None
    assert said("craft", file) == ("sent, 396 bytes: motors off, as asked; table 0, the cascade", None), said("craft", file)
    # A table for it is now one for this craft, and that of another is not.
    assert said("table", GENERATED / "cascade-100ms.bin")[1] == "upload.py: refused: for another craft or rate (status 8)"
    own = Path(folder) / "table.bin"
    own.write_bytes(CRAFT[66:-4])
    assert said("table", own) == ("sent, 326 bytes: motors off, as asked; table 5, the table that was sent", None)
    assert said("table", file)[1].endswith("is no binary gain table; send it with `upload.py craft`")
    craft(library, CRAZYFLIE)
    words = f"upload.py: refused: firmware's torque differs (status 18){upload.REMEDIES[18]}"
    assert said("craft", file) == ("", words), said("craft", file)


def trajectories(library):
    made = craft(library, CRAZYFLIE)
    # A piece of 1.5 s along each axis by a number of its own.
    row = [1.5, *([0.5, 0.25] + 6 * [0.0]), *([1.0] + 7 * [0.0]), *([2.0] + 7 * [0.0]), *([3.0] + 7 * [0.0])]
    header = ",".join(["duration", *(f"{axis}^{k}" for axis in ("x", "y", "z", "yaw") for k in range(8))])
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "t.csv"
        file.write_text("\n".join([header, *(2 * [",".join(map(str, row))])]))
        out, ending = said("trajectory", file, "--number", 3)
        assert ending is None and out.startswith("trajectory 3: 2 pieces, 3.00 s, 264 bytes from 0 on"), (out, ending)
        memory = made.memories[firmware_object.TRAJECTORY_MEMORY]
        # The firmware's struct poly4d: x, y, z, yaw, and the duration last.
        assert struct.unpack_from("<33f", memory, 132) == (*row[1:], row[0])
        # COMMAND_DEFINE_TRAJECTORY, number, in memory, polynomials, from byte 0, two pieces.
        assert made.commands[-1] == struct.pack("<BBBBIB", 6, 3, 1, 0, 0, 2)
        file.write_text("\n".join([header, *(32 * [",".join(map(str, row))])]))
        assert "`quatrack refit --pieces 31`" in said("trajectory", file)[1]
        file.write_text(header + "\n1,2,3\n")
        assert f"{file}: line 2" in said("trajectory", file)[1]
        # A start, and two pieces: 7 shorts of x alone, then none.
        packed = struct.pack("<4h", 0, 0, 1000, 0) + struct.pack("<BH7h", 3, 1500, *range(7)) + struct.pack("<BH", 0, 500)
        file.write_bytes(packed)
        out, ending = said("trajectory", file, "--address", 264)
        assert out.startswith("trajectory 1: 2 pieces, 2.00 s, 28 bytes from 264 on"), (out, ending)
        assert memory[264 : 264 + len(packed)] == packed
        assert made.commands[-1] == struct.pack("<BBBBIB", 6, 1, 1, 1, 264, 2)


def nothing_is_sent_in_flight(library):
    made = craft(library, CRAZYFLIE)
    made.shared.log.mode = 1
    _, ending = said("table", GENERATED / "cascade-100ms.bin")
    assert ending.startswith("upload.py: it flies"), ending


def the_first_flight_of_the_chapter(library):
    made = craft(library, CRAZYFLIE)
    page = (ROOT / "docs" / "owner.md").read_text()
    lines = page[page.index("```python\n") :].split("```")[1].removeprefix("python\n")
    lines = textwrap.dedent(lines).replace("radio://0/80/2M/E7E7E7E7E7", stand_in.URI).replace("time.sleep(", "pauses.append(")
    lines = lines.replace("rw_cache='./cache'", "rw_cache=None")
    pauses = []
    exec(lines, {"pauses": pauses})
    # COMMAND_TAKEOFF_2 to 0.5 m in 2 s and COMMAND_LAND_2 to 0 m in 2.5 s, each at the yaw that the craft has; COMMAND_STOP.
    take_off, land, stop = made.commands
    assert struct.unpack("<BBff?f", take_off) == (7, 0, 0.5, 0.0, True, 2.0)
    assert struct.unpack("<BBff?f", land) == (8, 0, 0.0, 0.0, True, 2.5)
    assert stop[0] == 3 and len(pauses) == 3


def words_are_those_of_the_source():
    """Every code of the object has words."""
    source = ROOT / "crazyflie" / "src"
    for path, enum, words in [
        ("tables.rs", "Refusal", upload.REFUSALS),
        ("tables.rs", "TableId", upload.TABLES),
        ("control/outcome.rs", "Mode", upload.MODES),
    ]:
        body = re.search(rf"pub enum {enum} \{{(.*?)\n\}}", (source / path).read_text(), re.S).group(1)
        codes = {int(code) for code in re.findall(r"= (\d+),", body)}
        assert codes and codes <= set(words), (enum, codes)


def main():
    library = Path(sys.argv[1]).resolve()
    words_are_those_of_the_source()
    tables_and_refusals(library)
    a_craft_without_tables(library)
    with tempfile.TemporaryDirectory() as folder:
        crafts(library, folder)
    trajectories(library)
    nothing_is_sent_in_flight(library)
    the_first_flight_of_the_chapter(library)
    print("upload.py sends, stores and says why not")


if __name__ == "__main__":
    main()
