"""``fingerpad drive``: friction over the period of a drive, and whether it is felt, without finite elements."""

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

from fingerpad.cli import output
from fingerpad.cli.arguments import Parser, changes, echo, quantities, refuse_twice, scene_of
from fingerpad.model.cautions import examine
from fingerpad.reduced.detection import FREQUENCIES, REFERENCE_FREQUENCY, thresholds
from fingerpad.results.quantities import Output
from fingerpad.runs.drive import drive
from fingerpad.scene import Scene, load
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.remarks import circuit_in_words

_COLUMNS = (
    Output("frequency", "Hz", digits=1),
    Output("sine", "", digits=2),
    Output("square_over_sine", "", words="square / sine", digits=2),
    Output("square", "", digits=2),
)
_EXAMPLES = """
    fingerpad drive --set "voltage={waveform='sine', amplitude='200 V', frequency='100 Hz'}" --plot drive.png
    fingerpad drive --file scope.csv --column CH1 --probe 100 --plot drive.png
    fingerpad drive --set electric.tissue=dry --set electric.leak="sliding dry" --frequency 15:480:20:log
"""


def main(argv: Sequence[str]) -> int:
    """Print friction over the period of a drive and relative thresholds of detection; return the exit code."""
    parser = Parser("drive", _EXAMPLES)
    parser.add_scene()
    words = "frequencies (Hz) of the relative thresholds, as 10:480:20 or 10:480:20:log"
    parser.add_argument("--frequency", metavar="RANGE", help=words)
    parser.add_argument("--file", metavar="CSV", help="drive: one period from a file, as an oscilloscope writes it")
    parser.add_argument("--column", metavar="NAME", help="its column of voltages, where it has several")
    parser.add_argument("--probe", type=_factor, metavar="FACTOR", help="factor on its voltages, as 100 of a 1:100 one")
    words = "picture: voltage, attraction and friction over a period, and the spectrum of friction"
    output.add_files(parser, _COLUMNS, words)
    args = parser.read(argv)
    scene = _scene(args)
    if args.plot and scene.drive is None:
        raise SceneError(
            f"--plot is given and voltage is {scene.volts:g} V; it must be a drive to be drawn over a period"
        )
    frequencies = FREQUENCIES if args.frequency is None else quantities("--frequency", args.frequency, "Hz")
    rows = [vars(each) | {"square": each.sine * each.square_over_sine} for each in thresholds(scene, frequencies)]
    found = None if scene.drive is None else drive(scene)
    constant = f"voltage is {scene.volts:g} V and no drive: no friction over a period."
    echo("\n".join([constant, *map(str, examine("note", scene))]) if found is None else str(found))
    echo(f"\nVoltage at the threshold of detection, relative to a sine of {REFERENCE_FREQUENCY:g} Hz:\n")
    echo(output.text(_COLUMNS, rows))
    if math.isinf(max(row["square"] for row in rows)):
        echo("\ninf: never felt, as the attraction is constant.")
    circuit = scene.electric.circuit(scene.geometry.sc_thickness)
    echo(f"\nThrough {circuit_in_words(circuit)}.")
    beyond = [f"{row['frequency']:g}" for row in rows if row["extrapolated"]]
    if beyond:
        echo(f"Extrapolated, at {', '.join(beyond)} Hz: the component that decides is beyond the known thresholds.")
    echo("Thresholds are ± 3 dB, and of displacement; volts of a person do not follow from them.")

    def draw(file: Path, _: object) -> None:
        if found is not None:
            found.plot(file)

    output.write_files(args, _COLUMNS, rows, draw)
    return 0


def _factor(text: str) -> float:
    """Return a number, whose range the scene checks."""
    try:
        return float(text)
    except ValueError:
        given = clip(text) or "an empty text"
        raise argparse.ArgumentTypeError(f"{given} is not allowed; it must be a number") from None


def _scene(args: argparse.Namespace) -> Scene:
    """Return the scene of the options, with the drive of a file."""
    refuse_twice(args, "voltage", "--file")
    if args.file is None:
        for name in ("column", "probe"):
            if getattr(args, name) is not None:
                raise SceneError(f"--{name} is given without --file; give the file that it is of")
        return scene_of(args, meshed=False)
    drive = {"waveform": "file", "file": args.file, "column": args.column, "probe": args.probe}
    return load(args.scene, changes(args.set) | {"voltage": drive})
