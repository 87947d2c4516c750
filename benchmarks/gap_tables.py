"""Tables of gaps that come with the package: exact contacts of random surfaces, over pressure and shortest wave.

environment/run python3 -m benchmarks.gap_tables [RATIO ...] [--hurst H ...]     ten minutes of one core an exponent

Each Hurst exponent and ratio of the longest to the shortest wave has one file in variational/roughness/data/. Six
surfaces are four longest waves wide, for the ratio 64 two waves, and twelve of them for the exponent 0.75. They have
four pixels to the shortest wave, or 256 in all. Seeds are counted from 0: the files are the same each time.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from itertools import product

import numpy as np

from variational.roughness import gaps
from variational.roughness.gaps import HURSTS, RATIOS, GapTable, save, shipped_file
from variational.roughness.halfspace import gap_table
from variational.roughness.spectrum import SelfAffine
from variational.roughness.topography import HeightMap

PIXELS, LEAST = 4, 256  # pixels to the shortest wave; in a side, least


def surfaces(
    ratio: float, count: int = 0, waves: int = 0, pixels: int = PIXELS, hurst: float = 0.75
) -> list[HeightMap]:
    """Return random surfaces of a spectrum without roll-off; h_rms and q_0 are about 1.

    Args:
        ratio: of the longest wave to the shortest.
        count: of surfaces; by default that of a table.
        waves: longest waves in the side of a surface; by default those of a table.
        pixels: to a shortest wave, at least.
        hurst: Hurst exponent.
    """
    waves = waves or gaps.waves(ratio)
    count = count or (12 if ratio == RATIOS[-1] and hurst == 0.75 else 6)
    longest, n = 2 * np.pi, max(round(waves * ratio * pixels), LEAST)
    spectrum = SelfAffine(1.0, hurst, longest, plateau=False, shortest=longest / ratio)
    return [spectrum.surface((n, n), (waves * longest, waves * longest), seed) for seed in range(count)]


def computed(ratio: float, hurst: float) -> GapTable:
    """Return the table of a ratio and a Hurst exponent."""

    def progress(done: int, of: int) -> None:
        if done % 28 == 0:
            print(f"H {hurst:g}, ratio {ratio:g}: {done} of {of} contacts", flush=True)

    return gap_table(surfaces(ratio, hurst=hurst), 2 * np.pi, progress=progress)


def main(given: Sequence[str] | None = None) -> int:
    """Compute the tables of the ratios and exponents named, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ratios", nargs="*", type=float, metavar="RATIO", help="longest over shortest wave")
    parser.add_argument("--hurst", nargs="+", type=float, default=HURSTS, metavar="H", help="Hurst exponents")
    args = parser.parse_args(given)
    for hurst, ratio in product(args.hurst, args.ratios or RATIOS):
        start = time.process_time()
        save(shipped_file(hurst, ratio), computed(ratio, hurst))
        print(f"{shipped_file(hurst, ratio)}: {time.process_time() - start:.0f} s of processor time", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
