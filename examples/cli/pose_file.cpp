// SPDX-License-Identifier: Apache-2.0
#include "pose_file.hpp"

#include <filesystem>
#include <sstream>

#include "input.hpp"
#include "kinecal/io/recordings/pose_messages.hpp"
#include "kinecal/io/recordings/write_recording.hpp"
#include "kinecal/io/results/file_set.hpp"
#include "output_file.hpp"

namespace kinecal::cli {

std::vector<CapturePose> read_pose_file(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::file_size(path, unknown) == 0) throw InputError(path + ": is empty");
  Diagnostics diagnostics;
  std::vector<CapturePose> poses =
      is_poses_yaml(path) ? read_poses_yaml(path, diagnostics) : read_bag_poses(path, diagnostics);
  print_or_throw(diagnostics);
  if (poses.empty()) throw InputError(path + ": has no poses");
  return poses;
}

void write_pose_file(const std::string& path, const std::vector<CapturePose>& poses) {
  const std::optional<Encoding> encoding = output_encoding(path);
  if (poses.empty()) {
    std::filesystem::remove(path);
  } else if (encoding) {
    const OutputFolder folder(folder_of(path));  // creates it if it is missing
    BagOutput bag(path, *encoding);
    write_poses(bag, poses);
    bag.finish();
  } else {
    std::ostringstream text;
    write_poses_yaml(text, poses);
    write_file(path, text.str());
  }
}

}  // namespace kinecal::cli
