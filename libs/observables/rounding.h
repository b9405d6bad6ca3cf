#pragma once

/// What numbers that were rounded to whole ones were before.
namespace fathom {

struct BeforeRounding {
  double mean = 0, sigma = 0;  ///< sigma: of the mean, by what is known of it
};

/// Of `count` numbers that scattered normally about one mean, from the mean and the variance of what they
/// were rounded to: the pair of mean and scatter of which rounding would make these, the scatter being the
/// usual one where it may be (Widrow & Kollar 2008, quantization noise: what rounding does to moments; here
/// without their series, which fails where numbers scatter by less than a third). Where they are all alike,
/// and may scatter by nothing, their mean is known to 0.29.
BeforeRounding beforeRounding(double mean, double variance, double count, double usual_scatter);

}  // namespace fathom
