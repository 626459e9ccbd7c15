"""An EtherCAT master on pysoem, as a user has one: it turns the first axis of a TMCM-3315 by one revolution.

python3 ethercat_master.py INTERFACE
"""

import struct
import sys
import time

import pysoem

REVOLUTION = 51_200  # microsteps
PATIENCE = 60.0  # s, for each thing that is waited for
ANSWER = 1_000_000  # us; a loaded machine of a CI takes its time
RELATIVE_MOVE = 0x5F  # controlword: enabled, new set-point, change at once, relative
ENABLING = (0x06, 0x21), (0x07, 0x23), (0x0F, 0x27)  # controlword, and the state in the statusword that follows


class Axis:
    """The first axis, in process data as 1600h and 1A00h map them."""

    def __init__(self, master):
        """The only slave of the segment has it."""
        self.master = master
        self.drive = master.slaves[0]
        self.command(0)

    def command(self, controlword, target=0):
        """What goes out with the next frames."""
        outputs = bytearray(self.drive.output)
        struct.pack_into("<Hi", outputs, 0, controlword, target)
        self.drive.output = bytes(outputs)

    def exchange(self):
        """Statusword and position that come back with one frame, None if none came."""
        self.master.send_processdata()
        if self.master.receive_processdata(ANSWER) < self.master.expected_wkc:
            return None
        return struct.unpack_from("<Hi", self.drive.input)

    def wait(self, what, condition):
        """Exchanges process data until the condition holds for what came back; returns that."""
        limit = time.monotonic() + PATIENCE
        while (answer := self.exchange()) is None or not condition(*answer):
            if time.monotonic() > limit:
                sys.exit(f"{what}: not within {PATIENCE:.0f} s, last answer {answer}")
            time.sleep(0.001)
        return answer


def main():
    """Ends with a sentence and exit status 1 where something is not as it should be."""
    pysoem.settings.timeouts.ret = 100_000
    pysoem.settings.timeouts.eeprom = pysoem.settings.timeouts.safe = ANSWER
    master = pysoem.Master()
    master.sdo_read_timeout = master.sdo_write_timeout = ANSWER
    master.open(sys.argv[1])
    found = master.config_init()
    if found != 1:
        sys.exit(f"{max(found, 0)} slaves on the segment, expected one")
    drive = master.slaves[0]
    drive.sdo_write(0x6060, 0, struct.pack("<b", 1))  # profile position
    for index, value in ((0x6081, 4 * REVOLUTION), (0x6083, 20 * REVOLUTION), (0x6084, 20 * REVOLUTION)):
        drive.sdo_write(index, 0, struct.pack("<I", value))
    master.config_map()
    drive.set_watchdog("processdata", 5000.0)
    axis = Axis(master)
    if master.state_check(pysoem.SAFEOP_STATE, ANSWER) != pysoem.SAFEOP_STATE:
        sys.exit(f"Safe-Operational is refused: {pysoem.al_status_code_to_string(drive.al_status)}")
    axis.exchange()
    master.state = pysoem.OP_STATE
    master.write_state()
    axis.wait("Operational", lambda *_: master.read_state() == pysoem.OP_STATE)

    for controlword, state in ENABLING:
        axis.command(controlword)
        _, start = axis.wait(f"controlword {controlword:02X}h", lambda status, _, state=state: status & 0x6F == state)
    axis.command(RELATIVE_MOVE, REVOLUTION)
    axis.wait("set-point acknowledged", lambda status, _: status & 0x1000)
    axis.command(0x0F)
    _, end = axis.wait("target reached", lambda status, _: not status & 0x1000 and status & 0x0400)
    print(f"moved by {end - start} microsteps")
    if abs(end - start - REVOLUTION) > 16:
        sys.exit(f"expected {REVOLUTION}")
    axis.command(0)
    axis.exchange()
    master.state = pysoem.INIT_STATE
    master.write_state()
    master.close()


if __name__ == "__main__":
    main()
