// Parses a URDF with urdfdom.  Messages that urdfdom would print become the text of an error,
// because a library never prints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <exception>
#include <locale>
#include <mutex>
#include <pugixml.hpp>
#include <set>
#include <sstream>
#include <string>

#include "kinecal/files/urdf/urdf_text.ipp"

namespace kinecal::detail {

/// Collects the messages of urdfdom during its lifetime.  console_bridge has one output per
/// process, so a second thread waits.
class UrdfdomMessages : public console_bridge::OutputHandler {
 public:
  UrdfdomMessages()
      : lock_(mutex()),
        previous_(console_bridge::getOutputHandler()),
        previous_level_(console_bridge::getLogLevel()) {
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
    console_bridge::useOutputHandler(this);
  }
  ~UrdfdomMessages() override {
    console_bridge::useOutputHandler(previous_);
    console_bridge::setLogLevel(previous_level_);
  }
  UrdfdomMessages(const UrdfdomMessages&) = delete;
  UrdfdomMessages& operator=(const UrdfdomMessages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel, const char*, int) override {
    all += (all.empty() ? "" : "; ") + text;
  }

  std::string all;

 private:
  [[nodiscard]] static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }

  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  console_bridge::LogLevel previous_level_;
};

/// Reports duplicate attributes of an element, for which urdfdom has no clear message.
struct DoubleAttributes : pugi::xml_tree_walker {
  DoubleAttributes(const UrdfText& from, Diagnostics& to) : source(from), diagnostics(to) {}

  bool for_each(pugi::xml_node& node) override {
    std::set<std::string> names;
    for (const pugi::xml_attribute attribute : node.attributes()) {
      if (names.insert(attribute.name()).second) continue;
      diagnostics.error(source.place(node), std::string("<") + node.name() +
                                                "> has the attribute '" + attribute.name() +
                                                "' twice; remove one");
    }
    constexpr std::size_t kMost = 20;
    return diagnostics.errors.size() < kMost;
  }

  const UrdfText& source;
  Diagnostics& diagnostics;
};

/// urdfdom's model of the robot.  urdfdom gets the text of the tree with normalized white space in
/// attributes: it would fail on a tab or a line break between two numbers.
/// @throws InputError  with urdfdom's message, if it rejects the text
[[nodiscard]] inline urdf::ModelInterfaceSharedPtr parse_with_urdfdom(const UrdfText& source) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  source.robot().print(text, "", pugi::format_raw);
  UrdfdomMessages messages;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(text.str());
  } catch (const std::exception& e) {
    messages.all += (messages.all.empty() ? "" : "; ") + std::string(e.what());
  }
  if (!model) {
    Diagnostics diagnostics;
    DoubleAttributes twice(source, diagnostics);
    source.robot().traverse(twice);
    source.throw_if_errors(diagnostics);
    diagnostics.error(source.place_of_name_in(messages.all), messages.all);
    source.throw_if_errors(diagnostics);
  }
  return model;
}

}  // namespace kinecal::detail
