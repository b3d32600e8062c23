"""Numbers of the noise and of the search of a diagnosis: what each limits, where it comes from, what doubling it does.

What a verdict is decided by is in :mod:`updating.diagnosis.answer.rules`; a number of one algorithm stands beside it.
Where the effect of doubling is stated, it follows from the formula that the number stands in. *Judged* means chosen by
a modeller for structures of this kind, with no measurement behind it: these are the first to be replaced once one is
there.
"""

# --------------------------------------------------------------------------------- the noise of frequencies

LEAST_FREQUENCY_NOISE = 1e-6
"""No frequency is known better than this, relative [-]. From the digits of files that hold frequencies alone.
Doubled: nothing, where a repeatability is stated."""

STATED_MASS_DOUBT = 0.02
"""By how much a body weighs more or less than stated, relative (1 sigma) [-]. Judged: a data sheet's rounding, wax and
the cable's end. Doubled: a change of a sensor's mass must be twice as large to be seen."""

CARRIED_DOUBT = 1.0
"""Standard deviation of the mass that a support carries along, over what is estimated [-]: nothing or twice as much.
Of a foot of quadratic bricks, whose corners have negative shares, it is -0.15 of the estimate."""

IMPORTED_MESH_DOUBT = 0.005
"""How far an imported mesh of bricks leaves each frequency off beside the others, relative, at the most (1 sigma) [-]:
it cannot be refined here. Twelve quadratic bricks along a plate with ribs, or an angle bolted to one, are 0.1 to 0.5 %
from sixteen. Doubled: one mode of a fine mesh must change by a tenth of a per cent to be seen, not by half of that."""

REGION_MESH_DOUBT = 0.02
"""How far an imported mesh of bricks leaves the stiffness of each region off, relative (1 sigma) [-]: few of them
through a bend lock. In twelve specimens sixteen quadratic bricks along for twelve change regions by 1.4 % (angles) and
0.8 % (ribbed plates) r.m.s., by 3.4 % at most; 0.13 % of a frequency is left at most, of 0.5 %. Doubled: a region has
to soften by 8, not by 4 %, to be seen without a baseline."""

UNREACHED_MODE_DOUBT = 0.01
"""Doubt in the frequency of a mode the baseline did not reach, beside the unevenness of the others, relative [-].
Judged: what tolerances of one per cent leave. Doubled: such a mode counts a quarter as much."""

# ---------------------------------------------------------------------------------------- the noise of damping

DAMPING_REPEATABILITY = 0.1
"""Scatter of damping from one mounting of a specimen to the next, relative [-]. Judged, from tests that were taken
down and put up again. Doubled: a gap in damping beside a baseline must be twice as large to be seen."""

COMMON_DAMPING = 0.5
"""Variance of the doubt in the expected damping that all modes have in common, of that which each has for itself [-].
The tolerance is that of each mode; whether all are off alike besides nobody states, so half as much. Doubled, as much:
damping that is off alike shows by three quarters of the sigmas. A share of one variance rejects what is true where
modes scatter each for itself: with five modes and half of it one cause in nine."""

DAMPING_PER_SHIFT = 0.5
"""How much of a change of frequency (1 sigma of its logarithm) damping may follow otherwise than expected [-]. Ratios
of viscous dampers fall as 1/f, those of a stiffness-proportional one rise as f; half of that either way. Doubled: a
change of frequency by 10 % leaves damping 10 % in doubt."""

UNSTATED_DAMPING_NOISE = 0.05
"""Relative standard deviation of a damping ratio of which none is stated [-]. Judged: a usual one of an
identification. Doubled: only where the tolerance on damping is as small does it matter."""

LEAST_DAMPING = 1e-7
"""No damping ratio is predicted lower: its logarithm is taken [-]. A thousand times below what any metal has."""

# -------------------------------------------------------------------------------- the noise of modal constants

UNPAIRED_SPREAD = 1.0
"""How far a measured mode that the model lacks may lie from its others, in ln f and ln zeta, and how much of each shape
beside it may be in its own, relative to its r.m.s.: 1 sigma [-]. Judged: a band is some e-folds wide. Doubled: what
makes such a mode is more probable by a factor of 16."""

UNPAIRED_NEIGHBOURS = 3
"""So many of the model's modes, those next to it in frequency, mix in the shape of a measured mode that the model lacks
[-]: the one that it is a twin of, and one to either side. Doubled: fewer shapes support what makes such a mode."""

UNPAIRED_SHAPE_NOISE = 0.05
"""Error of the shape of a measured mode that the model lacks beyond its noise, relative to its r.m.s. [-]: points are
hit beside their places, and whatever makes it is more complicated. Doubled: its shape has a quarter of the weight."""

MOST_TOGETHER = 6
"""Nuisances of one group: a hit and a sensor in three directions each. Twice as many cost more small matrices and are
never wrong; groups beyond it are taken as common to all."""

FEW_NUISANCES = 64
"""So many nuisances are taken as common to all: small matrices cost less than finding groups. Twice as many are four
times slower at worst, half as many slow a beam of a dozen points down by a half; the answer is the same."""

LEAST_CONSTANT_NOISE = 0.005
"""Error of a modal constant that no coherence shows (cross-talk, direction), relative to the mode's r.m.s. [-].
Judged from transducers' data sheets: a cross sensitivity of some per cent, of motion across that is a tenth. It is the
most that a single constant may be off, see ``UNSEEN_SHARES``. Doubled: good shapes count a quarter as much."""

UNSEEN_SHARES = (1.0, 0.3, 0.1, 0.03)
"""Sizes of that error of a constant, as shares, each as likely [-]: where motion is all along the transducers there is
next to none of it, and shapes are many data, which show it. Doubled: the largest, and shapes decide less where
structures do move across."""

BEYOND_PLATE = 0.2
"""Share of what a plate's shapes have beyond a beam's that bricks may have beyond the plate, 1 sigma [-]: near ends and
under bodies (CalculiX). Doubled: high modes of wide beams tell less."""

LEAST_TURN = 0.005
"""Shapes of close modes are held to turn into each other where their frequencies' scatter makes it so much [rad]: less
is within ``LEAST_CONSTANT_NOISE``. Doubled: pairs twice as close are left as sharp as they are."""

DELAY_FIT_ERROR = 0.01
"""Error of a modal constant, relative to the mode's r.m.s., per radian by which a delay turns it [1/rad]: no rational
function is a delay. Doubled: a delay explains constants that it spoils twice as much."""

FREE_LEVEL_DOUBT = 3.0
"""Doubt in the level of a mode of which the shape alone is known (1 sigma, relative) [-]: no level is believed."""

SHAPE_NOISE_SCALES = (1.0, 2.0, 4.0, 8.0, 16.0)
"""How many times worse than thought the shapes may be [-]: powers of two up to what hides any shape. Not below 1:
beside a baseline that the model misses, much of that noise is what this leaves of the shapes, which is alike from point
to point, and a second cause that takes it up would be paid for each of them."""

REPEATED_SCATTER_PRIOR = (0.85, 0.12, 0.025, 0.004, 0.001)
"""Prior of each of these where repeated hits show the scatter [-]. Judged: some one in seven stated scatters is too
small by two or more. The p-value of a fit is never above the tail of this prior at the scale that it needs."""

SINGLE_SCATTER_PRIOR = (0.3, 0.25, 0.2, 0.15, 0.1)
"""The same where nothing shows the scatter [-]: nearly any is as likely."""

DOUBT_SHARES = (1.0, 0.3, 0.1)
"""Sizes of a doubt of which the most is judged, as shares of that, each as likely [-]: of an effect's idealisation,
whose ``fidelity`` is what it may be off where the structure is none of those it was made for; of the scatter of damping
from mounting to mounting; of phases; of a frequency's dependence on the level. Roots of ten, so that no size between
is far from one; not below a tenth, since a few data that a cause fits by chance would count for more than they show.
Doubled: the largest, and an effect may leave twice as much."""

END_REACH = 0.01
"""Points this near to an end, relative to the length, sit at it [-]: there is nothing to hit beyond. Doubled: nothing
on usual grids, whose points are further apart."""

REGISTRATION_SHARE = 0.5
"""Share of the doubt in the length by which all points may be shifted together where no single clamp states from which
end they were measured [-]. From one end it would be nought, from the other the whole; half is from the middle."""

# ------------------------------------------------------------------------------------------ the noise of phases

PHASE_DOUBT = 0.03
"""How far damping that is not proportional, and filters, turn a mode's constants (1 sigma) [rad]. From paired
filters, matched to a degree or two. Doubled: a delay must be twice as long to be seen."""

PHASE_UNEVENNESS = 0.3
"""How much of that differs from chain to chain [-]. Judged. Doubled: several chains give little more information than
one.
"""

COMPLEXITY_PER_DAMPING = 2.5
"""Imaginary part of a mode over its damping ratio times its size, where damping is not proportional [-]. Judged; it
grows with how close modes are. Doubled: heavily damped modes determine a delay a quarter as well."""

LARGEST_NODE_RATIO = 30.0
"""No sensor is taken to sit nearer to a node than where a mode moves this much less than elsewhere [-]: rounding of
its place decides beyond that. Doubled: the phase of such a mode counts for even less."""

# ---------------------------------------------------------------------------- the dependence on the hits' level

DRIFT_SHARE = 0.1
"""Drift of frequencies within a test, as a share of the scatter of re-mounting [-]. Judged: what re-mounts is the
clamp, what drifts the temperature. Doubled: in a test that scatters a joint must be twice as nonlinear to be seen."""

LEAST_DRIFT = 3e-5
"""That drift is at least this, relative [-]: of steel in a quarter of a kelvin. Doubled: as above, in a good test."""

# ------------------------------------------------------------------------------- the course of a test over time

UNREMARKABLE_TREND = 3e-4
"""Change of all frequencies from the first point of a test to the last that no test is free of, relative (1 sigma) [-]:
two kelvin in a laboratory, of steel or aluminium, whose moduli fall by 2.5e-4 to 5e-4 per kelvin and frequencies by
half of that. Doubled: a drift must be twice as large to be named."""

TREND_SHARE = 1.0
"""That change over the scatter of re-mounting, beside the above [-]. Judged: two ends of a test differ by root 2 times
what one state scatters, and half of its variance is of the mount, which stays. Doubled: as above, where it is large."""

BENT_COURSE = 0.15
"""How far a drift from first to last point may be from that of the line through all points, relative to it (1 sigma)
[-]: what warms up by two to five time constants during a test does 6 to 26 % more. Doubled: rates are half as sure."""

# ------------------------------------------------------------------------------------------ priors, and what fits

REJECTED_FIT = 0.003
"""For the search, and the default of the rule ``rejected_fit`` [-]."""

HOPELESS_FIT = 1e-12
"""What fits worse than this is not integrated by predictions [-]: it is rejected, wherever its samples lie."""

DOUBTED_FIT = 0.02
"""For the search, and the default of the rule ``doubted_fit`` [-]."""

WELL_FITTED = 0.1
"""Where no single effect fits better than this the most promising pairs are compared with them, whatever they promise
[-]: a linear step from a single that explains most, but not all, errs by more than the evidence differs. Doubled:
one test in five that needs no pair takes the longer search, some 5 s on a beam."""

ODD_DATA_BELOW = 0.2
"""What fits better than this has no odd data to be sought [-]: above the p-value of a fit for which shapes that hits
repeat have to be twice as noisy, as one mode that is no mode makes all of them. Doubled: twice the time it takes."""

PROBABLE_BEHIND = 6.0
"""Explanations whose logarithm of the probability lies further behind the best do not count in whether one fits [-]:
they hold less than 0.3 % of its probability."""

COUNT_PRIOR = (0.3, 0.5, 0.15, 0.04, 0.01)
"""Prior of so many causes at once, none first, each spread evenly over the sets of that number [-]. Judged: what is
tested beside its model mostly has one cause that stands out. Doubled for two: pairs gain ln 2 in all odds."""

OUTLIER_PRIOR = 0.005
"""Prior of each group of data (a kind of data of a mode, a measuring channel, a tolerance) to be worse than stated [-].
Judged: of some forty groups that is one test in five with one. Doubled: a datum is odd from 3.9, not 4.1 sigma."""

OUTLIER_SCALES = (3.0, 10.0, 30.0, 100.0)
"""How many times worse such a group may be [-], each as likely: from a stated sigma that is too small to a frequency
that belongs to another body. Doubled: an oddity of 4 sigma stays an argument."""

MOST_OUTLIERS = 3
"""So many groups at most are taken to be odd at once: with more of them a test is not informative."""

MOST_ALONE = 1
"""So many where there is no cause beside them, shapes only: one odd shape is a slip, two or a frequency are a gap."""

SUSPECTS_TRIED = 3
"""How many groups, those that the rest predicts worst, are tried for each. Doubled: twice the time of this step."""

QUANTILE_SPREAD = 0.3
"""Standard deviation of a parameter's prior quantile, even between nought and one [-]."""

SET_MARGIN = 2.0
"""A set is compared where a score test estimates that its logarithm of the probability comes this near to the best,
or above [-]: the test errs by one or two. Doubled: some three times as many sets are compared where one cause fits."""

LEAST_PLACE = 0.05
"""For the search, and the default of the rule ``least_place`` [-]."""

FORM_SHARE = 0.02
"""Forms of an effect with less than this share of the most probable one are no evidence for its fit [-]: they are
another point, or another sign, that would not be named."""

HELD_NEAR_END = 0.25
"""A parameter is held at the end of its prior range where it is within this share of it [-]..."""

HELD_SHARE = 0.95
"""...with so much of its posterior [-]: then the data ask for a size beyond what is plausible."""

NEGLIGIBLE_PROBABILITY = 1e-4
"""Explanations less probable are not asked where their parameters lie, get rougher intervals, and do not count in the
regions [-]. The contract lets their rows be left out. Doubled: nothing that is printed with two digits."""

# --------------------------------------------------------------------------------- how the search is carried out

DOUBT_BEYOND_NOISE = 3.0
"""Where the idealisation of the best single effect leaves a frequency in doubt by so many times its noise [-], pairs
are sought beside it though it fits: nine tenths of the variance are its own. Doubled: six sigma may hide in it."""

WITHIN_REACH = 7.0
"""Drafts whose logarithm of the probability lies further behind the best are not evaluated more closely [-]: a draft's
evidence errs by one or two. Doubled: twice the predictions for the same answer."""

FINISHING_ROUNDS = 3
"""How often what is within reach is sought: finishing one moves the bar for the others."""

PAIRS_WEIGHED = 10
"""How many pairs are compared, those that a score test finds the most promising. Doubled: twice the time of pairs."""

PAIRS_ANEW = 3
"""How many of these, the best, are evaluated from all starts of either effect. Doubled: pairs take 1.5 times longer."""

FORMS_TRIED = 6
"""Of how many forms of a pair of effects on imported matrices, the best by either score test, a short maximisation
chooses [-]: the true one was among the first three where two regions of six were changed. Doubled: 1.5 times longer."""

SHIFT_SPREAD = 3.0
"""How many times the shift of a starting place may be asked for, 1 sigma [-]: an effect from slight to severe."""

STEP_INSIDE = (0.02, 0.98)
"""Prior quantiles to which the first step from a pair of starting places is kept [-]: at the very end of their range
some effects stand still. Doubled: a start a little further from the end."""

PLACES_TOGETHER = 3
"""How many pairs of starting places, those that explain the most together, a pair of causes is searched from. Doubled:
a third more time for these pairs."""

LARGER_SETS = 6
"""How many sets of three causes, and of four, are searched where those of fewer do not explain the data: those that
score tests find the most promising. Doubled: twice the time of these."""

SETS_ENLARGED = 3
"""Beside how many of the best sets a further cause is sought. Doubled: twice the score tests; the one more cause is
found where the best set of fewer was none of its parts."""

MISSED_MAXIMUM = 1.0
"""By how much a part of the best set has to fit better from its place in that than it did before, for the search to
have missed its maximum, in log-likelihood [-]. Doubled: misses of a little go unmended."""

SAME_PEAK = 0.02
"""Peaks nearer to each other than this in every prior quantile are one [-]: narrower than samples are drawn."""

PEAK_BEHIND = 12.0
"""Peaks whose log-likelihood lies further behind the highest are left out [-]: they hold less than 1e-5 of it."""

RIDGE_FLAT = 30.0
"""Information along the flattest direction of a maximum below which it may be a ridge, in prior quantiles [-]: a
standard deviation of a fifth of the range. Doubled: ridges half as long as the range are followed, too."""

RIDGE_STEEP = 1000.0
"""Information along the steepest direction above which it is one [-]: a ridge narrower than a thirtieth of the range,
which a parabola along its tangent leaves as soon as it bends. Doubled: wider ones are left to the tangent."""

RIDGE_STEP = 0.2
"""How far apart places of a ridge are, in prior quantiles [-]. Doubled: a ridge that bends is lost sooner."""

RIDGE_STEPS = 4
"""How many places are taken either way: with the step, four fifths of the range. Doubled: twice the evaluations."""

STARTS_TRIED = 12
"""From how many of the starting places at most a maximisation is started..."""

STEPS_TRIED = 4
"""...for how many steps, before the best of them go on..."""

CLIMBS = 3
"""...and how many of these maximisations are completed. Doubled: maxima are missed less often, at twice the time."""

LEAST_ON_LINE = 0.05
"""Least share of each parameter in the direction of a line of starting places, for the search to begin at that line's
maxima alone [-]: with less the line does not determine the parameter. Doubled: fewer rows of starts count as a line."""

PRIOR_SHARE = 0.25
"""Share of the samples drawn from the prior itself [-]: no weight is more than four times the likelihood. Doubled: a
narrow peak gets two thirds as many samples."""

SAMPLE_FREEDOM = 5
"""Degrees of freedom of the t-distributions that samples are drawn from: heavy tails, a finite variance."""

MOST_SAMPLES = 1024
"""Most samples drawn in all. Doubled: evidence errs by 0.7 of what it did, in twice the time."""

DRAFT_SAMPLES = 512
"""Samples drawn for a draft, which cost no predictions."""

ENOUGH_SAMPLES = 100.0
"""Effective number of samples that is enough: evidence is off by a tenth, ends of intervals by a quarter of a standard
deviation."""

DIFFERENCE_STEP = 1e-3
"""Step of differences for sensitivities, in prior quantiles [-]: between round-off and curvature."""

UNDERSTEPPED = 1.3
"""A step that gains so many times what the parabola promised was too short [-]: far from the data the likelihood's
tails are heavier than its curvature implies."""

FRESH_PARAMETERS = 2
"""With so few parameters sensitivities are taken anew after every step: they cost no more than the step."""

PATIENT_STEPS = 6
"""After so many steps a maximisation is checked for progress:"""

LITTLE_GAIN = 0.002
"""...a gain below this share of the distance to the best found ends a maximisation [-]: it needs hundreds."""

HOPELESS_BEHIND = 40.0
"""How far below the best found elsewhere, in log-likelihood, a maximum need not be known any better [-]."""

AT_REST = 0.01
"""A maximisation is at rest when a step gains less than this, in log-likelihood [-]: a tenth of the evidence error."""

RELINEARISATIONS = 3
"""How often at most wide tolerances are linearised anew; what comes nearest to its own linearisation stands."""

STRAINED_LINEARISATION = 0.01
"""Relative change of a tolerance's property that a linearisation bears [-]: its square is below the noise."""

FARTHEST_TOLERANCE = 6.0
"""Tolerances are followed so far from nominal [standard deviations]: more is not plausible."""

LARGEST_SENSITIVITY = 1e6
"""A state whose nuisances move the data by more, per standard deviation, is none [-]: an eigenvalue near zero."""

# ------------------------------------------------------------------------------- how far a gap closes, held out

BELIEVED_DOUBT = 3.0
"""No tolerance, and no calibration, is taken to be further off than this where nothing else is fitted [standard
deviations]. Doubled: an absurd modulus closes gaps that are no tolerance."""

REFIT_STEPS = 6
"""Most steps of a refit, data left out, from the best parameters on all data."""

SHORT_STEP = 0.02
"""Longest step, in prior quantiles, that a refit takes on the sensitivities at the best parameters [-]."""

UNSEEN_CURVATURE = 4.0
"""Curvature that keeps parameters the data do not see, per squared prior quantile [-]: a sigma of half the range."""

HELD_OUT_FOLDS = 5
"""In so many parts the points are left out. Doubled: smaller parts, nearer neighbours, a gap that seems to close."""
