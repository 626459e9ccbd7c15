"""The notebooks run from their first cell to their last, and draw what they are there for."""

from __future__ import annotations

import base64
import io
import json
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import matplotlib.image
import nbformat
import pytest
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient

ROOT = Path(__file__).parents[2]
NOTEBOOKS = ROOT / "python" / "notebooks"
#: Notebooks and how many plots each draws.
PLOTS = {"a_failing_master": 2, "stall_of_a_stepper": 3, "tuning_a_servo": 3}


def read(name: str) -> nbformat.NotebookNode:
    """A notebook as it is kept."""
    return nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)


@pytest.fixture
def kernel(monkeypatch: pytest.MonkeyPatch) -> Iterator[AsyncKernelManager]:
    """A kernel of this interpreter, whatever others are installed, which is reached over sockets of its own."""
    # Names of sockets must be short.
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        place = Path(folder) / "kernels" / "stator"
        place.mkdir(parents=True)
        command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        (place / "kernel.json").write_text(json.dumps({"argv": command, "display_name": "", "language": "python"}))
        monkeypatch.setenv("JUPYTER_PATH", folder)
        for variable in ("JUPYTER_RUNTIME_DIR", "IPYTHONDIR", "MPLCONFIGDIR"):
            monkeypatch.setenv(variable, folder)
        # Plots go into the notebook.
        monkeypatch.delenv("MPLBACKEND", raising=False)
        yield AsyncKernelManager(kernel_name="stator", transport="ipc", ip=f"{folder}/socket")


def plots_of(notebook: nbformat.NotebookNode) -> list[bytes]:
    """The pictures that its cells gave out."""
    outputs = (output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs)
    return [base64.b64decode(output.data["image/png"]) for output in outputs if "image/png" in output.get("data", {})]


@pytest.mark.parametrize("name", PLOTS)
def test_a_notebook_runs_and_draws(name: str, kernel: AsyncKernelManager) -> None:
    notebook = read(name)
    # A cell that raises ends it with an exception that shows the cell.
    NotebookClient(notebook, km=kernel, timeout=None, startup_timeout=600).execute(cwd=str(NOTEBOOKS))
    plots = plots_of(notebook)
    assert len(plots) == PLOTS[name]
    for plot in plots:
        pixels = matplotlib.image.imread(io.BytesIO(plot), format="png")
        assert pixels.shape[0] > 200 and pixels.shape[1] > 400
        assert pixels[..., :3].std() > 0.05, "the plot is empty"


def test_a_cell_that_raises_is_told(kernel: AsyncKernelManager) -> None:
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("import stator\nstator.Rack('tmcm-3351')")])
    with pytest.raises(Exception, match="tmcm-3351"):
        NotebookClient(notebook, km=kernel, timeout=None, startup_timeout=600).execute()


def test_all_notebooks_are_here_and_in_the_documentation() -> None:
    assert {file.stem for file in NOTEBOOKS.glob("*.ipynb")} == PLOTS.keys()
    document = (ROOT / "docs" / "how-to" / "python.md").read_text()
    for name in PLOTS:
        assert f"python/notebooks/{name}.ipynb" in document


@pytest.mark.parametrize("name", PLOTS)
def test_a_notebook_is_kept_without_what_it_printed(name: str) -> None:
    for cell in read(name).cells:
        assert cell.cell_type != "code" or (cell.outputs == [] and cell.execution_count is None)
