#!/usr/bin/python3
"""The pipelines of examples/ci, as far as that can be told without the CI systems they are for.

    pipelines.py --stator PROGRAM

Both have the same jobs; what these run is the shell's language, starts commands with options that `stator` has, and uses files
that stand beside; all versions are the project's. What the jobs do is tried by scripts and documents.
"""

import argparse
import pathlib
import re
import subprocess
import sys

import yaml
from documents import Help

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples" / "ci"
OF_GITLAB = ("variables",)  # what is no job at the top of its file
COMMAND = re.compile(r"(?<![\w./:_-])stator [a-z][^|&;>'\n]*")
VERSION = re.compile(r"stator[:_-](\d+\.\d+\.\d+)")
FILE = re.compile(r"(?<![\w/.$-])[a-z_]+\.(?:toml|c|py)\b")


def jobs_of_github(text):
    """Names of jobs, and the shell's lines of each."""
    jobs = yaml.safe_load(text)["jobs"]
    return {name: "\n".join(step["run"] for step in job["steps"] if "run" in step) for name, job in jobs.items()}


def jobs_of_gitlab(text):
    """The same of the other file, in which jobs extend what begins with a dot."""
    tops = {name: top for name, top in yaml.safe_load(text).items() if name not in OF_GITLAB}
    jobs = {}
    for name, top in tops.items():
        if not name.startswith("."):
            job = {**tops[top["extends"]], **top} if "extends" in top else top
            if "image" not in job:
                raise ValueError(f"the job {name} has no image")
            jobs[name] = "\n".join(job.get("before_script", []) + job["script"])
    return jobs


def mistakes(where, script, program):
    """Sentences about what is wrong with the script of a job."""
    read = subprocess.run(["bash", "-n", "-c", script], capture_output=True, text=True, check=False)
    if read.returncode:
        yield f"{where}: {read.stderr}"
    commands = COMMAND.findall(script.replace("\\\n", " "))
    if not commands and "pip install 'stator" not in script:
        yield f"{where}: does nothing with Stator"
    for command in commands:
        if wrong := program.wrong(command.strip()):
            yield f"{where}: {command.strip()}: {wrong}"
    for name in set(FILE.findall(script)):
        if not (FOLDER / name).exists():
            yield f"{where}: {name} is not in examples/ci"


def main():
    """Exit status 1 where something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stator", required=True, help="the program")
    program = Help(parser.parse_args().stator)
    texts = {name: (FOLDER / name).read_text(encoding="utf-8") for name in ("github.yml", "gitlab.yml")}
    pipelines = {"github.yml": jobs_of_github(texts["github.yml"]), "gitlab.yml": jobs_of_gitlab(texts["gitlab.yml"])}
    wrong = []
    for pipeline, jobs in pipelines.items():
        for name, script in jobs.items():
            wrong += mistakes(f"{pipeline}, job {name}", script, program)
    if list(pipelines["github.yml"]) != list(pipelines["gitlab.yml"]):
        wrong.append(f"the jobs differ: {', '.join(pipelines['github.yml'])}; {', '.join(pipelines['gitlab.yml'])}")
    header = (ROOT / "src" / "stator" / "version.hpp").read_text(encoding="utf-8")
    version = ".".join(re.findall(r"^#define STATOR_VERSION_\w+ (\d+)", header, re.MULTILINE))
    texts["docs/how-to/install.md"] = (ROOT / "docs/how-to/install.md").read_text(encoding="utf-8")
    for name, text in texts.items():
        wrong += [f"{name}: version {old}, not {version}" for old in set(VERSION.findall(text)) - {version}]
    print("\n".join(wrong) or f"{sum(map(len, pipelines.values()))} jobs in {len(pipelines)} pipelines are in order")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
