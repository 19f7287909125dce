// The steps of a search for what is wrong, as a report shows them: trust/identify.hpp with names in place of numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kinecal {

/// What one step of a search bought.
struct ReportedSearchStep {
  std::string freed;       ///< "elbow_joint"; empty: nothing yet, only unknown poses are free
  int parameters = 0;      ///< that are free after it
  double fitted = 0.0;     ///< root of the mean squared distance after it, unit of the search
  double held_out = 0.0;   ///< the same, of poses held out; not finite: a fold leaves something
                           ///< undetermined
  double deviation = 0.0;  ///< standard error of held_out
  double region = 0.0;     ///< of regions held out; 0: too few poses
  double certainty = 0.0;  ///< rise of the error on held-out poses without it alone, in its
                           ///< standard errors
  bool is_chosen = true;   ///< false: tried after the chosen ones, and not freed
  std::vector<std::string> alike = {};        ///< what explains the same in place of it
  std::vector<std::string> inseparable = {};  ///< of these, what no sample like these tells from it
};

/// A search: the chosen steps in the order of what they explain, then those that were not.
struct ReportedSearch {
  std::string unit;                            ///< "m" or "px"; "1": several error blocks, in units
                                               ///< of their noise
  std::vector<ReportedSearchStep> steps = {};  ///< empty: there was none
};

}  // namespace kinecal
