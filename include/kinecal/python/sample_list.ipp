// Samples as the module holds them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/python/arrays.ipp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::python {

/// What a sensor saw, as arrays give it.
struct SensorArray {
  std::string sensor;  ///< name
  std::string frame;   ///< link or frame in which features are given
  Numbers
      features;  ///< (n, k, 2 or 3) pixels or points, or (n, k, 4, 4) poses; NaN: not seen.  n may be 1: the
                 ///< same in each sample
  std::vector<int> ids;              ///< of the k features; empty: by their place
  std::optional<CameraInfo> camera;  ///< intrinsics
};

/// Samples as arrays, which are not copied.  Reading them needs no lock of Python.
struct SampleArrays {
  std::vector<std::string> joints;
  Numbers positions;  ///< (n, joints)
  std::vector<SensorArray> sensors;
  std::map<std::string, Numbers> conditions;  ///< (n) by name
  std::optional<Numbers> stamps;              ///< (n) seconds
  std::string name;                           ///< for messages

  [[nodiscard]] std::size_t size() const { return size_of(positions, 0); }
  /// Some of them, from `first` to before `end`.
  [[nodiscard]] std::vector<Sample> samples(std::size_t first, std::size_t end) const;
};

/// Samples of arrays or files.
struct SampleList {
  std::vector<Sample> samples = {};  ///< in the order of the rows, or of the files
  std::string urdf = {};             ///< that a recording has; may be empty
  Diagnostics diagnostics = {};      ///< of their readers
};

}  // namespace kinecal::python
