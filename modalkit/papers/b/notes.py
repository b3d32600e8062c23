"""Notes below each of paper B's tables."""

GAIN_NOTE = (
    "The sample test is synthetic; its responses are set to 0.74 of the truth, because the paper's updated areas "
    "and inertias all grow by about a third: a common factor on mass and stiffness leaves every frequency alone "
    "and divides the FRFs, so it is what a calibration error of 26 % does. The measured cross-section excludes a "
    "beam that is a third heavier; the column times 0.74 is what is left without that error."
)
EQUATIONS_NOTE = (
    "Errata of the equations, mended in the program: Eqs. 5 and 6 need the conjugate transpose; X^A in Eq. 8 is "
    "X^X, the measured response; Eq. 9 is a residual of displacement, not of force."
)
SECTION_NOTES = (
    GAIN_NOTE,
    EQUATIONS_NOTE,
    "Estimated values are those of a 31.5 x 4.6 mm section (region 1) and a 31.5 x 4.8 mm one (region "
    "2, under the tape); the text states 31 x 4.5 mm.",
    "Of the four parameters the frequencies determine ratios only; their common level comes from the level of the "
    "FRFs. How much heavier and stiffer region 2 is than region 1 was put into the test from this very table; that it "
    "comes out again shows that the chain runs, not that the tape is so.",
)
FREQUENCY_NOTES = (
    "Nominal model: 20 Euler-Bernoulli elements. 'after at the printed A and I' checks Table 2 against Table 3 "
    "without any test; 'after, ours' is our own update by FRFs.",
    "The paper prints the same MAC before and after. Ours is of a synthetic test, whose shapes carry little noise.",
    "A uniform beam of 31.5 x 4.6 mm with one factor of 0.986 on E meets the published frequencies at least as "
    "well as four parameters (0.34 against 0.47 % r.m.s.).",
)
DAMPER_NOTES = (
    "'estimated, ours' starts from beta_2 = 1e-7 s, see the erratum.",
    "The test's damping is that of a loss factor under the tape and of air, with the poles moved to the published "
    "ratios; alpha and beta can follow that only in part, and the level of the FRFs (0.74) does not matter to "
    "them.",
)
DAMPING_NOTES = (
    "The initial column is that of the section already updated (first stage) with the estimated alpha and beta, "
    "and beta_2 = 1e-7 s; on the original section mode 1 would have 0.95 %.",
    "Of the available forms of damping, alpha and beta are not the best: see docs/tutorials/papers.md "
    "for a loss factor.",
    "Damping of the model is identified from the model's own FRFs at the eleven points, as the paper does it.",
    "Erratum: the header of the error columns has (test - model) / test; all twelve printed values have the "
    "opposite sign, (model - test) / test, which is used here.",
)
FRAC_NOTES = (
    "All values are ours; the paper prints bars only: about 0.1 before and after the geometry is updated (Fig. "
    "6), 'good' after the damping is (Fig. 9). Eq. 6 needs the conjugate transpose, as used here; the sum runs "
    "over 5-600 Hz.",
    "The paper's first stage has no damping, and an undamped model has FRAC of 0.1 to 0.3 whatever "
    "its section; the columns without that word have the estimated alpha and beta. FRAC of "
    "receptances is ruled by the first resonance: while the damping is wrong, or the peaks do not "
    "overlap, it is low however alike the shapes are.",
)
