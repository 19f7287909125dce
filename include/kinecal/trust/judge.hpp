// The verdict on a calibration: good, use with care, or do not use; with reasons.
//
// Do not use                                          Use with care
//   a step did not converge
//   noise 10 x the sigma that was given, and 2 mm or    3 x
//   1 px; or a sigma above 5 cm or 30 px and 50 x the noise
//   without sigma: distances of 20 mm, 12 px, in metres 8 mm, 4 px
//   less for a robot below one metre
//   poses that differ by 20 mm or 6 degrees             8 mm or 2 degrees
//   freedom less than half of the parameters            less than the parameters
//   held-out error 3 x the fitted one                   1.5 x; whole regions held out: 3 x
//                                                       scatter in one direction 5 x that across it
//   a quarter of the samples does not fit,              a tenth
//   left out or not
//   something changed or drifted during the recording:  three quarters; also with a pattern of
//   with that, the noise falls to a third               residuals, such as of a joint's gear
//   a joint's offset of 45 degrees                      15 degrees
//   an intrinsic changed by 30 %                        9 %
//   the frame of a joint that moves: 0.3 m, 60 degrees  15 % of its link or 3 % of the robot, at most 5 cm;
//                                                       15 degrees; of a fixed one 0.2 m, 30 degrees
//   the pose in question is known to 20 mm only         to 5 mm, also over the limits of the joints; a
//                                                       direction of it not at all
//                                                       a frame outside of the URDF 0.3 m from where the
//                                                       configuration says it is
//                                                       a parameter ended at a bound
//                                                       a parameter known to 5 degrees, 20 mm, 5 %
//                                                       or 20 px only; of a camera only if its pixels
//                                                       are not known
//   cameras alone: a focal length known to 5 %          a pixel where features are known to 1 px, or not
//   only                                                determined; fx that the lens makes up for
//                                                       a prior that moves a parameter by 8
//                                                       standard deviations
//                                                       residuals of a camera that grow with the
//                                                       distance from the center: its lens
//   a lens that folds over among the features          beyond them, inside the image
//   copies of one sample alone                          one of fifty a copy, a tenth under the name of no sensor, a
//                                                       quarter not numbers (judge_input.hpp)
//                                                       doubts about the input
//
// Freedom is the number of residuals minus the number of determined parameters.  Undetermined
// parameter combinations do not count unless they move the pose in question.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/text/reading.hpp"
#include "kinecal/trust/assess.hpp"

namespace kinecal {

/// Whether a result should be used.
enum class Grade { good, use_with_care, do_not_use };

/// "good", "use with care" or "do not use".
[[nodiscard]] constexpr std::string_view to_string(Grade grade) {
  if (grade == Grade::good) return "good";
  return grade == Grade::use_with_care ? "use with care" : "do not use";
}

/// What answers a reason.
struct Remedy {
  /// What is to be done.
  enum class Kind {
    look,    ///< at residuals
    record,  ///< more poses
    hold,    ///< what samples do not determine or support
    mend,    ///< what the reason names
    serve,   ///< those who read the files: see read_back.hpp
  };
  Kind kind = Kind::look;
  std::string how = {};  ///< to mend: "loosen or remove prior 'p'"; empty: the reason says it
};

/// A verdict and its reasons.
struct Judgement {
  Grade verdict = Grade::good;
  std::vector<std::string> reasons;  ///< causes, then the worst first; sentences with figures
  std::vector<Remedy> remedies;      ///< what answers each of them
  int causes = 0;                    ///< how many of the reasons are causes of the others

  /// Adds a reason.
  void add(Grade grade, const std::string& reason, const Remedy& with = {}) {
    const auto at = grade > verdict ? reasons.begin() + causes : reasons.end();
    remedies.insert(remedies.begin() + (at - reasons.begin()), with);
    reasons.insert(at, reason);
    if (grade > verdict) verdict = grade;
  }
  /// Adds what explains the reasons, in front of what is known already.
  void add_causes(Grade grade, const std::vector<std::string>& found) {
    reasons.insert(reasons.begin(), found.begin(), found.end());
    causes += static_cast<int>(found.size());
    remedies.insert(remedies.begin(), found.size(), Remedy{Remedy::Kind::mend});
    if (!found.empty() && grade > verdict) verdict = grade;
  }
  /// Takes a cause back that another one explains; the verdict stays.
  void take_back_cause(const std::string& cause) {
    const auto end = reasons.begin() + causes;
    const auto at = std::find(reasons.begin(), end, cause);
    if (at == end) return;
    remedies.erase(remedies.begin() + (at - reasons.begin()));
    reasons.erase(at);
    --causes;
  }
};

/// Judges a calibration.
/// @param assessments  of its steps: see assess()
/// @param doubts       about the input, in sentences
/// @param refutable    those of the doubts that do not count if the last step fits to the noise
[[nodiscard]] Judgement judge(const Calibration& calibration, const CalibrationResult& result,
                              const std::vector<Assessment>& assessments,
                              const std::vector<std::string>& doubts = {},
                              const std::vector<std::string>& refutable = {});

/// Judges samples that were left out because they do not fit the others (ruined.hpp).
/// @param samples  their number, including those left out
void judge_left_out(int left_out, int samples, Judgement& judgement);

/// True if the noise of an error block speaks against calling a step good: something is wrong with
/// the model or the samples.
[[nodiscard]] bool fits_badly(const Assessment& step);

}  // namespace kinecal
