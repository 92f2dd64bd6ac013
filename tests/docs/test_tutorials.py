"""Every command of a tutorial is run as it stands there, in the order of the page."""

import re
import shlex
from pathlib import Path

import pytest

from groundstation.cli.main import main

TUTORIALS = sorted((Path(__file__).resolve().parents[2] / "docs" / "tutorials").glob("*.md"))


def commands(page):
    """Lines of the blocks that are marked as shell."""
    blocks = re.findall(r"^```sh\n(.*?)^```", page.read_text("utf-8"), re.S | re.M)
    return [line for block in blocks for line in block.splitlines() if line.strip()]


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_every_line_of_a_tutorial_is_a_command_that_exists(page):
    from groundstation.cli.main import build_parser

    assert commands(page)
    for line in commands(page):
        program, *arguments = shlex.split(line, comments=True)
        assert program == "reflight"
        build_parser().parse_args(arguments)


@pytest.mark.slow
@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_tutorial_can_be_followed(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for line in commands(page):
        status = main(shlex.split(line, comments=True)[1:], lambda _: pytest.fail("the window was opened"))
        captured = capsys.readouterr()
        assert status == 0, f"{line}\n{captured.out[-1000:]}{captured.err[-1000:]}"
