// Columns of a magnetometer in a table.
#include "kinecal/tools/init/magnetometer_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

TEST(MagnetometerColumns, AreInMicrotesla) {
  const auto columns = [](const std::string& unit) -> std::string {
    try {
      return magnetometer_columns(
          "mag_x" + unit + ",mag_y" + unit + ",mag_z" + unit + "\n1,2,3\n4,5,7\n", "t.csv");
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_THAT(columns("_ut"), HasSubstr("mag_x: mag_x_ut"));
  EXPECT_THAT(columns("_t"), HasSubstr("t.csv: column 'mag_x_t' is in tesla"));
}

}  // namespace
}  // namespace kinecal
