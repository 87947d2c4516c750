"""Tables of gaps: bins against the pixels themselves, what comes with the package, measured maps and refusals."""

import numpy as np
import pytest

from variational.roughness import gaps, halfspace
from variational.roughness.gaps import HURSTS, GapTable, bins, ratios
from variational.roughness.halfspace import gap_table, measured_table, press
from variational.roughness.spectrum import SelfAffine
from variational.roughness.topography import HeightMap

RATIO, WIDTH = 8.0, 8 * np.pi
PRESSURES = tuple(np.geomspace(0.02, 0.4, 8))


@pytest.fixture(scope="module")
def surface() -> HeightMap:
    spectrum = SelfAffine(1.0, 0.75, 2 * np.pi, plateau=False, shortest=2 * np.pi / RATIO)
    return spectrum.surface((128, 128), (WIDTH, WIDTH), 0)


@pytest.fixture(scope="module")
def table(surface) -> GapTable:
    return gap_table([surface], 2 * np.pi, PRESSURES)


def test_bins_have_the_moments_of_the_gaps():
    """Area, mean and mean square to roundoff, whatever is in a bin."""
    gap = np.abs(np.random.default_rng(0).standard_normal((40, 50))) * 3
    gap[:10] = 0.0
    contact = gap == 0
    area, weight, mean, deviation = bins(gap, contact)
    assert area == 0.25 and weight.sum() == pytest.approx(0.75)
    assert (weight * mean).sum() == pytest.approx(gap.mean())
    assert (weight * (mean**2 + deviation**2)).sum() == pytest.approx((gap**2).mean())


@pytest.mark.parametrize("h_0", [0.03, 0.166, 1.0])
def test_table_is_the_surface(surface, table, h_0):
    """<(h_0 + g)^-2> of the pixels, with and without contact, within 1e-4: two points for a bin lose its skewness."""
    k, h_rms = 3, surface.heights.std()
    found = press(surface, PRESSURES[k] * h_rms, 1.0)
    touching, square = found.pressure > 0, (h_0 + found.gap / h_rms) ** -2
    assert table.inverse_square(h_0, True)[0, k] == pytest.approx(square.mean(), rel=1e-4)
    assert table.inverse_square(h_0, False)[0, k] == pytest.approx(square[~touching].sum() / square.size, rel=1e-4)
    assert table.mean_gap()[0, k] == pytest.approx(found.gap.mean() / h_rms, rel=1e-5)
    near = np.mean((found.gap > 0) & (found.gap < 0.5 * h_rms))
    assert table.closer(0.5)[0, k] == pytest.approx(near, rel=0.02)  # bins are 20 % wide, and inside even


@pytest.mark.parametrize(("hurst", "ratio"), [(hurst, ratio) for hurst in HURSTS for ratio in ratios(hurst)])
def test_tables_of_the_package(hurst, ratio):
    """Six realisations, twelve smaller ones of the paper's last; all of the area is in contact or in a bin.

    Contact grows and gaps close with pressure.
    """
    ((part, found),) = gaps.of_spectrum(hurst, ratio)
    assert part == 1 and len(found.area) == (12 if (hurst, ratio) == (0.75, 64) else 6)
    np.testing.assert_allclose(found.area + found.weight.sum(axis=-1), 1, rtol=1e-5)
    assert (np.diff(found.area) > 0).all() and (np.diff(found.mean_gap()) < 0).all()
    assert (found.area[:, 0] < 0.005).all() and (found.area[:, -1] > 0.5).all()


@pytest.mark.slow
def test_table_of_the_package_is_made_again():
    """The first surface of the ratio 16 at two of its pressures, to what another library of transforms rounds."""
    from benchmarks.gap_tables import surfaces

    kept = gaps.of_spectrum(0.75, 16.0)[0][1]
    for k in (10, 20):
        ((_, found),) = halfspace.over_pressure(surfaces(16.0, 1)[0], 2 * np.pi, [kept.pressure[k]])
        assert found.area == pytest.approx(kept.area[0, k], rel=1e-3)
        assert found.weight @ found.mean == pytest.approx(kept.mean_gap()[0, k], rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(("hurst", "ratio"), [(0.65, 16.0), (0.85, 8.0), (0.75, 11.0), (0.7, 12.0)])
def test_between_tables_is_the_contact_itself(hurst, ratio):
    """A surface of an exponent or a ratio between the tables', beside the same random numbers in all of them.

    Persson's theory between exponents is off by less than half of it; a shorter wave has fewer pixels, besides.
    """
    from benchmarks.gap_tables import surfaces

    (first, *_), h_0 = surfaces(ratio, 1, hurst=hurst), 0.166
    between = gaps.of_spectrum(hurst, ratio)
    for pressure in between[0][1].pressure[[8, 14]]:
        ((_, found),) = halfspace.over_pressure(first, 2 * np.pi, [pressure])
        alone = GapTable(np.array([pressure]), *(np.array(each)[None, None] for each in found))
        for name, arguments, tolerance in (("mean_gap", (), 0.01), ("inverse_square", (h_0, True), 0.03)):
            expected = 0.0
            for part, table in between:
                (k,) = np.flatnonzero(np.isclose(table.pressure, pressure))
                expected += part * getattr(table, name)(*arguments)[0, k]
            assert getattr(alone, name)(*arguments)[0, 0] == pytest.approx(expected, rel=tolerance)


def test_between_ratios_and_exponents():
    """Parts of the neighbours add to one, by the ratio's logarithm and the exponent; beyond the ends it is refused."""
    (low, _), (high, _) = gaps.of_spectrum(0.75, 16 * np.sqrt(2))
    assert low == pytest.approx(0.5) and high == pytest.approx(0.5)
    assert [part for part, _ in gaps.of_spectrum(0.65, 8.0)] == pytest.approx([2 / 3, 1 / 3])
    parts = [part for part, _ in gaps.of_spectrum(0.825, 8 * np.sqrt(2))]
    assert parts == pytest.approx([0.25] * 4)
    assert ratios(0.75) == [8.0, 16.0, 32.0, 64.0] and set(ratios(0.8)) <= set(ratios(0.75))
    for ratio in (7.0, 65.0):
        with pytest.raises(ValueError, match=rf"{ratio:g} times the shortest one; tables .* for 8 to 64 times"):
            gaps.of_spectrum(0.75, ratio)
    for hurst in (0.5, 0.95):
        with pytest.raises(ValueError, match=rf"hurst is {hurst:g}; tables of the package are for 0.6 to 0.9"):
            gaps.of_spectrum(hurst, 16.0)


# -- measured maps -----------------------------------------------------------------------------------------
@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path))
    return tmp_path


def test_measured_map_is_computed_once(cache, surface):
    """The second time nothing is solved; the table is found by its name; another height makes another name."""
    measured = HeightMap(1e-6 * surface.heights, (100e-6, 100e-6)).cut((0, 0), (64, 64)).detrended("curvature")
    done: list[tuple[int, int]] = []
    name, h_rms, wavelength = halfspace.keep(measured, lambda *each: done.append(each))
    assert done[-1] == (len(gaps.PRESSURES), len(gaps.PRESSURES)) and wavelength == pytest.approx(50e-6)
    again: list[tuple[int, int]] = []
    assert halfspace.keep(measured, lambda *each: again.append(each))[0] == name and not again
    ((_, found),) = gaps.of_map(name)
    whole = measured_table(measured)[0]
    np.testing.assert_allclose(found.mean_gap(), whole.mean_gap(), rtol=1e-6)
    other = measured.heights.copy()
    other[3, 3] += 1e-9
    assert halfspace.keep(HeightMap(other, measured.size))[0] != name
    assert h_rms == measured.h_rms


def test_map_that_is_not_there(cache):
    with pytest.raises(ValueError, match="surface is 'abc', and .* has no table of that name .*; compute it again by"):
        gaps.of_map("abc")


X = np.linspace(-1, 1, 32)
WAVES = HeightMap(np.cos(7 * X)[:, None] * np.cos(5 * X) * 1e-6, (1e-4, 1e-4))


@pytest.mark.parametrize("content", [b"", b"nothing", b"PK\x03\x04 a zip file that was cut", None], ids=str)
def test_damaged_table_is_computed_again(cache, content):
    """Where a computer stopped while it was written, or a disk was full: by its name it is refused, by its map made."""
    name = halfspace.keep(WAVES)[0]
    file = cache / f"gaps_{name}.npz"
    file.write_bytes(file.read_bytes()[:2000] if content is None else content)
    with pytest.raises(ValueError, match=rf"surface is '{name}', and .*{file.name} holds no table of gaps"):
        gaps.of_map(name)
    done: list[int] = []
    assert halfspace.keep(WAVES, lambda *each: done.append(each[0]))[0] == name and done
    assert len(gaps.of_map(name)) == 1 and sorted(cache.iterdir()) == [file]


@pytest.mark.parametrize(("place", "why"), [("file", "File exists"), ("/proc", "No such file or directory")])
def test_cache_that_takes_no_files_is_refused_before_contacts_are_solved(tmp_path, monkeypatch, place, why):
    """A file in the place of the folder, and a folder in which nobody can write."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path / place))
    done: list[int] = []
    with pytest.raises(ValueError, match=rf"table .* cannot be kept in .*{place} .{why}.; name another folder"):
        halfspace.keep(WAVES, lambda *each: done.append(each[0]))
    assert not done


@pytest.mark.parametrize(
    ("heights", "size", "words"),
    [
        (np.ones((32, 32)), (1.0, 1.0), "all heights of the map are the same"),
        (X[:, None] + np.zeros(32), (1.0, 1.0), "a tilt makes 1e.02 % .* at most 5 % is allowed; remove it first"),
        (np.cos(7 * X)[:, None] * np.cos(5 * X), (1.0, 1.1), "pixels of the map are .* needs square ones, so resample"),
        (np.random.default_rng(0).normal(size=(32, 32)), (1.0, 1.0), "waves shorter than 4 pixels .* filter the map"),
    ],
)
def test_bad_maps(cache, heights, size, words):
    with pytest.raises(ValueError, match=words):
        halfspace.keep(HeightMap(heights, size))
