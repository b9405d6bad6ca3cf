#pragma once

#include <ceres/loss_function.h>

#include <cstddef>

/// A prior about zero for what is as large as one expects, most often, and much larger at times: normal as
/// far as its n dimensions reach (u <= sqrt(n), u the norm in units of its sigmas), from there on with the
/// weight, and so the slope, of a multivariate Cauchy distribution, (n + 1) / (1 + u^2). A normal one would
/// pull what is ten of its sigmas large towards zero by many sigmas of the readings.
namespace fathom {

/// Whether an effect's prior is one: where all that is unknown of it is one parameter. Of several (a port's
/// distance, glass and water) normal priors tell which is meant, where the readings hardly do.
bool hasWidePrior(std::size_t effect);

/// Weight on the square of the norm: 1 to 0. A normal prior of sigma / sqrt(weight) has the same slope there.
double widePriorWeight(double square, double dimensions);

/// -ln of its density, 0 at zero.
double widePriorCost(double square, double dimensions);

/// As Ceres wants it: rho(s) is twice the cost.
class WidePriorLoss final : public ceres::LossFunction {
 public:
  explicit WidePriorLoss(double dimensions) : dimensions_(dimensions) {}
  void Evaluate(double square, double rho[3]) const override;

 private:
  double dimensions_;
};

}  // namespace fathom
