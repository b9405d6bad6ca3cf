#include "calibration/camera_selection.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "core/for_each.h"
#include "core/median.h"
#include "core/progress.h"

namespace fathom {
namespace {

/// Sigmas by which a kind of more unknowns has to be better.
constexpr double kClearly = 2;

/// Mean square of what a view's points are off by, each half judged at the pose that the other half has.
double heldOutSquare(const CameraFit& camera, const BoardView& view) {
  const CameraProjector<double> projector = camera.projector(view.in_water);
  double squares = 0;
  for (const std::size_t from : {std::size_t{0}, std::size_t{1}}) {
    const BoardView fitted = view.half(from), judged = view.half(1 - from);
    const Pose pose = poseOfView(camera, fitted);
    for (std::size_t i = 0; i < judged.pixels.size(); ++i)
      squares += (projector.project(Vector3d(pose * judged.points_m[i])) - judged.pixels[i]).squaredNorm();
  }
  return squares / static_cast<double>(view.pixels.size());
}

/// Of each view by its name, calibrated without it.
using Squares = std::map<std::string, double>;

template <class Fit>
Squares heldOutSquares(const std::vector<BoardView>& views, bool judged_in_water, int folds, const Fit& fit) {
  Squares squares;
  for (int fold = 0; fold < folds; ++fold) {
    if (interrupted()) throw Interrupted{};
    std::vector<BoardView> fitted, judged;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const bool is_out = static_cast<int>(i) % folds == fold && views[i].in_water == judged_in_water;
      (is_out ? judged : fitted).push_back(views[i]);
    }
    if (judged.empty()) continue;
    const CameraFit camera = fit(fitted);
    for (const BoardView& view : judged) squares[view.name] = heldOutSquare(camera, view);
  }
  return squares;
}

double meanOf(const Squares& squares) {
  double sum = 0;
  for (const auto& [view, square] : squares) sum += square;
  return sum / static_cast<double>(squares.size());
}

double medianRange(const CameraFit& fit, const std::vector<BoardView>& views) {
  std::vector<double> ranges;
  for (const BoardView& view : views) {
    const auto pose = fit.T_camera_board.find(view.name);
    if (pose == fit.T_camera_board.end()) continue;
    for (const Vector3d& point : view.points_m) ranges.push_back((pose->second * point).norm());
  }
  return upperMedian(ranges);
}

class Selection {
 public:
  Selection(const std::vector<BoardView>& views, const CameraSetting& setting,
            const SelectionOptions& options)
      : views_(views), setting_(setting), options_(options) {
    for (const BoardView& view : views) has_water_ |= view.in_water;
    for (const BoardView& view : views)
      if (view.in_water == has_water_) judged_.push_back(view);
  }

  CameraSelection run() {
    const std::vector<const CameraKind*> kinds = kindsToTry();
    selection_.by_opencv = fitByOpenCv(judged_, setting_);
    std::vector<std::optional<Tried>> tried(kinds.size());
    std::vector<std::string> why(kinds.size());
    forEachIndex(kinds.size(), "fitting kinds of cameras", [&](std::size_t i) {
      try {
        tried[i] = tryKind(*kinds[i]);
      } catch (const std::invalid_argument& e) {
        why[i] = e.what();
      }
    });
    std::vector<Squares> squares;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      if (!tried[i]) {
        selection_.failed.emplace_back(kinds[i]->id, why[i]);
        continue;
      }
      selection_.kinds.push_back(tried[i]->result);
      squares.push_back(tried[i]->squares);
    }
    if (selection_.kinds.empty()) throw std::invalid_argument(selection_.failed.front().second);
    choose(squares);
    const CameraFit& chosen = selection_.kinds[selection_.chosen].fit;
    selection_.grid = gridFor(chosen);
    Random random = Random::stream(options_.seed, 1);
    selection_.sigma_px = projectionSigma(chosen, selection_.grid, random);
    selection_.opencv_heldout_rms_px =
        std::sqrt(meanOf(heldOutSquares(judged_, has_water_, options_.folds,
                                        [&](const auto& fitted) { return fitByOpenCv(fitted, setting_); })));
    return selection_;
  }

 private:
  struct Tried {
    KindResult result;
    Squares squares;
  };

  std::vector<const CameraKind*> kindsToTry() const {
    std::vector<const CameraKind*> kinds;
    for (const CameraKind& kind : cameraKinds())
      if (options_.kinds.empty() && (has_water_ || kind.port == CameraKind::Port::none))
        kinds.push_back(&kind);
    for (const std::string& id : options_.kinds) {
      const CameraKind* kind = findCameraKind(id);
      if (kind == nullptr) throw std::invalid_argument("no such kind of camera: " + id);
      if (!has_water_ && kind->port != CameraKind::Port::none)
        throw std::invalid_argument(id + " asks for views under water");
      kinds.push_back(kind);
    }
    return kinds;
  }

  const std::vector<BoardView>& viewsFor(const CameraKind& kind) const {
    return kind.port == CameraKind::Port::none ? judged_ : views_;
  }

  Tried tryKind(const CameraKind& kind) const {
    const std::vector<BoardView>& views = viewsFor(kind);
    Tried tried;
    const bool is_without_port = kind.port == CameraKind::Port::none;
    tried.result.fit =
        fitCamera(views, kind, setting_, is_without_port ? selection_.by_opencv : std::nullopt);
    const auto again = [&](const std::vector<BoardView>& some) {
      return fitCamera(some, kind, setting_, tried.result.fit);
    };
    tried.squares = heldOutSquares(views, has_water_, options_.folds, again);
    tried.result.heldout_rms_px = std::sqrt(meanOf(tried.squares));
    compareHalves(views, again, tried.result);
    return tried;
  }

  template <class Fit>
  void compareHalves(const std::vector<BoardView>& views, const Fit& fit, KindResult& result) const {
    std::array<std::vector<BoardView>, 2> halves;
    for (std::size_t i = 0; i < views.size(); ++i) halves[i % 2].push_back(views[i]);
    const CameraFit a = fit(halves[0]), b = fit(halves[1]);
    const ProjectionGrid grid = gridFor(result.fit);
    Random random = Random::stream(options_.seed, 2);
    const std::vector<double> sigma_a = projectionSigma(a, grid, random),
                              sigma_b = projectionSigma(b, grid, random);
    double squares = 0, expected = 0;
    const std::vector<Vector2d> off = projectionDifference(a, b, grid);
    for (std::size_t i = 0; i < off.size(); ++i) {
      squares += off[i].squaredNorm();
      expected += 2 * (sigma_a[i] * sigma_a[i] + sigma_b[i] * sigma_b[i]);
    }
    const auto count = static_cast<double>(off.size());
    result.halves_px = std::sqrt(squares / count);
    result.halves_sigma_px = std::sqrt(expected / count);
  }

  ProjectionGrid gridFor(const CameraFit& fit) const {
    return gridOver(setting_, options_.range_m > 0 ? options_.range_m : medianRange(fit, judged_),
                    has_water_);
  }

  /// Numbers that it takes to see in air and in water: without a port, a lens for each.
  std::size_t unknownsForAll(const CameraFit& fit) const {
    const bool needs_two = judged_.size() < views_.size() && fit.kind->port == CameraKind::Port::none;
    return fit.unknowns.size() * (needs_two ? 2 : 1);
  }

  /// The simplest that the best is not clearly better than, by what differs view by view.
  void choose(const std::vector<Squares>& squares) {
    std::vector<KindResult>& kinds = selection_.kinds;
    const auto best = static_cast<std::size_t>(std::min_element(kinds.begin(), kinds.end(),
                                                                [](const KindResult& a, const KindResult& b) {
                                                                  return a.heldout_rms_px < b.heldout_rms_px;
                                                                }) -
                                               kinds.begin());
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      double sum = 0, square = 0;
      for (const auto& [view, of_best] : squares[best]) {
        const double more = squares[i].at(view) - of_best;
        sum += more, square += more * more;
      }
      const auto count = static_cast<double>(squares[best].size());
      kinds[i].worse_px2 = sum / count;
      kinds[i].worse_sigma_px2 = std::sqrt(std::max(0.0, square / count - std::pow(sum / count, 2)) / count);
    }
    selection_.chosen = best;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      const bool is_as_good = kinds[i].worse_px2 <= kClearly * kinds[i].worse_sigma_px2;
      if (is_as_good && unknownsForAll(kinds[i].fit) < unknownsForAll(kinds[selection_.chosen].fit))
        selection_.chosen = i;
    }
  }

  const std::vector<BoardView>& views_;
  const CameraSetting& setting_;
  const SelectionOptions& options_;
  bool has_water_ = false;
  std::vector<BoardView> judged_;
  CameraSelection selection_;
};

}  // namespace

CameraSelection selectCamera(const std::vector<BoardView>& views, const CameraSetting& setting,
                             const SelectionOptions& options) {
  return Selection(views, setting, options).run();
}

}  // namespace fathom
