"""The plug-in for pytest, in runs of pytest of its own."""

from __future__ import annotations

import os
import subprocess
import xml.etree.ElementTree as ElementTree

import pytest

ONE_DRIVE = '[[segment]]\n[[segment.device]]\ntype = "tmcm-3315"\nname = "x"\n'


def test_a_marker_names_the_rack(pytester: pytest.Pytester) -> None:
    pytester.makefile(".toml", drive=ONE_DRIVE)
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.stator_rack("drive.toml", limit=5)
        def test_file(stator_rack):
            stator_rack.run(0.01)
            assert list(stator_rack) == ["x"]

        @pytest.mark.stator_rack("tmcc160")
        def test_product(stator_rack):
            assert list(stator_rack) == ["tmcc160"]

        @pytest.mark.stator_rack({"segment": [{"device": [{"type": "junction"}]}]})
        def test_table(stator_rack):
            assert len(stator_rack) == 1
        """
    )
    pytester.runpytest_subprocess("--strict-markers").assert_outcomes(passed=3)


def test_the_ini_file_and_the_option_name_it(pytester: pytest.Pytester) -> None:
    pytester.makefile(".toml", drive=ONE_DRIVE)
    pytester.makeini("[pytest]\nstator_rack = drive.toml\n")
    pytester.makepyfile(
        """
        def test_rack(stator_rack, request):
            names = list(stator_rack)
            assert names == (["tmcc160"] if request.config.getoption("--stator-rack") else ["x"])
        """
    )
    pytester.runpytest_subprocess().assert_outcomes(passed=1)
    pytester.runpytest_subprocess("--stator-rack", "tmcc160").assert_outcomes(passed=1)


def test_a_test_that_names_no_rack_fails(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("def test_rack(stator_rack): pass")
    result = pytester.runpytest_subprocess()
    assert result.ret != 0
    result.stdout.fnmatch_lines(["*names no rack*"])
    assert "skipped" not in result.stdout.str()


def test_each_test_has_a_fresh_rack(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest
        pytestmark = pytest.mark.stator_rack("tmcm-3315")

        @pytest.mark.parametrize("number", range(3))
        def test_rack(stator_rack, number):
            assert stator_rack.now == 0
            stator_rack.run(0.1)
        """
    )
    pytester.runpytest_subprocess().assert_outcomes(passed=3)


def test_faults_are_armed_by_markers(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.stator_rack("tmcm-3315")
        @pytest.mark.stator_fault("motor-stall", device="tmcm-3315", axis=1, at="5ms")
        @pytest.mark.stator_fault("motor-stall", device="tmcm-3315", axis=2, at="1s")
        def test_rack(stator_rack):
            stator_rack.run(0.01)
            assert [fault.state for fault in stator_rack.faults()] == ["active", "armed"]
        """
    )
    pytester.runpytest_subprocess().assert_outcomes(passed=1)


def test_a_failure_tells_what_happened(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.stator_rack("tmcm-3315")
        @pytest.mark.stator_fault("motor-stall", device="tmcm-3315", axis=1, at="5ms")
        def test_rack(stator_rack):
            stator_rack.go_operational()
            stator_rack.run(0.05)
            assert False
        """
    )
    result = pytester.runpytest_subprocess("--basetemp", str(pytester.path / "kept"))
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        ["*- rack -*", "*s of simulated time", "*Safe-Operational*", "fault 1: motor-stall*", "signals: *"]
    )
    (table,) = (pytester.path / "kept").rglob("signals.csv")
    head, *rows = table.read_text().splitlines()
    assert head.startswith("time [s],") and "axis0.shaft_speed" in head
    assert len(rows) > 50
    pytest.importorskip("matplotlib")
    (plot,) = (pytester.path / "kept").rglob("signals.svg")
    assert "<svg" in plot.read_text()[:2000]


def test_reports_have_properties(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.stator_rack("tmcm-3315")
        def test_rack(stator_rack):
            stator_rack.go_operational()
            stator_rack.run(0.25)
        """
    )
    pytester.runpytest_subprocess("--junit-xml", "report.xml").assert_outcomes(passed=1)
    properties = {each.get("name"): each.get("value") for each in ElementTree.parse("report.xml").iter("property")}
    assert properties["stator_rack"] == "tmcm-3315"
    assert float(properties["stator_seconds"]) >= 0.25
    assert int(properties["stator_events_information"]) > 0


@pytest.mark.parametrize("workers", [4])
def test_racks_on_links_do_not_clash(pytester: pytest.Pytester, workers: int) -> None:
    pytest.importorskip("xdist")
    pytester.makefile(
        ".toml",
        rack='[[segment]]\nlink = "udp:127.0.0.1"\n[[segment.device]]\ntype = "tmcm-3315"\nname = "x"\nusb = "pty:/tmp/stator-usb"\n'
        '[[bus]]\nports = ["slcan:/tmp/stator-can0", "socketcand:29536"]\n[[bus.device]]\ntype = "tmcc160"\nname = "s"\n',
    )
    pytester.makepyfile(
        """
        import os
        import pytest

        @pytest.mark.parametrize("number", range(8))
        @pytest.mark.stator_rack("rack.toml", links=True)
        def test_rack(stator_rack, stator_links, number):
            stator_rack.run(0.05)
            assert stator_links["segment[0].link"].startswith("udp:127.0.0.1:")
            assert os.path.exists(stator_links["segment[0].device[0].usb"].removeprefix("pty:"))
        """
    )
    result = pytester.runpytest_subprocess("-n", str(workers))
    result.assert_outcomes(passed=8)


FAILING = """
    import pytest

    @pytest.mark.stator_rack("drive.toml")
    def test_fails(stator_rack):
        stator_rack.go_operational()
        stator_rack["x"].axis[0].inputs["load_torque"] = 0.1
        stator_rack.run(0.2)
        assert False

    @pytest.mark.stator_rack("drive.toml")
    def test_passes(stator_rack):
        stator_rack.run(0.1)
"""


def test_a_failed_test_names_its_recording(pytester: pytest.Pytester) -> None:
    pytester.makefile(".toml", drive=ONE_DRIVE)
    pytester.makepyfile(FAILING)
    result = pytester.runpytest_subprocess("--basetemp", "kept")
    result.assert_outcomes(failed=1, passed=1)
    (line,) = [line for line in result.stdout.lines if "stator replay " in line]
    file = line.partition("stator replay ")[2].strip()
    replayed = subprocess.run(
        [os.environ["STATOR_PROGRAM"], "replay", file], capture_output=True, text=True, check=False
    )
    assert replayed.returncode == 0, replayed.stderr
    assert "the same to the last bit" in replayed.stdout
    assert [each.name for each in pytester.path.glob("kept/**/*.stator")] == ["run.stator"], (
        "only that of the failed test"
    )


def test_recordings_can_be_left_away(pytester: pytest.Pytester) -> None:
    pytester.makefile(".toml", drive=ONE_DRIVE)
    pytester.makepyfile(FAILING)
    result = pytester.runpytest_subprocess("--no-stator-recording")
    assert "stator replay" not in result.stdout.str()
    pytester.makeini("[pytest]\nstator_recording = false\n")
    result = pytester.runpytest_subprocess()
    assert "stator replay" not in result.stdout.str()


def test_a_rack_that_cannot_be_recorded_is_tested_all_the_same(pytester: pytest.Pytester) -> None:
    program = pytester.makefile(".tmc", "WAIT TICKS, 0, 10\nSTOP\n")
    pytester.makefile(
        ".toml", module=f'[[device]]\ntype = "tmcm-142"\nname = "x"\nrs485 = "pty:line"\nprogram = "{program}"\n'
    )
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.stator_rack("module.toml")
        def test_fails(stator_rack):
            stator_rack.run(0.1)
            assert False
        """
    )
    result = pytester.runpytest_subprocess()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["no recording: *would lie elsewhere*"])
