"""What is built holds what it needs, and says what it lacks."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tarfile
import venv
import zipfile
from email.parser import Parser
from importlib.util import find_spec
from pathlib import Path

import pytest

import surmount
from surmount.cli.main import VERBS
from surmount.core.extras import EXTRAS

ROOT = Path(__file__).parents[1]
CORE = ("numpy", "scipy", "polars", "_polars_runtime_32", "lazy_loader", "msgspec", "packaging")
"""Top-level modules of what the distribution itself requires."""
SHIPPED = (
    "surmount/__init__.pyi",
    "surmount/py.typed",
    "surmount/trials/data/step.parquet",
    "surmount/exports/sb3_curriculum.txt",
    "surmount/rstar/manoeuvres/",
    "surmount/report/templates/",
)
WITHOUT_EXTRAS = """
import importlib.abc, json, sys

class Absent(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in EXTRAS:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return None

EXTRAS = json.loads(sys.argv[1])
sys.meta_path.insert(0, Absent())
import surmount
said = {}
for name in surmount.__all__:
    try:
        getattr(surmount, name)
        said[name] = ""
    except surmount.MissingExtraError as error:
        said[name] = str(error)
    except BaseException as error:
        said[name] = f"{type(error).__name__}: {error}"
from surmount.cli.main import run
said["command"] = run(["show", "results"])
print(json.dumps(said))
"""
SMOKE = """
import surmount
assert "site-packages" in surmount.__file__, surmount.__file__
config = surmount.AnalysisConfig(components=4, bootstrap=0, sensitivity=False, max_samples=2000)
trials = surmount.load_example()
print(len(trials.success), len(surmount.determine_curriculum(trials, config).groups) > 0)
"""


@pytest.fixture(scope="module")
def without_extras():
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", WITHOUT_EXTRAS, json.dumps([*EXTRAS])],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1]), done.stderr


def test_without_extras_every_public_name_is_there_or_says_what_to_install(without_extras):
    said, _ = without_extras
    told = {name: text for name, text in said.items() if name != "command" and text}
    sentence = r"This needs the package `\w+`, which is not installed\. Install it with: pip .*"
    assert [name for name, text in told.items() if not re.fullmatch(sentence, text)] == []
    there = {name for name, text in said.items() if not text}
    assert {"determine_curriculum", "load_example", "read_trials", "make_teacher"} <= there
    assert {"TaskEnv", "TeacherCallback", "Experiment", "ObstacleEnv", "roll_out"} <= set(told)


def test_without_extras_the_command_says_what_to_install(without_extras):
    said, complained = without_extras
    assert said["command"] == 6
    assert "pip install 'surmount[cli]'" in complained


def test_a_missing_extra_is_an_import_error():
    assert issubclass(surmount.MissingExtraError, ImportError)


def test_every_extra_that_is_named_can_be_installed():
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for extra in set(EXTRAS.values()):
        assert re.search(rf"^{extra} = \[", text, flags=re.MULTILINE), extra


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Return a wheel and a source distribution, built without a network."""
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run(  # noqa: S603
        [sys.executable, "-m", "hatchling", "build", "-d", folder],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    return wheel, sdist


def test_wheel_and_sdist_hold_what_is_needed(built):
    wheel, sdist = built
    names = zipfile.ZipFile(wheel).namelist()
    for wanted in SHIPPED:
        assert any(name.startswith(wanted) for name in names), wanted
    assert any(name.endswith("licenses/LICENSE") for name in names)
    sources = {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "src").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert {name.removeprefix("src/") for name in sources} <= set(names)
    assert {name.partition("/")[0] for name in names} == {
        "surmount",
        f"surmount-{surmount.__version__}.dist-info",
    }
    with tarfile.open(sdist) as archive:
        inside = {name.partition("/")[2] for name in archive.getnames()}
    assert {*sources, "README.md", "LICENSE", "CHANGELOG.md", "pyproject.toml"} <= inside


def test_what_an_index_shows_has_no_link_that_leads_nowhere(built):
    wheel, _ = built
    archive = zipfile.ZipFile(wheel)
    (metadata,) = [name for name in archive.namelist() if name.endswith("METADATA")]
    shown = Parser().parsestr(archive.read(metadata).decode()).get_payload()
    assert "# Surmount" in shown
    targets = re.findall(r"\]\(([^)]+)\)", shown)
    assert [target for target in targets if not target.startswith(("https://", "#"))] == []


def test_the_wheel_works_where_only_what_it_requires_is_installed(built, tmp_path):
    wheel, _ = built
    clean = tmp_path / "clean"
    venv.create(clean, with_pip=False)
    python = clean / "bin" / "python"
    (site,) = clean.glob("lib/python*/site-packages")
    pip = [sys.executable, "-m", "pip", "--python", python, "install", "--no-deps", "--no-index"]
    subprocess.run([*pip, "--quiet", wheel], check=True)  # noqa: S603
    for module in CORE:
        spec = find_spec(module)
        if spec is None or spec.origin is None:
            continue
        package = Path(spec.origin).parent
        for found in [package, *package.parent.glob(f"{module}.libs")]:
            (site / found.name).symlink_to(found)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}

    def ask(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(  # noqa: S603
            [python, *words],
            capture_output=True,
            text=True,
            env=environment,
            cwd=tmp_path,
            check=False,
        )

    done = ask("-c", SMOKE)
    assert done.stdout.split() == ["720", "True"], done.stderr
    helped = ask("-m", "surmount", "--help")
    assert [verb for verb in VERBS if f"  {verb} " not in helped.stdout] == []
    assert ask("-m", "surmount", "--version").stdout.split() == ["surmount", surmount.__version__]
    lacking = ask("-m", "surmount", "show", "results")
    assert lacking.returncode == 6
    assert "pip install 'surmount[cli]'" in lacking.stderr
    absent = ask("-c", "import surmount; surmount.TaskEnv")
    assert "MissingExtraError: This needs the package `gymnasium`" in absent.stderr
