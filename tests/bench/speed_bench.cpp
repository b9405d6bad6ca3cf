// One page: what each path takes, beside a reference that does the same and beside the limit it approaches,
// all in this run. Processor time of one core, medians of rounds that take turns, so that what else the
// machine does hits all alike.
//
//     build/release/tests/speed_bench
#include <tbb/global_control.h>

#include <Eigen/SparseCholesky>
#include <cstdio>
#include <ctime>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <opencv2/quality/qualityssim.hpp>
#include <vector>

#include "core/median.h"
#include "diagnosis/budget_file.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/nominal.h"
#include "environment/water_scores.h"
#include "estimation/sparse.h"
#include "predicted_views.h"
#include "similarity/fsim.h"
#include "support/diagnosis_runs.h"
#include "support/ekf_inputs.h"
#include "support/render_scenes.h"
#include "support/textbook_filter.h"
#include "support/textured_images.h"
#include "water_images.h"

namespace fathom::test {
namespace {

struct Work {
  const char* what;
  std::function<void()> run;
  double times = 1;  ///< of what it is a sample of
};

struct Path {
  const char* name;
  const char* unit;  ///< of what the time is
  double units;      ///< in one run
  Work ours, reference, limit;
  int rounds = 5;
};

double processorSeconds(const Work& work) {
  const std::clock_t begin = std::clock();
  work.run();
  return work.times * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

void print(const Path& path) {
  std::vector<double> ours, reference, limit;
  for (int round = 0; round < path.rounds; ++round) {
    ours.push_back(processorSeconds(path.ours));
    reference.push_back(processorSeconds(path.reference));
    limit.push_back(processorSeconds(path.limit));
  }
  const double ours_s = upperMedian(ours), reference_s = upperMedian(reference), limit_s = upperMedian(limit);
  std::printf("%-10s %10.3f ms %-28s %6.2f times as fast as %s\n%-10s %13s %-28s %6.2f times the limit: %s\n",
              path.name, 1e3 * ours_s / path.units, path.unit, reference_s / ours_s, path.reference.what, "",
              "", path.ours.what, ours_s / limit_s, path.limit.what);
  std::fflush(stdout);
}

// ---- The paths

/// 100 Hz of an INS that reads attitude, rates and acceleration.
std::vector<EkfLine> insReadings(int count) {
  Random random(1);
  std::vector<EkfLine> lines;
  for (int i = 0; i < count; ++i) {
    EkfLine line;
    line.t = 0.01 * i;
    line.index = {3, 4, 5, 9, 10, 11, 12, 13, 14};
    line.z.motion.angular_velocity_robot = 0.01 * random.normal3();
    line.R = 1e-4 * Eigen::MatrixXd::Identity(9, 9);
    lines.push_back(std::move(line));
  }
  return lines;
}

template <class Filter, class Update>
void filtered(const std::vector<EkfLine>& lines, Filter filter, Update&& update) {
  filter.P = 1e-2 * Eigen::Matrix<double, 15, 15>::Identity();
  for (std::size_t i = 1; i < lines.size(); ++i) {
    filter.predict(lines[i].t - lines[i - 1].t, ProcessNoise{});
    withMeasurement<15>(filter.x, lines[i], [&](const auto& m) { return update(filter, m, lines[i]); });
  }
}

/// F P F^T alone, twice a reading.
void denseProducts(std::size_t count) {
  Eigen::Matrix<double, 15, 15> P = Eigen::Matrix<double, 15, 15>::Identity(), FP;
  const Eigen::Matrix<double, 15, 15> F = Eigen::Matrix<double, 15, 15>::Identity();
  for (std::size_t i = 0; i < 2 * count; ++i) {
    FP.noalias() = F * P;
    P.noalias() = FP * F.transpose();
  }
  if (!(P(0, 0) > 0)) std::abort();
}

void filterPath() {
  const auto lines = insReadings(20000);
  print({"filter",
         "a thousand readings",
         1e-3 * static_cast<double>(lines.size()),
         {"predict and update, 15 states",
          [&] {
            filtered(lines, ErrorStateFilter<15>{},
                     [](auto& filter, const auto& m, const EkfLine&) { return filter.update(m); });
          }},
         {"the same filter as a textbook writes it",
          [&] {
            filtered(lines, TextbookFilter<15>{}, [](auto& filter, const auto& m, const EkfLine& line) {
              return filter.update(m, line.index);
            });
          }},
         {"two products F P F^T", [&] { denseProducts(lines.size()); }}});
}

/// So many Gauss-Newton steps on one linearization.
void solved(const Linearization& linear, int steps) {
  for (int step = 0; step < steps; ++step) {
    const Eigen::SparseMatrix<double> normal = transposedTimes(linear.J, linear.J);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal);
    const Eigen::VectorXd x = factor.solve(linear.J.transpose() * linear.residual);
    if (!x.allFinite()) std::abort();
  }
}

void batchPath() {
  const BatchInput input = BatchRun(60.0).input();
  const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  const auto problem = problemAt(input.data, estimate, {});
  const Linearization linear = linearize(input.data, *problem, false);
  print({"batch",
         "a minute of recording",
         1,
         {"maximum a posteriori, covariances", [&] { estimateBatch(input.data, input.start, {}); }},
         {"Gauss-Newton by Eigen's LDLT, as many steps, without covariances",
          [&] {
            for (int step = 0; step < estimate.iterations; ++step)
              solved(linearize(input.data, *problem, false), 1);
          }},
         {"the linear systems alone", [&] { solved(linear, estimate.iterations); }}});
}

void detectionPath() {
  const PredictedViews views("turbid", 12);
  const std::vector<cv::Mat>& images = views.images;
  const auto detector = views.detector(Backend::apriltag);
  print({"detection",
         "an image of 640 x 480",
         static_cast<double>(images.size()),
         {"where a filter predicts the panel",
          [&] {
            for (std::size_t i = 0; i < images.size(); ++i)
              detectPredicted(*detector, images[i], views.map, views.vehicle.camera->model,
                              views.predictions[i]);
          }},
         {"AprilTag's search of the whole image",
          [&] {
            for (const cv::Mat& image : images) detector->detect(image);
          }},
         {"OpenCV's adaptiveThreshold() of it", [&] {
            for (const cv::Mat& image : images) {
              cv::Mat grey, black;
              cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
              cv::adaptiveThreshold(grey, black, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY, 23, 7);
            }
          }}});
}

/// The same lens with so many pixels for each.
CameraModel finer(CameraModel camera, int times) {
  camera.width_px *= times;
  camera.height_px *= times;
  camera.fx_px *= times;
  camera.fy_px *= times;
  camera.cx_px = times * (camera.cx_px + 0.5) - 0.5;
  camera.cy_px = times * (camera.cy_px + 0.5) - 0.5;
  return camera;
}

void renderingPath() {
  constexpr int kSupersampling = 5;
  const Pose pose = lookingAt(kPanelPosition_odom + Vector3d(-1.6, -0.2, 0.2), kPanelPosition_odom);
  const Lighting lamps = lampsBeside(pose, 0.2F, 1.0F);
  Renderer ours(rovCamera(), {kSupersampling}), whole(finer(rovCamera(), kSupersampling), {1}),
      empty(rovCamera(), {1});
  for (Renderer* renderer : {&ours, &whole}) renderer->setScene(panelOnSeaFloor());
  View view, large, nothing;
  print({"rendering",
         "a view of 640 x 480",
         1,
         {"edges at 25 samples a pixel", [&] { ours.render(pose, lamps, view); }},
         {"every pixel at 25 samples",
          [&] {
            whole.render(pose, lamps, large);
            cv::Mat mean;
            cv::resize(large.radiance, mean, {640, 480}, 0, 0, cv::INTER_AREA);
          }},
         {"a view of nothing", [&] { empty.render(pose, lamps, nothing); }},
         9});
}

/// What FSIM's phase congruency cannot do without: of both images, as it halves them, one transform forth and
/// 16 (four scales, four directions) back.
void transforms(const cv::Mat& image) {
  cv::Mat grey, half, spectrum, back;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  cv::resize(grey, half, {320, 240}, 0, 0, cv::INTER_AREA);
  half.convertTo(half, CV_32F);
  for (int of = 0; of < 2; ++of) {
    cv::dft(half, spectrum, cv::DFT_COMPLEX_OUTPUT);
    for (int filter = 0; filter < 16; ++filter) cv::dft(spectrum, back, cv::DFT_INVERSE);
  }
}

void similarityPath() {
  const cv::Mat reference = texturedImage({640, 480}, 1), image = noisy(blurred(reference, 1.5), 4, 2);
  const FsimComparer comparer;
  print({"FSIM",
         "a pair of 640 x 480",
         1,
         {"FSIM and FSIMc", [&] { comparer.compare(reference, image); }},
         {"OpenCV's SSIM, three channels",
          [&] { cv::quality::QualitySSIM::compute(reference, image, cv::noArray()); }},
         {"its Fourier transforms by OpenCV", [&] { transforms(image); }},
         21});
}

void waterPath() {
  constexpr std::size_t kImages = 20, kSearched = 5;
  constexpr std::size_t kTried = 6;
  const WaterImages bench("fathom-speed-bench", kImages);
  const PosedImages& images = bench.images;
  const std::vector<std::size_t>& some = bench.nearest;
  const PairMaker maker = bench.maker();
  std::vector<CleanPair> pairs;
  for (std::size_t k = 0; k < kSearched; ++k) pairs.push_back(maker.clean(images.posed[some[k]]));
  const WaterCamera camera(maker, std::nullopt, 1);
  const FsimComparer fsim;
  const auto similarity = [&](const Environment& water) {
    double sum = 0;
    for (std::size_t k = 0; k < kSearched; ++k) {
      const cv::Mat simulated = camera.image(images.posed[some[k]], pairs[k].clean, water);
      const ImagePair compared = comparedPair(maker, pairs[k], simulated);
      if (const auto score = fsim.compare(compared.recorded, compared.simulated)) sum += score->fsimc;
    }
    return sum / kSearched;
  };
  const FsimSearchOptions whole;
  FsimSearchOptions tried;
  tried.evaluations = kTried;
  print({"fit",
         "water from 20 images",
         1,
         {"rendered, cut into patches, fitted",
          [&] {
            const SynchronizedImages patches = synchronize(images.posed, some, maker);
            fitWater(patches.patches, patches.images.size());
          }},
         {"the paper's search by FSIM on 5 of them (6 of 120 waters measured)",
          [&] { searchByFsim({}, similarity, tried); },
          static_cast<double>(whole.evaluations) / static_cast<double>(kTried)},
         {"rendering alone",
          [&] {
            for (const std::size_t i : some) maker.clean(images.posed[i]);
          }},
         3});
}

void diagnosisPath() {
  const BatchInput input = plainNull(richRun(1, 40.0), 1).input();
  const NominalFit nominal = nominalFit(input.data, input.start, {}, fieldBudget(), 1);
  const Candidate lasting{.effect = findEffect("dvl-scale")->index};
  print({"diagnosis",
         "40 s, nothing hidden",
         1,
         {"", [&] { diagnose(input); }},
         {"a refit with each effect of the catalogue (one measured)",
          [&] { refit(input.data, nominal.fit, nominal.options, {lasting}, nominal.noise); },
          static_cast<double>(kEffectCount)},
         {"one batch estimate", [&] { estimateBatch(input.data, input.start, {}); }},
         3});
}

}  // namespace
}  // namespace fathom::test

int main() {
  using namespace fathom::test;
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  cv::setNumThreads(1);
  filterPath();
  batchPath();
  detectionPath();
  renderingPath();
  similarityPath();
  waterPath();
  diagnosisPath();
}
