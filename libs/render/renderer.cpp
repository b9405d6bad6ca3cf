#include "render/renderer.h"

#include <tbb/concurrent_queue.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/parallel.h"
#include "render/faces.h"
#include "render/lens.h"
#include "render/pixel.h"
#include "render/shading.h"
#include "render/visibility.h"

namespace fathom {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kNothing = 0;  // instead of a triangle's number, counted from 1
constexpr std::uint32_t kEdge = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kRendered = kEdge - 1;

/// Rows of pixels that are rendered from one drawing, and the rows of the raster around them; the ends are
/// the first that are not.
struct Band {
  int first = 0, end = 0;                // pixels
  int first_sample = 0, end_sample = 0;  // of the raster

  std::size_t samples(const Raster& raster) const {
    return static_cast<std::size_t>(end_sample - first_sample) * static_cast<std::size_t>(raster.columns);
  }
};

Band bandOf(int row, const Lens& lens) {
  const auto begin = lens.block.begin() + static_cast<std::ptrdiff_t>(row) * lens.camera.width_px;
  const auto [low, high] = std::minmax_element(begin, begin + lens.camera.width_px);
  const auto columns = static_cast<std::uint32_t>(lens.raster.columns);
  return {row, row + 1, static_cast<int>(*low / columns),
          static_cast<int>(*high / columns) + lens.block_side};
}

/// As few as have at most so many samples each.
std::vector<Band> bandsOf(const Lens& lens, std::size_t largest) {
  if (lens.raster.size() <= largest) return {{0, lens.camera.height_px, 0, lens.raster.rows}};
  std::vector<Band> bands;
  for (int row = 0; row < lens.camera.height_px; ++row) {
    const Band next = bandOf(row, lens);
    Band both = next;
    if (!bands.empty())
      both = {bands.back().first, next.end, std::min(bands.back().first_sample, next.first_sample),
              std::max(bands.back().end_sample, next.end_sample)};
    if (bands.empty() || both.samples(lens.raster) > largest)
      bands.push_back(next);
    else
      bands.back() = both;
  }
  return bands;
}

int mostRows(const std::vector<Band>& bands) {
  int most = 0;
  for (const Band& band : bands) most = std::max(most, band.end_sample - band.first_sample);
  return most;
}

void checkScene(const Surface& surface) {
  for (const auto& vertex : surface.vertices)
    if (!vertex.position.allFinite() || !vertex.normal.allFinite() || !vertex.albedo.allFinite())
      throw std::invalid_argument("a vertex of the scene is not finite");
  for (const auto& triangle : surface.triangles)
    if (*std::max_element(triangle.begin(), triangle.end()) >= surface.vertices.size())
      throw std::invalid_argument("a triangle of the scene lacks its vertex");
}

/// What of a view all its bands have in common.
struct SeenView {
  const Surface& scene;
  std::uint64_t scene_number;                 // another one for each scene
  const std::vector<std::uint32_t>& face_of;  // by triangle
  const SeenLighting& lighting;
  Pose T_camera_odom;
  View& view;
};

/// Renders bands of a view, one at a time.
class BandPainter {
 public:
  BandPainter(const Lens& lens, const Renderer::Options& options, int most_rows)
      : lens_(lens),
        sampler_(options.supersampling),
        visibility_(lens.raster, most_rows),
        row_triangles_(static_cast<std::size_t>(lens.camera.width_px)) {
    const Band largest{0, 0, 0, most_rows};
    for (auto* of_band : {&faces_, &differs_, &inner_}) of_band->resize(largest.samples(lens.raster));
  }

  void paint(const SeenView& view, const Band& band);

 private:
  const Lens& lens_;
  PixelSampler sampler_;
  VisibilityBuffer visibility_;
  std::uint64_t scene_number_ = 0;  // that `visibility_` has

  // Of the view being rendered
  const SeenView* view_ = nullptr;
  std::vector<std::optional<SeenTriangle>> seen_;  // by triangle, once it is needed

  // Of the band being rendered, by sample
  std::size_t first_sample_ = 0;  // among all of the raster's
  const std::uint32_t* triangles_ = nullptr;
  std::vector<std::uint32_t> faces_;
  std::vector<std::uint32_t> differs_;  // whether its block's first row has an edge
  std::vector<std::uint32_t> inner_;    // a block's first: the triangle in its middle, or kEdge

  // Of a row or a pixel
  std::vector<std::uint32_t> row_triangles_;  // by pixel of a row: the triangle that fills it
  std::vector<std::uint32_t> numbers_;        // of the triangles around a pixel …
  std::vector<TriangleInPixel> in_pixel_;     // … and those of them that are in it

  const SeenTriangle& seenTriangle(std::uint32_t number) {
    auto& triangle = seen_[number];
    if (!triangle) triangle.emplace(view_->scene, number - 1, view_->T_camera_odom);
    return *triangle;
  }

  /// Where a pixel's block begins in the band.
  std::size_t blockOf(std::size_t pixel) const { return lens_.block[pixel] - first_sample_; }
  void draw(const Band& band);
  void findEdges();
  std::uint32_t renderIfShared(std::size_t pixel, SingleSights& shared, float* radiance, float* range_m);
  void renderRow(int row, SingleSights& shared);
};

void BandPainter::paint(const SeenView& view, const Band& band) {
  view_ = &view;
  if (std::exchange(scene_number_, view.scene_number) != view.scene_number) visibility_.setScene(view.scene);
  seen_.assign(view.face_of.size(), std::nullopt);
  draw(band);
  SingleSights shared(view.lighting);
  for (int row = band.first; row < band.end; ++row) renderRow(row, shared);
  shared.finish();
}

void BandPainter::draw(const Band& band) {
  first_sample_ =
      static_cast<std::size_t>(band.first_sample) * static_cast<std::size_t>(lens_.raster.columns);
  triangles_ = visibility_.draw(view_->T_camera_odom, band.first_sample).data();
  findEdges();
}

/// Sets apart the blocks of raster samples that see more than one face.
void BandPainter::findEdges() {
  const auto side = static_cast<std::size_t>(lens_.block_side);
  const auto columns = static_cast<std::size_t>(lens_.raster.columns);
  for (std::size_t i = 0; i < faces_.size(); ++i) faces_[i] = view_->face_of[triangles_[i]];
  std::fill(differs_.begin(), differs_.end(), 0u);
  for (std::size_t k = 1; k < side; ++k)
    for (std::size_t i = 0; i + k < faces_.size(); ++i) differs_[i] |= faces_[i + k] ^ faces_[i];
  const std::size_t middle = side / 2 * (columns + 1), last = (side - 1) * columns;
  for (std::size_t i = 0; i + last + side <= faces_.size(); ++i) {
    std::uint32_t difference = differs_[i];
    for (std::size_t k = columns; k <= last; k += columns)
      difference |= differs_[i + k] | (faces_[i + k] ^ faces_[i]);
    inner_[i] = difference == 0 ? triangles_[i + middle] : kEdge;
  }
}

/// Returns the triangle that fills a pixel near an edge, or renders the pixel.
std::uint32_t BandPainter::renderIfShared(std::size_t pixel, SingleSights& shared, float* radiance,
                                          float* range_m) {
  const PixelSquare square = lens_.square(pixel);
  numbers_.clear();
  in_pixel_.clear();
  bool nothing_behind = false;
  std::uint32_t filling = kNothing;
  const std::uint32_t* samples = triangles_ + blockOf(pixel);
  for (int row = 0; row < lens_.block_side; ++row, samples += lens_.raster.columns)
    for (int column = 0; column < lens_.block_side; ++column) {
      const std::uint32_t number = samples[column];
      nothing_behind |= number == kNothing;
      if (number == kNothing || std::find(numbers_.begin(), numbers_.end(), number) != numbers_.end())
        continue;
      numbers_.push_back(number);
      const TriangleInPixel triangle(seenTriangle(number), square);
      if (triangle.missesPixel()) continue;
      if (triangle.fillsPixel()) filling = number;
      in_pixel_.push_back(triangle);
    }
  if (in_pixel_.size() == 1 && filling != kNothing) return filling;
  const std::vector<PixelPart>& parts = sampler_.sample(square, in_pixel_, nothing_behind);
  if (parts.empty()) return nothing_behind ? kNothing : numbers_.front();
  std::fill_n(radiance, 3, 0.0f);
  for (const PixelPart& part : parts) shared.add(*part.triangle, part.middle, part.share, radiance);
  *range_m = sampler_.range_m();
  return kRendered;
}

/// Runs of pixels that one triangle fills are shaded together.
void BandPainter::renderRow(int row, SingleSights& shared) {
  auto *radiance = view_->view.radiance.ptr<float>(row), *range_m = view_->view.range_m.ptr<float>(row);
  const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(lens_.camera.width_px);
  for (std::size_t u = 0; u < row_triangles_.size(); ++u) {
    const std::size_t pixel = first + u;
    std::uint32_t& triangle = row_triangles_[u];
    triangle = inner_[blockOf(pixel)];
    if (triangle == kEdge) triangle = renderIfShared(pixel, shared, radiance + 3 * u, range_m + u);
  }
  for (auto begin = row_triangles_.begin(), end = begin; begin != row_triangles_.end(); begin = end) {
    const std::uint32_t triangle = *begin;
    end = std::find_if(begin, row_triangles_.end(), [&](std::uint32_t other) { return other != triangle; });
    const auto u = begin - row_triangles_.begin(), count = end - begin;
    const std::size_t pixel = first + static_cast<std::size_t>(u);
    if (triangle == kNothing) {
      std::fill_n(radiance + 3 * u, 3 * count, 0.0f);
      std::fill_n(range_m + u, count, kInfinity);
    } else if (triangle != kRendered) {
      shade(seenTriangle(triangle), view_->lighting, &lens_.x[pixel], &lens_.y[pixel],
            static_cast<int>(count), radiance + 3 * u, range_m + u);
    }
  }
}

}  // namespace

struct Renderer::Implementation {
  std::shared_ptr<const Lens> lens;
  Options options;
  std::vector<Band> bands;
  Surface scene;
  std::uint64_t scene_number = 0;
  std::vector<std::uint32_t> face_of;                          // by triangle
  tbb::concurrent_queue<std::unique_ptr<BandPainter>> idle{};  // as many as bands were painted at once

  Implementation(std::shared_ptr<const Lens> its_lens, const Options& its_options)
      : lens(std::move(its_lens)), options(its_options), bands(bandsOf(*lens, options.drawn_at_once)) {
    idle.push(painter());  // throws now what it throws
  }

  std::unique_ptr<BandPainter> painter() {
    std::unique_ptr<BandPainter> one;
    if (!idle.try_pop(one)) one = std::make_unique<BandPainter>(*lens, options, mostRows(bands));
    return one;
  }
};

Renderer::Renderer(const CameraModel& camera, const Options& options) {
  if (options.supersampling < 1 || options.supersampling > 16)
    throw std::invalid_argument("supersampling must be from 1 to 16");
  implementation_ = std::make_unique<Implementation>(std::make_shared<const Lens>(camera), options);
  setScene({});
}
Renderer::Renderer(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {
  setScene({});
}
Renderer Renderer::another() const {
  const Implementation& r = *implementation_;
  return Renderer(std::make_unique<Implementation>(r.lens, r.options));
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::setScene(Surface surface_odom) {
  checkScene(surface_odom);
  Implementation& r = *implementation_;
  r.scene = std::move(surface_odom);
  r.face_of = facesOf(r.scene);
  ++r.scene_number;
}

View Renderer::render(const Pose& T_odom_camera, const Lighting& lighting) {
  View view;
  render(T_odom_camera, lighting, view);
  return view;
}

void Renderer::render(const Pose& T_odom_camera, const Lighting& lighting, View& view) {
  Implementation& r = *implementation_;
  view.radiance.create(r.lens->camera.height_px, r.lens->camera.width_px, CV_32FC3);
  view.range_m.create(r.lens->camera.height_px, r.lens->camera.width_px, CV_32FC1);
  const Pose T_camera_odom = T_odom_camera.inverse();
  const SeenLighting seen_lighting(lighting, T_camera_odom);
  const SeenView seen{r.scene, r.scene_number, r.face_of, seen_lighting, T_camera_odom, view};
  // A thread that waits here for the others does not begin with another image.
  tbb::this_task_arena::isolate([&] {
    parallelFor(r.bands.size(), [&](std::size_t i) {
      std::unique_ptr<BandPainter> painter = r.painter();
      painter->paint(seen, r.bands[i]);
      r.idle.push(std::move(painter));
    });
  });
}

}  // namespace fathom
