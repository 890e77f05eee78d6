"""Rational tensor-product B-spline surfaces, evaluated with cached basis matrices.

The evaluation is Piegl and Tiller, The NURBS Book (2nd ed. 1997), equation 4.15, as two matrix products; geomdl is the
test oracle and the bridge to exchange files, and stays out of every loop.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.interpolate import BSpline

from hpsop_core.errors import InputError
from hpsop_core.one_thread import one_blas_thread
from hpsop_core.typing_aliases import Array

# Grids of meshes and panels come again with every design; long lists of scattered parameters (fits) do not.
_LONGEST_CACHED = 1200


def _basis(knots: Array, degree: int, at: Array, order: int) -> Array:
    if order == 0:
        matrix: Array = BSpline.design_matrix(at, knots, degree).toarray()
    else:
        spline = BSpline(knots, np.eye(len(knots) - degree - 1), degree)
        # The derivative spline keeps clamped ends; its value at the last knot is the limit from the left.
        matrix = np.asarray(spline.derivative(order)(at), dtype=np.float64)
    matrix.setflags(write=False)
    return matrix


@lru_cache(maxsize=512)
def _cached_basis(knots: bytes, degree: int, parameters: bytes, order: int) -> Array:
    return _basis(np.frombuffer(knots), degree, np.frombuffer(parameters), order)


def basis_matrix(knots: Array, degree: int, parameters: Array, order: int = 0) -> Array:
    """B-spline basis functions (or their derivatives) at parameters, cached.

    Args:
        knots: clamped knot vector on [0, 1], shape (count + degree + 1,).
        degree: polynomial degree.
        parameters: values in [0, 1], shape (m,); values outside by rounding are clipped.
        order: 0 for the functions, k for the k-th derivative.

    Returns:
        Read-only matrix of shape (m, count).
    """
    at = np.clip(np.ascontiguousarray(parameters, dtype=np.float64), knots[0], knots[-1])
    knots = np.ascontiguousarray(knots, dtype=np.float64)
    if len(at) > _LONGEST_CACHED:
        return _basis(knots, degree, at, order)
    return _cached_basis(knots.tobytes(), degree, at.tobytes(), order)


def rising_spline_inverse(knots: Array, degree: int, control: Array, target: Array) -> Array:
    """Parameters in [0, 1] at which a rising spline reaches the targets, clipped to its ends.

    A table brackets, bisection finishes: the slope may vanish at the ends, where Newton's method would crawl.
    """
    spline = BSpline(knots, control, degree)
    goal = np.asarray(target, dtype=np.float64)
    grid = np.linspace(0.0, 1.0, 8 * len(control) + 1)
    index = np.clip(np.searchsorted(np.maximum.accumulate(spline(grid)), goal, side="right") - 1, 0, len(grid) - 2)
    low, high = grid[index], grid[index + 1]
    for _ in range(44):
        middle = 0.5 * (low + high)
        above = spline(middle) > goal
        high, low = np.where(above, middle, high), np.where(above, low, middle)
    result = 0.5 * (low + high)
    return np.where(goal <= control[0], 0.0, np.where(goal >= control[-1], 1.0, result))


def clamped_knots(interior: Array | list[float], degree: int) -> Array:
    """Knot vector on [0, 1] with full multiplicity at both ends around the given interior knots."""
    return np.concatenate([np.zeros(degree + 1), np.asarray(interior, dtype=np.float64), np.ones(degree + 1)])


def _frozen(values: Any, name: str, dimensions: int) -> Array:
    array = np.array(values, dtype=np.float64)
    if array.ndim != dimensions or not np.all(np.isfinite(array)):
        raise InputError(f"NURBS surface: '{name}' must be {dimensions}-dimensional and finite")
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class NurbsSurface:
    """A rational B-spline surface over the unit square.

    Attributes:
        degree_u, degree_v: polynomial degrees.
        knots_u, knots_v: clamped, non-decreasing knot vectors on [0, 1].
        control_points: shape (nu, nv, 3), metres.
        weights: shape (nu, nv), positive.

    Raises:
        InputError: counts, knots or weights do not make a surface.
    """

    degree_u: int
    degree_v: int
    knots_u: Array
    knots_v: Array
    control_points: Array
    weights: Array

    def __post_init__(self) -> None:
        for name, dimensions in (("knots_u", 1), ("knots_v", 1), ("control_points", 3), ("weights", 2)):
            object.__setattr__(self, name, _frozen(getattr(self, name), name, dimensions))
        nu, nv, axes = self.control_points.shape
        if axes != 3 or self.weights.shape != (nu, nv) or np.any(self.weights <= 0.0):
            raise InputError("NURBS surface: control points must be (nu, nv, 3) with one positive weight each")
        for direction, knots, degree, count in (
            ("u", self.knots_u, self.degree_u, nu),
            ("v", self.knots_v, self.degree_v, nv),
        ):
            if len(knots) != count + degree + 1 or degree < 1:
                raise InputError(f"NURBS surface: {len(knots)} knots in {direction}, {count + degree + 1} needed")
            clamped = np.all(knots[: degree + 1] == 0.0) and np.all(knots[-degree - 1 :] == 1.0)
            if np.any(np.diff(knots) < 0.0) or not clamped:
                raise InputError(f"NURBS surface: knots in {direction} must rise from 0 to 1 and be clamped")

    @property
    def _is_polynomial(self) -> bool:
        first = float(self.weights.flat[0])
        return bool(np.all(np.abs(self.weights - first) <= 1e-12 * first))

    def _basis(self, u: Array, v: Array, order_u: int, order_v: int) -> tuple[Array, Array]:
        return (
            basis_matrix(self.knots_u, self.degree_u, u, order_u),
            basis_matrix(self.knots_v, self.degree_v, v, order_v),
        )

    def _homogeneous(self, u: Array, v: Array, order_u: int, order_v: int) -> tuple[Array, Array]:
        left, right = self._basis(u, v, order_u, order_v)
        weighted = self.control_points * self.weights[..., None]
        return (
            np.einsum("iu,uvk,jv->ijk", left, weighted, right, optimize=True),
            left @ self.weights @ right.T,
        )

    @one_blas_thread()
    def evaluate(self, u: Array, v: Array) -> Array:
        """Points on the tensor grid u x v: shape (len(u), len(v), 3), metres."""
        if self._is_polynomial:
            left, right = self._basis(u, v, 0, 0)
            return np.asarray(np.einsum("iu,uvk,jv->ijk", left, self.control_points, right, optimize=True))
        points, weight = self._homogeneous(u, v, 0, 0)
        return np.asarray(points / weight[..., None])

    @one_blas_thread()
    def evaluate_pairs(self, u: Array, v: Array) -> Array:
        """Points at the pairs (u_i, v_i): shape (len(u), 3), metres."""
        left, right = self._basis(u, v, 0, 0)
        weighted = np.concatenate([self.control_points * self.weights[..., None], self.weights[..., None]], axis=2)
        homogeneous = np.einsum("iu,uvk,iv->ik", left, weighted, right, optimize=True)
        return np.asarray(homogeneous[:, :3] / homogeneous[:, 3:])

    @one_blas_thread()
    def derivatives(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Points and first derivatives with respect to u and v on the tensor grid, each (len(u), len(v), 3).

        The NURBS Book, equation 4.20.
        """
        points_w, weight = self._homogeneous(u, v, 0, 0)
        points = points_w / weight[..., None]
        tangents = []
        for order in ((1, 0), (0, 1)):
            numerator, slope = self._homogeneous(u, v, *order)
            tangents.append((numerator - slope[..., None] * points) / weight[..., None])
        return points, tangents[0], tangents[1]

    def transposed(self) -> NurbsSurface:
        """The same points with u and v exchanged."""
        return NurbsSurface(
            self.degree_v, self.degree_u, self.knots_v, self.knots_u,
            self.control_points.transpose(1, 0, 2), self.weights.T,
        )  # fmt: skip

    @one_blas_thread()
    def with_knots_u(self, knots: Array) -> NurbsSurface:
        """The same surface with further knots in u (for polynomial and rational surfaces alike).

        The finer spline space contains the coarser one, so collocation at the Greville points is exact.
        """
        degree = self.degree_u
        finer = np.sort(np.concatenate([self.knots_u, knots]))
        count = len(finer) - degree - 1
        greville = np.array([np.mean(finer[k + 1 : k + degree + 1]) for k in range(count)])
        insert = np.linalg.solve(basis_matrix(finer, degree, greville), basis_matrix(self.knots_u, degree, greville))
        weights = insert @ self.weights
        weighted = np.einsum("iu,uvk->ivk", insert, self.control_points * self.weights[..., None])
        return NurbsSurface(degree, self.degree_v, finer, self.knots_v, weighted / weights[..., None], weights)

    def to_dict(self) -> dict[str, Any]:
        """Plain lists for JSON; equal weights are stored as one number."""
        weights: Any = float(self.weights.flat[0]) if self._is_polynomial else self.weights.tolist()
        return {
            "degree_u": self.degree_u,
            "degree_v": self.degree_v,
            "knots_u": self.knots_u.tolist(),
            "knots_v": self.knots_v.tolist(),
            "weights": weights,
            "control_points": self.control_points.tolist(),
        }

    @staticmethod
    def from_dict(data: dict[str, Any]) -> NurbsSurface:
        """The inverse of `to_dict`.

        Raises:
            InputError: a key is missing or the numbers do not make a surface.
        """
        try:
            points = np.array(data["control_points"], dtype=np.float64)
            weights = np.array(data["weights"], dtype=np.float64)
            if weights.ndim == 0:
                weights = np.full(points.shape[:2], float(weights))
            return NurbsSurface(
                int(data["degree_u"]),
                int(data["degree_v"]),
                np.array(data["knots_u"]),
                np.array(data["knots_v"]),
                points,
                weights,
            )
        except (KeyError, ValueError, TypeError) as problem:
            raise InputError(f"NURBS surface: unreadable ({problem})") from problem

    def to_geomdl(self) -> Any:
        """The same surface as a ``geomdl.NURBS.Surface`` (for exchange files and as an oracle)."""
        from geomdl import NURBS

        surface = NURBS.Surface()
        surface.degree_u, surface.degree_v = self.degree_u, self.degree_v
        surface.ctrlpts_size_u, surface.ctrlpts_size_v = self.weights.shape
        surface.ctrlpts = self.control_points.reshape(-1, 3).tolist()
        surface.weights = self.weights.reshape(-1).tolist()
        surface.knotvector_u, surface.knotvector_v = self.knots_u.tolist(), self.knots_v.tolist()
        return surface

    @staticmethod
    def from_geomdl(surface: Any) -> NurbsSurface:
        """The inverse of `to_geomdl`; a polynomial geomdl surface gets weights of one."""
        shape = (surface.ctrlpts_size_u, surface.ctrlpts_size_v)
        points = np.array(surface.ctrlpts, dtype=np.float64).reshape(*shape, 3)
        weights = np.array(surface.weights or np.ones(shape), dtype=np.float64).reshape(shape)
        return NurbsSurface(
            surface.degree_u,
            surface.degree_v,
            np.array(surface.knotvector_u),
            np.array(surface.knotvector_v),
            points,
            weights,
        )
