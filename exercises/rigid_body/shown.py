"""What checks measure and figures draw, which students get too: it imports only numpy and the kit.

The bodies and spins of notebook 2.6 are in SI units. Sums are written element by element: the last bits of
einsum depend on an array's place in memory, and a student's kernel must print the same digits as the server.
The figures show the student's data and the exact motion, after Figs. 145–150 of the notebook.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from polhode.judging.checks import Arrays
from polhode.judging.integration import Array
from polhode.kinds.motions import as_closely
from polhode.report.figure_parts import FACE_COLORS, arrow, box_polys, cube_axes, legend_above

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

BOX = (1.0, 2.0, 1.4, 0.4)  # mass and edges of the book, kg and m
SPIN = 6.0  # rad/s about each axis of the book in turn
SPIN_TIME = 2.5  # s
NUDGE = 0.02  # both other components, as a fraction of the spin
BODY = (2.0, 3.0, 4.0)  # moments of exercises 2 and 3
TORQUE_FREE = (1.0, 0.6, 0.8)  # and their spin: T = 2.82 J, |L| = 4.180909 kg m²/s
SYMMETRIC = (1.0, 1.0, 1.6)  # moments of exercises 4 and 6
SYMMETRIC_RATE = 1.8  # rad/s, (I₃ − I₁)/I₁ · ω₃ with ω₃ = 3


def kinetic_energy(w: Array, I: ArrayLike) -> Array:
    """Return T = ½ Σ Iᵢ ωᵢ² in J (...) of ``w`` (3, ...) in rad/s and ``I`` (3,) in kg m²."""
    i1, i2, i3 = np.asarray(I, dtype=float)
    return np.asarray(0.5 * (i1 * w[0] ** 2 + i2 * w[1] ** 2 + i3 * w[2] ** 2))


def momentum_norm(w: Array, I: ArrayLike) -> Array:
    """Return |L| in kg m²/s (...) of ``w`` (3, ...) and ``I`` (3,)."""
    return np.asarray(np.linalg.norm(_momentum(w, I), axis=0))


def energy_of_the_top(w: Array) -> Array:
    """Return T of the torque-free motion in J (...)."""
    return kinetic_energy(w, BODY)


def momentum_of_the_top(w: Array) -> Array:
    """Return |L| of the torque-free motion in kg m²/s (...)."""
    return momentum_norm(w, BODY)


def space_momentum(R: Array, w: Array, I: ArrayLike) -> Array:
    """Return L in *space* components (n, 3), in kg m²/s, of ``R`` (n, 3, 3), ``w`` (3, n) and ``I`` (3,)."""
    return np.asarray((R * _momentum(w, I).T[:, None, :]).sum(axis=2))


def orthonormality_error(R: Array) -> Array:
    """Return max |RᵀR − 1| of each attitude (n,)."""
    gram = (R[:, :, :, None] * R[:, :, None, :]).sum(axis=1)
    return np.asarray(np.abs(gram - np.eye(3)).max(axis=(1, 2)))


def turning_rate(t: Array, w: Array, exact_w: Array) -> float:
    """Return the mean rate in rad/s at which (ω₁, ω₂) turns: the known one of the exact ω (3, n), and what
    ``w`` gains on it.
    """
    ahead = (w[0] + 1j * w[1]) * (exact_w[0] - 1j * exact_w[1])
    return SYMMETRIC_RATE + float(np.polyfit(t, np.unwrap(np.angle(ahead)), 1)[0])


def variation(w: Array) -> float:
    """Return by how much ω₃ varies, in rad/s."""
    return float(np.ptp(w[2]))


def transverse(w: Array, axis: int, spin: float) -> Array:
    """Return the transverse |ω| (n,) over ``spin``, for a spin started about body axis ``axis`` (0, 1, 2)."""
    return np.asarray(np.hypot(*np.delete(w, axis, axis=0)) / spin)


def growth(w: list[Array]) -> Array:
    """Return the largest transverse |ω| over the spin, of spins about the three axes in turn."""
    return np.array([transverse(one, axis, SPIN).max() for axis, one in enumerate(w)])


def is_stable_about_the_extreme_axes(w: list[Array]) -> tuple[bool, str]:
    """Return whether the growth about the first and last axis is under 5 times the nudge, and about the
    middle one over 50 times; and the text for the brackets.
    """
    low, mid, high = growth(w)
    steady = 5 * NUDGE
    return (
        bool(low < steady and mid > 10 * steady and high < steady),
        f"growth: min {low:.3f}, mid {mid:.3f}, max {high:.3f}",
    )


def skewness(R: Array) -> float:
    """Return the largest |RᵀR − 1| of a motion."""
    return float(orthonormality_error(R).max())


def wander(R: Array, w: Array, I: ArrayLike) -> Array:
    """Return by how much each component of L in space varies, in kg m²/s."""
    return np.asarray(np.ptp(space_momentum(R, w, I), axis=0))


def _momentum(w: Array, I: ArrayLike) -> Array:
    return np.asarray((np.asarray(I, dtype=float) * w.T).T)


COLORS = ("#0072b2", "#b36b00", "#c1272d")  # of ω₁, ω₂, ω₃ and of ê₁, ê₂, ê₃: blue, orange, red
AMBER, GREY = "#c0851a", "0.55"
EXACT: dict[str, Any] = {"ls": (0, (1, 1.5)), "lw": 2.0}  # dotted, in the colour of what it is compared with
UNCOLOURED: dict[str, Any] = {**EXACT, "color": "0.25"}
HALF_BOX = np.array(BOX[1:]) / 2
BOX_AXES = (AMBER, COLORS[0], COLORS[2])  # the figure of the box has ê₁ amber
FLOOR = 1e-17  # below one rounding error; a log axis shows an exact zero here


def draw_moments(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    """Draw the box with its axes, and its moments beside the exact ones."""
    solid, bars = canvas.add_subplot(121, projection="3d"), canvas.add_subplot(122)
    _draw_box(solid, np.eye(3), alpha=0.55)
    for k, color in enumerate(BOX_AXES):
        tip = 1.45 * HALF_BOX.max() * np.eye(3)[k]
        arrow(solid, tip, color=color, lw=2.5, zorder=10)
        solid.text(*(1.12 * tip), f"ê{'₁₂₃'[k]}", color=color)
    cube_axes(solid, 1.0)
    solid.set_title(f"box {BOX[1]:g} × {BOX[2]:g} × {BOX[3]:g} m", fontsize=9)
    place, yours, exact = np.arange(3), np.sort(seen[0]["moments"][0]), truth[0]["moments"][0]
    bars.bar(place - 0.2, yours, 0.4, color=BOX_AXES, label="yours")
    bars.bar(place + 0.2, exact, 0.4, color="0.75", label="exact")
    bars.set_xticks(place, ["I₁", "I₂", "I₃"])
    bars.set_ylabel("kg m²")
    legend_above(bars)


def draw_omega(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    """Draw ω(t), and T and |L|, with the exact ones dotted."""
    run, exact = seen[0], truth[0]
    left, right = canvas.subplots(1, 2)
    _components(left, run, exact)
    observables = (("T / J", kinetic_energy), ("|L| / (kg m²/s)", momentum_norm))
    yours, trues = (
        [observable(motion["w"], BODY) for _, observable in observables] for motion in (run, exact)
    )
    for (name, _), values, true, color in zip(observables, yours, trues, COLORS, strict=False):
        drift = np.abs(values / true[0] - 1).max()
        right.plot(run["t"], values, color=color, label=f"{name}, drift {drift:.2g}")
        right.plot(exact["t"], true, color=color, **EXACT)
    right.set(xlabel="t / s", ylim=(0, None))
    _keep_exact_in_view(right, run["t"], np.array(yours), np.array(trues), 0.0)
    legend_above(right, 1)


def _components(axes: Any, run: Arrays, exact: Arrays) -> None:
    for i in range(3):
        axes.plot(run["t"], run["w"][i], color=COLORS[i], label=f"ω{'₁₂₃'[i]}")
        axes.plot(exact["t"], exact["w"][i], color=COLORS[i], **EXACT)
    axes.plot([], [], **UNCOLOURED, label="exact")
    _keep_exact_in_view(axes, run["t"], run["w"], exact["w"])
    axes.set(xlabel="t / s", ylabel="rad/s")
    legend_above(axes, 5)


def _keep_exact_in_view(axes: Any, t: Any, yours: Any, exact: Any, least: float = np.inf) -> None:
    """Limit the y axis to the exact values and half their range on both sides if the student's, (..., n), go
    farther.

    A line marks the time at which they leave. ``least`` is a value that the axis shows too.
    """
    low, high = min(float(exact.min()), least), float(exact.max())
    room = 0.5 * (high - low)
    inside = ((low - room <= yours) & (yours <= high + room)).reshape(-1, len(t)).all(axis=0)
    if not inside.all() and room > 0:
        axes.set_ylim(low if low == least else low - room, high + room)
        axes.axvline(t[int(inside.argmin())], color=GREY, lw=1, label="yours leaves")


def draw_residual(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    """Draw the distance from the exact motion, and the tolerance."""
    axes = canvas.add_subplot()
    for i in range(3):
        delta = np.abs(seen[0]["w"][i] - truth[0]["w"][i])
        axes.semilogy(
            seen[0]["t"], np.maximum(delta, FLOOR), color=COLORS[i], lw=0.9, label=f"|Δω{'₁₂₃'[i]}|"
        )
    limit = float(as_closely(truth[0]).limit or 0.0) * float(np.linalg.norm(truth[0]["w"][:, 0]))
    axes.axhline(limit, color="k", lw=1, ls="--", label=f"tolerance {limit:.3g}")
    axes.set(xlabel="t / s", ylabel="rad/s")
    legend_above(axes)


def draw_polhodes(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    """Draw the polhodes on the energy ellipsoid."""
    axes = canvas.add_subplot(projection="3d")
    energy = float(kinetic_energy(truth[0]["w"][:, 0], BODY))
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 37), np.linspace(0, np.pi, 19))
    sphere = np.array([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)])
    ellipsoid = sphere * np.sqrt(2 * energy / np.array(BODY))[:, None, None]
    axes.plot_surface(*ellipsoid, color="0.6", alpha=0.15, linewidth=0, rstride=1, cstride=1)
    for number, (run, exact) in enumerate(zip(seen, truth, strict=True)):
        axes.plot(
            *run["w"],
            color=COLORS[number],
            lw=1.8,
            label=f"yours, ω(0) = {np.round(run['w'][:, 0], 2).tolist()}",
        )
        axes.plot(*exact["w"], color=COLORS[number], **EXACT)
    cube_axes(axes, float(np.abs(ellipsoid).max()))
    axes.set(xlabel="ω₁", ylabel="ω₂", zlabel="ω₃")
    _few_ticks(axes)
    legend_above(axes, 1)


def _few_ticks(axes: Any) -> None:
    """Number the axes of a 3-D plot so sparsely that no number lies over another."""
    axes.locator_params(nbins=3)
    axes.tick_params(labelsize=8, pad=0)


def draw_precession(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    """Draw ω(t) of the symmetric top, and the circle of (ω₁, ω₂)."""
    run, exact = seen[0], truth[0]
    left, circle = canvas.subplots(1, 2)
    _components(left, run, exact)
    circle.plot(run["w"][0], run["w"][1], color=COLORS[0], label="yours")
    circle.plot(exact["w"][0], exact["w"][1], **UNCOLOURED, label="exact")
    reach = 1.6 * float(np.abs(exact["w"][:2]).max())
    inside = (np.abs(run["w"][:2]) <= reach).all(axis=0)
    if not inside.all():
        circle.set(xlim=(-reach, reach), ylim=(-reach, reach))
        circle.plot(
            *run["w"][:2, max(int(inside.argmin()) - 1, 0)],
            "x",
            color=COLORS[2],
            ms=9,
            mew=2,
            clip_on=False,
            label="yours leaves",
        )
    circle.set(xlabel="ω₁ / (rad/s)", ylabel="ω₂ / (rad/s)", aspect="equal")
    if np.isfinite(run["w"]).all():
        rate = turning_rate(run["t"], run["w"], exact["w"])
        circle.set_title(f"phase slope {rate:.6g} rad/s\n(I₃−I₁)/I₁·ω₃ = {SYMMETRIC_RATE:g} rad/s")
    legend_above(circle)


def draw_growth(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    """Draw the transverse spin about each axis."""
    axes = canvas.add_subplot()
    for k, (run, exact) in enumerate(zip(seen, truth, strict=True)):
        axes.semilogy(
            SPIN * run["t"], transverse(run["w"], k, SPIN), color=COLORS[k], label=f"spin about ê{'₁₂₃'[k]}"
        )
        axes.semilogy(SPIN * exact["t"], transverse(exact["w"], k, SPIN), color=COLORS[k], **EXACT)
    axes.plot([], [], **UNCOLOURED, label="exact")
    axes.axhline(NUDGE * np.sqrt(2), color="0.7", lw=0.8)
    axes.set_ylim(max(axes.get_ylim()[0], 1e-3 * NUDGE), min(axes.get_ylim()[1], 10.0))
    axes.set(xlabel="turn angle nt / rad", ylabel="transverse |ω| / n")
    legend_above(axes)


def draw_tumble(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    """Draw stills of the box spun about each axis."""
    shares = np.linspace(0.0, 0.7, 6)
    grid = canvas.subplots(
        len(seen), len(shares), subplot_kw={"projection": "3d"}, gridspec_kw={"wspace": 0, "hspace": 0}
    )
    for row, run in enumerate(seen):
        for column, share in enumerate(shares):
            at = int(share * (len(run["t"]) - 1))
            _draw_box(grid[row, column], run["R"][at])
            grid[row, column].set_title(f"ê{'₁₂₃'[row]}, {run['t'][at]:.2f} s", fontsize=8, pad=-2)


def draw_cone(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    """Draw the symmetry axis around L, with L vertical."""
    run, exact = seen[0], truth[0]
    L = space_momentum(exact["R"], exact["w"], SYMMETRIC)[0]
    up = _upright(L / np.linalg.norm(L))
    axes = canvas.add_subplot(projection="3d")
    R = up @ run["R"]
    axes.plot(*R[:, :, 2].T, color=GREY, lw=1.6, label="yours: path of ê₃")
    axes.plot(*(up @ exact["R"])[:, :, 2].T, **UNCOLOURED, label="exact")
    for at in np.linspace(0, len(R) - 1, 7).astype(int):
        arrow(axes, R[at, :, 2], color=COLORS[2], lw=0.8, alpha=0.4)
    for k in range(3):
        arrow(axes, R[0, :, k], color=COLORS[k], lw=2, label=f"ê{'₁₂₃'[k]} at t = 0")
    arrow(axes, (0, 0, 1.3), color="k", lw=2.5, label="direction of L, fixed in space")
    cube_axes(axes, 0.8).set_zlim(-0.3, 1.3)
    _few_ticks(axes)
    legend_above(axes, 2)


def _upright(n: np.ndarray) -> np.ndarray:
    """Return the rotation (3, 3) that takes the unit vector ``n`` (3,), not −ê₃, to ê₃."""
    x, y, z = n
    return np.array(
        [[1 - x * x / (1 + z), -x * y / (1 + z), -x], [-x * y / (1 + z), 1 - y * y / (1 + z), -y], [x, y, z]]
    )


def _draw_box(axes: Any, R: np.ndarray, alpha: float = 1.0) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    faces = Poly3DCollection(
        box_polys(R, HALF_BOX), facecolors=FACE_COLORS, edgecolors="k", linewidths=0.4, alpha=alpha
    )
    axes.add_collection3d(faces)
    cube_axes(axes, 0.85).set_axis_off()
