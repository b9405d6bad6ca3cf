#include "panel/mesh.h"

// MeshIO comes before the mesh type, as OpenMesh demands.
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <cmath>
#include <cstdio>
#include <mutex>

#include "core/error.h"
#include "panel/obj_outline.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

using PolyMesh = OpenMesh::PolyMesh_ArrayKernelT<>;
using Face = PolyMesh::FaceHandle;

constexpr double kSmallest_m = 0.01, kLargest_m = 20.0;
constexpr double kNoArea_m2 = 1e-12;  // a micrometre square: floats of metres end there

/// An OBJ as OpenMesh reads it. Its faces are those of the outline, one by one.
struct ObjFile {
  fs::path file;
  ObjOutline outline;
  PolyMesh mesh;

  const ObjFace& outlineOf(Face face) const { return outline.faces[static_cast<std::size_t>(face.idx())]; }
  Error error(Face face, const std::string& why) const {
    return {file.string(), "line " + std::to_string(outlineOf(face).line), why};
  }
};

PolyMesh readByOpenMesh(const fs::path& file) {
  // One reader object serves the whole process, and complains on standard error.
  static std::mutex mutex;
  const std::scoped_lock lock(mutex);
  PolyMesh mesh;
  mesh.request_face_status();  // there the reader marks the faces that are not manifold
  omerr().disable();
  const bool done = OpenMesh::IO::read_mesh(mesh, file.string());
  omerr().enable();
  if (!done) throw Error(file.string(), "", "OpenMesh cannot read it as an OBJ file");
  return mesh;
}

ObjFile readObj(const fs::path& file) {
  if (file.extension() != ".obj") throw Error(file.string(), "", "a mesh is a Wavefront OBJ file, NAME.obj");
  ObjFile obj{file, readObjOutline(file), {}};
  if (obj.outline.faces.empty()) throw Error(file.string(), "", "has no faces");
  obj.mesh = readByOpenMesh(file);
  // The reader leaves out what it cannot parse, and says so nowhere. Vertices of faces that are not manifold
  // it makes twice.
  if (obj.mesh.n_faces() != obj.outline.faces.size() ||
      obj.mesh.n_vertices() < static_cast<std::size_t>(obj.outline.vertices))
    throw Error(file.string(), "",
                "OpenMesh reads " + std::to_string(obj.mesh.n_faces()) + " faces of " +
                    std::to_string(obj.outline.faces.size()) + " and " +
                    std::to_string(obj.mesh.n_vertices()) + " vertices of " +
                    std::to_string(obj.outline.vertices));
  return obj;
}

Vector3d positionOf(const PolyMesh& mesh, PolyMesh::VertexHandle vertex) {
  const auto& p = mesh.point(vertex);
  return {p[0], p[1], p[2]};
}

std::vector<Vector3d> cornersOf(const PolyMesh& mesh, Face face) {
  std::vector<Vector3d> corners;
  for (const auto vertex : mesh.fv_range(face)) corners.push_back(positionOf(mesh, vertex));
  return corners;
}

// ---- checks

void checkSize(const ObjFile& obj) {
  Eigen::AlignedBox3d box;
  for (const auto vertex : obj.mesh.vertices()) box.extend(positionOf(obj.mesh, vertex));
  const double size_m = box.sizes().maxCoeff();
  if (size_m >= kSmallest_m && size_m <= kLargest_m) return;
  char why[100];
  std::snprintf(why, sizeof why, "is %.4g m large, where a panel is 0.01 to 20 m: is its unit the metre?",
                size_m);
  throw Error(obj.file.string(), "", why);
}

/// How a face that OpenMesh could not join to the others disagrees with them.
std::string whyNotManifold(const ObjOutline& outline, std::size_t face) {
  const auto uses = [](const ObjFace& f, int from, int to) {
    for (std::size_t i = 0; i < f.corners.size(); ++i)
      if (f.corners[i] == from && f.corners[(i + 1) % f.corners.size()] == to) return true;
    return false;
  };
  const auto& corners = outline.faces[face].corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int from = corners[i], to = corners[(i + 1) % corners.size()];
    int sharing = 0, same_way_line = 0;
    for (const ObjFace& other : outline.faces) {
      const bool same_way = uses(other, from, to);
      if (same_way && other.line < outline.faces[face].line) same_way_line = other.line;
      sharing += same_way || uses(other, to, from) ? 1 : 0;
    }
    const std::string edge = "edge " + std::to_string(from + 1) + " " + std::to_string(to + 1);
    if (sharing > 2) return edge + " is shared by " + std::to_string(sharing) + " faces: not manifold";
    if (same_way_line > 0) return "turned against its neighbour in line " + std::to_string(same_way_line);
  }
  return "touches other faces in a single vertex: not manifold";
}

void checkManifold(const ObjFile& obj) {
  for (const Face face : obj.mesh.faces())
    if (obj.mesh.status(face).fixed_nonmanifold())
      throw obj.error(face, whyNotManifold(obj.outline, static_cast<std::size_t>(face.idx())));
  for (const auto vertex : obj.mesh.vertices())
    if (!obj.mesh.is_isolated(vertex) && !obj.mesh.is_manifold(vertex))
      throw obj.error(*obj.mesh.cvf_iter(vertex), "vertex " + std::to_string(vertex.idx() + 1) +
                                                      " joins faces that share no edge: not manifold");
}

/// The face's triangles, a fan, must all look the same way.
void checkFaces(const ObjFile& obj) {
  for (const Face face : obj.mesh.faces()) {
    const auto corners = cornersOf(obj.mesh, face);
    Vector3d first_normal = Vector3d::Zero();
    for (std::size_t i = 2; i < corners.size(); ++i) {
      const Vector3d twice_area = (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
      if (twice_area.norm() < 2 * kNoArea_m2) throw obj.error(face, "the face has no area");
      if (i == 2) first_normal = twice_area.normalized();
      if (first_normal.dot(twice_area.normalized()) < 0.999)
        throw obj.error(face, "the face is not plane and convex: make triangles of it");
    }
  }
}

/// The connected piece that each face belongs to, counted from 0.
std::vector<int> piecesOf(const PolyMesh& mesh) {
  std::vector<int> piece(mesh.n_faces(), -1);
  int pieces = 0;
  for (const Face first : mesh.faces()) {
    if (piece[static_cast<std::size_t>(first.idx())] >= 0) continue;
    std::vector<Face> open{first};
    while (!open.empty()) {
      const Face face = open.back();
      open.pop_back();
      int& mine = piece[static_cast<std::size_t>(face.idx())];
      if (mine >= 0) continue;
      mine = pieces;
      for (const auto neighbour : mesh.ff_range(face)) open.push_back(neighbour);
    }
    ++pieces;
  }
  return piece;
}

/// A closed piece encloses a positive volume (divergence theorem). An open one has no inside.
void checkInsideOut(const ObjFile& obj, const std::vector<int>& piece) {
  struct Piece {
    double volume_m3 = 0.0;
    bool closed = true;
    Face first;
  };
  std::vector<Piece> pieces(piece.size());
  for (const Face face : obj.mesh.faces()) {
    Piece& mine = pieces[static_cast<std::size_t>(piece[static_cast<std::size_t>(face.idx())])];
    if (!mine.first.is_valid()) mine.first = face;
    if (obj.mesh.is_boundary(face)) mine.closed = false;
    const auto corners = cornersOf(obj.mesh, face);
    for (std::size_t i = 2; i < corners.size(); ++i)
      mine.volume_m3 += corners[0].dot(corners[i - 1].cross(corners[i])) / 6.0;
  }
  for (const Piece& p : pieces)
    if (p.first.is_valid() && p.closed && p.volume_m3 < 0.0)
      throw obj.error(p.first, "the piece that begins here is inside out: all its faces look inwards");
}

void addFace(const std::vector<Vector3d>& corners, const Eigen::Vector3f& albedo, Surface& surface) {
  const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  const auto first = static_cast<std::uint32_t>(surface.vertices.size());
  for (const auto& corner : corners)
    surface.vertices.push_back({corner.cast<float>(), normal.cast<float>(), albedo});
  for (std::uint32_t i = 2; i < corners.size(); ++i)
    surface.triangles.push_back({first, first + i - 1, first + i});
}

}  // namespace

Mesh readMesh(const fs::path& file, const std::set<std::string>& left_out) {
  const ObjFile obj = readObj(file);
  checkSize(obj);
  checkManifold(obj);
  checkFaces(obj);
  const std::vector<int> piece = piecesOf(obj.mesh);
  checkInsideOut(obj, piece);

  Mesh result;
  std::set<std::string> materials;
  std::set<int> pieces;
  for (const Face face : obj.mesh.faces()) {
    const ObjFace& outline = obj.outlineOf(face);
    if (left_out.contains(outline.object)) continue;
    addFace(cornersOf(obj.mesh, face), obj.outline.albedo.at(outline.material), result.surface);
    materials.insert(outline.material);
    pieces.insert(piece[static_cast<std::size_t>(face.idx())]);
  }
  result.materials.assign(materials.begin(), materials.end());
  result.components = static_cast<int>(pieces.size());
  return result;
}

}  // namespace fathom
