"""The only home of the numbers by which cells and facets are known."""

# Cells
STRATUM_CORNEUM = 1
VIABLE_EPIDERMIS = 2
DERMIS = 3
SUBCUTIS = 4
NAIL = 5
NAIL_BED = 6
LAYERS = {
    "stratum corneum": STRATUM_CORNEUM,
    "viable epidermis": VIABLE_EPIDERMIS,
    "dermis": DERMIS,
    "subcutis": SUBCUTIS,
    "nail": NAIL,
    "nail bed": NAIL_BED,
}

# Facets
BONE_RIM = 11
OUTER_SKIN = 12  # skin that is not expected to touch
NAIL_SURFACE = 13
SIDES = 14  # lateral faces of the verification bodies
SYMMETRY = 15  # x = 0, where a finger is built by half
_RIDGE_CENTRE = 1000


def ridge(j: int) -> int:
    """Return the facet tag of ridge ``j``; 0 is the central one, negative ones lie at x < 0."""
    return _RIDGE_CENTRE + j


def ridge_index(tag: int) -> int:
    """Return the ridge number that a facet tag made by :func:`ridge` stands for."""
    return tag - _RIDGE_CENTRE


def is_ridge(tag: int) -> bool:
    """Return whether a facet tag is one made by :func:`ridge`; the others are far below."""
    return tag > _RIDGE_CENTRE // 2
