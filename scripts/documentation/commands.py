"""Pages of the program's commands, made of the help that it prints."""

import re
import subprocess

from .pages import contents, plain, table, text

HEADINGS = ("Positionals:", "Options:", "Subcommands:")
RELATION = re.compile(r"\s*(Excludes|Needs): ((?:(?!Excludes:|Needs:).)*)")
# The column in which the program's help begins to explain.
COLUMN = 30


class Help:
    """What `stator COMMAND --help` says, taken apart."""

    def __init__(self, printed):
        """`printed`: the whole text."""
        self.summary, _, rest = printed.partition("\n")
        self.usage = ""
        self.parts = {heading: [] for heading in HEADINGS}
        after = []
        heading = None
        for line in rest.splitlines():
            if line.startswith("Usage: "):
                self.usage = line.removeprefix("Usage: ")
            elif line in HEADINGS:
                heading = line
            elif heading and line.startswith("  "):
                name, words = line[:COLUMN].strip(), line[COLUMN:].strip()
                if name and len(line) > COLUMN and line[COLUMN - 1] != " ":
                    name, words = line.strip(), ""
                if name:
                    self.parts[heading].append([name, words])
                else:
                    last = self.parts[heading][-1]
                    last[1] = f"{last[1]} {words}".strip()
            elif line:
                heading = None
                after.append(line)
            elif after:
                after.append(line)
        self.after = "\n".join(after).strip()

    def subcommands(self):
        """Names of the commands below this one."""
        return [name for name, _ in self.parts["Subcommands:"]]


def apart(name):
    """How an option is spelled, which values it takes, and what else the program says of it."""
    spelling, _, details = name.partition(" ")
    words = []
    if found := RELATION.search(details):
        words = [
            f"{relation.lower()} {others.strip().replace(' ', ', ')}" for relation, others in RELATION.findall(details)
        ]
        details = details[: found.start()]
    if "REQUIRED" in details:
        details = details.replace("REQUIRED", "")
        words.append("required")
    values = re.sub(r"^[A-Z]+:(?=[A-Z{])", "", details.strip())
    return spelling, values.replace(" ...", ", several"), "; ".join(words).replace("excludes", "not with")


def anchor_of(name):
    """Where a page has an option or positional."""
    return re.split(r"[ ,]", name)[-1 if name.startswith("-h,") else 0].lstrip("-").split(":")[0]


def page(command, parsed, root, pages):
    """The page of one command; its name in the site."""
    words = ["stator", *command]
    name = "commands/" + "-".join(command)
    lines = [f"# {' '.join(words)}", "", plain(parsed.summary) + ".", "", "```text", parsed.usage, "```", ""]
    for heading in HEADINGS[:2]:
        rows = []
        for option, meaning in parsed.parts[heading]:
            spelling, values, remark = apart(option)
            anchor = f"{heading[:-2].lower()}-{anchor_of(option)}"
            rows.append(
                (
                    anchor,
                    [
                        f"<code>{text(spelling)}</code>",
                        text(values),
                        "; ".join(filter(None, (text(meaning), text(remark)))),
                    ],
                )
            )
            if heading == "Options:" and spelling != "-h,--help":
                pages.entry(f"{spelling} ({' '.join(words)})", "option", name, anchor)
        if rows:
            lines += [f"## {heading[:-1]}", "", table(("Name", "Value", "Meaning"), rows)]
    if below := parsed.parts["Subcommands:"]:
        lines += ["## Subcommands", ""]
        lines += [
            f"- [{' '.join([*words, below_name])}]({'-'.join([*command, below_name])}.md): {plain(meaning)}"
            for below_name, meaning in below
        ] + [""]
        lines.append(contents([f"{name}-{below_name}" for below_name, _ in below]))
    # Commands that have nothing of their own to say end with what the program says.
    if parsed.after and parsed.after != root.after:
        lines += ["## Examples and notes", "", "```text", parsed.after, "```", ""]
    pages.write(name, "\n".join(lines))


def write(stator, pages):
    """Writes a page of each command and one that lists them."""

    def asked(command):
        return Help(subprocess.run([stator, *command, "--help"], check=True, capture_output=True, text=True).stdout)

    root = asked([])
    waiting = [[name] for name in root.subcommands()]
    listed = []
    while waiting:
        command = waiting.pop(0)
        parsed = asked(command)
        page(command, parsed, root, pages)
        if len(command) == 1:
            listed.append((command[0], parsed.summary))
        waiting += [[*command, name] for name in parsed.subcommands()]
    rows = [
        (None, [f'<a href="{name}.html"><code>stator {name}</code></a>', text(summary)]) for name, summary in listed
    ]
    pages.write(
        "commands/index",
        "# Commands\n\nWhat `stator COMMAND --help` says, command by command.\n\n"
        + table(("Command", "What it does"), rows)
        + "\n"
        + contents([f"commands/{name}" for name, _ in listed]),
    )
