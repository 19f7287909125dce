// Photographs in a folder, with a table of the robot's joint positions.
//
//   image,joint_1,joint_2        a column `image` names the files; without one, rows follow the
//   0001.png,0.52,-1.04          natural order of the file names: 2.png before 10.png
//
// Positions are radians and metres, unless a column file (io/csv/csv_mapping.hpp) says otherwise.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/view.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Location of photographs.
struct ImageFolder {
  std::string images;   ///< folder of PNG, JPEG, BMP or TIFF files
  std::string table;    ///< of joint positions, CSV; or a folder with a pose for each image, see
                        ///< files/poses/pose_table.hpp; empty: nobody knows where the robot was
  std::string columns;  ///< meaning of its columns; empty: each is a joint, except `image`
  std::string depth;    ///< folder of depth images, same names except the extension; empty: none
  std::vector<std::string> others =
      {};  ///< folders of other cameras, one of which has what this one has not
};

/// A photograph and the robot's joint positions.
struct PosedImage {
  std::string path;       ///< of the image
  std::string depth;      ///< of its depth image; empty: none
  MeasuredJoints joints;  ///< of the robot
  std::string source;     ///< row of the table: "poses.csv:3"
};

/// Lists photographs in table order.  Collects all errors: images without a row, rows without an
/// image, rows that name an image twice, cells that are not numbers.
/// @throws InputError  if the folder or a file cannot be read
[[nodiscard]] std::vector<PosedImage> list_images(const ImageFolder& folder,
                                                  Diagnostics& diagnostics);

/// Reads a photograph as a view of a camera.
/// @param camera       without a size, gets that of the image; nullopt: unknown; of an image without joints and poses,
///                     its camera_info is its size
/// @param frame        of the camera
/// @throws InputError  if a file is damaged, the sizes of depth and image differ, or points cannot
///                     be computed because there is no camera
[[nodiscard]] View read_view(const PosedImage& image, const std::optional<CameraInfo>& camera,
                             const std::string& frame);

}  // namespace kinecal
