#include "tasks/task_outputs.h"

#include "core/error.h"

namespace fathom {

InnovationLog::InnovationLog(const std::filesystem::path& file)
    : file_(file), gz_(gzopen(file_.path().c_str(), "wb6")) {
  if (gz_ == nullptr) throw Error(file.string(), "", "cannot be written");
  gzputs(gz_, "t_s,channel,degrees_of_freedom,nis,fused\n");
}

InnovationLog::~InnovationLog() {
  if (gz_ != nullptr) gzclose(gz_);
}

void InnovationLog::write(const Innovation& i) {
  gzprintf(gz_, "%.4f,%s,%d,%.6g,%d\n", i.t_s, nameOf(i.channel).c_str(), i.degrees_of_freedom, i.nis,
           i.fused ? 1 : 0);
}

void InnovationLog::finish() {
  const int status = gzclose(gz_);
  gz_ = nullptr;
  if (status != Z_OK) throw Error(file_.target().string(), "", "cannot be written; is the disk full?");
  file_.commit();
}

void NisWindows::add(const Innovation& innovation) {
  constexpr std::size_t kMost = 4000;
  if (windows_.empty() || innovation.t_s >= windows_.back().begin_s + length_s_)
    windows_.push_back({std::floor(innovation.t_s / length_s_) * length_s_});
  windows_.back().sum += innovation.nis;
  ++windows_.back().count;
  if (windows_.size() <= kMost) return;
  length_s_ *= 2.0;
  std::vector<Window> merged;
  for (const Window& window : windows_) {
    const double begin_s = std::floor(window.begin_s / length_s_) * length_s_;
    if (merged.empty() || begin_s > merged.back().begin_s) merged.push_back({begin_s});
    merged.back().sum += window.sum;
    merged.back().count += window.count;
  }
  windows_ = std::move(merged);
}

void TaskOutputs::TumFile::finish() {
  out.close();
  if (!out) throw Error(file.target().string(), "", "cannot be written; is the disk full?");
  file.commit();
}

TaskOutputs::TaskOutputs(const std::filesystem::path& folder, const std::string& task, bool smoothed,
                         ResultsLog& results, std::size_t stream)
    : label_("EKF_" + task),
      results_(results),
      stream_(stream),
      trajectory_(folder / "trajectory.tum"),
      innovations_(folder / "innovations.csv.gz") {
  if (smoothed) smoothed_ = std::make_unique<TumFile>(folder / "trajectory_smoothed.tum");
}

void TaskOutputs::estimate(const Estimate& e) {
  const KinematicState<double>& m = e.state.motion;
  poses_.push_back({e.time, {m.R_odom_robot, m.position_odom}});
  lost_.push_back(e.lost);
  if (!e.lost && (marks_.empty() || e.t_s - marks_.back().t_s >= kMarkEvery_s))
    marks_.push_back({e.t_s, {poses_.back().T_odom_robot, e.pose_covariance}});
  writeTumLine(trajectory_.out, poses_.back());
  results_.add(stream_, {e.time, label_, PoseSample{posePdf(e)}});
  velocities_.push_back(m.velocity_robot);
  last_ = e;
}

void TaskOutputs::smoothed(const Estimate& e) {
  smoothed_poses_.push_back({e.time, {e.state.motion.R_odom_robot, e.state.motion.position_odom}});
  writeTumLine(smoothed_->out, smoothed_poses_.back());
}

void TaskOutputs::innovation(const Innovation& innovation) {
  innovations_.write(innovation);
  nis_[innovation.channel].add(innovation);
}

void TaskOutputs::event(const Event& event) {
  const bool tells_trust = event.kind == "lost" || event.kind == "found";
  if (tells_trust || other_events_++ < kEventsKept) events_.push_back(event);
}

void TaskOutputs::finish() {
  trajectory_.finish();
  if (smoothed_) smoothed_->finish();
  innovations_.finish();
}

}  // namespace fathom
