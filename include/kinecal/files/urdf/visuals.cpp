// Definitions of visuals.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/visuals.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Why a visual cannot be drawn.
struct NoVisual {
  std::string why;
};

/// Reads <visual> or <collision> elements.  They are no reason to reject a robot, so nothing here is an error of
/// the file.
class VisualReader {
 public:
  VisualReader(const UrdfText& urdf, Diagnostics& diagnostics, ShapeElement element)
      : urdf_(urdf),
        diagnostics_(diagnostics),
        element_(element == ShapeElement::visual ? "visual" : "collision") {
    for (const pugi::xml_node material : urdf.robot().children("material")) {
      if (const auto color = color_in(material)) {
        colors_[material.attribute("name").value()] = *color;
      }
    }
  }

  [[nodiscard]] std::vector<Visual> all() const {
    std::vector<Visual> visuals;
    for (const pugi::xml_node link : urdf_.robot().children("link")) {
      for (const pugi::xml_node visual : link.children(element_)) {
        try {
          visuals.push_back(read(link, visual));
        } catch (const NoVisual& no) {
          diagnostics_.warning(urdf_.place(visual),
                               "link '" + printable(link.attribute("name").value()) + "': its <" +
                                   element_ + "> is not drawn: " + no.why);
        }
      }
    }
    return visuals;
  }

 private:
  using Color = std::array<double, 4>;

  /// The numbers of an attribute; nullopt if there is no such attribute.
  template <std::size_t N>
  [[nodiscard]] static std::optional<std::array<double, N>> numbers(pugi::xml_node element,
                                                                    const char* attribute) {
    const pugi::xml_attribute found = element.attribute(attribute);
    if (!found) return std::nullopt;
    const auto tokens = number_tokens(found.value());
    std::array<double, N> all{};
    bool good = tokens && tokens->size() == N;
    for (std::size_t i = 0; good && i < N; ++i) {
      all[i] = (*tokens)[i].value;
      good = std::isfinite(all[i]);
    }
    if (good) return all;
    throw NoVisual{std::string(attribute) + "=\"" + printable(found.value()) + "\" of <" +
                   element.name() + "> is not " +
                   (N == 1 ? "a number" : std::to_string(N) + " numbers")};
  }

  /// The same for sizes, which are required and must be positive.
  template <std::size_t N>
  [[nodiscard]] static std::array<double, N> sizes(pugi::xml_node element, const char* attribute) {
    const auto all = numbers<N>(element, attribute);
    if (!all) throw NoVisual{std::string("<") + element.name() + "> has no " + attribute};
    for (const double size : *all) {
      if (size > 0.0) continue;
      throw NoVisual{std::string(attribute) + " of <" + element.name() + "> must be positive"};
    }
    return *all;
  }

  [[nodiscard]] static std::optional<Color> color_in(pugi::xml_node material) {
    try {
      auto color = numbers<4>(material.child("color"), "rgba");
      if (!color) return std::nullopt;
      for (double& part : *color) part = std::clamp(part, 0.0, 1.0);
      return color;
    } catch (const NoVisual&) {  // a shape in another color is better than none
      return std::nullopt;
    }
  }

  [[nodiscard]] Visual read(pugi::xml_node link, pugi::xml_node element) const {
    Visual visual;
    visual.link = link.attribute("name").value();
    const pugi::xml_node origin = element.child("origin");
    const std::array<double, 3> zero{};
    const auto xyz = numbers<3>(origin, "xyz").value_or(zero),
               rpy = numbers<3>(origin, "rpy").value_or(zero);
    visual.link_T_visual = {rotation_from_rpy(Vector3<double>(rpy[0], rpy[1], rpy[2])),
                            Vector3<double>(xyz[0], xyz[1], xyz[2])};
    read_shape(element.child("geometry"), visual);
    const pugi::xml_node material = element.child("material");
    const auto named = colors_.find(material.attribute("name").value());
    if (const auto own = color_in(material)) {
      visual.color = *own;
    } else if (named != colors_.end()) {
      visual.color = named->second;
    }
    return visual;
  }

  static void read_shape(pugi::xml_node geometry, Visual& visual) {
    if (const pugi::xml_node box = geometry.child("box")) {
      visual.shape = VisualShape::box;
      visual.size = sizes<3>(box, "size");
    } else if (const pugi::xml_node cylinder = geometry.child("cylinder")) {
      visual.shape = VisualShape::cylinder;
      visual.radius = sizes<1>(cylinder, "radius")[0];
      visual.length = sizes<1>(cylinder, "length")[0];
    } else if (const pugi::xml_node sphere = geometry.child("sphere")) {
      visual.shape = VisualShape::sphere;
      visual.radius = sizes<1>(sphere, "radius")[0];
    } else if (const pugi::xml_node mesh = geometry.child("mesh")) {
      visual.shape = VisualShape::mesh;
      visual.mesh = mesh.attribute("filename").value();
      if (visual.mesh.empty()) throw NoVisual{"<mesh> has no filename"};
      visual.scale = numbers<3>(mesh, "scale").value_or(visual.scale);  // may mirror: negative
      for (const double scale : visual.scale) {
        if (scale == 0.0) throw NoVisual{"scale of <mesh> is zero"};
      }
    } else {
      throw NoVisual{"its <geometry> is no box, cylinder, sphere or mesh"};
    }
  }

  const UrdfText& urdf_;
  Diagnostics& diagnostics_;
  const char* element_;
  std::map<std::string, Color> colors_;  ///< of materials by name
};

}  // namespace
}  // namespace detail

std::vector<Visual> visuals(const std::string& text, const std::string& name_for_messages,
                            Diagnostics& diagnostics, ShapeElement element) {
  const detail::UrdfText urdf(text, name_for_messages);
  return detail::VisualReader(urdf, diagnostics, element).all();
}

}  // namespace kinecal
