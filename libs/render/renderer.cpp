#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>

#include "render/lens.h"
#include "render/shading.h"
#include "render/visibility.h"

namespace fathom {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void checkScene(const Surface& surface) {
  for (const auto& vertex : surface.vertices)
    if (!vertex.position.allFinite() || !vertex.normal.allFinite() || !vertex.albedo.allFinite())
      throw std::invalid_argument("a vertex of the scene is not finite");
  for (const auto& triangle : surface.triangles)
    if (*std::max_element(triangle.begin(), triangle.end()) >= surface.vertices.size())
      throw std::invalid_argument("a triangle of the scene has no such vertex");
}

/// Between triangles of one face (one plane to 10 um, one normal, one albedo) there is no edge to see: each
/// triangle's face is named after its first triangle. Index and value count from 1, as in VisibilityBuffer.
std::vector<std::uint32_t> facesOf(const Surface& surface) {
  std::vector<std::uint32_t> face_of(surface.triangles.size() + 1, 0);
  std::map<std::array<float, 7>, std::uint32_t> faces;
  for (std::uint32_t k = 1; k < face_of.size(); ++k) {
    face_of[k] = k;
    if (!isUniform(surface, k - 1)) continue;
    std::array<long, 3> offsets_10um{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& vertex = surface.vertices[surface.triangles[k - 1][i]];
      offsets_10um[i] =
          std::lround(1e5 * vertex.normal.cast<double>().dot(vertex.position.cast<double>()));
    }
    if (offsets_10um[0] != offsets_10um[1] || offsets_10um[0] != offsets_10um[2]) continue;
    const auto& v = surface.vertices[surface.triangles[k - 1][0]];
    const std::array<float, 7> key{v.normal.x(), v.normal.y(), v.normal.z(), v.albedo.x(),
                                   v.albedo.y(), v.albedo.z(), static_cast<float>(offsets_10um[0])};
    face_of[k] = faces.emplace(key, k).first->second;
  }
  return face_of;
}

/// Samples of a pixel, in pixels from its centre, and the centre itself last. `side`² samples on a sheared
/// grid: seen from any of the image's axes no two coincide, so edges along them are as good as any others.
struct PixelSamples {
  std::vector<float> u, v;

  explicit PixelSamples(int side) {
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) {
        u.push_back((static_cast<float>(i) + (static_cast<float>(j) + 0.5f) / static_cast<float>(side)) /
                        static_cast<float>(side) -
                    0.5f);
        v.push_back((static_cast<float>(j) + (static_cast<float>(i) + 0.5f) / static_cast<float>(side)) /
                        static_cast<float>(side) -
                    0.5f);
      }
    u.push_back(0.0f);
    v.push_back(0.0f);
  }
};

}  // namespace

struct Renderer::Implementation {
  Lens lens;
  int width, height;
  PixelSamples samples;
  VisibilityBuffer visibility;
  Surface scene;
  std::vector<std::uint32_t> face_of;

  // Of the view being rendered
  Pose T_camera_odom;
  std::optional<SeenLighting> lighting;
  std::vector<std::optional<SeenTriangle>> seen;  // by triangle, once it is needed
  const std::uint32_t* triangles = nullptr;       // by raster sample
  std::vector<std::uint32_t> faces;               // by raster sample; kEdge among samples of another face
  std::vector<float> nearness;                    // by pixel sample: largest 1/z so far …
  std::vector<std::int32_t> owner;                // … and whose it is

  static constexpr std::uint32_t kEdge = std::numeric_limits<std::uint32_t>::max();

  Implementation(const CameraModel& camera, const Options& options)
      : lens(camera),
        width(camera.width_px),
        height(camera.height_px),
        samples(options.supersampling),
        visibility(lens.raster),
        nearness(samples.u.size()),
        owner(samples.u.size()) {}

  const SeenTriangle& seenTriangle(std::uint32_t number) {
    auto& triangle = seen[number];
    if (!triangle) triangle.emplace(scene, number - 1, T_camera_odom);
    return *triangle;
  }

  void findFaces();
  void renderRow(int row, float* radiance, float* range_m);
  void renderEdgePixel(std::size_t pixel, float* radiance, float* range_m);
  void findOwners(std::size_t pixel, std::int32_t candidate, const SeenTriangle& triangle);
};

/// Marks the raster samples that have another face among their eight neighbours.
void Renderer::Implementation::findFaces() {
  const auto columns = static_cast<std::size_t>(lens.raster.columns);
  const auto rows = static_cast<std::size_t>(lens.raster.rows);
  std::vector<std::uint32_t> face(columns * rows);
  for (std::size_t i = 0; i < face.size(); ++i) face[i] = face_of[triangles[i]];
  faces.assign(face.size(), kEdge);
  for (std::size_t row = 1; row + 1 < rows; ++row) {
    const std::uint32_t* above = &face[(row - 1) * columns];
    const std::uint32_t* here = above + columns;
    const std::uint32_t* below = here + columns;
    std::uint32_t* out = &faces[row * columns];
    for (std::size_t i = 1; i + 1 < columns; ++i) {
      const std::uint32_t f = here[i];
      const std::uint32_t differences = (above[i - 1] ^ f) | (above[i] ^ f) | (above[i + 1] ^ f) |
                                        (here[i - 1] ^ f) | (here[i + 1] ^ f) | (below[i - 1] ^ f) |
                                        (below[i] ^ f) | (below[i + 1] ^ f);
      out[i] = differences == 0 ? f : kEdge;
    }
  }
}

void Renderer::Implementation::renderRow(int row, float* radiance, float* range_m) {
  const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
  const auto face = [&](int u) { return faces[lens.nearest[first + static_cast<std::size_t>(u)]]; };
  for (int u = 0, end = 0; u < width; u = end) {
    const std::uint32_t here = face(u);
    end = u + 1;
    const std::size_t pixel = first + static_cast<std::size_t>(u);
    if (here == kEdge) {
      renderEdgePixel(pixel, radiance + 3 * u, range_m + u);
      continue;
    }
    while (end < width && face(end) == here) ++end;
    if (here == 0) {
      std::fill(radiance + 3 * u, radiance + 3 * end, 0.0f);
      std::fill(range_m + u, range_m + end, kInfinity);
    } else {
      shade(seenTriangle(here), *lighting, &lens.x[pixel], &lens.y[pixel], end - u, radiance + 3 * u,
            range_m + u);
    }
  }
}

/// Gives the triangle all samples of the pixel that it is the first to be hit in.
void Renderer::Implementation::findOwners(std::size_t pixel, std::int32_t candidate,
                                          const SeenTriangle& triangle) {
  const Vector3d centre(static_cast<double>(lens.x[pixel]), static_cast<double>(lens.y[pixel]), 1.0);
  const Eigen::Vector3f at = (triangle.corner_shares * centre).cast<float>();
  const Eigen::Matrix<float, 3, 2> image_axes = triangle.corner_shares.leftCols<2>().cast<float>();
  const Eigen::Vector3f u = image_axes * Eigen::Vector2f(lens.x_u[pixel], lens.y_u[pixel]);
  const Eigen::Vector3f v = image_axes * Eigen::Vector2f(lens.x_v[pixel], lens.y_v[pixel]);
  for (std::size_t k = 0; k < owner.size(); ++k) {
    const float a = at[0] + u[0] * samples.u[k] + v[0] * samples.v[k];
    const float b = at[1] + u[1] * samples.u[k] + v[1] * samples.v[k];
    const float c = at[2] + u[2] * samples.u[k] + v[2] * samples.v[k];
    const float inverse_depth = a + b + c;
    const bool hit = std::min(a, std::min(b, c)) >= 0.0f && inverse_depth > nearness[k];
    nearness[k] = hit ? inverse_depth : nearness[k];
    owner[k] = hit ? candidate : owner[k];
  }
}

void Renderer::Implementation::renderEdgePixel(std::size_t pixel, float* radiance, float* range_m) {
  std::array<std::uint32_t, 9> candidates{};
  auto last = candidates.begin();
  bool background = false;
  const std::uint32_t* block = triangles + lens.nearest[pixel] - lens.raster.columns - 1;
  for (int row = 0; row < 3; ++row, block += lens.raster.columns)
    for (int column = 0; column < 3; ++column) {
      if (block[column] == 0)
        background = true;
      else if (std::find(candidates.begin(), last, block[column]) == last)
        *last++ = block[column];
    }

  std::fill(nearness.begin(), nearness.end(), 0.0f);
  std::fill(owner.begin(), owner.end(), -1);
  for (auto it = candidates.begin(); it != last; ++it)
    findOwners(pixel, static_cast<std::int32_t>(it - candidates.begin()), seenTriangle(*it));

  // Light of each triangle in the middle of its samples. A sample that none owns belongs to a triangle that no
  // raster sample saw, unless nothing can be seen here: it does not count.
  const std::size_t count = owner.size() - 1;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero(), light;
  float samples_seen = 0, any_range_m = 0;
  for (auto it = candidates.begin(); it != last; ++it) {
    const auto candidate = static_cast<std::int32_t>(it - candidates.begin());
    float hits = 0, u = 0, v = 0;
    for (std::size_t k = 0; k < count; ++k)
      if (owner[k] == candidate) {
        hits += 1;
        u += samples.u[k];
        v += samples.v[k];
      }
    if (hits == 0) continue;
    u /= hits;
    v /= hits;
    const float x = lens.x[pixel] + u * lens.x_u[pixel] + v * lens.x_v[pixel];
    const float y = lens.y[pixel] + u * lens.y_u[pixel] + v * lens.y_v[pixel];
    shade(seenTriangle(*it), *lighting, &x, &y, 1, light.data(), &any_range_m);
    sum += hits * light;
    samples_seen += hits;
  }
  const float weight = 1.0f / (background ? static_cast<float>(count) : std::max(samples_seen, 1.0f));
  for (int c = 0; c < 3; ++c) radiance[c] = weight * sum[c];

  const float x = lens.x[pixel], y = lens.y[pixel];
  *range_m = nearness[count] > 0 ? std::sqrt(x * x + y * y + 1.0f) / nearness[count] : kInfinity;
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
  Implementation& r = *implementation_;
  r.T_camera_odom = T_odom_camera.inverse();
  r.lighting.emplace(lighting, r.T_camera_odom);
  r.seen.assign(r.face_of.size(), std::nullopt);
  r.triangles = r.visibility.draw(r.T_camera_odom).data();
  r.findFaces();
  View view{cv::Mat(r.height, r.width, CV_32FC3), cv::Mat(r.height, r.width, CV_32FC1)};
  for (int row = 0; row < r.height; ++row)
    r.renderRow(row, view.radiance.ptr<float>(row), view.range_m.ptr<float>(row));
  return view;
}

}  // namespace fathom
