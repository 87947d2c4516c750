"""Tables of gaps that come with the package: exact contacts of random surfaces, over pressure and shortest wave.

environment/run python3 -m benchmarks.gap_tables [RATIO ...]     half an hour on one core, most of it for ratio 64

Each ratio of the longest to the shortest wave has one file in variational/roughness/data/. A surface is four longest
waves wide and has four pixels to the shortest one, or 256 in all. Seeds are 0 to 5: the files are the same each time.
"""

import argparse
import sys
import time
from collections.abc import Sequence

import numpy as np

from variational.roughness.contacts import gap_table
from variational.roughness.gaps import GapTable
from variational.roughness.spectrum import SelfAffine
from variational.roughness.tables import HURST, RATIOS, save, shipped_file
from variational.roughness.topography import HeightMap

WAVES, PIXELS, SURFACES, LEAST = 4, 4, 6, 256


def surfaces(ratio: float, count: int = SURFACES, waves: int = WAVES, pixels: int = PIXELS) -> list[HeightMap]:
    """Return random surfaces of a spectrum without roll-off; h_rms and q_0 are about 1.

    Args:
        ratio: of the longest wave to the shortest.
        count: of surfaces.
        waves: longest waves in the side of a surface.
        pixels: to a shortest wave, at least.
    """
    longest, n = 2 * np.pi, max(round(waves * ratio * pixels), LEAST)
    spectrum = SelfAffine(1.0, HURST, longest, plateau=False, shortest=longest / ratio)
    return [spectrum.surface((n, n), (waves * longest, waves * longest), seed) for seed in range(count)]


def computed(ratio: float) -> GapTable:
    """Return the table of a ratio."""

    def progress(done: int, of: int) -> None:
        if done % (of // SURFACES) == 0:
            print(f"ratio {ratio:g}: {done} of {of} contacts", flush=True)

    return gap_table(surfaces(ratio), 2 * np.pi, progress=progress)


def main(given: Sequence[str] | None = None) -> int:
    """Compute the tables of the ratios named, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ratios", nargs="*", type=float, metavar="RATIO", help="longest over shortest wave")
    for ratio in parser.parse_args(given).ratios or RATIOS:
        start = time.process_time()
        save(shipped_file(ratio), computed(ratio))
        print(f"{shipped_file(ratio)}: {time.process_time() - start:.0f} s of processor time")
    return 0


if __name__ == "__main__":
    sys.exit(main())
