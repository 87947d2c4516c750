"""``fingerpad sweep``: a scene over values of its keys, each run in a process of its own and kept on disk."""

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fingerpad.cli import ranges, tables
from fingerpad.cli.arguments import Parser, override, positive, say, writable
from fingerpad.folder import check_folder
from fingerpad.reading import plain, read
from fingerpad.scene import Scene, check, from_data
from fingerpad.sentences import SceneError, clip, show

_MOST = 10_000  # scenes of a study
_RESULTS = (
    tables.Column("mu_app", "mu_app", digits=".4f"),
    tables.Column("mu_app_error", "±", digits=".2g"),
    tables.Column("f_t", "friction", "N/m"),
    tables.Column("f_electrostatic", "attraction", "N/m"),
    tables.Column("contact_length", "contact", "mm", 1e3),
    tables.Column("contact_length_error", "±", "mm", 1e3, ".2g"),
    tables.Column("ridges_in_contact", "ridges", digits=".0f"),
)
_EXAMPLES = """
    fingerpad sweep --over voltage=0:200:5 --over f_ext=25,75 --jobs 2 --out results/sweep
    fingerpad sweep study.toml --set friction=0.3
"""


def main(argv: Sequence[str]) -> int:
    """Run a study; return the exit code."""
    parser = Parser(
        "fingerpad sweep", "A scene over values of its keys; runs that are in the folder are not repeated.", _EXAMPLES
    )
    parser.add_scene()
    parser.add_argument(
        "--over", action="append", default=[], metavar="KEY=RANGE", help="values of a key: 0,50 or first:last:count"
    )
    parser.add_out("results/sweep", "folder of all runs and of table.csv (default: results/sweep)")
    parser.add_argument("--jobs", type=positive(int), default=2, metavar="N", help="runs at a time (default: 2)")
    args = parser.read(argv)
    check_folder(args.out)
    base, axes = study(args.scene, args.set, args.over)
    scenes = {name: from_data(data) for name, data in grid(base, axes).items()}
    for scene in scenes.values():
        check(scene)
    args.out.mkdir(parents=True, exist_ok=True)
    writable(args.out / "table.csv")
    from fingerpad.sweep import sweep

    found = sweep(scenes, args.out, args.jobs)
    columns = [tables.Column(key, key, digits=".6g") for key in axes] + [*_RESULTS]
    rows = [_row(axes, scenes[name], found[name]) for name in scenes]
    say("Full slip of each run:")
    say(tables.text(columns, rows))
    failed = {name: summary["failure"] for name, summary in found.items() if summary.get("failure")}
    for name, why in failed.items():
        say(f"{name}: {why}")
    tables.write(args.out / "table.csv", [*columns, tables.Column("failure", "")], rows)
    say(f"Written: {args.out / 'table.csv'}")
    return 1 if failed else 0


def study(file: Path | None, given: Sequence[str], over: Sequence[str]) -> tuple[dict[str, Any], dict[str, list[Any]]]:
    """Return the data of a scene, and the values of each key that is varied.

    Args:
        file: a scene with a table ``[sweep]``, of a list or a range for each key.
        given: ``KEY=VALUE`` for the scene.
        over: ``KEY=RANGE``, which win over the table's.

    Raises:
        SceneError: nothing is varied, or a key is given twice.
    """
    data: dict[str, Any] = plain(read(file)) if file is not None else {}
    axes: dict[str, list[Any]] = {}
    table = data.pop("sweep", {})
    if not isinstance(table, dict):
        raise SceneError(f'sweep is {show(table)}; it must be a table such as [sweep] with voltage = "0:200:5"')
    for key, value in _flat(table):
        axes[key] = ranges.read(f"sweep.{key}", value) if isinstance(value, str) else value
        if not isinstance(axes[key], list) or not axes[key]:
            raise SceneError(f'sweep.{key} is {show(value)}; it must be a list or a range such as "0:200:5"')
    for text in over:
        key, equals, values = text.partition("=")
        if not (equals and key.strip()):
            raise SceneError(f"--over {clip(text) or 'an empty text'} is no KEY=RANGE; write --over voltage=0:200:5")
        axes[key.strip()] = ranges.read(f"--over {key.strip()}", values)
    if not axes:
        raise SceneError("nothing is varied; give a table [sweep] in the scene file or --over KEY=RANGE")
    for key, value in map(override, given):
        if key in axes:
            raise SceneError(f"--set {key} is given and {key} is varied; give one of the two")
        _put(data, key, value)
    return data, axes


def _flat(table: Mapping[str, Any], where: str = "") -> list[tuple[str, Any]]:
    """Return dotted keys and values: TOML reads ``roughness.h_rms = …`` as a table in a table."""
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        found += _flat(value, f"{where}{key}.") if isinstance(value, dict) else [(where + key, value)]
    return found


def grid(base: Mapping[str, Any], axes: Mapping[str, Sequence[Any]]) -> dict[str, dict[str, Any]]:
    """Return the data of every scene of a study, by a name that says its values.

    Raises:
        SceneError: there are too many.
    """
    count = 1
    for values in axes.values():
        count *= len(values)
    if count > _MOST:
        raise SceneError(f"the study has {count} scenes; it must have at most {_MOST}")
    scenes = {}
    for values in itertools.product(*axes.values()):
        data: dict[str, Any] = plain(base)
        for key, value in zip(axes, values, strict=True):
            _put(data, key, value)
        name = ", ".join(
            f"{key} = {value if isinstance(value, str) else show(value)}"
            for key, value in zip(axes, values, strict=True)
        )
        scenes[name] = data
    return scenes


def _put(data: dict[str, Any], key: str, value: Any) -> None:
    *tables_, name = key.split(".")
    for part in tables_:
        data = data.setdefault(part, {})
        if not isinstance(data, dict):
            raise SceneError(f"{key} cannot be given, since {part} is {show(data)}")
    data[name] = value


def _row(axes: Mapping[str, Any], scene: Scene, summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return the row of a run; values of keys as the scene has them, in SI."""
    row: dict[str, Any] = {}
    for key in axes:
        value: Any = scene
        for part in key.split("."):
            value = getattr(value, part)
        row[key] = value
    return row | {c.key: summary.get(f"slip_{c.key}") for c in _RESULTS} | {"failure": summary.get("failure")}
