#include "render/renderer.h"

#include <algorithm>
#include <array>
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
  Lens lens;
  int width, height;
  PixelSampler sampler;
  VisibilityBuffer visibility;
  Surface scene;
  std::vector<std::uint32_t> face_of;  // by triangle

  // Of the view being rendered
  Pose T_camera_odom;
  std::optional<SeenLighting> lighting;
  std::vector<std::optional<SeenTriangle>> seen;  // by triangle, once it is needed
  const std::uint32_t* triangles = nullptr;       // by raster sample
  std::vector<std::uint32_t> faces;               // by raster sample
  std::vector<std::uint32_t> inner;               // by raster sample: its triangle, or kEdge
  std::vector<std::uint32_t> row_triangles;       // by pixel of a row: the triangle that fills it

  Implementation(const CameraModel& camera, const Options& options)
      : lens(camera),
        width(camera.width_px),
        height(camera.height_px),
        sampler(options.supersampling),
        visibility(lens.raster),
        faces(lens.raster.size()),
        inner(lens.raster.size()),
        row_triangles(static_cast<std::size_t>(width)) {}

  const SeenTriangle& seenTriangle(std::uint32_t number) {
    auto& triangle = seen[number];
    if (!triangle) triangle.emplace(scene, number - 1, T_camera_odom);
    return *triangle;
  }

  void findEdges();
  std::uint32_t renderIfShared(std::size_t pixel, float* radiance, float* range_m);
  void renderRow(int row, float* radiance, float* range_m);
};

/// Sets apart the raster samples that have another face among their eight neighbours.
void Renderer::Implementation::findEdges() {
  const auto columns = static_cast<std::size_t>(lens.raster.columns);
  const auto rows = static_cast<std::size_t>(lens.raster.rows);
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = face_of[triangles[i]];
  for (std::size_t row = 1; row + 1 < rows; ++row) {
    const std::uint32_t* above = &faces[(row - 1) * columns];
    const std::uint32_t* here = above + columns;
    const std::uint32_t* below = here + columns;
    const std::uint32_t* triangle = triangles + row * columns;
    std::uint32_t* out = &inner[row * columns];
    for (std::size_t i = 1; i + 1 < columns; ++i) {
      const std::uint32_t face = here[i];
      const std::uint32_t differences =
          (above[i - 1] ^ face) | (above[i] ^ face) | (above[i + 1] ^ face) | (here[i - 1] ^ face) |
          (here[i + 1] ^ face) | (below[i - 1] ^ face) | (below[i] ^ face) | (below[i + 1] ^ face);
      out[i] = differences == 0 ? triangle[i] : kEdge;
    }
  }
}

/// Returns the triangle that fills a pixel near an edge, or renders the pixel.
std::uint32_t Renderer::Implementation::renderIfShared(std::size_t pixel, float* radiance, float* range_m) {
  const PixelSquare square = lens.square(pixel);
  std::array<std::uint32_t, 9> numbers{};
  std::array<TriangleInPixel, 9> in_pixel;
  std::size_t distinct = 0, count = 0;
  bool nothing_behind = false;
  std::uint32_t filling = kNothing;
  const std::uint32_t* samples = triangles + lens.nearest[pixel] - lens.raster.columns - 1;
  for (int row = 0; row < 3; ++row, samples += lens.raster.columns)
    for (int column = 0; column < 3; ++column) {
      const std::uint32_t number = samples[column];
      nothing_behind |= number == kNothing;
      const auto known = numbers.begin() + static_cast<std::ptrdiff_t>(distinct);
      if (number == kNothing || std::find(numbers.begin(), known, number) != known) continue;
      numbers[distinct++] = number;
      in_pixel[count] = TriangleInPixel(seenTriangle(number), square);
      if (in_pixel[count].missesPixel()) continue;
      if (in_pixel[count].fillsPixel()) filling = number;
      ++count;
    }
  if (count == 1 && filling != kNothing) return filling;
  const bool hit = sampler.sample(square, in_pixel.data(), static_cast<int>(count), nothing_behind, *lighting,
                                  radiance, range_m);
  if (hit) return kRendered;
  return nothing_behind ? kNothing : triangles[lens.nearest[pixel]];
}

/// Runs of pixels that one triangle fills are shaded together.
void Renderer::Implementation::renderRow(int row, float* radiance, float* range_m) {
  const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
  for (int u = 0; u < width; ++u) {
    const std::size_t pixel = first + static_cast<std::size_t>(u);
    std::uint32_t& triangle = row_triangles[static_cast<std::size_t>(u)];
    triangle = inner[lens.nearest[pixel]];
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
  implementation_ = std::make_unique<Implementation>(camera, options);
  setScene({});
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
  r.seen.assign(r.face_of.size(), std::nullopt);
  r.triangles = r.visibility.draw(r.T_camera_odom).data();
  r.findEdges();
  view.radiance.create(r.height, r.width, CV_32FC3);
  view.range_m.create(r.height, r.width, CV_32FC1);
  for (int row = 0; row < r.height; ++row)
    r.renderRow(row, view.radiance.ptr<float>(row), view.range_m.ptr<float>(row));
}

}  // namespace fathom
