"""Racks by seed, with events and faults, and who speaks to them meanwhile."""

import collections
import dataclasses
import random
import shutil
import threading
import time
import traceback
from pathlib import Path

from comparison.actors import CAN_PORT, ETHERCAT_PORT, PATIENCE, SERIAL_PORT
from comparison.can_actor import Bus
from comparison.ethercat_actor import Segment
from comparison.outcome import run
from comparison.products import MFC, ROOT, SEGMENT_PRODUCTS, SERIAL
from comparison.tmcl_actors import Line, Module, SerialHost
from rack_process import Gone, RackProcess, own_address

PRODUCTS = ("tmcm-3315", "tmc8670", "tmc8461", "tmcc160", "tmcm-142")
STEPPERS = ("QSH5718-41-30-047", "QSH5718-55-30-098", "QSH5718-79-30-163", "QSH6018-86-28-310")
SERVOS = ("QBL4208-41-04-006", "QBL4208-61-04-013", "QBL4208-100-04-025", "EC45-flat-70W")
WITHIN = 250000  # us, in which events and faults begin
MOST_TORQUE, MOST_VALUE = 1.0, 60.0
TRIES = 12

BOARD = f"""mfc = "{MFC}"
[segment.device.board.axis]
type = "step-dir-motor"
wires = {{ step = "MFCIO03", dir = "MFCIO04" }}
microsteps = 16
[segment.device.board.encoder]
type = "encoder"
wires = {{ a = "MFCIO00", b = "MFCIO01", n = "MFCIO02" }}
shaft = "axis"
[segment.device.board.fan]
type = "dc-motor"
wires = {{ a_high = "MFCIO05", a_low = "MFCIO06", b_high = "MFCIO07", b_low = "MFCIO08" }}
[segment.device.board.memory]
type = "i2c-eeprom"
wires = {{ scl = "MFCIO14", sda = "MFCIO15" }}
[segment.device.board.door]
type = "switch"
wires = {{ line = "MFC_HV0" }}
bounce_time = 300
[segment.device.board.filter]
type = "rc-filter"
wires = {{ line = "MFC_HV2" }}
[segment.device.board.lamp]
type = "led"
wires = {{ line = "MFC_HV6" }}
"""
# Objects of a TMC8670 with which every mode moves it, as in racks/ethercat-servo.toml.
TUNED = {
    "2030:01": 1453,
    "2030:02": 786,
    "2030:03": 1453,
    "2030:04": 786,
    "2030:05": 6400,
    "2030:06": 80,
    "2030:07": 300,
    "2031:01": 12000,
    "6065": 65536,
    "6066": 100,
    "6072": 2000,
    "6073": 2000,
    "6075": 2450,
    "6076": 125,
    "6081": 2000,
    "6083": 20000,
    "6084": 20000,
    "6085": 50000,
    "6098": 34,
}


@dataclasses.dataclass
class Placed:
    name: str
    product: str
    network: str  # segment, bus or none
    lines: list


class Session:
    """The rack of a number; `text` is its file, {address} left open."""

    def __init__(self, seed, number, products, faults):
        self.number = number
        self.rng = random.Random(f"{seed}/{number}")
        self.products = products
        self.faults = faults
        self.placed = []
        self.kinds = []  # of faults that are in it
        self.events = collections.Counter()
        self.ports = SERIAL_PORT
        self.lockstep = self.rng.random() < 0.6
        self.text = self._rack()

    def _rack(self):
        rng = self.rng
        main = PRODUCTS[self.number % len(PRODUCTS)]
        others = [product for product in PRODUCTS if product != main and rng.random() < 0.22]
        chosen = [main, *others]
        parts = [f'clock = "{"lockstep" if self.lockstep else "real"}"\n']
        if rng.random() < 0.3:
            parts.append(f'cycle = "{rng.choice(("500us", "1ms", "2ms"))}"\nstep = "{rng.choice(("10us", "50us"))}"\n')
        slaves = [product for product in chosen if product in SEGMENT_PRODUCTS]
        if main in SEGMENT_PRODUCTS and rng.random() < 0.3:
            slaves.append(main)
        if slaves:
            rng.shuffle(slaves)
            parts.append(f'[[segment]]\nlink = "udp:{{address}}:{ETHERCAT_PORT}"\n')
            parts += [self._slave(product) for product in slaves]
        on_bus = [product for product in chosen if product == "tmcc160"]
        if "tmcm-142" in chosen and (on_bus or rng.random() < 0.3):
            on_bus.append("tmcm-142")
        if on_bus:
            rate = rng.choice(("1000", "1000", '"unlimited"'))
            parts.append(f'[[bus]]\nname = "can0"\nbit_rate = {rate}\nports = ["slcan-tcp:{{address}}:{CAN_PORT}"]\n')
            parts += [self._node(product) for product in on_bus]
        if "tmcm-142" in chosen and "tmcm-142" not in on_bus:
            parts.append(self._module())
        parts.append(self._lines())
        return "".join(parts)

    # Devices

    def _name(self, product, network):
        name = f"{product}-{len(self.placed)}"
        self.placed.append(Placed(name, product, network, []))
        return f'type = "{product}"\nname = "{name}"\n'

    def _serial(self, probability):
        text = ""
        placed = self.placed[-1]
        for interface in SERIAL.get(placed.product, ()):
            if self.rng.random() < probability:
                line = f"tcp:{{address}}:{self.ports}"
                placed.lines.append((interface, line, self.ports))
                self.ports += 1
                text += f'{interface} = "{line}"\n'
        return text

    def _load(self):
        rng = self.rng
        text = f"load.inertia = {rng.choice((0, 1e-5, 3e-5))}\n"
        if rng.random() < 0.4:
            text += f"load.coulomb_friction = {rng.choice((0.01, 0.05))}\n"
        if rng.random() < 0.2:
            text += "load.end_stop_minimum = -3\nload.end_stop_maximum = 4\n"
        if rng.random() < 0.3:
            text += "left_switch = { pressed_to = -1.5 }\nright_switch = { pressed_from = 2 }\n"
        if rng.random() < 0.2:
            text += "supply = { brake_chopper_voltage = 30 }\n"
        return text

    def _quirks(self, names):
        if self.rng.random() < 0.75:
            return ""
        return f'quirks = ["{self.rng.choice(names)}"]\n'

    def _slave(self, product):
        rng = self.rng
        text = "[[segment.device]]\n" + self._name(product, "segment")
        if product == "tmc8461":
            return text + BOARD
        text += self._serial(0.35) + f'firmware_erase_time = "{rng.choice(("0ms", "3ms"))}"\n'
        text += self._quirks(
            ("slow-sdo", "one-pdo", "emergency-storm", "abort-with-size", "late-boot", "repeats-executed")
        )
        if product == "tmcm-3315":
            text += f'firmware = "{rng.choice(("1.07", "1.08", "1.09", "1.09"))}"\n'
            for _ in range(rng.randrange(4)):
                text += f'[[segment.device.axis]]\nmotor = "{rng.choice(STEPPERS)}"\n'
                text += f"supply_voltage = {rng.choice((24, 48))}\n"
                text += self._load()
                if rng.random() < 0.4:
                    text += "encoder.counts_per_revolution = 4000\n"
            return text
        text += f'controller = "{rng.choice(("document", "silicon"))}"\n'
        text += f"clock_deviation_ppb = {rng.randrange(-90000, 90000)}\n"
        if rng.random() < 0.7:
            text += "".join(f'objects."{key}" = {value}\n' for key, value in TUNED.items())
        text += f'[segment.device.axis]\nmotor = "{rng.choice(SERVOS)}"\nsupply_voltage = 24\n' + self._load()
        if rng.random() < 0.3:
            text += 'inverter = { model = "switched", dead_time = 2e-7 }\n'
        if rng.random() < 0.3:
            text += "converter.current_u.noise = 20\nhalls.h1_error = 3\n"
        return text

    def _node(self, product):
        text = "[[bus.device]]\n" + self._name(product, "bus") + self._serial(0.3)
        if product == "tmcm-142":
            return text + "axis.supply_voltage = 24\n" + self._axis(self.rng.choice(STEPPERS))
        text += f'node_id = 5\nboot_time = "2ms"\nfriendly = {self.rng.choice(("true", "false"))}\n'
        text += self._quirks(("slow-sdo", "late-boot", "no-segments", "emergency-storm", "one-pdo"))
        return text + self._axis(self.rng.choice(SERVOS))

    def _module(self):
        text = "[[device]]\n" + self._name("tmcm-142", "none")
        serial = self._serial(0.4)
        if not serial:
            serial = self._serial(1.0)
        return text + serial + self._axis(self.rng.choice(STEPPERS))

    def _axis(self, motor):
        return f'axis.motor = "{motor}"\n' + "".join(f"axis.{line}\n" for line in self._load().splitlines())

    def _lines(self):
        lines = [(interface, line) for placed in self.placed for interface, line, _ in placed.lines]
        return "".join(
            f'[[line]]\nlink = "{line}"\npacing = {self.rng.choice(("true", "false"))}\n'
            for interface, line in lines
            if interface.startswith("rs") and self.rng.random() < 0.5
        )

    # What happens to them

    def add_happenings(self, check):
        """Events and faults that `check` takes; the first kind of fault goes by the session's number."""
        rng = self.rng
        for _ in range(rng.randrange(1, 5)):
            self._try(check, self._event)
        wanted = self.faults[self.number % len(self.faults)]
        self._try(check, lambda: self._fault(wanted))
        for _ in range(rng.randrange(3)):
            self._try(check, lambda: self._fault(rng.choice(self.faults)))
        if rng.random() < 0.3:
            self._try(check, self._wire)

    def _try(self, check, draw):
        for _ in range(TRIES):
            text, note = draw()
            if text and check(self.text + text):
                self.text += text
                note()
                return

    def _time(self, most=WITHIN):
        return f'"{self.rng.randrange(1, most)}us"'

    def _value(self, name, least, most, unit):
        bound = MOST_TORQUE if "N" in unit else MOST_VALUE
        low, high = max(least, -bound), max(min(most, bound), max(least, -bound))
        return f"{self.rng.choice((low, high, low + (high - low) * self.rng.random())):.6f}"

    def _event(self):
        rng = self.rng
        device = rng.choice(self.placed)
        action = rng.choice(("set", "set", "power", "power", "cable", "bus-off", "error-passive", "drop", "corrupt"))
        head = f'[[event]]\ndevice = "{device.name}"\n'
        begin = rng.randrange(1000, WITHIN)

        def note():
            self.events[action] += 1

        if action == "set":
            name, *limits = rng.choice(self.products[device.product].inputs)
            text = f'{head}at = "{begin}us"\naction = "set"\ninput = "{name}"\nvalue = {self._value(name, *limits)}\n'
        elif action in ("power", "cable"):
            ways = ("power-off", "power-on") if action == "power" else ("break", "heal")
            later = begin + rng.randrange(500, 60000)
            text = f'{head}at = "{begin}us"\naction = "{ways[0]}"\n{head}at = "{later}us"\naction = "{ways[1]}"\n'
        else:
            text = f'{head}at = "{begin}us"\naction = "{action}"\n'
        return text, note

    def _wire(self):
        source, target = self.rng.choice(self.placed), self.rng.choice(self.placed)
        signal = self.rng.choice(self.products[source.product].signals)
        name = self.rng.choice(self.products[target.product].inputs)[0]
        return (
            f'[[wire]]\nfrom = "{source.name}.{signal}"\nto = "{target.name}.{name}"\n',
            lambda: self.events.update(["wire"]),
        )

    def _fault(self, fault):
        rng = self.rng
        fitting = [
            each
            for each in self.placed
            if fault.reach == "any"
            or fault.reach == "serial"
            and each.lines
            or fault.reach == "ethercat"
            and each.network == "segment"
            or fault.reach == "can"
            and each.network == "bus"
        ]
        if not fitting:
            return "", None
        device = rng.choice(fitting)
        lines = ["[[fault]]", f'kind = "{fault.kind}"']
        if fault.scope == "bus" and rng.random() < 0.5:
            lines.append('bus = "can0"')
        elif fault.scope == "line":
            lines.append(f'line = "{rng.choice(device.lines)[1]}"')
        else:
            lines.append(f'device = "{device.name}"')
        if device.product == "tmc8461" and any(key == "peripheral" for key, *_ in fault.parameters):
            lines.append(f'peripheral = "{rng.choice(("axis", "fan"))}"')
        chosen = rng.choice(self.products[device.product].inputs)
        for key, kind, limits, needed in fault.parameters:
            if key == "peripheral" or not needed and rng.random() < 0.6:
                continue
            value = self._parameter(key, kind, limits, chosen)
            if value:
                lines.append(f"{key} = {value}")
        begin = rng.random()
        if begin < 0.55:
            lines.append(f"at = {self._time()}")
        elif begin < 0.8:
            lines.append(
                "when = { "
                + rng.choice(
                    (
                        'network_state = "operational"',
                        f"cycles = {rng.randrange(1, 60)}",
                        f"message = {rng.randrange(1, 20)}",
                        'sdo = "1018"',
                        'sdo = "6060"',
                        "frame = 0x80, count = 20",
                    )
                )
                + " }"
            )
        if fault.counted and rng.random() < 0.7:
            lines.append(f"count = {rng.randrange(1, 20)}")
            if rng.random() < 0.5:
                lines.append(f"probability = {0.1 + 0.8 * rng.random():.2f}\nseed = {rng.randrange(1000)}")
        elif not fault.momentary and rng.random() < 0.85:
            lines.append(f"for = {self._time(60000)}")
        return "\n".join(lines) + "\n", lambda: self.kinds.append(fault.kind)

    def _parameter(self, key, kind, limits, chosen):
        rng = self.rng
        if kind == "choice":
            return f'"{rng.choice([word.strip() for word in limits.split(",")])}"'
        if kind == "text":
            return f'"{chosen[0]}"' if key == "input" else '"6060"' if key == "object" else ""
        if key in ("value", "back"):
            return self._value(*chosen)
        least, _, most = limits.partition(" to ")
        least, most = float(least), float(most.split(" ")[0])
        if kind == "duration":
            return f'"{rng.randrange(int(least * 1e6) + 1, int(least * 1e6) + 9000)}us"'
        bound = {"torque": 0.5, "inertia": 1e-4}.get(key, rng.choice((1.0, 10.0, 1e5)))
        low = max(least, -bound)
        value = low + (min(most, low + 2 * bound) - low) * rng.random()
        return str(int(value)) if kind == "whole number" else f"{value:.6f}"

    # Its life

    def actors(self, address, counts):
        """Everybody who speaks to it."""
        rng, found = self.rng, []

        def own():
            return random.Random(rng.random())

        slaves = [self.products[each.product] for each in self.placed if each.network == "segment"]
        if slaves:
            found.append(Segment(own(), counts, address, slaves))
        on_bus = [each.product for each in self.placed if each.network == "bus"]
        if on_bus:
            found.append(
                Bus(
                    own(),
                    counts,
                    address,
                    self.products["tmcc160"].objects,
                    5 if "tmcc160" in on_bus else 0,
                    1 if "tmcm-142" in on_bus else 0,
                )
            )
        for placed in self.placed:
            for interface, _, port in placed.lines:

                def open_host(port=port):
                    return SerialHost(address, port)

                found.append(
                    Module(own(), counts, open_host)
                    if placed.product == "tmcm-142"
                    else Line(own(), counts, open_host, placed.product, interface)
                )
        return found


def prepare(folder):
    """What racks name, beside where their files will be."""
    target = Path(folder, MFC)
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(ROOT / MFC, target)


def live(actor, end, budget):
    try:
        actor.connect()
        if actor.first:
            actor.act(actor.first)
        while time.monotonic() < end and budget[0] > 0:
            budget[0] -= 1
            actor.act(actor.rng.choice(actor.chapters))
        actor.close()
    except (Gone, OSError):
        actor.counts["connections closed"] += 1
    except Exception:  # a mistake of the actor's, to be mended here
        budget.append(traceback.format_exc())


def record(program, session, folder, seconds, chapters=10**6):
    """Runs a session with its actors; the recording and counts of what was done."""
    address = own_address()
    rack = Path(folder, "rack.toml")

    def check(text):
        rack.write_text(text.replace("{address}", address), encoding="utf-8")
        return run(program, ["check", rack.name], folder).status == 0

    session.add_happenings(check)
    rack.write_text(session.text.replace("{address}", address), encoding="utf-8")
    counts = collections.Counter()
    recording = Path(folder, "session.stator")
    with RackProcess(program, str(rack), str(folder), "--record", str(recording)) as process:
        actors = session.actors(address, counts)
        end = time.monotonic() + seconds
        budget = [chapters]
        threads = [threading.Thread(target=live, args=(actor, end, budget)) for actor in actors]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(seconds + 60 * PATIENCE)
        status, _ = process.end()
        log = process.log()
    if budget[1:]:
        raise RuntimeError(budget[1])
    return recording, counts, status, log
