r"""Newtons and square millimetres: a whole finger as slices of plane strain along its axis.

The finger is cut across its axis z. Its bone is rigid, so that a slice at z is indented by

.. math:: h(z) = \delta - s(z) - \theta z,

with the bone's lowering δ, the height s of the finger's lower side above its lowest point, and the slope θ of the
bone. Every slice is the scene's cross-section on a scale w(z), in plane strain. One trace of the cross-section, its
external force f, friction force, attraction, contact length and gross width over the indentation, answers for all:

.. math:: F = \int w\, f(h / w) \,dz, \qquad A = \int w\, \ell(h / w) \,dz .

The scale is exact for an elastic section without a length of its own. Ridges, roughness and attraction have one, so
that w should stay near 1.

What is summed. A slice touches where h > 0 and follows its trace from there, the branch of a finger that comes down:
pressed, charged, or at full slip with a force that is raised. A charged slice that is still held below h = 0 after it
was pressed deeper, its tension and its attraction, are left out; friction and area are low by that much. Full slip does
not depend on the path of loads as long as the same ridges touch (``tests/test_slices_runs.py``), so that each slice is
taken from one trace of sliding. A ridge that came down in the press may stay down in sliding: then the trace, on which
it comes in sliding, has less friction (``docs/newtons.md``).

What is left out: shear between slices, the end cap of the finger, and the flow of soft tissue along the axis, which in
a slice goes sideways alone. Smooth layered fingers in three dimensions (half ellipsoids with semi-axes of 10, 7 and
14 mm, neo-Hookean, frictionless, uncharged) are the measure of that. Beside them the sum of slices has
:data:`FORCE_ERROR` in force and :data:`AREA_ERROR` in area at equal indentation, and :data:`AREA_ERROR_AT_FORCE` in
area at equal force. Each is the span of two comparisons: one made once, without a program in this repository, and that
of ``benchmarks/solid.py`` (``docs/newtons.md``). This is the error of the model; the discretisation error of the
cross-section is another one and is stated apart.

Everything here is NumPy and SciPy; only :mod:`fingerpad.slices.traces` orders runs of finite elements.
"""

FORCE_ERROR = (-0.10, 0.15)
"""Least and largest error of the sum's force at equal indentation, over that of the finger in three dimensions."""
AREA_ERROR = (0.05, 0.14)
"""Likewise of the gross area at equal indentation, from 0.3 N."""
AREA_ERROR_AT_FORCE = (0.0, 0.07)
"""Likewise of the gross area at equal force, from 0.3 N."""
