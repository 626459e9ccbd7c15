#!/usr/bin/env python3
"""Writes what an installed package tells of itself - name, version, entry points - beside the package of a build directory,
so that pytest and python-can find it there as if it were installed.

    distribution_info.py PYPROJECT VERSION FOLDER
"""

import sys
import tomllib
from pathlib import Path


def main() -> None:
    project_file, version, folder = sys.argv[1:]
    project = tomllib.loads(Path(project_file).read_text())["project"]
    place = Path(folder) / f"{project['name']}-{version}.dist-info"
    place.mkdir(parents=True, exist_ok=True)
    (place / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {version}\n")
    groups = project["entry-points"] | {"console_scripts": project["scripts"]}
    (place / "entry_points.txt").write_text(
        "".join(
            f"[{group}]\n" + "".join(f"{name} = {target}\n" for name, target in entries.items())
            for group, entries in groups.items()
        )
    )


if __name__ == "__main__":
    main()
