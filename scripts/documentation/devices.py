"""Pages of what devices have: objects, parameters, registers, signals, inputs, quirks, by `stator describe`."""

import json
import subprocess

from .pages import contents, plain, slug, table, text

# Of an object dictionary, by the first digit of the index.
AREAS = (("1", "1000h to 1FFFh: communication"), ("2345", "2000h to 5FFFh: the maker's own"),
         ("6789", "6000h to 9FFFh: profile"), ("ABCDEF", "A000h and on"))  # fmt: skip

# What there is to say, and where the document says it.
REMARKS = ("notes", "source", "source_line")
# Pages behind that of a device, in the order of the navigation.
BEHIND = ("objects", "parameters", "registers", "mfc", "peripherals", "signals", "decisions", "requirements")
# The columns below which they stand.
WIDE = ("field", "name", "reply")


class Device:
    """A product, and what the program says of it."""

    def __init__(self, name, stator, pages):
        """`name` as `stator devices` lists it."""
        self.name = name
        self.title = name.upper() if name.startswith("tm") else name.capitalize()
        self.stator = stator
        self.pages = pages

    def described(self, *options):
        """What `stator describe` lists; None where the device has nothing of the kind."""
        command = [self.stator, "describe", self.name, *options, "--format", "json"]
        answer = subprocess.run(command, capture_output=True, text=True, check=False)
        if answer.returncode == 0:
            return json.loads(answer.stdout)
        if not answer.stderr.startswith("stator: "):
            raise RuntimeError(f"{' '.join(command)}: status {answer.returncode}: {answer.stderr}")
        return None

    def page(self, kind):
        """The name of a page of this device."""
        return f"devices/{self.name}-{kind}"

    def rows(self, kind, page, columns, listed, named):
        """A table of `listed`, with the search finding what `named` makes of a row: its anchor and name."""
        made = []
        anchors = set()
        for row in listed:
            anchor, name = named(row)
            # Fields of one register stand in several rows, of which the first has the anchor.
            if anchor in anchors:
                anchor = None
            else:
                anchors.add(anchor)
                self.pages.entry(f"{name} ({self.title})", kind, page, anchor)
            cells = [text(value(row) if callable(value) else row.get(value, "")) for value in columns.values()]
            # Long words have no column of their own, which would be narrow and far to the right.
            notes, source = row.get("notes"), row.get("source") or row.get("source_line")
            if remark := " ".join(filter(None, (notes, source and f"({source})"))):
                place = next(number for number, value in enumerate(columns.values()) if value in WIDE)
                cells[place] += f'<div class="remark">{text(remark)}</div>'
            made.append((anchor, cells))
        return table(columns, made)

    def objects(self):
        """The object dictionary, or parameters and commands of a TMCL module."""
        listed = self.described()
        if listed is None:
            return
        if isinstance(listed, dict):
            self.parameters(listed)
            return
        page = self.page("objects")
        lines = [
            f"# Objects of the {self.title}",
            "",
            f"What `stator describe {self.name}` lists; its CSV and JSON formats are for programs.",
            "",
        ]
        columns = {
            "Object": lambda row: f"{row['index']}h:{row['subindex']}", "Name": "name", "Type": "data_type",
            "Access": "access", "PDO": "pdo_mapping", "Default": "default", "Range": span, "Unit": "unit",
        }  # fmt: skip
        for digits, area in AREAS:
            if rows := [row for row in listed if row["index"][0] in digits]:
                lines += [
                    f"## {area}",
                    "",
                    self.rows(
                        "object",
                        page,
                        columns,
                        rows,
                        lambda row: (
                            f"{row['index'].lower()}h-{row['subindex'].lower()}",
                            f"{row['index']}h:{row['subindex']} {row['name']}",
                        ),
                    ),
                ]
        self.pages.write(page, "\n".join(lines))

    def parameters(self, listed):
        """Axis parameters, global parameters and commands of a TMCL module."""
        page = self.page("parameters")
        lines = [f"# Parameters and commands of the {self.title}", "", f"What `stator describe {self.name}` lists.", ""]
        for part, rows in listed.items():
            word = part.rstrip("s").replace("_", " ")
            columns = {name.replace("_", " ").capitalize(): name for name in rows[0] if name not in REMARKS}
            lines += [
                f"## {part.replace('_', ' ').capitalize()}",
                "",
                self.rows(
                    "parameter",
                    page,
                    columns,
                    rows,
                    lambda row, word=word: (
                        slug(" ".join(filter(None, (word, row.get("bank"), row["number"])))),
                        " ".join(
                            filter(None, (word, row.get("bank"), row["number"], row.get("name") or row.get("mnemonic")))
                        ),
                    ),
                ),
            ]
        self.pages.write(page, "\n".join(lines))

    def registers(self, kind, title, option, address):
        """Registers field by field; the first field of one carries its anchor."""
        listed = self.described(option)
        if listed is None:
            return
        page = self.page(kind)
        columns = {
            "Address": address, "Bits": bits, "Register": lambda row: row["name"], "Field": "field",
            "Bus": "access_ecat", "Host": "access_pdi", "Reset": "reset",
        }  # fmt: skip
        lines = [
            f"# {title} of the {self.title}",
            "",
            f"What `stator describe {self.name} {option}` lists. "
            "[What the columns mean](../how-to/registers.md#rights).",
            "",
            self.rows(
                "register", page, columns, listed, lambda row: (slug(address(row)), f"{address(row)} {row['name']}")
            ),
        ]
        self.pages.write(page, "\n".join(lines))

    def signals(self):
        """What can be recorded, what can be set, and how it can be made to misbehave."""
        page = self.page("signals")
        lines = [f"# Signals, inputs and quirks of the {self.title}", ""]
        for kind, option, heading, columns in (
            ("signal", "--signals", "Signals: what can be recorded and plotted", {"Signal": "signal", "Unit": "unit"}),
            (
                "input",
                "--inputs",
                "Inputs: what can be set around it",
                {"Input": "input", "Range": span, "Unit": "unit"},
            ),
            (
                "quirk",
                "--quirks",
                "Quirks: what it can do otherwise than it should",
                {"Quirk": "quirk", "Parameter": "parameter", "What it does": "summary", "Whom it traps": "trap"},
            ),
        ):
            if rows := self.described(option):
                lines += [
                    f"## {heading}",
                    "",
                    f"What `stator describe {self.name} {option}` lists.",
                    "",
                    self.rows(
                        kind, page, columns, rows, lambda row, kind=kind: (slug(f"{kind} {row[kind]}"), row[kind])
                    ),
                ]
        self.pages.write(page, "\n".join(lines))

    def write(self):
        """All pages of what the device has."""
        self.objects()
        self.registers("registers", "Registers", "--registers", lambda row: row["address"].removeprefix("0x") + "h")
        self.registers("mfc", "Registers of the I/O block", "--mfc", lambda row: f"MFC {row['number']}")
        self.signals()


def span(row):
    """The range of a value."""
    return f"{row['minimum']} … {row['maximum']}" if row["minimum"] or row["maximum"] else ""


def bits(row):
    """The bits of a field."""
    return row["bit_hi"] if row["bit_hi"] == row["bit_lo"] else f"{row['bit_hi']}:{row['bit_lo']}"


def products(stator):
    """Names of the products with what they are and how they are reached."""
    listing = subprocess.run([stator, "devices"], check=True, capture_output=True, text=True).stdout
    for line in listing.splitlines()[1:]:
        name, rest = line.split(None, 1)
        what, _, reached = rest.rpartition("  ")
        yield name, what.strip(), reached.strip()


def write(stator, pages):
    """The pages of every device and a list of them."""
    lines = ["# Devices", "", "| Device | What it is | Reached over |", "|---|---|---|"]
    listed = list(products(stator))
    for name, what, reached in listed:
        device = Device(name, stator, pages)
        device.write()
        lines.append(f"| [{device.title}]({name}.md) | {plain(what)} | {plain(reached)} |")
    pages.write("devices/index", "\n".join(lines) + "\n\n" + contents(f"devices/{name}" for name, _, _ in listed))
    for name, _, _ in listed:
        page = f"devices/{name}"
        behind = [f"{page}-{kind}" for kind in BEHIND if f"{page}-{kind}" in pages.names]
        path = pages.folder / f"{page}.md"
        heading = "\n\n## More about it\n\n" + "".join(
            f"- [{pages.title(one)}]({one.removeprefix('devices/')}.md)\n" for one in behind
        )
        path.write_text(path.read_text(encoding="utf-8").rstrip() + heading + "\n" + contents(behind), encoding="utf-8")
