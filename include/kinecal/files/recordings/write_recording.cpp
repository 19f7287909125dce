// Definitions of write_recording.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/write_recording.hpp"

#include <filesystem>
#include <sstream>

#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/recordings/convert.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/standard_output.hpp"
#include "kinecal/files/samples/write_samples.hpp"

namespace kinecal {

std::optional<Encoding> output_encoding(const std::string& path) {
  if (is_standard_output(path)) return std::nullopt;
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".bag") return Encoding::ros1;
  if (extension == ".mcap") return Encoding::cdr;
  if (extension == ".yaml" || extension == ".yml") return std::nullopt;
  throw InputError(path + ": unknown format; the name must end in .yaml, .bag or .mcap");
}

void write_recording(const std::string& path, const std::vector<Sample>& samples,
                     const std::string& urdf, Existing existing) {
  const std::optional<Encoding> encoding = output_encoding(path);
  if (!encoding) {
    std::ostringstream text;
    write_samples(text, samples);
    return write_text_file(path, text.str(), existing);
  }
  const OutputFolder folder(folder_of(path));  // creates it if it is missing
  BagOutput bag(path, *encoding,
                *encoding == Encoding::cdr ? best_mcap_compression() : Compression::none);
  if (!urdf.empty()) write_urdf(bag, urdf);
  write_samples(bag, samples);
  bag.finish(existing);
}

}  // namespace kinecal
