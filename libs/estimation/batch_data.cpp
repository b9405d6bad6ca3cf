#include "estimation/batch_data.h"

namespace fathom {

bool BatchData::hasMotion() const {
  for (std::size_t i = 0; i < readings.size(); ++i)
    if (!readings[i].empty() && kChannelTexts[i].shows_motion) return true;
  return false;
}

}  // namespace fathom
