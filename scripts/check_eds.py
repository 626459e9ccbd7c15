#!/usr/bin/env python3
"""Checks an electronic data sheet against CiA 306-1 and against itself.

    scripts/check_eds.py FILE...

Every violation of the standard is an error; what is allowed but known to confuse masters or the
conformance test is a warning. Exit status 1 if there is either.
"""

import argparse
import pathlib
import re
import sys

FILE_INFO = [
    "FileName",
    "FileVersion",
    "FileRevision",
    "EDSVersion",
    "Description",
    "CreationTime",
    "CreationDate",
    "CreatedBy",
    "ModificationTime",
    "ModificationDate",
    "ModifiedBy",
]
BIT_RATES = [f"BaudRate_{rate}" for rate in (10, 20, 50, 125, 250, 500, 800, 1000)]
DEVICE_INFO = [
    "VendorName",
    "VendorNumber",
    "ProductName",
    "ProductNumber",
    "RevisionNumber",
    "OrderCode",
    *BIT_RATES,
    "SimpleBootUpMaster",
    "SimpleBootUpSlave",
    "Granularity",
    "DynamicChannelsSupported",
    "GroupMessaging",
    "NrOfRXPDO",
    "NrOfTXPDO",
    "LSS_Supported",
]
FLAGS = [*BIT_RATES, "SimpleBootUpMaster", "SimpleBootUpSlave", "GroupMessaging", "LSS_Supported"]
LISTS = {
    "MandatoryObjects": lambda index: index in (0x1000, 0x1001, 0x1018),
    "OptionalObjects": lambda index: index not in (0x1000, 0x1001, 0x1018)
    and (0x1000 <= index <= 0x1FFF or 0x6000 <= index <= 0xFFFF),
    "ManufacturerObjects": lambda index: 0x2000 <= index <= 0x5FFF,
}
ENTRY_KEYS = [
    "ParameterName",
    "ObjectType",
    "DataType",
    "AccessType",
    "LowLimit",
    "HighLimit",
    "DefaultValue",
    "PDOMapping",
    "ObjFlags",
    "Denotation",
]
HEAD_KEYS = ["ParameterName", "ObjectType", "SubNumber", "ObjFlags", "Denotation"]
DUMMIES = [f"Dummy{number:04d}" for number in range(1, 8)]

# Data types by their index: name, bits, signed. None: no number.
TYPES = {
    0x1: (1, False),
    0x2: (8, True),
    0x3: (16, True),
    0x4: (32, True),
    0x5: (8, False),
    0x6: (16, False),
    0x7: (32, False),
    0x8: None,
    0x9: None,
    0xA: None,
    0xB: None,
    0xF: None,
    0x11: None,
    0x15: (64, True),
    0x1B: (64, False),
}
VAR, ARRAY, RECORD = 7, 8, 9
READABLE = ("ro", "const", "rw", "rwr", "rww")
# What CiA 301 says of the communication objects: object type, data type, access of a variable.
STANDARD = {
    0x1000: (VAR, 0x7, ("ro", "const")),
    0x1001: (VAR, 0x5, ("ro",)),
    0x1002: (VAR, 0x7, ("ro",)),
    0x1005: (VAR, 0x7, ("rw", "ro", "const")),
    0x1006: (VAR, 0x7, ("rw",)),
    0x1007: (VAR, 0x7, ("rw",)),
    0x1008: (VAR, 0x9, ("ro", "const")),
    0x1009: (VAR, 0x9, ("ro", "const")),
    0x100A: (VAR, 0x9, ("ro", "const")),
    0x100C: (VAR, 0x6, ("rw", "ro", "const")),
    0x100D: (VAR, 0x5, ("rw", "ro", "const")),
    0x1014: (VAR, 0x7, ("rw", "ro", "const")),
    0x1015: (VAR, 0x6, ("rw",)),
    0x1017: (VAR, 0x6, ("rw", "ro", "const")),
    0x1019: (VAR, 0x5, ("rw",)),
    0x1021: (VAR, 0xF, ("ro", "const")),
    0x1022: (VAR, 0x6, ("ro", "const")),
    0x1010: (ARRAY, 0x7, None),
    0x1011: (ARRAY, 0x7, None),
    0x1016: (ARRAY, 0x7, None),
    0x1029: (ARRAY, 0x5, None),
    0x1018: (RECORD, None, None),
}


class Eds:
    """The sections of a file, and what is wrong with them."""

    def __init__(self, data):
        self.errors = []
        self.warnings = []
        self.sections = {}
        self.parse(data)

    def error(self, where, what):
        self.errors.append(f"[{where}] {what}")

    def warn(self, where, what):
        self.warnings.append(f"[{where}] {what}")

    def parse(self, data):
        try:
            text = data.decode("ascii")
        except UnicodeDecodeError as problem:
            self.error("file", f"is not ASCII: {problem}")
            text = data.decode("latin-1")
        if not text.endswith("\r\n") or "\n" in text.replace("\r\n", ""):
            self.error("file", "a line does not end with CR LF")
        section = None
        for number, line in enumerate(text.splitlines(), 1):
            if len(line) > 255:
                self.error("file", f"line {number} is longer than 255 characters")
            line = line.strip()
            if not line or line.startswith(";"):
                continue
            if line.startswith("[") and line.endswith("]"):
                section = line[1:-1]
                if section in self.sections:
                    self.error(section, "stands in the file twice")
                self.sections.setdefault(section, {})
                continue
            key, equals, value = line.partition("=")
            if not equals or section is None:
                self.error("file", f"line {number} is neither a section nor Key=Value: {line}")
                continue
            if key in self.sections[section]:
                self.error(section, f"{key} is given twice")
            if not value and key not in ("Description", "OrderCode") and not key.startswith("Line"):
                self.warn(section, f"{key} has no value; leave the line out")
            self.sections[section][key] = value

    def number(self, section, key, text=None):
        """The number behind a key, or None after complaining."""
        text = self.sections[section].get(key) if text is None else text
        if text is None:
            return None
        try:
            return int(text, 8) if re.fullmatch(r"0[0-7]+", text) else int(text, 0)
        except ValueError:
            self.error(section, f"{key}={text} is not a number")
            return None


def check_keys(eds, section, known, mandatory):
    content = eds.sections[section]
    for key in mandatory:
        if key not in content:
            eds.error(section, f"{key} is missing")
    for key in content:
        if key not in known:
            eds.warn(section, f"{key} is no key of CiA 306-1")


def check_head(eds):
    for section in ("FileInfo", "DeviceInfo", "DummyUsage", "Comments", *LISTS):
        if section not in eds.sections:
            eds.error(section, "is missing")
            eds.sections[section] = {}
    check_keys(eds, "FileInfo", FILE_INFO, FILE_INFO)
    info = eds.sections["FileInfo"]
    for key in ("FileVersion", "FileRevision"):
        value = eds.number("FileInfo", key)
        if value is not None and not 0 <= value <= 255:
            eds.error("FileInfo", f"{key}={value} is no UNSIGNED8")
    if info.get("EDSVersion") not in ("4.0", "4.1"):
        eds.error("FileInfo", f"EDSVersion={info.get('EDSVersion')} is neither 4.0 nor 4.1")
    for key in ("CreationTime", "ModificationTime"):
        if not re.fullmatch(r"(0[1-9]|1[0-2]):[0-5][0-9](AM|PM)", info.get(key, "")):
            eds.error("FileInfo", f"{key}={info.get(key)} is not hh:mmAM or hh:mmPM")
    for key in ("CreationDate", "ModificationDate"):
        if not re.fullmatch(r"(0[1-9]|1[0-2])-(0[1-9]|[12][0-9]|3[01])-[0-9]{4}", info.get(key, "")):
            eds.error("FileInfo", f"{key}={info.get(key)} is not mm-dd-yyyy")
    check_keys(eds, "DeviceInfo", DEVICE_INFO, DEVICE_INFO)
    for key in FLAGS:
        if eds.sections["DeviceInfo"].get(key) not in ("0", "1", None):
            eds.error("DeviceInfo", f"{key} is neither 0 nor 1")
    for key in ("VendorNumber", "ProductNumber", "RevisionNumber", "Granularity"):
        eds.number("DeviceInfo", key)
    check_keys(eds, "DummyUsage", DUMMIES, DUMMIES)
    lines = eds.number("Comments", "Lines") or 0
    check_keys(
        eds,
        "Comments",
        ["Lines", *(f"Line{n + 1}" for n in range(lines))],
        ["Lines", *(f"Line{n + 1}" for n in range(lines))],
    )


def check_lists(eds):
    """The objects listed, in every list's order."""
    listed = []
    for section, belongs in LISTS.items():
        content = eds.sections[section]
        count = eds.number(section, "SupportedObjects") or 0
        keys = [str(n + 1) for n in range(count)]
        check_keys(eds, section, ["SupportedObjects", *keys], ["SupportedObjects", *keys])
        indices = [eds.number(section, key) for key in keys if key in content]
        for index in indices:
            if index is None:
                continue
            if not belongs(index):
                eds.error(section, f"{index:04X}h does not belong into this list")
            if index in listed:
                eds.error(section, f"{index:04X}h is listed twice")
            if f"{index:04X}" not in eds.sections:
                eds.error(section, f"{index:04X}h is listed and not described")
            listed.append(index)
        if indices != sorted(index for index in indices if index is not None):
            eds.warn(section, "the objects are not in ascending order")
    for section in eds.sections:
        match = re.fullmatch(r"([0-9A-F]{4})(sub([0-9A-F]{1,2}))?", section)
        if match is None:
            if section not in ("FileInfo", "DeviceInfo", "DummyUsage", "Comments", *LISTS):
                eds.warn(section, "is no section of CiA 306-1")
        elif int(match[1], 16) not in listed:
            eds.error(section, "is described and not listed")
    return [index for index in listed if f"{index:04X}" in eds.sections]


def in_type(kind, value):
    bits, signed = kind
    return -(1 << bits - 1) <= value < 1 << bits - 1 if signed else 0 <= value < 1 << bits


def check_value(eds, section, key, kind):
    """The value of a limit or default if it is a number, for node-ID 0."""
    text = eds.sections[section].get(key)
    if text is None or kind is None:
        return None
    relative = re.fullmatch(r"\$NODEID\+(0x[0-9A-Fa-f]+|[0-9]+)", text)
    if relative is not None:
        if key != "DefaultValue" or kind != TYPES[0x7]:
            eds.error(section, f"{key}={text}: only the default of an UNSIGNED32 may count from the node-ID")
        return int(relative[1], 0)
    value = eds.number(section, key)
    if value is not None and not in_type(kind, value):
        eds.error(section, f"{key}={text} is no value of its data type")
    return value


def check_entry(eds, section):
    """One entry; its (data type, access, mappable, default)."""
    content = eds.sections[section]
    check_keys(eds, section, ENTRY_KEYS, ["ParameterName", "ObjectType", "DataType", "AccessType", "PDOMapping"])
    if not 1 <= len(content.get("ParameterName", "")) <= 241:
        eds.error(section, "ParameterName has not 1 to 241 characters")
    if eds.number(section, "ObjectType") not in (2, VAR):
        eds.error(section, "ObjectType of an entry is 0x7")
    data_type = eds.number(section, "DataType")
    if data_type not in TYPES:
        eds.error(section, f"DataType={content.get('DataType')} is unknown")
    kind = TYPES.get(data_type)
    access = content.get("AccessType")
    if access not in ("ro", "rw", "wo", "const", "rwr", "rww"):
        eds.error(section, f"AccessType={access} is unknown")
    mappable = content.get("PDOMapping") == "1"
    if content.get("PDOMapping") not in ("0", "1"):
        eds.error(section, "PDOMapping is neither 0 nor 1")
    if mappable and access == "rw":
        eds.warn(section, "is mappable in both directions; rwr or rww says which one is meant")
    if not mappable and access in ("rwr", "rww"):
        eds.error(section, f"AccessType={access} says it can be mapped, PDOMapping that it cannot")
    low, high = (check_value(eds, section, key, kind) for key in ("LowLimit", "HighLimit"))
    default = check_value(eds, section, "DefaultValue", kind)
    if low is not None and high is not None and low > high:
        eds.error(section, f"LowLimit {low} is above HighLimit {high}")
    if default is not None and ((low is not None and default < low) or (high is not None and default > high)):
        eds.error(section, f"DefaultValue {default} is outside its limits {low}..{high}")
    if access == "wo" and "DefaultValue" in content:
        eds.warn(section, "has a default that nobody can read")
    return {"type": data_type, "access": access, "mappable": mappable, "default": default}


def check_object(eds, index):
    """One object; its entries by subindex."""
    section = f"{index:04X}"
    content = eds.sections[section]
    object_type = eds.number(section, "ObjectType")
    subsections = {
        int(match[1], 16): name for name in eds.sections if (match := re.fullmatch(f"{section}sub([0-9A-F]+)", name))
    }
    if object_type in (2, VAR):
        if subsections:
            eds.error(section, "is a variable and has subindices")
        entries = {0: check_entry(eds, section)}
    else:
        check_keys(eds, section, HEAD_KEYS, ["ParameterName", "ObjectType", "SubNumber"])
        if object_type not in (ARRAY, RECORD):
            eds.error(section, f"ObjectType={content.get('ObjectType')} is unknown")
        if eds.number(section, "SubNumber") != len(subsections):
            eds.error(section, f"SubNumber={content.get('SubNumber')}, but {len(subsections)} subindices are described")
        entries = {sub: check_entry(eds, name) for sub, name in sorted(subsections.items())}
        check_structure(eds, section, object_type, entries, subsections)
    check_standard(eds, index, object_type, entries)
    return entries


def check_structure(eds, section, object_type, entries, subsections):
    if 0 not in entries or entries[0]["type"] != 0x5:
        eds.error(section, "subindex 0 is missing or no UNSIGNED8")
        return
    highest = max(entries)
    mapping = 0x1600 <= int(section, 16) <= 0x17FF or 0x1A00 <= int(section, 16) <= 0x1BFF
    if not mapping and entries[0]["default"] not in (highest, None):
        eds.error(section, f"subindex 0 says {entries[0]['default']}, the highest is {highest}")
    types = {entry["type"] for sub, entry in entries.items() if sub != 0}
    if object_type == ARRAY and len(types) > 1:
        eds.error(section, "the elements of an array have different data types")
    names = [eds.sections[name].get("ParameterName") for name in subsections.values()]
    if len(set(names)) != len(names):
        eds.warn(section, "two subindices have the same name")


def check_standard(eds, index, object_type, entries):
    wanted = STANDARD.get(index)
    if wanted is None:
        return
    section = f"{index:04X}"
    if object_type != wanted[0]:
        eds.error(section, f"CiA 301 has ObjectType={wanted[0]:#x} here")
    data = entries.get(0 if wanted[0] == VAR else 1)
    if wanted[1] is not None and (data is None or data["type"] != wanted[1]):
        eds.error(section, f"CiA 301 has DataType={wanted[1]:#06x} here")
    if wanted[2] is not None and data is not None and data["access"] not in wanted[2]:
        eds.error(section, f"CiA 301 has AccessType={' or '.join(wanted[2])} here")


def check_pdos(eds, objects):
    for first, mapping_first, key, directions in (
        (0x1400, 0x1600, "NrOfRXPDO", ("rw", "rww", "wo")),
        (0x1800, 0x1A00, "NrOfTXPDO", ("ro", "const", "rw", "rwr")),
    ):
        communication = {i - first for i in objects if first <= i < first + 0x200}
        mappings = {i - mapping_first for i in objects if mapping_first <= i < mapping_first + 0x200}
        if communication != mappings:
            eds.error("file", f"PDOs from {first:04X}h and mappings from {mapping_first:04X}h do not belong together")
        if eds.number("DeviceInfo", key) != len(communication):
            eds.error("DeviceInfo", f"{key} is not {len(communication)}")
        for number in sorted(communication & mappings):
            check_cob_id(eds, first + number, objects[first + number])
            check_mapping(eds, mapping_first + number, objects, directions)


def check_cob_id(eds, index, entries):
    identifier = entries[1]["default"] if 1 in entries else None
    if identifier is None:
        eds.error(f"{index:04X}", "its COB-ID has no default")
    elif identifier & 0x3FFFF800:
        eds.error(f"{index:04X}", f"its COB-ID {identifier:08X}h has bits outside of an 11-bit one")


def check_mapping(eds, index, objects, directions):
    section = f"{index:04X}"
    entries = objects[index]
    count = entries[0]["default"] or 0
    bits = 0
    for sub in range(1, max(entries) + 1):
        value = entries[sub]["default"] if sub in entries else None
        if sub > count:
            continue
        if not value:
            eds.error(section, f"entry {sub} of {count} is empty")
            continue
        target, length = objects.get(value >> 16, {}).get(value >> 8 & 0xFF), value & 0xFF
        bits += length
        if target is None:
            eds.error(section, f"entry {sub} maps {value:08X}h, which does not exist")
        elif not target["mappable"] or target["access"] not in directions:
            eds.error(section, f"entry {sub} maps {value:08X}h, which cannot be mapped so")
        elif TYPES[target["type"]] is None or TYPES[target["type"]][0] != length:
            eds.error(section, f"entry {sub} maps {value:08X}h with a wrong length")
    if bits > 64:
        eds.error(section, f"maps {bits} bits, 64 are possible")


def check_identity(eds, objects):
    identity = objects.get(0x1018, {})
    for sub, key in ((1, "VendorNumber"), (2, "ProductNumber"), (3, "RevisionNumber")):
        stated = eds.number("DeviceInfo", key)
        if sub in identity and identity[sub]["default"] != stated:
            eds.error("DeviceInfo", f"{key} is not the default of 1018h:{sub:02X}")


def check(data):
    """Errors and warnings of a file's bytes."""
    eds = Eds(data)
    check_head(eds)
    objects = {index: check_object(eds, index) for index in check_lists(eds)}
    names = [eds.sections[f"{index:04X}"].get("ParameterName") for index in objects]
    for name in sorted({name for name in names if names.count(name) > 1}):
        eds.warn("file", f'two objects are called "{name}"; masters that go by names lose one')
    check_pdos(eds, objects)
    check_identity(eds, objects)
    return eds.errors, eds.warnings


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE", type=pathlib.Path)
    failed = False
    for path in parser.parse_args().files:
        errors, warnings = check(path.read_bytes())
        for kind, messages in (("error", errors), ("warning", warnings)):
            for message in messages:
                print(f"{path}: {kind}: {message}")
        print(f"{path}: {len(errors)} errors, {len(warnings)} warnings")
        failed = failed or bool(errors or warnings)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
