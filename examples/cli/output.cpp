// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"

#include "terminal.hpp"

namespace kinecal::cli {

void write(OutputFolder& folder, const std::vector<OutputFile>& files, bool force) {
  folder.write(files, force ? Existing::replaced : Existing::kept);
  for (const OutputFile& file : files) {
    say("wrote {}\n", (folder.path() / file.name).string());
  }
}

}  // namespace kinecal::cli
