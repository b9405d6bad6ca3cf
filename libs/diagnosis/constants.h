#pragma once

#include <cstddef>

/// Every number that the diagnosis decides by, and where it is from: derived (by which formula) or chosen.
/// What a user declares is in the error budget (config/error_budget.yaml), what a user can ask for in
/// DiagnosisOptions, and what a type is made of, as the sizes of EffectEvidence, in it.
namespace fathom {

// What is said.

/// Of what can be taken away, from which on a recording is explained. Chosen: the contract's rule.
inline constexpr double kExplained = 0.95;
/// ln of the odds that a component of the budget is beyond its limit. Chosen: twenty to one.
inline constexpr double kBursts = 3;
/// ln of the likelihood from which on a part of a recording is noisier than the rest. Chosen: more than for
/// having looked at every part.
inline constexpr double kNoisierPart = 10;
/// Sigmas, by the median, beyond which a reading is none of the others' kind. Chosen: by chance one in a
/// million.
inline constexpr double kOutlierSigmas = 5;
/// Of a map of what is left: below, it is unlikely by chance. Chosen: one in a hundred.
inline constexpr double kUnexplained_p = 0.01;
/// Information times prior variance, from which on a usual size would have shown. Derived: 5 % over the whole
/// catalogue, power 90 %.
inline constexpr double kDetectable = 18;
/// Of the catalogue that has to be within reach, for "none" to mean something. Chosen.
inline constexpr double kLeastShare = 0.2;
/// Than stated: worth a remark. Chosen.
inline constexpr double kNoisier = 1.5, kQuieter = 0.5;
/// Of a prior's sigma: a screening's is less where nothing is told of a parameter, and it is left out of the
/// inverse. Derived: rounding.
inline constexpr double kNothingTold = 1e-6;
inline constexpr std::size_t kToldFailures = 3;  ///< chosen: as many as one reads
/// Beyond, its exponential is no double. Derived: ln 1e308 = 709.
inline constexpr double kMostLogOdds = 300;
/// ln of odds against an effect by itself: what is less likely than not is not said. Derived.
inline constexpr double kEvenOdds = 0;

// What else it could be.

/// ln of odds beyond which a rival is excluded, or one more effect is named. Derived: what is stated holds
/// 95 % of the mass, ln 19.
inline constexpr double kExcluded = 2.94;
/// lambda (1 - |c|), below which two effects cannot be told apart. Derived: what one in a hundred recordings
/// is off by (discrepancy.md).
inline constexpr double kSeparable = 5.4;
inline constexpr std::size_t kRivals = 4;  ///< tried in full. Chosen, for time
/// sqrt(lambda) of what would never have been named. Derived: two sigma.
inline constexpr double kVanished = 2;

/// What a found effect changes is right to so much of it: what is less, in readings of the same kind, may be
/// the other's error. In sizes (sqrt(lambda)). Chosen with one recording's lamp in view.
inline constexpr double kModelError = 0.03;

// Whether it holds on stretches that were not fitted.

/// Of the gain that is expected there, that has to be seen, see leastSeen(). Chosen.
inline constexpr double kConfirmed = 0.3;
/// By which it may be less than expected: as one true effect of 44 is, or fewer. Usual.
inline constexpr double kUsualSigmas = 2;
/// Where held-out stretches could not show so much of the gain, since poses follow it there, it has to gain
/// kUnseen (ln of the likelihood: odds of a thousand to one) where it was fitted, for kUnseenShare of the
/// recording. Chosen.
inline constexpr double kShownAtAll = 0.1, kUnseen = 7, kUnseenShare = 0.25;
/// Less likely than that by chance, what shows is a mismatch, also where no effect can be named. Chosen, with
/// the recordings of seeds 36901 and 37001 in view.
inline constexpr double kNoChance_p = 1e-3;
/// Stretches of a fold, between those of others. Chosen: an effect for a part is in most folds.
inline constexpr int kStretches = 3;
inline constexpr double kFivePercent = 1.645;  ///< sigmas of a normal distribution's lower tail
/// Of a stretch, that are drawn anew by the bootstrap. Chosen.
inline constexpr int kPartsOfStretch = 2;
inline constexpr int kResamples = 1000;  ///< usual for 95 % intervals (Efron & Tibshirani 1993)
inline constexpr int kFloorDraws = 8;    ///< of noise, for the floor. Chosen
inline constexpr int kPlacebos = 20;     ///< draws of noise: the largest is their 95th percentile
inline constexpr double kRidge =
    1e-6;  ///< of a column's length, where a stretch by itself says nothing. Chosen: more than rounding, and
           ///< a path that is 10 m elsewhere costs nothing

// What is tried.

/// Support (ln of odds) from which on an effect may be far from linear, and then what may be right has so
/// much of the largest. Chosen.
inline constexpr double kFarFromLinear = 100, kFarShare = 0.3;
/// ln of odds by which the budget as declared may say less than as it shows. Chosen.
inline constexpr double kUnderestimated = 5;
/// Sets looked at to first order, and those of them that are fitted in full. Chosen, for time.
inline constexpr std::size_t kLooked = 40, kContenders = 5;
inline constexpr std::size_t kTogether = 3;  ///< effects that are looked for at once. Chosen, for time
/// ln of odds, and share of the largest, by which a contender to first order may be behind. Chosen.
inline constexpr double kContenderMargin = 8, kContenderShare = 0.25;
/// Of its best part's evidence: then it may last. Chosen.
inline constexpr double kMayLast = 0.3;
/// sqrt(lambda) of what is needed without being tried: what robust losses leave of it decides all the same.
inline constexpr double kPlainlyNeeded = 30;
inline constexpr std::size_t kKeptModels = 1;  ///< each as large as all readings' derivatives
inline constexpr std::size_t kFinerTried = 4;  ///< parts with finer edges, of each family. Chosen, for time
inline constexpr std::size_t kKeptSets =
    60;                                     ///< of a size, to which another effect is added. Chosen, for time
inline constexpr double kEdge_s = 1.0 / 3;  ///< between finer edges: as often as images usually come
inline constexpr int kMostPerSegment = 32;  ///< finer edges; of a long recording, whose parts are long
inline constexpr double kFinest_s = 0.1;    ///< between edges in the end. Chosen
/// Of a direction's length that is left: less is rounding. Chosen.
inline constexpr double kLeastKept = 1e-4;
inline constexpr int kAlarmDraws = 200, kDrawsAtOnce = 40;  ///< of the budget and noise: its 90th percentile
inline constexpr double kImpossible = -1e6;                 ///< ln of odds
inline constexpr double kClearlySigmas = 3;                 ///< less than nothing: by chance once in 700

// The budget and its scales.

/// A field's nodes: so many to a length of correlation, along one covariate at most. Derived: at a third of a
/// length the field is what it is but for 1e-6 of its variance, at half a length but for 1e-4 (see kDropped);
/// the most, for time.
inline constexpr double kNodesPerLength = 3;
inline constexpr int kMostNodes = 12;
/// Of a field's length: a mean over no more is a value. Derived: off by 1e-7 of it.
inline constexpr double kPointLike = 1e-3;
/// Of a field's variance: directions that are not in its columns. Derived: of a field of 2 % that is 6e-6 of
/// light, of which all of it together resolves 4e-5; 1e-4 would leave out 2e-4 of light.
inline constexpr double kDropped = 1e-7;
/// Of the noise's variance: a value that readings cannot see better, be it as large as it may, needs no
/// column. Chosen: an effect in that direction would seem sqrt(1.3) times as sure as it is, at most.
inline constexpr double kLeastTold = 0.3;
/// Of the squares of what a column changes: less is not followed through the poses to light, of all of it
/// nor, by its share, of a reading. Chosen, for time.
inline constexpr double kLeastThrough = 1e-3;
/// Columns of places that have readings in common, at most: of more, nothing is gained by their being few.
/// Chosen, for time.
inline constexpr std::size_t kLargestBlock = 100;
/// Of the declared variance of ln sigma, that is between vehicles of a kind. Chosen.
inline constexpr double kBetweenVehicles = 0.5;
/// Steps of the likeliest scales; they end where another would gain so little of ln of the likelihood. No
/// step is longer than a factor of e^3. Chosen.
inline constexpr int kMostSteps = 100, kMostHalvings = 20;
inline constexpr double kConverged = 0.01, kLongestStep = 3;
/// Steps before that one is mixed with; what is longer (a factor of e) overshoots by no steady share. Chosen.
inline constexpr int kAccelerated = 2;
inline constexpr double kUnsteadyStep = 1;
inline constexpr int kScaleRounds = 2;  ///< of scales and sizes. Chosen, for time
/// How often light is linearized, at most, where budget and effects have it by then, until its readings are
/// there what was foretold: sum of squares, in units of their sigmas. Chosen: most of it is what the budget
/// makes up for, and ln of the evidence changes by less than one.
inline constexpr int kLinearized = 4;
inline constexpr double kAsForetold = 10;
inline constexpr double kMostLight = 0.3;  ///< ln of a factor, by which the budget may be off then. Chosen
inline constexpr int kReweighed = 4;       ///< rounds of robust weights, at most. Chosen, for time

/// An owner's value is not of its kind where the largest sigma that the budget has for it would give any of
/// them one like it so rarely; but where so large a share of the owners are so, it is the kind that is
/// otherwise. How many are expected to be, of the owners. Chosen.
inline constexpr double kApart_p = 1e-3, kMostApart = 0.1, kExpectedApart = 0.01;

// The noise.

inline constexpr double kLessNoise = 0.9;  ///< times the noise taken before: less than chance
/// ln of the likelihood by which another minimum is a better one. Chosen: more than where a fit stops.
inline constexpr double kOtherMinimum = 1;
inline constexpr int kNoisePasses = 2;          ///< of noise and nominal fit. Chosen
inline constexpr double kCostTolerance = 0.01;  ///< of a fit: a hundredth of what decides
/// Of a noise's scale beside the one assumed: the largest, and how often what it is between is halved (its
/// logarithm) until it is known to 1e-4. Derived.
inline constexpr double kMostScale = 3e6;
inline constexpr int kScaleHalvings = 18;
inline constexpr int kNoiseDraws = 16;  ///< squares of kFewestRows are known to sqrt(2 / 480) then
inline constexpr int kCorrelationRounds = 5, kPartRounds = 3;  ///< at most. Chosen
inline constexpr std::size_t kFewestRows = 30;                 ///< fewer show no noise of their own
inline constexpr double kClearSigmas = 4;  ///< from which on a correlation is more than chance
inline constexpr double kLargestCorrelation = 0.95;
/// Of Poisson's variance: where there are no specks there is less. Chosen.
inline constexpr double kCounted = 0.1;
/// Of the variance of light: a mean of rounded numbers is no better. Chosen.
inline constexpr double kLeastOfStated = 0.01;
inline constexpr double kLeastSeen = 0.1;  ///< of a place; less counts as that
inline constexpr int kWeightRounds = 4;    ///< of the saturated model. Chosen
inline constexpr int kPeaks = 16;  ///< over the recording: narrower ones are noise until they are found

// Maps of the mismatch.

inline constexpr double kFailed_p = 0.002;    ///< of a check of the fit. Chosen
inline constexpr double kLeastChange = 0.1;   ///< below, a strong effect's own curvature shows
inline constexpr double kLeastSpread = 1e-6;  ///< below, a covariate is constant
inline constexpr int kSpectrumDraws = 16;
inline constexpr std::size_t kShortestSpectrum = 64, kImagesTogether = 64;

// The advised manoeuvre.

/// Separation s, in sigma, from which on the better one is ahead by half of what decides (kSeparable), 2.7 in
/// ln of the likelihood, in 39 of 40 recordings. Derived: s^2 / 2 - 2 s.
inline constexpr double kToldApart = 5;
inline constexpr double kEase_s = 5;           ///< from rest to the manoeuvre. Chosen
inline constexpr double kImageInterval_s = 1;  ///< of images in it. Chosen: a slow camera
inline constexpr double kNearest_m = 0.2;      ///< nothing nearer is recognized

}  // namespace fathom
