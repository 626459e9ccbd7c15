"""What the mutation campaign has to know of a C++ source: tokens, brackets, operands, bodies.

It is no parser. It relies on the layout that .clang-format enforces: a binary operator has white space
on both sides; unary operators, declarators and template brackets have not.
"""

import re
from dataclasses import dataclass

TOKEN = re.compile(
    r"""
    (?P<skip>\s+|//[^\n]*|/\*.*?\*/|(?<=\n)\#(?:[^\n\\]|\\.|\\\n)*|\A\#[^\n]*)
  | (?P<string>(?:u8|[uUL])?(?:R"(?P<tag>[^\s()\\]{0,16})\(.*?\)(?P=tag)"|"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)+'))
  | (?P<number>\.?\d(?:'?[\w.]|(?<=[eEpP])[+-])*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<operator><=>|<<=|>>=|\.\.\.|->\*|::|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)
""",
    re.VERBOSE | re.DOTALL,
)

PRECEDENCE = {
    "*": 10,
    "/": 10,
    "%": 10,
    "+": 9,
    "-": 9,
    "<<": 8,
    ">>": 8,
    "<=>": 7.5,
    "<": 7,
    "<=": 7,
    ">": 7,
    ">=": 7,
    "==": 6,
    "!=": 6,
    "&": 5,
    "^": 4,
    "|": 3,
    "&&": 2,
    "||": 1,
}
ASSIGNMENTS = {"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="}
STATEMENT_WORDS = {"return", "co_return", "case", "throw", "else", "do", "delete", "goto"}
NOT_BEFORE_A_BRACED_VALUE = {"else", "do", "try", "const", "noexcept", "override", "final"}


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    start: int
    end: int
    spaced: bool  # white space on both sides


@dataclass(frozen=True)
class Body:
    """A function's body: indices of its braces; constexpr ones may run in the compiler only."""

    first: int
    last: int
    is_constexpr: bool


class SourceText:
    """Tokens of one file; `partner` maps each bracket, template brackets included, to its other, and
    `enclosing` tells the innermost bracket around each token."""

    def __init__(self, text):
        self.text = text
        self.tokens = list(self._tokens())
        self.partner = {}
        self.enclosing = []
        self._match_templates()
        self._match_brackets()
        self.bodies = []
        self._find_bodies(0, len(self.tokens))

    def line(self, offset):
        return self.text.count("\n", 0, offset) + 1

    def _tokens(self):
        for match in TOKEN.finditer(self.text):
            kind, start, end = match.lastgroup, match.start(), match.end()
            if kind == "tag":
                kind = "string"
            if kind == "skip":
                continue
            before = self.text[start - 1 : start].isspace()
            after = self.text[end : end + 1].isspace()
            if match.group() == ">>" and not before:  # closes two templates
                yield Token(kind, ">", start, start + 1, False)
                yield Token(kind, ">", start + 1, end, False)
            else:
                yield Token(kind, match.group(), start, end, before and after)

    def _match_templates(self):
        for i, token in enumerate(self.tokens):
            if token.text != "<" or token.spaced or i in self.partner or i == 0:
                continue
            if self.tokens[i - 1].kind != "name":
                continue
            depth, opened = 0, []
            for j in range(i, len(self.tokens)):
                text = self.tokens[j].text
                if text == "<" and not self.tokens[j].spaced:
                    opened.append(j)
                    depth += 1
                elif (
                    text == ">"
                    and not self.tokens[j].spaced
                    or text == ">"
                    and depth
                    and self.text[self.tokens[j].start - 1] not in " \n"
                ):
                    first = opened.pop()
                    self.partner[first], self.partner[j] = j, first
                    depth -= 1
                    if depth == 0:
                        break
                elif text in (";", "{"):
                    break

    def _match_brackets(self):
        closing = {")": "(", "]": "[", "}": "{"}
        opened = []
        for i, token in enumerate(self.tokens):
            self.enclosing.append(self.tokens[opened[-1]].text if opened else "")
            if token.kind == "operator" and token.text in "([{":
                opened.append(i)
            elif token.kind == "operator" and token.text in closing:
                if not opened or self.tokens[opened[-1]].text != closing[token.text]:
                    raise ValueError(f"line {self.line(token.start)}: '{token.text}' closes nothing")
                first = opened.pop()
                self.partner[first], self.partner[i] = i, first

    def opens(self, i):
        return self.partner.get(i, -1) > i

    def closes(self, i):
        return i in self.partner and self.partner[i] < i

    def is_braced_value(self, opening):
        """Whether `{` begins `Type{...}` and not a block."""
        before = self.tokens[opening - 1] if opening else None
        return before is not None and (
            before.kind == "name"
            and before.text not in NOT_BEFORE_A_BRACED_VALUE
            or before.text == ">"
            and self.closes(opening - 1)
        )

    def binary_precedence(self, i):
        """Precedence of the binary operator at `i`; None if there is none."""
        token = self.tokens[i]
        if token.kind == "operator" and token.spaced and i not in self.partner:
            return PRECEDENCE.get(token.text)
        return None

    def _ends_operand(self, i):
        token = self.tokens[i]
        return (
            token.kind == "operator"
            and (token.text in (",", ";", "?", ":") or token.text in ASSIGNMENTS)
            or token.kind == "name"
            and token.text in STATEMENT_WORDS
        )

    def left_operand(self, operator, precedence):
        """Index of the first token of the left operand; None if it cannot be told."""
        i = operator - 1
        while i >= 0:
            if self.closes(i):
                opening = self.partner[i]
                if self.tokens[i].text == "}" and not self.is_braced_value(opening):
                    break
                i = opening - 1
                continue
            if self.opens(i) or self._ends_operand(i):
                break
            found = self.binary_precedence(i)
            if found is not None and found < precedence:
                break
            i -= 1
        return i + 1 if i + 1 < operator else None

    def right_operand(self, operator, precedence):
        """Index of the last token of the right operand; None if it cannot be told."""
        i = operator + 1
        while i < len(self.tokens):
            if self.opens(i):
                i = self.partner[i] + 1
                continue
            if self.closes(i) or self._ends_operand(i):
                break
            found = self.binary_precedence(i)
            if found is not None and found <= precedence:
                break
            i += 1
        return i - 1 if i - 1 > operator else None

    def end_of_statement(self, i):
        """Index of the `;` that ends the statement at `i`, blocks in between jumped over; of the
        bracket around it if there is none."""
        while self.tokens[i].text != ";" and not self.closes(i):
            i = self.partner[i] + 1 if self.opens(i) else i + 1
        return i

    def _find_bodies(self, i, end):
        while i < end:
            head = []
            while i < end and self.tokens[i].text not in ("{", ";"):
                head.append(self.tokens[i].text)
                if self.opens(i):
                    i = self.partner[i]
                    head.append(self.tokens[i].text)
                i += 1
            if i < end and self.tokens[i].text == "{":
                i = self._enter(head, i)
            i += 1

    def _enter(self, head, opening):
        """Deals with what a brace opens after `head`; the index of the last token it took."""
        closing = self.partner[opening]
        kinds = {"class", "struct", "union"}
        if "namespace" in head or kinds & set(head) and "(" not in head:
            self._find_bodies(opening + 1, closing)
            return closing
        if "enum" in head or "(" not in head or "=" in head and "operator" not in head:
            return self.end_of_statement(opening)
        while self.is_braced_value(opening) and ":" in head:  # a member's initialiser
            following = closing + 1
            while self.tokens[following].text != "{":
                following = self.partner[following] if self.opens(following) else following
                following += 1
            opening, closing = following, self.partner[following]
        self.bodies.append(Body(opening, closing, bool({"constexpr", "consteval"} & set(head))))
        return closing
