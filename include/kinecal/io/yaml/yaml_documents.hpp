// Documents of a YAML file as nodes, without the endless loop of yaml-cpp.
//
// yaml-cpp 0.7 finds empty documents without end before a stray ',' at the start of a document; it
// does not move on.  So the text is parsed once before nodes are made of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <sstream>
#include <string>
#include <vector>

namespace kinecal {

namespace detail {

/// Listens to nothing but the starts of documents, and notices a parser that does not move on.
class YamlDocumentStarts final : public YAML::EventHandler {
 public:
  /// @throws YAML::ParserException  if a document starts where the last one did
  void OnDocumentStart(const YAML::Mark& mark) override {
    if (mark.pos <= position_) {
      throw YAML::ParserException(mark, "a character that cannot begin a document");
    }
    position_ = mark.pos;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

 private:
  int position_ = -1;
};

}  // namespace detail

/// All documents of a text.
/// @throws YAML::Exception  where it is not YAML
[[nodiscard]] inline std::vector<YAML::Node> load_yaml_documents(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  detail::YamlDocumentStarts starts;
  while (parser.HandleNextDocument(starts)) {
  }
  return YAML::LoadAll(text);
}

}  // namespace kinecal
