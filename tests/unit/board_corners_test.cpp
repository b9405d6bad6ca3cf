// Checkerboard corners taken for markers: wherever the rows begin, the markers are where the corners were.
#include "camera_tables/board_corners.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"
#include "landmarks/given_corners.h"
#include "support/run_program.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

constexpr Checkerboard kChess{8, 6, 0.03};
// What nine digits of a pixel leave.
constexpr double kText_px = 1e-4;

CameraModel chessCamera() { return {1440, 1080, 1200, 1195, 715, 548, -0.2, 0.05, 0.001, -0.0005, 0.0}; }

/// A board in front of the camera, turned this way and that.
Pose chessPose(int view) {
  return {rotationFromYawPitchRoll(0.2 * view, 0.35 * std::sin(2.0 * view), 0.3 * std::cos(3.0 * view)),
          {-0.1 + 0.02 * view, -0.08 + 0.01 * view, 0.5 + 0.05 * view}};
}

/// Its numbered corners; `upward`: row 0 is the one lowest in the image.
std::string numberedTable(int views, bool upward) {
  std::string text = "image,corner,u_px,v_px\n";
  for (int view = 0; view < views; ++view)
    for (int k = 0; k < kChess.columns * kChess.rows; ++k) {
      const int row = upward ? kChess.rows - 1 - k / kChess.columns : k / kChess.columns;
      const Vector3d corner(kChess.square_m * (k % kChess.columns), kChess.square_m * row, 0);
      const Vector2d pixel = chessCamera().project<double>(chessPose(view) * corner);
      text += print("view%d.png,%d,%.9g,%.9g\n", view, k, pixel.x(), pixel.y());
    }
  return text;
}

BoardCorners chessCorners(const std::string& text, const std::optional<Checkerboard>& board = kChess) {
  const fs::path file = test::scratchFolder() / "corners.csv";
  writeTextFile(file, text);
  return readBoardCorners(file, board, 0.1);
}

std::string chessError(const std::string& text, const std::optional<Checkerboard>& board = kChess) {
  try {
    chessCorners(text, board);
  } catch (const Error& e) {
    return std::string(e.what());
  }
  return "";
}

TEST(BoardCorners, MarkersAreWhereTheCornersWere) {
  for (const bool upward : {false, true}) {
    const BoardCorners corners = chessCorners(numberedTable(4, upward));
    ASSERT_EQ(corners.boards.size(), 1U);
    ASSERT_EQ(corners.boards[0].markers.size(), 12U);
    EXPECT_TRUE(corners.boards[0].look().saddle_corners);
    ASSERT_EQ(corners.by_image.size(), 4U);
    const Pose& T_board_panel = corners.boards[0].T_odom_panel;
    EXPECT_NEAR(T_board_panel.rotation.determinant(), 1, 1e-12);
    // The table's y counts from its own row 0: the board as it lies before the camera is that turned over.
    const Pose T_lying_table =
        upward ? Pose{Eigen::Vector3d(1, -1, -1).asDiagonal(), {0, kChess.square_m * (kChess.rows - 1), 0}}
               : Pose{};
    for (int view = 0; view < 4; ++view) {
      const auto& squares = corners.by_image.at(print("view%d.png", view));
      ASSERT_EQ(squares.size(), 12U);
      const Pose T_camera_panel = chessPose(view) * T_lying_table * T_board_panel;
      EXPECT_LT(T_camera_panel.rotation.col(2).z(), 0) << "its face is towards the camera";
      for (const Detection& square : squares)
        for (std::size_t k = 0; k < 4; ++k) {
          const Vector3d corner =
              corners.boards[0].markers[static_cast<std::size_t>(square.id)].corners_panel()[k];
          const Vector2d pixel = chessCamera().project<double>(T_camera_panel * corner);
          EXPECT_LT((pixel - square.corners_px[k]).norm(), kText_px) << upward << " " << square.id;
        }
    }
  }
}

TEST(BoardCorners, SeveralBoardsInOneImage) {
  // A board of 30 mm and one of 20 mm at right angles to it, as in a corner of a tank.
  const Pose T_camera_table = chessPose(1);
  const Pose boards[]{Pose{}, {rotationFromYawPitchRoll(0, radians(60), radians(20)), {0.25, 0.02, 0.1}}};
  std::string text = "x_mm,y_mm,z_mm,u_px,v_px\n";
  const double square_m[]{0.03, 0.02};
  const int columns[]{6, 8}, rows[]{8, 4};
  for (int b = 0; b < 2; ++b)
    for (int k = 0; k < columns[b] * rows[b]; ++k) {
      const int column = k % columns[b], row = k / columns[b];
      const Vector3d p = boards[b] * Vector3d(square_m[b] * column, square_m[b] * row, 0);
      const Vector2d pixel = chessCamera().project<double>(T_camera_table * p);
      text +=
          print("%.9g,%.9g,%.9g,%.9g,%.9g\n", 1000 * p.x(), 1000 * p.y(), 1000 * p.z(), pixel.x(), pixel.y());
    }
  const BoardCorners corners = chessCorners(text, std::nullopt);
  ASSERT_EQ(corners.boards.size(), 2U);
  EXPECT_EQ(corners.boards[0].markers.size(), 12U);
  EXPECT_EQ(corners.boards[1].markers.size(), 8U);
  std::size_t compared = 0;
  for (const Detection& square : corners.by_image.at("corners"))
    for (const PanelMap& board : corners.boards)
      for (const Marker& marker : board.markers)
        for (std::size_t k = 0; marker.id == square.id && k < 4; ++k, ++compared) {
          const Vector3d corner = board.T_odom_panel * marker.corners_panel()[k];
          EXPECT_LT((chessCamera().project<double>(T_camera_table * corner) - square.corners_px[k]).norm(),
                    kText_px);
        }
  EXPECT_EQ(compared, 80U);
}

TEST(BoardCorners, CalibrateTheCameraThatSawThem) {
  const CameraSetting setting{.width_px = 1440, .height_px = 1080};
  const auto views = boardViews(chessCorners(numberedTable(12, false)), "air", false);
  const CameraFit fit = fitByOpenCv(views, setting);
  const CameraModel camera = lensOf(fit.values, *fit.kind, setting);
  // Exact corners in single precision: the reprojection is that of rounding.
  EXPECT_LT(fit.rms_px, 1e-3);
  EXPECT_NEAR(camera.fx_px, chessCamera().fx_px, 0.1);
  EXPECT_NEAR(camera.cy_px, chessCamera().cy_px, 0.1);
  EXPECT_NEAR(camera.k1, chessCamera().k1, 1e-3);
  EXPECT_EQ(views[0].name.rfind("air/", 0), 0u);
  EXPECT_EQ(views[0].pixels.size(), 48u);
  EXPECT_THROW(fitByOpenCv({views[0], views[1]}, setting), std::invalid_argument);
}

TEST(BoardCorners, WrongTablesAreOneLine) {
  const std::string good = numberedTable(1, false);
  EXPECT_NE(chessError("a,b\n1,2\n").find("must be image,corner"), std::string::npos);
  EXPECT_NE(chessError(good, std::nullopt).find("--board"), std::string::npos);
  EXPECT_NE(chessError(good + "view0.png,48,1,1\n").find("line 50: the board has corners 0 to 47"),
            std::string::npos)
      << chessError(good + "view0.png,48,1,1\n");
  EXPECT_NE(chessError(good + "view0.png,3,1,1\n").find("twice"), std::string::npos);
  EXPECT_NE(chessError(good + "view1.png,3,one,1\n").find("not a finite number"), std::string::npos);
  EXPECT_NE(chessError("x_mm,y_mm,z_mm,u_px,v_px\n0,0,0,1,1\n1,0,0,2,2\n0,7,0,1,2\n1,7,0,2,1\n")
                .find("no regular board"),
            std::string::npos);
}

TEST(GivenCorners, AreReadAsTheyWereWritten) {
  const BoardCorners corners = chessCorners(numberedTable(3, false));
  const fs::path file = test::scratchFolder() / "dive_corners.csv";
  writeGivenCorners(file, corners.by_image);
  EXPECT_EQ(cornersBeside(file.parent_path() / "dive.rawlog"), file);
  const Detections read = readGivenCorners(file, "Images");
  ASSERT_EQ(read.by_file.size(), 3U);
  for (const auto& [image, squares] : corners.by_image) {
    const auto* found = read.find(fs::path("Images") / image);
    ASSERT_NE(found, nullptr) << image;
    ASSERT_EQ(found->size(), squares.size());
    for (std::size_t i = 0; i < squares.size(); ++i) {
      EXPECT_EQ((*found)[i].id, squares[i].id);
      EXPECT_NEAR((*found)[i].sigma_px(), 0.1, 1e-9);
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_LT(((*found)[i].corners_px[k] - squares[i].corners_px[k]).norm(), kText_px);
    }
  }
}

TEST(GivenCorners, WrongTablesAreOneLine) {
  const auto complaint = [](const std::string& rows) {
    const fs::path file = test::scratchFolder() / "dive_corners.csv";
    writeTextFile(file, "image,family,id,sigma_px,x0_px,y0_px,x1_px,y1_px,x2_px,y2_px,x3_px,y3_px\n" + rows);
    try {
      readGivenCorners(file, "Images");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(complaint("a.png,tag36h11,3,0.1,1,1,2,1,2,2,1,2\n"), "");
  EXPECT_NE(complaint("a.png,tag,3,0.1,1,1,2,1,2,2,1,2\n").find("line 2: no such family: `tag`"),
            std::string::npos);
  EXPECT_NE(complaint("a.png,tag36h11,3,0,1,1,2,1,2,2,1,2\n").find("greater than zero"), std::string::npos);
  EXPECT_NE(complaint("a.png,tag36h11,-3,0.1,1,1,2,1,2,2,1,2\n").find("whole number"), std::string::npos);
  EXPECT_NE(complaint("a.png,tag36h11,3,0.1,1,1,2,1,2,2,1\n").find("11 fields instead of 12"),
            std::string::npos);
  EXPECT_NE(
      complaint("a.png,tag36h11,3,0.1,1,1,2,1,2,2,1,2\na.png,tag36h11,3,0.1,1,1,2,1,2,2,1,2\n").find("twice"),
      std::string::npos);
}

}  // namespace
}  // namespace fathom
