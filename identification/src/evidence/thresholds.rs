//! Every limit of the evidence: its value, why it has that value, and who asks it.
//!
//! A limit answers one of four questions. Is it *relevant*: how much of the unexplained does
//! it remove? Does it *matter*: how large is it beside the effort, or in counts of an encoder? Is
//! it *certain*: could chance have done it? And of what cannot be told: when is it
//! *unexplained* and not just noise?
//!
//! Where a measurement stands behind a limit, it is told. The others are *chosen*: set on simulated
//! records, EMPS and `bldc_cogging`, with both wrong names and misses in view. What they give is
//! the table of docs/identification.md; on other real axes they have not been seen.

// ---- Effort of moving samples: `effort`; relevance also in `slow_ripple` ----

/// Smallest share of the held-out error that an effect of the effort removes.
///
/// It is the limit that separates: on 14 simulated records with nothing missing the largest false
/// share was 0.016, while t alone reached 14 there, because gains sit in few blocks.
pub(crate) const EFFORT_SHARE: f64 = 0.05;

/// Smallest size of an effect, percent of the effort. Chosen: less does not
/// matter to an axis.
pub(crate) const EFFORT_PERCENT: f64 = 0.15;

/// Shares of the held-out error, and the smallest t over blocks from each of them on.
///
/// The t of an effect that shows in few blocks (slow motion) is small however large it is there, so
/// a large share asks for less.
pub(crate) const EFFORT_T: [(f64, f64); 4] =
    [(0.30, 1.0), (0.12, 1.5), (0.08, 2.5), (EFFORT_SHARE, 3.0)];

/// From this t on the interval of what was fitted is not asked whether it excludes zero: that many
/// standard errors over blocks say the same (1.96 would be its 95 %).
pub(crate) const CERTAIN_T: f64 = 2.5;

/// Smallest share of a structure without a name: the share that counts as unexplained, since that
/// is what it leads to.
pub(crate) const NAMELESS_SHARE: f64 = UNEXPLAINED_SHARE;

/// Smallest share and size (percent of the effort) of a nearest outsider: twice those of a listed
/// effect. It has what the list leaves, and a listed effect of a slightly other shape leaves some.
pub(crate) const OUTSIDER: (f64, f64) = (2.0 * EFFORT_SHARE, 2.0 * EFFORT_PERCENT);

/// Smallest share that something removes which comes and goes and shows at both times together
/// alone: two times are chosen among a thousand pairs. Chosen: the largest share of [`EFFORT_T`].
pub(crate) const BOTH_SHARE: f64 = 0.30;

/// What comes and what goes differ by at most this share of the larger one. Chosen: a part of the
/// load may stay.
pub(crate) const BOTH_ALIKE: f64 = 0.3;

/// It stays for at least this share of the record. Chosen: a shorter stay has too few blocks.
pub(crate) const BOTH_APART: f64 = 0.1;

/// Largest error on another record with an effect over that without it. Chosen: what holds on one
/// record only is no effect of the axis, but a little more error is no proof of that. A bristle
/// that is one leaves at most a quarter there.
pub(crate) const VETO_RATIO: f64 = 1.05;

/// Smallest part of what an effect should remove from another record, by its size on the first one,
/// that it must remove there: less is a third of its size, and other days do not change that much.
pub(crate) const VETO_PART: f64 = 0.1;

/// A coefficient of another record that differs by less than this is not told. Chosen: friction
/// changes by as much while a record is taken.
pub(crate) const OTHER_DAY_SHARE: f64 = 0.05;

/// Smallest share and t with which the load's own inertia comes in beside a gap or a compliance
/// that a load scale shows. The load is known to move otherwise: chance is not the question.
pub(crate) const LOAD_INERTIA: (f64, f64) = (EFFORT_SHARE, 1.0);

/// Most effects that one output is asked for: an end to the search. No record of ours has more than
/// two that are hidden.
pub(crate) const MOST_EFFECTS: usize = 8;

// ---- Residual of moving samples: `verdict`, `residual` ----

/// A residual with a smaller share of structure counts as white: what the smallest accepted effect
/// removes.
pub(crate) const WHITE_SHARE: f64 = EFFORT_SHARE;

/// A larger share of structure is unexplained, if it also matters to the axis. Chosen: three times
/// what an accepted effect needs.
pub(crate) const UNEXPLAINED_SHARE: f64 = 0.15;

/// And from this t on: a name asks for more, but `explained` is a claim too, and a structure that
/// sits in few blocks may be what the axis does there.
pub(crate) const UNEXPLAINED_T: f64 = 1.0;

/// Structure below this much of the effort of motion does not matter to the axis, percent: twice
/// the smallest effect that is named. What a cubic drag leaves of a quadratic one on a seeded
/// record is
/// 0.4 %, and has to count.
pub(crate) const UNEXPLAINED_PERCENT: f64 = 0.3;

/// Structure of the kind of an effect that the model has does not count below this part of that
/// effect's own size: the axis has another shape of it. Axes of unlike make left up to a seventh
/// of their effects so (exponential Stribeck falls, worn ways) before those had forms of their own;
/// a cubic drag leaves a fifth of a quadratic one, and has to count.
pub(crate) const SHAPE_PART: f64 = 1.0 / 6.0;

/// From this size on, percent of the effort of motion, a structure counts even where it is gone at
/// the lower cut-off: a controller gives back less of an encoder's rounding and a drive's noise.
/// Chosen; records of `commission` have 0.4 %, an eccentric encoder 6 %.
pub(crate) const FED_BACK_PERCENT: f64 = 2.0;

/// The frequencies of mains, Hz.
pub(crate) const MAINS_HZ: [f64; 2] = [50.0, 60.0];

/// Mains are so near to their frequency, Hz: a synchronous grid keeps it within 0.2 (EN 50160,
/// clause 4.2.1, allows 0.5 for 99.5 % of a year).
pub(crate) const MAINS_OFF_HZ: f64 = 0.2;

/// More mains than this are no pick-up, percent of the effort: as much as counts where a controller
/// gives it back.
pub(crate) const MAINS_PERCENT: f64 = FED_BACK_PERCENT;

/// A shift in time below this is told and does not count, s: a sixth of the period at which drives
/// usually record, the part of it by which a measured effort and a position may stand apart in it.
pub(crate) const SHIFT_S: f64 = 0.15e-3;

/// More than this of the effort of motion is not left by an explained axis, percent, unless it is
/// noise. Real axes leave 1 to 6 % with their friction known.
pub(crate) const LEFT_PERCENT: f64 = 12.0;

/// Noise and quantisation leave a residual that is as slow as the low-pass makes white noise;
/// motion is slower by more than this factor.
pub(crate) const NOISE_SLOWNESS: f64 = 2.0;

/// What is faster than the low-pass is a wave where two samples leave at most this part of the next
/// one's square: encoders' rounding leaves 0.7 and more, resonances after impacts up to 0.07, loops
/// that oscillate 0.002 and less.
pub(crate) const WAVE_LEFT: f64 = 0.05;

/// Such a wave drives an axis from this part of the acceleration of all slower motion on. Chosen:
/// loops that oscillate have 1.06 and more, springy flanks of 100 µm that ring up to 0.85.
pub(crate) const OSCILLATION: f64 = 1.0;

/// A half second rings by itself where two samples leave at most this part of the next one's
/// square: loops at the edge of their stability leave 0.0005 and less, impacts at their largest
/// 0.01 and more.
pub(crate) const STRETCH_LEFT: f64 = 0.005;

/// Such a half second is told from this multiple of the acceleration of the record's slower motion
/// on. Chosen: the two loops that spoil their records have 5.7, the next of the same machine, whose
/// sizes come out right, 1.9.
pub(crate) const STRETCH_OSCILLATION: f64 = 3.0;

// ---- Motor − load: `difference` and its rooms ----

/// Smallest share of the held-out variance that an effect between motor and load removes.
/// Chosen: twice that of the effort, because two encoders are quieter than an effort.
pub(crate) const DIFFERENCE_SHARE: f64 = 0.10;

/// Smallest share of what was there before any effect. Chosen: once a large effect is out, ten
/// percent of the rest may be nothing.
pub(crate) const DIFFERENCE_SHARE_OF_ALL: f64 = 0.01;

/// Smallest t over blocks, about the 95 % of a normal distribution.
pub(crate) const DIFFERENCE_T: f64 = 2.0;

/// Smallest share of the held-out variance of the effort that friction of the motor's own side
/// removes beside a spring. With a fifth of 400 N there it is 6 %, with two fifths 15 to 80; where
/// there is none, a thousandth.
pub(crate) const MOTOR_SIDE_SHARE: f64 = 0.02;

/// Where the force shows a gap, a large share of the effort asks for less: as [`EFFORT_T`] does.
/// Machines without a gap had shares of a thousandth, those with 2 µm 0.39 and more.
pub(crate) const FORCE_LARGE: (f64, f64) = EFFORT_T[0];

/// Smallest rms that an effect removes, in counts of the coarser encoder: every screw has some
/// stiffness.
pub(crate) const DIFFERENCE_RMS_COUNTS: f64 = 1.0;

/// A gap is as wide as it is: the factor that a fit would give its lag must be near one. Chosen.
pub(crate) const GAP_FACTOR: std::ops::RangeInclusive<f64> = 0.8..=1.2;

/// What impacts between rigid flanks leave of motor − load, rms, as a share of the gap: 0.01 to
/// 0.07 on simulated records. A loop that bounces on springy flanks, taken for rigid ones, leaves
/// 0.12 and more.
pub(crate) const IMPACTS: f64 = 0.1;

/// The stiffness by the load's motion is taken where it is that of the effort within this share.
/// Chosen: noise of the effort makes its own up to 3 % wrong, and a loop that bounces 17.
pub(crate) const STIFFNESS_AGREES: f64 = 0.1;

/// Structure of motor − load that no effect explains counts beyond so many counts of the coarser
/// encoder, rms: rounding alone is 0.3 counts, and two encoders with errors of their own within a
/// count make no more than one.
pub(crate) const APART_COUNTS: f64 = 3.0;

/// And from this share of what is left on: as for the effort, three times what an accepted effect
/// needs.
pub(crate) const APART_SHARE: f64 = UNEXPLAINED_SHARE;

/// More than this of motor − load, rms, is not left by what explains it, unless it is noise: as
/// much as of the effort ([`LEFT_PERCENT`]).
pub(crate) const APART_LEFT: f64 = 0.01 * LEFT_PERCENT;

/// Noise has an autocorrelation as short as the low-pass makes it; that of what slips, warms or
/// oscillates has more than so many times its square. Records with noisy encoders had up to 2.3,
/// the steps of a coarse one 3.7, a loop that oscillates 30.
pub(crate) const NOISE_COLOUR: f64 = 4.0;

// ---- Reversals: `reversal`, `free_run`, `at_reversals`, and the amplitudes of `difference` ----

/// Smallest deflection, gap or amplitude of a position, in counts of the encoder that shows it: one
/// count is what rounding makes of nothing.
pub(crate) const FEWEST_COUNTS: f64 = 2.0;

/// Fewest samples about reversals: five reversals at 1 kHz with their margins of 20 ms.
pub(crate) const FEWEST_REVERSAL_ROWS: usize = 200;

/// Rms of Dahl over that of rigid friction about reversals, at most, for a bristle. On 128
/// simulated records: 0.05 to 0.34 with presliding, 0.88 and more with a gap, 2 and more with
/// neither.
pub(crate) const BRISTLE_RATIO: f64 = 0.7;

/// Rms of Maxwell slip over that of Dahl about reversals, at most, for it to stand there. Chosen:
/// on made records whose elements slip one after the other it leaves 0.03 to 0.6, on bristles of
/// Dahl's or `LuGre`'s law one and more.
pub(crate) const SLIP_RATIO: f64 = 0.8;

/// The same, at most, for a record not to say which of the two laws it is, so that a deflection is
/// no nearer known than they agree. Chosen: where noise is most of what is left, elements leave
/// 0.97 to 1.02 of makes of any law; where it is not, 1.7 and more of Dahl's or `LuGre`'s on one of
/// the two records.
pub(crate) const AS_MUCH_RATIO: f64 = 1.05;

/// Above this ratio nothing is suspected at reversals: simulated records with a gap begin at 0.88.
pub(crate) const SUSPICION_RATIO: f64 = 0.85;

/// Smallest t over reversals of a bristle: there are few in a record, so it is small even where the
/// ratio is 0.07.
pub(crate) const BRISTLE_T: f64 = 1.2;

/// Below this ratio of the inverse model (Dahl over rigid) a bristle wins a tie of the free run.
/// Noise that really acts raises what every shape leaves there; the inverse model averages it out.
/// Below it a gap that a followed simulation sees is none: gaps have 0.6 and more, bristles of
/// other laws (Maxwell slip, Bouc–Wen) 0.02 to 0.08.
pub(crate) const BRISTLE_TIE_RATIO: f64 = 0.5;

/// Above this ratio a gap wins it. Of 128 simulated records those with a gap had 0.88 and more.
pub(crate) const GAP_TIE_RATIO: f64 = 0.8;

/// A shape of the free run leaves at most this share of the rms without it. At equal bursts the
/// wrong shape leaves five to fifty times the error of the right one.
pub(crate) const SHAPE_RATIO: f64 = 0.6;

/// And at most this share of what its rival leaves. Chosen.
pub(crate) const RIVAL_RATIO: f64 = 0.75;

/// A gap is looked for where rigid friction leaves more than so many times the rounding of the
/// encoder, or a bristle helps: the search is the longest of all.
pub(crate) const VISIBLE_ROUNDINGS: f64 = 3.0;

/// How much a bristle must help for that: share of the rms that it leaves, at most. Chosen.
pub(crate) const HELPS_RATIO: f64 = 0.9;

// ---- Ripple about reversals: `slow_ripple` ----

/// An axis dwells where it has at least so many rows below the moving velocity per reversal. There
/// stiction would be taken for ripple.
pub(crate) const DWELL_ROWS: f64 = 1.0;

/// Samples up to this share of the median velocity are slow. Chosen: ripple that lies above the
/// low-pass at speed lies four times lower there.
pub(crate) const SLOW_SHARE: f64 = 0.25;

/// Fewest slow samples. Chosen: ten folds of 150.
pub(crate) const FEWEST_SLOW_ROWS: usize = 1500;

/// Fewest reversals. Chosen: ten for each half of a record, since both halves must agree.
pub(crate) const FEWEST_SLOW_REVERSALS: usize = 20;

/// Largest distance of the two halves' amplitudes (as vectors), as a share of their mean. Chosen:
/// noise has another phase in each half, so that its distance is of the size of the mean.
pub(crate) const LARGEST_DISAGREEMENT: f64 = 0.6;

/// An amplitude is at least so many half widths of its interval. Chosen: a good half more than what
/// excludes zero, because the best of 180 orders is taken.
pub(crate) const AMPLITUDE_HALF_WIDTHS: f64 = 1.5;

// ---- Whether a dataset can be what it says: `plausibility` ----

/// A thousand, roughly: factors between these are taken for a wrong unit.
pub(crate) const THOUSAND: std::ops::Range<f64> = 300.0..3000.0;

/// Recorded over computed effort below this has the other sign: not just a poor law.
pub(crate) const SWAPPED_EFFORT: f64 = -0.2;

/// Smallest share of the effort that inertia must take part in before its sign means anything.
pub(crate) const SMALLEST_INERTIA_SHARE: f64 = 0.05;

/// Load over motor motion: a transmission error or a gap changes it by less.
pub(crate) const LOAD_SLOPE: std::ops::Range<f64> = 0.8..1.25;

/// Setpoint over motor motion below this is swapped. A setpoint is not needed: only one in a wrong
/// unit or direction is worth a refusal.
pub(crate) const SWAPPED_REFERENCE: f64 = -0.5;

/// A column that moves less than this share of the motor stands still.
pub(crate) const STANDSTILL_SLOPE: f64 = 1.0e-6;

/// Longest travel of a linear axis, m: longer ones are in millimetres.
pub(crate) const LONGEST_M: f64 = 100.0;

/// Fastest motion of a linear axis, m/s.
pub(crate) const FASTEST_M_PER_S: f64 = 50.0;

// ---- What a record cannot know: `rank` ----

/// A declared model is known where its prediction is certain within this part of the effort,
/// percent. Chosen: beyond a half, no effect's own force is as large as the doubt about it. A model
/// that lacks something large is uncertain by up to a tenth, and that is for the selection to find.
pub(crate) const KNOWN_PERCENT: f64 = 50.0;

/// An effect is dropped where that makes the prediction so much more certain: a half, or it was not
/// this effect that was unknown.
pub(crate) const KNOWN_GAIN: f64 = 0.5;

// ---- The drive's own velocity: `velocity` ----

/// Measured velocity over derivative of the position: other factors are a unit, a gear or another
/// axis.
pub(crate) const VELOCITY_SLOPE: std::ops::Range<f64> = LOAD_SLOPE;

/// Smallest correlation of the two below 20 Hz. Chosen: below it noise alone would change the slope
/// by a fifth, which is where the range of the slope ends.
pub(crate) const VELOCITY_CORRELATION: f64 = 0.9;

/// Latest velocity that is shifted back, in rows. A difference of positions comes half a row late,
/// and one that is logged a cycle early or late a row. What comes later went through a filter,
/// whose delay is another at each frequency: a shift does not give back what it took.
pub(crate) const VELOCITY_LATE_ROWS: f64 = 1.0;

/// A measured velocity is used where it leaves at most so much of the error that the derivative of
/// the position leaves. Chosen: less gain is no reason to leave the position, which is what
/// everything else goes by.
pub(crate) const VELOCITY_WORTH: f64 = 0.9;

/// Velocity and acceleration are sharpened where the declared model leaves at most so much of the
/// error that it leaves without. Chosen: what noise of positions costs is up to 5 %, what fast
/// motion gains is up to 20.
pub(crate) const SHARPENED_WORTH: f64 = 0.99;

/// A jittered record keeps the low-pass of the errors where the declared model leaves at most this
/// part of the effort in the band that the lower one takes away; mean squares. Chosen: a good
/// acceleration explains most of it (0.03 on a made clock that is off by a fifth of its period).
/// One that jitter spoils makes it 24 times as large (`bldc_cogging`).
pub(crate) const FULL_BAND: f64 = 0.5;

// ---- Intervals: `inverse_dynamics`, `difference` ----

/// A coefficient is good to this share of itself at best: so far derivatives, hold and low-pass of
/// a record make the force that acted. Of made machines, with noise that would tell them to a tenth
/// of that, it is what they are off by (2026-11-25).
pub(crate) const METHOD: f64 = 1.0e-3;

/// Half widths that are told are so many times those of the blocks and of the validation record,
/// which know nothing of what both records have in common: a load of two bodies, a drive's own
/// velocity, a bristle of another law. On the makes that were known, 705 of 747 told intervals hold
/// with it (`cargo bench -p hil-tests --bench coverage -- 12`, 2026-11-26).
pub(crate) const WRONG_IN_FORM: f64 = 1.15;
