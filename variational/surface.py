"""The skin that can touch: its facets, quadrature points, history, integrals and contact patches."""

import math
from collections.abc import Mapping

import basix
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from variational import compat, jit

Array = NDArray[np.float64]
_PIECES = 8  # of the part of a facet that a point stands for, over each of which heights are taken as linear


class Surface:
    """Facets of a set of tags, grouped in ridges, with Gauss points on each.

    Attributes:
        ridge: position of each facet's ridge in ``ridge_numbers``, shape (facets,).
        ridge_numbers: the ridges' numbers.
        tags: facet tag of each ridge.
        facets: number of each facet in the mesh.
        length: reference length of each facet (m).
        weights: Gauss weights on [0, 1], shape (points,).
        measure_at: reference length per facet coordinate from 0 to 1 (m) at the points, shape (facets, points).
    """

    def __init__(
        self,
        mesh: dolfinx.mesh.Mesh,
        facet_tags: dolfinx.mesh.MeshTags,
        ridges: Mapping[int, int],
        points: int = 4,
    ) -> None:
        """Collect the facets that this rank integrates over.

        Args:
            mesh: triangles, of first or second order.
            facet_tags: tags of facets.
            ridges: facet tag of each ridge's number.
            points: Gauss points on a facet; n of them integrate degree 2n - 1.

        Raises:
            ValueError: a cell has two facets on the surface, which leaves no place for their history.
        """
        self.mesh = mesh
        self.ridge_numbers = list(ridges)
        self.degree = 2 * points - 1
        self.tags = tag_list = list(ridges.values())
        degree = {"quadrature_degree": self.degree}
        self.measure = ufl.Measure("ds", mesh, subdomain_data=facet_tags, subdomain_id=tuple(tag_list), metadata=degree)
        gauss, weights = basix.make_quadrature(basix.CellType.interval, self.degree)
        self.points, self.weights = np.asarray(gauss), np.asarray(weights)
        if len(self.weights) != points:
            raise ValueError(f"degree {self.degree} takes {len(self.weights)} points, not {points}")

        topology = mesh.topology
        topology.create_connectivity(1, 2)
        topology.create_connectivity(2, 1)
        to_cells, to_facets = topology.connectivity(1, 2), topology.connectivity(2, 1)
        owned_cells = topology.index_map(2).size_local
        pairs, ridge, facets = [], [], []
        position = {tag: k for k, tag in enumerate(tag_list)}
        for facet, tag in zip(facet_tags.indices, facet_tags.values, strict=True):
            if int(tag) in position:
                cell = to_cells.links(facet)[0]
                if cell < owned_cells:
                    pairs.append((cell, int(np.flatnonzero(to_facets.links(cell) == facet)[0])))
                    ridge.append(position[int(tag)])
                    facets.append(facet)
        self.pairs = np.array(pairs, dtype=np.int32).reshape(-1, 2)
        self.ridge = np.array(ridge, dtype=np.int64)
        self.facets = np.array(facets, dtype=np.int32)
        doubled = len(np.unique(self.pairs[:, 0])) < len(self.pairs)
        if mesh.comm.allreduce(doubled):
            raise ValueError("a cell has two facets on the touching surface; use smaller surface elements")

        self._ways: fem.Function | None = None
        self.follow()
        # Powers of the facet coordinate at the points: interpolation is exact for the traces of elements
        # of a degree below the number of points.
        self._to_powers = np.linalg.inv(np.vander(self.points[:, 0], increasing=True))
        n = range(len(self.points))
        bernstein = np.array([[math.comb(i, k) / math.comb(n[-1], k) for k in n] for i in n])
        self._to_bernstein = bernstein @ self._to_powers
        self._history_maps()
        self._reversed = self._point_order(self._nodes())

    def follow(self) -> None:
        """Take the facets as they are now, after the mesh's nodes have moved."""
        nodes = self._nodes()
        self.measure_at = np.linalg.norm(np.einsum("kp,fki->fpi", self._slopes(nodes.shape[1]), nodes), axis=2)
        self.length = self.measure_at @ self.weights
        if self._ways is not None:
            self._write_ways(self._ways)

    def heights_along(self, y, w_y) -> list:
        """Return heights (m) from end to end of the part of its facet that each point stands for, evenly spaced; UFL.

        The parts have the weights' lengths, one after the other. A Taylor series from the point leads to the heights,
        which has no remainder where the displacement is quadratic along a facet.

        Args:
            y: current height (m).
            w_y: the vertical displacement in it (m).
        """
        shape = (_PIECES + 1, 2)
        self._ways = ways = fem.Function(
            fem.functionspace(self.mesh, ("Discontinuous Lagrange", len(self.weights) - 1, shape))
        )
        self._write_ways(ways)
        slope, bend = ufl.grad(w_y), ufl.grad(ufl.grad(w_y))
        every = [ufl.as_vector([ways[k, 0], ways[k, 1]]) for k in range(shape[0])]
        return [y + way[1] + ufl.dot(way, slope) + ufl.dot(way, bend * way) / 2 for way in every]

    def _write_ways(self, ways: fem.Function) -> None:
        """Write the ways (m) from each point to places along the part of its facet."""
        nodes, parts = self._nodes(), np.arange(_PIECES + 1) / _PIECES
        element = basix.create_element(basix.ElementFamily.P, basix.CellType.interval, nodes.shape[1] - 1)

        def places(xi: Array) -> Array:
            shapes: Array = np.asarray(element.tabulate(0, xi[:, None]), dtype=float)[0, :, :, 0]
            return np.asarray(np.einsum("pk,fki->fpi", shapes, nodes))

        component = fem.Function(self.history_space)
        for k, part in enumerate(parts):
            way = places(np.cumsum(self.weights) - (1 - part) * self.weights) - places(self.points[:, 0])
            for i in range(2):
                self.set_history(component, way[:, :, i])
                ways.x.array.reshape(-1, len(parts), 2)[:, k, i] = component.x.array

    def _nodes(self) -> Array:
        """Return the places (m) of each facet's ends and, of second order, its middle, shape (facets, 2 or 3, 2)."""
        geometry = compat.cell_geometry(self.mesh)
        on_facet = np.array([[1, 2, 3], [0, 2, 4], [0, 1, 5]])[:, : 2 if geometry.shape[1] == 3 else 3]
        nodes = np.take_along_axis(geometry[self.pairs[:, 0]], on_facet[self.pairs[:, 1]], axis=1)
        return np.asarray(self.mesh.geometry.x[nodes][:, :, :2])

    def ends(self) -> Array:
        """Return the places (m) of the ends of this rank's facets, shape (facets, 2, 2)."""
        return self._nodes()[:, :2]

    def _slopes(self, nodes: int) -> Array:
        """Return the derivatives of a facet's nodes' functions at the points, shape (nodes, points)."""
        element = basix.create_element(basix.ElementFamily.P, basix.CellType.interval, nodes - 1)
        return np.asarray(element.tabulate(1, self.points))[1, :, :, 0].T

    def _point_order(self, nodes: Array) -> NDArray[np.bool_]:
        """Find the facets whose points dolfinx takes from their second end to the first.

        By their cell's numbering in 0.9 no facet's, by their vertices' in 0.11 some.
        """
        position = self.compile(list(ufl.SpatialCoordinate(self.mesh)))
        first = self._as_given(position)[:, 0]
        from_first, from_second = (np.linalg.norm(first - nodes[:, k], axis=1) for k in range(2))
        return np.asarray(from_second < from_first)

    # -- history ---------------------------------------------------------------------------------------
    def _history_maps(self) -> None:
        """Matrices from values at a facet's points to the degrees of freedom of a discontinuous polynomial.

        A polynomial of degree n - 1 has n values on a facet, fixed by n Gauss points; the form evaluates it
        at the same points and gets the same values back.
        """
        self.history_space = fem.functionspace(self.mesh, ("Discontinuous Lagrange", len(self.weights) - 1))
        element = self.history_space.element.basix_element
        vertices = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        self._closure, self._inverse = [], []
        for a, b in ((1, 2), (0, 2), (0, 1)):
            on_facet = vertices[a] + self.points * (vertices[b] - vertices[a])
            basis = element.tabulate(0, on_facet)[0, :, :, 0]
            dofs = np.flatnonzero(np.abs(basis).max(axis=0) > 1e-12)
            self._closure.append(dofs)
            self._inverse.append(np.linalg.inv(basis[:, dofs]))

    def set_history(self, history: fem.Function, values: Array) -> None:
        """Write values at the Gauss points, shape (facets, points), into a function of ``history_space``."""
        dofmap = self.history_space.dofmap.list
        for local in range(3):
            mine = self.pairs[:, 1] == local
            cells = self.pairs[mine, 0]
            history.x.array[dofmap[cells][:, self._closure[local]]] = values[mine] @ self._inverse[local].T
        history.x.scatter_forward()

    def compile(self, expressions: list) -> fem.Expression:
        """Compile scalar UFL expressions for evaluation at the Gauss points."""
        return fem.Expression(ufl.as_vector(expressions), self.points, jit_options=jit.OPTIONS)

    def evaluate(self, compiled: fem.Expression) -> Array:
        """Return values at this rank's Gauss points, shape (expressions, facets, points)."""
        values = self._as_given(compiled)
        values[self._reversed] = values[self._reversed, ::-1]
        return np.moveaxis(values, 2, 0)

    def _as_given(self, compiled: fem.Expression) -> Array:
        """Return values at the points in dolfinx's order, shape (facets, points, expressions)."""
        values = compat.evaluate_on_facets(compiled, self.mesh, self.pairs)
        count = int(np.prod(compiled.ufl_expression.ufl_shape))
        return values.reshape(len(self.pairs), len(self.weights), count)

    def nodes(self, space: fem.FunctionSpace, ridge: int) -> NDArray[np.int32]:
        """Return this rank's nodes of a space on a ridge, by its position among the ridges; ghosts as far as known."""
        return np.asarray(fem.locate_dofs_topological(space, 1, self.facets[self.ridge == ridge], remote=True))

    # -- integrals -------------------------------------------------------------------------------------
    def per_ridge(self, density: Array) -> Array:
        """Integrate a density per reference length over each ridge, summed over ranks; shape (ridges,)."""
        return self.sum_over_facets((density * self.measure_at) @ self.weights)

    def sum_over_facets(self, values: Array) -> Array:
        """Sum one value a facet over each ridge and all ranks; shape (ridges,)."""
        # As floats: that of no facets would be of integers.
        mine = np.asarray(np.bincount(self.ridge, weights=values, minlength=len(self.ridge_numbers)), dtype=np.float64)
        total = np.empty_like(mine)
        self.mesh.comm.Allreduce(mine, total)
        return total

    def closed_length(self, x: Array, y: Array, gap: Array) -> Array:
        """Return the current length of each facet over which a gap is negative.

        The facet's current curve and the gap are the polynomials through their values at the points; the ends of the
        closed part are the gap's roots, so the length is located inside the facet and converges with the
        displacement's order.

        Args:
            x: current abscissae at the points (m), shape (facets, points).
            y: current heights at the points (m), shape (facets, points).
            gap: gaps at the points (m), shape (facets, points).
        """
        lengths = np.zeros(len(x))
        # A polynomial lies between its least and its largest Bernstein coefficient: most facets are found open or
        # closed as a whole, without roots.
        bernstein = gap @ self._to_bernstein.T
        near = gap.min(axis=1, initial=np.inf) < 4 * (np.ptp(gap, axis=1) if len(gap) else 0)
        near &= bernstein.min(axis=1) < 1e-9 * np.abs(gap).max(axis=1)
        closed = bernstein.max(axis=1) < 0
        gauss, weights = np.polynomial.legendre.leggauss(6)
        slopes = [z[closed] @ self._to_powers.T @ _derivative(len(self.weights), (1 + gauss) / 2) for z in (x, y)]
        lengths[closed] = np.hypot(*slopes) @ weights / 2
        partly = np.flatnonzero(near & ~closed)
        opening, *curve = (z[partly] @ self._to_powers.T for z in (gap, x, y))
        inside = _roots(opening)
        slope = _values(opening, inside, 1)
        # Of a gap that is nearly straight the companion matrix loses digits; one step of Newton's finds them.
        inside -= np.divide(_values(opening, inside), slope, out=np.zeros_like(inside), where=slope != 0)
        cuts = np.pad(np.sort(np.where((inside > 0) & (inside < 1), inside, 1.0)), [(0, 0), (1, 0)])
        cuts = np.pad(cuts, [(0, 0), (0, 1)], constant_values=1.0)
        start, size = cuts[:, :-1], np.diff(cuts)
        middle = start + size / 2
        xi = middle[:, :, None] + size[:, :, None] / 2 * gauss
        speed = np.hypot(*(_values(z, xi, 1) for z in curve))
        lengths[partly] = ((size / 2) * (speed @ weights) * (_values(opening, middle) < 0)).sum(axis=1)
        return lengths

    def gather(self, values: Array) -> Array | None:
        """Bring values at the points, shape (n, facets, points), to rank 0 as (n, all facets, points)."""
        parts = self.mesh.comm.gather(values)
        return None if parts is None else np.concatenate(parts, axis=1)


def _derivative(powers: int, xi: Array) -> Array:
    """Return the derivatives of 1, x, x^2, ... at places, shape (powers, places)."""
    n = np.arange(powers)[:, None]
    return np.asarray(n * xi ** np.maximum(n - 1, 0))


def _values(coefficients: Array, xi: Array, order: int = 0) -> Array:
    """Return polynomials, or their derivatives, shape (n, powers), at places of their own, shape (n, ...)."""
    values = np.zeros_like(xi)
    for k in range(coefficients.shape[1] - 1, order - 1, -1):
        values = values * xi + (k if order else 1) * np.expand_dims(coefficients[:, k], tuple(range(1, xi.ndim)))
    return values


def _roots(coefficients: Array) -> Array:
    """Return the real roots of polynomials of shape (n, powers), shape (n, powers - 1), NaN where there are fewer."""
    roots = np.full((len(coefficients), coefficients.shape[1] - 1), np.nan)
    degree = np.where(coefficients != 0, np.arange(coefficients.shape[1]), 0).max(axis=1, initial=0)
    for n in np.unique(degree[degree > 0]):
        mine = np.flatnonzero(degree == n)
        companion = np.zeros((len(mine), n, n))
        companion[:, np.arange(1, n), np.arange(n - 1)] = 1.0
        companion[:, :, -1] = -coefficients[mine, :n] / coefficients[mine, n, None]
        found = np.linalg.eigvals(companion[:, ::-1, ::-1])  # turned round, as numpy does, for smaller errors
        roots[mine, :n] = np.where(np.abs(np.imag(found)) < 1e-12, np.real(found), np.nan)
    return roots
