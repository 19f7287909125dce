// The results of a study as a page with charts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "study_tables.hpp"

namespace kinecal::cli {

/// The page as HTML.
[[nodiscard]] std::string study_page(const StudyInput& input, const StudyResult& result);

}  // namespace kinecal::cli
