"""The two doors to the outside, as a process has them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from petalfoil.cli.streams import say
from tests.cases import case as small_case

PETALFOIL = [sys.executable, "-m", "petalfoil"]


@pytest.mark.parametrize("arguments", [["--version"], pytest.param(["solve", "--help"], marks=pytest.mark.slow)])
def test_a_reader_that_goes_away_is_no_event(arguments: list[str]) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run([*PETALFOIL, *arguments], stdout=writing, stderr=subprocess.PIPE, text=True, check=False)
    finally:
        os.close(writing)
    assert done.stderr == ""
    assert done.returncode in (1, 141)  # 1 is what the library says that prints the help


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_no_room_for_the_answer_is_said() -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([*PETALFOIL, "--version"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("Error: cannot write to standard output: ")
    assert done.stderr.count("\n") == 1


def test_a_title_the_terminal_cannot_show_is_no_failure() -> None:
    code = "from petalfoil.cli.streams import accept_any_text, emit; accept_any_text(); emit('e = 5 \\u00b5m\\n')"
    environment = os.environ | {"PYTHONIOENCODING": "ascii"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == "e = 5 ?m\n"


def test_what_is_said_shows_control_characters_by_their_codes(capsys) -> None:
    say("no case file \x1b[31ma\x9b\u202e.toml")
    assert capsys.readouterr().err == "no case file \\x1b[31ma\\x9b\\u202e.toml\n"


def test_a_terminal_that_is_gone_does_not_end_the_run() -> None:
    code = (
        "import os, pty, sys; from petalfoil.cli.streams import say; near, far = pty.openpty(); os.dup2(far, 2); "
        "os.close(far); os.close(near); say('interrupted'); print('files are written')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "files are written\n")


@pytest.mark.slow
@pytest.mark.parametrize("place", ["before", "behind"])
def test_verbose_tells_the_steps(tmp_path: Path, place: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text(small_case("paper_n6").to_toml(), encoding="utf-8")
    arguments = ["-v", "check", str(path)] if place == "before" else ["check", str(path), "--verbose"]
    done = subprocess.run([*PETALFOIL, *arguments], capture_output=True, text=True, check=True)
    assert "pack: barrier " in done.stderr
    assert "pack: barrier " not in done.stdout


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("petalfoil lift", "liftoff"),
        pytest.param("petalfoil capacity case.toml --orient", "--orientations", marks=pytest.mark.slow),
    ],
)
def test_a_shell_completes_commands_and_options(words: str, completed: str) -> None:
    code = "import sys; from petalfoil.cli import main; sys.argv = ['petalfoil']; main()"
    asked = {"_PETALFOIL_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | asked, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == [completed]
