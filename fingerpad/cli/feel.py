"""``fingerpad feel``: spikes of mechanoreceptive afferents over a run in time, from its folder."""

from collections.abc import Sequence

from fingerpad.afferents import DEFAULT, LAWS
from fingerpad.cli.arguments import Parser, echo, path
from fingerpad.results.result import Result

_EXAMPLES = """
    fingerpad feel results/mine
    fingerpad feel results/mine --class SA1 --class "RA1 strain"
"""
CSV, NETCDF, PICTURE = "spikes.csv", "spikes.nc", "raster.png"


def main(argv: Sequence[str]) -> int:
    """Print and write the spikes of a run; return the exit code."""
    parser = Parser("feel", _EXAMPLES)
    parser.add_argument("folder", type=path, metavar="DIR", help="folder of a run with a load over time")
    words = f"class of afferents, one --class for each: {', '.join(LAWS)} (default: {', '.join(DEFAULT)})"
    parser.add_argument("--class", action="append", dest="classes", metavar="NAME", help=words)
    args = parser.read(argv)
    spikes = Result.load(args.folder).afferents(args.classes)
    echo(str(spikes))
    spikes.to_csv(args.folder / CSV)
    spikes.to_netcdf(args.folder / NETCDF)
    spikes.plot(args.folder / PICTURE)
    echo(f"Written: {', '.join(str(args.folder / name) for name in (CSV, NETCDF, PICTURE))}")
    return 0
