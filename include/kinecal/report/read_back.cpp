// Definitions of read_back.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/read_back.hpp"

#include <algorithm>

#include "kinecal/report/text.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal {

namespace detail {
namespace {

/// What a reader reads.
[[nodiscard]] std::string_view files_of(Reader reader) {
  if (reader == Reader::driver) return "calibrated.urdf and calibration.yaml (true_position.hpp)";
  return reader == Reader::urdf ? "calibrated.urdf, with the zeros that it holds"
                                : "calibrated.urdf without <calibration rising>";
}

}  // namespace
}  // namespace detail

std::string_view to_string(Reader reader) {
  if (reader == Reader::driver) return "driver";
  return reader == Reader::urdf ? "urdf" : "origins";
}

const ReaderFit* ReadBack::of(Reader reader) const {
  const auto found = std::find_if(fits.begin(), fits.end(),
                                  [&](const ReaderFit& fit) { return fit.reader == reader; });
  return found == fits.end() ? nullptr : &*found;
}

double times_larger(const std::vector<BlockError>& errors, const std::vector<BlockError>& than) {
  double times = 1.0;
  for (std::size_t b = 0; b < std::min(errors.size(), than.size()); ++b) {
    if (than[b].rms > 0.0) times = std::max(times, errors[b].rms / than[b].rms);
  }
  return times;
}

std::string errors_text(const std::vector<BlockError>& errors) {
  std::string text;
  for (const BlockError& error : errors) {
    text += (text.empty() ? "" : ", ") + error.block + " " + reading(error.rms, error.unit);
  }
  return text;
}

std::string read_back_text(const ReadBack& read_back) {
  constexpr double kSame = 1.01;
  TextTable table({"read", "fits"}, 2);
  int rows = 0;
  const std::vector<BlockError>* last = nullptr;
  for (auto fit = read_back.fits.rbegin(); fit != read_back.fits.rend(); ++fit) {
    if (last != nullptr && !(times_larger(*last, fit->errors) > kSame)) continue;
    table.add({std::string(detail::files_of(fit->reader)), errors_text(fit->errors)});
    last = &fit->errors;
    ++rows;
  }
  if (rows < 2) return "";
  std::string text = "The files as they are read\n" + table.str();
  if (read_back.of(Reader::origins) != nullptr) {
    text +=
        "  robot_state_publisher, MoveIt and most drivers do not read <calibration rising>;\n"
        "  --offsets origin puts zeros into the origins, which all read\n";
  }
  return text;
}

}  // namespace kinecal
