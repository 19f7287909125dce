// Feeds the reader of CalibrationData YAML with any text, also in pieces so small that texts of a
// few lines are cut.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "kinecal/files/samples/sample_file.ipp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const std::size_t piece : {std::size_t{64}, kinecal::detail::SampleFile::kPieceBytes}) {
    std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
    kinecal::detail::SampleFile file(in, "fuzz.yaml", piece);
    file.read(1);
    kinecal::Diagnostics diagnostics;
    (void)file.take(diagnostics);
  }
  return 0;
}
