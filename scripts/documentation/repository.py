"""Brings the repository's Markdown into the site, with all it links to.

docs/ is the site's root, everything else stands below repository/. A file that is no page gets one that shows it and
offers it; a folder gets one that lists its files. So a link of a Markdown file works on a forge and in the site alike.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

from .pages import plain

# Fenced code, code in a line, or the target of a link.
PARTS = re.compile(
    r"^(?P<fence>[ \t]*(?:```+|~~~+)).*?^(?P=fence)[ \t]*$|`+[^`]*`+|\]\((?P<target>[^)\s]+)\)", re.M | re.S
)
LANGUAGES = {
    ".c": "c", ".cpp": "cpp", ".h": "c", ".hpp": "cpp", ".js": "javascript", ".json": "json", ".py": "python",
    ".rs": "rust", ".toml": "toml", ".txt": "text", ".tmc": "text", ".csv": "text", ".xml": "xml",
}  # fmt: skip
ORPHAN = "---\norphan: true\n---\n"
IMAGES = (".png", ".svg")
# Longer ones are only offered: nobody reads a schema, and to colour one takes seconds.
SHOWN_BYTES = 60_000
# A folder of more files is listed without their pages.
LISTED_FILES = 60


class Repository:
    """Copies files of the repository into pages, once each."""

    def __init__(self, root, pages, generated):
        """`generated` are pages that are made otherwise, by the file of the repository they take the place of."""
        self.root = Path(root)
        self.pages = pages
        self.generated = generated
        self.missing = []
        self.done = set()
        self.tracked = subprocess.run(
            ["git", "ls-files"], cwd=root, check=True, capture_output=True, text=True
        ).stdout.splitlines()
        self.folders = {parent.as_posix() for path in self.tracked for parent in Path(path).parents}

    def place(self, path):
        """Where something of the repository stands in the site."""
        return path.removeprefix("docs/") if path.startswith("docs/") else f"repository/{path}"

    def add(self, path):
        """Brings a file or folder into the site; the file there to which links go, from the site's root."""
        target = self.place(path)
        if path in self.folders:
            target += "/index.md"
        elif not path.endswith((".md", *IMAGES)):
            target += ".md"
        if path not in self.done:
            self.done.add(path)
            if path in self.generated:
                pass
            elif path in self.folders:
                self._add_folder(path, target)
            elif path.endswith(IMAGES):
                self._copy(path)
            elif path.endswith(".md"):
                # What the navigation does not lead to is reached by links.
                head = "" if path.startswith("docs/") else ORPHAN
                self.pages.write(target.removesuffix(".md"), head + self.markdown(path))
            else:
                self._add_source(path, target)
        return target

    def markdown(self, path, content=None):
        """The text of a Markdown file, with its links as they must be in the site."""
        content = content or (self.root / path).read_text(encoding="utf-8")
        here = Path(path)

        def renew(match):
            target = match["target"]
            if target is None or re.match(r"[a-z]+:|#", target):
                return match[0]
            name, mark, anchor = target.partition("#")
            wanted = os.path.normpath(here.parent / name)
            if wanted not in self.folders and wanted not in self.tracked:
                line = content[: match.start()].count("\n") + 1
                self.missing.append(f"{path}:{line}: there is no {wanted}")
                return match[0]
            split = self.generated.get(wanted)
            if anchor and split and anchor in split:
                # What is one file on a forge may be several pages here.
                return f"]({os.path.relpath(split[anchor], Path(self.place(path)).parent)}.md)"
            reached = self.add(wanted)
            return f"]({os.path.relpath(reached, Path(self.place(path)).parent)}{mark}{anchor})"

        return PARTS.sub(renew, content)

    def _copy(self, path):
        copy = self.pages.folder / self.place(path)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(self.root / path, copy)
        return copy

    def _add_source(self, path, target):
        copy = self._copy(path)
        lines = [f"{ORPHAN}# {plain(path)}", "", f"{{download}}`Download <{copy.name}>`", ""]
        if copy.stat().st_size <= SHOWN_BYTES:
            language = LANGUAGES.get(copy.suffix, "text")
            lines += [f"```{{literalinclude}} {copy.name}", f":language: {language}", "```", ""]
        self.pages.write(target.removesuffix(".md"), "\n".join(lines))

    def _add_folder(self, path, target):
        files = [file for file in self.tracked if file.startswith(path + "/")]
        lines = [f"{ORPHAN}# {plain(path)}/", ""]
        for file in files:
            name = plain(file.removeprefix(path + "/"))
            if len(files) <= LISTED_FILES:
                lines.append(f"- [{name}]({os.path.relpath(self.add(file), Path(target).parent)})")
            else:
                lines.append(f"- {name}")
        self.pages.write(target.removesuffix(".md"), "\n".join(lines) + "\n")
