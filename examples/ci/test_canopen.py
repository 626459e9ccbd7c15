"""A master on python-canopen that turns a drive: the test of a user, on a rack in the process of the test.

pip install 'stator[canopen]' pytest; stator export eds tmcc160 -o tmcc160.eds; pytest
"""

import canopen
import pytest
from canopen.profiles.p402 import BaseNode402


@pytest.fixture
def drive(stator_rack):
    """The drive as a master of CiA 402 has it, in Operational."""
    network = canopen.Network()
    network.connect(interface="stator", channel=stator_rack.bus())
    stator_rack["spindle"].wait_for_boot_up()
    node = BaseNode402(1, "tmcc160.eds")
    network.add_node(node)
    network.nmt.state = "OPERATIONAL"
    node.setup_402_state_machine(False)
    yield node
    network.disconnect()


@pytest.mark.stator_rack("can.toml")
def test_the_drive_reaches_its_velocity(stator_rack, drive):
    drive.op_mode = "PROFILED VELOCITY"
    for state in ("READY TO SWITCH ON", "SWITCHED ON", "OPERATION ENABLED"):
        drive.state = state
    drive.sdo["Target velocity"].raw = 500
    stator_rack.run(2.0)  # simulated seconds: no test waits for a motor
    assert drive.sdo["Velocity actual value"].raw == pytest.approx(500, abs=25)
    assert stator_rack["spindle"].axis[0]["shaft_speed"].value == pytest.approx(500 / 60, rel=0.05)
