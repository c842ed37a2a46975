"""The shell completes verbs, flags of a configuration and their choices."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest

FIRST_COMMAND = {"zsh": "#compdef surmount", "fish": "complete --no-files --command 'surmount'"}
BASH = shutil.which("bash")
COMPLETE = """
source "$1"; shift
function_of=$(complete -p surmount | sed 's/.*-F \\([^ ]*\\).*/\\1/')
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMP_LINE="$*"; COMP_POINT=${#COMP_LINE}
"$function_of" surmount "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD-1]}"
printf '%s\\n' "${COMPREPLY[@]}"
"""


def script_for(shell: str) -> str:
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-m", "surmount", "completion", shell],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def bash_script(tmp_path_factory):
    path = tmp_path_factory.mktemp("completion") / "surmount.bash"
    path.write_text(script_for("bash"), encoding="utf-8")
    return path


@pytest.mark.skipif(BASH is None, reason="Bash completes")
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["rep"], {"report", "reproduce"}),
        (["reproduce", "step", "--env.robot.g"], {"--env.robot.gear"}),
        (["reproduce", "step", "--env.robot.gear", ""], {"wheels", "whegs", "both"}),
        (["compare", "step", "--teaching.plr.t"], {"--teaching.plr.temperature"}),
        (["show", "--w"], {"--why"}),
    ],
)
def test_bash_completes(bash_script, words, expected):
    done = subprocess.run(  # noqa: S603
        [BASH, "-c", COMPLETE, "bash", bash_script, "surmount", *words],
        capture_output=True,
        text=True,
        check=False,
    )
    assert set(done.stdout.split()) == expected, done.stderr


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells_get_a_script_of_their_own(shell):
    script = script_for(shell)
    assert "env.robot.gear" in script
    assert FIRST_COMMAND[shell] in script
