// Reads a file of samples piece by piece on several threads.
//
// The pieces do not depend on the number of threads, and are joined in file order.  So samples and
// messages do not depend on the number of threads either.  Memory holds the samples and one piece
// per thread.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <future>
#include <istream>
#include <iterator>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/samples/sample_camera.ipp"
#include "kinecal/files/samples/sample_handler.ipp"
#include "kinecal/files/yaml/yaml_events.ipp"
#include "kinecal/files/yaml/yaml_pieces.ipp"
#include "kinecal/samples/progress_meter.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

// Lines that ROS tools print among the messages of a topic in YAML.
//
// ros2 topic echo    A message was lost!!!, with two lines of counts
// rostopic echo      WARNING: no messages received and simulated time is active. / Is /clock being
//                    published?

/// Blanks the output of a tool in a piece of a file, so that the rest is readable.
/// @return  an error for each output
[[nodiscard]] inline std::vector<SampleErrors::Message> take_tool_output(YamlPiece& piece) {
  struct Output {
    std::string_view begin;
    int lines;
  };
  constexpr Output kOutputs[] = {{"A message was lost!!!", 3},
                                 {"WARNING: no messages received and simulated time", 2}};
  std::string& text = piece.text;
  std::vector<SampleErrors::Message> errors;
  for (const auto& [begin, lines] : kOutputs) {
    for (std::size_t at = 0; (at = text.find(begin, at)) != std::string::npos; ++at) {
      if (at > 0 && text[at - 1] != '\n') continue;
      const auto line = piece.line + static_cast<int>(std::count(&text[0], &text[at], '\n'));
      errors.push_back({line, fmt::format("lines {} to {} are output of the tool that recorded the "
                                          "file; delete them",
                                          line, line + lines - 1)});
      for (int left = lines; at < text.size() && left > 0; ++at) {
        if (text[at] == '\n') --left;
        if (text[at] != '\n') text[at] = ' ';
      }
      --at;  // the next output may follow at once
    }
  }
  return errors;
}

/// Adds the errors of a tool's output in line order.
inline void add_in_order(SampleErrors& all, std::vector<SampleErrors::Message> outputs) {
  for (SampleErrors::Message& output : outputs) {
    const auto is_later = [&](const SampleErrors::Message& m) { return m.line > output.line; };
    auto place = std::find_if(all.errors.begin(), all.errors.end(), is_later);
    all.errors.insert(place, std::move(output));
  }
}

/// True if a line from this one on begins with `---`: then the document there is not the last one.
[[nodiscard]] inline bool has_marker_from(const YamlPiece& piece, int line) {
  const std::string& text = piece.text;
  std::size_t at = 0;
  for (int before = piece.line; before < line && at < text.size(); ++before) {
    at = std::min(text.find('\n', at), text.size() - 1) + 1;
  }
  for (; (at = text.find("---", at)) != std::string::npos; ++at) {
    if ((at == 0 || text[at - 1] == '\n') && is_yaml_marker(text, at)) return true;
  }
  return false;
}

/// The content of a piece of a file.
struct SamplePiece {
  std::vector<Sample> samples;
  SampleErrors errors;
  std::optional<YamlError> not_yaml;    ///< the reason if it was not read completely
  int sample_line = 0;                  ///< where its last sample begins
  bool last_document_is_empty = false;  ///< as after a final `---`
  bool may_be_cut_off = false;          ///< invalid YAML in the file's last document

  /// True if the rest of the file will not be read.
  [[nodiscard]] bool stops() const { return not_yaml || errors.too_many(); }
};

[[nodiscard]] inline SamplePiece read_sample_piece(const std::string& file, YamlPiece piece) {
  SampleHandler handler(file);
  SamplePiece read;
  std::vector<SampleErrors::Message> outputs = take_tool_output(piece);
  try {
    YamlEvents events(piece.text, piece.line);
    while (!handler.builder().errors().too_many() && events.next_document(handler)) {
    }
  } catch (const YamlError& e) {
    read.not_yaml = e;
    read.may_be_cut_off = !has_marker_from(piece, e.line);
  }
  read.samples = handler.take();
  read.errors = std::move(handler.builder().errors());
  add_in_order(read.errors, std::move(outputs));
  read.sample_line = handler.builder().sample_line();
  read.last_document_is_empty = handler.last_document_is_empty();
  return read;
}

class SampleFile {
 public:
  /// Size of a piece, bytes: some 100 samples, so that the threads end at about the same time.
  static constexpr std::size_t kPieceBytes = std::size_t{1} << 18;

  /// @param file  name of the file in messages
  SampleFile(std::istream& in, std::string file, std::size_t piece_bytes = kPieceBytes)
      : file_(std::move(file)), pieces_(in, piece_bytes) {}

  /// Reports the progress of reading.
  /// @param bytes  size of the file
  void show_progress(std::uintmax_t bytes, const ProgressMeter& meter) {
    bytes_ = bytes;
    meter_ = meter;
  }

  /// Reads the file to its end, to the first invalid YAML, or until there are too many errors.
  void read(std::size_t threads) {
    std::vector<std::future<void>> others;
    try {
      while (others.size() + 1 < threads) {
        others.push_back(std::async(std::launch::async, [this] { work(); }));
      }
    } catch (const std::system_error&) {  // no more threads available: continue with fewer
    }
    work();
    for (std::future<void>& other : others) other.get();
  }

  /// The samples in file order, and their errors.
  [[nodiscard]] std::vector<Sample> take(Diagnostics& diagnostics) {
    std::vector<Sample> samples;
    SampleErrors all;
    int sample_line = 0;
    for (SamplePiece& piece : read_) {
      std::move(piece.samples.begin(), piece.samples.end(), std::back_inserter(samples));
      piece.samples = {};
      for (auto& [line, text] : piece.errors.errors) all.add(line, std::move(text));
      for (auto& [line, text] : piece.errors.warnings) all.warn_once(line, std::move(text));
      if (piece.sample_line > 0) sample_line = piece.sample_line;
      if (piece.not_yaml) all.add(piece.not_yaml->line, not_yaml(piece, sample_line));
      if (piece.stops() || all.too_many()) break;
      if (&piece == &read_.back() && is_wrong_at_end(piece, all)) {
        all.errors.back().text += "; is the file cut off?";
      }
    }
    if (all.errors.empty()) check_end(samples, sample_line, all);
    report(all, file_, diagnostics);
    return samples;
  }

 private:
  /// One thread's work: pieces, until there are no more.
  void work() {
    for (;;) {
      std::unique_lock lock(mutex_);
      std::optional<YamlPiece> piece;
      if (!stopped_) piece = next();
      if (!piece) return;
      done_ += piece->text.size();
      if (meter_ && bytes_ > 0) {
        meter_(std::min(1.0, double(done_) / double(bytes_)), "reading " + file_);
      }
      SamplePiece& read = read_.emplace_back();  // its address is stable while others are added
      lock.unlock();
      read = read_sample_piece(file_, std::move(*piece));
      if (!read.stops()) continue;
      lock.lock();
      stopped_ = true;
    }
  }

  [[nodiscard]] std::optional<YamlPiece> next() {
    try {
      return pieces_.next();
    } catch (const YamlError& e) {
      read_.emplace_back().not_yaml = e;
      stopped_ = true;
      return std::nullopt;
    }
  }

  [[nodiscard]] static std::string not_yaml(const SamplePiece& piece, int sample_line) {
    std::string text = fmt::format("not YAML: {}", piece.not_yaml->what());
    if (sample_line > 0) text += fmt::format("; the last sample begins at line {}", sample_line);
    return text + (piece.may_be_cut_off ? "; is the file cut off?" : "");
  }

  /// True if the last error is in the last sample of the file, which is not followed by `---`.
  [[nodiscard]] static bool is_wrong_at_end(const SamplePiece& last, const SampleErrors& all) {
    return !last.last_document_is_empty && last.sample_line > 0 && !all.errors.empty() &&
           all.errors.back().line >= last.sample_line;
  }

  /// An interrupted recording may end in the middle of a number and still be valid YAML.
  void check_end(const std::vector<Sample>& samples, int sample_line, SampleErrors& all) const {
    if (samples.empty()) {
      all.add(0, done_ == 0 ? "no samples: the file is empty" : "no samples in this file");
    } else if (!read_.back().last_document_is_empty) {
      const char last = pieces_.last();
      if (last == '\n' || last == '}' || last == ']') {
        all.warn(sample_line,
                 "no '---' after this sample, the last one; if the file is cut off, observations "
                 "are missing");
      } else {
        all.add(sample_line,
                "the file ends within a line of this sample, the last one; if it is not cut off, "
                "add a line '---'");
      }
    }
  }

  std::string file_;
  std::mutex mutex_;  ///< guards the members below while threads work
  YamlPieces pieces_;
  std::deque<SamplePiece> read_;  ///< in the order of the file
  bool stopped_ = false;
  ProgressMeter meter_;
  std::uintmax_t bytes_ = 0, done_ = 0;  ///< of the file, for the meter
};

}  // namespace kinecal::detail
