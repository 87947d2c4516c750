"""The paper's statements on tractions and energy densities, from fields that are made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.paper import energy, fields
from benchmarks.paper.statement import BUILT, HOLDS, IN_PART, NOT
from fingerpad.scene import Scene
from geometry import tags
from geometry.profiles import Profiles
from tests.test_paper import by

MU_0 = 0.25
POINTS = 8  # of a ridge under pressure
RIDGES = np.arange(-4, 5)


# -- tractions -------------------------------------------------------------------------------------
def skin(**changes):
    """Return the skin of nine ridges: tension at the edges, shear odd in x, slip at the edges; leading slip in part."""
    n = POINTS + 2  # one without pressure on either side
    x = (RIDGES[:, None] + np.linspace(-0.3, 0.3, n)) * 1e-3
    p = np.tile([0.0, 0.4, *[2.0] * (n - 4), 0.4, 0.0], (len(RIDGES), 1))
    slip = np.tile([True, True, *[False] * (n - 4), True, True], (len(RIDGES), 1))
    normal = {"p": p, "p_el": np.full(x.shape, 0.5), "t": MU_0 * p * np.where(slip, 1.0, 0.5) * np.sign(x)}
    partial = normal | {"t": MU_0 * p * np.where(x > 0, 1.0, 0.5)}
    states = {"charged": normal | changes, "partial": partial, "full_slip": normal}
    found = {f"{s}_{name}": values.ravel() for s, a in states.items() for name, values in a.items()}
    for s in states:
        found |= {f"{s}_x": x.ravel(), f"{s}_ridge": np.repeat(RIDGES, n).astype(float)}
    return found


def run_of(arrays, gaps=None, partial=None):
    """Return a run with a skin; ``gaps``: air gaps (m) by ridge in normal contact and at full slip."""
    gaps = gaps or ([3, 3, 2, 2, 1, 2, 2, 3, 3],) * 2
    arrays = arrays | {f"partial_{name}": values for name, values in (partial or {}).items()}
    steps = {"f_ext": np.full(4, 10.0), "contact_length": np.array([2.5, 2.0, 4.0, 5.0])}
    of_row = {0: gaps[0], 3: gaps[1]}
    return SimpleNamespace(
        arrays=lambda _: arrays, steps=steps, charged=0, full_slip=3, scene=Scene(),
        on_ridges=lambda row, name: (RIDGES, np.array(of_row[row], dtype=float)),
    )  # fmt: skip


def test_section_of_a_skin_as_the_paper_has_it():
    found = fields.section(run_of(skin()), run_of(skin()))
    assert [s.verdict for s in found] == [HOLDS, BUILT, BUILT, HOLDS, HOLDS]
    assert by(found, "leading").numbers == {"leading": 1.0, "trailing": 0.0}
    tension = by(found, "tensile").numbers
    assert (tension["points"], tension["near"], tension["of"]) == (54, 54, 27 * POINTS)
    assert (tension["edges"], tension["of_edges"]) == (54, 54)
    assert tension["most"] == pytest.approx(0.1 / 4)
    assert by(found, "slipping areas").numbers == {
        "ridges_0": 9, "ridges_1": 9, "of": 9, "ends_0": 18, "ends_1": 18, "ends": 18,
    }  # fmt: skip


def p_with(k, value):
    """Return a pressure that differs at one point of each ridge."""
    p = skin()["charged_p"].reshape(len(RIDGES), -1).copy()
    p[:, k] = value
    return p


SHEAR = skin()["charged_t"].reshape(len(RIDGES), -1)
HALF = np.r_[np.full(5, 0.5), np.full(85, 1.0)]  # of the friction limit in partial slip
STICK = {"t": 0.01 * np.sign(RIDGES[:, None] + np.linspace(-0.3, 0.3, POINTS + 2))}


@pytest.mark.parametrize(
    ("words", "run", "verdict"),
    [
        ("tensile", run_of(skin(p_el=np.full((9, POINTS + 2), 0.3))), BUILT),
        ("tensile", run_of({k: v * (0.1 if k.endswith("p_el") else 1) for k, v in skin().items()}), NOT),
        ("tensile", run_of(skin(p=p_with(4, 0.1))), IN_PART),
        ("point-symmetric", run_of(skin(t=np.full((9, POINTS + 2), 0.1))), NOT),
        ("point-symmetric", run_of(skin(**STICK)), IN_PART),  # too little shear
        ("slipping areas", run_of(skin(**STICK)), NOT),
        ("slipping areas", run_of(skin(t=np.where(RIDGES[:, None] < 3, SHEAR, 0.0))), IN_PART),
        ("slipping areas", run_of(skin(t=MU_0 * p_with(4, 2.0))), NOT),
        ("leading", run_of(skin(), partial={"t": skin()["partial_t"][::-1]}), NOT),
        ("leading", run_of(skin(), partial={"t": MU_0 * skin()["partial_p"] * HALF}), IN_PART),
        ("central", run_of(skin(), gaps=([0.5, 5, 2, 1, 1, 1, 2, 5, 5],) * 2), NOT),
        ("central", run_of(skin(), gaps=([1, 1, 2, 2, 3, 2, 2, 1, 1],) * 2), NOT),
        ("central", run_of(skin(), gaps=([3, 3, 2, 2, 1, 2, 2, 3, 3], [1, 1, 2, 2, 3, 3, 3, 4, 4])), IN_PART),
    ],
)  # fmt: skip
def test_verdict_on_a_skin(words, run, verdict):
    assert by(fields.section(run, run_of(skin(**STICK))), words).verdict == verdict


def test_slip_that_springs_take_up_is_shown_beside_the_verdict():
    found = by(fields.section(run_of(skin(**STICK)), run_of(skin())), "slipping areas")
    assert (found.verdict, found.numbers["ridges_0"], found.numbers["ridges_1"]) == (NOT, 0, 9)


def test_tension_without_pressure_does_not_count():
    """Attraction beyond the contact's edge is no tension of the skin: only points under pressure are judged."""
    arrays = skin()
    for state in ("charged", "partial", "full_slip"):
        arrays[f"{state}_p_el"] = np.where(arrays[f"{state}_p"] > 0, 0.1, 9.0)
    assert by(fields.section(run_of(arrays), run_of(arrays)), "tensile").numbers["points"] == 0


def test_threshold_statements():
    """155.2 V by Eq. 15, 163.6 V by Eq. 9."""
    numbers = by(fields.microscale(), "155 V").numbers
    assert numbers["eq_15"] == pytest.approx(155.2, abs=0.06)
    assert numbers["eq_9"] == pytest.approx(163.6, abs=0.05)


# -- the sine --------------------------------------------------------------------------------------
def sine(ratio, before, after, mu_app=(0.25, 0.5, 0.25)):
    """Return a run of three voltages; ``ratio``: of the energy densities of five sites at 200 V to those at 0 V."""
    sed = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    touching = {1: np.array(before), 3: np.array(after), 5: np.array(before)}
    rows = np.repeat([sed, sed * ratio, sed], 2, axis=0)
    return SimpleNamespace(
        loads=["slide", "slide", "sine 1", "sine 1", "sine 2", "sine 2"],
        steps={"mu_app": np.repeat(mu_app, 2), "voltage": np.repeat([0.0, 200.0, 0.0], 2)},
        receptors={"ridge": np.arange(-2.0, 3.0), "merkel_sed": rows},
        on_ridges=lambda row, name: (touching[row], None),
    )


@pytest.mark.parametrize(
    ("ratio", "after", "verdict"),
    [
        ([0.5, 1.0, 0.8, 0.9, 2.0], [-1, 0, 1, 2], HOLDS),
        ([8.0, 1.0, 0.8, 0.9, 2.0], [-1, 0, 1, 2], IN_PART),  # the site that leaves rises
        ([0.5, 1.0, 0.8, 0.9, 0.7], [-1, 0, 1, 2], IN_PART),  # the site that enters falls
        ([1.5, 1.2, 1.1, 1.3, 2.0], [-2, -1, 0, 1, 2], NOT),  # all but the one that enters rise
    ],
)
def test_sites_are_judged_by_what_their_energy_does(ratio, after, verdict):
    found = by(fields.sine(sine(ratio, [-2, -1, 0, 1], after)), "enter")
    assert found.verdict == verdict
    assert found.numbers["enters 2"] == found.numbers["highest 2"] == pytest.approx(ratio[-1])
    assert ("leave and fall" in found.why) == (ratio[0] > 1)
    assert ("leaves -2" in found.numbers) == (-2 not in after)


def test_map_of_the_sites_is_by_what_they_do():
    """The highest at 0 V is the last of five, which enters; the first leaves."""
    found = by(fields.sine(sine([8.0, 1.0, 0.8, 0.9, 2.0], [-2, -1, 0, 1], [-1, 0, 1, 2])), "enter")
    named = {name: ratio for name, ratio in found.numbers.items() if " " in name}
    assert named == {"highest 2": 2.0, "enters 2": 2.0, "leaves -2": 8.0, "changes least -1": 1.0}


def test_frequency_is_of_one_turn_in_half_a_period():
    def verdict(mu_app):
        run = sine(np.ones(5), [0], [0], mu_app)
        return by(fields.sine(run), "frequency").verdict

    assert verdict((0.25, 0.5, 0.25)) == BUILT
    assert verdict((0.25, 0.3, 0.5)) == NOT


# -- energy densities ------------------------------------------------------------------------------
def charged(run_x, tag, before, after):
    """Return a run whose layers' triangles have energy densities before and after charging."""
    triangles = np.arange(3 * len(tag)).reshape(-1, 3)
    finger = {"x": run_x, "u": np.zeros_like(run_x), "triangles": triangles, "tag": np.array(tag)}
    arrays = {"finger_press": finger | {"sed": np.array(before)}, "finger_charge": finger | {"sed": np.array(after)}}
    return SimpleNamespace(
        arrays=arrays.__getitem__, charged=0, on_ridges=lambda row, name: (np.array([-1, 0, 1]), None), scene=Scene()
    )


def test_change_of_a_layer_is_weighed_by_area():
    """One triangle of 1 and one of 3 area units: 100 % of the small and 20 % of the large are 40 %; one far off."""
    small, wide = np.array([[0, 0], [2, 0], [0, 1]]), np.array([[0, 0], [6, 0], [0, 1]])
    layers = [tags.LAYERS[name] for name in ("stratum corneum", "viable epidermis", "dermis")]
    corners = [1e-5 * small, 1e-5 * wide, 1e-5 * small + [5e-3, 0], 1e-5 * small, 1e-5 * small]
    tag = [layers[0], layers[0], layers[0], layers[1], layers[2]]
    run = charged(np.concatenate(corners), tag, [1.0, 1.0, 1.0, 2.0, 4.0], [2.0, 0.8, 9.0, 2.0, 5.0])
    assert list(energy.changes(run).values()) == pytest.approx([0.4, 0.0, 0.25], rel=1e-12)


SC, VE, DERMIS = (tags.LAYERS[name] for name in ("stratum corneum", "viable epidermis", "dermis"))
FINGER = Scene().geometry


def finger(*parts):
    """Return the arrays of a finger of small triangles about ridges.

    Each part is of a ridge, the place across (of the wavelength), the height above the intermediate ridge's tip (of its
    own), the layer and the energy density.
    """
    profiles, corners, tag, sed = Profiles(FINGER), [], [], []
    for ridge, across, height, layer, density in parts:
        s = np.array([ridge * FINGER.ridge_wavelength])
        tip, top = profiles.point(s, profiles.ve_d(s))[0], profiles.point(s)[0]
        up = (top - tip) / np.linalg.norm(top - tip)
        centre = tip + height * FINGER.intermediate_ridge_height * up
        centre = centre + across * FINGER.ridge_wavelength * np.array([-up[1], up[0]])
        corners.append(centre + 1e-6 * np.array([[-1, -1], [1, -1], [0, 2]]))
        tag.append(layer)
        sed.append(density)
    triangles = np.arange(3 * len(tag)).reshape(-1, 3)
    xy = np.concatenate(corners)
    return {"x": xy, "u": 0 * xy, "triangles": triangles, "tag": np.array(tag), "sed": np.array(sed, dtype=float)}


def about(ridge, skin=1.0, tip=9.0, valley=4.0, base=3.0, dermis=5.0):
    """Return the parts of one ridge: stratum corneum, viable epidermis from tip to base, dermis below the tip."""
    parts = [(0.0, 1.7, SC, skin), (0.0, 0.05, VE, tip), (0.1, 0.8, VE, base), (0.0, -0.05, DERMIS, dermis)]
    return [(ridge, *part) for part in [*parts, *((0.0, h, VE, valley) for h in (0.2, 0.3, 0.45))]]


def mapped(normal, slip, sites=(1.0, 0.5), papillae=(1.0, 2.0), away=1.0):
    """Return a run of ridges 0 and 1 in contact and 9 away from it; energies in normal contact and at full slip."""
    ridges = np.array([0.0, 1.0, 9.0])
    both = np.array([*[1.0] * 2, away])
    arrays = {"finger_press": finger(*about(0), *about(1)), "finger_charge": normal, "finger_slide": slip}
    return SimpleNamespace(
        arrays=arrays.__getitem__, loads=["press", "charge", "slide"], pressed=0, charged=1, full_slip=2, scene=Scene(),
        receptors={
            "ridge": ridges,
            "merkel_sed": np.array([both, both * sites[0], both * sites[1]]),
            "meissner_left": np.array([both, both * papillae[0], both * papillae[1]]),
            "meissner_right": np.array([both, both * papillae[0], both * papillae[1]]),
        },
        on_ridges=lambda row, name: (ridges[:2], None),
    )  # fmt: skip


def two(**values):
    return finger(*about(0, **values), *about(1, **values))


def sliding(base=8.0, sites=(1.0, 0.5), papillae=(1.0, 2.0), normal=None):
    return mapped(two() if normal is None else normal, two(base=base), sites, papillae)


def verdicts(plain, charged):
    return {s.paper: s.verdict for s in energy.maps(plain, charged)}


def verdict(words, plain, charged):
    return next(v for paper, v in verdicts(plain, charged).items() if words in paper)


def test_maps_as_the_paper_has_them():
    """In normal contact voltage changes the outer layer alone; sliding lowers the sites, and with voltage more so."""
    charged = sliding(12.0, (1.0, 0.3), (1.0, 3.0), two(skin=2.0))
    assert set(verdicts(sliding(), charged).values()) == {HOLDS}


@pytest.mark.parametrize(
    ("words", "plain", "charged", "expected"),
    [
        ("only in the stratum", sliding(), sliding(normal=two()), NOT),
        ("only in the stratum", sliding(), sliding(sites=(1.1, 0.5), normal=two(skin=2.0)), IN_PART),
        ("maxima", sliding(), sliding(normal=two(skin=20.0)), IN_PART),
        ("maxima", sliding(), sliding(normal=two(base=20.0)), NOT),
        ("most Merkel", sliding(sites=(1.0, 2.0)), sliding(), IN_PART),
        ("most Merkel", sliding(sites=(1.0, 2.0)), sliding(sites=(1.0, 2.0)), NOT),
        ("most Merkel", sliding(sites=(1.0, 0.96)), sliding(sites=(1.0, 0.96)), NOT),
        ("second maximum", sliding(4.0), sliding(4.0), NOT),
        ("second maximum", sliding(), sliding(normal=two(base=8.0)), NOT),
        ("second maximum", sliding(), mapped(two(), finger(*about(0, base=8.0), *about(1))), IN_PART),
        ("papillae", sliding(papillae=(2.0, 1.0)), sliding(), IN_PART),
        ("papillae", sliding(papillae=(2.0, 1.0)), sliding(papillae=(2.0, 1.0)), NOT),
        ("amplifies", sliding(), sliding(12.0, (1.0, 0.6), (1.0, 3.0)), IN_PART),
        ("amplifies", sliding(), sliding(7.0, (1.0, 0.6), (1.0, 1.9)), NOT),
    ],
)
def test_verdict_on_the_maps(words, plain, charged, expected):
    assert verdict(words, plain, charged) == expected


def test_places_about_a_ridge():
    """Across and up from the tip of its intermediate ridge, also where the outline is inclined."""
    run = mapped(finger((9, 0.1, 0.4, VE, 2.0), (9, -0.3, -0.2, DERMIS, 3.0), (0, 0.0, 0.5, VE, 4.0)), two())
    found = energy.Column(run, run.charged, 9.0)
    assert found.sed.tolist() == [2.0, 3.0]
    assert found.across == pytest.approx([0.1, -0.3], abs=1e-9)
    assert found.height == pytest.approx([0.4, -0.2], abs=1e-9)
    site = FINGER.merkel_offset / FINGER.ridge_wavelength
    off = 0.4 * FINGER.intermediate_ridge_height / FINGER.ridge_wavelength - site
    assert found.distance[0] == pytest.approx(np.hypot(0.1, off), rel=1e-9)


def test_claim_is_judged_site_by_site():
    """At the three ridges of which one is in contact in either run; the papillae can break it, the others in part."""

    def run(sed, touching, papillae=1.0):
        receptors = {"ridge": np.array([-3, -2, -1, 0]), "merkel_sed": np.array([sed])}
        receptors |= {"meissner_left": np.ones((1, 4)), "meissner_right": np.full((1, 4), papillae)}
        return SimpleNamespace(receptors=receptors, full_slip=0, on_ridges=lambda row, name: (touching, None))

    found = fields.claim(run([9.0, 100.0, 200.0, 400.0], [-2, -1]), run([1.0, 80.0, 202.0, 400.0], [-1, 0], 1.4))
    assert found.numbers == pytest.approx({"median": 0.01, "largest": -0.2, "papillae": 0.2, "least": 0.0, "most": 0.4})
    assert "at ridge -2, and 2 of 3 are" in found.ours
    assert "3 of 6" in found.ours
    assert found.verdict == IN_PART
    same = run([9.0, 1.0, 2.0, 4.0], [-1])
    assert fields.claim(same, run([9.0, 1.0, 2.0, 4.0], [0])).verdict == HOLDS
    assert fields.claim(same, run([9.0, 1.0, 2.0, 4.0], [0], 1.1)).verdict == IN_PART
    assert fields.claim(same, run([9.0, 1.0, 3.0, 8.0], [0])).verdict == NOT
