#include "core/geodesy.h"

#include <gtest/gtest.h>
#include <mrpt/topography/conversions.h>

#include "core/random.h"

namespace fathom {
namespace {

// Against MRPT's conversion, whose ellipsoid is the same: both err by rounding of the Earth's radius, 1e-9 m.
TEST(Geodesy, EastNorthUpIsMrpts) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Geodetic origin{random.uniform(-80, 80), random.uniform(-180, 180), random.uniform(-50, 500)};
    const Geodetic at{origin.latitude_deg + 0.05 * random.normal(),
                      origin.longitude_deg + 0.05 * random.normal(), origin.height_m + 30 * random.normal()};
    mrpt::math::TPoint3D theirs;
    mrpt::topography::geodeticToENU_WGS84({at.latitude_deg, at.longitude_deg, at.height_m}, theirs,
                                          {origin.latitude_deg, origin.longitude_deg, origin.height_m});
    EXPECT_LT((eastNorthUp(at, origin) - Vector3d(theirs.x, theirs.y, theirs.z)).norm(), 1e-6);
    const Geodetic back = geodetic(eastNorthUp(at, origin), origin);
    EXPECT_LT(eastNorthUp(back, at).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace fathom
