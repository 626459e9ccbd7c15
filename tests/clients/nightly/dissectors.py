#!/usr/bin/python3
"""tshark's dissectors over whole conversations of masters with devices: nothing malformed, every refusal shown as
what it is.

    dissectors.py DIRECTORY      with the captures that tests leave there (STATOR_CLIENT_CAPTURES)
"""

import collections
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from running_rack import unavailable  # noqa: E402

LINKTYPE_ETHERNET = 1
REFUSALS = {"0x06010002", "0x06020000", "0x06090011", "0x06090030"}
ERRORS = 0x00800000  # of dissectors; they warn of every frame with a source address like SOEM's 01-01-01-01-01-01


def tshark(path, *words):
    done = subprocess.run(["tshark", "-n", "-r", str(path), *words], text=True, capture_output=True, check=False)
    assert done.returncode == 0, f"{path}: {done.stderr}"
    return done.stdout.splitlines()


def link_type(path):
    return int.from_bytes(path.read_bytes()[20:24], "little")


def check(path):
    """What was in it, by name; what must not be in it is an assertion."""
    ethernet = link_type(path) == LINKTYPE_ETHERNET
    options = [] if ethernet else ["-d", "can.subdissector,canopen"]
    wrong = tshark(path, *options, "-Y", f"_ws.malformed || _ws.expert.severity >= {ERRORS}")
    assert not wrong, f"{path}: {len(wrong)} frames that tshark does not understand:\n" + "\n".join(wrong[:20])
    protocols = collections.Counter()
    for line in tshark(path, *options, "-T", "fields", "-e", "frame.protocols"):
        protocols[line] += 1
    field = "ecat_mailbox.coe.abortcode" if ethernet else "canopen.sdo.abort_code"
    aborts = collections.Counter(
        code for line in tshark(path, *options, "-T", "fields", "-e", field, "-Y", field) for code in line.split(",")
    )
    return protocols, aborts


def main():
    if shutil.which("tshark") is None:
        unavailable("tshark is missing", "scripts/setup nightly installs it")
    captures = sorted(pathlib.Path(sys.argv[1]).glob("*.pcap"))
    assert captures, f"no captures in {sys.argv[1]}"
    protocols, aborts = collections.Counter(), collections.Counter()
    for path in captures:
        more = check(path)
        protocols += more[0]
        aborts += more[1]
    for name, count in sorted(protocols.items()):
        print(f"{count:8} {name}")
    print("aborts:", dict(aborts))
    missing = REFUSALS - set(aborts)
    assert not missing, f"tshark shows no abort {missing}"


if __name__ == "__main__":
    main()
