"""Compute one case of benchmarks.same; executed by the Python of either program, so that it uses public names alone.

The case comes as JSON from standard input; the last line of standard output is the answer as JSON.
"""

import dataclasses
import json
import sys
import tempfile
import warnings
from importlib import import_module
from pathlib import Path
from typing import Any

import fingerpad as fp
from fingerpad.startup import MPI


def plain(value: Any) -> Any:
    """Return states and what they hold as JSON has it: dataclasses by field, arrays as lists."""
    if dataclasses.is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, dict):
        return {str(key): plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    return value.tolist() if hasattr(value, "tolist") else value


def law(given: dict[str, Any]) -> Any:
    """Return the law of a name with its numbers."""
    return getattr(fp, given["law"])(**{name: value for name, value in given.items() if name != "law"})


def body(case: dict[str, Any]) -> dict[str, Any]:
    """Return the states of a ridge that is led by hand."""
    ridge = fp.Body(
        fp.geometry.ridge(size=20e-6),
        fp.Ogden(86.76e3, -14.53, 0.48),
        contact=law(case["contact"]),
        friction=0.25,
        roughness=fp.BearingArea(h_0=0.51e-6),
    )
    for name, argument in case["body"]:
        getattr(ridge, name)(**argument)
    return {"states": plain(ridge.states), "energy": plain(ridge.energy), "displacement": plain(ridge.displacement)}


def scene(case: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return steps, loads, named states and newtons of a run."""
    small = fp.Scene(**case["small"]).replace(mesh={"contact": 40e-6}, output={"errors": False})
    given = (fp.Scene() if case.get("default") else small).replace(**case["scene"])
    laws: dict[str, Any] = {}
    if "friction" in case:
        laws["friction"] = law(case["friction"])
    if "closure" in case:
        laws["roughness"] = law(case["closure"] | {"h_0": given.h_0})
    if "materials" in case:
        laws["materials"] = {layer: law(each) for layer, each in case["materials"].items()}
    if case.get("mesh"):
        laws["geometry"] = {"file": str(folder / "finger.msh")}
        write_mesh(folder / "finger.msh")
    given, laws = with_laws(given, laws)
    more = {"model": case["model"]} if "model" in case else {}
    if "force" in case and "force" in fp.Scene.model_fields:
        given = given.replace(force=case["force"])
    elif "force" in case:
        more["force"] = case["force"]
    out = None if case.get("without_folder") else folder / "out"
    result = fp.run(given, out=out, **more, **laws)
    found: dict[str, Any] = {"failure": result.failure}
    if "force" not in case:  # with one a program has steps and states of its own choice beside the finger's slices
        found |= {"steps": result.steps, "loads": result.loads, "named": result.named}
    if result.finger is not None:
        found["finger"] = {
            name: total.slices() | {"values": total.values, "error": result.finger.error[name]}
            for name, total in result.finger.states.items()
        }
    return {name: plain(value) for name, value in found.items()}


def newtons(finger: Any) -> dict[str, Any]:
    """Return the sums of a whole finger and their errors by state; a program of before had them in a dictionary."""
    if hasattr(finger, "to_dict"):
        kept = finger.to_dict()["states"]
        numbers = {name: {k: v for k, v in each.items() if isinstance(v, float)} for name, each in kept.items()}
        return {name: each | {"error": kept[name]["error"]} for name, each in numbers.items()}
    return {name: total.values | {"error": finger.error.get(name, {})} for name, total in finger.states.items()}


def with_laws(given: fp.Scene, laws: dict[str, Any]) -> tuple[fp.Scene, dict[str, Any]]:
    """Return a scene with its laws, and what a run is given beside it: a program of before took them as arguments."""
    if not hasattr(given, "with_laws"):
        if "geometry" in laws:  # of which the file of a mesh leaves nothing to read
            data = given.parameters()
            data["geometry"] = {"sc_thickness": given.geometry.sc_thickness}
            given = fp.Scene(**{name: value for name, value in data.items() if name != "mesh"})
        return given.replace(**laws), {}
    if "geometry" in laws:
        laws["mesh"] = Path(laws.pop("geometry")["file"])
    return given, {"closure" if name == "roughness" else name: value for name, value in laws.items()}


def write_mesh(path: Path) -> None:
    """Write the mesh of the small finger to a file, on rank 0; collective."""
    if MPI.COMM_WORLD.rank == 0:
        try:
            from fingerpad.model import section
        except ImportError:  # a program of before
            import_module("fingerpad.cli.mesh").main(
                ["demos/scenes/small_finger.toml", "--set", "mesh.contact=40e-6", "--out", str(path)]
            )
        else:
            section.write(fp.Scene.load(Path("demos/scenes/small_finger.toml")).replace(mesh={"contact": 40e-6}), path)
    MPI.COMM_WORLD.barrier()


def main() -> None:
    """Answer a case."""
    warnings.simplefilter("ignore")
    text = MPI.COMM_WORLD.bcast(sys.stdin.read() if MPI.COMM_WORLD.rank == 0 else None)
    case = json.loads(text)
    with tempfile.TemporaryDirectory() as own:
        folder = Path(MPI.COMM_WORLD.bcast(own))
        answer = body(case) if "body" in case else scene(case, folder)
        MPI.COMM_WORLD.barrier()
    if MPI.COMM_WORLD.rank == 0:
        print("\n" + json.dumps(answer))


main()
