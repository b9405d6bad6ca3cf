#include "environment/fsim_search.h"

#include <algorithm>
#include <cmath>

#include "environment/water_fit.h"

namespace fathom {

FsimSearch searchByFsim(const Environment& start, const std::function<double(const Environment&)>& similarity,
                        const FsimSearchOptions& options) {
  FsimSearch best{start, similarity(start), 1};
  double factor = options.first_factor;
  while (factor >= options.last_factor) {
    bool better = false;
    for (int i = 0; i < 6; ++i)
      for (const double turn : {factor, 1 / factor}) {
        if (best.evaluations >= options.evaluations) return best;
        Vector9d parameters = waterParameters(best.environment);
        parameters[i] *= turn;
        if (i >= 3) parameters[i] = std::min(parameters[i], 1.0);
        const Environment tried = environmentOf(parameters);
        const double reached = similarity(tried);
        ++best.evaluations;
        if (reached <= best.similarity) continue;
        best.environment = tried;
        best.similarity = reached;
        better = true;
        break;
      }
    if (!better) factor = std::sqrt(factor);
  }
  return best;
}

}  // namespace fathom
