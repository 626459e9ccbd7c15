"""Devices whose objects and behaviour are written in Python."""

from __future__ import annotations

import gc
import threading
import weakref

import pytest

import stator

BUS = {"bus": [{"device": [{"type": "probe", "name": "probe", "node_id": 9}]}]}
SEGMENT = {"segment": [{"device": [{"type": "lamp", "name": "lamp"}]}]}


class Probe(stator.CanOpenDevice):
    """A distance probe that goes along at 100 mm/s and can be set back."""

    type = "probe"
    name = "PROBE"
    vendor = 0x1234
    code = 7
    objects = (
        stator.Object(0x6004, "Position value", "integer32", access="ro", pdo="transmit", unit="um"),
        stator.Object(0x6003, "Preset value", "integer32", minimum=-1000, maximum=1000),
        stator.Object(0x2000, "Label", "visible-string", default="left"),
        *stator.record(
            0x2001,
            "Limits",
            [stator.Object(0, "Low", "integer16", default=-5), stator.Object(0, "Gain", "real32", default=0.5)],
        ),
        stator.Object(0x2002, "Temperature", "real64", access="ro"),
    )

    def start(self) -> None:
        self.zero = 0
        self.starts = getattr(self, "starts", 0) + 1

    def step(self, now: float) -> None:
        self[0x6004] = round(now * 1e5) - self.zero

    def check(self, index: int, subindex: int, value: stator.Value) -> None:
        if index == 0x6003 and value == 13:
            raise stator.ObjectRefused("13 brings bad luck", 0x06090030)

    def written(self, index: int, subindex: int, value: stator.Value) -> None:
        if index == 0x6003:
            self.zero += int(self[0x6004]) - int(value)

    def read(self, index: int, subindex: int) -> stator.Value | None:
        return 21.5 if index == 0x2002 else None


class Lamp(stator.EtherCatDevice):
    """A lamp with one output and one input."""

    type = "lamp"
    name = "LAMP"
    objects = (
        stator.Object(0x6000, "Light", "unsigned16", access="ro", pdo="transmit", unit="lm"),
        stator.Object(0x7000, "Dimming", "unsigned16", pdo="receive", minimum=0, maximum=100, unit="%"),
    )

    def step(self, now: float) -> None:
        dimming = self[0x7000]
        assert isinstance(dimming, int)
        self[0x6000] = 5 * dimming
        if dimming == 100:
            self.emergency(0x4210, 0x09, b"hot")


def test_a_node_has_objects_signals_and_pdos() -> None:
    with stator.Rack(BUS, products=[Probe], limit=10) as rack:
        probe = rack["probe"]
        probe.wait_for_boot_up()
        assert probe.upload(0x1008) == b"PROBE"
        assert int.from_bytes(probe.upload(0x1018, 1), "little") == 0x1234
        assert probe.upload(0x2000) == b"left"
        assert probe.objects[0x2001, 1] == -5
        assert probe.objects[0x2001, 2] == 0.5
        assert probe.objects[0x2002] == 21.5
        rack.go_operational()
        rack.run(0.5)
        assert probe["position_value"].value == pytest.approx(rack.now * 1e5, abs=200)
        assert probe["position_value"].unit == "um"
        assert isinstance(probe.own, Probe)


def test_writes_are_checked_refused_and_told() -> None:
    with stator.Rack(BUS, products=[Probe], limit=10) as rack:
        probe = rack["probe"]
        probe.wait_for_boot_up()
        rack.run(0.1)
        probe.download(0x6003, 0, (40).to_bytes(4, "little"))
        rack.run(0.001)
        assert int.from_bytes(probe.upload(0x6004), "little") == pytest.approx(240, abs=300)
        with pytest.raises(stator.MasterError) as refused:
            probe.download(0x6003, 0, (13).to_bytes(4, "little"))
        assert refused.value.detail == 0x06090030
        assert any("13 brings bad luck" in event.text for event in rack.events())
        with pytest.raises(stator.MasterError) as too_high:
            probe.download(0x6003, 0, (1001).to_bytes(4, "little"))
        assert too_high.value.detail == 0x06090031


def test_power_starts_it_again() -> None:
    with stator.Rack(BUS, products=[Probe], limit=10) as rack:
        own = rack["probe"].own
        assert own.starts == 1
        rack["probe"].powered = False
        rack.run(0.01)
        rack["probe"].powered = True
        rack.run(0.01)
        assert own.starts == 2


def test_python_canopen_reads_its_data_sheet() -> None:
    canopen = pytest.importorskip("canopen")
    with stator.Rack(BUS, products=[Probe], limit=10) as rack:
        rack["probe"].wait_for_boot_up()
        network = canopen.Network()
        network.connect(interface="stator", channel=rack.bus())
        node = network.add_node(9, rack["probe"].eds())
        assert node.sdo["Limits"]["Low"].raw == -5
        node.sdo["Preset value"].raw = 7
        assert node.sdo["Preset value"].raw == 7
        network.disconnect()


def test_a_slave_has_process_data_and_emergencies() -> None:
    with stator.Rack(SEGMENT, products=[Lamp], limit=10) as rack:
        lamp = rack["lamp"]
        master = rack.segment().master()
        (slave,) = master.scan()
        assert slave.name == "LAMP"
        rack.go_operational()
        for dimming in (0, 40, 99):
            master.set_outputs(dimming.to_bytes(2, "little"))
            rack.run(0.005)
            assert lamp["light"].value == 5 * dimming
            assert int.from_bytes(master.inputs()[:2], "little") == 5 * dimming
        lamp.download(0x7000, 0, (100).to_bytes(2, "little"))
        rack.run(0.005)
        emergency = lamp.emergencies()[0]
        assert (emergency.error_code, emergency.error_register & 0x09, emergency.data[:3]) == (0x4210, 0x09, b"hot")


class Broken(Lamp):
    type = "lamp"

    def step(self, now: float) -> None:
        if now > 0.01:
            raise ZeroDivisionError("no light")


def test_what_it_raises_comes_out_where_time_passes() -> None:
    with stator.Rack(SEGMENT, products=[Broken], limit=10) as rack:
        with pytest.raises(ZeroDivisionError, match="no light"):
            rack.run(0.1)
        rack.run(0.1)
        (event,) = [event for event in rack.events() if event.id == "own-device-failed"]
        assert "step()" in event.text and "no light" in event.text


def test_what_it_raises_in_a_thread_of_the_rack_comes_out_in_run() -> None:
    with stator.Rack(SEGMENT, products=[Broken], limit=10) as rack:
        rack.start()
        with pytest.raises(ZeroDivisionError, match="no light"):
            rack.run(1.0)
        rack.stop()


def test_objects_are_its_own_functions_only() -> None:
    with stator.Rack(SEGMENT, products=[Lamp], limit=10) as rack:
        own = rack["lamp"].own
        with pytest.raises(stator.Error, match="objects"):
            own[0x6000]
    with pytest.raises(stator.Error, match="gone"):
        own[0x6000]
    with pytest.raises(stator.Error, match="products="):
        Lamp()[0x6000]


@pytest.mark.parametrize(
    ("objects", "message"),
    [
        ((stator.Object(0x2000, "A", "uint8"),), "there is no type"),
        ((stator.Object(0x2000, "A", access="rx"),), "there is no access"),
        ((stator.Object(0x2000, "A", "unsigned8", default=256),), "no value of the type"),
        ((stator.Object(0x2000, "A", minimum=1),), "a minimum goes with a maximum"),
        ((stator.Object(0x2000, "A"), stator.Object(0x2000, "B")), "twice"),
        ((stator.Object(0x7000, "A", "unsigned8", pdo="receive"),), "one byte"),
    ],
)
def test_mistakes_are_told(objects: tuple[stator.Object, ...], message: str) -> None:
    class Wrong(Lamp):
        pass

    Wrong.objects = objects
    with pytest.raises((stator.Error, ValueError), match=message):
        stator.Rack(SEGMENT, products=[Wrong])


def test_many_in_one_rack_and_in_real_time_leave_nothing_behind() -> None:
    table = {
        "segment": [{"device": [{"type": "lamp", "name": f"lamp{number}"} for number in range(5)]}],
        "bus": [{"device": [{"type": "probe", "name": "probe", "node_id": 9}]}],
    }
    threads = threading.active_count()
    rack = stator.Rack(table, products=[Lamp, Probe])
    rack.start()
    rack.run(0.2)
    owns = [weakref.ref(device.own) for device in rack.values()]
    assert all(own() is not None for own in owns)
    rack.close()
    del rack
    gc.collect()
    assert not any(own() is not None for own in owns)
    assert threading.active_count() == threads


@pytest.mark.parametrize(("base", "network"), [(stator.CanOpenDevice, "bus"), (stator.EtherCatDevice, "segment")])
def test_a_device_may_report_an_error_when_it_starts(base: type[stator.OwnDevice], network: str) -> None:
    starts = []

    class Alarming(base):  # type: ignore[misc, valid-type]
        type = "alarming"
        name = "ALARMING"
        objects = (stator.Object(0x2000, "Setting", "unsigned16", default=3, pdo="transmit"),)

        def start(self) -> None:
            self.emergency(0x1000, 0x01, b"start")
            starts.append((self[0x2000], self.state))

    rack = stator.Rack({network: [{"device": [{"type": "alarming", "name": "alarming"}]}]}, products=[Alarming])
    rack.run(0.01)
    assert starts
    assert starts[0][0] == 3
