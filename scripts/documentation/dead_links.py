"""Finds links between the files of a site that lead nowhere."""

import os
import re
from html import unescape
from pathlib import Path
from urllib.parse import unquote

LINK = re.compile(r"<[a-zA-Z][^<>]*?\s(?:href|src)=(?:\"([^\"]*)\"|'([^']*)')")
ANCHOR = re.compile(r"<[a-zA-Z][^<>]*?\s(?:id|name)=(?:\"([^\"]*)\"|'([^']*)')")
SHEET_LINK = re.compile(r"url\(\s*[\"']?([^\"')]+)")
ELSEWHERE = re.compile(r"[a-zA-Z][a-zA-Z0-9+.-]*:|//")


def either(match):
    """What stands between quotes of either kind."""
    return unescape(match[1] if match[1] is not None else match[2])


def dead_links(site, entries=()):
    """How many links there are, and a sentence for each that is dead, also of what the search is to find."""
    site = Path(site).resolve()
    texts = {path: path.read_text(encoding="utf-8") for path in sorted(site.rglob("*.html"))}
    anchors = {path: {either(match) for match in ANCHOR.finditer(page)} for path, page in texts.items()}
    links = {path: {either(match) for match in LINK.finditer(page)} for path, page in texts.items()}
    for path in sorted(site.rglob("*.css")):
        links[path] = {match[1] for match in SHEET_LINK.finditer(path.read_text(encoding="utf-8"))}
    count = 0
    dead = []
    for path, leads_to in links.items():
        for link in sorted(leads_to):
            if ELSEWHERE.match(link):
                continue
            count += 1
            name, _, anchor = link.partition("#")
            name = unquote(name.partition("?")[0])
            target = Path(os.path.normpath(path.parent / name)) if name else path
            if not target.is_relative_to(site):
                dead.append(f"{path.relative_to(site)}: {link} is outside")
            elif not target.is_file():
                dead.append(f"{path.relative_to(site)}: {link}: there is no such file")
            elif anchor and target in anchors and unquote(anchor) not in anchors[target]:
                dead.append(f"{path.relative_to(site)}: {link}: there is no such anchor")
    for name, _, page, anchor in entries:
        count += 1
        if anchor not in anchors.get(site / f"{page}.html", ()):
            dead.append(f"search: {name}: there is no {page}.html#{anchor}")
    return count, dead
