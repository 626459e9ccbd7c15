"""Racks in programs with an event loop."""

from __future__ import annotations

import asyncio

import pytest

import stator


def test_other_tasks_go_on_while_time_passes(stepper: stator.Rack) -> None:
    async def count(turns: list[int]) -> None:
        while True:
            turns[0] += 1
            await asyncio.sleep(0)

    async def program() -> int:
        turns = [0]
        counter = asyncio.create_task(count(turns))
        await stepper.run_async(1.0)
        counter.cancel()
        return turns[0]

    assert asyncio.run(program()) > 10
    assert stepper.now == pytest.approx(1.0, abs=0.002)


def test_time_is_the_same_as_without_an_event_loop(stepper: stator.Rack) -> None:
    asyncio.run(stepper.run_async(0.123))
    with stator.Rack("tmcm-3315") as other:
        other.run(0.123)
        assert other.now == stepper.now


def test_a_condition_is_waited_for(stepper: stator.Rack) -> None:
    stepper.go_operational()
    drive = stepper["tmcm-3315"].axis[0].drive()
    drive.enable()
    drive.set_mode("profile-position")
    drive.start_move(5000, velocity=50_000, acceleration=500_000)

    async def program() -> tuple[bool, bool]:
        reached = await stepper.wait_until_async(lambda: drive.target_reached, 20.0)
        never = await stepper.wait_until_async(lambda: False, 0.01)
        return reached, never

    assert asyncio.run(program()) == (True, False)
    assert drive.position == pytest.approx(5000, abs=20)


def test_it_can_be_cancelled(stepper: stator.Rack) -> None:
    async def program() -> None:
        task = asyncio.create_task(stepper.run_async(1e6))
        while stepper.now < 0.1:
            await asyncio.sleep(0.001)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task

    asyncio.run(program())
    assert stepper.now < 250
