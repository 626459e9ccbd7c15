"""python-can, python-canopen and PyTrinamic on racks of this process."""

from __future__ import annotations

import threading

import pytest
from conftest import FEEDER, SPINDLE

import stator

can = pytest.importorskip("can")
canopen = pytest.importorskip("canopen")


@pytest.fixture
def bus(spindle: stator.Rack):
    with can.Bus(interface="stator", channel=spindle.bus()) as bus:
        yield bus


def read(bus, index: int) -> bytes:
    request = bytes([0x40, index & 0xFF, index >> 8, 0, 0, 0, 0, 0])
    bus.send(can.Message(arbitration_id=0x601, data=request, is_extended_id=False))
    while True:
        answer = bus.recv(1.0)
        assert answer is not None
        if answer.arbitration_id == 0x581:
            return bytes(answer.data)


def test_frames_go_and_come(spindle: stator.Rack, bus) -> None:
    spindle["spindle"].wait_for_boot_up()
    assert read(bus, 0x1000)[4:6] == bytes([0x92, 0x01])


def test_waiting_lets_simulated_time_pass(spindle: stator.Rack, bus) -> None:
    boot = bus.recv(10.0)
    assert boot is not None and boot.arbitration_id == 0x701
    assert boot.timestamp == pytest.approx(spindle.now, abs=0.002)
    spindle.run(0.01)
    while bus.recv(0) is not None:
        pass
    before = spindle.now
    assert bus.recv(0) is None
    assert spindle.now == before
    heartbeat = bus.recv(10.0)
    assert heartbeat is not None and heartbeat.arbitration_id == 0x701
    assert before < spindle.now == pytest.approx(heartbeat.timestamp, abs=0.002)


def test_a_sync_is_a_cycle(spindle: stator.Rack, bus) -> None:
    spindle["spindle"].wait_for_boot_up()
    before = spindle.now
    bus.send(can.Message(arbitration_id=0x80, is_extended_id=False))
    assert spindle.now == pytest.approx(before + 0.001, abs=2e-4)


def test_frames_that_a_bus_cannot_carry_are_refused(bus) -> None:
    with pytest.raises(ValueError, match="classical"):
        bus.send(can.Message(is_error_frame=True))
    with pytest.raises(ValueError, match="classical"):
        bus.send(can.Message(is_fd=True, data=bytes(12)))


def test_wrong_channels_are_named(spindle: stator.Rack) -> None:
    with pytest.raises(can.CanInitializationError, match="rack.bus"):
        can.Bus(interface="stator", channel="can0")
    spindle.close()
    with pytest.raises((can.CanInitializationError, stator.Error), match="closed"):
        can.Bus(interface="stator", channel=spindle.bus())


def test_a_rack_may_close_before_its_buses(spindle: stator.Rack) -> None:
    bus = can.Bus(interface="stator", channel=spindle.bus())
    spindle.close()
    with pytest.raises(can.CanOperationError):
        bus.send(can.Message(arbitration_id=0x601, data=bytes(8)))
    bus.shutdown()


def test_two_programs_see_each_other(spindle: stator.Rack) -> None:
    with (
        can.Bus(interface="stator", channel=spindle.bus()) as one,
        can.Bus(interface="stator", channel=spindle.bus()) as other,
    ):
        one.send(can.Message(arbitration_id=0x123, data=b"hello", is_extended_id=False))
        frames = []
        while (frame := other.recv(0)) is not None:
            frames.append(frame)
        assert [bytes(frame.data) for frame in frames if frame.arbitration_id == 0x123] == [b"hello"]


@pytest.fixture
def network(spindle: stator.Rack):
    network = canopen.Network()
    network.connect(interface="stator", channel=spindle.bus())
    spindle["spindle"].wait_for_boot_up()
    spindle.settle()
    yield network
    network.disconnect()


def test_canopen_turns_the_spindle_in_lockstep(spindle: stator.Rack, network) -> None:
    from canopen.profiles.p402 import BaseNode402

    node = BaseNode402(1, spindle["spindle"].eds())
    network.add_node(node)
    network.nmt.state = "OPERATIONAL"
    node.setup_402_state_machine(False)
    node.op_mode = "PROFILED VELOCITY"
    node.state = "READY TO SWITCH ON"
    node.state = "SWITCHED ON"
    node.state = "OPERATION ENABLED"
    assert node.state == "OPERATION ENABLED"
    node.sdo[0x60FF].raw = 500
    spindle.run(2.0)
    assert node.sdo[0x606C].raw == pytest.approx(500, abs=25)
    speed = spindle["spindle"].axis[0]["shaft_speed"]
    assert speed.value > 0


def test_heartbeats_reach_canopen_while_time_runs(spindle: stator.Rack, network) -> None:
    node = network.add_node(1)
    node.nmt.state = "OPERATIONAL"
    spindle.run(2.5)
    assert node.nmt.state == "OPERATIONAL"


def test_canopen_in_real_time() -> None:
    with stator.Rack(SPINDLE) as rack:
        rack.start()
        network = canopen.Network()
        network.connect(interface="stator", channel=rack.bus())
        try:
            node = network.add_node(1, rack["spindle"].eds())
            node.nmt.wait_for_bootup(60)
            assert node.sdo[0x1008].raw.startswith("TMCC160")
        finally:
            network.disconnect()


def test_a_listener_that_runs_the_rack_does_not_block(spindle: stator.Rack) -> None:
    seen = threading.Event()
    with can.Bus(interface="stator", channel=spindle.bus()) as bus:

        def listen(message) -> None:
            spindle.run(0.001)
            seen.set()

        notifier = can.Notifier(bus, [listen])
        spindle.run(1.0)
        assert seen.wait(60)
        notifier.stop()


def test_pytrinamic_on_a_line_of_the_rack() -> None:
    pytest.importorskip("pytrinamic")
    from stator.pytrinamic import Connection

    with stator.Rack(FEEDER, limit=60) as rack, Connection(rack.line()) as connection:
        assert "142" in connection.get_version_string()
        connection.move_to(0, 51_200, 1)
        assert rack.wait_until(lambda: connection.get_axis_parameter(8, 0, 1) == 1, 30)
        assert connection.get_axis_parameter(1, 0, 1, signed=True) == 51_200
        assert rack["feeder"].axis[0]["shaft_position"].value != 0


def test_a_module_that_does_not_answer_times_out_in_simulated_time() -> None:
    pytest.importorskip("pytrinamic")
    from stator.pytrinamic import Connection

    with stator.Rack(FEEDER, limit=60) as rack:
        connection = Connection(rack.line(), module_id=77, timeout_s=0.5)
        before = rack.now
        with pytest.raises(RuntimeError, match="no reply"):
            connection.get_version_string()
        assert rack.now >= before + 0.5
