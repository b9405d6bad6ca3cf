#include "camera_tables/board_corners.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "landmarks/given_corners.h"
#include "panel/marker_family.h"
#include "recording/csv.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFamily = "tag36h11";
constexpr double kRegular = 0.02;  // of a square: so far may points lie off their grid

/// A regular grid of points: corner (c, r) at origin + c right + r down.
struct Grid {
  Vector3d origin = Vector3d::Zero(), right = Vector3d::Zero(), down = Vector3d::Zero();
  int columns = 0, rows = 0;

  double square_m() const { return right.norm(); }
  Vector3d at(double column, double row) const { return origin + column * right + row * down; }
  std::size_t index(int column, int row) const {
    const int place = row * columns + column;
    return static_cast<std::size_t>(place);
  }
  std::size_t corners() const { return index(0, rows); }
};

/// What stands in an image, corner by corner; NaN: not seen.
using Pixels = std::vector<Vector2d>;

/// Whether the rows go down as the camera sees them: the grid's right and down turn as the image's do.
bool seenFromTheFront(const Grid& grid, const Pixels& pixels) {
  double turn = 0;
  for (int r = 0; r + 1 < grid.rows; ++r)
    for (int c = 0; c + 1 < grid.columns; ++c) {
      const Vector2d &at = pixels[grid.index(c, r)], &right = pixels[grid.index(c + 1, r)],
                     &down = pixels[grid.index(c, r + 1)];
      const Vector2d a = right - at, b = down - at;
      if (a.allFinite() && b.allFinite()) turn += a.x() * b.y() - a.y() * b.x();
    }
  return turn > 0;
}

/// The same corners with the rows counted from the other side.
void turnOver(Grid& grid, Pixels& pixels) {
  Pixels turned = pixels;
  for (int r = 0; r < grid.rows; ++r)
    for (int c = 0; c < grid.columns; ++c)
      turned[grid.index(c, r)] = pixels[grid.index(c, grid.rows - 1 - r)];
  grid.origin = grid.at(0, grid.rows - 1);
  grid.down = -grid.down;
  pixels = std::move(turned);
}

/// The top left corners of every second square of every second row: those that stand for markers.
std::vector<std::array<int, 2>> markedSquares(const Grid& grid) {
  std::vector<std::array<int, 2>> squares;
  for (int row = 0; row + 1 < grid.rows; row += 2)
    for (int column = 0; column + 1 < grid.columns; column += 2) squares.push_back({column, row});
  return squares;
}

/// The board with its markers, ids from the first on.
PanelMap boardOf(const Grid& grid, const std::string& name, int first_id) {
  PanelMap board;
  board.name = name;
  const Vector3d x = grid.right.normalized(), y = -grid.down.normalized();
  board.T_odom_panel.rotation << x, y, x.cross(y);
  board.T_odom_panel.position = grid.origin;
  const double s = grid.square_m();
  int id = first_id;
  for (const auto& [column, row] : markedSquares(grid)) {
    Marker marker;
    marker.family = kFamily;
    marker.id = id++;
    marker.size_m = s;
    marker.look.saddle_corners = true;
    marker.T_panel_marker.position = {(column + 0.5) * s, -(row + 0.5) * s, 0};
    board.markers.push_back(marker);
  }
  return board;
}

/// The markers of which all four corners are seen.
std::vector<Detection> squaresOf(const Grid& grid, const Pixels& pixels, int first_id, double sigma_px) {
  std::vector<Detection> squares;
  int id = first_id;
  for (const auto& [c, r] : markedSquares(grid)) {
    const Detection square = givenDetection(kFamily, id++,
                                            {pixels[grid.index(c, r)], pixels[grid.index(c + 1, r)],
                                             pixels[grid.index(c + 1, r + 1)], pixels[grid.index(c, r + 1)]},
                                            sigma_px);
    if (std::all_of(square.corners_px.begin(), square.corners_px.end(),
                    [](const Vector2d& p) { return p.allFinite(); }))
      squares.push_back(square);
  }
  return squares;
}

/// Every corner that is seen.
BoardView viewOf(const std::string& image, const Grid& grid, const Pixels& pixels) {
  BoardView view{image, {}, {}};
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      if (const Vector2d& pixel = pixels[grid.index(column, row)]; pixel.allFinite()) {
        view.points_m.push_back(grid.at(column, row));
        view.pixels.push_back(pixel);
      }
  return view;
}

/// One id a marker is all that the family has.
void requireIds(const TextTable& table, std::size_t markers) {
  const auto ids = static_cast<std::size_t>(markerCount(kFamily));
  if (markers > ids)
    throw Error(table.file.string(), "",
                print("%zu squares for markers, of which there are %zu", markers, ids));
}

BoardCorners numberedCorners(const TextTable& table, const Checkerboard& board, double sigma_px) {
  Grid grid{Vector3d::Zero(), {board.square_m, 0, 0}, {0, board.square_m, 0}, board.columns, board.rows};
  requireIds(table, static_cast<std::size_t>(board.columns / 2) * static_cast<std::size_t>(board.rows / 2));
  std::map<std::string, Pixels> views;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const auto corner = static_cast<std::size_t>(table.wholeNumber(row, 1));
    Pixels& pixels = views[table.rows[row][0]];
    pixels.resize(grid.corners(), Vector2d::Constant(std::nan("")));
    if (corner >= pixels.size())
      throw table.error(row, print("the board has corners 0 to %zu", pixels.size() - 1));
    Vector2d& pixel = pixels[corner];
    if (pixel.allFinite()) throw table.error(row, "this corner is in this image twice");
    pixel = {table.number(row, 2), table.number(row, 3)};
  }
  const bool front = seenFromTheFront(grid, views.begin()->second);
  BoardCorners corners;
  for (auto& [image, pixels] : views) {
    if (seenFromTheFront(grid, pixels) != front)
      throw Error(table.file.string(), "image `" + image + "`", "is a mirror image of others");
    Grid own = grid;
    if (!front) turnOver(own, pixels);
    corners.by_image[image] = squaresOf(own, pixels, 0, sigma_px);
    corners.views.push_back(viewOf(image, own, pixels));
  }
  if (!front) {
    Pixels unused(grid.corners());
    turnOver(grid, unused);
  }
  corners.boards.push_back(boardOf(grid, "board", 0));
  return corners;
}

/// The longest regular grid that begins at a row of the table.
Grid gridFrom(const std::vector<Vector3d>& points, std::size_t first) {
  Grid grid;
  grid.origin = points[first];
  const std::size_t left = points.size() - first;
  if (left < 4) return grid;
  grid.right = points[first + 1] - grid.origin;
  const double tolerance_m = kRegular * grid.square_m();
  const auto lies = [&](std::size_t k, double column, double row) {
    return k < left && (points[first + k] - grid.at(column, row)).norm() < tolerance_m;
  };
  std::size_t columns = 2;
  while (lies(columns, static_cast<double>(columns), 0)) ++columns;
  if (columns >= left) return grid;
  grid.down = points[first + columns] - grid.origin;
  if (std::abs(grid.down.norm() - grid.square_m()) > tolerance_m ||
      std::abs(grid.down.dot(grid.right)) > tolerance_m * grid.square_m())
    return grid;
  std::size_t rows = 0;
  const auto lieInRow = [&](std::size_t row) {
    for (std::size_t column = 0; column < columns; ++column)
      if (!lies(row * columns + column, static_cast<double>(column), static_cast<double>(row))) return false;
    return true;
  };
  while (lieInRow(rows)) ++rows;
  grid.columns = static_cast<int>(columns);
  grid.rows = static_cast<int>(rows);
  return grid;
}

BoardCorners placedCorners(const TextTable& table, double sigma_px) {
  std::vector<Vector3d> points;
  Pixels pixels;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    points.emplace_back(0.001 * table.number(row, 0), 0.001 * table.number(row, 1),
                        0.001 * table.number(row, 2));
    pixels.emplace_back(table.number(row, 3), table.number(row, 4));
  }
  BoardCorners corners;
  corners.views.push_back({table.file.stem().string(), points, pixels});
  std::vector<Detection>& seen = corners.by_image[table.file.stem().string()];
  int id = 0;
  for (std::size_t first = 0; first < points.size();) {
    Grid grid = gridFrom(points, first);
    if (grid.columns < 2 || grid.rows < 2)
      throw table.error(first, "here no regular board begins: points must go row by row");
    const auto count = static_cast<std::ptrdiff_t>(grid.corners());
    const auto begin = pixels.begin() + static_cast<std::ptrdiff_t>(first);
    Pixels own(begin, begin + count);
    if (!seenFromTheFront(grid, own)) turnOver(grid, own);
    corners.boards.push_back(boardOf(grid, print("board%zu", corners.boards.size() + 1), id));
    const std::vector<Detection> squares = squaresOf(grid, own, id, sigma_px);
    seen.insert(seen.end(), squares.begin(), squares.end());
    id += static_cast<int>(corners.boards.back().markers.size());
    first += static_cast<std::size_t>(count);
    requireIds(table, static_cast<std::size_t>(id));
  }
  return corners;
}

}  // namespace

BoardCorners readBoardCorners(const fs::path& file, const std::optional<Checkerboard>& board,
                              double sigma_px) {
  const TextTable table = readTable(file);
  if (table.columns == std::vector<std::string>{"x_mm", "y_mm", "z_mm", "u_px", "v_px"})
    return placedCorners(table, sigma_px);
  if (table.columns != std::vector<std::string>{"image", "corner", "u_px", "v_px"})
    throw Error(file.string(), "line 1", "must be image,corner,u_px,v_px or x_mm,y_mm,z_mm,u_px,v_px");
  if (!board) throw Error("--board", "", "needed: " + file.string() + " numbers the corners");
  return numberedCorners(table, *board, sigma_px);
}

std::vector<BoardView> boardViews(const BoardCorners& corners, const std::string& prefix, bool in_water) {
  std::vector<BoardView> views = corners.views;
  for (BoardView& view : views) {
    view.name = prefix + "/" + view.name;
    view.in_water = in_water;
  }
  return views;
}

}  // namespace fathom
