#!/usr/bin/env python3
"""Runs clang-tidy on the C++ files a change touches; any finding is an error.

  scripts/check_tidy.py [--build-dir DIR] [--base COMMIT] [--all] [--seconds N] [--jobs N]

The change is what differs from the merge base with origin/main, work tree included. On main itself
(a fresh clone) it is what the last ten commits touched, or every file where there are fewer. A
changed header is checked through one source file that includes it. --seconds bounds the time spent;
files left over are counted and named.

Checked are the folders that .ci/tidy-folders names: those that are clean and have to stay so. A
folder is added once `check_tidy.py --all` finds nothing in it; none is ever taken out.
"""

import argparse
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

COMMITS_ON_MAIN = 10
ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ROOT / ".ci" / "tidy-folders"


def git(*arguments):
    """Output lines of a git command; None if it failed."""
    done = subprocess.run(
        ["git", "-C", str(ROOT), *arguments], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False
    )
    return done.stdout.splitlines() if done.returncode == 0 else None


def find_base():
    """The commit to compare with; None means that every file is checked."""
    head = git("rev-parse", "HEAD")
    merge_base = git("merge-base", "HEAD", "origin/main")
    if merge_base and merge_base != head:
        return merge_base[0]
    earlier = git("rev-parse", f"HEAD~{COMMITS_ON_MAIN}")
    return earlier[0] if earlier else None


def without_includes(text):
    """`text` without what a move changes in it."""
    return [line for line in text.splitlines() if not line.startswith("#include ")]


def only_moved(base, old, new):
    """`new` is what `old` was in `base` but for lines with #include."""
    before = git("show", f"{base}:{old}")
    after = (ROOT / new).read_text(encoding="utf-8")
    return before is not None and without_includes("\n".join(before)) == without_includes(after)


def changed_files(base):
    """Paths, relative to the root, of files that differ from `base` or are new; not of those that
    have only moved."""
    if base is None:
        tracked = git("ls-files") or []
    else:
        rows = git("diff", "--name-status", "--find-renames", "-l0", "--diff-filter=d", base)
        if rows is None:
            sys.exit(f"scripts/check_tidy.py: git knows no commit '{base}'; name another with --base")
        tracked = []
        for status, *paths in (row.split("\t") for row in rows):
            if not (status.startswith("R") and (ROOT / paths[1]).exists() and only_moved(base, *paths)):
                tracked.append(paths[-1])
    untracked = git("ls-files", "--others", "--exclude-standard") or []
    return sorted({f for f in tracked + untracked if f.endswith((".cpp", ".hpp")) and (ROOT / f).exists()})


def clean_folders():
    """Folders, relative to the root, in which every finding is an error."""
    lines = FOLDERS.read_text(encoding="utf-8").splitlines()
    return [line.strip().rstrip("/") + "/" for line in lines if line.strip() and not line.startswith("#")]


def included_headers(source):
    """Names of the project's headers that `source` includes, also through others."""
    found, left = set(), [ROOT / source]
    while left:
        text = left.pop().read_text(encoding="utf-8")
        for name in set(re.findall(r'#include "([^"]+)"', text)) - found:
            found.add(name)
            left += [path for folder in ("src", "tests") if (path := ROOT / folder / name).exists()]
    return found


def sources_to_check(files, compiled):
    """Compiled sources that show every file of `files`: itself, or one source including the header."""
    chosen = {f for f in files if f in compiled}
    includes = {source: included_headers(source) for source in sorted(compiled)}
    unseen = []
    for header in (f for f in files if f.endswith(".hpp")):
        name = header.split("/", 1)[1] if "/" in header else header
        users = [s for s in includes if name in includes[s]]
        own = header[: -len(".hpp")] + ".cpp"
        if own in compiled:
            chosen.add(own)
        elif users:
            if not chosen & set(users):
                chosen.add(users[0])
        else:
            unseen.append(header)
    return sorted(chosen), unseen


def run_tidy(source, build_dir, deadline):
    """(source, exit status, output); exit status None if the time was over."""
    left = deadline - time.monotonic()
    if left <= 0:
        return source, None, ""
    command = ["clang-tidy", "--quiet", "--warnings-as-errors=*", "-p", str(build_dir), source]
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=left, check=False)
    except subprocess.TimeoutExpired:
        return source, None, ""
    return source, done.returncode, done.stdout + (done.stderr if done.returncode else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--build-dir",
        type=Path,
        default=ROOT / "build" / "release",
        help="a configured build folder (its compile_commands.json is used)",
    )
    parser.add_argument("--base", help="compare with this commit")
    parser.add_argument("--all", action="store_true", help="check every source file")
    parser.add_argument("--seconds", type=float, default=900.0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()

    database = options.build_dir / "compile_commands.json"
    if not database.exists():
        sys.exit(f"scripts/check_tidy.py: {database} is missing; run: cmake --preset release")
    compiled = set()
    for entry in json.loads(database.read_text(encoding="utf-8")):
        path = Path(entry["directory"], entry["file"]).resolve()
        if path.is_relative_to(ROOT) and path.exists():
            compiled.add(str(path.relative_to(ROOT)))

    base = None if options.all else options.base or find_base()
    changed = changed_files(base)
    folders = tuple(clean_folders())
    files = [f for f in changed if f.startswith(folders)]
    if len(files) < len(changed):
        print(
            f"clang-tidy: {len(changed) - len(files)} changed files lie outside the folders of "
            f"{FOLDERS.relative_to(ROOT)} and are not checked"
        )
    sources, unseen = sources_to_check(files, {c for c in compiled if c.startswith(folders)})
    for header in unseen:
        print(f"{header}: not checked, no compiled source includes it")

    deadline = time.monotonic() + options.seconds
    failed, late = [], []
    with concurrent.futures.ThreadPoolExecutor(max_workers=options.jobs) as pool:
        jobs = [pool.submit(run_tidy, s, options.build_dir, deadline) for s in sources]
        for job in concurrent.futures.as_completed(jobs):
            source, status, output = job.result()
            if status is None:
                late.append(source)
            elif status != 0:
                failed.append(source)
                print(output, flush=True)
    for source in sorted(late):
        print(f"{source}: not checked, {options.seconds:.0f} s were over")
    print(
        f"clang-tidy: {len(sources) - len(late)} of {len(sources)} sources checked "
        f"(changes since {base[:10] if base else 'the beginning'}), {len(failed)} with findings"
    )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
