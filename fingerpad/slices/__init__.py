r"""Newtons and square millimetres: a whole finger as slices of plane strain along its axis.

The finger is cut across its axis z. Its bone is rigid, so that a slice at z is indented by

.. math:: h(z) = \delta - s(z),

with the bone's lowering δ since the first touch and the height s of the finger's lower side above its lowest point. A
tilted bone has :func:`fingerpad.slices.total.tilted`. Every slice is the scene's cross-section on a scale w(z), in
plane strain. One trace of the cross-section, its external force f, friction force, attraction, contact length and gross
width over the indentation, answers for all:

.. math:: F = \int w\, f(h / w) \,dz, \qquad A = \int w\, \ell(h / w) \,dz .

The scale is exact for an elastic section without a length of its own. Ridges, roughness and attraction have one, so
that w should stay near 1.

A slice touches where h > 0 and follows its trace from there, the branch of a finger that comes down: pressed, charged,
or at full slip, which does not depend on the path of loads as long as the same ridges touch
(``tests/test_full_slip.py``). A charged slice that is still held below h = 0 after it was pressed deeper is left
out. A ridge that came down in the press may stay down in sliding: then the trace, on which it comes in sliding, has
less friction (``docs/newtons.md``). Left out are shear between slices, the end cap of the finger, and the flow of soft
tissue along the axis. Fingers in three dimensions are the measure of that: :mod:`fingerpad.slices.errors` has what is
known at a force. Errors of the cross-section's mesh and of the points of its trace are stated apart.

Everything here is NumPy and SciPy.
"""
