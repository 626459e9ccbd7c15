"""What of a document is run: its fenced blocks with the notes in front of them, and how output is compared.

A block of the language `sh` is run line by line. Notes are HTML comments, which no reader sees; those that are not
named here are none of ours. One that stands by itself:

    <!-- run: COMMANDS -->              done here, in the same shell; several lines are one command each

In front of a block, several where needed; PREFIXES are beginnings of command lines, with commas between them:

    <!-- not run: REASON -->            the block is left out
    <!-- not run (PREFIXES): REASON --> these lines are left out
    <!-- stays (PREFIXES) -->           these go on in the background, as `stator run` always does
    <!-- fails (PREFIXES) -->           these end with another exit status than 0
    <!-- keys q (PREFIXES) -->          these have a terminal, at which q is pressed
    <!-- file: NAME -->                 the block is the content of this file; of whatever language it is
    <!-- output -->                     the block is what the lines of the last block have said, those that have ended
    <!-- output of: PREFIX -->          the block is what the newest line that begins so and stays says
    <!-- output (varies: TEXTS) -->     the same; instead of each of TEXTS there may be anything without blanks
    <!-- input: COMMAND -->             the block is a dialogue with this program: lines behind a prompt are typed

COMMANDS may be those of a shell, and besides `stop`, which ends what stays, `heard TEXT`, which waits until something that
stays has said this, and `needed COMMAND # REASON`: where this fails, the machine cannot do what follows. A rack that is run
ends what stayed before.

Commands in the text, such as `stator run --http`, are looked at for names of commands and options that do not exist; those
that only tell something, such as `stator describe tmc8670 --inputs`, are run.

A block `text` with lines that begin with "$ " has commands and, below each, its output; the first of a dialogue is its
program. In output "..." is anything: lines when it stands alone, else a part of the line.
"""

import dataclasses
import itertools
import re

FENCE = re.compile(r"^( *)```+(\w*)")
NOTE = re.compile(r"<!--(.*?)-->", re.DOTALL)
OURS = re.compile(r"(run|not run|stays|fails|keys|file|output|input)\b *([^(:]*?)(?:\((.*?)\))?(?:: *(.*))?", re.DOTALL)
OTHER_NAMES = ("bash", "shell", "console", "shell-session")
SET_IN = re.compile(r"^(    |\t)\s*(\$ |sudo |stator [a-z])")
PROMPT = re.compile(r"^(?:\(stator\)|tmcl>) (.*)$")
IN_TEXT = re.compile(r"(?<!`)`(stator\s[^`]+)`")
TELLS = re.compile(
    r"stator (devices|faults|(describe|conformance|tune) [a-z0-9-]+|export \w+ [a-z0-9-]+|(check|test) --(keys|schema|reference|steps))\b"
)
HEAD = re.compile(r"# {2,}stator ")
PLACEHOLDER = re.compile(r"(^|\s)[A-Z]{3,}(\s|$)|\.\.\.")
RACK = re.compile(r"^(\S+=\S+ )*(.* )?(\S*/|\$)?stator run\b")
ELLIPSIS = "..."


class Mistake(Exception):
    """A document has what this cannot read."""


@dataclasses.dataclass(frozen=True)
class Step:
    """One thing to do, with the line of the document it stands on."""

    line: int
    kind: str  # "command", "left out", "file", "output", "dialogue"
    text: str  # the command; of what is left out, the reason; name of a file; what is expected
    block: int = 0  # the line at which the block begins that it is in
    content: str = ""  # of a file, a dialogue, what is left out; of output, whose it is
    varying: tuple = ()
    shown: bool = True  # the reader sees it
    stays: bool = False
    fails: bool = False
    keys: str = ""


@dataclasses.dataclass(frozen=True)
class Note:
    """A comment in front of a block."""

    kind: str
    argument: str
    prefixes: tuple
    text: str


def read_note(line, comment):
    """A comment as a note, or None if it is none of ours."""
    text = comment.strip()
    found = OURS.fullmatch(text)
    if not found:
        if re.match(r"(not run|stays|fails|keys|output)\b", text):
            raise Mistake(f"line {line}: no note of that form: {text}")
        return None
    kind, argument, prefixes, rest = found.groups(default="")
    return Note(kind, argument, tuple(prefix.strip() for prefix in prefixes.split(",") if prefix.strip()), rest.strip())


def begins(command, prefix):
    """Whether a command line begins so; blanks count as one."""
    return " ".join(command.split()).startswith(prefix)


def commands(lines):
    """Number and text of each command of a block: lines that end with a backslash go on."""
    begun, number = "", 0
    for index, line in enumerate(lines):
        if not begun:
            number = index
            if not line.strip() or line.lstrip().startswith("#"):
                continue
        begun += line
        if begun.endswith("\\"):
            begun += "\n"
            continue
        yield number, begun.strip()
        begun = ""
    if begun:
        raise Mistake(f"the last line of a block ends with a backslash: {begun.strip()}")


def stays_by_itself(command):
    """Whether a command goes on until it is ended: a rack that is run, and what has an ampersand behind it."""
    plain = command.split(" #")[0].strip()
    return plain.endswith("&") and not plain.endswith("&&") or bool(RACK.match(plain)) and "--help" not in plain


def command_step(line, block, command, notes):
    """The step of one command line of a block, as the notes in front of the block have it."""

    def noted(kind):
        for note in notes:
            if note.kind == kind and any(begins(command, prefix) for prefix in note.prefixes):
                return note
        return None

    if left_out := noted("not run"):
        return Step(line, "left out", left_out.text, block, content=command)
    keys = noted("keys")
    return Step(
        line,
        "command",
        command,
        block,
        stays=stays_by_itself(command) or bool(noted("stays")),
        fails=bool(noted("fails")),
        keys=keys.argument if keys else "",
    )


def transcript(line, lines, notes):
    """Steps of a block that has commands behind "$ " and their output below them."""
    pending, expected, where = None, [], line

    def finish():
        if pending is None:
            if any(text.strip() for text in expected):
                raise Mistake(f"line {line}: output stands above the first command")
            return
        if any(PROMPT.match(text) for text in expected):
            yield Step(where, "dialogue", pending, content="\n".join(expected))
            return
        yield command_step(where, where, pending, notes)
        yield Step(where, "output", "\n".join(expected), varying=varies(notes))

    for index, text in enumerate(lines):
        if text.startswith("$ "):
            yield from finish()
            pending, expected, where = text[2:].strip(), [], line + index + 1
        else:
            expected.append(text)
    yield from finish()


def varies(notes):
    """Texts of an output that may be otherwise."""
    for note in notes:
        if note.kind == "output":
            return tuple(prefix.removeprefix("varies:").strip() for prefix in note.prefixes)
    return ()


def block_steps(line, language, lines, notes):
    """Steps of one fenced block."""
    for note in notes:
        for prefix in note.prefixes if note.kind != "output" else ():
            if not any(begins(command, prefix) for _, command in commands(t.removeprefix("$ ") for t in lines)):
                raise Mistake(f"line {line}: no line of the block begins with {prefix!r}")
    if language in OTHER_NAMES:
        raise Mistake(f"line {line}: commands stand in blocks of sh, not of {language}")
    whole = {note.kind: note for note in notes if not note.prefixes or note.kind == "output"}
    if "not run" in whole:
        if not whole["not run"].text:
            raise Mistake(f"line {line}: a note says that the block is not run, but not why")
        yield Step(line, "left out", whole["not run"].text, content="\n".join(lines))
    elif "file" in whole:
        yield Step(line, "file", whole["file"].text, content="\n".join(lines) + "\n")
    elif "input" in whole:
        yield Step(line, "dialogue", whole["input"].text, content="\n".join(lines))
    elif language in ("", "text") and any(text.startswith("$ ") for text in lines):
        yield from transcript(line, lines, notes)
    elif "output" in whole:
        yield Step(line, "output", "\n".join(lines), content=whole["output"].text, varying=varies(notes))
    elif language == "sh":
        for number, command in commands(lines):
            yield command_step(line + number + 1, line, command, notes)
    elif notes:
        raise Mistake(f"line {line}: the notes in front of this block say nothing of a block of {language or 'text'!r}")


def read(text):
    """The steps of a document, in their order."""
    lines = text.split("\n")
    steps, notes, index = [], [], 0
    while index < len(lines):
        fence = FENCE.match(lines[index])
        if fence:
            end = index + 1
            while end < len(lines) and lines[end].strip() != "```":
                end += 1
            if end == len(lines):
                raise Mistake(f"line {index + 1}: this block has no end")
            body = [line.removeprefix(fence.group(1)) for line in lines[index + 1 : end]]
            steps += block_steps(index + 1, fence.group(2), body, notes)
            notes, index = [], end + 1
        elif lines[index].lstrip().startswith("<!--"):
            end = index
            while "-->" not in lines[end]:
                end += 1
                if end == len(lines):
                    raise Mistake(f"line {index + 1}: this comment has no end")
            for found in NOTE.finditer("\n".join(lines[index : end + 1])):
                note = read_note(index + 1, found.group(1))
                if note and note.kind == "run":
                    steps += (
                        Step(index + 1, "command", command, shown=False, stays=stays_by_itself(command))
                        for _, command in commands(note.text.split("\n"))
                    )
                elif note:
                    notes.append(note)
            index = end + 1
        else:
            if SET_IN.match(lines[index]):
                raise Mistake(f"line {index + 1}: commands stand in blocks of sh, not set in")
            if lines[index].strip() and notes:
                raise Mistake(f"line {index + 1}: a note stands above this line, but it is for a block")
            index += 1
    return steps


def tells(command):
    """Whether a command in the text is whole, needs nothing and ends by itself."""
    return bool(TELLS.match(command)) and not PLACEHOLDER.search(command)


def read_head(text):
    """The steps of a file that says in its head how it is used: commands stand behind "#", set in. Their interfaces are
    those of a machine with such cables; a master turns an axis for as long as somebody looks at it."""
    head = itertools.takewhile(lambda line: line.startswith("#"), text.split("\n"))
    written = [(number, line.removeprefix("#").strip()) for number, line in enumerate(head, 1) if HEAD.match(line)]
    interfaces = sorted({name for _, line in written for name in re.findall(r"ethercat:(\w+)", line)})
    steps = [Step(1, "command", f"cable {name} {name}-end", shown=False) for name in interfaces]
    for number, line in written:
        stays = stays_by_itself(line) or line.startswith("stator move --link")
        steps.append(Step(number, "command", line, block=1, stays=stays))
    return steps


def in_text(text):
    """Commands of the program that stand in the text between the blocks, with their lines."""
    inside, lines = False, []
    for line in text.split("\n"):
        fence = bool(FENCE.match(line))
        inside ^= fence
        lines.append("" if inside or fence else line)
    joined = "\n".join(lines)
    return [
        (joined.count("\n", 0, found.start()) + 1, " ".join(found.group(1).split()))
        for found in IN_TEXT.finditer(joined)
    ]


def line_pattern(line, varying):
    """What a line of output has to match: blanks count as one, "..." as anything."""
    line = " ".join(line.split())
    pieces = [ELLIPSIS, *varying]
    split = re.split("(" + "|".join(re.escape(piece) for piece in pieces) + ")", line)
    wild = {ELLIPSIS: ".*", **dict.fromkeys(varying, r"\S+")}
    return re.compile("".join(wild.get(piece, re.escape(piece)) for piece in split))


def difference(expected, output, varying=()):
    """None if the output is what is expected; otherwise the first line that is missing."""
    shown = [" ".join(line.split()) for line in output.strip("\n").split("\n")]
    wanted = expected.strip("\n").split("\n")
    chunks = [[]]
    for line in wanted:
        if line.strip() == ELLIPSIS:
            chunks.append([])
        else:
            chunks[-1].append(line_pattern(line, varying))
    place = 0
    for number, chunk in enumerate(chunks):
        first, last = number == 0, number == len(chunks) - 1
        if first:
            starts = [0]
        elif last and chunk:
            starts = [len(shown) - len(chunk)]
        else:
            starts = range(place, len(shown) + 1)
        best = 0
        for start in starts:
            matched = 0
            while matched < len(chunk) and 0 <= start + matched < len(shown) and start >= place:
                if not chunk[matched].fullmatch(shown[start + matched]):
                    break
                matched += 1
            best = max(best, matched)
            if matched == len(chunk):
                place = start + matched
                break
        else:
            return f"not among the output, or not at this place: {chunk[best].pattern}"
    if chunks[-1] and place != len(shown):
        return f"more output than expected: {shown[place]}"
    return None


def dialogue(content):
    """Lines that are typed, and those that are expected."""
    typed, expected = [], []
    for line in content.split("\n"):
        found = PROMPT.match(line)
        (typed if found else expected).append(found.group(1) if found else line)
    return typed, "\n".join(expected)
