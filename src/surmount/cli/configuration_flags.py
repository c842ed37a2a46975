"""A flag for every key of an experiment's configuration, beside the options of a verb.

Which keys there are depends on the task: RSTAR's settings are not those of somebody's environment.
So the options are read first, as far as they say which task, preset, run and file are meant; the
configuration that these give is what the flags change, and what ``--help`` shows as their defaults.
"""

from __future__ import annotations

import argparse
import ast
import dataclasses
import inspect
import itertools
import json
import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, TypeVar, cast, get_type_hints

import tyro

from surmount.cli.options import Assignments, ConfigFile, Preset, Task, overrides
from surmount.cli.workers import WorkerOptions, Workers
from surmount.core.configuration import Arguments, override
from surmount.core.errors import ConfigError
from surmount.core.records import parse_json
from surmount.envs.registry import find_family
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.presets import DISPLACING, configured, preset
from surmount.workflow.console import SafeConsole

NOT_FLAGS = ("task", "preset", "fingerprint")
"""Keys that the options or the run itself say."""
HELP = ("-h", "--help")
_VALUE = re.compile(r"[^-]|-[\d.]|-$")
"""How an argument begins that is no option."""


@dataclass(frozen=True, kw_only=True)
class ConfigurationOptions:
    """Options that say which configuration is meant."""

    task: Annotated[Task, tyro.conf.Positional] = None
    """One of those that `surmount tasks` lists, or an environment of your own as my_module:make_env
    (see `surmount check`); may be left out where --config or --resume says it."""
    preset: Preset = "smoke"
    """smoke (minutes, shows the method at work) or paper (the paper's scale, many hours)."""
    config: ConfigFile = None
    """TOML or JSON file of configuration keys to change; see `surmount config`."""
    set: Assignments = ()
    """Configuration key to change, as key=value; may be repeated; overrides the file."""


@dataclass(frozen=True, kw_only=True)
class RunOptions(ConfigurationOptions):
    """Options of verbs that run an experiment."""

    out: Annotated[Path, tyro.conf.arg(metavar="DIR")]
    """Folder for everything the run makes."""
    resume: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Go on with the run in --out, with its stored configuration; flags and --set change what no
    finished stage depends on."""
    workers: WorkerOptions = field(default_factory=Workers)
    """Where stages run."""


Options = TypeVar("Options", bound=ConfigurationOptions)


def opened_console(out: Path) -> SafeConsole:
    """Say where a run goes and how to look at it meanwhile; return what goes on saying."""
    console = SafeConsole()
    console.print(
        f"Into {out}. Look at it meanwhile: surmount report --follow {out}, or "
        f"tensorboard --logdir {out / 'logs'}",
        soft_wrap=True,
        markup=False,
        highlight=False,
    )
    return console


def run_configured(
    options: type[Options],
    run: Callable[[Options, ExperimentConfig, Mapping[str, Any]], int],
    arguments: Sequence[str],
    *,
    verb: str,
    description: str,
    beside: Mapping[str, object] | None = None,
) -> int:
    """Read a verb's options and the configuration's flags, and run it.

    Parameters
    ----------
    options
        A dataclass of the verb's options.
    run
        Takes the options, the configuration, and the values of ``beside``.
    arguments
        The command line after the verb.
    verb, description
        For ``--help``.
    beside
        Configurations that have flags too, by the name that begins them.
    """
    description = inspect.cleandoc(description)
    wants_help = any(argument in HELP for argument in arguments)
    asked = _asked(options, arguments, verb, out_may_lack=wants_help)
    more = dict(beside or {})
    if wants_help and asked.task is None and not _resumes(asked):
        tyro.cli(
            options,
            prog=f"surmount {verb}",
            args=["--help"],
            description=f"{description}\n\nWith a task, --help shows a flag for every key of its "
            f"configuration, too: surmount {verb} step --help",
        )
        return 0
    changes = overrides(asked.config, asked.set)
    asked = _agreed(asked, changes, arguments)
    for name, default in more.items():
        own = {key: changes.pop(key) for key in [*changes] if key.startswith(f"{name}.")}
        more[name] = _override_below(name, default, own)
    base = configured(begun_with(asked), changes | _displacing(arguments))
    kind = combined(options, base, more)
    defaults = {name: getattr(base, name) for name in _flag_fields(base)} | more
    parsed: Any = tyro.cli(
        kind,
        prog=f"surmount {verb}",
        args=list(arguments),
        description=description,
        registry=tables(),
    )
    flags = {name: getattr(parsed, name) for name in defaults}
    beside_values = {name: flags.pop(name) for name in more}
    return run(parsed.options, dataclasses.replace(base, **flags), beside_values)


def tables() -> tyro.constructors.ConstructorRegistry:
    """Return how flags of tables of arguments are read: as JSON."""
    registry = tyro.constructors.ConstructorRegistry()

    @registry.primitive_rule
    def rule(
        info: tyro.constructors.PrimitiveTypeInfo,
    ) -> tyro.constructors.PrimitiveConstructorSpec[Arguments] | None:
        if info.type is not Arguments:
            return None
        return tyro.constructors.PrimitiveConstructorSpec(
            nargs=1,
            metavar="JSON",
            instance_from_str=_table,
            is_instance=lambda value: isinstance(value, Arguments),
            str_from_instance=lambda table: [json.dumps(table)],
        )

    del rule
    return registry


def _table(words: list[str]) -> Arguments:
    try:
        table = parse_json(words[0])
    except ValueError as error:
        raise ValueError(f"{words[0]} is no JSON ({error})") from error
    if not isinstance(table, dict):
        raise ValueError(f'{words[0]} is no table, such as {{"gamma": 0.98}}')  # noqa: TRY004
    return Arguments(cast("dict[str, Any]", table))


def _displacing(arguments: Sequence[str]) -> dict[str, Any]:
    """Return what flags choose that other values of a preset make way for."""
    reader = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    for key in DISPLACING:
        reader.add_argument(f"--{key}", f"--{key.replace('_', '-')}", dest=key)
    chosen = vars(reader.parse_known_args(arguments)[0])
    return {key: value for key, value in chosen.items() if value is not None}


def _agreed(options: Options, changes: Mapping[str, Any], arguments: Sequence[str]) -> Options:
    """Return options with the task and the preset that a file says; none may contradict it.

    Raises
    ------
    ConfigError
        If the command line says another.
    """
    said = {name: str(changes[name]) for name in ("task", "preset") if name in changes}
    given = {"task": options.task is not None,
             "preset": any(one.partition("=")[0] == "--preset" for one in arguments)}  # fmt: skip
    for name, value in said.items():
        asked = str(getattr(options, name))
        same: Callable[[str], str] = _task_name if name == "task" else str
        if given[name] and same(asked) != same(value):
            raise ConfigError(
                f"The {name} is {asked} on the command line and {value} in what changes the "
                "configuration.",
                remedy=f"Leave the {name} out of one of them.",
            )
    return dataclasses.replace(
        options, **{name: value for name, value in said.items() if not given[name]}
    )


def _task_name(task: str) -> str:
    return find_family(task).name


def _resumes(options: ConfigurationOptions) -> bool:
    return isinstance(options, RunOptions) and options.resume


def begun_with(options: ConfigurationOptions) -> ExperimentConfig:
    """Return the preset of a task, or the configuration of the run in a folder.

    Raises
    ------
    ConfigError
        If no task is given to begin with, or the run is on another one.
    OutputError
        If a run is to be resumed and there is none.
    """
    task = options.task
    if isinstance(options, RunOptions) and options.resume:
        from surmount.experiment.running import load_config

        out = options.out
        stored = load_config(out)
        if task is not None and find_family(task).name != stored.task:
            raise ConfigError(
                f"{out} holds a run on {stored.task}, not on {task}.",
                remedy="Leave the task out, or choose another --out folder.",
            )
        return stored
    if task is None:
        raise ConfigError(
            "No task was given.",
            remedy="Name one that `surmount tasks` lists, such as step, or my_module:make_env.",
        )
    return preset(task, options.preset)


def _asked(
    options: type[Options], arguments: Sequence[str], verb: str, *, out_may_lack: bool
) -> Options:
    """Return the options alone, without the configuration's flags and their values.

    What is neither is taken for a mistyped flag: reading all together tells it, and the nearest.
    """
    own = _option_names(options)
    kept: list[str] = []
    dropping = False
    for argument in arguments:
        if argument in HELP:
            continue
        if not _VALUE.match(argument):
            dropping = argument.lstrip("-").partition("=")[0].replace("-", "_") not in own
        if not dropping:
            kept.append(argument)
    if out_may_lack and "out" in own and not any(one.startswith("--out") for one in kept):
        kept += ["--out", "."]
    return tyro.cli(options, prog=f"surmount {verb}", args=kept)


def _option_names(options: type[Any]) -> set[str]:
    """Return the names of a verb's options, those of the dataclasses among them included."""
    names: set[str] = set()
    for name, kind in get_type_hints(options).items():
        names |= _option_names(cast(type[Any], kind)) if dataclasses.is_dataclass(kind) else {name}
    return names


def _flag_fields(config: ExperimentConfig) -> list[str]:
    return [one.name for one in dataclasses.fields(config) if one.name not in NOT_FLAGS]


def combined(options: type[Any], base: ExperimentConfig, beside: Mapping[str, object]) -> type[Any]:
    """Return one dataclass of a verb's options and of the configuration's fields."""
    told = attribute_docs(ExperimentConfig)
    fields: list[tuple[str, Any, Any]] = []
    for name in _flag_fields(base):
        value = getattr(base, name)
        kind = type(value)
        if not dataclasses.is_dataclass(value):
            kind = Annotated[kind, tyro.conf.arg(help=told.get(name, ""))]
        fields.append((name, kind, dataclasses.field(default=value)))
    fields += [(name, type(value), dataclasses.field(default=value))
               for name, value in beside.items()]  # fmt: skip
    return dataclasses.make_dataclass(
        "Configured",
        [("options", tyro.conf.OmitArgPrefixes[options]), *fields],
        frozen=True,
        kw_only=True,
    )


def _override_below(name: str, default: object, changes: Mapping[str, Any]) -> object:
    """Override one configuration by keys that begin with its name."""
    holder = dataclasses.make_dataclass(
        "Holder", [(name, type(default), dataclasses.field(default=default))], frozen=True
    )
    return getattr(override(holder(), changes), name)


def attribute_docs(cls: type[Any]) -> dict[str, str]:
    """Return the sentence below each field of a dataclass, by the field's name."""
    (node,) = ast.parse(textwrap.dedent(inspect.getsource(cls))).body
    body = node.body if isinstance(node, ast.ClassDef) else []
    found: dict[str, str] = {}
    for named, below in itertools.pairwise(body):
        if (
            isinstance(named, ast.AnnAssign)
            and isinstance(named.target, ast.Name)
            and isinstance(below, ast.Expr)
            and isinstance(below.value, ast.Constant)
        ):
            found[named.target.id] = " ".join(str(below.value.value).split())
    return found
