#!/usr/bin/python3
"""Kills `stator run` at seeded moments around orders to keep something, starts it again with the same --state and
reads back over the bus: what was answered must be there, what was one order must be old or new.

    kill.py --stator PROGRAM [--count 200] [--seed 1] [--jobs 6] [--only ROW[:MODE]]... [--list]

Rows are devices and operations (kept_devices.py). Modes say what happens to the run:
  kill       SIGKILL
  sigint     SIGINT, which must end it with exit status 0
  full       the disk runs full; then SIGKILL or SIGINT
  readonly   the directory cannot be written any more; then SIGKILL or SIGINT
  power      the disk loses what was not brought to it (fsync), with SIGKILL
  lockstep   SIGKILL under --clock lockstep
  recorded   SIGKILL while a session is recorded
--count is of kills for each row in each mode. Orders refused in the protocol's words are no fault, but what was
refused must not be there later. A run of kills on one directory is a chain with a seed of its own; --chain N
repeats one. Exit status 1 if anything was lost, torn or refused to start. `full`, `readonly` and `power` need root.
"""

import argparse
import collections
import math
import multiprocessing
import os
import pathlib
import random
import signal
import sys
import tempfile
import threading
import time
import traceback

from ethercat_host import GivenUp, Refused
from kept_devices import ROWS
from kept_model import KeptModel
from places import FullPlace, Place, PowerCutPlace, ReadOnlyPlace, have_own_mounts
from rack_process import Gone, NotStarted, RackProcess, Silent, own_address

KILLS_IN_A_CHAIN = 20
MODES = {
    "kill": Place,
    "sigint": Place,
    "full": FullPlace,
    "readonly": ReadOnlyPlace,
    "power": PowerCutPlace,
    "lockstep": Place,
    "recorded": Place,
}
NEED_MOUNTS = ("full", "readonly", "power")
OPTIONS = {"lockstep": ("--clock", "lockstep")}
COLUMNS = ("kills", "answered", "refused", "open", "lost", "torn", "other")


class RackAddress:
    """Where the devices of this process's racks are reached."""

    def __init__(self, address):
        self.address = address


def log_uniform(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


class Moment:
    """When a run ends: at once or some time behind the n-th order or its answer."""

    def __init__(self, rng, burst, action):
        self.action = action
        self.behind = rng.choice(("order", "answer", "answer"))
        self.number = rng.randrange(burst)
        self.delay = 0.0 if rng.random() < 0.4 else log_uniform(rng, 0.00005, 0.15)
        self.silence = rng.random() < 0.3  # no more orders meanwhile
        self.lock = threading.Lock()
        self.counts = collections.Counter()
        self.timer = None

    def __str__(self):
        return f"{self.delay * 1000:.2f} ms behind {self.behind} {self.number}"

    def note(self, what):
        """True if no more orders shall come."""
        with self.lock:
            number = self.counts[what]
            self.counts[what] += 1
            hit = what == self.behind and number == self.number and self.timer is None
            if hit:
                self.timer = threading.Timer(self.delay, self.action)
                if self.delay:
                    self.timer.start()
        if hit and not self.delay:
            self.action()
        return self.timer is not None and self.silence

    def finish(self):
        if self.timer is not None and self.delay:
            self.timer.join()


def give_orders(device, model, rng, moments, tally):
    """Until the program is gone, or the moment has come and nothing more shall be ordered."""
    try:
        orders = device.orders(rng)
        outcome = None
        while True:
            changes, give = orders.send(outcome)
            model.order(changes)
            quiet = [each.note("order") for each in moments]
            try:
                give()
            except Refused as reason:
                tally["refused"] += 1
                if isinstance(reason, GivenUp):
                    return  # as open as an order without an answer
                outcome = False
                model.refused()
            else:
                outcome = True
                model.answered()
                tally["answered"] += 1
            quiet += [each.note("answer") for each in moments]
            if any(quiet):
                return
            if rng.random() < 0.1:
                time.sleep(log_uniform(rng, 0.001, 0.15))
    except (Gone, Refused) as reason:  # Refused: what prepares an order, on a device that is going
        if isinstance(reason, Refused):
            tally["refused"] += 1
        tally["open"] += model.ordered is not None


class Chain:
    """Kills in a row on one state directory."""

    def __init__(self, program, row, mode, seed, number, directory):
        self.program = program
        self.row = row
        self.mode = mode
        self.name = f"{row.name}:{mode} --seed {seed} --chain {number}"
        self.rng = random.Random(f"{seed}/{row.name}/{mode}/{number}")
        self.directory = pathlib.Path(directory)
        self.place = MODES[mode](directory)
        self.rack = RackAddress(own_address())
        self.devices = [device(self.rack, at) for at, device in enumerate(row.devices)]
        self.models = [KeptModel() for _ in self.devices]
        self.tally = collections.Counter()
        self.worst_end = 0.0
        self.faults = []
        self.last = "the first start"

    def fault(self, kind, number, sentence):
        self.tally[kind] += 1
        self.faults.append(f"{self.name} kill {number} ({self.last}): {kind}: {sentence}")

    def run(self, kills):
        path = self.directory / "rack.toml"
        path.write_text(self.row.rack.format(address=self.rack.address), encoding="ascii")
        for name, text in self.row.files.items():
            (self.directory / name).write_text(text, encoding="ascii")
        for number in range(kills + 1):
            recording = self.directory / "run.stator"
            recording.unlink(missing_ok=True)
            options = ["--state", str(self.place.state), *OPTIONS.get(self.mode, ())]
            if self.mode == "recorded":
                options += ["--record", str(recording)]
            try:
                with RackProcess(self.program, str(path), str(self.directory), *options) as process:
                    self.one_run(process, number, number == kills)
            except NotStarted as error:
                self.fault("other", number, str(error))
                break
            except Silent as error:
                self.fault("other", number, f"{error}; it said: {self.log()}")
                break
            self.place.mend()
        self.place.close()
        return self

    def log(self):
        return (self.directory / "stderr").read_text("utf-8", "replace")[-500:].strip()

    def one_run(self, process, number, last):
        for device, model in zip(self.devices, self.models, strict=True):
            device.connect()
            for kind, sentence in model.compare(device.read(self.rng)):
                self.fault(kind, number, sentence)
        if last:
            return
        self.tally["kills"] += 1
        moments, spoilt, ending = self.draw_moments(process)
        threads = [
            threading.Thread(
                target=give_orders, args=(device, model, random.Random(self.rng.random()), moments, self.tally)
            )
            for device, model in zip(self.devices, self.models, strict=True)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for moment in moments:
            moment.finish()
        status, seconds = process.end(ending)
        self.worst_end = max(self.worst_end, seconds)
        if ending == signal.SIGINT and status not in ((0, 1) if spoilt else (0,)):
            self.fault("other", number, f"exit status {status} after SIGINT; it said: {self.log()}")
        for device in self.devices:
            device.close()

    def draw_moments(self, process):
        burst = sum(device.burst for device in self.devices)
        ending = signal.SIGKILL
        if self.mode == "sigint" or self.mode in ("full", "readonly") and self.rng.random() < 0.5:
            ending = signal.SIGINT
        rng = random.Random(self.rng.random())
        if self.mode == "power":

            def end():
                process.send(signal.SIGSTOP)
                self.place.spoil(rng)
                process.send(signal.SIGKILL)
        else:

            def end():
                process.send(ending)

        moments = [Moment(self.rng, burst, end)]
        self.last = f"signal {ending} {moments[0]}"
        spoilt = self.mode in ("full", "readonly")
        if spoilt:
            moments.insert(0, Moment(self.rng, burst, lambda: self.place.spoil(rng)))
            moments[0].silence = False
            self.last += f", disk spoilt {moments[0]}"
        return moments, spoilt, ending


def run_chain(task):
    program, row_name, mode, seed, number, kills = task
    row = next(row for row in ROWS if row.name == row_name)
    with tempfile.TemporaryDirectory(prefix="stator-rig-") as directory:
        chain = Chain(program, row, mode, seed, number, directory)
        try:
            chain.run(kills)
        except Exception:  # a fault of the rig must not leave others' runs behind
            chain.fault("other", 0, traceback.format_exc())
    return f"{row_name}:{mode}", chain.tally, chain.worst_end, chain.faults


def prepare_worker(mounts):
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent's to react to
    os.nice(5)
    if mounts:
        have_own_mounts()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stator", required=True)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=6)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--chain", type=int)
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    names = [(row.name, mode) for row in ROWS for mode in MODES if mode != "lockstep" or row.lockstep]
    names = [each for each in names if not options.only or any(part in f"{each[0]}:{each[1]}" for part in options.only)]
    if options.list or not names:
        print("\n".join(":".join(each) for each in names))
        return 0 if names else 2
    program = os.path.abspath(options.stator)
    chains = range(-(-options.count // KILLS_IN_A_CHAIN)) if options.chain is None else (options.chain,)
    tasks = [
        (
            program,
            row,
            mode,
            options.seed,
            chain,
            min(KILLS_IN_A_CHAIN, options.count - (chain * KILLS_IN_A_CHAIN if options.chain is None else 0)),
        )
        for chain in chains
        for row, mode in names
    ]
    begin = time.monotonic()
    tallies = {":".join(each): collections.Counter() for each in names}
    worst = collections.Counter()
    with multiprocessing.Pool(options.jobs, prepare_worker, (any(mode in NEED_MOUNTS for _, mode in names),)) as pool:
        for name, tally, end, faults in pool.imap_unordered(run_chain, tasks):
            tallies[name] += tally
            worst[name] = max(worst[name], end)
            for fault in faults:
                print(fault, flush=True)
    seconds = time.monotonic() - begin
    width = max(map(len, tallies))
    print(f"{'':{width}}" + "".join(f"{column:>9}" for column in COLUMNS) + f"{'end, s':>9}")
    total = sum(tallies.values(), collections.Counter())
    for name, tally in [*tallies.items(), ("together", total)]:
        print(
            f"{name:{width}}"
            + "".join(f"{tally[column]:>9}" for column in COLUMNS)
            + f"{max(worst.values()) if name == 'together' else worst[name]:>9.2f}"
        )
    print(f"{total['kills']} kills in {seconds:.0f} s, {total['kills'] / seconds:.1f} a second; seed {options.seed}")
    return 1 if total["lost"] + total["torn"] + total["other"] else 0


if __name__ == "__main__":
    sys.exit(main())
