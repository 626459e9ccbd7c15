#!/usr/bin/python3
"""Starts racks on state directories, and replays recordings, that were damaged by seed or made by somebody hostile.

    hostile.py --stator PROGRAM [--count 300] [--seed 1] [--jobs 4] [--only PART]... [--limit 1.0] [--factor 5]

PART is a part of KIND:DAMAGE, see --list. Each must be refused in a second with a sentence that names the file, in
printable characters, with exit status 1 or 2 (a recording that was cut: 3); or mean nothing: what the devices then
hold is what they held at some moment before, and replays come to the same end. Never more than 200 MB of memory, no
change of what lies outside, nothing left over. --limit is for a quiet machine, --factor for how much slower this
one may be. Exit status 1 if anything else happened. Needs root, for device nodes. --case N repeats one.
"""

import argparse
import collections
import contextlib
import multiprocessing
import os
import pathlib
import random
import re
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback

import damage
from ethercat_host import Refused
from kept_devices import (
    BUS,
    SERIAL_MODULE,
    TMCC160,
    Firmware,
    SerialTmcm142,
    Sii,
    Tmc8670Parameters,
    Tmcc160Parameters,
    segment,
)
from kept_model import KeptModel
from rack_process import Gone, RackProcess, Silent, own_address

MEMORY = 200 << 20
CASES_OF_A_TEMPLATE = 40
SEGMENT = segment("tmc8461", "tmc8670", "tmcm-3315") + SERIAL_MODULE
# A rack, and the files of which device is there for what: (file, device, position).
RACKS = {
    "segment": (
        SEGMENT,
        [
            ("tmc8461.eeprom", Sii, 0),
            ("tmc8670.eeprom", Sii, 1),
            ("tmcm-3315.eeprom", Sii, 2),
            ("tmc8670.parameters", Tmc8670Parameters, 1),
            ("tmcm-3315.firmware", Firmware, 2),
            ("module.parameters", SerialTmcm142, 0),
        ],
    ),
    "node": (BUS + TMCC160, [("tmcc160.parameters", Tmcc160Parameters, 0)]),
}


class Rack:
    def __init__(self, address):
        self.address = address


class Template:
    """A directory with kept files, every state its devices were in, and a recording of how they came there."""

    def __init__(self, program, kind, rng, directory):
        self.kind = kind
        text, parts = RACKS[kind]
        self.state = directory / "template"
        self.recording = directory / "template.stator"
        self.rack_file = directory / "rack.toml"
        self.rack_file.write_text(text.format(address=own_address()), encoding="ascii")
        self.devices = {name: device(Rack(own_address()), at) for name, device, at in parts}
        self.histories = {}
        with RackProcess(program, str(self.rack_file), str(directory), "--state", str(self.state)) as process:
            self.work(rng, range(12))
            process.end(rng.choice((signal.SIGINT, signal.SIGKILL)))
        shutil.copytree(self.state, directory / "recorded")
        with RackProcess(
            program,
            str(self.rack_file),
            str(directory),
            "--state",
            str(directory / "recorded"),
            "--record",
            str(self.recording),
        ) as process:
            for device in self.devices.values():
                device.connect()
                device.read(rng)
                device.close()
            process.end()

    def work(self, rng, numbers):
        for name, device in self.devices.items():
            device.connect()
            model = KeptModel()
            model.compare(device.read(random.Random(0.9)))
            history = [dict(model.cells)]
            orders = device.orders(rng)
            outcome = None
            for _ in numbers:
                changes, give = orders.send(outcome)
                model.order(changes)
                patiently(give)
                model.answered()
                history.append(dict(model.cells))
                outcome = True
            while orders.gi_frame is not None and "module" in name and outcome:
                changes, give = orders.send(True)  # until no program is being loaded
                if all(not cell.startswith("instruction") for cell in changes) and changes:
                    break
                if changes:
                    model.order(changes)
                    give()
                    model.answered()
                    history.append(dict(model.cells))
                else:
                    give()
            self.histories[name] = history
            device.close()
        time.sleep(0.4)  # what is written behind an answer


def patiently(give):
    """An order that is refused while the memory is still busy with the one before."""
    for _ in range(50):
        with contextlib.suppress(Refused):
            return give()
        time.sleep(0.01)
    return give()


class Outcome:
    """What the program did: `status` None if it had to be killed."""

    def __init__(self):
        self.status = None
        self.seconds = self.memory = 0
        self.said = b""


def limits():
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class Started(Exception):
    pass


def run(command, patience, directory, until=None):
    """Runs the command to its end, or until it says `until`: then Started is raised with the process."""
    outcome = Outcome()
    said = directory / "said"
    with said.open("wb") as errors:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors, preexec_fn=limits
        )
    begin = time.monotonic()
    output = b""
    stream = process.stdout.fileno()
    while (left := begin + patience - time.monotonic()) > 0 and select.select([stream], [], [], left)[0]:
        data = os.read(stream, 65536)
        output += data
        if until is not None and until in output:
            raise Started(process)
        if not data:
            break
    outcome.seconds = time.monotonic() - begin
    alive = outcome.seconds >= patience
    if alive:
        process.kill()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    process.stdout.close()
    outcome.status = None if alive else process.returncode
    outcome.memory = usage.ru_maxrss << 10
    outcome.said = output + said.read_bytes()
    return outcome


class Case:
    """One damaged directory or recording, and what is wrong with what became of it."""

    def __init__(self, options, template, directory, rng):
        self.options = options
        self.template = template
        self.directory = directory
        self.rng = rng
        self.outside = directory / "outside"
        self.outside.mkdir()
        (self.outside / "secret").write_bytes(damage.SECRET)
        self.faults = []
        self.verdict = "?"

    def patience(self):
        return self.options.limit * self.options.factor

    # Judging

    def judge_refusal(self, outcome, names, statuses):
        said = outcome.said
        if outcome.status is None:
            self.faults.append(f"still running after {outcome.seconds:.1f} s")
            return
        if outcome.status not in statuses:
            self.faults.append(f"exit status {outcome.status}")
        if outcome.memory > MEMORY:
            self.faults.append(f"took {outcome.memory >> 20} MB")
        try:
            text = said.decode("utf-8")
        except UnicodeDecodeError:
            self.faults.append("says bytes that are no UTF-8")
            text = said.decode("utf-8", "replace")
        if any(ord(letter) < 32 and letter != "\n" or 0x7F <= ord(letter) < 0xA0 for letter in text):
            self.faults.append("says control characters")
        failure = re.split("^stator: ", text.strip(), flags=re.MULTILINE)[-1]
        if not any(name in failure for name in names):
            self.faults.append(f"its failure does not name {names[0]}")
        if self.faults:
            self.faults.append(f"it said: {ascii(text[-400:])}")

    def judge_outside(self):
        content = {
            each.name: each.read_bytes() for each in self.outside.iterdir() if each.is_file() and each.name != "moved"
        }
        if content != {"secret": damage.SECRET}:
            self.faults.append(f"changed what lies outside: {sorted(content)}")
        if (self.outside / "secret").stat().st_mode & 0o777 != 0o644:
            self.faults.append("changed the mode of what lies outside")

    # State directories

    def try_state(self, kind, name):
        state = self.directory / "state"
        shutil.copytree(self.template.state, state)
        hit = state / name
        if kind == "temporary":
            hit = state / f"{name}.new"
        elif kind == "lock":
            hit = state / "lock"
        elif kind == "directory":
            hit = state
        function = damage.DAMAGES[self.name]
        function(hit, self.rng, self.outside)
        command = [self.options.stator, "run", str(self.template.rack_file), "--state", str(state)]
        try:
            self.judge_refusal(
                run(command, self.patience(), self.directory, b"Running;"), (hit.name, name, str(state)), (1, 2)
            )
            self.verdict = "refused"
        except Started as started:
            self.verdict = "started"
            self.judge_run(started.args[0], function, kind, name)
        self.judge_outside()
        if kind == "directory" and sum(each.name.startswith("foreign") for each in state.iterdir()) != 300:
            self.faults.append("deleted foreign files")

    def judge_run(self, process, function, kind, hit):
        try:
            if not function.forged:
                for name, device in self.template.devices.items():
                    found = self.read(name, device)
                    allowed = self.template.histories[name]
                    if name != hit or kind != "kept" or function.harmless:
                        allowed = allowed[-1:]
                    if name == hit and function.factory:
                        allowed = [*allowed, self.template.histories[name][0]]
                    if found not in allowed:
                        cells = [cell for cell in found if found[cell] != allowed[-1][cell]]
                        self.faults.append(
                            f"started, and {name} holds what it never held: {len(cells)} cells, e.g. "
                            f"{cells[0]} is {str(found[cells[0]])[:40]}"
                        )
            if kind in ("temporary", "lock"):
                self.write(self.template.devices[hit], may_refuse=kind == "temporary")
            process.send_signal(signal.SIGINT)
            status = process.wait(self.patience() + 5)
            if status not in (0, 1):
                self.faults.append(f"started, and ended with status {status}")
        except (Gone, Silent, Refused) as error:
            self.faults.append(f"started, and then {type(error).__name__}: {error}; exit status {process.poll()}")
        except subprocess.TimeoutExpired:
            self.faults.append("started, and does not end")
        finally:
            process.kill()
            process.wait()
            process.stdout.close()
        left = [
            each.name
            for each in (self.directory / "state").iterdir()
            if each.name.endswith(".new") and not each.is_dir()
        ]
        if left:
            self.faults.append(f"left {left} behind")

    def read(self, name, device):
        try:
            device.connect()
            return device.read(random.Random(0.9))
        finally:
            device.close()

    def write(self, device, may_refuse):
        """So that the file is replaced, whatever lies in the way: a device may say that it cannot keep it."""
        device.connect()
        device.read(random.Random(0.9))
        orders = device.orders(self.rng)
        for _ in range(2):
            _, give = next(orders)
            try:
                patiently(give)
            except Refused:
                if not may_refuse:
                    raise
                break
        device.close()
        time.sleep(0.2)  # what is written behind an answer

    # Names that are too long, and directories that are none

    def try_name(self):
        """A name too long for a file, alone or with what is appended to it."""
        length = self.rng.choice((120, 200, 244, 245, 248, 250, 255, 300, 5000))
        text = f'[[device]]\ntype = "tmcm-142"\nname = "{"n" * length}"\nrs485 = "tcp:{own_address()}:29142"\n'
        path = self.directory / "rack.toml"
        path.write_text(text, encoding="ascii")
        command = [self.options.stator, "run", str(path), "--state", str(self.directory / "state")]
        try:
            self.judge_refusal(run(command, self.patience(), self.directory, b"Running;"), ("nnnn", "name"), (1, 2))
            self.verdict = "refused"
        except Started as started:
            self.verdict = "started"
            process = started.args[0]
            device = SerialTmcm142(Rack(own_address()))
            try:
                device.connect()
                device.module.ask(9, 83, 0, 0x345)
                device.close()
                process.send_signal(signal.SIGINT)
                if process.wait(20) != 0:
                    self.faults.append(f"took a name of {length} letters and could not keep anything under it")
            except Refused as error:
                self.faults.append(f"took a name of {length} letters and refuses to keep anything: {error}")
            finally:
                process.kill()
                process.wait()
                process.stdout.close()

    def try_place(self):
        state = self.directory / "state"
        kind = self.rng.choice(
            ("file", "fifo", "device_node", "link_to_itself", "long", "no parent", "listening_socket", "link to file")
        )
        if kind == "file":
            state.write_bytes(damage.SECRET)
        elif kind == "long":
            state = self.directory / "/".join(["d" * 200] * 30)
        elif kind == "no parent":
            state = self.directory / "secret" / "x"
            (self.directory / "secret").write_bytes(damage.SECRET)
        elif kind == "link to file":
            state.symlink_to(self.outside / "secret")
        else:
            damage.DAMAGES[kind](state, self.rng, self.outside)
        command = [self.options.stator, "run", str(self.template.rack_file), "--state", str(state)]
        try:
            self.judge_refusal(
                run(command, self.patience(), self.directory, b"Running;"), (str(state), state.name, "ddddd"), (1, 2)
            )
            self.verdict = "refused"
        except Started as started:
            self.faults.append(f"started with a {kind} instead of a directory")
            started.args[0].kill()
            started.args[0].wait()
        self.judge_outside()

    def try_second(self):
        """Another rack on the same directory, whose lock somebody deleted or replaced."""
        state = self.directory / "state"
        shutil.copytree(self.template.state, state)
        options = ["--state", str(state)]
        other = self.directory / "other.toml"
        text = self.template.rack_file.read_text("ascii")
        other.write_text(text.replace(own_address(), "127.0.0.1"), encoding="ascii")
        with RackProcess(self.options.stator, str(self.template.rack_file), str(self.directory), *options):
            if self.rng.random() < 0.8:
                (state / "lock").unlink()
            if self.rng.random() < 0.5:
                (state / "lock").write_bytes(b"")
            try:
                self.judge_refusal(
                    run(
                        [self.options.stator, "run", str(other), *options], self.patience(), self.directory, b"Running;"
                    ),
                    (str(state),),
                    (1, 2),
                )
                self.verdict = "refused"
            except Started as started:
                self.verdict = "started"
                self.faults.append("a second rack runs on the directory")
                started.args[0].kill()
                started.args[0].wait()

    # Recordings

    def try_recording(self):
        path = self.directory / "damaged.stator"
        shutil.copyfile(self.template.recording, path)
        function = damage.DAMAGES[self.name]
        before = path.read_bytes()
        function(path, self.rng, self.outside)
        same = function.harmless or (
            path.is_file() and path.stat().st_size == len(before) and path.read_bytes() == before
        )
        outcome = run([self.options.stator, "replay", str(path)], self.patience(), self.directory)
        if outcome.status == 0 and not (same or function.forged or function.behind):
            self.faults.append("replayed as if nothing was wrong")
        if same and outcome.status != 0:
            self.faults.append("refused what was not damaged")
        self.verdict = {0: "replayed", 3: "cut"}.get(outcome.status, "refused")
        self.judge_refusal(outcome, (path.name,) if outcome.status != 0 else ("",), (0, 1, 2, 3))
        self.judge_outside()


def kinds():
    names = [("state", name) for name, each in damage.DAMAGES.items() if each.kept]
    names += [("temporary", name) for name, each in damage.DAMAGES.items() if each.temporary]
    names += [("lock", name) for name, each in damage.DAMAGES.items() if each.lock]
    names += [("directory", "many_foreign_files"), ("name", "too_long"), ("place", "no_directory"), ("second", "rack")]
    names += [("recording", name) for name, each in damage.DAMAGES.items() if each.recording]
    return names


def run_case(options, template, number):
    rng = random.Random(f"{options.seed}/{number}")
    chosen = [each for each in kinds() if not options.only or any(part in ":".join(each) for part in options.only)]
    kind, name = chosen[number % len(chosen)]
    with tempfile.TemporaryDirectory(prefix="stator-rig-") as directory:
        case = Case(options, template, pathlib.Path(directory), rng)
        case.name = name
        try:
            if kind == "recording":
                case.try_recording()
            elif kind == "name":
                case.try_name()
            elif kind == "place":
                case.try_place()
            elif kind == "second":
                case.try_second()
            else:
                case.try_state({"state": "kept"}.get(kind, kind), rng.choice(list(template.devices)))
        except Exception:
            case.faults.append(traceback.format_exc())
    return (
        f"{kind}:{name}",
        case.verdict,
        [f"--case {number} {kind}:{name}: {'; '.join(case.faults)}"] if case.faults else [],
    )


def run_batch(task):
    options, numbers = task
    results = []
    rng = random.Random(f"{options.seed}/template/{numbers[0] // CASES_OF_A_TEMPLATE}")
    with tempfile.TemporaryDirectory(prefix="stator-rig-") as directory:
        try:
            template = Template(
                options.stator, "node" if rng.random() < 0.1 else "segment", rng, pathlib.Path(directory)
            )
        except Exception:
            return [("template", "?", [f"--case {numbers[0]}: {traceback.format_exc()}"])]
        for number in numbers:
            results.append(run_case(options, template, number))
    return results


def prepare_worker():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(5)
    os.umask(0o022)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stator", required=True)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=4)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--limit", type=float, default=1.0)
    parser.add_argument("--factor", type=float, default=5.0)
    parser.add_argument("--case", type=int)
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    if options.list:
        print("\n".join(":".join(each) for each in kinds()))
        return 0
    options.stator = os.path.abspath(options.stator)
    numbers = list(range(options.count)) if options.case is None else [options.case]
    batches = [numbers[at : at + CASES_OF_A_TEMPLATE] for at in range(0, len(numbers), CASES_OF_A_TEMPLATE)]
    begin = time.monotonic()
    verdicts = collections.defaultdict(collections.Counter)
    with multiprocessing.Pool(options.jobs, prepare_worker) as pool:
        for results in pool.imap_unordered(run_batch, [(options, batch) for batch in batches]):
            for name, verdict, faults in results:
                verdicts[name][verdict] += 1
                verdicts[name]["faults"] += bool(faults)
                for fault in faults:
                    print(fault, flush=True)
    columns = ("refused", "started", "replayed", "cut", "faults")
    width = max(map(len, verdicts))
    print(f"{'':{width}}" + "".join(f"{column:>10}" for column in columns))
    total = sum(verdicts.values(), collections.Counter())
    for name, counts in [*sorted(verdicts.items()), ("together", total)]:
        print(f"{name:{width}}" + "".join(f"{counts[column]:>10}" for column in columns))
    print(f"{len(numbers)} cases in {time.monotonic() - begin:.0f} s; seed {options.seed}")
    return 1 if total["faults"] else 0


if __name__ == "__main__":
    sys.exit(main())
