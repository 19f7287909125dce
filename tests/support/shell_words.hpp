// The words of a command, as a shell reads them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/temporary_folder.hpp"

namespace kinecal::test {

/// What a shell makes of a command that is pasted into it.
struct PastedCommand {
  std::vector<std::string> words;
  bool did_more = false;  ///< it has run something else, or left a file behind
};

/// @param shell  "sh", or "bash" for words with escapes, which older shells do not know
inline PastedCommand paste(const std::string& command, const std::string& shell = "sh") {
  const TemporaryFolder folder, results;
  const std::string script = (results.path() / "script").string(),
                    words = (results.path() / "words").string();
  std::ofstream(script, std::ios::binary)
      << "set -- " << command << "\nfor word in \"$@\"; do printf '%s\\0' \"$word\"; done > "
      << words << "\n";
  const std::string call =
      "cd " + folder.path().string() + " && " + shell + " " + script + " > " + words + ".out 2>&1";
  PastedCommand pasted;
  pasted.did_more = std::system(call.c_str()) != 0 ||
                    std::filesystem::file_size(words + ".out") > 0 ||
                    !std::filesystem::is_empty(folder.path());
  std::ifstream file(words, std::ios::binary);
  for (std::string word; std::getline(file, word, '\0');) pasted.words.push_back(word);
  return pasted;
}

}  // namespace kinecal::test
