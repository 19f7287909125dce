// Definitions of image_folder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/image_folder.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "kinecal/files/csv/csv_table.hpp"
#include "kinecal/files/csv/csv_units.hpp"
#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/images/read_image.hpp"
#include "kinecal/files/natural_order.hpp"
#include "kinecal/files/poses/pose_table.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {
namespace {

// Which row of a table belongs to which image.

/// Adds to the names of text files the endings of their images.
void complete_names(const std::vector<std::string>& images, std::vector<CsvRow>& rows) {
  for (CsvRow& row : rows) {
    for (const std::string& image : images) {
      if (std::filesystem::path(image).stem() == row.cells.front()) row.cells.front() = image;
    }
  }
}

/// True if a folder has a file of that name, which may lack its ending.
[[nodiscard]] bool has_image(const std::string& folder, const std::string& name) {
  std::error_code failed;
  for (const auto& file : std::filesystem::directory_iterator(folder, failed)) {
    if (file.path().filename() == name || file.path().stem() == name) return true;
  }
  return false;
}

/// Assigns images to rows.
/// @param image  column of their names; nullopt: the order of their names
/// @return       by the source of each row
[[nodiscard]] std::map<std::string, std::string> images_of_rows(
    const std::vector<CsvRow>& rows, std::optional<std::size_t> image, const ImageFolder& folder,
    const std::vector<std::string>& names, Diagnostics& diagnostics) {
  std::map<std::string, std::string> result;
  std::set<std::string> used;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const SourceLocation place{folder.table, rows[i].line};
    std::string name;
    if (image && *image < rows[i].cells.size()) name = rows[i].cells[*image];
    if (!image && i < names.size()) name = names[i];
    const std::string file = std::filesystem::path(name).filename().string();
    if (!image && name.empty()) {
      diagnostics.error(place, "there is no image for this row: the table has " +
                                   std::to_string(rows.size()) + " rows, " + folder.images +
                                   " has " + std::to_string(names.size()) + " images");
    } else if (!std::binary_search(names.begin(), names.end(), file, file_naturally_before)) {
      const auto has_it = [&](const std::string& other) { return has_image(other, file); };
      if (std::any_of(folder.others.begin(), folder.others.end(), has_it)) continue;
      diagnostics.error(place, "image '" + printable(name) + "' is not in " + folder.images +
                                   (folder.others.empty() ? did_you_mean(file, names)
                                                          : ", nor in that of another camera"));
    } else if (!used.insert(file).second) {
      diagnostics.error(place, "image '" + printable(name) + "' has a row already");
    } else {
      result[place.str()] = file;
    }
  }
  for (const std::string& name : names) {
    if (used.count(name) > 0) continue;
    diagnostics.error({folder.table, 0},
                      "has no row for image " + printable(name) + " of " + folder.images);
  }
  return result;
}

/// A text in lower case (ASCII).
[[nodiscard]] std::string in_small_letters(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// True for the name of an image.
[[nodiscard]] bool is_image_name(const std::string& name) {
  const std::string ending = in_small_letters(std::filesystem::path(name).extension().string());
  constexpr std::string_view kEndings[] = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff"};
  return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings);
}

/// Names of the images in a folder, in natural order.
[[nodiscard]] std::vector<std::string> image_names(const std::string& folder) {
  std::error_code failed;
  std::filesystem::directory_iterator files(folder, failed);
  if (failed) throw InputError(folder + ": " + failed.message());
  std::vector<std::string> names;
  for (const std::filesystem::directory_entry& file : files) {
    if (is_image_name(file.path().string())) names.push_back(file.path().filename().string());
  }
  if (names.empty()) throw InputError(folder + ": has no PNG, JPEG, BMP or TIFF images");
  std::sort(names.begin(), names.end(), file_naturally_before);
  return names;
}

/// The column with the names of images: by its name, or because its first cell names an image;
/// nullopt if the table has none.
[[nodiscard]] std::optional<std::size_t> image_column(const CsvTable& table) {
  for (std::size_t i = 0; i < table.header.cells.size(); ++i) {
    const std::string name = in_small_letters(table.header.cells[i]);
    if (name == "image" || name == "file" || name == "filename") return i;
  }
  for (std::size_t i = 0; !table.rows.empty() && i < table.rows.front().cells.size(); ++i) {
    if (is_image_name(table.rows.front().cells[i])) return i;
  }
  return std::nullopt;
}

/// Every column except that of the images is a joint, in the unit of a row of units.
[[nodiscard]] CsvMapping joints_of_header(const CsvTable& read, char separator,
                                          std::optional<std::size_t> image,
                                          const std::string& table) {
  CsvMapping mapping;
  mapping.separator = separator;
  for (std::size_t i = 0; i < read.header.cells.size(); ++i) {
    if (i == image) continue;
    const std::string& name = read.header.cells[i];
    const auto unit =
        i < read.units.cells.size() ? unit_of_cell(read.units.cells[i]) : std::nullopt;
    mapping.joints.push_back({name,
                              {{name, {table, read.header.line}}},
                              {unit == NamedUnit::degrees, unit == NamedUnit::millimetres}});
  }
  return mapping;
}

/// The depth image of an image: the same name, with extension .png.
[[nodiscard]] std::string depth_of(const ImageFolder& folder, const std::string& image,
                                   const std::string& source, Diagnostics& diagnostics) {
  if (folder.depth.empty()) return {};
  std::string path =
      (std::filesystem::path(folder.depth) / image).replace_extension(".png").string();
  if (!std::filesystem::exists(path)) {
    diagnostics.errors.push_back(source + ": image '" + printable(image) +
                                 "' has no depth: " + printable(path) + " does not exist");
  }
  return path;
}

/// Photographs of which nobody knows where the robot was, or that are of no robot.
[[nodiscard]] std::vector<PosedImage> images_alone(const ImageFolder& folder,
                                                   const std::vector<std::string>& names,
                                                   Diagnostics& diagnostics) {
  std::vector<PosedImage> images;
  for (const std::string& name : names) {
    const std::string path = (std::filesystem::path(folder.images) / name).string();
    images.push_back({path, depth_of(folder, name, path, diagnostics), {}, path});
  }
  return images;
}

}  // namespace
}  // namespace detail

std::vector<PosedImage> list_images(const ImageFolder& folder, Diagnostics& diagnostics) {
  const std::vector<std::string> names = detail::image_names(folder.images);
  if (!folder.depth.empty() && !std::filesystem::is_directory(folder.depth)) {
    throw InputError(folder.depth + ": is not a folder with images of depth");
  }
  if (folder.table.empty()) return detail::images_alone(folder, names, diagnostics);
  const bool of_files = is_pose_folder(folder.table);
  const std::string text = read_pose_table(folder.table);
  CsvMapping mapping;
  if (!folder.columns.empty()) {
    mapping = read_csv_mapping(folder.columns, diagnostics, CsvUse::joints);
  }
  if (of_files && folder.columns.empty()) {
    throw InputError(folder.table +
                     ": poses in text files need --columns, which says what their "
                     "numbers are; 'kinecal init --poses' writes it");
  }
  if (of_files) mapping.separator = ',', mapping.header = true;
  const char separator = folder.columns.empty() ? detail::csv_separator(text) : mapping.separator;
  const bool header = folder.columns.empty() || mapping.header;
  Diagnostics repeated;  // csv_samples() reports them again
  detail::CsvTable table = detail::csv_table(
      text, separator, header ? detail::CsvHeader::present : detail::CsvHeader::absent,
      folder.table, repeated);
  const auto image = header ? detail::image_column(table) : std::nullopt;
  if (folder.columns.empty()) {
    mapping = detail::joints_of_header(table, separator, image, folder.table);
  }
  if (!diagnostics.errors.empty()) return {};
  const std::vector<Sample> samples = csv_samples(text, mapping, folder.table, diagnostics);
  if (table.rows.empty()) return {};  // an error: no image has a row
  if (of_files) detail::complete_names(names, table.rows);
  const auto images = detail::images_of_rows(table.rows, image, folder, names, diagnostics);
  std::vector<PosedImage> result;
  for (const Sample& sample : samples) {
    const auto found = images.find(sample.source);
    if (found == images.end()) continue;
    result.push_back({(std::filesystem::path(folder.images) / found->second).string(),
                      detail::depth_of(folder, found->second, sample.source, diagnostics),
                      {{}, sample.joint_names, sample.joint_positions, {}, sample.poses},
                      sample.source});
  }
  return result;
}

View read_view(const PosedImage& image, const std::optional<CameraInfo>& camera,
               const std::string& frame) {
  View view;
  view.frame = frame;
  view.camera = camera;
  view.image = read_image(image.path);
  view.joints = image.joints;
  const bool is_alone = image.joints.names.empty() && image.joints.poses.empty();
  if (!camera && is_alone) view.camera.emplace();
  if (view.camera && view.camera->width == 0) {  // its size is all that is known
    view.camera->width = view.image.width;
    view.camera->height = view.image.height;
  }
  if (image.depth.empty()) return view;
  const DepthImage depth = read_depth(image.depth);
  if (depth.width != view.image.width || depth.height != view.image.height) {
    throw InputError(image.depth + ": has " + std::to_string(depth.width) + "x" +
                     std::to_string(depth.height) + " pixels, but " + image.path + " has " +
                     std::to_string(view.image.width) + "x" + std::to_string(view.image.height));
  }
  if (!camera) throw InputError(image.depth + ": points of depth need a camera; give its file");
  try {
    view.points = points_of(depth, *camera);
  } catch (const std::invalid_argument& error) {
    throw InputError(image.depth + ": " + error.what());
  }
  return view;
}

}  // namespace kinecal
