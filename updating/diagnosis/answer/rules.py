"""What a verdict is decided by, as one record: which gap counts, which fit, which rival, which place."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from acquisition.errors import InputError
from updating.thresholds import DOUBTED_FIT, LEAST_PLACE, REJECTED_FIT

SHARES = frozenset(
    {
        "significant_gap", "chance_of_a_fit", "rejected_fit", "doubted_fit", "credible_share", "rival_share",
        "determined_spread", "usual_share", "likely_all_the_same", "second_metric", "separate_places", "least_place",
        "something_else_prior", "concerned_reach", "together_share",
    }
)  # fmt: skip
"""Rules that are probabilities or shares, between 0 and 1."""


@dataclass(frozen=True, kw_only=True)
class DecisionRules:
    """The numbers that a verdict is decided by.

    The search, the noise and the priors do not follow them: what was searched, and each probability, stay. *Judged*
    means chosen by a modeller for structures of this kind, without a measurement behind it. What doubling does follows
    from the formula that the number stands in.

    Parameters
    ----------
    significant_gap : float
        Tolerances and noise explain data that chance alone makes more often than this [-]. One false alarm in 200
        tests. Doubled: one in 100.
    effect_shows_gap : float
        Logarithm of the Bayes factor at which an effect shows a gap that no single test does [-]: odds of 400, which
        beats the prior of one effect among two dozen seventeen to one. Doubled: such gaps count only by their chance.
    chance_of_a_fit : float
        Chance, over all that was tried, that an effect fits noise that much better, below which there is a gap [-].
        Doubled: twice as many false alarms, one in 500.
    places_per_form : float
        Places tried for each form of an effect, roughly: what that chance is multiplied by, beside the form's share
        [-]. Doubled: an effect must fit noise by ln 2 better.
    rejected_fit : float
        A single effect that fits worse than this is no answer [-]. One true cause in 300 is rejected if the noise is
        as stated.
    doubted_fit : float
        Sets of several must fit as well as this [-]: more freedom fits better. A set that fits worse leaves a
        remainder. Doubled: one true pair in 25 is rejected.
    closes_nearly_all : float
        A cause that leaves more than noise is named where it closes so much of what can be closed, on modes held out
        [%]. Doubling what is left out of it, to 80, names a part of the cause as if it were nearly all.
    beyond_nothing : float
        By how much the log evidence of an answer exceeds that of no effect at all [-]: odds of 20.
    something_else_prior : float
        Prior of a cause that is in no library [-]: of the blind trials so many have one. Judged. Doubled: a set must be
        2.4 times as likely to be named.
    something_left : float
        Logarithm of the Bayes factor of such a cause beside the first set from which on more than noise is left [-]:
        odds of 3. Doubled: odds of 9.
    credible_share : float
        Probability that the sets of an answer hold together [-]. The contract's.
    rival_share : float
        A rival that fits as well as the first is kept from this share of its probability on [-]. Below, its prior
        alone, by how wide its parameters range, is odds of 50. Doubled: odds of 25 name an effect among equals.
    determined_spread : float
        Standard deviation of a prior quantile below which the data determine a parameter [-]: a third of the prior's
        own, 0.29. Doubled: a parameter counts as determined that the data halve.
    usual_share : float
        A rival that has hardly any probability is kept only with its sizes in so much of their priors, about the
        middle [-]: the contract's rule. Doubling what is left out drops rivals in the outer two per cent.
    close_fits : float
        Twice the difference of log-likelihood below which two explanations are equivalent [-]: 2 sigma, as the
        contract has it. Doubled: more sets are equivalents, and a class loses sets that only add a cause to another.
    whole_beside_part : float
        A part of the first set that fits by itself stays in the answer unless the log evidence of the whole is above
        its own by this [-]: odds of 400, by which an effect shows a gap, too. Doubled: odds of 160 000, which only
        pairs reach whose causes both show plainly.
    split_sigma : float
        A cause whose size in one half of the data is further from that in the other names nothing [sigma]: by chance
        1 in 400 for each of its parameters. Doubled: only a cause that is wrong by far is found out.
    notable_remainder : float
        R.m.s. residual of a kind of data of a mode, or of a measuring channel, from which on it is reported to carry
        what an explanation leaves [sigma]. Doubled: only the plainest is pointed out.
    second_metric : float
        A second kind of data carries the gap, too, if the logarithm of its probability is this share of the first's
        [-]. Judged. Doubled: it would have to be as improbable as the first.
    closable_gap : float
        A gap within this many times the floor has nothing to close [-]. The contract's. Doubled: a cause that closes
        too little of a gap of two to three floors is not refused for that.
    likely_all_the_same : float
        From this probability on that there is some cause, the summary names it, though chance might make the gap
        [-].
    separate_places : float
        Samples further from each other than this share of the span belong to different places [-]. Doubled: two spots
        a tenth of the length apart are one.
    least_place : float
        A place with less of the weight is not named [-]: the answer's 95 % stand without it.
    concerned_reach : float
        A test point within this share of the span of a place is concerned [-]. Judged: the spacing of a fine grid.
    together_share : float
        Channels whose probabilities differ by less act together, halves of one pair, which differ by what other
        explanations add to either [-]. Doubled: two rival explanations pass for a pair more easily.
    separated_sigma : float
        Explanations so many sigma apart are separated by a test [sigma]: the wrong one is rejected 998 times in 1000.

    Raises
    ------
    InputError
        If one is not finite, not above zero, or a share above 1.
    """

    significant_gap: float = 0.005
    effect_shows_gap: float = 6.0
    chance_of_a_fit: float = 1e-3
    places_per_form: float = 2.0
    rejected_fit: float = REJECTED_FIT
    doubted_fit: float = DOUBTED_FIT
    closes_nearly_all: float = 90.0
    beyond_nothing: float = 3.0
    something_else_prior: float = 0.15
    something_left: float = 1.1
    credible_share: float = 0.95
    rival_share: float = 0.02
    determined_spread: float = 0.1
    usual_share: float = 0.99
    close_fits: float = 4.0
    whole_beside_part: float = 6.0
    split_sigma: float = 3.0
    notable_remainder: float = 3.0
    second_metric: float = 0.5
    closable_gap: float = 1.5
    likely_all_the_same: float = 0.8
    separate_places: float = 0.05
    least_place: float = LEAST_PLACE
    concerned_reach: float = 0.05
    together_share: float = 0.02
    separated_sigma: float = 3.0

    def __post_init__(self) -> None:
        for name in (one.name for one in fields(self)):
            value = getattr(self, name)
            most = 1.0 if name in SHARES else math.inf
            if not (0 < value <= most and math.isfinite(value)):
                limit = "above 0 and at most 1" if name in SHARES else "finite and above 0"
                raise InputError(f"rule {name} = {value:g}: must be {limit}")

    @property
    def changed(self) -> dict[str, float]:
        """The rules that differ from the defaults, by name."""
        values = {one.name: getattr(self, one.name) for one in fields(self)}
        return {one.name: values[one.name] for one in fields(self) if values[one.name] != one.default}


DEFAULT_RULES = DecisionRules()
"""The rules of a diagnosis that states none."""
