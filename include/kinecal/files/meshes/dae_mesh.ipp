// COLLADA files (DAE): triangles and polygons of the nodes of their scene.
//
// Like RViz, applies the file's unit but not its up axis.  Ignores materials, skins and animations.
// Source: COLLADA 1.4.1 specification, 5: <node>, <triangles>, <polylist>, <polygons>.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/meshes/obj_mesh.ipp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// Reads one file.
class DaeReader {
 public:
  /// @throws MeshError  if it is not COLLADA
  explicit DaeReader(const std::string& bytes) {
    const auto read = document_.load_buffer(bytes.data(), bytes.size());
    if (!read) throw MeshError(std::string("is malformed XML: ") + read.description());
    if (std::string_view(root().name()) != "COLLADA") throw MeshError("is not a COLLADA file");
    struct Ids : pugi::xml_tree_walker {
      std::map<std::string, pugi::xml_node>& all;
      explicit Ids(std::map<std::string, pugi::xml_node>& ids) : all(ids) {}
      bool for_each(pugi::xml_node& node) override {
        if (const auto id = node.attribute("id")) all.emplace(id.value(), node);
        return true;
      }
    } walker(by_id_);
    document_.traverse(walker);
  }

  [[nodiscard]] Mesh take() {
    const double metres = root().child("asset").child("unit").attribute("meter").as_double(1.0);
    Eigen::Affine3d unit = Eigen::Affine3d::Identity();
    if (std::isfinite(metres) && metres > 0.0) unit.scale(metres);
    const auto scene = of(root().child("scene").child("instance_visual_scene").attribute("url"));
    for (const pugi::xml_node node : scene.children("node")) add_node(node, unit, 0);
    return std::move(mesh_);
  }

 private:
  static constexpr int kDeepest = 100;                   ///< of nested nodes
  static constexpr int kMostNodes = 20000;               ///< nodes may be used many times
  static constexpr std::size_t kMostNumbers = 30000000;  ///< of vertices and triangles

  [[nodiscard]] pugi::xml_node root() const { return document_.document_element(); }

  /// The element of "#id"; a null node if absent.
  [[nodiscard]] pugi::xml_node of(pugi::xml_attribute url) const {
    const std::string_view text = url.value();
    const auto found = by_id_.find(std::string(text.substr(text.starts_with('#') ? 1 : 0)));
    return found == by_id_.end() ? pugi::xml_node() : found->second;
  }

  /// The numbers of an element; zeros for missing ones.
  [[nodiscard]] static std::vector<double> numbers(pugi::xml_node element, std::size_t count) {
    std::vector<double> all = all_numbers<double>(element.child_value());
    all.resize(count);
    return all;
  }

  /// The pose of a node: its transforms in order.
  [[nodiscard]] static Eigen::Affine3d pose_of(pugi::xml_node node) {
    Eigen::Affine3d pose = Eigen::Affine3d::Identity();
    for (const pugi::xml_node child : node.children()) {
      const std::string_view name = child.name();
      if (name == "translate") {
        const auto t = numbers(child, 3);
        pose.translate(Eigen::Vector3d(t[0], t[1], t[2]));
      } else if (name == "scale") {
        const auto s = numbers(child, 3);
        pose.scale(Eigen::Vector3d(s[0], s[1], s[2]));
      } else if (name == "rotate") {
        const auto r = numbers(child, 4);
        const Eigen::Vector3d axis(r[0], r[1], r[2]);
        if (!(axis.norm() > 0.0)) continue;
        pose.rotate(Eigen::AngleAxisd(r[3] * std::numbers::pi / 180.0, axis.normalized()));
      } else if (name == "matrix") {
        const auto m = numbers(child, 16);
        Eigen::Affine3d of_node = Eigen::Affine3d::Identity();
        for (int i = 0; i < 12; ++i) of_node(i / 4, i % 4) = m[static_cast<std::size_t>(i)];
        pose = pose * of_node;
      }
    }
    return pose;
  }

  void add_node(pugi::xml_node node, const Eigen::Affine3d& above, int depth) {
    if (depth > kDeepest || ++nodes_ > kMostNodes) throw MeshError("has too many nodes");
    const Eigen::Affine3d pose = above * pose_of(node);
    for (const pugi::xml_node child : node.children()) {
      const std::string_view name = child.name();
      if (name == "node") add_node(child, pose, depth + 1);
      const pugi::xml_node target = of(child.attribute("url"));
      if (name == "instance_node" && target) add_node(target, pose, depth + 1);
      if (name == "instance_geometry") add_geometry(target.child("mesh"), pose);
    }
  }

  void add_geometry(pugi::xml_node geometry, const Eigen::Affine3d& pose) {
    for (const pugi::xml_node part : geometry.children()) {
      const std::string_view name = part.name();
      if (name == "triangles" || name == "polylist" || name == "polygons") add_part(part, pose);
      if (mesh_.vertices.size() + mesh_.triangles.size() > kMostNumbers) {
        throw MeshError("has too many vertices and triangles");
      }
    }
  }

  /// Adds the vertices of a part, and its polygons.
  void add_part(pugi::xml_node part, const Eigen::Affine3d& pose) {
    std::size_t stride = 1, offset = 0;
    pugi::xml_node positions;
    for (const pugi::xml_node input : part.children("input")) {
      const std::size_t place = input.attribute("offset").as_uint();
      stride = std::max(stride, place + 1);
      if (std::string_view(input.attribute("semantic").value()) != "VERTEX") continue;
      offset = place;
      for (const pugi::xml_node of_vertex : of(input.attribute("source")).children("input")) {
        if (std::string_view(of_vertex.attribute("semantic").value()) == "POSITION") {
          positions = of(of_vertex.attribute("source"));
        }
      }
    }
    const auto first = static_cast<std::uint32_t>(mesh_.num_vertices());
    add_vertices(positions, pose);
    const std::vector<std::uint32_t> sizes =
        all_numbers<std::uint32_t>(part.child("vcount").child_value());
    const bool is_list = std::string_view(part.name()) == "polylist",
               is_triangles = std::string_view(part.name()) == "triangles";
    for (const pugi::xml_node p : part.children("p")) {
      std::vector<std::uint32_t> corners;
      const auto indices = all_numbers<std::uint32_t>(p.child_value());
      for (std::size_t i = offset; i < indices.size(); i += stride) {
        corners.push_back(first + indices[i]);
      }
      std::size_t begin = 0;
      for (std::size_t n = 0; begin < corners.size(); ++n) {
        const std::size_t left = corners.size() - begin;
        const std::size_t size = is_triangles       ? 3
                                 : !is_list         ? left
                                 : n < sizes.size() ? sizes[n]
                                                    : 0;
        if (size == 0 || size > left) break;
        const auto from = corners.begin() + static_cast<std::ptrdiff_t>(begin);
        add_polygon({from, from + static_cast<std::ptrdiff_t>(size)}, mesh_);
        begin += size;
      }
    }
  }

  void add_vertices(pugi::xml_node source, const Eigen::Affine3d& pose) {
    const pugi::xml_node accessor = source.child("technique_common").child("accessor");
    const std::size_t stride = std::max(3U, accessor.attribute("stride").as_uint(3)),
                      from = accessor.attribute("offset").as_uint();
    const auto all = all_numbers<double>(source.child("float_array").child_value());
    for (std::size_t i = from; i + 2 < all.size(); i += stride) {
      const Eigen::Vector3d p = pose * Eigen::Vector3d(all[i], all[i + 1], all[i + 2]);
      for (int k = 0; k < 3; ++k) mesh_.vertices.push_back(static_cast<float>(p(k)));
    }
  }

  pugi::xml_document document_;
  std::map<std::string, pugi::xml_node> by_id_;
  Mesh mesh_;
  int nodes_ = 0;
};

[[nodiscard]] inline Mesh dae_mesh(const std::string& bytes) {
  return DaeReader(bytes).take();
}

}  // namespace kinecal::detail
