// Definitions of read_mesh.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/meshes/read_mesh.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "kinecal/files/meshes/dae_mesh.ipp"
#include "kinecal/files/meshes/obj_mesh.ipp"
#include "kinecal/files/meshes/stl_mesh.ipp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {

/// Copies triangles and the vertices that they use.
class MeshCopy {
 public:
  explicit MeshCopy(const Mesh& from) : from_(from), place_(from.num_vertices(), kNone) {}

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t vertex : {a, b, c}) {
      std::uint32_t& place = place_[vertex];
      if (place == kNone) {
        place = static_cast<std::uint32_t>(to_.num_vertices());
        const auto first = from_.vertices.begin() + std::ptrdiff_t{3} * vertex;
        to_.vertices.insert(to_.vertices.end(), first, first + 3);
      }
      to_.triangles.push_back(place);
    }
  }
  [[nodiscard]] Mesh take() { return std::move(to_); }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  const Mesh& from_;
  Mesh to_;
  std::vector<std::uint32_t> place_;  ///< of each vertex in the copy
};

Mesh cleaned(const Mesh& mesh) {
  // Millimetres are allowed, but at most a kilometre in them: squares of larger numbers overflow.
  constexpr float kFar = 1e6F;
  const auto good = [&](std::uint32_t vertex) {
    if (vertex >= mesh.num_vertices()) return false;
    const float* p = &mesh.vertices[std::size_t{3} * vertex];
    return std::all_of(p, p + 3, [](float x) { return std::abs(x) <= kFar; });
  };
  MeshCopy copy(mesh);
  for (std::size_t t = 0; t < mesh.num_triangles(); ++t) {
    const std::uint32_t a = mesh.triangles[3 * t], b = mesh.triangles[3 * t + 1],
                        c = mesh.triangles[3 * t + 2];
    if (a != b && b != c && c != a && good(a) && good(b) && good(c)) copy.add(a, b, c);
  }
  return copy.take();
}

/// The mesh with one vertex per cell of a grid: the first one in it.
/// @param cells  along the longest side of the mesh
[[nodiscard]] inline Mesh clustered(const Mesh& mesh, int cells) {
  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::max());
  high.fill(std::numeric_limits<float>::lowest());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], mesh.vertices[i]);
    high[i % 3] = std::max(high[i % 3], mesh.vertices[i]);
  }
  float side = 0.0F;
  for (std::size_t k = 0; k < 3; ++k) side = std::max(side, high[k] - low[k]);
  if (!(side > 0.0F)) return {};
  std::unordered_map<std::uint32_t, std::uint32_t> first;  // by cell: ten bits per side
  std::vector<std::uint32_t> stand_in;
  for (std::uint32_t v = 0; v < mesh.num_vertices(); ++v) {
    std::uint32_t cell = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float place = (mesh.vertices[std::size_t{3} * v + k] - low[k]) / side;
      cell = cell << 10U | static_cast<std::uint32_t>(place * static_cast<float>(cells));
    }
    stand_in.push_back(first.emplace(cell, v).first->second);
  }
  Mesh merged{mesh.vertices, {}};
  std::set<std::array<std::uint32_t, 3>> known;  // triangles may coincide
  for (std::size_t t = 0; t < mesh.num_triangles(); ++t) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = stand_in[mesh.triangles[3 * t + k]];
    std::array<std::uint32_t, 3> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) continue;
    if (!known.insert(sorted).second) continue;
    merged.triangles.insert(merged.triangles.end(), corners.begin(), corners.end());
  }
  return cleaned(merged);
}

/// The bytes of a file.
[[nodiscard]] inline std::string mesh_bytes(const std::filesystem::path& file,
                                            std::uintmax_t most) {
  std::error_code wrong;
  const std::uintmax_t size = std::filesystem::file_size(file, wrong);
  if (wrong) throw MeshError("cannot be read: " + wrong.message());
  if (size > most) {
    throw MeshError("has " + std::to_string(size >> 20) + " MB; at most " +
                    std::to_string(most >> 20) + " MB are drawn");
  }
  std::ifstream in(file, std::ios::binary);
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!in) throw MeshError("cannot be read");
  return bytes;
}

Mesh mesh_of(const std::string& bytes, const std::string& type) {
  if (type == "stl") return stl_mesh(bytes);
  if (type == "dae") return dae_mesh(bytes);
  if (type == "obj") return obj_mesh(bytes);
  throw MeshError("is a ." + printable(type) + " file; STL, DAE and OBJ are drawn");
}

}  // namespace detail

Mesh thinned(const Mesh& mesh, std::size_t triangles) {
  if (mesh.num_triangles() <= triangles) return mesh;
  // A surface meets about the square of the cells along a side.
  const double most = std::min(512.0, 2.0 * std::sqrt(static_cast<double>(triangles)));
  for (int cells = static_cast<int>(most); cells > 1; cells = cells * 4 / 5) {
    Mesh coarse = detail::clustered(mesh, cells);
    if (coarse.num_triangles() <= triangles) return coarse;
  }
  return {};
}

Mesh read_mesh(const std::filesystem::path& file, const MeshLimits& limits) {
  std::string type = file.extension().string();
  std::transform(type.begin(), type.end(), type.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (!type.empty()) type.erase(0, 1);
  const std::string bytes = detail::mesh_bytes(file, limits.bytes);
  const Mesh mesh = detail::cleaned(detail::mesh_of(bytes, type));
  if (mesh.triangles.empty()) throw MeshError("has no triangles");
  return thinned(mesh, limits.triangles);
}

}  // namespace kinecal
