#!/usr/bin/env python3
"""The JSON schema of rack files, in the hands of a validator as editors have one.

Ready racks must be valid, and what `stator check` refuses for a key, a type or a range must not be.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tomllib

from running_rack import unavailable

try:
    import jsonschema
except ImportError as error:
    unavailable(str(error), "scripts/setup test installs what is needed")

RACKS = pathlib.Path(__file__).resolve().parents[2] / "racks"

HEAD = '[[segment]]\n[[segment.device]]\ntype = "tmcm-3315"\n'
WRONG = {
    "a key nobody knows": HEAD + 'colour = "red"\n',
    "a key of another product": HEAD + "node_id = 5\n",
    "a value out of range": HEAD + "alias = 65536\n",
    "a value of the wrong kind": HEAD + 'alias = "one"\n',
    "a word that is none of the choices": 'clock = "wrong"\n' + HEAD,
    "a duration without a unit": 'cycle = "5"\n' + HEAD,
    "a device without a type": "[[segment]]\n[[segment.device]]\nalias = 1\n",
    "a nested value out of range": HEAD + "[[segment.device.axis]]\nload.inertia = -1.0\n",
    "an event without a time": HEAD + '[[event]]\naction = "break"\ndevice = "tmcm-3315"\n',
    "a key of another action":
        HEAD + '[[event]]\nat = "1s"\naction = "power-off"\ndevice = "tmcm-3315"\nport = 1\n',
    "a bus with a text that is no bit rate":
        '[[bus]]\nbit_rate = "fast"\n[[bus.device]]\ntype = "tmcc160"\n',
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stator", required=True)
    arguments = parser.parse_args()
    printed = subprocess.run([arguments.stator, "check", "--schema"], check=True,
                             capture_output=True, text=True).stdout
    schema = json.loads(printed)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)

    failures = 0
    racks = sorted(RACKS.glob("*.toml"))
    assert racks, "there are no ready racks"
    for path in racks:
        with open(path, "rb") as file:
            for error in validator.iter_errors(tomllib.load(file)):
                failures += 1
                print(f"{path.name}: {'/'.join(map(str, error.path))}: {error.message[:300]}")
    for name, text in WRONG.items():
        if validator.is_valid(tomllib.loads(text)):
            failures += 1
            print(f"the schema allows {name}")
    print(f"{len(racks)} racks, {len(WRONG)} mistakes, {failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
