// STL files: binary, or text.
//
//   binary  80 ignored bytes, number of triangles (uint32), then for each: normal, three corners
//           (float32 x y z), two ignored bytes; little endian
//   text    solid ... vertex x y z ... endsolid
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "kinecal/files/meshes/find_mesh.hpp"
#include "kinecal/files/meshes/mesh.hpp"
#include "kinecal/files/meshes/mesh_numbers.ipp"

namespace kinecal::detail {

/// Adds triangles corner by corner; merges equal corners.
class StlTriangles {
 public:
  void add(const std::array<float, 3>& corner) {
    std::array<std::uint32_t, 3> bits{};  // compares bits, because NaN is not less than anything
    std::memcpy(bits.data(), corner.data(), sizeof bits);
    const auto place = static_cast<std::uint32_t>(mesh_.num_vertices());
    const auto [known, is_new] = known_.try_emplace(bits, place);
    if (is_new) mesh_.vertices.insert(mesh_.vertices.end(), corner.begin(), corner.end());
    mesh_.triangles.push_back(known->second);
  }
  /// The complete triangles.
  [[nodiscard]] Mesh take() {
    mesh_.triangles.resize(mesh_.triangles.size() / 3 * 3);
    return std::move(mesh_);
  }

 private:
  struct Hash {
    std::size_t operator()(const std::array<std::uint32_t, 3>& bits) const {
      std::uint64_t hash = 0;
      for (const std::uint32_t part : bits) hash = (hash ^ part) * 0x9E3779B97F4A7C15U;
      return hash ^ hash >> 32U;
    }
  };

  Mesh mesh_;
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, Hash> known_;
};

inline constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;  // bytes

/// Number of triangles in the header of a binary file.
[[nodiscard]] inline std::uint32_t stl_count(std::string_view bytes) {
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < 4 && bytes.size() >= kStlHeader; ++k) {
    count |= std::uint32_t{static_cast<unsigned char>(bytes[80 + k])} << (8 * k);
  }
  return count;
}

[[nodiscard]] inline Mesh binary_stl(std::string_view bytes) {
  const std::uint64_t count = stl_count(bytes);
  if (bytes.size() < kStlHeader || count > (bytes.size() - kStlHeader) / kStlTriangle) {
    throw MeshError("is cut off, or not an STL file");
  }
  StlTriangles triangles;
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t corner = 1; corner < 4; ++corner) {
      std::array<float, 3> p{};
      std::memcpy(p.data(), bytes.data() + kStlHeader + t * kStlTriangle + 12 * corner, sizeof p);
      triangles.add(p);
    }
  }
  return triangles.take();
}

[[nodiscard]] inline Mesh text_stl(std::string_view text) {
  StlTriangles triangles;
  constexpr std::string_view kVertex = "vertex";
  for (std::size_t at = text.find(kVertex); at != std::string_view::npos; at = text.find(kVertex)) {
    text.remove_prefix(at + kVertex.size());
    std::array<float, 3> p{};
    for (float& number : p) {
      const auto read = next_number<float>(text);
      if (!read) throw MeshError("has a vertex that is not three numbers");
      number = *read;
    }
    triangles.add(p);
  }
  return triangles.take();
}

/// Some programs start binary files with "solid", too: then the size decides.
[[nodiscard]] inline Mesh stl_mesh(std::string_view bytes) {
  const bool fits = bytes.size() >= kStlHeader &&
                    bytes.size() == kStlHeader + std::uint64_t{stl_count(bytes)} * kStlTriangle;
  const bool is_text = bytes.starts_with("solid") && bytes.find("vertex") != std::string_view::npos;
  return !fits && is_text ? text_stl(bytes) : binary_stl(bytes);
}

}  // namespace kinecal::detail
