#!/usr/bin/env python3
"""Clients on every network of the five-device rack at once, for a build with the thread sanitizer.

Each client does nothing clever but does it without a pause: EtherCAT by Stator's own master, SDOs on the CAN bus,
TMCL commands on the serial line, pages, metrics, events, objects, inputs and faults over HTTP. What is judged is
that the rack goes on answering all of them and ends in order; a race ends it.
"""

import argparse
import json
import os
import pathlib
import random
import re
import select
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from running_rack import PATIENCE, TOKEN, RunningRack, have_own_network, server_environment  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[3]


def rack_text():
    """The five devices of racks/five-devices.toml, on ports that belong to this program alone."""
    text = (ROOT / "racks" / "five-devices.toml").read_text(encoding="utf-8")
    text = text.replace("../examples/", f"{ROOT}/examples/")
    text, buses = re.subn(r'ports = \["[^"]*"\]', 'ports = ["slcan-tcp:0", "slcan-tcp:0"]', text)
    text, lines = re.subn(r'"pty:[^"]*"', '"tcp:127.0.0.1:0"', text)
    assert buses == 1 and lines >= 1, "racks/five-devices.toml is not as it was"
    return text


class Client(threading.Thread):
    """Goes on until it is told to stop; an exception is the run's."""

    def __init__(self, name, work):
        super().__init__(name=name, daemon=True)
        self.work, self.rounds, self.failure = work, 0, None

    def run(self):
        try:
            while not STOP.is_set():
                self.work()
                self.rounds += 1
        except Exception as error:  # pylint: disable=broad-except
            if not STOP.is_set():
                self.failure = error
                STOP.set()


STOP = threading.Event()


def connect(address):
    host, port = re.search(r"([0-9.]+):(\d+)$", address).groups()
    link = socket.create_connection((host, int(port)), PATIENCE)
    link.settimeout(PATIENCE)
    return link


def master(program, seed):
    """Stator's own, patient with a slow build; each start scans the segment."""
    dice = random.Random(seed)
    orders = [["scan"], ["sdo", "read", "1008:0"], ["move", "--revolutions", "2"]]

    def work():
        order = dice.choice(orders)
        done = subprocess.run(
            [program, *order, "--link", "udp:127.0.0.1", "--timeout", "2s"],
            capture_output=True,
            text=True,
            env=server_environment(),
            timeout=10 * PATIENCE,
            check=False,
        )
        # A drive on a build that is slower than real time may miss the limits of a move, and say so.
        permitted = (0, 1) if order[0] == "move" else (0,)
        assert done.returncode in permitted, f"stator {' '.join(order)}: {done.stderr}{done.stdout}"

    return work


def can_program(address):
    """Uploads an object of the drive again and again and hears everything else as well."""
    link = connect(address)
    link.sendall(b"O\r")

    def work():
        seen = b""
        while b"t585" not in seen and not STOP.is_set():
            link.sendall(b"t60584041600000000000\r")  # 6041h, statusword; again while the drive boots
            again = time.monotonic() + 1.0
            while b"t585" not in seen and time.monotonic() < again:
                if select.select([link], [], [], 0.1)[0]:
                    seen = seen[-64:] + link.recv(4096)

    return work


def serial_program(address):
    """Asks the module for its actual position (TMCL: GAP 1, motor 0)."""
    link = connect(address)
    body = bytes([1, 6, 1, 0, 0, 0, 0, 0])
    request = body + bytes([sum(body) & 0xFF])

    def work():
        link.sendall(request)
        reply = b""
        while len(reply) < 9:
            reply += link.recv(64)

    return work


def browser(address, seed):
    """Reads whatever the server has, and now and then sets an input and has something go wrong."""
    dice = random.Random(seed)
    pages = [
        "/",
        "/metrics",
        "/api/v1/rack",
        "/api/v1/devices",
        "/api/v1/signals",
        "/api/v1/events",
        "/api/v1/faults",
        "/api/v1/devices/gantry",
        "/api/v1/devices/spindle/objects",
        "/api/v1/inputs",
        "/api/v1/wiring",
        "/api/v1/devices/feeder/panel",
    ]

    def ask(path, body=None):
        request = urllib.request.Request(
            address + path,
            data=None if body is None else json.dumps(body).encode(),
            headers={"Authorization": f"Bearer {TOKEN}", "Content-Type": "application/json"},
        )
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
                answer.read()
        except urllib.error.HTTPError as error:
            assert error.code < 500 or error.code == 503, f"{path}: {error.code}"

    # Not more often than the master gets over it.
    next_fault = time.monotonic() + 5.0

    def work():
        nonlocal next_fault
        ask(dice.choice(pages))
        if time.monotonic() > next_fault:
            next_fault = time.monotonic() + dice.uniform(5.0, 15.0)
            ask("/api/v1/faults", {"kind": "ethercat-drop", "device": "gantry", "count": 1})

    return work


def watcher(address):
    """A page with a stream of signals, opened and closed again."""
    host, port = re.search(r"([0-9.]+):(\d+)$", address).groups()

    def work():
        with socket.create_connection((host, int(port)), PATIENCE) as link:
            link.sendall(
                (
                    f"GET /api/v1/traffic?token={TOKEN} HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\n"
                    "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                    "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
                ).encode()
            )
            end = time.monotonic() + 1.0
            while time.monotonic() < end and not STOP.is_set():
                if select.select([link], [], [], 0.1)[0] and not link.recv(65536):
                    break

    return work


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stator", required=True)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    program = os.path.abspath(options.stator)
    have_own_network()
    with RunningRack(program, rack_text()) as rack:
        http = re.search(r"http://[0-9.]+:\d+", rack.wait_for(r"http://[0-9.]+:\d+")).group()
        said = rack.log()
        can = re.findall(r"slcan-tcp:([0-9.]+:\d+)", said)
        serial = re.findall(r"Serial line ([0-9.]+:\d+)", said)
        assert len(can) >= 2 and serial, f"no ports are announced:\n{said}"
        clients = [
            Client("EtherCAT master", master(program, options.seed)),
            Client("CAN program", can_program(can[0])),
            Client("second CAN program", can_program(can[-1])),
            Client("serial program", serial_program(serial[0])),
            Client("browser", browser(http, options.seed)),
            Client("second browser", browser(http, options.seed + 1)),
            Client("watcher", watcher(http)),
        ]
        for client in clients:
            client.start()
        STOP.wait(options.seconds)
        STOP.set()
        ended = rack.process.poll()
        process = rack.process
        for client in clients:
            client.join(10 * PATIENCE if ended is None else 1.0)
            print(f"{client.name}: {client.rounds} rounds")
    failures = [f"{client.name}: {client.failure}" for client in clients if client.failure]
    if process.returncode != 0:
        failures.insert(0, f"stator run ended with {process.returncode}")
    failures += [f"{client.name} did nothing" for client in clients if client.rounds == 0 and not client.failure]
    print("\n".join(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
