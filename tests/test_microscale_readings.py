"""The page of closures: what its finding has of states with a number, of upper bounds, and of ridges that adhere."""

from benchmarks.microscale import readings


def state(mu_app, d_eq=1e-6, balanced=0.0, beyond=0.0):
    return {"mu_app": mu_app, "p_c": 5e4, "d_eq": d_eq, "area": 0.1, "balanced": balanced, "beyond": beyond}


def read(**closures):
    states = {words: {"rms": {readings.LOAD: each}} for words, each in closures.items()}
    return {each.words: each for each in readings.read({"read": states})}


def test_states_beyond_the_table_have_no_number():
    """Nor without an equilibrium: neither in a row, nor in the band, whose upper end is open."""
    found = read(soft=state(0.5), hard=state(0.7), stuck=state(0.9, beyond=1.0), lost=None)
    assert readings.span(list(found.values()), "rms")["none"] == 2
    assert found["stuck"].cells().startswith("adheres") and not found["stuck"].friction and not found["stuck"].gaps


def test_upper_bound_is_marked():
    assert read(a=state(0.5, balanced=0.2))["a"].cells().startswith("≤ 0.50")


def test_agreement_with_published_numbers():
    found = read(both=state(0.55, 2e-6), friction=state(0.6, 1e-6), gap=state(0.7, 2.4e-6), none=state(0.4, 2.6e-6))
    agree = {words: (each.friction, bool(each.gaps)) for words, each in found.items()}
    assert agree == {"both": (True, True), "friction": (True, False), "gap": (False, True), "none": (False, False)}
