#!/usr/bin/env python3
"""Makes the generated parts of docs/devices/.

    scripts/device_pages.py           write <device>-requirements.md and the tables of each device
    scripts/device_pages.py --check   fail if a page is not what would be written

A device's own page, <device>.md, is written by people. The page of requirements has every requirement of
tests/data/<device>/requirements.csv in words, block by block, with its status and tests from
docs/conformance/<device>.csv. A table is what `stator describe` prints: the object
dictionary of a product, <device>-objects.md, its parameters and commands, <device>-parameters.md,
the registers of a bare slave controller, <device>-registers.md, or what can be wired to the pins of
an I/O chip, <device>-peripherals.md.
"""

import argparse
import csv
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# What the column "Done" says; only `open` is still to come.
MARKS = {"done": "yes", "simplified": "simplified", "left-out": "left out", "open": "not yet"}


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def requirements_page(device):
    """Every requirement of a device's document, and what became of it."""
    requirements = read_rows(ROOT / "tests/data" / device / "requirements.csv")
    status = {row["id"]: row for row in read_rows(ROOT / "docs/conformance" / f"{device}.csv")}
    counts = dict.fromkeys(MARKS, 0)
    for row in status.values():
        counts[row["status"]] += 1
    lines = [
        f"# Requirements of the {device.upper()}",
        "",
        "Made by `scripts/device_pages.py` from the rows whose columns are explained [here](../conformance/README.md); "
        f"what the device is stands on [its own page]({device}.md). `L...` are line numbers of the plain text of its document.",
        "",
        f"{len(requirements)} requirements: {counts['done']} done, {counts['open']} not yet; "
        f"{counts['simplified']} simplified and {counts['left-out']} left out for good, for the "
        "reasons in their notes.",
    ]
    block = None
    for requirement in requirements:
        if requirement["block"] != block:
            block = requirement["block"]
            lines += ["", f"## {block}", "", "| ID | Requirement | Done | Tests, notes |", "|---|---|---|---|"]
        row = status[requirement["id"]]
        tests = ", ".join(f"`{test}`" for test in row["tests"].replace(";", " ").split())
        remark = "; ".join(part for part in (tests, row["note"]) if part)
        text = requirement["requirement"].replace("|", "\\|")
        lines.append(
            f"| {requirement['id']} | {text} ({requirement['source']}) | "
            f"{MARKS[row['status']]} | {remark.replace('|', chr(92) + '|')} |"
        )
    return "\n".join(lines) + "\n"


def describe(device, stator, *options):
    """The table of `device` as `stator describe` prints it, and the command without its format."""
    command = ["describe", device, *options]
    table = subprocess.run(
        [stator, *command, "--format", "markdown"], check=True, capture_output=True, text=True
    ).stdout
    return table, "stator " + " ".join(command)


def products(stator):
    """Names of the devices that run."""
    listing = subprocess.run([stator, "devices"], check=True, capture_output=True, text=True).stdout
    return {line.split()[0] for line in listing.splitlines()[1:]}


def product_page(device, stator):
    """What the tables of a product are and their page; None if it has none."""
    try:
        table, command = describe(device, stator)
    except subprocess.CalledProcessError as error:
        if "has no object dictionary" not in error.stderr:
            raise
        return None
    # An object dictionary is one table, a TMCL module has several with headings.
    if table.startswith("## "):
        return "parameters", (
            f"# Parameters and commands of the {device.upper()}\n\nMade by `{command} --format markdown`.\n\n{table}"
        )
    return "objects", (
        f"# Objects of the {device.upper()}\n\n"
        f"Made by `{command} --format markdown`; the CSV and JSON formats\n"
        f"also carry the place in the device's document and notes.\n\n{table}"
    )


def registers_page(device, stator):
    """The registers of a bare slave controller, in the reading that is its default; None if the
    device is none."""
    try:
        table, command = describe(device, stator, "--registers")
    except subprocess.CalledProcessError:
        return None
    return (
        f"# Registers of the {device.upper()}\n\n"
        f"Made by `{command} --format markdown`; the CSV and JSON formats\n"
        f"also carry the place in the device's document. "
        f"[What the columns mean](../how-to/registers.md#rights).\n\n{table}"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    parser.add_argument(
        "--stator", default=str(ROOT / "build/release/src/cli/stator"), help="the stator program (default: %(default)s)"
    )
    arguments = parser.parse_args()
    stale = []
    running = products(arguments.stator)
    for status in sorted((ROOT / "docs/conformance").glob("*.csv")):
        device = status.stem
        page = ROOT / "docs/devices" / f"{device}.md"
        if not page.exists():
            sys.exit(
                f"docs/devices/{device}.md is missing, but docs/conformance/{device}.csv is there; write what the device is"
            )
        wanted = {page.with_name(f"{device}-requirements.md"): requirements_page(device)}
        if device in running and (made := product_page(device, arguments.stator)):
            kind, table = made
            wanted[page.with_name(f"{device}-{kind}.md")] = table
        # Of a product that is a slave controller itself the registers have a page beside the objects.
        registers = page.with_name(f"{device}-registers.md")
        if device not in running or registers.exists():
            if table := registers_page(device, arguments.stator):
                wanted[registers] = table
            elif registers.exists():
                sys.exit(f"stator describe {device} --registers fails, but its page is there")
        peripherals = page.with_name(f"{device}-peripherals.md")
        if peripherals.exists():
            table, command = describe(device, arguments.stator, "--peripherals")
            wanted[peripherals] = (
                f"# Peripherals at the pins of a {device.upper()}\n\n"
                f"Made by `{command} --format markdown`. "
                f"[How to wire them](../how-to/board-at-the-pins.md).\n\n{table}"
            )
        for path, text in wanted.items():
            if path.exists() and path.read_text(encoding="utf-8") == text:
                continue
            if arguments.check:
                stale.append(str(path.relative_to(ROOT)))
            else:
                path.write_text(text, encoding="utf-8")
                print(f"wrote {path.relative_to(ROOT)}")
    if stale:
        sys.exit("not up to date: " + ", ".join(stale) + "; run scripts/device_pages.py")


if __name__ == "__main__":
    main()
