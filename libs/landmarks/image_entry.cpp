#include "landmarks/image_entry.h"

#include <set>

#include "core/affine.h"
#include "core/progress.h"
#include "sensors/dvl.h"
#include "sensors/ins.h"

namespace fathom {
namespace fs = std::filesystem;

namespace {

/// The robot's motion as its navigation sensors tell it, noise and all: enough for the few centiseconds that
/// an image takes.
struct LatestMotion {
  Vector3d velocity_robot = Vector3d::Zero(), angular_velocity_robot = Vector3d::Zero();

  void look(const Sample& sample) {
    Inputs<double> in;
    if (const auto* ins = std::get_if<InsSample>(&sample.reading); ins && ins->angular_velocity_ins) {
      const auto turnedBy = [&](const Vector3d& rate_robot) {
        in.state.angular_velocity_robot = rate_robot;
        return Gyro::angularVelocity(in, ins->T_robot_ins);
      };
      angular_velocity_robot = affineInverse<3>(turnedBy, *ins->angular_velocity_ins);
    }
    if (const auto* dvl = std::get_if<DvlSample>(&sample.reading); dvl && dvl->velocity_dvl) {
      in.state.angular_velocity_robot = angular_velocity_robot;
      const auto movedBy = [&](const Vector3d& velocity) {
        in.state.velocity_robot = velocity;
        return Dvl::velocity(in, dvl->T_robot_dvl);
      };
      velocity_robot = affineInverse<3>(movedBy, *dvl->velocity_dvl);
    }
  }
};

}  // namespace

bool isImage(const Sample& sample) {
  return std::holds_alternative<ImageSample>(sample.reading) ||
         std::holds_alternative<StereoSample>(sample.reading);
}

std::optional<ImageEntry> imageEntry(const Sample& sample, const fs::path& image_folder,
                                     const Vehicle& vehicle) {
  const Instance instance = Instance::of(sample.label);
  const auto& sheet = vehicle.sensors(instance).camera;
  const auto eye = [&](const std::string& file, const RecordedCamera& camera, const Pose& T_first_camera) {
    ImageEntry::Eye view{{image_folder / file, camera.model}, T_first_camera};
    if (sheet) view.image.camera.bayer = sheet->model.bayer;
    return view;
  };
  if (const auto* image = std::get_if<ImageSample>(&sample.reading))
    return ImageEntry{
        sample.time, instance, image->T_robot_camera, {eye(image->file, image->intrinsics, {})}};
  if (const auto* pair = std::get_if<StereoSample>(&sample.reading))
    return ImageEntry{sample.time,
                      instance,
                      pair->T_robot_left,
                      {eye(pair->left_file, pair->left_intrinsics, {}),
                       eye(pair->right_file, pair->right_intrinsics, pair->T_left_right)}};
  return std::nullopt;
}

std::vector<ImageEntry> imageEntries(SampleSource& source, const Vehicle& vehicle) {
  std::vector<ImageEntry> entries;
  LatestMotion motion;
  Progress progress("looking for images");
  while (const auto sample = source.next()) {
    motion.look(*sample);
    if (auto entry = imageEntry(*sample, source.imageFolder(), vehicle)) {
      entry->velocity_robot = motion.velocity_robot;
      entry->angular_velocity_robot = motion.angular_velocity_robot;
      entries.push_back(std::move(*entry));
    }
    progress.update(source.fraction());
  }
  return entries;
}

std::vector<CameraImage> imagesOf(const std::vector<ImageEntry>& entries) {
  std::vector<CameraImage> images;
  std::set<fs::path> files;
  for (const ImageEntry& entry : entries)
    for (const ImageEntry::Eye& eye : entry.eyes)
      if (files.insert(eye.image.file).second) images.push_back(eye.image);
  return images;
}

}  // namespace fathom
