// SPDX-License-Identifier: Apache-2.0
#include "describe.hpp"

#include <fmt/core.h>

#include <string_view>
#include <vector>

#include "kinecal/files/results/file_set.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// The commands that --help lists, in its order.
std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

/// "--urdf"; empty for a positional argument.
std::string option_name(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

/// What follows an option: "FILE"; empty for a flag.
std::string value_name(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return "";
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

/// The values of an option that has a list of them, as CLI11 shows it: "TEXT:{rising,origin}".
std::vector<std::string> values_of(const CLI::Option& option) {
  std::vector<std::string> values;
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return values;
  std::string value;
  for (const char c : type.substr(begin + 1, end - begin - 1) + ",") {
    if (c != ',') {
      value += c;
    } else {
      values.push_back(std::move(value));
      value.clear();
    }
  }
  return values;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// A text between single quotes of zsh, in which brackets and colons end nothing.
std::string zsh_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
    } else {
      if (std::string_view("[]:\\").find(c) != std::string_view::npos) result += '\\';
      result += c;
    }
  }
  return result;
}

/// A text in single quotes of fish.
std::string fish_text(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c;
  }
  return result + "'";
}

/// A text of a manual page.  No line of it is a request of troff.
std::string troff(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  return result.starts_with('.') || result.starts_with('\'') ? "\\&" + result : result;
}

/// Names of the commands, or of the long options of a command.
std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
  return names;
}
std::vector<std::string> long_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (!option_name(*option).empty()) names.push_back(option_name(*option));
  }
  return names;
}

/// The entry of an option in a manual page.
std::string man_option(const CLI::Option& option) {
  const std::string name = option_name(option), value = value_name(option);
  std::string title =
      name.empty() ? "\\fI" + troff(option.get_name(true)) + "\\fR" : "\\fB" + troff(name) + "\\fR";
  if (!name.empty() && !value.empty()) title += " \\fI" + troff(value) + "\\fR";
  std::string text = option.get_description();
  if (const auto values = values_of(option); !values.empty()) {
    text += "; one of: " + joined(values);
  }
  if (!option.get_default_str().empty()) text += "; default: " + option.get_default_str();
  return ".TP\n" + title + "\n" + troff(text) + "\n";
}

}  // namespace

std::string man_page(const CLI::App& app) {
  std::string text = fmt::format(
      ".TH KINECAL 1 \"\" \"kinecal {}\" \"User Commands\"\n"
      ".SH NAME\nkinecal \\- calibrate robots\n"
      ".SH SYNOPSIS\n.B kinecal\n\\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n"
      ".SH DESCRIPTION\n{}\n.SH OPTIONS\n",
      KINECAL_VERSION, troff(app.get_description()));
  for (const CLI::Option* option : app.get_options()) text += man_option(*option);
  text += ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(app)) {
    text += ".SS " + troff(command->get_name()) + "\n" + troff(command->get_description()) + ".\n";
    for (const CLI::Option* option : command->get_options()) {
      if (option_name(*option) != "--help") text += man_option(*option);
    }
  }
  return text +
         ".SH EXIT STATUS\n.TP\n0\nThe command did what it should.\n.TP\n1\nThe input or the "
         "arguments are wrong; nothing is written.\n.TP\n2\nThe robot is not calibrated, and "
         "nothing "
         "is written; or, of verify, the result does not hold any more.\n.SH EXAMPLE\n.nf\nkinecal "
         "init \\-\\-urdf robot.urdf\nkinecal calibrate "
         "\\-\\-urdf robot.urdf \\-\\-config calibrate.yaml \\e\n    \\-\\-samples samples.yaml "
         "\\-\\-output calibrated\n.fi\n";
}

std::string bash_completion(const CLI::App& app) {
  std::string options, values;
  for (const CLI::App* command : commands_of(app)) {
    options +=
        fmt::format("    {}) words=\"{}\" ;;\n", command->get_name(), joined(long_names(*command)));
    for (const CLI::Option* option : command->get_options()) {
      const auto list = values_of(*option);
      if (list.empty() || option_name(*option).empty()) continue;
      values += fmt::format("    \"{} {}\") words=\"{}\" ;;\n", command->get_name(),
                            option_name(*option), joined(list));
    }
  }
  const std::string names = joined(command_names(app));
  return "# Completion of kinecal for bash.\n_kinecal() {\n"
         "  local word=\"${COMP_WORDS[COMP_CWORD]}\" words=\"\"\n"
         "  local command=\"${COMP_WORDS[1]}\" before=\"${COMP_WORDS[COMP_CWORD-1]}\"\n"
         "  if [ \"$word\" = \"=\" ]; then word=\"\"\n"
         "  elif [ \"$before\" = \"=\" ]; then before=\"${COMP_WORDS[COMP_CWORD-2]}\"; fi\n"
         "  case \"$command $before\" in\n" +
         values + "    \"help help\") words=\"" + names +
         "\" ;;\n  esac\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n    words=\"" +
         names + " " + joined(long_names(app)) +
         "\"\n  elif [ -z \"$words\" ] && [[ \"$word\" == -* ]]; then\n"
         "    case \"$command\" in\n" +
         options +
         "    esac\n  fi\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n}\n"
         "complete -o default -F _kinecal kinecal\n";
}

std::string zsh_completion(const CLI::App& app) {
  std::string names, cases;
  for (const CLI::App* command : commands_of(app)) {
    names +=
        fmt::format("    '{}:{}'\n", command->get_name(), zsh_text(command->get_description()));
    cases += fmt::format("    {})\n      _arguments", command->get_name());
    for (const CLI::Option* option : command->get_options()) {
      if (option_name(*option).empty()) continue;
      const auto list = values_of(*option);
      const std::string value = !list.empty() ? ":value:(" + joined(list) + ")"
                                : value_name(*option).empty()
                                    ? ""
                                    : ":" + value_name(*option) + ":_files";
      cases += fmt::format(" \\\n        '*{}[{}]{}'", option_name(*option),
                           zsh_text(option->get_description()), value);
    }
    cases += " \\\n        '*:file:_files'\n      ;;\n";
  }
  return "#compdef kinecal\n# Completion of kinecal for zsh.\n_kinecal() {\n"
         "  local -a commands\n  commands=(\n" +
         names +
         "  )\n  if (( CURRENT == 2 )); then\n    _describe command commands\n    return\n  fi\n"
         "  local command=$words[2]\n  shift words\n  (( CURRENT-- ))\n  case $command in\n" +
         cases + "  esac\n}\n_kinecal \"$@\"\n";
}

std::string fish_completion(const CLI::App& app) {
  std::string text = "# Completion of kinecal for fish.\n";
  for (const CLI::App* command : commands_of(app)) {
    const std::string& name = command->get_name();
    text += fmt::format("complete -c kinecal -n __fish_use_subcommand -f -a {} -d {}\n", name,
                        fish_text(command->get_description()));
    for (const CLI::Option* option : command->get_options()) {
      if (option_name(*option).empty()) continue;
      const auto list = values_of(*option);
      const std::string value = !list.empty()                 ? " -x -a " + fish_text(joined(list))
                                : value_name(*option).empty() ? ""
                                                              : " -r";
      text += fmt::format("complete -c kinecal -n '__fish_seen_subcommand_from {}' -l {}{} -d {}\n",
                          name, option_name(*option).substr(2), value,
                          fish_text(option->get_description()));
    }
  }
  return text;
}

int describe(const CLI::App& app, const DescribeOptions& options) {
  const std::string text = options.format == "man"    ? man_page(app)
                           : options.format == "bash" ? bash_completion(app)
                           : options.format == "fish" ? fish_completion(app)
                                                      : zsh_completion(app);
  if (options.output.empty()) {
    say("{}", text);
  } else {
    check_output(options.output, {}, options.force);
    write_output(options.output, text);
  }
  return kDone;
}

}  // namespace kinecal::cli
