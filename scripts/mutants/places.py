"""Where a source can be changed, and how it looks with every change in it, asleep.

Each place is rewritten once into an expression that is the original unless the one mutant in
question is awake (mutant schemata): so one compilation serves all mutants of a file, and each costs a
run of tests only. Rewriting inserts no line breaks; a compiler's complaint names the original's line.
"""

import re
from dataclasses import dataclass, field

from source_text import ASSIGNMENTS, SourceText

# operator: (its function object, what replaces it)
COMPARISONS = {"<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"], "==": ["!="], "!=": ["=="]}
ARITHMETIC = {
    "+": ["-"],
    "-": ["+"],
    "*": ["/"],
    "/": ["*"],
    "%": ["*"],
    "&": ["|"],
    "|": ["&"],
    "^": ["|"],
    "<<": [">>"],
    ">>": ["<<"],
}
REPLACED = {**COMPARISONS, **ARITHMETIC}
FUNCTION = {
    "<": "Less",
    "<=": "LessEqual",
    ">": "Greater",
    ">=": "GreaterEqual",
    "==": "Equal",
    "!=": "NotEqual",
    "+": "Plus",
    "-": "Minus",
    "*": "Times",
    "/": "Divide",
    "%": "Modulo",
    "&": "And",
    "|": "Or",
    "^": "Xor",
    "<<": "ShiftLeft",
    ">>": "ShiftRight",
}
ASSIGNED = {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "&=": "|=", "|=": "&=", "<<=": ">>=", ">>=": "<<="}

# What has no run time, and what only people read: the values in an event's text.
UNEVALUATED = {"sizeof", "decltype", "alignof", "noexcept", "EventArgument"}
DECLARATIONS = {"constexpr", "static_assert", "using", "typedef", "friend", "template", "asm"}
NOT_A_STATEMENT = {
    "if",
    "for",
    "while",
    "switch",
    "return",
    "break",
    "continue",
    "case",
    "default",
    "else",
    "do",
    "throw",
    "delete",
    "new",
    "goto",
    "auto",
    "const",
    "static",
    "constexpr",
    "using",
    "unsigned",
    "int",
    "bool",
    "double",
    "float",
    "try",
    "catch",
    "char",
    "long",
    "struct",
    "class",
    "co_return",
    "static_assert",
    "typename",
}
NO_DIFFERENCE = {"reserve", "shrink_to_fit"}
PLAIN_NUMBER = re.compile(
    r"(?:0[xX][\da-fA-F']+|[\d']+)[uUlLzZ]*"
    r"|(?:[\d']+\.[\d']*|\.\d+)(?:[eE][-+]?\d+)?[fF]?"
)


@dataclass
class Place:
    """One place: its extent in the text, how it is rewritten, and the changes it offers."""

    start: int
    end: int
    kind: str
    changes: list
    operator: tuple = None  # extent of the operator that the rewriting replaces
    is_constexpr: bool = False
    identities: list = field(default_factory=list)  # numbers of the mutants, one per change


def find_places(text):
    """Every place of a C++ source in the order of its text."""
    source = SourceText(text)
    places = []
    for body in source.bodies:
        found = _Finder(source, body).places
        for place in found:
            place.is_constexpr = body.is_constexpr
        places += found
    return sorted(places, key=lambda place: (place.start, -place.end))


class _Finder:
    def __init__(self, source, body):
        self.source, self.body = source, body
        self.tokens = source.tokens
        self.places = []
        self.hidden = self._hidden()
        for i in range(body.first + 1, body.last):
            if i not in self.hidden:
                self._look_at(i)

    def _hidden(self):
        """Indices of tokens that are not changed."""
        hidden = set()
        tokens, source = self.tokens, self.source
        for i in range(self.body.first + 1, self.body.last):
            text = tokens[i].text
            if text == "<" and source.opens(i) or text == "[" and tokens[i + 1].text == "[":
                hidden.update(range(i, source.partner[i] + 1))
            elif text == "case":
                last = i
                while tokens[last].text != ":":
                    last += 1
                hidden.update(range(i, last))
            elif text == "constexpr" and tokens[i - 1].text == "if":
                hidden.update(range(i + 1, source.partner[i + 1] + 1))
            elif text in DECLARATIONS:
                hidden.update(range(i, source.end_of_statement(i)))
            elif text in UNEVALUATED | NO_DIFFERENCE and tokens[i + 1].text in ("(", "{"):
                hidden.update(range(i, source.partner[i + 1] + 1))
            elif text == "const" and self._is_fixed(i):
                hidden.update(range(i, source.end_of_statement(i)))
        return hidden

    def _is_fixed(self, i):
        """Whether a declaration `const T name = value` gives a value that the compiler knows."""
        end = self.source.end_of_statement(i)
        names = [t.text for t in self.tokens[i:end] if t.kind == "name"]
        texts = [t.text for t in self.tokens[i:end]]
        if "=" not in texts and "{" not in texts:
            return False
        value = texts.index("=") if "=" in texts else texts.index("{")
        values = [t.text for t in self.tokens[i + value : end] if t.kind == "name"]
        return bool(names) and all(re.fullmatch(r"k[A-Z]\w*|std|true|false", v) for v in values)

    def _add(self, first, last, kind, changes, operator=None):
        self.places.append(
            Place(
                self.tokens[first].start,
                self.tokens[last].end,
                kind,
                changes,
                (self.tokens[operator].start, self.tokens[operator].end) if operator else None,
            )
        )

    def _look_at(self, i):
        token = self.tokens[i]
        if token.kind == "number" and PLAIN_NUMBER.fullmatch(token.text):
            self._add(i, i, "constant", [_other_value(token.text)])
        elif token.text in ("true", "false"):
            self._add(i, i, "constant", ["false" if token.text == "true" else "true"])
        elif token.text in ("if", "while") and self.tokens[i + 1].text == "(":
            self._condition(token.text, i + 1)
        elif token.text == "?" and token.spaced:
            first = self.source.left_operand(i, 0.5)
            if first is not None:
                self._add(first, i - 1, "condition", ["true", "false"])
        elif self.source.binary_precedence(i) is not None:
            self._operation(i)
        if self.source.enclosing[i] == "{" and (self.tokens[i - 1].text in (";", "{", "}") or self._follows_a_head(i)):
            self._statement(i)

    def _follows_a_head(self, i):
        """Whether the token stands where a statement of `if (...)` without braces begins."""
        before = i - 1
        if self.tokens[before].text == "else":
            return True
        return (
            self.tokens[before].text == ")"
            and self.source.closes(before)
            and self.tokens[self.source.partner[before] - 1].text in ("if", "for", "while")
        )

    def _condition(self, word, opening):
        closing = self.source.partner[opening]
        first = opening + 1
        for i in range(opening + 1, closing):
            if self.tokens[i].text == ";":
                first = i + 1
        if first >= closing or any(token.text in ASSIGNMENTS for token in self.tokens[first:closing]):
            return
        self._add(first, closing - 1, "condition", ["true", "false"] if word == "if" else [None, "false"])

    def _operation(self, i):
        text = self.tokens[i].text
        if text not in REPLACED and text not in ("&&", "||"):
            return
        precedence = self.source.binary_precedence(i)
        first = self.source.left_operand(i, precedence)
        last = self.source.right_operand(i, precedence)
        if first is None or last is None:
            return
        if text in ("&&", "||"):
            self._add(first, last, "logical", ["||" if text == "&&" else "&&"], i)
        elif not any(self.tokens[j].kind == "string" for j in range(first, last + 1)):
            self._add(first, last, "operation", REPLACED[text], i)

    def _statement(self, first):
        tokens, source = self.tokens, self.source
        if (
            tokens[first].text in NOT_A_STATEMENT
            or tokens[first].kind != "name"
            and tokens[first].text not in ("++", "--", "*")
        ):
            return
        i = first + (tokens[first].kind != "name")
        while (
            tokens[i].kind == "name"
            or tokens[i].text in ("::", ".", "->")
            or source.opens(i)
            and tokens[i].text in "([<"
        ):
            if tokens[i].kind == "name" and i > first and (tokens[i - 1].kind == "name" or source.closes(i - 1)):
                return  # a declaration
            i = source.partner[i] + 1 if source.opens(i) else i + 1
        assigned = tokens[i].text in ASSIGNMENTS
        if not assigned and not (
            tokens[i].text == ";" and (tokens[i - 1].text == ")" or tokens[first].text in ("++", "--"))
        ):
            return
        end = source.end_of_statement(i)
        if tokens[end].text != ";" or NO_DIFFERENCE & {t.text for t in tokens[first:end]}:
            return
        self._add(first, end, "statement", ["nothing"])
        if tokens[i].text in ASSIGNED:
            self._add(first, end - 1, "assignment", [ASSIGNED[tokens[i].text]], i)


def _other_value(text):
    plain = text.replace("'", "").rstrip("uUlLzZfF") if not text.startswith(("0x", "0X")) else text
    if plain in ("0", "1"):
        return "1" if plain == "0" else "0"
    return f"{text} + 1"


def rewrite(text, places, header):
    """`text` with every place of `places` guarded; `header` is included first."""
    inserted = []  # (offset, order, text)

    def around(place, before, after):
        # Of two with one extent, the one that replaces its operator is within the other.
        depth = 1 if place.operator else 2 if place.kind == "constant" else 0
        inserted.append((place.start, (1, -place.end, depth), before))
        inserted.append((place.end, (0, -place.start, -depth), after))

    replaced = []
    for place in places:
        number = place.identities[0]
        original = text[slice(*place.operator)] if place.operator else None
        if place.kind == "constant":
            around(place, f"::mutant::constant<{number}>(", ")")
        elif place.kind == "condition":
            around(place, f"::mutant::condition<{number}>(static_cast<bool>(", "))")
        elif place.kind == "statement":
            around(place, f"if (!::mutant::skips<{number}>()) {{ ", " }")
        elif place.kind == "operation":
            functions = ", ".join(f"::mutant::{FUNCTION[c]}" for c in place.changes)
            around(place, f"::mutant::operate<{number}, ::mutant::{FUNCTION[original]}, {functions}>(", ")")
            replaced.append((place.operator, ","))
        elif place.kind == "logical":
            swapped = f"::mutant::swaps<{number}>()"
            around(place, "(((static_cast<bool>(", f") != {swapped})) != {swapped})")
            replaced.append((place.operator, f") != {swapped}) {original} (static_cast<bool>("))
        else:
            left = text[place.start : place.operator[0]]
            right = text[place.operator[1] : place.end]
            inserted.append(
                (
                    place.start,
                    (1, -place.end, 1),
                    f"if (::mutant::swaps<{number}>()) {{ {_one_line(left)}"
                    f"{place.changes[0]}{_one_line(right)}; }} else ",
                )
            )
    changes = [(offset, order, offset, new) for offset, order, new in inserted]
    changes += [(start, (2, 0, 0), end, new) for (start, end), new in replaced]
    result, at = [f'#include "{header}" // NOLINT\n#line 1\n'], 0
    for start, _, end, new in sorted(changes, key=lambda change: change[:2]):
        result += [text[at:start], new]
        at = end
    return "".join(result) + text[at:]


def _one_line(text):
    return re.sub(r"\s+", " ", re.sub(r"//[^\n]*", "", text))
