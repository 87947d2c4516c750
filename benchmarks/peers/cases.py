"""What is solved: the histories of load, the programs, and those of them that are made to do as another does."""

from benchmarks.peers.exchange import Case, Load

_PRESS, _STEPS = -0.06, 20  # mm
_SLIDES = ((0.005, 10), (0.05, 15))  # mm, steps
PEERS = ("ngsolve", "getfem", "felupe", "calculix")
# What explains where a peer is off: programs that can be made to do the same.
VARIANTS = (
    ("frictionless", "as CalculiX", "ngsolve"),
    ("friction", "as CalculiX", "ngsolve"),
    ("frictionless", "as FElupe", "ngsolve"),
    ("friction", "as FElupe", "ngsolve"),
    ("frictionless", "as installed", "felupe"),
)


def cases() -> dict[str, Case]:
    """Return the two histories of load."""
    press = [Load(0.0, _PRESS * k / _STEPS) for k in range(1, _STEPS)]
    loads, x = [*press, Load(0.0, _PRESS, "pressed with friction")], 0.0
    for end, count in _SLIDES:
        loads += [Load(x + (end - x) * k / count, _PRESS) for k in range(1, count)]
        loads += [Load(end, _PRESS, f"moved {1e3 * end:g} µm")]
        x = end
    frictionless = Case(0.0, (*press, Load(0.0, _PRESS, "pressed without friction")))
    return {"frictionless": frictionless, "friction": Case(0.25, tuple(loads))}
