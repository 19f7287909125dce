// A result as those see it who read its files.
//
// A URDF holds no joint models: gears, eccentric encoders, sag.  Few programs read <calibration rising>.  So the
// calibrated URDF is read back, and the samples are evaluated with what each reader has, cameras and frames of trackers or
// targets as they were calibrated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kinecal {

/// Who reads the files of a result.
enum class Reader {
  driver,   ///< applies calibration.yaml: see true_position.hpp
  urdf,     ///< reads calibrated.urdf, and zeros where they were written
  origins,  ///< reads calibrated.urdf, but no <calibration rising>
};

/// "driver", "urdf" or "origins".
[[nodiscard]] std::string_view to_string(Reader reader);

/// Distances of an error block's features.
struct BlockError {
  std::string block;
  std::string unit;  ///< "m", "px" or "1"
  double rms = 0.0;
};

/// How the result fits for a reader.
struct ReaderFit {
  Reader reader = Reader::driver;
  std::vector<BlockError> errors = {};  ///< of each error block of the last step
};

/// What the files of a result are worth.
struct ReadBack {
  Reader judged = Reader::urdf;        ///< whose errors the verdict is about
  std::vector<ReaderFit> fits = {};    ///< the driver's first; empty: there is no URDF to read
  std::vector<std::string> lost = {};  ///< parameters of joint models that are not zero
  /// Errors if what a URDF can hold is searched for (kinecal identify --geometry-only); empty: not tried.
  std::vector<BlockError> geometry_only = {};
  bool is_worse = false;  ///< for the judged reader than for a driver, so that it matters

  /// The fit of a reader; nullptr if it is unknown.
  [[nodiscard]] const ReaderFit* of(Reader reader) const;
};

/// Times that errors are larger than others: of the block where it is most.
[[nodiscard]] double times_larger(const std::vector<BlockError>& errors,
                                  const std::vector<BlockError>& than);

/// "hand_eye 1.11 mm, eye 0.3 px"
[[nodiscard]] std::string errors_text(const std::vector<BlockError>& errors);

/// What readers see, a line each; empty if all see the same.
[[nodiscard]] std::string read_back_text(const ReadBack& read_back);

}  // namespace kinecal
