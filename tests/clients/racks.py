"""Rack files that several masters are tried with."""

import os
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
IO_BOARD = ROOT / "examples" / "mfc" / "io-board.toml"
SERVO = ROOT / "racks" / "ethercat-servo.toml"

SEGMENT = """
[[segment]]
link = "{link}"
{more}
[[segment.device]]
type = "tmcm-3315"
name = "gantry"

{servo}
[[segment.device]]
type = "tmc8461"
name = "io"
mfc = "{io_board}"

[segment.device.board.axis]
type = "step-dir-motor"
wires = {{ step = "MFCIO03", dir = "MFCIO04" }}
microsteps = 16

[segment.device.board.encoder]
type = "encoder"
wires = {{ a = "MFCIO00", b = "MFCIO01", n = "MFCIO02" }}
shaft = "axis"
counts_per_revolution = 4000
"""
SEGMENT_NAMES = ["TMCM-3315", "TMC8670", "IO board"]

DRIVE_NODE = 5
DRIVE = """
[[bus]]
bit_rate = {bit_rate}
ports = ["{port}"]
{more}
[[bus.device]]
type = "tmcc160"
name = "drive"
node_id = 5
friendly = true
sdo_timeout = "60s"  # a busy machine may take its time to pass a segment on

[bus.device.axis]
left_switch = {{ pressed_to = -2.0 }}
"""


def capture():
    """Where scripts/nightly wants to see what went over the cable: a file for each rack."""
    directory = os.environ.get("STATOR_CLIENT_CAPTURES")
    if not directory:
        return ""
    number = len([name for name in os.listdir(directory) if name.startswith(f"{os.getpid()}-")])
    path = os.path.join(directory, f"{os.getpid()}-{number}.pcap")
    open(path, "wb").close()
    return f'capture = "{path}"'


def segment_rack(link):
    """One of each EtherCAT product; the servo with its motor and gains as racks/ethercat-servo.toml has it."""
    servo = SERVO.read_text(encoding="utf-8")
    servo = servo[servo.index("[[segment.device]]") :]
    servo = "".join(line.split("#")[0].rstrip() + "\n" for line in servo.splitlines())
    return SEGMENT.format(link=link, more=capture(), servo=servo, io_board=IO_BOARD)


def drive_rack(port, more="", bit_rate='"unlimited"'):
    """One TMCC160 that tells of itself as masters expect it."""
    return DRIVE.format(port=port, more=f"{capture()}\n{more}", bit_rate=bit_rate)
