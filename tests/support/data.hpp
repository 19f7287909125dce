// The folder of the real data sets: KINECAL_DATA, by default ../shared/data beside the checkout.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/paths.hpp"

namespace kinecal::test {

inline std::filesystem::path data_folder() {
  const char* folder = std::getenv("KINECAL_DATA");
  return folder != nullptr ? folder : default_data_folder();
}

inline bool data_required() {
  const char* required = std::getenv("KINECAL_REQUIRE_DATA");
  return required != nullptr && std::string(required) == "1";
}

}  // namespace kinecal::test

/// Skips the test and says why if a data set is absent; fails with KINECAL_REQUIRE_DATA=1.
#define KINECAL_NEEDS_DATA(set)                                                             \
  if (!std::filesystem::exists(kinecal::test::data_folder() / (set))) {                     \
    if (kinecal::test::data_required()) {                                                   \
      FAIL() << "data set '" << (set) << "' is absent and KINECAL_REQUIRE_DATA is 1";       \
    }                                                                                       \
    GTEST_SKIP() << "data set '" << (set) << "' is not in " << kinecal::test::data_folder() \
                 << "; set KINECAL_DATA";                                                   \
  }
