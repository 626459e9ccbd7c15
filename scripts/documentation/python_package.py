"""Pages of the package for Python, made of its sources and of the stub of its extension module, which nobody runs."""

import ast
import re
import textwrap

from .pages import contents, plain

FOLDER = "python"
MODULES = ("stator", "stator.can", "stator.pytrinamic", "stator.mcap", "stator.pytest_plugin", "stator.gymnasium")
#: What a heading of a docstring in Google's style is in the pages.
SECTIONS = {"Args": "Arguments", "Attributes": "Attributes", "Raises": "Raises", "Returns": "Returns"}


def markdown(docstring):
    """A docstring's reStructuredText, as far as the package uses it, as Markdown."""
    lines, verbatim = [], False
    for line in textwrap.dedent(docstring).strip().split("\n"):
        section = re.fullmatch(r"(\w+):", line)
        if section and section.group(1) in SECTIONS:
            lines += [f"**{SECTIONS[section.group(1)]}**", ""]
            verbatim = True
        elif verbatim and (entry := re.match(r"    (\*{0,2}[\w, ]+): (.*)", line)):
            lines.append(f"- `{entry.group(1)}`: {entry.group(2)}")
        elif verbatim and line.startswith("    "):
            lines.append("  " + line.strip())
        elif line.startswith("    "):
            lines.append(line)
        else:
            verbatim = verbatim and not line
            lines.append(line)
    text = "\n".join(lines)
    text = re.sub(r":\w+:`~?(?:stator\.)?([^`]+)`", r"`\1`", text)
    return re.sub(r"``([^`]+)``", r"`\1`", text)


def documented(text):
    """The docstring of a tree as Markdown; in a stub it may be missing."""
    words = ast.get_docstring(text) if not isinstance(text, str) else text
    return markdown(words) if words else ""


def signature(function, name):
    """A function's head, in the words of its source."""
    arguments = ast.unparse(function.args)
    arguments = re.sub(r"^self(, /)?(, )?|^cls(, )?", "", arguments)
    result = f" -> {ast.unparse(function.returns)}" if function.returns else ""
    return f"{'await ' if isinstance(function, ast.AsyncFunctionDef) else ''}{name}({arguments}){result}"


def is_property(function):
    """It is read like an attribute."""
    return any(isinstance(each, ast.Name) and each.id == "property" for each in function.decorator_list)


def is_setter(function):
    """It is the other half of a property."""
    return any(isinstance(each, ast.Attribute) for each in function.decorator_list)


def members(tree):
    """Functions of a class that people call."""
    functions = [each for each in tree.body if isinstance(each, ast.FunctionDef | ast.AsyncFunctionDef)]
    return [
        each
        for each in functions
        if not is_setter(each) and (each.name == "__getitem__" or not each.name.startswith("_"))
    ]


def section_of_class(name, tree):
    """A class with its members."""
    constructor = next((e for e in tree.body if isinstance(e, ast.FunctionDef) and e.name == "__init__"), None)
    head = signature(constructor, name).partition(" -> ")[0] if constructor else name
    lines = [f"## {name}", "", "```python", f"class {head}", "```", "", documented(tree), ""]
    for each in members(tree):
        head = each.name
        if is_property(each):
            head += f": {ast.unparse(each.returns)}" if each.returns else ""
        elif each.name == "__getitem__":
            head = signature(each, "").replace("(", "[", 1).replace(")", "]", 1)
        else:
            head = signature(each, each.name)
        lines += [f"### {plain(name)}.{plain(each.name)}", "", "```python", head, "```", "", documented(each), ""]
    return lines


def section_of(name, tree):
    """A class, a function or a constant."""
    if isinstance(tree, ast.ClassDef):
        return section_of_class(name, tree)
    if isinstance(tree, ast.FunctionDef | ast.AsyncFunctionDef):
        return [f"## {name}", "", "```python", signature(tree, name), "```", "", documented(tree), ""]
    return [f"## {name}", "", "```python", ast.unparse(tree), "```", ""]


def anchor(name):
    """Of a heading, as Sphinx makes it."""
    return name.lower().replace("_", "-")


class Package:
    """The package's sources, and the stub of the extension module."""

    def __init__(self, root, stub):
        """`root`: the folder with stator/; `stub`: the file _native.pyi."""
        self.root = root
        self.trees = {"stator._native": ast.parse(stub.read_text(encoding="utf-8"))}

    def tree(self, module):
        """The syntax of a module."""
        if module not in self.trees:
            path = self.root.joinpath(*module.split("."))
            path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
            self.trees[module] = ast.parse(path.read_text(encoding="utf-8"))
        return self.trees[module]

    def find(self, module, name):
        """Where a name that a module has is declared, or None: it is no class, function or constant of the package."""
        for each in self.tree(module).body:
            if isinstance(each, ast.ImportFrom) and any((a.asname or a.name) == name for a in each.names):
                parts = module.split(".")
                is_package = self.root.joinpath(*parts).is_dir()
                base = parts if is_package else parts[:-1]
                base = base[: len(base) - (each.level - 1)] if each.level else []
                target = ".".join([*base, *([each.module] if each.module else [])])
                return self.find(target, name) if target.startswith("stator") else None
            if isinstance(each, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and each.name == name:
                return each
            if isinstance(each, ast.Assign) and any(isinstance(t, ast.Name) and t.id == name for t in each.targets):
                return each
        return None

    def public(self, module):
        """Names that a module offers: those of __all__, else its fixtures and functions without underscore."""
        for each in self.tree(module).body:
            if isinstance(each, ast.Assign) and ast.unparse(each.targets[0]) == "__all__":
                return [ast.literal_eval(one) for one in each.value.elts if isinstance(one, ast.Constant)]
        return [
            each.name
            for each in self.tree(module).body
            if isinstance(each, ast.FunctionDef) and not each.name.startswith(("_", "pytest_"))
        ]


def write(root, stub, pages):
    """A page for each public module of the package below `root`, and one that leads to them."""
    package = Package(root, stub)
    names = []
    for module in MODULES:
        page = f"{FOLDER}/{module}"
        lines = [f"# {plain(module)}", "", documented(package.tree(module)), ""]
        for name in package.public(module):
            tree = package.find(module, name)
            if tree is not None and not name.startswith("_"):
                lines += section_of(name, tree)
                pages.entry(f"{module}.{name}", "Python", page, anchor(name))
        pages.write(page, "\n".join(lines))
        names.append(page)
    lines = [
        "# Python reference",
        "",
        "How the package is used is told in [Stator in Python](../how-to/python.md).",
        "",
    ]
    lines += [f"- [{plain(page.partition('/')[2])}]({page.partition('/')[2]}.md)" for page in names]
    pages.write(f"{FOLDER}/index", "\n".join(lines) + "\n\n" + contents(names))
