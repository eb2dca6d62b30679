"""Draw the sketch on the page about the model: `python -m docs.scripts.frame`."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, FancyBboxPatch, Wedge
from matplotlib.transforms import Affine2D

from docs.scripts.plots import DOCS, Plot
from flockenv.rendering.palette import OKABE_ITO

OUTER_CM, INNER_CM, RADIUS_CM, HALF_CM = 90.0, 48.5, 5.0, 2.5
AXES, BOAT = OKABE_ITO["blue"], OKABE_ITO["vermilion"]


def frame_and_signs(figure: Figure) -> None:
    """Draw a hull, its local frame and its angles, and the phases of its motor."""
    water, motor = figure.subplots(1, 2, width_ratios=(3, 2))
    _draw_pool(water)
    _draw_motor(motor)


def _draw_pool(axes: Axes) -> None:
    axes.add_patch(
        Wedge((0, 0), OUTER_CM, -5, 95, width=OUTER_CM - INNER_CM, fc="#e8f1f8", ec="0.4")
    )
    theta, alpha, radius = np.radians(38), np.radians(-8), 66.0
    position = radius * np.array([np.cos(theta), np.sin(theta)])
    heading = np.array([np.cos(alpha), np.sin(alpha)])
    outward = position / radius
    clockwise = np.array([outward[1], -outward[0]])
    hull = FancyBboxPatch(
        (-HALF_CM, 0), 2 * HALF_CM, 0, f"round,pad={RADIUS_CM}", fc="#f7d9c4", ec=BOAT
    )
    hull.set_transform(Affine2D().rotate(alpha).translate(*position) + axes.transData)
    axes.add_patch(hull)
    for direction, color, word in (
        (outward, AXES, "outward"),
        (clockwise, AXES, "clockwise"),
        (heading, BOAT, "heading u(α)"),
    ):
        tip = position + 21 * direction
        axes.annotate(
            "", tip, position, arrowprops={"arrowstyle": "-|>", "color": color, "lw": 1.5}
        )
        axes.annotate(word, tip + 2 * direction, color=color, va="center", ha="left")
    axes.plot([0, position[0]], [0, position[1]], color="0.5", lw=1)
    axes.plot([0, 40], [0, 0], color="0.5", lw=1)
    axes.add_patch(Arc((0, 0), 50, 50, theta1=0, theta2=np.degrees(theta), color="0.3"))
    axes.annotate("θ", (27, 8))
    axes.add_patch(
        Arc(
            position, 24, 24, theta1=np.degrees(alpha), theta2=np.degrees(theta), color=BOAT, lw=1.5
        )
    )
    axes.annotate("φ", position + np.array([13.5, 3.0]), color=BOAT)
    axes.add_patch(Circle((0, 0), 1, color="0.3"))
    axes.set(xlim=(-4, 118), ylim=(-4, 94), aspect="equal")
    axes.set_axis_off()


def _draw_motor(axes: Axes) -> None:
    ends = np.cumsum([0.0, 2.0, 1.0, 0.6, 1.0])
    speeds = [15.0, 0.0, -15.0, 0.0]
    axes.stairs(speeds, ends, color=BOAT, lw=2, baseline=None)
    for word, left, right in zip(("fw", "nop", "bw", "nop"), ends, ends[1:], strict=False):
        axes.annotate(word, ((left + right) / 2, 17.5), ha="center")
    axes.set(
        xlabel="time [s]", ylabel="preferred speed v0 [cm/s]", yticks=(-15, 0, 15), ylim=(-18, 21)
    )


if __name__ == "__main__":
    Plot([], frame_and_signs, (7.2, 3.6)).save(DOCS / "frame.png")
