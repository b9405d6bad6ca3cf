#include "painted_panel.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "streams.h"

namespace fathom::sealed {
namespace {

using Triangle = TriangleTree::Triangle;

constexpr double kPiece_m = 0.08;  // so fine is what bends
constexpr int kMarkerPieces = 3;   // along each side, likewise
constexpr double kMarkerScatter = 0.003, kUnevenness = 0.005;
constexpr int kClouds = 6;
constexpr double kGrowthCover = 0.6, kGrowthSpread = 0.1, kGrowthPatch_m = 0.03;
const Array3d kGrowthAlbedo(0.08, 0.14, 0.06);  // of a film of algae
constexpr double kRounding = 1e-9;
constexpr int kMarkerSurfaces = 1000;  // numbers from here on are markers'

/// Splits the longest side until all are short.
void addPieces(const Triangle& t, std::vector<Triangle>& pieces) {
  std::size_t longest = 0;
  const auto side = [&](std::size_t i) { return (t[(i + 1) % 3] - t[i]).norm(); };
  for (std::size_t i = 1; i < 3; ++i)
    if (side(i) > side(longest)) longest = i;
  if (side(longest) <= kPiece_m) {
    pieces.push_back(t);
    return;
  }
  const Vector3d &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
  const Vector3d middle = (a + b) / 2;
  addPieces({a, middle, c}, pieces);
  addPieces({middle, b, c}, pieces);
}

}  // namespace

Paint::Paint(const TruePanel& panel, const SealedCase& sealed)
    : albedo_field(
          onPanel(ordinaryField(sealed, kOrdinary.albedo, kOrdinary.albedo_length_m, Stream::albedo))),
      sealed_(sealed) {
  for (const Marker& marker : panel.map().markers) ids_.push_back(marker.id);
  Random random = stream(sealed.seed, Stream::print);
  for (const Marker& marker : panel.map().markers) {
    patterns.push_back(markerPattern(marker.family, marker.id));
    strength.push_back(sealed.rich ? 1 + kMarkerScatter * random.normal() : 1.0);
  }
  if (sealed.ordinary > 0) {
    Random albedo = stream(sealed.seed, Stream::albedo);
    for (double& s : strength) s *= 1 + sealed.ordinary * kOrdinary.marker_albedo * albedo.normal();
  }
  coverGrowth(sealed);
  for (int i = 0; sealed.rich && i < kClouds; ++i) {
    const double wave_rad_m = 2 * std::numbers::pi / random.uniform(0.02, 0.10);
    const double towards_rad = random.uniform(0, std::numbers::pi);
    clouds.push_back({wave_rad_m * Eigen::Vector2d(std::cos(towards_rad), std::sin(towards_rad)),
                      random.uniform(0, 2 * std::numbers::pi)});
  }
}

/// Draws which markers growth covers.
void Paint::coverGrowth(const SealedCase& sealed) {
  const std::size_t count = static_cast<std::size_t>(std::max(0.0, sealed.outsideSize("growth")));
  Random random = stream(sealed.seed, Stream::growth);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < patterns.size(); ++i) order.emplace_back(random.uniform(), i);
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < std::min(count, order.size()); ++k) grown.insert(order[k].second);
  const bool fouled = std::any_of(sealed.effects.begin(), sealed.effects.end(),
                                  [](const HiddenEffect& effect) { return effect.id == "biofouling"; });
  if (count > 0 || fouled) growth_field = onPanel({kGrowthSpread, kGrowthPatch_m, random});
}

Paint::Film Paint::filmOn(std::size_t marker, double t_s) const {
  if (grown.contains(marker)) return {kGrowthCover, kGrowthAlbedo};
  if (!sealed_.find("biofouling", t_s)) return {};
  if (std::lround(sealed_.number("biofouling", "marker_id", t_s)) != ids_[marker]) return {};
  const Array3d albedo = sealed_.vector("biofouling", "growth_albedo", t_s).array();
  return {sealed_.number("biofouling", "covered", t_s), albedo.isZero() ? kGrowthAlbedo : albedo};
}

Array3d Paint::overgrown(std::size_t marker, const Vector3d& point_panel, const Array3d& print,
                         double t_s) const {
  const Film film = filmOn(marker, t_s);
  if (film.cover == 0) return print;
  // Thicker here than there, by the same share of what there is of it.
  const double uneven = growth_field.at(point_panel.x(), point_panel.y()) / kGrowthCover;
  const double cover =
      std::clamp(film.cover * (1 + uneven), 0.5 * film.cover, std::min(1.0, 1.42 * film.cover));
  return (1 - cover) * print + cover * film.albedo;
}

double Paint::evenness(const Vector3d& point_panel) const {
  double sum = 0;
  for (const Cloud& cloud : clouds)
    sum += std::cos(cloud.wave_rad_m.dot(point_panel.head<2>()) + cloud.phase_rad);
  return 1 + kUnevenness * std::sqrt(2.0 / kClouds) * sum + albedo_field.at(point_panel.x(), point_panel.y());
}

PaintedPanel::PaintedPanel(const TruePanel& panel, const Paint& paint, double t_s)
    : panel_(panel), paint_(paint), t_s_(t_s), tree_({}) {
  addBody(triangles_);
  for (std::size_t i = 0; i < panel.map().markers.size(); ++i) addMarker(i, triangles_);
  for (const Triangle& t : triangles_) normals_.push_back((t[1] - t[0]).cross(t[2] - t[0]).normalized());
  tree_ = TriangleTree(triangles_);
}

void PaintedPanel::addBody(std::vector<Triangle>& triangles) {
  const Surface& body = panel_.map().body;
  std::vector<Eigen::Vector3f> colours;
  for (const auto& [a, b, c] : body.triangles) {
    const Eigen::Vector3f& albedo = body.vertices[a].albedo;
    const auto known = std::find(colours.begin(), colours.end(), albedo);
    const int surface = 1 + static_cast<int>(known - colours.begin());
    if (known == colours.end()) colours.push_back(albedo);
    std::vector<Triangle> pieces;
    const auto position = [&](std::uint32_t i) { return Vector3d(body.vertices[i].position.cast<double>()); };
    const Triangle whole{position(a), position(b), position(c)};
    if (panel_.flat())
      pieces = {whole};
    else
      addPieces(whole, pieces);
    for (Triangle& piece : pieces) {
      for (Vector3d& corner : piece) corner = panel_.bent(corner, t_s_);
      triangles.push_back(piece);
      faces_.push_back({-1, surface, albedo.cast<double>(), {}});
    }
  }
}

/// The pattern can reach beyond the border square, which `size_m` is of.
void PaintedPanel::addMarker(std::size_t index, std::vector<Triangle>& triangles) {
  Marker whole = panel_.placed(panel_.map().markers[index], t_s_);
  const MarkerPattern& pattern = paint_.patterns[index];
  whole.size_m *= static_cast<double>(pattern.cells) / pattern.border_cells;
  const auto corners = panel_.placedCorners_panel(whole);
  const auto place = [&](const Eigen::Vector2d& p) {
    return panel_.bent(corners[0] + p.x() * (corners[1] - corners[0]) + p.y() * (corners[3] - corners[0]),
                       t_s_);
  };
  const auto add = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    triangles.push_back({place(a), place(b), place(c)});
    faces_.push_back({static_cast<int>(index), kMarkerSurfaces, Array3d::Zero(), {a, b, c}});
  };
  const int pieces = panel_.flat() ? 1 : kMarkerPieces;
  const double step = 1.0 / pieces;
  for (int row = 0; row < pieces; ++row)
    for (int column = 0; column < pieces; ++column) {
      const Eigen::Vector2d a(column * step, row * step), right(step, 0), down(0, step);
      add(a, a + down, a + right);
      add(a + right, a + down, a + right + down);
    }
}

void PaintedPanel::colour(const TriangleTree::Hit& hit, const Face& face, Sighted& seen) const {
  if (face.marker < 0) {
    seen.surface = face.surface;
    seen.albedo = face.albedo;
    return;
  }
  const auto index = static_cast<std::size_t>(face.marker);
  const MarkerPattern& pattern = paint_.patterns[index];
  const Eigen::Vector2d place =
      (1 - hit.u - hit.v) * face.pattern[0] + hit.u * face.pattern[1] + hit.v * face.pattern[2];
  const auto cell = [&](double share) {
    return std::clamp(static_cast<int>(share * pattern.cells), 0, pattern.cells - 1);
  };
  const bool beside = place.minCoeff() < -kRounding || place.maxCoeff() > 1 + kRounding;
  const bool white = beside || pattern.whiteAt(cell(place.y()), cell(place.x()));
  seen.print = white ? Sighted::Print::white : Sighted::Print::black;
  seen.surface = kMarkerSurfaces + 2 * face.marker + (white ? 1 : 0);
  seen.albedo = Array3d::Constant(paint_.strength[index] *
                                  (white ? panel_.map().white_albedo : panel_.map().black_albedo));
}

Sighted PaintedPanel::along(const Vector3d& origin, const Vector3d& direction) const {
  const auto hit = tree_.first(origin, direction);
  return hit ? sighted(*hit, origin, direction) : Sighted{};
}

Sighted PaintedPanel::beside(const Sighted& seen, const Vector3d& origin, const Vector3d& direction) const {
  if (faces_[seen.triangle].marker < 0) return along(origin, direction);
  const Triangle& t = triangles_[seen.triangle];
  Matrix3d axes;
  axes << t[1] - t[0], t[2] - t[0], -direction;
  const Vector3d place = axes.inverse() * (origin - t[0]);
  return sighted({place.z(), seen.triangle, place.x(), place.y()}, origin, direction);
}

Sighted PaintedPanel::sighted(const TriangleTree::Hit& hit, const Vector3d& origin,
                              const Vector3d& direction) const {
  Sighted seen;
  seen.triangle = hit.triangle;
  colour(hit, faces_[hit.triangle], seen);
  seen.along = hit.along;
  seen.normal_panel = normals_[hit.triangle];
  const Vector3d point_panel = origin + hit.along * direction;
  const int marker = faces_[hit.triangle].marker;
  if (marker >= 0)
    seen.albedo = paint_.overgrown(static_cast<std::size_t>(marker), point_panel, seen.albedo, t_s_);
  seen.albedo *= paint_.evenness(point_panel);
  seen.illumination = panel_.illumination(point_panel, t_s_);
  return seen;
}

}  // namespace fathom::sealed
