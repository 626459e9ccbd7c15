#!/usr/bin/env python3
"""The JSON schemas of rack files and scenarios, in the hands of a validator as editors have one.

Ready racks and scenarios must be valid, and what `stator check` and `stator test` refuse for a key, a type or a range
must not be. The schema of scenarios refers to that of rack files, which lies beside it.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tomllib
import warnings

from running_rack import unavailable

try:
    import jsonschema
except ImportError as error:
    unavailable(str(error), "scripts/setup test installs what is needed")

ROOT = pathlib.Path(__file__).resolve().parents[2]

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
    "a key of another action": HEAD + '[[event]]\nat = "1s"\naction = "power-off"\ndevice = "tmcm-3315"\nport = 1\n',
    "a bus with a text that is no bit rate": '[[bus]]\nbit_rate = "fast"\n[[bus.device]]\ntype = "tmcc160"\n',
}


STEP = 'product = "tmcm-3315"\n[[step]]\n'
WRONG_SCENARIOS = {
    "a key nobody knows": 'colour = "red"\n' + STEP + 'do = "scan"\n',
    "a step without a kind": STEP + 'note = "nothing"\n',
    "a kind of step that there is not": STEP + 'do = "wiat"\n',
    "a step without what it needs": STEP + 'do = "wait"\n',
    "a key of another step": STEP + 'do = "wait"\ntime = "1s"\ntarget = 5\n',
    "a value out of range": STEP + 'do = "enable"\naxis = 6\n',
    "a state of no network": STEP + 'do = "expect-state"\nstate = "asleep"\n',
    "a key of another event": STEP + 'do = "power-off"\ndevice = "tmcm-3315"\nport = 1\n',
    "a fault that there is not": STEP + 'do = "inject"\nfault = { kind = "moon" }\n',
    "a fault as a name where a table belongs": STEP + 'do = "inject"\nfault = "jam"\n',
    "a rack with a key nobody knows": '[rack]\ncolour = "red"\n[[rack.segment]]\n[[rack.segment.device]]\n'
    'type = "tmcm-3315"\n[[step]]\ndo = "scan"\n',
}


def schema_of(stator, command):
    schema = json.loads(
        subprocess.run([stator, command, "--schema"], check=True, capture_output=True, text=True).stdout
    )
    jsonschema.Draft7Validator.check_schema(schema)
    return schema


def failures_of(validator, folder, wrong):
    """How many good files are not valid, and wrong ones are."""
    failures = 0
    files = sorted((ROOT / folder).glob("*.toml"))
    assert files, f"there are no ready {folder}"
    for path in files:
        with open(path, "rb") as file:
            for error in validator.iter_errors(tomllib.load(file)):
                failures += 1
                print(f"{path.name}: {'/'.join(map(str, error.path))}: {error.message[:300]}")
    for name, text in wrong.items():
        if validator.is_valid(tomllib.loads(text)):
            failures += 1
            print(f"the schema of {folder} allows {name}")
    print(f"{len(files)} {folder}, {len(wrong)} mistakes, {failures} failures")
    return failures


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stator", required=True)
    arguments = parser.parse_args()
    racks, scenarios = (schema_of(arguments.stator, command) for command in ("check", "test"))
    warnings.simplefilter("ignore", DeprecationWarning)  # what replaces it is not everywhere yet
    beside = jsonschema.RefResolver("scenario.schema.json", scenarios, store={"rack-file.schema.json": racks})
    failures = failures_of(jsonschema.Draft7Validator(racks), "racks", WRONG)
    failures += failures_of(jsonschema.Draft7Validator(scenarios, resolver=beside), "scenarios", WRONG_SCENARIOS)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
