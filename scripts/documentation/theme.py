"""Makes the theme's files what they are elsewhere than in Debian 12, and work without a web server.

Debian packs Furo's sources: its script is a module, which a browser takes from no file, and imports another; its style
sheet imports one of the web server's, and has lost the rule that takes dark colours where the reader's system is dark.
"""

import re
from pathlib import Path

NORMALIZE = "/javascript/normalize.css/normalize.css"
DARK = re.compile(r'body\[data-theme="dark"\] {([^}]*--color-background-primary[^}]*)}')


def make_whole(static):
    """Puts what script and style sheet import into them; `static` is the site's folder _static."""
    scripts = Path(static) / "scripts"
    if not (scripts / "gumshoe-patched.js").exists():
        return  # Not Debian's: Furo as its makers pack it.
    spy = (scripts / "gumshoe-patched.js").read_text(encoding="utf-8")
    lines = (scripts / "furo.js").read_text(encoding="utf-8").splitlines(keepends=True)
    rest = "".join(line for line in lines if not line.startswith("import "))
    (scripts / "furo.js").write_text(f"{spy}\n{rest}", encoding="utf-8")
    sheet = Path(static) / "styles/furo.css"
    text = sheet.read_text(encoding="utf-8")
    if NORMALIZE in text:
        normal = Path(f"/usr/share{NORMALIZE}").read_text(encoding="utf-8")
        text = text.replace(f"@import url({NORMALIZE});", normal)
    if "prefers-color-scheme" not in text:
        colours = DARK.search(text)[1]
        text += f'\n@media (prefers-color-scheme: dark) {{\n  body[data-theme="auto"] {{{colours}}}\n}}\n'
    sheet.write_text(text, encoding="utf-8")
