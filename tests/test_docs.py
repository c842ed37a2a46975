"""What the documentation shows can be done: code runs, commands are read, links lead somewhere."""

from __future__ import annotations

import functools
import inspect
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from example_trials import two_behaviours

import surmount
from surmount.cli import compare, config, configuration_flags, main, reproduce
from surmount.cli.main import run
from surmount.experiment.presets import preset
from surmount.trials.table import write_trials

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md")]
PAGES += sorted(DOCS.rglob("*.md"))
OWN_TESTS = {
    "docs/analysis.md": "tests/test_analysis_page.py",
    "docs/own-environment.md": "tests/envs/test_own_page.py",
    "docs/teachers.md": "tests/teachers/test_teachers_page.py",
}
"""Pages whose Python is run by a test of their own, which says what it has to give."""


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def blocks(page: Path, language: str) -> list[str]:
    text = page.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)


def commands(page: Path) -> list[str]:
    """Return the command lines of Surmount on a page, continuation lines joined."""
    shown = "\n".join(blocks(page, "console")).replace("\\\n", " ")
    return re.findall(r"^\$ surmount (.*)$", shown, flags=re.MULTILINE)


WITH_PYTHON = [page for page in PAGES if blocks(page, "python")]
COMMANDS = sorted({(line, name_of(page)) for page in PAGES for line in commands(page)})


@pytest.mark.parametrize("page", WITH_PYTHON, ids=name_of)
def test_python_runs_block_after_block(page, tmp_path, monkeypatch):
    if name_of(page) in OWN_TESTS:
        tested = ROOT / OWN_TESTS[name_of(page)]
        assert page.name in tested.read_text(encoding="utf-8")
        return
    monkeypatch.chdir(tmp_path)
    write_trials(tmp_path / "trials.csv", two_behaviours())
    names: dict[str, object] = {}
    for block in blocks(page, "python"):
        exec(compile(block, page.name, "exec"), names)  # noqa: S102


class Read(Exception):  # noqa: N818 - it is no error
    """A command was read to its end, and would now run."""


@pytest.fixture
def nothing_runs(tmp_path, monkeypatch):
    """Let every verb stop where it would begin its work, in a folder with what it asks for."""

    def stop(*_: object, **__: object) -> int:
        raise Read

    def stopping(verb: str):
        function = function_of(verb)
        if verb in main.CONFIGURED:
            return function
        shell = functools.wraps(function)(stop)
        shell.__signature__ = inspect.signature(function)
        return shell

    function_of = main.function_of
    monkeypatch.setattr(main, "function_of", stopping)
    for verb in (reproduce, compare, config):
        if hasattr(verb, "_run"):
            monkeypatch.setattr(verb, "_run", stop)
    monkeypatch.setattr(config, "_print", stop, raising=False)
    monkeypatch.setattr(configuration_flags, "begun_with", lambda asked: preset(
        "rstar/step" if asked.task in (None, "step", "my_module:make_env") else asked.task,
        asked.preset,
    ))  # fmt: skip
    monkeypatch.chdir(tmp_path)
    (tmp_path / "step.toml").write_text("networks = 3\n", encoding="utf-8")
    return tmp_path


NOT_INSTALLED = ("gravity", "pendulum/weighted")
"""Tasks of the package that a page writes; the tests of the page register them."""
OWN_SETTINGS = ("--env.logarithmic", "--env.integer")
"""Flags of environments of one's own, whose settings are not those of RSTAR."""


@pytest.mark.parametrize(("line", "page"), COMMANDS)
def test_a_command_is_read_as_it_stands(line, page, nothing_runs):
    words = shlex.split(line, comments=True)
    words = words[: words.index(">")] if ">" in words else words
    if any(word.startswith(OWN_SETTINGS) or word in NOT_INSTALLED for word in words):
        assert page == "docs/own-environment.md"
        return
    try:
        code = run(words)
    except Read:
        return
    except SystemExit as ended:  # --help and --version
        code = ended.code
    assert code == 0, line


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page):
    text = re.sub(
        r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE
    )
    targets = re.findall(r"\]\(([^)#\s]+)", text)
    lost = [
        target
        for target in targets
        if not re.match(r"[a-z]+:", target) and not (page.parent / target).exists()
    ]
    assert lost == []


def test_concepts_name_every_equation_and_what_is_public():
    text = (DOCS / "concepts.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| eq\. (\d)", text, flags=re.MULTILINE) == [*"123456"]
    named = set(re.findall(r"`surmount\.(\w+)`", text))
    assert named <= set(surmount.__all__)
    for name, file in re.findall(r"\[`surmount\.(\w+)`\]\(\.\./src/([^)]+)\)", text):
        where = inspect.getsourcefile(getattr(surmount, name))
        assert where is not None
        assert Path(where) == ROOT / "src" / file, name


def test_the_site_has_every_public_name(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS / "site"))
    import reference  # noqa: PLC0415 - the site's, found by its folder

    listed = [name for names in reference.public_names().values() for name in names]
    assert sorted(listed) == sorted({*surmount.__all__} - {"__version__"})


def test_the_site_has_every_option_of_the_command_line():
    program = "import commands; print(commands.page('analyze'), commands.page('reproduce'))"
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program],
        env=os.environ | {"PYTHONPATH": f"{ROOT / 'src'}{os.pathsep}{DOCS / 'site'}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "| `--success-above` `VALUE` |" in done.stdout, done.stderr
    assert "| `--env.robot.gear` `{wheels,whegs,both}` |" in done.stdout


@pytest.mark.slow
def test_the_site_is_built_without_a_warning_and_needs_no_network(tmp_path):
    environment = os.environ | {
        "NO_MKDOCS_2_WARNING": "1",
        "PYTHONPATH": str(ROOT / "src"),
    }
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-m", "mkdocs", "build", "--quiet", "--strict", "--site-dir", tmp_path],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    pages = [*tmp_path.glob("*.html"), *tmp_path.glob("reference/*.html")]
    assert len(pages) > 20
    loaded = re.compile(r'<(?:script|link|img|iframe)[^>]*(?:src|href)="?(https?:)?//')
    assert [page.name for page in pages if loaded.search(page.read_text(encoding="utf-8"))] == []
    assert (tmp_path / "search" / "search_index.js").is_file()
    assert (tmp_path / "assets" / "iframe-worker.js").is_file()
