// Feeds the readers of meshes with damaged files.  The first byte says which reader: s(tl), d(ae) or
// o(bj).  What is read and cleaned can be drawn, thinned as well.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "kinecal/files/meshes/read_mesh.hpp"

namespace {

using namespace kinecal;

void check(const Mesh& mesh) {
  if (mesh.vertices.size() % 3 != 0 || mesh.triangles.size() % 3 != 0) std::abort();
  for (const std::uint32_t vertex : mesh.triangles) {
    if (vertex >= mesh.num_vertices()) std::abort();
  }
  for (const float number : mesh.vertices) {
    if (!std::isfinite(number)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const char* type = data[0] == 'd' ? "dae" : data[0] == 'o' ? "obj" : "stl";
  try {
    const Mesh mesh = detail::cleaned(detail::mesh_of(bytes, type));
    check(mesh);
    const Mesh few = thinned(mesh, mesh.num_triangles() / 2);
    check(few);
    if (few.num_triangles() > mesh.num_triangles()) std::abort();
  } catch (const MeshError&) {  // what is expected of most
  }
  return 0;
}
