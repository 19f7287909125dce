// Adding visuals and meshes to a scene.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/scene_meshes.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/meshes/read_mesh.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {

/// The meshes of a URDF: each file is read once.
class SceneMeshes {
 public:
  SceneMeshes(const MeshPlaces& places, RobotScene& scene) : places_(places), scene_(scene) {}

  /// Index of a mesh; negative if it cannot be drawn.
  [[nodiscard]] int index(const std::string& name) {
    const auto [known, is_new] = by_name_.try_emplace(name, -1);
    if (!is_new) return known->second;
    try {
      const std::filesystem::path file = find_mesh(name, places_);
      const auto [of_file, is_new_file] =
          by_file_.try_emplace(file.string(), static_cast<int>(scene_.meshes.size()));
      if (is_new_file) {
        try {
          scene_.meshes.push_back(read_mesh(file));
        } catch (const MeshError&) {
          of_file->second = -1;
          throw;
        }
      }
      known->second = of_file->second;
    } catch (const MeshError& e) {
      failed_[e.what()].push_back(name);
    }
    return known->second;
  }

  /// One warning for each reason.
  void warn(const std::string& urdf, Diagnostics& diagnostics) const {
    constexpr std::size_t kLongest = 200;  // bytes of a name
    for (const auto& [why, names] : failed_) {
      std::string text = "mesh '" + printable(names.front().substr(0, kLongest)) + "'";
      const std::size_t others = names.size() - 1;
      if (others > 0) {
        text += " (and " + std::to_string(others) + (others == 1 ? " other)" : " others)");
      }
      diagnostics.warning({urdf, 0}, text + " is not drawn: it " + why);
    }
  }

 private:
  const MeshPlaces& places_;
  RobotScene& scene_;
  std::map<std::string, int> by_name_, by_file_;
  std::map<std::string, std::vector<std::string>> failed_;  ///< names by reason
};

/// Triangles and bytes of all meshes.
[[nodiscard]] inline std::pair<std::size_t, std::size_t> size_of(const std::vector<Mesh>& meshes) {
  std::size_t triangles = 0, numbers = 0;
  for (const Mesh& mesh : meshes) {
    triangles += mesh.num_triangles();
    numbers += mesh.vertices.size() + mesh.triangles.size();
  }
  return {triangles, 4 * numbers};
}

/// Simplifies all meshes in proportion, so that they fit.
inline void thin_meshes(const MeshBudget& budget, std::vector<Mesh>& meshes) {
  constexpr std::size_t kLeast = 100;  // triangles: a link stays recognizable
  const std::vector<Mesh> whole = meshes;
  const auto [all, bytes] = size_of(whole);
  double share = 1.0;
  const auto fits = [&] {
    const auto [triangles, size] = size_of(meshes);
    return triangles <= budget.triangles && size <= budget.bytes;
  };
  for (int round = 0; !fits() && round < 40; ++round) {
    share = round == 0 ? std::min(static_cast<double>(budget.triangles) / static_cast<double>(all),
                                  static_cast<double>(budget.bytes) / static_cast<double>(bytes))
                       : 0.8 * share;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      const auto most =
          static_cast<std::size_t>(share * static_cast<double>(whole[i].num_triangles()));
      meshes[i] = thinned(whole[i], round < 20 ? std::max(kLeast, most) : most);
    }
  }
}

}  // namespace detail

void add_visuals(std::span<const Visual> visuals, const MeshPlaces& places, const std::string& name,
                 RobotScene& scene, Diagnostics& diagnostics, const MeshBudget& budget) {
  std::map<std::string, SceneLink*> links;
  for (SceneLink& link : scene.links) links.emplace(link.name, &link);
  detail::SceneMeshes meshes(places, scene);
  for (const Visual& visual : visuals) {
    const auto link = links.find(visual.link);
    if (link == links.end()) continue;
    SceneVisual shown{visual};
    if (visual.shape == VisualShape::mesh) {
      shown.mesh = meshes.index(visual.mesh);
      if (shown.mesh < 0) continue;
    }
    link->second->visuals.push_back(std::move(shown));
  }
  meshes.warn(name, diagnostics);
  detail::thin_meshes(budget, scene.meshes);
}

}  // namespace kinecal
