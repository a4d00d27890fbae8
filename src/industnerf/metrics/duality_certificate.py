"""The certificate of a transport cost: a plan from above, dual potentials from below.

    sum_k flow_k c(a_i, b_j)   >=   W   >=   sum_i u_i + sum_j v_j + min_reduced_cost

for any plan that carries every point's mass, and any potentials that no pair violates by more
than -min_reduced_cost (sums weighted by mass; masses add to 1).
"""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.errors import MetricError
from industnerf.metrics.cells import WeightedCloud
from industnerf.metrics.ground_cost import GroundCost
from industnerf.metrics.transport_plan import TransportPlan

RELATIVE_GAP = 1e-9  # of the value
ABSOLUTE_GAP = 1e-12  # of the unit, or its square: rounding, where the clouds all but coincide


@dataclass(frozen=True)
class MassPlan:
    """What is carried where: `mass` from point `row` of the first cloud to `column` of the other.

    Only pairs that carry something, in the order of rows, then columns; the masses add to 1.
    """

    row: Int64[np.ndarray, "k"]
    column: Int64[np.ndarray, "k"]
    mass: Float64[np.ndarray, "k"]


@dataclass(frozen=True)
class CertifiedEmd:
    """A cost, the plan that has it, and the proof that no plan is cheaper by more than `gap`.

    Lengths are in the clouds' unit, or its square.
    """

    value: float  # mean cost of the plan
    gap: float  # the true minimum is in [value - gap, value]
    plan: MassPlan = field(compare=False, repr=False)
    rounds: int  # of sparse solves; 0: the dense problem was solved
    pairs: int  # given to the solver in the last round

    @property
    def lower_bound(self) -> float:
        """What dual potentials prove: no plan costs less."""
        return self.value - self.gap


def allowed_gap(value: float) -> float:
    """The largest gap between bounds that counts as proof, in the unit of `value`."""
    return max(RELATIVE_GAP * value, ABSOLUTE_GAP)


def transport_cost(
    a: WeightedCloud, b: WeightedCloud, plan: TransportPlan, ground: GroundCost
) -> float:
    """Mean cost of a plan that carries exactly the mass of every point, or MetricError.

    Masses and flows are whole numbers, so that exactly means exactly.
    """
    sent = np.bincount(plan.rows, plan.flow, minlength=len(a.mass))
    received = np.bincount(plan.cols, plan.flow, minlength=len(b.mass))
    if not (np.array_equal(sent, a.mass) and np.array_equal(received, b.mass)):
        off = np.abs(sent - a.mass).sum() + np.abs(received - b.mass).sum()
        raise MetricError(f"POT's plan misplaces {off:g} of a mass of {a.mass.sum():g}")
    costs = ground.rowwise(a.points[plan.rows], b.points[plan.cols])
    return float(plan.flow @ costs / a.mass.sum())


def certify(
    a: WeightedCloud,
    b: WeightedCloud,
    plan: TransportPlan,
    ground: GroundCost,
    min_reduced_cost: float,
    rounds: int,
    pairs: int,
) -> CertifiedEmd:
    """The cost of `plan`; raises MetricError unless its potentials prove it.

    No reduced cost is below `min_reduced_cost`.
    """
    value = transport_cost(a, b, plan, ground)
    bound = float(a.mass @ plan.u + b.mass @ plan.v) / a.mass.sum() + min_reduced_cost
    gap = float(value - max(bound, 0.0))  # no cost is below 0, whatever the potentials
    if not gap <= allowed_gap(value):
        raise MetricError(
            f"EMD of {len(a.mass)} and {len(b.mass)} points is not proven: the plan found costs "
            f"{value:.17g}, their extent being 1, but the potentials only prove {bound:.17g}"
        )
    return CertifiedEmd(value, max(gap, 0.0), _mass_plan(plan), rounds, pairs)


def _mass_plan(plan: TransportPlan) -> MassPlan:
    """The pairs of `plan` that carry mass, in order, a mass of 1 in all."""
    order = np.lexsort((plan.cols, plan.rows))
    order = order[plan.flow[order] > 0]
    return MassPlan(plan.rows[order], plan.cols[order], plan.flow[order] / plan.flow.sum())
