# SPDX-License-Identifier: MIT OR Apache-2.0
"""The tutorial runs from its first cell to its last, in which it compares the library with theory. In tests/run all."""

import base64

import nbclient
import nbformat
import pytest
from conftest import ROOT

NOTEBOOK = ROOT / "python" / "tutorial.ipynb"


def pictures(notebook):
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return [
        base64.b64decode(output["data"]["image/png"]) for output in outputs if "image/png" in output.get("data", {})
    ]


# The kernel of a notebook warns about itself.
@pytest.mark.filterwarnings("default")
def test_the_tutorial_runs(tmp_path):
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    kept = len(pictures(notebook))
    nbclient.NotebookClient(
        notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    assert len(pictures(notebook)) == kept == 5
    assert all(picture.startswith(b"\x89PNG") and len(picture) > 5000 for picture in pictures(notebook))


def test_the_notebook_is_small():
    assert NOTEBOOK.stat().st_size < 500_000
