"""The small EtherCAT master of a segment."""

from __future__ import annotations

import pytest

import stator


@pytest.fixture
def master(stepper: stator.Rack) -> stator.EtherCatMaster:
    return stepper.segment().master()


def test_a_scan_finds_who_is_there(master: stator.EtherCatMaster) -> None:
    (slave,) = master.scan()
    assert slave.name == "TMCM-3315"
    assert slave.station_address == 0x1001
    assert master.state() == ("init", 0)


def test_objects_by_sdo(master: stator.EtherCatMaster) -> None:
    assert master.upload(0x1008).decode() == "TMCM-3315"
    master.download(0x6081, 0, (4321).to_bytes(4, "little"))
    assert int.from_bytes(master.upload(0x6081), "little") == 4321
    assert 0x6041 in master.object_list()
    with pytest.raises(stator.MasterError) as aborted:
        master.upload(0x5FFF)
    assert aborted.value.code == "sdo-aborted"
    assert aborted.value.detail == 0x06020000


def test_process_data(stepper: stator.Rack, master: stator.EtherCatMaster) -> None:
    master.take_to("operational")
    assert master.state() == ("operational", 0)
    outputs = master.outputs()
    assert len(outputs) == 30
    controlword = next(entry for entry in master.output_mapping() if entry.index == 0x6040)
    image = bytearray(outputs)
    image[controlword.bit_offset // 8] = 0x06
    master.set_outputs(bytes(image))
    stepper.run(0.02)
    statusword = next(entry for entry in master.input_mapping() if entry.index == 0x6041)
    at = statusword.bit_offset // 8
    assert int.from_bytes(master.inputs()[at : at + 2], "little") & 0x6F == 0x21
    cycles, lost, wrong = master.statistics
    assert cycles > 10 and lost == 0 and wrong == 0
    with pytest.raises(stator.Error, match="30"):
        master.set_outputs(b"\0")


def test_refused_states_say_why(master: stator.EtherCatMaster) -> None:
    master.scan()
    with pytest.raises(stator.MasterError) as refused:
        master.request_state(0, "operational")
    assert refused.value.code == "state-refused"
    assert refused.value.detail == 0x0011
    with pytest.raises(stator.Error, match="did you mean"):
        master.take_to("operationl")
    with pytest.raises(stator.Error, match="no slave 7"):
        master.outputs(7)


def test_drives_say_what_is_wrong(stepper: stator.Rack) -> None:
    stepper.go_operational()
    drive = stepper["tmcm-3315"].axis[1].drive()
    assert drive.state == "Switch on disabled"
    with pytest.raises(stator.MasterError):
        drive.start_move(1)
    drive.enable()
    assert drive.state == "Operation enabled"
    stepper["tmcm-3315"].objects[0x6883] = stepper["tmcm-3315"].objects[0x6884] = 500_000
    drive.set_mode("profile-velocity")
    drive.run_at(50_000)
    stepper.run(0.5)
    assert drive.velocity == pytest.approx(50_000, rel=0.02)
    drive.quick_stop()
    drive.disable()
    with pytest.raises(stator.Error, match="profile-position"):
        drive.set_mode("profile-positon")
