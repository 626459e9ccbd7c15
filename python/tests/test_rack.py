"""Racks: building them, time, signals, inputs, objects, events, faults."""

from __future__ import annotations

import gc
import os
import threading
import time

import numpy
import pytest
from conftest import SPINDLE

import stator

MICROSTEPS = 51_200


def move_of(rack: stator.Rack, revolutions: float) -> stator.Drive:
    """Moves the first axis of the first device."""
    rack.go_operational()
    drive = next(iter(rack.values())).axis[0].drive()
    drive.enable()
    drive.set_mode("profile-position")
    drive.start_move(int(revolutions * MICROSTEPS), velocity=MICROSTEPS * 5, acceleration=MICROSTEPS * 20)
    return drive


def test_a_product_alone_is_a_rack(stepper: stator.Rack) -> None:
    assert list(stepper) == ["tmcm-3315"]
    device = stepper["tmcm-3315"]
    assert [axis.number for axis in device.axis] == [0, 1, 2]
    assert device.network == "segment"
    assert stepper.now == 0.0


def test_a_drive_moves_and_its_shaft_follows(stepper: stator.Rack) -> None:
    drive = move_of(stepper, 3)
    drive.wait_for_target(5)
    stepper.run(0.1)
    assert abs(drive.position - 3 * MICROSTEPS) <= 1
    position = stepper["tmcm-3315"].axis[0]["shaft_position"]
    assert position.value == pytest.approx(3 * 2 * numpy.pi if position.unit == "rad" else 3, abs=0.02)


def test_equal_runs_have_equal_bits() -> None:
    def run() -> numpy.ndarray:
        with stator.Rack("tmcm-3315") as rack:
            move_of(rack, 1)
            rack.run(0.3)
            return rack["tmcm-3315"].axis[0]["shaft_speed"].numpy()

    first, second = run(), run()
    assert len(first) > 300
    assert first.tobytes() == second.tobytes()


def test_recorded_signals_are_looked_at_not_copied(stepper: stator.Rack) -> None:
    stepper.run(0.05)
    signal = stepper.signals["tmcm-3315.axis0.shaft_position"]
    early = signal.numpy()
    assert not early.flags.owndata
    assert not early.flags.writeable
    assert numpy.shares_memory(early, signal.numpy())
    times = signal.times()
    assert len(times) == len(early) == 51
    assert numpy.diff(times) == pytest.approx(0.001)
    kept = early.copy()
    stepper.run(5)
    assert numpy.array_equal(early, kept)
    assert len(signal.numpy()) == 5051
    assert stepper.native.lost_samples == 0


def test_arrays_outlive_their_rack() -> None:
    with stator.Rack("tmcm-3315") as rack:
        rack.run(0.01)
        values = rack.signals["tmcm-3315.axis0.supply_voltage"].numpy()
    del rack
    gc.collect()
    assert values.min() > 0


def test_only_named_signals_are_recorded() -> None:
    with stator.Rack("tmcm-3315", signals=["*.axis1.shaft_*"], period=0.01) as rack:
        rack.run(0.1)
        assert len(rack["tmcm-3315"].axis[1]["shaft_speed"].numpy()) == 11
        with pytest.raises(stator.Error, match="is not recorded"):
            rack["tmcm-3315"].axis[0]["shaft_speed"].numpy()
    with stator.Rack("tmcm-3315", signals=()) as rack, pytest.raises(stator.Error, match="records no signals"):
        rack["tmcm-3315"].axis[0]["shaft_speed"].numpy()


def test_inputs_act_on_the_motor(stepper: stator.Rack) -> None:
    inputs = stepper["tmcm-3315"].axis[0].inputs
    assert inputs.info("load_torque").unit == "Nm"
    assert inputs["load_torque"] == 0.0
    inputs["load_torque"] = 0.25
    assert stepper["tmcm-3315"].inputs["axis0.load_torque"] == 0.25
    del inputs["load_torque"]
    assert inputs["load_torque"] == 0.0
    with pytest.raises(stator.Error):
        inputs["load_torque"] = 1e9
    with pytest.raises(KeyError, match="axis0.load_torque"):
        stepper["tmcm-3315"].inputs["load_torque"] = 1.0  # which axis?


def test_names_that_do_not_exist_are_answered_with_those_that_do(stepper: stator.Rack) -> None:
    with pytest.raises(KeyError, match="tmcm-3315"):
        stepper["tmcm-3351"]
    with pytest.raises(KeyError, match="shaft_speed"):
        stepper["tmcm-3315"].axis[0]["shaft_sped"]
    with pytest.raises(IndexError, match="no segment 1"):
        stepper.segment(1)


def test_objects_are_read_and_written_beside_the_network(stepper: stator.Rack) -> None:
    objects = stepper["tmcm-3315"].objects
    assert objects[0x1018, 0] == 3
    assert objects[0x1018, 1] == 0x286
    assert objects[0x1008] == "TMCM-3315"
    objects[0x6081] = 12_345
    assert objects[0x6081] == 12_345
    assert objects.describe(0x6081)["data_type"] == "UNSIGNED32"
    assert (0x607A, 0) in objects and 0x607B not in objects
    assert len(objects) > 300
    with pytest.raises(stator.ObjectRefused) as refused:
        objects[0x6064] = 1
    assert refused.value.abort_code == 0x06010002
    assert "read-only" in str(refused.value)
    with pytest.raises(stator.ObjectRefused) as missing:
        objects[0x5FFF]
    assert missing.value.abort_code == 0x06020000
    for wrong in (-1, 2**32, 1.5, "text"):
        with pytest.raises(ValueError, match="UNSIGNED32"):
            objects[0x6081] = wrong


def test_what_happens_is_told_in_sentences(stepper: stator.Rack) -> None:
    move_of(stepper, 1)
    events = stepper.events()
    assert [event.number for event in events] == list(range(1, len(events) + 1))
    assert any("Operational" in event.text for event in events)
    assert stepper.events(after=events[-1].number) == []
    assert stepper.native.event_count(events[0].id) >= 1


def test_a_fault_stalls_the_motor(stepper: stator.Rack) -> None:
    drive = move_of(stepper, 20)
    number = stepper.inject("motor-stall", device="tmcm-3315", axis=0, at="300ms", for_="50ms")
    assert [fault.state for fault in stepper.faults()] == ["armed"]
    stepper.run(0.31 - stepper.now)
    assert [fault.state for fault in stepper.faults()] == ["active"]
    assert stepper.clear_faults(number) == 1
    drive.wait_for_target(10)
    assert abs(stepper["tmcm-3315"].axis[0]["shaft_position"].value) < 20 * 6.4
    with pytest.raises(stator.Error, match="motor-stall"):
        stepper.inject("motor-stal", device="tmcm-3315")


def test_supply_goes_and_comes(stepper: stator.Rack) -> None:
    device = stepper["tmcm-3315"]
    stepper.run(0.01)
    device.powered = False
    stepper.run(0.01)
    assert not device.powered
    device.powered = True
    stepper.run(0.1)
    assert device.powered


def test_mistakes_in_racks_name_place_and_remedy(tmp_path) -> None:
    with pytest.raises(stator.RackFileError, match="typ"):
        stator.Rack({"segment": [{"device": [{"type": "tmcm-3315", "nmae": "x"}]}]})
    file = tmp_path / "wrong.toml"
    file.write_text('[[segment]]\n[[segment.device]]\ntype = "tmcm-3315"\nnmae = "x"\n')
    with pytest.raises(stator.RackFileError) as mistake:
        stator.Rack(file)
    assert mistake.value.line == 4
    assert mistake.value.file == str(file)
    with pytest.raises(TypeError, match=r"segment\[0\]"):
        stator.Rack({"segment": [None]})
    with pytest.raises(stator.Error, match="0 .. "):
        stator.Rack("tmcm-3315", limit=-1)


def test_changes_are_those_of_the_option_set() -> None:
    with stator.Rack("tmcm-3315", changes=["tmcm-3315.axis[0].supply_voltage=24"]) as rack:
        rack.run(0.01)
        assert rack["tmcm-3315"].axis[0]["supply_voltage"].value == pytest.approx(24, abs=0.1)


def test_a_limit_of_time_ends_what_hangs() -> None:
    with stator.Rack("tmcm-3315", limit=0.5) as rack, pytest.raises(stator.TimeLimitReached, match="0.5 s"):
        rack.wait_until(lambda: False, 1000)


def test_waiting_for_a_condition(stepper: stator.Rack) -> None:
    drive = move_of(stepper, 1)
    speed = stepper["tmcm-3315"].axis[0]["shaft_speed"]
    assert stepper.wait_until(lambda: speed.value > 1, 1)
    assert not stepper.wait_until(lambda: False, 0.01)
    drive.wait_for_target(5)


def test_a_rack_follows_the_machines_clock_until_it_is_stopped() -> None:
    with stator.Rack("tmcm-3315") as rack:
        rack.start(speed=20)
        with pytest.raises(stator.Error, match="runs already"):
            rack.start()
        before = rack.now
        rack.run(0.5)
        assert rack.now >= before + 0.5
        rack.stop()
        stands = rack.now
        time.sleep(0.01)
        assert rack.now == stands
        for wrong in (0, -1, float("nan")):
            with pytest.raises(stator.Error, match="speed"):
                rack.start(wrong)


def test_the_interpreter_is_free_while_a_rack_runs(stepper: stator.Rack) -> None:
    counted = 0
    done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1

    thread = threading.Thread(target=count)
    thread.start()
    before = counted
    stepper.run(2)
    assert counted > before
    done.set()
    thread.join()


def test_threads_share_a_rack(stepper: stator.Rack) -> None:
    failures: list[Exception] = []

    def use() -> None:
        try:
            for _ in range(50):
                stepper.run(0.001)
                stepper["tmcm-3315"].axis[0]["shaft_speed"].numpy()
                stepper.events()
        except Exception as error:  # noqa: BLE001  what a thread raised is looked at below
            failures.append(error)

    threads = [threading.Thread(target=use) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    assert stepper.now == pytest.approx(0.4)


def test_a_closed_rack_says_so(stepper: stator.Rack) -> None:
    signal = stepper["tmcm-3315"].axis[0]["shaft_speed"]
    drive_source = stepper["tmcm-3315"].axis[0]
    stepper.close()
    stepper.close()
    assert stepper.closed
    for use in (
        lambda: stepper.run(1),
        lambda: stepper.events(),
        lambda: signal.value,
        lambda: drive_source.drive(),
        lambda: stepper.inject("motor-stall", device="tmcm-3315"),
    ):
        with pytest.raises(stator.Error, match="closed"):
            use()


def test_hundred_racks_come_and_go() -> None:
    for _ in range(50):
        for source in ("tmcm-3315", SPINDLE):
            with stator.Rack(source) as rack:
                rack.run(0.002)
    gc.collect()


def test_threads_of_a_rack_go_with_its_last_name() -> None:
    def threads() -> int:
        return len(os.listdir("/proc/self/task"))

    before = threads()
    rack = stator.Rack("tmcm-3315")
    rack.start()
    assert threads() == before + 1
    device = rack["tmcm-3315"]
    del rack
    gc.collect()
    assert device.rack.native.running
    del device
    gc.collect()
    assert threads() == before
