"""Pictures of synthetic states: files that hold a picture, and axes that say what they show in which unit."""

import shutil
from dataclasses import replace
from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LogNorm
from matplotlib.image import imread
from matplotlib.tri import Triangulation

import fingerpad as fp
from fingerpad.results.pictures import style
from fingerpad.results.pictures.curves import SurfaceProfile, history, over_time, surface
from fingerpad.results.pictures.finger import finger
from fingerpad.scene import from_data
from geometry import tags
from tests.runs import no_pictures
from tests.small_finger import NINE
from variational.snapshot import outline
from variational.state import ContactState, Errors, StepRecord

LOADED = ContactState(
    f_ext=75.0, voltage=200.0, f_t=0.0, mu_app=0.5, f_contact=150.0, f_electrostatic=75.0, ridges_in_contact=17,
    contact_length=1.5e-3,
)  # fmt: skip
RECORD = StepRecord(*[0.0] * 7, *[0] * 4, jump=False)
TITLE = style.conditions([LOADED], 0.25)
BREAK = np.full(1, np.nan)


@pytest.fixture
def snapshot() -> SimpleNamespace:
    """A strip of three layers, 6 mm wide, with a hole for the bone, its lower side on the screen for |x| < 1 mm."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-3e-3, 3e-3, 25), np.linspace(0, 2e-3, 17)))
    triangles = Triangulation(x, y).triangles.astype(np.int64)
    cx, cy = x[triangles].mean(axis=1), y[triangles].mean(axis=1)
    keep = (np.abs(cx) > 1e-3) | (np.abs(cy - 1.6e-3) > 0.2e-3)
    triangles, cx, cy = triangles[keep], cx[keep], cy[keep]
    tag = np.where(cy < 0.4e-3, tags.STRATUM_CORNEUM, np.where(cy < 0.8e-3, tags.VIABLE_EPIDERMIS, tags.DERMIS))
    places = np.column_stack([x, y])
    ends, beside, _ = outline(places, triangles, tag)
    middles = len(places) + np.arange(len(ends))
    places = np.concatenate([places, places[ends].mean(axis=1)])
    u = np.column_stack([0 * places[:, 0], 20.0 * np.maximum(np.abs(places[:, 0]) - 1e-3, 0) ** 2])
    lines = np.stack([ends[:, 0], middles, ends[:, 1]], axis=1)
    sed = 2e4 * np.exp(-cy / 5e-4)
    return SimpleNamespace(x=places, u=u, triangles=triangles, sed=sed, tag=tag, lines=lines, beside=beside)


def profile(title: str, shift: float, sign: float) -> SurfaceProfile:
    """Return 17 ridges of Hertzian pressure up to 100 kPa."""
    columns = []
    for j in range(-8, 9):
        s = np.linspace(-0.22e-3, 0.22e-3, 45)
        p = 1e5 * (1 - (j / 9) ** 2) * np.sqrt(np.clip(1 - (s / 5e-5) ** 2, 0, 1))
        y = 2.0 * np.maximum(np.abs(s) - 5e-5, 0) ** 1.5
        d_eq = np.full_like(s, 1.6e-6 + 1e-8 * j**2)
        p_el = 8.854e-12 * 200**2 / 2 / (0.514e-6 + np.maximum(y, d_eq)) ** 2
        columns += [
            np.stack([j * 0.45e-3 + s + shift, y, p, sign * 0.25 * p, p_el, d_eq, np.full_like(s, j)]),
            np.tile(BREAK, (7, 1)),
        ]
    arrays = np.concatenate(columns, axis=1)
    return SurfaceProfile(title, replace(LOADED, bone_x=shift), *arrays)


def steps(f_ext: list[float]) -> list[ContactState]:
    """Return four steps of pressing and charging, and eight of sliding, two of them jumps."""
    x = np.concatenate([np.zeros(4), np.linspace(0.2e-3, 1.6e-3, 8)])
    rows = []
    for k, (bone_x, load) in enumerate(zip(x, f_ext, strict=True)):
        length, ridges = 1.5e-3 - 0.1 * bone_x, 17 - (k > 6) - (k > 8)
        f_t, record = 35 * np.tanh(1e3 * bone_x), replace(RECORD, jump=k in (7, 9))
        state = replace(LOADED, bone_x=bone_x, f_t=f_t, f_ext=load, mu_app=f_t / load, contact_length=length)
        rows.append(replace(state, ridges_in_contact=ridges, record=record))
    return rows


def labels(figure) -> list[str]:
    """Return the labels of all axes, secondary ones included."""
    axes = [a for ax in figure.axes for a in (ax, *ax.child_axes)]
    return [text for ax in axes for text in (ax.get_xlabel(), ax.get_ylabel()) if text]


def assert_picture(path, figure) -> None:
    """Not blank, labelled with units throughout, and under a title that names the load."""
    image = imread(path)
    assert min(image.shape[:2]) > 500
    assert image[:, :, :3].std() > 0.05
    assert labels(figure)
    for label in labels(figure):
        assert label.endswith(")"), label
        assert any(unit in label for unit in ("mm", "µm", "kPa", "N/m", "(–)", "(number)")), label
    for words in (r"f$_\mathrm{ext}$", "75 N/m", "200 V", "0.25"):
        assert words in figure.get_suptitle()


@pytest.mark.parametrize("sites", [None, np.array([[-0.4e-3, 0.5e-3], [0.1e-3, 0.5e-3]])], ids=["bare", "sites"])
def test_finger(tmp_path, snapshot, sites):
    figure = finger(tmp_path / "finger.png", snapshot, sites, "Normal contact: " + TITLE)
    assert_picture(tmp_path / "finger.png", figure)
    whole = figure.axes[0]
    named = [text.get_text() for text in whole.get_legend().get_texts()]
    sites_named = [] if sites is None else ["Merkel sites"]
    assert named == ["stratum corneum", "viable epidermis", "dermis", "screen", *sites_named]
    assert "bone" in [text.get_text() for text in whole.texts]


def test_cells_are_drawn_where_they_are(snapshot):
    """The colour of a pixel is that of the density of the cell there; nothing is drawn outside."""
    near = finger(None, snapshot, None, TITLE).axes[1]
    for line in (*near.lines, *near.patches, *near.texts):
        line.remove()
    near.figure.set_dpi(style.DPI)
    canvas = FigureCanvasAgg(near.figure)
    canvas.draw()
    image = np.asarray(canvas.buffer_rgba())
    points = 1e3 * (snapshot.x + snapshot.u)
    find = Triangulation(*points.T, snapshot.triangles).get_trifinder()
    norm = LogNorm(1e-6 * np.quantile(snapshot.sed, 0.999), 1e-3 * np.quantile(snapshot.sed, 0.999))
    for x, y in ((0.02, 0.3), (1.51, 1.1), (0.0, -0.1), (-1.97, 0.001)):
        column, row = near.transData.transform((x, y))
        pixel, cell = image[len(image) - 1 - int(row), int(column), :3], int(find(x, y))
        colour = matplotlib.colormaps["viridis"](norm(1e-3 * snapshot.sed[cell]), bytes=True)[:3]
        expected = colour if cell >= 0 else np.full(3, 255 * 0.92)
        assert np.abs(np.subtract(pixel, expected, dtype=float)).max() <= 3, (x, y)


PROFILES = [
    profile("normal contact", 0.0, 0.2),
    profile("partial slip", 1e-4, -0.6),
    profile("full slip", 3e-4, -1.0),
]


def test_surface(tmp_path):
    states = PROFILES
    figure = surface(tmp_path / "surface.png", states, TITLE)
    assert_picture(tmp_path / "surface.png", figure)
    titles = [ax.get_title(loc="left") for ax in figure.axes[::2]]
    for title, state in zip(titles, states, strict=True):
        assert state.title in title
        assert "75 N/m" in title and "200 V" in title and "1.5 mm" in title and "50 kPa" in title
        assert f"x = {state.state.bone_x * 1e3:g} mm" in title
    pressure = next(line for line in figure.axes[0].lines if line.get_label().startswith("contact pressure"))
    assert np.nanmax(pressure.get_ydata()) == pytest.approx(100.0)
    assert np.isnan(pressure.get_ydata()).sum() == 17  # lines break between ridges


@pytest.mark.parametrize(("tooth", "noted"), [(0.0, False), (0.3, True)])
def test_note_on_a_mesh_too_coarse_for_the_pressure(tooth, noted):
    smooth = profile("full slip", 0.0, -1.0)
    state = replace(smooth, p=smooth.p * (1 - tooth * (np.arange(len(smooth.p)) % 2)))
    title = surface(None, [state], TITLE).axes[0].get_title(loc="left")
    assert ("mesh too coarse for the pressure: saw teeth of" in title) == noted


@pytest.mark.parametrize("f_ext", [[20.0, 50.0] + 10 * [75.0], list(range(70, 82))], ids=["constant", "varying"])
def test_history(tmp_path, f_ext):
    """It starts with the charged normal state, the last before sliding, and marks both jumps."""
    figure = history(tmp_path / "history.png", steps(f_ext)[3:], "Sliding: " + TITLE, mu_0=0.25)
    assert_picture(tmp_path / "history.png", figure)
    assert any(r"µ$_\mathrm{app}$" in label for label in labels(figure))
    assert any("ridges in\ncontact" in label for label in labels(figure))
    ticks = figure.axes[2].get_yticks()
    assert (ticks == np.round(ticks)).all(), "ridges are counted"
    force = figure.axes[0].lines[0]
    assert len(force.get_xdata()) == 9
    assert (force.get_xdata()[0], force.get_ydata()[0]) == (0, 0)
    assert sum(line.get_linestyle() == ":" for line in figure.axes[0].lines) == 2


@pytest.mark.parametrize(("signs", "lines"), [([1], [0.25]), ([-1], [-0.25]), ([1, -1], [-0.25, 0.25])])
def test_limit_without_attraction_has_the_sign_of_friction(signs, lines):
    """A finger that slides to the left has a negative friction force."""
    rows = steps(12 * [75.0])
    keys = ("bone_x", "f_t", "mu_app")
    turned = [replace(row, **{key: sign * getattr(row, key) for key in keys}) for sign in signs for row in rows]
    force = history(None, turned, TITLE, mu_0=0.25).axes[0]
    dashed = {
        line.get_ydata()[0] / 75.0 for line in force.lines if line.get_linestyle() == "--" and len(line.get_ydata())
    }
    assert sorted(dashed) == pytest.approx(lines)


def test_history_shows_estimated_errors(tmp_path):
    """Full slip has an error bar in both panels, normal contact in that of the contact length; none without errors."""
    rows, error = steps(12 * [75.0]), Errors(f_t=1.0, contact_length=2e-5)
    states = {
        name: replace(LOADED, bone_x=x, f_t=f_t, contact_length=1.4e-3, error=error)
        for name, x, f_t in (("charged", 0.0, 0.0), ("full_slip", 1.4e-3, 35.0))
    }
    named = history(None, rows, TITLE, named=states)
    assert [len(ax.containers) for ax in named.axes[:2]] == [1, 2]
    bar = named.axes[1].containers[1].lines[2][0].get_segments()[0]
    assert bar == pytest.approx(np.array([[1.4, 1.38], [1.4, 1.42]]))
    bare = {name: replace(state, error=Errors()) for name, state in states.items()}
    assert not history(None, rows, TITLE, named=bare).axes[1].containers


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_nothing_is_cut_off(snapshot, scale):
    """Parts have fixed places: labels of small and of large numbers, and titles of two lines, are in the figure."""
    words = TITLE + "\npath on the starting mesh, contact size 5 µm"
    rows = [
        replace(row, f_t=scale * row.f_t, f_ext=scale * row.f_ext, time=0.01 * k)
        for k, row in enumerate(steps(12 * [75.0]))
    ]
    error = Errors(f_t=scale, contact_length=2e-5)
    named = {"full_slip": replace(rows[-1], error=error), "charged": replace(rows[3], error=error)}
    states = [replace(each, p=scale * each.p, note="final mesh, contact size 2.5 µm") for each in PROFILES]
    sites = np.array([[-0.4e-3, 0.5e-3]])
    drawn = [
        finger(None, snapshot, sites, words, {0: 0.0}), surface(None, states, words), over_time(None, rows, words),
        history(None, rows[3:], words, 0.25, named),
    ]  # fmt: skip
    for figure in drawn:
        FigureCanvasAgg(figure).draw()
        box = figure.get_tightbbox(FigureCanvasAgg(figure).get_renderer())
        wide, high = figure.get_size_inches()
        assert box.x0 >= 0 and box.y0 >= 0 and box.x1 <= wide and box.y1 <= high, figure.get_suptitle()


# -- pictures of a result that was read from its folder --------------------------------------------------------------
KINDS = ("history", "surface", "finger")
RUNS = {"plain": {"output": {"errors": False}}, "refined": {"accuracy": {"mu_app": 0.2}}}


@pytest.fixture(scope="module", params=RUNS)
def ran(request, tmp_path_factory) -> fp.Result:
    """A run on one mesh, and one whose named states are on a finer mesh than its path."""
    with no_pictures():
        scene = from_data(NINE | {"f_ext": 1.0, "voltage": 100.0} | RUNS[request.param])
        return fp.run(scene, out=tmp_path_factory.mktemp("run") / "out")


def pixels(figure) -> bytes:
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return bytes(canvas.buffer_rgba())


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_picture_is_that_of_the_run(ran, kind):
    assert pixels(fp.Result.load(ran.folder).plot(kind)) == pixels(ran.plot(kind))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["surface", "finger"])
def test_picture_whose_arrays_are_gone_is_refused(ran, tmp_path, kind):
    bare = shutil.copytree(ran.folder, tmp_path / "bare", ignore=shutil.ignore_patterns("*.npz"))
    read = fp.Result.load(bare)
    assert read.plot("history").axes
    with pytest.raises(ValueError, match="its folder has no fields.npz"):
        read.plot(kind)
