#include "render/renderer.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

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
  const auto begin = lens.block.begin() + static_cast<std::ptrdiff_t>(row) * lens.width;
  const auto [low, high] = std::minmax_element(begin, begin + lens.width);
  const auto columns = static_cast<std::uint32_t>(lens.raster.columns);
  return {row, row + 1, static_cast<int>(*low / columns),
          static_cast<int>(*high / columns) + lens.block_side};
}

/// As few as have at most so many samples each.
std::vector<Band> bandsOf(const Lens& lens, std::size_t largest) {
  if (lens.raster.size() <= largest) return {{0, lens.height, 0, lens.raster.rows}};
  std::vector<Band> bands;
  for (int row = 0; row < lens.height; ++row) {
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

}  // namespace

struct Renderer::Implementation {
  std::shared_ptr<const Lens> shared_lens;
  const Lens& lens = *shared_lens;
  Options options;
  std::vector<Band> bands;
  PixelSampler sampler;
  VisibilityBuffer visibility;
  Surface scene;
  std::vector<std::uint32_t> face_of;  // by triangle

  // Of the view being rendered
  Pose T_camera_odom;
  std::optional<SeenLighting> lighting;
  std::optional<SingleSights> parts_of_pixels;
  std::vector<std::optional<SeenTriangle>> seen;  // by triangle, once it is needed

  // Of the band being rendered, by sample
  std::size_t first_sample = 0;  // among all of the raster's
  const std::uint32_t* triangles = nullptr;
  std::vector<std::uint32_t> faces;
  std::vector<std::uint32_t> differs;  // whether its block's first row has an edge
  std::vector<std::uint32_t> inner;    // a block's first: the triangle in its middle, or kEdge

  // Of a row or a pixel
  std::vector<std::uint32_t> row_triangles;  // by pixel of a row: the triangle that fills it
  std::vector<std::uint32_t> numbers;        // of the triangles around a pixel …
  std::vector<TriangleInPixel> in_pixel;     // … and those of them that are in it

  Implementation(std::shared_ptr<const Lens> its_lens, const Options& its_options)
      : shared_lens(std::move(its_lens)),
        options(its_options),
        bands(bandsOf(lens, options.drawn_at_once)),
        sampler(options.supersampling),
        visibility(lens.raster, mostRows(bands)),
        row_triangles(static_cast<std::size_t>(lens.width)) {
    const Band largest{0, 0, 0, mostRows(bands)};
    for (auto* of_band : {&faces, &differs, &inner}) of_band->resize(largest.samples(lens.raster));
  }

  const SeenTriangle& seenTriangle(std::uint32_t number) {
    auto& triangle = seen[number];
    if (!triangle) triangle.emplace(scene, number - 1, T_camera_odom);
    return *triangle;
  }

  /// Where a pixel's block begins in the band.
  std::size_t blockOf(std::size_t pixel) const { return lens.block[pixel] - first_sample; }
  void draw(const Band& band);
  void findEdges();
  std::uint32_t renderIfShared(std::size_t pixel, float* radiance, float* range_m);
  void renderRow(int row, float* radiance, float* range_m);
};

void Renderer::Implementation::draw(const Band& band) {
  first_sample = static_cast<std::size_t>(band.first_sample) * static_cast<std::size_t>(lens.raster.columns);
  triangles = visibility.draw(T_camera_odom, band.first_sample).data();
  findEdges();
}

/// Sets apart the blocks of raster samples that see more than one face.
void Renderer::Implementation::findEdges() {
  const auto side = static_cast<std::size_t>(lens.block_side);
  const auto columns = static_cast<std::size_t>(lens.raster.columns);
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = face_of[triangles[i]];
  std::fill(differs.begin(), differs.end(), 0u);
  for (std::size_t k = 1; k < side; ++k)
    for (std::size_t i = 0; i + k < faces.size(); ++i) differs[i] |= faces[i + k] ^ faces[i];
  const std::size_t middle = side / 2 * (columns + 1), last = (side - 1) * columns;
  for (std::size_t i = 0; i + last + side <= faces.size(); ++i) {
    std::uint32_t difference = differs[i];
    for (std::size_t k = columns; k <= last; k += columns)
      difference |= differs[i + k] | (faces[i + k] ^ faces[i]);
    inner[i] = difference == 0 ? triangles[i + middle] : kEdge;
  }
}

/// Returns the triangle that fills a pixel near an edge, or renders the pixel.
std::uint32_t Renderer::Implementation::renderIfShared(std::size_t pixel, float* radiance, float* range_m) {
  const PixelSquare square = lens.square(pixel);
  numbers.clear();
  in_pixel.clear();
  bool nothing_behind = false;
  std::uint32_t filling = kNothing;
  const std::uint32_t* samples = triangles + blockOf(pixel);
  for (int row = 0; row < lens.block_side; ++row, samples += lens.raster.columns)
    for (int column = 0; column < lens.block_side; ++column) {
      const std::uint32_t number = samples[column];
      nothing_behind |= number == kNothing;
      if (number == kNothing || std::find(numbers.begin(), numbers.end(), number) != numbers.end()) continue;
      numbers.push_back(number);
      const TriangleInPixel triangle(seenTriangle(number), square);
      if (triangle.missesPixel()) continue;
      if (triangle.fillsPixel()) filling = number;
      in_pixel.push_back(triangle);
    }
  if (in_pixel.size() == 1 && filling != kNothing) return filling;
  const std::vector<PixelPart>& parts = sampler.sample(square, in_pixel, nothing_behind);
  if (parts.empty()) return nothing_behind ? kNothing : numbers.front();
  std::fill_n(radiance, 3, 0.0f);
  for (const PixelPart& part : parts) parts_of_pixels->add(*part.triangle, part.middle, part.share, radiance);
  *range_m = sampler.range_m();
  return kRendered;
}

/// Runs of pixels that one triangle fills are shaded together.
void Renderer::Implementation::renderRow(int row, float* radiance, float* range_m) {
  const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(lens.width);
  for (std::size_t u = 0; u < row_triangles.size(); ++u) {
    const std::size_t pixel = first + u;
    std::uint32_t& triangle = row_triangles[u];
    triangle = inner[blockOf(pixel)];
    if (triangle == kEdge) triangle = renderIfShared(pixel, radiance + 3 * u, range_m + u);
  }
  for (auto begin = row_triangles.begin(), end = begin; begin != row_triangles.end(); begin = end) {
    const std::uint32_t triangle = *begin;
    end = std::find_if(begin, row_triangles.end(), [&](std::uint32_t other) { return other != triangle; });
    const auto u = begin - row_triangles.begin(), count = end - begin;
    const std::size_t pixel = first + static_cast<std::size_t>(u);
    if (triangle == kNothing) {
      std::fill_n(radiance + 3 * u, 3 * count, 0.0f);
      std::fill_n(range_m + u, count, kInfinity);
    } else if (triangle != kRendered) {
      shade(seenTriangle(triangle), *lighting, &lens.x[pixel], &lens.y[pixel], static_cast<int>(count),
            radiance + 3 * u, range_m + u);
    }
  }
}

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
  return Renderer(std::make_unique<Implementation>(r.shared_lens, r.options));
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::setScene(Surface surface_odom) {
  checkScene(surface_odom);
  Implementation& r = *implementation_;
  r.scene = std::move(surface_odom);
  r.face_of = facesOf(r.scene);
  r.visibility.setScene(r.scene);
}

View Renderer::render(const Pose& T_odom_camera, const Lighting& lighting) {
  View view;
  render(T_odom_camera, lighting, view);
  return view;
}

void Renderer::render(const Pose& T_odom_camera, const Lighting& lighting, View& view) {
  Implementation& r = *implementation_;
  r.T_camera_odom = T_odom_camera.inverse();
  r.lighting.emplace(lighting, r.T_camera_odom);
  r.parts_of_pixels.emplace(*r.lighting);
  r.seen.assign(r.face_of.size(), std::nullopt);
  view.radiance.create(r.lens.height, r.lens.width, CV_32FC3);
  view.range_m.create(r.lens.height, r.lens.width, CV_32FC1);
  for (const Band& band : r.bands) {
    r.draw(band);
    for (int row = band.first; row < band.end; ++row)
      r.renderRow(row, view.radiance.ptr<float>(row), view.range_m.ptr<float>(row));
  }
  r.parts_of_pixels->finish();
}

}  // namespace fathom
