// Definitions of robot_surface.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/surface/robot_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "kinecal/files/meshes/read_mesh.hpp"
#include "kinecal/files/urdf/visuals.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Adds what is around a circle in the plane of x and y, by rings of corners: {radius, height} of each, from below; a ring
/// without radius is one corner.
void add_rings(std::span<const std::array<double, 2>> rings, Mesh& mesh) {
  constexpr std::uint32_t kSides = 64;  // a radius of 5 cm is exact to 0.06 mm
  const auto first = [&](std::size_t ring) { return static_cast<std::uint32_t>(ring) * kSides; };
  for (const auto& [radius, height] : rings) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSides;
      mesh.vertices.push_back(static_cast<float>(radius * std::cos(angle)));
      mesh.vertices.push_back(static_cast<float>(radius * std::sin(angle)));
      mesh.vertices.push_back(static_cast<float>(height));
    }
  }
  for (std::size_t ring = 0; ring + 1 < rings.size(); ++ring) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t next = (i + 1) % kSides, low = first(ring), high = first(ring + 1);
      const bool from_point = rings[ring][0] == 0.0, to_point = rings[ring + 1][0] == 0.0;
      // A ring that is a point has the same place many times: its first corner stands for all.
      const std::uint32_t below = from_point ? low : low + i, above = to_point ? high : high + i;
      if (!from_point) mesh.triangles.insert(mesh.triangles.end(), {below, low + next, above});
      if (!to_point) {
        mesh.triangles.insert(mesh.triangles.end(),
                              {above, from_point ? below : low + next, high + next});
      }
    }
  }
}

/// The triangles of a box, cylinder or sphere.
[[nodiscard]] Mesh mesh_of_shape(const Visual& visual) {
  Mesh mesh;
  if (visual.shape == VisualShape::box) {
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const double side = (corner >> axis & 1U) != 0 ? 0.5 : -0.5;
        mesh.vertices.push_back(static_cast<float>(side * visual.size[axis]));
      }
    }
    mesh.triangles = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  } else if (visual.shape == VisualShape::cylinder) {
    const double r = visual.radius, z = 0.5 * visual.length;
    add_rings(std::array<std::array<double, 2>, 4>{{{0.0, -z}, {r, -z}, {r, z}, {0.0, z}}}, mesh);
  } else {
    constexpr int kRings = 32;
    std::vector<std::array<double, 2>> rings;
    for (int i = 0; i <= kRings; ++i) {
      const double angle = std::numbers::pi * i / kRings;
      const bool is_pole = i == 0 || i == kRings;
      rings.push_back(
          {is_pole ? 0.0 : visual.radius * std::sin(angle), -visual.radius * std::cos(angle)});
    }
    add_rings(rings, mesh);
  }
  return mesh;
}

/// The triangles of a link, from all its meshes.
struct LinkTriangles {
  std::vector<Vector3<double>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// @param visual  its scale and origin
  void add(const Mesh& mesh, const Visual& visual) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (std::size_t v = 0; v < mesh.num_vertices(); ++v) {
      Vector3<double> p;
      for (std::size_t k = 0; k < 3; ++k) {
        p[static_cast<Eigen::Index>(k)] = visual.scale[k] * mesh.vertices[3 * v + k];
      }
      vertices.push_back(visual.link_T_visual * p);
    }
    const bool mirrors = visual.scale[0] * visual.scale[1] * visual.scale[2] < 0.0;
    for (std::size_t t = 0; t < mesh.num_triangles(); ++t) {
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) corners[k] = first + mesh.triangles[3 * t + k];
      if (mirrors) std::swap(corners[1], corners[2]);
      triangles.push_back(corners);
    }
  }
};

/// The meshes of links that are needed.
class SurfaceReader {
 public:
  SurfaceReader(const SurfaceSource& source, Diagnostics& diagnostics)
      : source_(source), diagnostics_(diagnostics) {}

  [[nodiscard]] RobotSurface read(const std::vector<Visual>& all, const char* element) {
    std::vector<std::string> names;  // of links, in order of the URDF
    std::map<std::string, LinkTriangles> links;
    for (const Visual& visual : all) {
      const bool is_mesh = visual.shape == VisualShape::mesh;
      if (!is_needed(visual.link) || (!is_mesh && !shapes_count(all, visual.link))) continue;
      if (links.try_emplace(visual.link).second) names.push_back(visual.link);
      if (!is_mesh) links[visual.link].add(mesh_of_shape(visual), visual);
      if (!is_mesh) continue;
      if (const Mesh* mesh = mesh_of(visual)) links[visual.link].add(*mesh, visual);
    }
    report_without(names, element);
    std::vector<SurfaceLink> made;
    for (const std::string& name : names) {
      const LinkTriangles& of = links[name];
      if (of.triangles.empty()) continue;  // its mesh is reported
      SurfaceLink link{name, TriangleTree(of.vertices, of.triangles)};
      if (is_good(link)) made.push_back(std::move(link));
    }
    report_facts(made);
    return RobotSurface(std::move(made));
  }

 private:
  [[nodiscard]] bool is_needed(const std::string& link) const {
    const auto& needed = source_.links;
    return needed.empty() || std::any_of(needed.begin(), needed.end(),
                                         [&](const auto& name) { return same_frame(name, link); });
  }

  /// Whether boxes, cylinders and spheres of a link count: if no link has a mesh, or the link is listed and has none.
  [[nodiscard]] bool shapes_count(const std::vector<Visual>& all, const std::string& link) const {
    return std::none_of(all.begin(), all.end(), [&](const Visual& visual) {
      return visual.shape == VisualShape::mesh && (source_.links.empty() || visual.link == link);
    });
  }

  /// A mesh, read once; nullptr, and an error, if that fails.
  [[nodiscard]] const Mesh* mesh_of(const Visual& visual) {
    const auto [known, is_new] = meshes_.try_emplace(visual.mesh);
    if (is_new) {
      try {
        constexpr std::size_t kMost = 2000000, kAll = std::numeric_limits<std::size_t>::max();
        constexpr MeshLimits kLimits{.triangles = kAll, .bytes = std::uintmax_t{1} << 30};
        known->second = read_mesh(find_mesh(visual.mesh, source_.places), kLimits);
        if (const std::size_t triangles = known->second.num_triangles(); triangles > kMost) {
          known->second = thinned(known->second, kMost);
          diagnostics_.note(
              {source_.urdf, 0},
              fmt::format("mesh '{}' has {} triangles; it is simplified to {}",
                          printable(visual.mesh), triangles, known->second.num_triangles()));
        }
      } catch (const MeshError& error) {
        diagnostics_.error(
            {source_.urdf, 0},
            fmt::format("link '{}': mesh '{}' {}; the surface of the robot needs it: mend its "
                        "name in the URDF, or list the links to use under 'links'",
                        printable(visual.link), printable(visual.mesh), error.what()));
      }
    }
    return known->second.triangles.empty() ? nullptr : &known->second;
  }

  void report_without(const std::vector<std::string>& names, const char* element) {
    for (const std::string& link : source_.links) {
      const auto has = [&](const std::string& name) { return same_frame(name, link); };
      if (std::any_of(names.begin(), names.end(), has)) continue;
      diagnostics_.error(source_.place,
                         fmt::format("link '{}' has no mesh or shape in a <{}> of {}{}", link,
                                     element, source_.urdf, did_you_mean(link, names)));
    }
    if (names.empty() && source_.links.empty()) {
      diagnostics_.error(source_.place,
                         fmt::format("no link has a mesh or shape in a <{}> of {}; the surface of "
                                     "the robot is made of <mesh>, or of <box>, <cylinder> and "
                                     "<sphere> where no link has a <mesh>",
                                     element, source_.urdf));
    }
  }

  /// False, and an error, if the size of a link is impossible.
  [[nodiscard]] bool is_good(const SurfaceLink& link) {
    constexpr double kLargest = 30.0, kSmallest = 0.005;  // a room; a screw
    const SurfaceFacts& facts = link.tree.facts();
    const double size = (facts.high - facts.low).maxCoeff();
    std::string why;
    if (facts.triangles == 0) {
      why = "all triangles of its mesh are without area";
    } else if (size > kLargest) {
      why = fmt::format(
          "its mesh is {:.4g} m long; is it in millimetres?  Then write "
          "scale=\"0.001 0.001 0.001\" in its <mesh>",
          size);
    } else if (size < kSmallest) {
      why = fmt::format("its mesh is {:.3g} mm long; is its scale wrong?  Vertices are in metres",
                        1e3 * size);
    }
    if (!why.empty()) diagnostics_.error({source_.urdf, 0}, "link '" + link.name + "': " + why);
    return why.empty();
  }

  void report_facts(const std::vector<SurfaceLink>& links) {
    std::size_t triangles = 0, without_area = 0;
    std::vector<std::string> open, inside_out;
    for (const SurfaceLink& link : links) {
      const SurfaceFacts& facts = link.tree.facts();
      triangles += facts.triangles;
      without_area += facts.without_area;
      if (!facts.closed) open.push_back(link.name);
      if (facts.closed && facts.volume < 0.0) inside_out.push_back(link.name);
    }
    std::string text = fmt::format("the surface of the robot is {} of {}",
                                   counted(triangles, "triangle"), counted(links.size(), "link"));
    if (without_area > 0) text += fmt::format("; {} without area left out", without_area);
    if (!open.empty()) text += "; not closed: " + fmt::format("{}", fmt::join(open, ", "));
    if (!inside_out.empty()) {
      text += "; inside out: " + fmt::format("{}", fmt::join(inside_out, ", "));
    }
    if (!links.empty()) diagnostics_.note({source_.urdf, 0}, text);
  }

  const SurfaceSource& source_;
  Diagnostics& diagnostics_;
  std::map<std::string, Mesh> meshes_;  ///< by name in the URDF
};

}  // namespace
}  // namespace detail

int RobotSurface::find(const std::string& link) const {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (same_frame(links_[i].name, link)) return static_cast<int>(i);
  }
  return -1;
}

SurfaceHit RobotSurface::closest(std::span<const Pose<double>> base_T_links,
                                 const Vector3<double>& p_base, double bound,
                                 const SurfaceHit& last) const {
  return PosedSurface(*this, base_T_links).closest(p_base, bound, last);
}

PosedSurface::PosedSurface(const RobotSurface& surface, std::span<const Pose<double>> base_T_links)
    : surface_(surface), poses_(base_T_links) {
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const TriangleTree& tree = surface.links()[i].tree;
    balls_.push_back({poses_[i] * tree.center(), tree.radius()});
  }
}

SurfaceHit PosedSurface::closest(const Vector3<double>& p_base, double bound,
                                 const SurfaceHit& last) const {
  SurfaceHit hit;
  SurfacePoint best;
  const auto search = [&](std::size_t i, int guess) {
    const double least = std::min(bound, best.distance), reach = least + balls_[i].radius;
    if (guess < 0 && (p_base - balls_[i].middle).squaredNorm() > reach * reach) return;
    const Vector3<double> p = poses_[i].rotation.transpose() * (p_base - poses_[i].translation);
    const TriangleTree& tree = surface_.links()[i].tree;
    if (guess < 0 && tree.away(p) > least) return;
    const auto found = tree.closest(p, least, guess);
    if (!found || found->distance >= best.distance) return;
    best = *found;
    hit.link = static_cast<int>(i);
  };
  // What is found on one link bounds the search of the others.
  if (last.link >= 0) search(static_cast<std::size_t>(last.link), last.triangle);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (static_cast<int>(i) != last.link) search(i, -1);
  }
  if (hit.link < 0) return hit;
  const Pose<double>& base_T_link = poses_[static_cast<std::size_t>(hit.link)];
  hit.triangle = best.triangle;
  hit.point = best.point;
  hit.distance = best.distance;
  hit.face = base_T_link.rotation * best.normal;
  const Vector3<double> off = p_base - base_T_link * best.point;
  constexpr double kCoincide = 1e-9;  // metres
  const bool is_behind = off.dot(hit.face) < 0.0;
  hit.normal = off.norm() < kCoincide
                   ? hit.face
                   : Vector3<double>((is_behind ? -1.0 : 1.0) * off.normalized());
  return hit;
}

SurfaceHit RobotSurface::cast(std::span<const Pose<double>> base_T_links,
                              const Vector3<double>& origin,
                              const Vector3<double>& direction) const {
  SurfaceHit hit;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Pose<double> link_T_base = base_T_links[i].inverse();
    const auto found = links_[i].tree.cast(
        link_T_base * origin, Vector3<double>(link_T_base.rotation * direction), hit.distance);
    if (!found) continue;
    hit.link = static_cast<int>(i);
    hit.triangle = found->triangle;
    hit.point = found->point;
    hit.distance = found->distance;
    hit.normal = hit.face = base_T_links[i].rotation * found->normal;
  }
  return hit;
}

std::vector<std::size_t> farthest_apart(std::span<const std::vector<Pose<double>>> links,
                                        std::size_t most) {
  constexpr double kTaken = -1.0;
  std::vector<double> away;
  for (const auto& pose : links) {
    away.push_back(pose.empty() ? kTaken : std::numeric_limits<double>::infinity());
  }
  std::vector<std::size_t> chosen;
  while (chosen.size() < most) {
    const auto next = std::max_element(away.begin(), away.end());
    if (next == away.end() || *next == kTaken) break;
    const auto taken = static_cast<std::size_t>(next - away.begin());
    chosen.push_back(taken);
    for (std::size_t i = 0; i < links.size(); ++i) {
      double moves = 0.0;
      for (std::size_t l = 0; l < links[i].size(); ++l) {
        moves += (links[i][l].translation - links[taken][l].translation).norm() +
                 (links[i][l].rotation - links[taken][l].rotation).norm();
      }
      away[i] = i == taken ? kTaken : std::min(away[i], moves);
    }
  }
  return chosen;
}

RobotSurface read_surface(const std::string& text, const SurfaceSource& source,
                          Diagnostics& diagnostics) {
  const auto of = [&](ShapeElement element) {
    return visuals(text, source.urdf, diagnostics, element);
  };
  const auto have_meshes = [](const std::vector<Visual>& some) {
    return std::any_of(some.begin(), some.end(),
                       [](const Visual& visual) { return visual.shape == VisualShape::mesh; });
  };
  std::vector<Visual> all;
  const char* element = "visual";
  if (source.geometry != SurfaceGeometry::collision) all = of(ShapeElement::visual);
  if (source.geometry == SurfaceGeometry::collision ||
      (source.geometry == SurfaceGeometry::automatic && !have_meshes(all))) {
    std::vector<Visual> others = of(ShapeElement::collision);
    const bool have_more = have_meshes(others) || (all.empty() && !others.empty());
    if (have_more || source.geometry == SurfaceGeometry::collision) {
      element = "collision";
      all = std::move(others);
    }
  }
  return detail::SurfaceReader(source, diagnostics).read(all, element);
}

}  // namespace kinecal
