"""Fig. 9A: maps of the strain energy density, in normal contact and at full slip, without and with voltage."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from benchmarks.paper.statement import Statement, statement
from benchmarks.runs import Run
from geometry import tags
from geometry.profiles import Profiles

_OUTER, _BELOW = "stratum corneum", ("viable epidermis", "dermis")
_NEAR = 1 / 8  # of the ridges' wavelength: within it a maximum is at a site
_VALLEY = np.array([1, 2, 3, 4]) / 8  # bins of an intermediate ridge's height, from its tip, between its two maxima
_HIGHER = 1.1  # a second maximum over the least value on the way to it from the tip


class Column:
    """The triangles about one ridge, in its own directions, in the unloaded finger; shape (triangles,) each.

    Attributes:
        across: from the ridge's middle, over the wavelength.
        height: above the intermediate ridge's tip, over its height; the skin is up.
        distance: to the Merkel site, over the wavelength.
        sed: mean strain energy density (J/m^3).
    """

    def __init__(self, run: Run, row: int, ridge: float) -> None:
        """Take the finger at the end of the load that a row of :attr:`Run.steps` belongs to."""
        load, finger = str(run.steps["load"][row]).replace(" ", "_"), run.scene.geometry
        a = run.arrays(f"finger_{load}")
        profiles, s = Profiles(finger), np.array([ridge * finger.ridge_wavelength])
        tip, skin = profiles.point(s, profiles.ve_d(s))[0], profiles.point(s)[0]
        up = (skin - tip) / np.linalg.norm(skin - tip)
        off = a["x"][a["triangles"]].mean(axis=1) - tip
        height, across = off @ up, off @ np.array([-up[1], up[0]])
        mine = np.abs(across) < finger.ridge_wavelength / 2
        self._tag, self.sed = a["tag"][mine], a["sed"][mine]
        self.across = across[mine] / finger.ridge_wavelength
        self.height = height[mine] / finger.intermediate_ridge_height
        self.distance = np.hypot(across, height - finger.merkel_offset)[mine] / finger.ridge_wavelength

    def layers(self, names: Iterable[str]) -> NDArray[np.bool_]:
        """Return which triangles are in some layers."""
        return np.isin(self._tag, [tags.LAYERS[name] for name in names])

    def base(self) -> tuple[float, float]:
        """Return the highest energy density in the upper half of the intermediate ridge, and the valley below it.

        The valley is the least of the highest values in the bins of the lower half; the tip is left out.
        """
        inside = self.layers(["viable epidermis"]) & (np.abs(self.across) < 0.25)
        bins = np.digitize(self.height, _VALLEY)
        parts = [self.sed[inside & (bins == k)] for k in range(1, len(_VALLEY))]
        upper = self.sed[inside & (self.height > _VALLEY[-1]) & (self.height < 1)]
        return float(upper.max()), min(float(part.max()) for part in parts if len(part))


def changes(run: Run) -> dict[str, float]:
    """Return by how much the voltage changes a layer's energy near the contact, in normal contact (relative)."""
    before, after = run.arrays("finger_press"), run.arrays("finger_charge")
    centre = (before["x"] + before["u"])[before["triangles"]].mean(axis=1)
    touching, _ = run.on_ridges(run.charged, "p_c")
    near = np.abs(centre[:, 0]) < (np.abs(touching).max() + 0.5) * run.scene.geometry.ridge_wavelength
    found = {}
    for name in (_OUTER, *_BELOW):
        mine = near & (before["tag"] == tags.LAYERS[name])
        corners = before["x"][before["triangles"][mine]]
        e, f = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = np.abs(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]) / 2
        found[name] = float((area @ np.abs(after["sed"][mine] - before["sed"][mine])) / (area @ before["sed"][mine]))
    return found


def maps(plain: Run, charged: Run) -> list[Statement]:
    """Return the statements on the maps, of a run without voltage and one with."""
    both = _in_contact(plain) & _in_contact(charged)
    return [_layers(charged), _maxima(charged), _fall(plain, charged), *_second(plain, charged, both)]


def _in_contact(run: Run) -> NDArray[np.bool_]:
    """Return which sites' ridges are in contact in normal contact and at full slip, shape (sites,)."""
    rows = (np.isin(run.receptors["ridge"], run.on_ridges(row, "p_c")[0]) for row in (run.charged, run.full_slip))
    return np.logical_and(*rows)


def _layers(run: Run) -> Statement:
    mine, r = _in_contact(run), run.receptors["merkel_sed"]
    sites = np.abs(r[run.charged][mine] / r[run.pressed][mine] - 1)
    sc, ve, dermis = changes(run).values()
    layers = {"sc": sc, "ve": ve, "dermis": dermis, "merkel": np.median(sites), "largest": sites.max()}
    return statement("layers", layers, ve < 0.1 * sc and sites.max() < 0.05, ve < 0.5 * sc)


def _maxima(run: Run) -> Statement:
    """Judge the field about each ridge in normal contact: whole by all of the skin, in part below its outer layer."""
    ridges = run.on_ridges(run.charged, "p_c")[0]
    found = {"skin": 0, "below": 0, "dermis": 0}
    for c in (Column(run, run.charged, ridge) for ridge in ridges):
        skin, below = (int(np.argmax(np.where(c.layers(of), c.sed, 0.0))) for of in ((_OUTER, *_BELOW), _BELOW))
        found["skin"] += c.distance[skin] < _NEAR
        found["below"] += c.distance[below] < _NEAR
        found["dermis"] += c.distance[below] < _NEAR and c.layers(["dermis"])[below]
    numbers = found | {"of": len(ridges)}
    return statement("maxima", numbers, found["skin"] == len(ridges), found["below"] > len(ridges) / 2)


def _fall(plain: Run, charged: Run) -> Statement:
    """Judge the sites in contact all along: whole where most fall by more than 5 % without voltage and with it."""
    counts, most = dict[str, int](), []
    for name, run in (("plain", plain), ("charged", charged)):
        sed = run.receptors["merkel_sed"][:, _in_contact(run)]
        fallen = sed[run.full_slip] < 0.95 * sed[run.charged]
        counts |= {name: int(fallen.sum()), f"{name}_of": fallen.size}
        most.append(fallen.mean() > 0.5)
    return statement("fall", counts, all(most), any(most))


def _second(plain: Run, charged: Run, both: NDArray[np.bool_]) -> list[Statement]:
    """Judge the second maximum, and whether voltage amplifies what sliding does, at the ridges always in contact."""
    ridges = plain.receptors["ridge"][both]
    found, numbers, trends = {}, {"of": len(ridges)}, {}
    for name, run in (("plain", plain), ("charged", charged)):
        for state, row in (("normal", run.charged), ("slip", run.full_slip)):
            found[state] = np.array([Column(run, row, ridge).base() for ridge in ridges])
            numbers[f"{name}_{state}"] = (found[state][:, 0] > _HIGHER * found[state][:, 1]).sum()
        sed, meissner = run.receptors["merkel_sed"], run.receptors["meissner_left"] + run.receptors["meissner_right"]
        trends[f"{name}_site"] = np.median(sed[run.full_slip][both] / sed[run.charged][both])
        trends[f"{name}_base"] = np.median(found["slip"][:, 0] / found["normal"][:, 0])
        trends[f"{name}_papilla"] = meissner[run.full_slip][both].mean() / meissner[run.charged][both].mean()
    appear, before = ([numbers[f"{name}_{state}"] for name in ("plain", "charged")] for state in ("slip", "normal"))
    more = [trends["charged_site"] < trends["plain_site"]]
    more += [trends[f"charged_{part}"] > trends[f"plain_{part}"] for part in ("base", "papilla")]
    rises = {name: trends[f"{name}_papilla"] for name in ("plain", "charged")}
    return [
        statement("second", numbers, min(appear) == len(ridges) > max(before), min(appear) > max(before)),
        statement("papillae", rises, min(rises.values()) > 1, max(rises.values()) > 1),
        statement("amplified", trends, all(more), any(more)),
    ]
