#pragma once

#include <mrpt/core/Clock.h>
#include <mrpt/img/TCamera.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include "recording/samples.h"

/// This program's types as MRPT's and back, for what reads and writes MRPT's files; nobody else includes
/// this. There and back is exact where a camera has square pixels' axes: skew is left out.
namespace fathom {

mrpt::poses::CPose3D toMrpt(const Pose& pose);
Pose fromMrpt(const mrpt::poses::CPose3D& pose);

mrpt::poses::CPose3DPDFGaussian toMrpt(const YawPitchRollPose& pose);
YawPitchRollPose fromMrpt(const mrpt::poses::CPose3DPDFGaussian& pdf);

mrpt::img::TCamera toMrpt(const RecordedCamera& camera);
RecordedCamera fromMrpt(const mrpt::img::TCamera& camera);

mrpt::Clock::time_point toMrpt(Time time);
Time fromMrpt(mrpt::Clock::time_point time);

}  // namespace fathom
