"""What sessions need to know of products, asked from a program."""

import contextlib
import csv
import dataclasses
import io
import re
import struct
from pathlib import Path

from comparison.outcome import run

ROOT = Path(__file__).resolve().parent.parent.parent
SEGMENT_PRODUCTS = ("tmcm-3315", "tmc8670", "tmc8461")
SERIAL = {
    "tmcm-3315": ("usb",),
    "tmc8670": ("mcu-uart", "hardware-uart"),
    "tmcc160": ("serial",),
    "tmcm-142": ("rs232", "rs485", "rs422", "usb"),
}
SIZES = {"BOOLEAN": 1, "INTEGER8": 1, "UNSIGNED8": 1, "INTEGER16": 2, "UNSIGNED16": 2, "INTEGER32": 4, "UNSIGNED32": 4}
# Written at random they end the session or make its process data something else.
LEFT_ALONE = range(0x1000, 0x1FFF)
MFC = "examples/mfc/io-board.toml"


@dataclasses.dataclass
class Product:
    type: str
    objects: list = dataclasses.field(default_factory=list)  # (index, subindex, size, writable) of plain numbers
    areas: tuple = ()  # where sync managers 2 and 3 begin
    block: dict = dataclasses.field(default_factory=dict)  # {register: (address, size)} of an I/O block
    inputs: list = dataclasses.field(default_factory=list)  # (name, least, most, unit)
    signals: list = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Fault:
    kind: str
    scope: str
    reach: str
    counted: bool
    momentary: bool
    parameters: list  # (key, type, range, needed)


def rows(program, *arguments):
    output = run(program, [*arguments, "--format", "csv"], ROOT).output
    return list(csv.DictReader(io.StringIO(output.decode())))


def objects_of(program, product):
    found = []
    for row in rows(program, "describe", product):
        index, subindex, _, _, kind, access, *_ = row.values()
        if kind in SIZES and access != "wo":
            writable = "w" in access and int(index, 16) not in LEFT_ALONE
            found.append((int(index, 16), int(subindex, 16), SIZES[kind], writable))
    return found


def areas_of(image):
    """Begins of sync managers 2 and 3 in an SII image: category 41."""
    at = 0x80
    while at + 4 <= len(image):
        category, words = struct.unpack_from("<HH", image, at)
        if category == 41:
            return tuple(struct.unpack_from("<H", image, at + 4 + 8 * number)[0] for number in (2, 3))
        if category == 0xFFFF:
            break
        at += 4 + 2 * words
    return ()


def block_of(program):
    """{register: (address, size)} of what goes to the I/O block and comes from it."""
    found = {}
    for row in rows(program, "mfc", "config", MFC):
        address, _, register, size, *_ = row.values()
        with contextlib.suppress(ValueError, TypeError):
            found[register] = (int(address.rstrip("h"), 16), int(size))
    return found


def load(program):
    """{type: Product}"""
    found = {}
    for kind in ("tmcm-3315", "tmc8670", "tmc8461", "tmcc160", "tmcm-142"):
        product = Product(kind)
        if kind in ("tmcm-3315", "tmc8670", "tmcc160"):
            product.objects = objects_of(program, kind)
        if kind in ("tmcm-3315", "tmc8670"):
            product.areas = areas_of(run(program, ["export", "sii", kind], ROOT).output)
        if kind == "tmc8461":
            product.block = block_of(program)
        for row in rows(program, "describe", kind, "--inputs"):
            product.inputs.append((row["input"], float(row["minimum"]), float(row["maximum"]), row["unit"]))
        product.signals = [row["signal"] for row in rows(program, "describe", kind, "--signals")]
        found[kind] = product
    return found


def load_faults(program):
    """All kinds, from the page that the program makes of them."""
    page = run(program, ["faults", "--format", "markdown"], ROOT).output.decode()
    found = []
    for part in page.partition("\n## Kinds")[2].split("\n### ")[1:]:
        kind, _, rest = part.partition("\n")
        scope = re.search(r"^Of an? ([a-z]+):", rest, re.MULTILINE)
        parameters = []
        for row in re.findall(r"^\| `([a-z0-9_.]+)` \| (.*)$", rest, re.MULTILINE):
            cells = [cell.strip() for cell in row[1].split(" | ")]
            parameters.append((row[0], cells[0], cells[1], cells[2] == "needed"))
        reach = (
            "ethercat"
            if "EtherCAT devices" in rest
            else "can"
            if "on a CAN bus" in rest
            else "serial"
            if "For serial lines" in rest
            else "any"
        )
        found.append(
            Fault(
                kind.strip(),
                scope[1] if scope else "device",
                reach,
                "Nothing to count" not in rest and "Over as soon" not in rest,
                "Over as soon" in rest,
                parameters,
            )
        )
    return found
