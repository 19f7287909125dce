// Schemas of configurations, capture.yaml, columns.yaml and scenes: what editors say of a file is what the
// program says of it.
#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using Schemas = test::ProgramTest;

TEST_F(Schemas, OfInputFilesAgreeWithTheReaders) {
  if (run("python3 -c 'import jsonschema, yaml'").code != 0) {
    if (std::getenv("KINECAL_REQUIRE_DATA") != nullptr) FAIL() << "there is no python3-jsonschema";
    GTEST_SKIP() << "there is no python3-jsonschema or python3-yaml";
  }
  const std::string source = test::source_folder();
  const test::Outcome checked = run("python3 " + source + "/tests/program/check_schemas.py " +
                                    test::kinecal_program() + " " + source);
  EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
}

}  // namespace
}  // namespace kinecal
