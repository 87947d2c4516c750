"""``fingerpad calibrate``: keys of a scene by one's own table of whole fingers."""

import sys
from collections.abc import Sequence

from fingerpad.cli.arguments import Parser, echo, heads_of, path, positive, scene_of
from fingerpad.launcher import raising_at_ctrl_c
from fingerpad.runs import batch  # noqa: F401  # before Ctrl-C raises
from fingerpad.scene.messages import SceneError, clip

_EXAMPLES = """
    fingerpad calibrate mine.csv --fit friction roughness.h_rms
    fingerpad calibrate mine.csv scene.toml --fit friction.tau_0 electric.d_i --spread 0.05 --no-full
    fingerpad calibrate people.csv --fit friction roughness.h_rms --hold-out participant=7
"""


def main(argv: Sequence[str]) -> int:
    """Calibrate a scene; return the exit code."""
    parser = Parser("calibrate", _EXAMPLES)
    words = "CSV of whole fingers with names and units in its header: force, voltage, friction force, gross area, …"
    parser.add_argument("table", type=path, metavar="TABLE", help=words)
    parser.add_scene()
    words = "keys of the scene whose values are fitted, as friction roughness.h_rms"
    parser.add_argument("--fit", nargs="+", action="extend", default=[], metavar="KEY", help=words)
    words = "relative standard deviation of rows that have none in the table (default: estimated from the rows)"
    parser.add_argument("--spread", type=float, metavar="PART", help=words)
    words = "rows that are predicted and not fitted: participant=7, or force=0.5 in N"
    parser.add_argument("--hold-out", action="append", default=[], metavar="NAME=VALUE", help=words)
    parser.add_heads()
    parser.add_out("results/calibration", "folder of scene.toml, rows.csv, report.html and full runs", quiet="result")
    parser.add_argument("--no-full", action="store_true", help="no full runs at three conditions of the table")
    parser.add_argument("--jobs", type=positive, default=2, metavar="N", help="full runs at a time (default: 2)")
    args = parser.read(argv)
    held = {name.strip(): value.strip() for name, _, value in (text.partition("=") for text in args.hold_out)}
    if not all(held.values()):
        raise SceneError(f"--hold-out is {clip(' '.join(args.hold_out))}; write it as --hold-out participant=7")
    from fingerpad.measurements.calibrate import calibrate  # pandas

    try:
        with raising_at_ctrl_c():
            found = calibrate(
                args.table, scene_of(args, meshed=False), args.fit, spread=args.spread, columns=heads_of(args),
                hold_out=held, full=0 if args.no_full else 3, out=args.out, jobs=args.jobs, quiet=args.quiet,
            )  # fmt: skip
    except (KeyboardInterrupt, SystemExit):  # of signals
        kept = "" if args.no_full else f"; full runs are kept in {args.out}, and the same command goes on"
        print(f"fingerpad: stopped{kept}", file=sys.stderr)
        raise
    echo(f"{found}\n\nWritten: {args.out / 'scene.toml'}, rows.csv, report.html")
    return 1 if found.failures else 0
