#include "support/board_views.h"

#include "core/text.h"
#include "support/traced_light.h"

namespace fathom::test {

std::vector<BoardView> BoardViews::views(int count, bool in_water, std::uint64_t seed) const {
  Random random = Random::stream(seed, in_water ? 1 : 0);
  std::vector<BoardView> all;
  for (int i = 0; i < count; ++i) {
    BoardView& view =
        all.emplace_back(BoardView{print(in_water ? "water/%d" : "air/%d", i), {}, {}, in_water});
    const Pose T_camera_board{
        expSO3<double>(Vector3d(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(-3, 3))),
        {0, 0, random.uniform(nearest_m, farthest_m)}};
    const Vector3d normal = T_camera_board.rotation.col(2);
    while (std::ssize(view.pixels) < points) {
      const Vector2d pixel(random.uniform(20, lens.width_px - 20), random.uniform(20, lens.height_px - 20));
      LightRay ray{Vector3d::Zero(), lens.rayAt(pixel)};
      if (in_water && port) ray = traced(*port, ray.direction);
      if (in_water && dome) ray = traced(*dome, ray.direction);
      const double along = normal.dot(T_camera_board.position - ray.origin) / normal.dot(ray.direction);
      if (!(along > 0.1 && along < 4)) continue;
      view.points_m.push_back(T_camera_board.inverse() * Vector3d(ray.origin + along * ray.direction));
      view.pixels.push_back(pixel + noise_px * random.normal3().head<2>());
    }
  }
  return all;
}

}  // namespace fathom::test
