#include "support/ekf_inputs.h"

#include <fstream>
#include <sstream>

namespace fathom::test {

EkfLine parseEkfLine(const std::string& text) {
  std::vector<std::string> cells;
  std::stringstream in(text);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  EkfLine line;
  line.t = std::stod(cells[0]);
  line.sensor = cells[1];
  const std::size_t n = std::stoul(cells[2]);
  Eigen::Matrix<double, 15, 1> z = Eigen::Matrix<double, 15, 1>::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    line.index.push_back(std::stoi(cells[3 + i]));
    z[line.index.back()] = std::stod(cells[3 + n + i]);
  }
  line.R.resize(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n * n; ++i)
    line.R(static_cast<Eigen::Index>(i / n), static_cast<Eigen::Index>(i % n)) =
        std::stod(cells[3 + 2 * n + i]);
  auto& m = line.z.motion;
  m.position_odom = z.segment<3>(0);
  m.R_odom_robot = rotationFromYawPitchRoll(z[5], z[4], z[3]);
  m.velocity_robot = z.segment<3>(6);
  m.angular_velocity_robot = z.segment<3>(9);
  m.acceleration_robot = z.segment<3>(12);
  for (std::size_t i = 0; i < n; ++i) {
    if (line.index[i] != 3) continue;
    // Roll, pitch, yaw in the file; MRPT order in bodyRotationFromYawPitchRoll.
    const auto k = static_cast<Eigen::Index>(i);
    Eigen::MatrixXd J = Eigen::MatrixXd::Identity(line.R.rows(), line.R.rows());
    J.block<3, 3>(k, k) = bodyRotationFromYawPitchRoll({z[5], z[4], z[3]}).rowwise().reverse();
    line.R = (J * line.R * J.transpose()).eval();
  }
  return line;
}

EkfInputs readEkfInputs(const std::filesystem::path& file) {
  EkfInputs inputs;
  std::ifstream in(file);
  for (std::string text; std::getline(in, text);) {
    if (text.starts_with("#Q") || text.starts_with("#P0")) {
      std::stringstream numbers(text.substr(text.find(' ')));
      auto& target = text.starts_with("#Q") ? inputs.Q : inputs.P0;
      for (double v = 0; numbers >> v;) target.push_back(v);
    } else if (!text.starts_with("#") && !text.empty()) {
      inputs.lines.push_back(parseEkfLine(text));
    }
  }
  return inputs;
}

}  // namespace fathom::test
