// Where a URDF says what: the lines of joints and of their elements, for messages.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

class UrdfText;

/// A <joint> as the file has it.
struct JointElement {
  std::string name, type;
  std::string mimicked;  ///< the joint in its <mimic>; empty without one
  SourceLocation place;
};

/// An element that xacro should have replaced, or one with such an attribute (xacro_remnants.ipp).
struct XacroLeft {
  std::string text;      ///< "<xacro:hand>", or "xyz="${x} 0 0" of <origin>"
  bool is_inert = true;  ///< false: links, joints or numbers may be missing
  SourceLocation place;
};

/// The joints of a URDF, and the lines of their elements.
class UrdfPlaces {
 public:
  /// @param file  name of the file for messages
  /// @throws InputError  if the text is empty, not XML, not UTF-8 or its root is not <robot>
  UrdfPlaces(const std::string& text, const std::string& file);
  ~UrdfPlaces();
  UrdfPlaces(UrdfPlaces&&) noexcept;
  UrdfPlaces& operator=(UrdfPlaces&&) noexcept;

  [[nodiscard]] const std::string& file() const;

  /// In the order of the file.
  [[nodiscard]] std::vector<JointElement> joints() const;

  /// Location of a joint's element, such as "limit"; the file as a whole if it has no such element.
  [[nodiscard]] SourceLocation place(const std::string& joint, const char* element) const;

  /// Location of a joint's element, or of the joint if it has no such element.
  [[nodiscard]] SourceLocation place_or_joint(const std::string& joint, const char* element) const;

  /// The numbers of an attribute of a joint's element.
  /// @param count  required number; any other is an error
  /// @return       (count) zeros without such an attribute, or after an error
  [[nodiscard]] std::vector<double> numbers(const std::string& joint, const char* element,
                                            const char* attribute, std::size_t count,
                                            Diagnostics& diagnostics) const;

  /// What xacro should have replaced, in the order of the file.
  [[nodiscard]] std::vector<XacroLeft> xacro_left() const;

 private:
  std::unique_ptr<UrdfText> text_;
};

}  // namespace kinecal::detail
