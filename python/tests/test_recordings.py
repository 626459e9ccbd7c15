"""Recordings of racks, and bringing racks back to earlier moments."""

from __future__ import annotations

import gc
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy
import pytest
from conftest import FEEDER, SPINDLE

import stator

MICROSTEPS = 51_200
MOVER = {"segment": [{"device": [{"type": "tmcm-3315", "name": "x"}]}]}
#: All networks in one rack, with a load that a timetable brings.
MIXED = {
    **MOVER,
    "bus": SPINDLE["bus"],
    "device": FEEDER["device"],
    "event": [{"at": "30ms", "action": "set", "device": "x", "input": "axis1.load_torque", "value": 0.05}],
}


def program(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Runs stator with these arguments."""
    return subprocess.run(
        [os.environ["STATOR_PROGRAM"], *map(str, arguments)], capture_output=True, text=True, check=False, timeout=120
    )


def replayed(file: Path) -> str:
    """What the program says when it plays the recording, in which nothing is otherwise."""
    result = program("replay", file)
    assert result.returncode == 0, result.stdout + result.stderr
    assert "everything that came out is the same to the last bit" in result.stdout
    return result.stdout


def enabled(rack: stator.Rack, device: str = "x") -> stator.Drive:
    """A drive in profile position."""
    drive = rack[device].axis[0].drive()
    drive.enable()
    drive.set_mode("profile-position")
    return drive


def move(drive: stator.Drive, revolutions: float) -> None:
    drive.start_move(int(revolutions * MICROSTEPS), velocity=MICROSTEPS * 5, acceleration=MICROSTEPS * 20)


def all_bits(rack: stator.Rack) -> dict[str, bytes]:
    """Every sample of every signal so far, and when."""
    bits = {name: signal.numpy().tobytes() for name, signal in rack.signals.items()}
    bits["times"] = next(iter(rack.signals.values())).times().tobytes()
    return bits


def log_of(rack: stator.Rack) -> list[tuple[int, float, str, str]]:
    return [(event.number, event.time, event.device, event.text) for event in rack.events()]


# Recordings.


def everything(rack: stator.Rack) -> None:
    """Does a bit of everything that can be done to MIXED."""
    x, spindle, feeder = rack["x"], rack["spindle"], rack["feeder"]
    rack.go_operational()
    drive = enabled(rack)
    move(drive, 2)
    x.axis[0].inputs["load_torque"] = 0.1
    x.objects[0x6081] = 40_000
    assert x.objects[0x6064] is not None
    rack.inject("motor-stall", device="x", axis=0, at="5ms", for_="20ms")
    rack.run(0.05)
    feeder.tmcl(1, 0, 0, 500)  # ROR
    assert spindle.upload(0x1000)
    port = rack.bus().port()
    port.send(0x601, bytes([0x40, 0x64, 0x60, 0, 0, 0, 0, 0]))
    rack.run(0.02)
    while port.wait(0) is not None:
        pass
    port.close()
    spindle.powered = False
    rack.run(0.05)
    spindle.powered = True
    rack.clear_faults()
    feeder.tmcl(3)  # MST
    rack.run(0.1)


def test_what_masters_do_over_all_networks_is_played_to_the_bit(tmp_path: Path) -> None:
    file = tmp_path / "run.stator"
    with stator.Rack(MIXED, recording=file) as rack:
        assert rack.recording == file
        everything(rack)
        rack.mark("end")
    said = replayed(file)
    assert "0 EtherCAT frames" not in said
    assert "0 serial bytes" not in said


def test_a_replay_computes_the_same_signals(tmp_path: Path) -> None:
    file, table = tmp_path / "run.stator", tmp_path / "run.csv"
    with stator.Rack(MOVER, recording=file) as rack:
        rack.go_operational()
        move(enabled(rack), 1)
        rack.run(0.2)
        signal = rack["x"].axis[0]["shaft_position"]
        times, values = signal.times(), signal.numpy()
    assert program("replay", file, "--csv", table, "--signals", "x.axis0.shaft_position").returncode == 0
    rows = numpy.loadtxt(table, delimiter=",", skiprows=1)
    common = min(len(rows), len(values))
    assert common > 150
    assert rows[:common, 0] == pytest.approx(times[:common])
    assert rows[:common, 1] == pytest.approx(values[:common], rel=1e-6, abs=1e-9)


def test_record_is_for_a_rack_to_which_nothing_was_done(tmp_path: Path) -> None:
    file = tmp_path / "run.stator"
    with stator.Rack(MOVER) as rack:
        assert rack.recording is None
        assert list(rack["x"].signals), "looking is nothing that is done"
        rack.record(file)
        with pytest.raises(stator.Error, match="is recorded into .* already"):
            rack.record(tmp_path / "other.stator")
        rack.run(0.01)
        rack.end_recording()
        with pytest.raises(stator.Error, match="power-on"):
            rack.record(file)
    replayed(file)


@pytest.mark.parametrize(
    "deed",
    [
        lambda rack: rack.run(0.001),
        lambda rack: rack["x"].objects[0x6064],
        lambda rack: rack["x"].axis[0].inputs.update(load_torque=0.1),
        lambda rack: rack.inject("motor-stall", device="x", axis=0, at="1s"),
    ],
    ids=["time", "object", "input", "fault"],
)
def test_a_recording_cannot_begin_later(deed: Callable[[stator.Rack], object], tmp_path: Path) -> None:
    with stator.Rack(MOVER) as rack:
        deed(rack)
        with pytest.raises(stator.Error, match=r"begins at power-on.*recording="):
            rack.record(tmp_path / "run.stator")


def test_marks_have_a_name_once_and_need_a_recording(tmp_path: Path) -> None:
    with stator.Rack(MOVER) as rack, pytest.raises(stator.Error, match="not recorded"):
        rack.mark("here")
    with stator.Rack(MOVER, recording=tmp_path / "run.stator") as rack:
        rack.mark("here")
        with pytest.raises(stator.Error, match='"here"'):
            rack.mark("here")
        rack.end_recording()
        with pytest.raises(stator.Error, match="not recorded"):
            rack.mark("there")
        with pytest.raises(stator.Error, match="ended"):
            rack.end_recording()


def test_a_place_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    with pytest.raises(stator.Error, match="no-such-folder"):
        stator.Rack(MOVER, recording=tmp_path / "no-such-folder" / "run.stator")


def test_a_rack_file_and_what_it_names_travel_with_the_recording(tmp_path: Path) -> None:
    folder = tmp_path / "racks"
    folder.mkdir()
    (tmp_path / "programs").mkdir()
    source = tmp_path / "programs" / "turn.tmc"
    source.write_text("ROR 0, 500\nWAIT TICKS, 0, 50\nMST 0\nSTOP\n")
    rack_file = folder / "module.toml"
    rack_file.write_text(
        f'[[device]]\ntype = "tmcm-142"\nname = "feeder"\nrs485 = "pty:{tmp_path}/line"\nprogram = "../programs/turn.tmc"\n'
    )
    file = tmp_path / "run.stator"
    with stator.Rack(rack_file, recording=file, changes=["feeder.name=pump"]) as rack:
        assert list(rack) == ["pump"]
        rack["pump"].tmcl(129)  # RUN
        rack.run(0.3)
    source.unlink()
    rack_file.unlink()
    replayed(file)


def test_a_state_directory_that_a_lockstep_rack_leaves_alone_is_not_needed(tmp_path: Path) -> None:
    rack_file = tmp_path / "rack.toml"
    rack_file.write_text(
        'state = "kept"\n[[bus]]\n[[bus.device]]\ntype = "tmcc160"\nname = "spindle"\nfriendly = true\n'
    )
    file = tmp_path / "run.stator"
    with stator.Rack(rack_file, recording=file) as rack:
        rack["spindle"].wait_for_boot_up()
        rack["spindle"].download(0x1010, 1, b"save")
        rack.run(0.1)
    assert not (tmp_path / "kept").exists()
    replayed(file)


def test_a_product_alone_is_recorded(tmp_path: Path) -> None:
    for product in ("tmcm-3315", "tmcc160", "tmcm-142"):
        file = tmp_path / f"{product}.stator"
        with stator.Rack(product, recording=file) as rack:
            rack.run(0.1)
        replayed(file)


def test_programs_on_the_bus_are_recorded_whenever_they_come(tmp_path: Path) -> None:
    can = pytest.importorskip("can")
    file = tmp_path / "run.stator"
    with stator.Rack(SPINDLE, recording=file) as rack:
        rack["spindle"].wait_for_boot_up()
        for _ in range(2):
            with can.Bus(interface="stator", channel=rack.bus()) as bus:
                bus.send(can.Message(arbitration_id=0x601, data=[0x40, 0, 0x10, 0, 0, 0, 0, 0], is_extended_id=False))
                answer = bus.recv(1.0)
                while answer is not None and answer.arbitration_id == 0x701:  # boot-up, heartbeat
                    answer = bus.recv(1.0)
                assert answer is not None and answer.arbitration_id == 0x581
            rack.run(0.05)
    assert "2 CAN frames" in replayed(file)


def test_a_paced_rack_is_recorded(tmp_path: Path) -> None:
    file = tmp_path / "run.stator"
    with stator.Rack(MOVER, recording=file) as rack:
        rack.go_operational()
        rack.start(speed=20)
        move(enabled(rack), 1)
        rack.run(0.3)
        rack.stop()
    replayed(file)


def test_a_rack_on_links_is_recorded(tmp_path: Path) -> None:
    file = tmp_path / "run.stator"
    line = tmp_path / "line"
    source = {"device": [{"type": "tmcm-142", "name": "x", "rs485": f"pty:{line}"}]}
    with stator.Rack(source, links=True, recording=file) as rack:
        rack["x"].axis[0].inputs["load_torque"] = 0.01
        host = os.open(line, os.O_RDWR | os.O_NOCTTY)
        os.write(host, bytes([1, 1, 0, 0, 0, 0, 1, 0, 3]))  # ROR 0, 256
        answer = b""
        while len(answer) < 9:
            answer += os.read(host, 9)
        os.close(host)
        assert answer[2] == 100
        rack.run(0.05)
        rack.mark("later")
        with pytest.raises(stator.Error, match="outside"):
            rack.snapshot()
    assert "9 serial bytes" in replayed(file)
    with pytest.raises(stator.Error, match="rewindable"):
        stator.Rack(source, links=True, rewindable=True)


# Back.


@pytest.fixture
def rewindable():
    with stator.Rack(MIXED, rewindable=True, limit=300) as rack:
        yield rack


def test_a_rack_goes_back_and_then_the_same_way_to_the_bit(rewindable: stator.Rack) -> None:
    rack = rewindable
    rack.go_operational()
    drive = enabled(rack)
    speed = rack["x"].axis[0]["shaft_speed"]
    rack.run(0.05)
    moment = rack.snapshot("before the move")
    assert (moment.name, moment.time) == ("before the move", rack.now)

    def way() -> tuple[dict[str, bytes], list[tuple[int, float, str, str]], float]:
        move(drive, 1)
        rack["feeder"].tmcl(1, 0, 0, 300)
        assert rack["spindle"].upload(0x1008)
        rack.run(0.2)
        return all_bits(rack), log_of(rack), speed.value

    before = all_bits(rack)
    first = way()
    rack.rewind(moment)
    assert rack.now == moment.time
    assert all_bits(rack) == before
    assert way() == first
    rack.rewind(moment)
    assert way() == first


def test_another_way_is_another(rewindable: stator.Rack) -> None:
    rack = rewindable
    rack.go_operational()
    drive = enabled(rack)
    position = rack["x"].axis[0]["shaft_position"]
    moment = rack.snapshot()
    begin = position.value
    ends = []
    for revolutions in (1, -1):
        move(drive, revolutions)
        drive.wait_for_target(5)
        rack.run(0.1)
        ends.append(position.value)
        later = rack.snapshot(f"after {revolutions}")
        rack.rewind(moment)
        assert position.value == begin
    assert ends == pytest.approx([begin + 1, begin - 1], abs=0.02)  # revolutions
    rack.rewind(later)  # of a way that was not taken
    assert position.value == ends[1]
    assert drive.position == pytest.approx(-MICROSTEPS, abs=2)


def test_a_drive_that_was_disabled_meanwhile_is_enabled_again(rewindable: stator.Rack) -> None:
    rack = rewindable
    rack.go_operational()
    drive = enabled(rack)
    moment = rack.snapshot()
    drive.disable()
    rack.rewind(moment)
    assert drive.state == "Operation enabled"
    move(drive, 1)  # with the controlword of then
    drive.wait_for_target(5)
    assert drive.state == "Operation enabled"


def test_the_master_of_a_segment_knows_what_it_knew(rewindable: stator.Rack) -> None:
    rack = rewindable
    master = rack.segment().master()
    master.scan()
    scanned = rack.snapshot("scanned")
    rack.go_operational()
    operational = rack.snapshot("operational")
    statistics = master.statistics
    master.scan()
    rack.rewind(operational)
    assert master.state() == ("operational", 0)
    assert master.statistics == statistics
    rack.run(0.01)
    assert master.statistics[0] == statistics[0] + 10
    assert master.statistics[1:] == statistics[1:]
    rack.rewind(scanned)
    assert master.state() == ("init", 0)
    assert rack["x"].upload(0x1018, 1) == bytes([0x86, 0x02, 0, 0])


def test_faults_surroundings_and_supply_come_back(rewindable: stator.Rack) -> None:
    rack = rewindable
    number = rack.inject("motor-stall", device="x", axis=0, at="1s")
    rack["x"].axis[0].inputs["load_torque"] = 0.02
    moment = rack.snapshot()
    rack.clear_faults(number)
    rack["x"].axis[0].inputs["load_torque"] = 0.3
    rack["spindle"].powered = False
    rack.run(0.1)
    rack.rewind(moment)
    assert rack["x"].axis[0].inputs["load_torque"] == 0.02
    assert rack["spindle"].powered
    assert [fault.state for fault in rack.faults()] == ["armed"]


def test_ports_of_then_go_on_and_later_ones_are_closed(rewindable: stator.Rack) -> None:
    rack = rewindable
    rack["spindle"].wait_for_boot_up()
    ask = bytes([0x40, 0x00, 0x10, 0, 0, 0, 0, 0])
    early = rack.bus().port()
    early.send(0x601, ask)
    rack.run(0.01)
    waiting = early.waiting
    assert waiting > 0
    moment = rack.snapshot()
    frames = [early.wait(0) for _ in range(waiting)]
    late = rack.bus().port()
    closed = rack.bus().port()
    closed.close()
    rack.rewind(moment)
    assert early.waiting == waiting
    assert [early.wait(0) for _ in range(waiting)] == frames
    with pytest.raises(stator.Error, match="opened after the moment"):
        late.send(0x601, ask)
    with pytest.raises(stator.Error, match="the port is closed$"):
        closed.send(0x601, ask)
    anew = rack.bus().port()
    anew.send(0x601, ask)
    rack.run(0.01)
    assert anew.waiting > 0


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # of the notifier of the later bus
def test_programs_of_python_can_go_on(tmp_path: Path) -> None:
    canopen = pytest.importorskip("canopen")
    with stator.Rack(SPINDLE, recording=tmp_path / "run.stator", limit=300) as rack:
        network = canopen.Network()
        network.connect(interface="stator", channel=rack.bus())
        rack["spindle"].wait_for_boot_up()
        node = network.add_node(1, rack["spindle"].eds())
        assert node.sdo[0x1000].raw
        moment = rack.snapshot()
        rack.run(0.1)
        later = canopen.Network()
        later.connect(interface="stator", channel=rack.bus())
        rack.rewind(moment)
        assert node.sdo[0x1008].raw
        rack.run(0.05)  # does not wait for the one that is closed
        network.disconnect()
        assert rack.recording == tmp_path / "run-2.stator"
    replayed(tmp_path / "run.stator")
    replayed(tmp_path / "run-2.stator")


def test_the_new_way_is_recorded_from_power_on(tmp_path: Path) -> None:
    file = tmp_path / "run.stator"
    with stator.Rack(MIXED, recording=file) as rack:
        everything(rack)
        moment = rack.snapshot("everything")
        rack.run(0.1)
        rack.rewind(moment)
        move(enabled(rack), -1)
        rack.run(0.3)
        rack.rewind(moment)
        assert rack.recording == tmp_path / "run-3.stator"
        rack.run(0.01)
    for name in ("run", "run-2", "run-3"):
        replayed(tmp_path / f"{name}.stator")


def test_a_rack_that_is_not_recorded_is_not_brought_back(tmp_path: Path) -> None:
    with stator.Rack(MOVER) as rack, pytest.raises(stator.Error, match="rewindable=True"):
        rack.snapshot()
    with stator.Rack(MOVER, rewindable=True) as one, stator.Rack(MOVER, rewindable=True) as other:
        moment = one.snapshot()
        with pytest.raises(stator.Error, match="another rack"):
            other.rewind(moment)
        one.start()
        with pytest.raises(stator.Error, match=r"stop\(\)"):
            one.rewind(moment)
        one.stop()
    file = tmp_path / "run.stator"
    with stator.Rack(MOVER, recording=file) as rack:
        moment = rack.snapshot()
        rack.run(0.01)
        file.unlink()
        with pytest.raises(stator.Error, match=r"run\.stator"):
            rack.rewind(moment)
        rack.run(0.01)  # it goes on
        rack.mark("still recorded")


def test_temporary_recordings_go_with_their_rack(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    with stator.Rack(MOVER, rewindable=True) as rack:
        rack.run(0.01)
        assert rack.recording is None
        assert len(list(tmp_path.rglob("*.stator"))) == 1
        moment = rack.snapshot()
        for _ in range(5):
            rack.run(0.01)
            rack.rewind(moment)
        assert len(list(tmp_path.rglob("*.stator"))) == 2, "that of the moment and that of the present way"
        moment = rack.snapshot("of this way")
        gc.collect()
        assert len(list(tmp_path.rglob("*.stator"))) == 1
        rack.rewind(moment)
    del rack
    gc.collect()
    assert not list(tmp_path.iterdir())
