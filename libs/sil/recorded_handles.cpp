#include "sil/recorded_handles.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/for_each.h"
#include "handles/circular_average.h"
#include "image_files/image_file.h"
#include "image_files/jpeg.h"
#include "imaging/eight_bits.h"

namespace fathom {
namespace {

constexpr double kContradicted_rad = radians(15);

/// One thread's readers, a panel each.
class Readers {
 public:
  explicit Readers(const KnownWorld& world) : world_(world) {}

  HandleReader& of(std::size_t panel) {
    auto it = readers_.find(panel);
    if (it == readers_.end())
      it = readers_
               .emplace(panel,
                        HandleReader({world_.panels[panel], *world_.vehicle.camera, world_.environment}))
               .first;
    return it->second;
  }

 private:
  const KnownWorld& world_;
  std::map<std::size_t, HandleReader> readers_;
};

HandleSight sightOf(std::size_t image, std::size_t panel, const HandleReading& reading) {
  HandleSight sight;
  sight.image = image;
  sight.panel = panel;
  sight.handle = reading.handle;
  sight.confident = reading.confident;
  sight.why_not = reading.why_not;
  sight.disagreement_rad = reading.disagreement_rad;
  if (reading.confident) {
    sight.angle_rad = reading.angle_rad;
    sight.sigma_rad = reading.sigma_rad;
  }
  if (reading.edge.found) {
    sight.chain_angle_rad = reading.edge.angle_rad;
    sight.chain_symmetry_rad = reading.edge.symmetry_rad;
  }
  return sight;
}

/// The mean direction, as an angle within the handle's range where one is near it.
double inRange(const Handle& handle, double angle_rad) {
  constexpr double kBeyond_rad = radians(5);
  const double symmetry = symmetryOf(handle.kind);
  const std::vector<double> angles = anglesInRange(handle, angle_rad, symmetry, kBeyond_rad);
  return angles.empty() ? angle_rad
                        : std::clamp(angles.front(), handle.smallest_angle_rad, handle.largest_angle_rad);
}

void addAverages(const std::vector<PanelMap>& panels, std::size_t window, std::vector<HandleSight>& sights) {
  std::map<std::pair<std::size_t, std::size_t>, CircularAverage> averages;
  for (HandleSight& sight : sights) {
    const Handle& handle = panels[sight.panel].handles[sight.handle];
    CircularAverage& average =
        averages.try_emplace({sight.panel, sight.handle}, symmetryOf(handle.kind), window).first->second;
    if (sight.confident) average.add(sight.angle_rad, sight.sigma_rad);
    if (average.count() == 0) continue;
    sight.average_rad = inRange(handle, average.mean_rad());
    sight.average_sigma_rad = average.sigma_rad();
  }
}

/// `imageOf` gives an image's pixels, CV_8UC3 or CV_16UC3; empty where there is none.
std::vector<HandleSight> readAll(const PosedImages& images, const KnownWorld& world, std::size_t window,
                                 const std::string& what,
                                 const std::function<cv::Mat(const PosedImage&)>& imageOf,
                                 const SeeHandles& see) {
  tbb::enumerable_thread_specific<Readers> readers([&] { return Readers(world); });
  std::vector<std::vector<HandleSight>> by_image(images.posed.size());
  forEachIndex(images.posed.size(), what, [&](std::size_t i) {
    const PosedImage& posed = images.posed[i];
    const cv::Mat image = imageOf(posed);
    if (image.empty()) return;
    CameraSheet sheet = *world.vehicle.camera;
    sheet.bits = bitsOf(image, sheet.bits);
    const cv::Mat numbers = sheet.bits > 8 ? image : fullScaleInEightBits(image, sheet.bits);
    const PosedPanelImage before{radianceOf(numbers, sheet), posed.camera.lens, posed.camera.projector,
                                 T_camera_panelOf(posed, world.panels[posed.panel]).pose,
                                 jpegQuality(posed.image.file).has_value()};
    const std::vector<HandleReading> readings = readers.local().of(posed.panel).read(before);
    for (const HandleReading& reading : readings) by_image[i].push_back(sightOf(i, posed.panel, reading));
    if (see) see(posed, image, readings);
  });
  std::vector<HandleSight> sights;
  for (const auto& own : by_image) sights.insert(sights.end(), own.begin(), own.end());
  addAverages(world.panels, window, sights);
  return sights;
}

}  // namespace

UncertainPose T_camera_panelOf(const PosedImage& posed, const PanelMap& panel) {
  const LinkedPose camera = composed(posed.T_odom_robot.pose, posed.camera.T_robot_camera);
  const LinkedPose seen = between(camera.pose, panel.T_odom_panel);
  const Matrix6d wrt_robot = seen.wrt_first * camera.wrt_first;
  return {seen.pose, wrt_robot * posed.T_odom_robot.covariance * wrt_robot.transpose()};
}

std::vector<HandleSight> recordedHandles(const PosedImages& images, const KnownWorld& world,
                                         std::size_t window, const SeeHandles& see) {
  return readAll(
      images, world, window, "reading handles",
      [](const PosedImage& posed) {
        try {
          return inColour(readImage(posed.image.file, posed.image.camera));
        } catch (const Error&) {
          return cv::Mat();
        }
      },
      see);
}

std::vector<HandleSight> simulatedHandles(const PosedImages& images, const PairMaker& maker,
                                          std::size_t window) {
  return readAll(images, maker.world(), window, "reading simulated handles",
                 [&](const PosedImage& posed) -> cv::Mat {
                   try {
                     return maker.make(posed).images.simulated;
                   } catch (const Error&) {
                     return {};
                   }
                 },
                 {});
}

std::vector<HandleState> statesOf(const std::vector<HandleSight>& sights,
                                  const std::vector<PanelMap>& panels) {
  std::map<std::pair<std::size_t, std::size_t>, std::pair<HandleState, CircularAverage>> all;
  for (const HandleSight& sight : sights) {
    const Handle& handle = panels[sight.panel].handles[sight.handle];
    auto& [state, average] = all.try_emplace({sight.panel, sight.handle},
                                             HandleState{.panel = sight.panel, .handle = sight.handle},
                                             CircularAverage(symmetryOf(handle.kind), sights.size()))
                                 .first->second;
    ++state.images;
    if (!sight.confident) continue;
    ++state.confident;
    state.contradicted += sight.disagreement_rad > kContradicted_rad ? 1 : 0;
    average.add(sight.angle_rad, sight.sigma_rad);
    state.angle_rad = inRange(handle, average.mean_rad());
    state.sigma_rad = average.sigma_rad();
  }
  std::vector<HandleState> states;
  for (const auto& [key, of_handle] : all) states.push_back(of_handle.first);
  return states;
}

}  // namespace fathom
