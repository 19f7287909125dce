// Photographs of several cameras: those of one name were taken at once, and are one sample.
//
//   images/left/0001.png   images/right/0001.png   -> one sample of both
//
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/tools/detect/look.hpp"

namespace kinecal {

/// What was found in the photographs of a camera.
struct CameraLooks {
  std::string camera;       ///< its name and its frame
  std::vector<Look> looks;  ///< their sources are the paths of the photographs
};

/// Joins what cameras saw at once, for each target apart.  Cameras get their names; features of a target that both saw are there once, by id.
/// @param all  of each camera; its samples are taken out
/// @returns    in the natural order of the names of the photographs
/// @throws SampleError  if features without ids are not the same ones for two cameras
[[nodiscard]] std::vector<Sample> joined_views(std::vector<CameraLooks>& all);

}  // namespace kinecal
