// Definitions of history.hpp, by SQLite.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/watch/history.hpp"

#include <string_view>
#include <utility>

#include "kinecal/files/diagnostics.hpp"

#ifdef KINECAL_HAVE_SQLITE

#include <fmt/core.h>
#include <sqlite3.h>

#include <cstring>
#include <set>

namespace kinecal {

namespace detail {
namespace {

/// "kcal": tells a history from other databases.
constexpr std::int64_t kApplication = 0x6B63616C;
/// Of the tables below.
constexpr std::int64_t kVersion = 1;

constexpr const char* kTables = R"(
CREATE TABLE robot(id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, structure TEXT NOT NULL);
CREATE TABLE epoch(id INTEGER PRIMARY KEY, robot INTEGER NOT NULL REFERENCES robot, result TEXT NOT NULL,
  UNIQUE(robot, result));
CREATE TABLE recording(id INTEGER PRIMARY KEY, robot INTEGER NOT NULL REFERENCES robot,
  epoch INTEGER NOT NULL REFERENCES epoch, name TEXT NOT NULL, checksum TEXT NOT NULL, time REAL NOT NULL,
  state INTEGER NOT NULL, reason TEXT NOT NULL, samples INTEGER NOT NULL, statistic REAL, freedom REAL,
  probability REAL, UNIQUE(robot, checksum));
CREATE INDEX recording_by_epoch ON recording(epoch, time);
CREATE INDEX recording_by_content ON recording(checksum);
CREATE TABLE change(recording INTEGER NOT NULL REFERENCES recording ON DELETE CASCADE, owner TEXT NOT NULL,
  is_frame INTEGER NOT NULL, parameters TEXT NOT NULL, units TEXT NOT NULL, change BLOB NOT NULL,
  covariance BLOB NOT NULL, score REAL, explains INTEGER NOT NULL);
CREATE INDEX change_by_recording ON change(recording);
CREATE TABLE seen(robot INTEGER NOT NULL REFERENCES robot, name TEXT NOT NULL, size INTEGER NOT NULL,
  modified INTEGER NOT NULL, PRIMARY KEY(robot, name)) WITHOUT ROWID;
)";

/// Names as lines, which no name in a URDF contains.
[[nodiscard]] std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

[[nodiscard]] std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  for (std::size_t end = 0; (end = text.find('\n')) != text.npos; text.remove_prefix(end + 1)) {
    lines.emplace_back(text.substr(0, end));
  }
  return lines;
}

}  // namespace

/// The database of a history.
class HistoryFile {
 public:
  HistoryFile(std::string path, double wait) : path_(std::move(path)) {
    sqlite3* made = nullptr;
    const int code =
        sqlite3_open_v2(path_.c_str(), &made,
                        SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
    handle_.reset(made);
    check(code);
    sqlite3_extended_result_codes(made, 1);
    sqlite3_busy_timeout(made, static_cast<int>(1e3 * wait));
    sqlite3_db_config(made, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(made, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    run("PRAGMA foreign_keys = ON");
    prepare();
  }

  /// A transaction that is undone unless it is kept.
  class Transaction {
   public:
    explicit Transaction(HistoryFile& file) : file_(file) { file_.run("BEGIN IMMEDIATE"); }
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    ~Transaction() {
      if (!is_kept_) sqlite3_exec(file_.handle_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
    }
    void keep() {
      file_.run("COMMIT");
      is_kept_ = true;
    }

   private:
    HistoryFile& file_;
    bool is_kept_ = false;
  };

  /// A statement, its values in the order of their '?', and its rows.
  class Query {
   public:
    template <class... Values>
    explicit Query(const HistoryFile& file, const char* sql, const Values&... values)
        : file_(file) {
      sqlite3_stmt* made = nullptr;
      const int code = sqlite3_prepare_v2(file.handle_.get(), sql, -1, &made, nullptr);
      handle_.reset(made);
      file_.check(code);
      (bind(values), ...);
    }
    /// Goes to the next row; false if there is none.
    [[nodiscard]] bool next() {
      const int code = sqlite3_step(handle_.get());
      if (code != SQLITE_ROW && code != SQLITE_DONE) file_.check(code);
      return code == SQLITE_ROW;
    }
    void run() {
      while (next()) {
      }
    }
    [[nodiscard]] std::int64_t integer(int column) const {
      return sqlite3_column_int64(handle_.get(), column);
    }
    [[nodiscard]] double number(int column) const {
      return sqlite3_column_double(handle_.get(), column);
    }
    [[nodiscard]] std::string text(int column) const {
      const auto* data = static_cast<const char*>(sqlite3_column_blob(handle_.get(), column));
      return data ? std::string(
                        data, static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column)))
                  : std::string();
    }
    [[nodiscard]] std::vector<double> numbers(int column) const {
      const std::string bytes = text(column);
      std::vector<double> values(bytes.size() / sizeof(double));
      if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
      return values;
    }

   private:
    struct Finalize {
      void operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }
    };
    void bind(const std::string& text) {
      file_.check(sqlite3_bind_text(handle_.get(), ++bound_, text.data(),
                                    static_cast<int>(text.size()), SQLITE_TRANSIENT));
    }
    void bind(std::int64_t value) {
      file_.check(sqlite3_bind_int64(handle_.get(), ++bound_, value));
    }
    void bind(double value) { file_.check(sqlite3_bind_double(handle_.get(), ++bound_, value)); }
    void bind(const std::vector<double>& values) {
      file_.check(sqlite3_bind_blob(handle_.get(), ++bound_, values.data(),
                                    static_cast<int>(values.size() * sizeof(double)),
                                    SQLITE_TRANSIENT));
    }

    const HistoryFile& file_;
    int bound_ = 0;
    std::unique_ptr<sqlite3_stmt, Finalize> handle_;
  };

  void run(const char* sql) { check(sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr)); }
  [[nodiscard]] std::int64_t last_row() const { return sqlite3_last_insert_rowid(handle_.get()); }
  [[nodiscard]] bool has_changed_a_row() const { return sqlite3_changes(handle_.get()) > 0; }
  [[nodiscard]] const std::string& path() const { return path_; }

  std::set<std::pair<std::int64_t, std::string>> looked_at;  ///< since the start, robot and name

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
  };

  /// @throws InputError  with what to do, unless it is SQLITE_OK
  void check(int code) const {
    if (code == SQLITE_OK) return;
    const std::string text = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code);
    switch (code & 0xFF) {
      case SQLITE_BUSY:
      case SQLITE_LOCKED:
        throw InputError(
            path_ + ": another 'kinecal watch' is writing to it; nothing was added, try again");
      case SQLITE_FULL:
      case SQLITE_IOERR:
        throw InputError(path_ + ": cannot be written: " + text +
                         "; is the disk full?  What was found last is not in the history, which is "
                         "as it was before");
      case SQLITE_READONLY:
      case SQLITE_CANTOPEN:
      case SQLITE_PERM:
        throw InputError(path_ + ": cannot be written: " + text +
                         "; give another file with --history");
      case SQLITE_NOTADB:
        throw InputError(path_ +
                         ": is not a history of 'kinecal watch'; give another file with --history");
      case SQLITE_CORRUPT:
        throw InputError(
            path_ + ": the history is damaged: " + text +
            "; \"sqlite3 <file> .recover\" may save what is left, or move it away to begin anew");
      default:
        throw InputError(path_ + ": " + text);
    }
  }
  [[nodiscard]] std::int64_t pragma(const char* sql) const {
    Query query(*this, sql);
    return query.next() ? query.integer(0) : 0;
  }
  /// Checks that it is a history, or makes an empty file one.
  void prepare() {
    if (pragma("PRAGMA application_id") == 0 && pragma("SELECT count(*) FROM sqlite_master") == 0) {
      Transaction adding(*this);
      if (pragma("SELECT count(*) FROM sqlite_master") ==
          0) {  // another watcher may have been faster
        run(kTables);
        run(fmt::format("PRAGMA application_id = {}", kApplication).c_str());
        run(fmt::format("PRAGMA user_version = {}", kVersion).c_str());
      }
      adding.keep();
    }
    if (pragma("PRAGMA application_id") != kApplication) check(SQLITE_NOTADB);
    if (const std::int64_t version = pragma("PRAGMA user_version"); version > kVersion) {
      throw InputError(
          fmt::format("{}: is a history of version {}, and this kinecal reads up to {}", path_,
                      version, kVersion));
    }
  }

  std::string path_;
  std::unique_ptr<sqlite3, Close> handle_;
};

namespace {

using Query = HistoryFile::Query;

[[nodiscard]] std::int64_t robot_of(const HistoryFile& file, std::int64_t epoch) {
  Query query(file, "SELECT robot FROM epoch WHERE id = ?", epoch);
  return query.next() ? query.integer(0) : 0;
}

void add_changes(const HistoryFile& file, std::int64_t recording,
                 const std::vector<WatchedChange>& changes) {
  for (const WatchedChange& of : changes) {
    Query(file, "INSERT INTO change VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)", recording, of.owner,
          std::int64_t{of.is_frame}, joined(of.parameters), joined(of.units), of.change,
          of.covariance, of.score, std::int64_t{of.explains})
        .run();
  }
}

}  // namespace
}  // namespace detail

History::History(const std::string& file, double wait)
    : file_(std::make_unique<detail::HistoryFile>(file, wait)) {}
History::~History() = default;

std::int64_t History::epoch(const std::string& robot, const std::string& structure,
                            const std::string& result) {
  {
    detail::Query known(
        *file_,
        "SELECT robot.structure, epoch.id FROM robot LEFT JOIN epoch ON epoch.robot = robot.id AND "
        "epoch.result = ? WHERE robot.name = ?",
        result, robot);
    if (known.next()) {
      if (known.text(0) != structure) {
        throw InputError(
            fmt::format("{}: robot '{}' there has other links or joints than the one in its "
                        "folder: it is the history of another "
                        "robot; rename the folder, or give another file with --history",
                        file_->path(), robot));
      }
      if (known.integer(1) > 0) return known.integer(1);
    }
  }
  detail::HistoryFile::Transaction adding(*file_);
  detail::Query(*file_, "INSERT OR IGNORE INTO robot(name, structure) VALUES(?, ?)", robot,
                structure)
      .run();
  detail::Query(*file_,
                "INSERT OR IGNORE INTO epoch(robot, result) SELECT id, ? FROM robot WHERE name = ?",
                result, robot)
      .run();
  detail::Query made(
      *file_,
      "SELECT epoch.id FROM epoch JOIN robot ON robot.id = epoch.robot WHERE robot.name = ? AND "
      "epoch.result = ?",
      robot, result);
  const std::int64_t id = made.next() ? made.integer(0) : 0;
  adding.keep();
  return id;
}

bool History::follows_another(std::int64_t epoch) const {
  return detail::Query(*file_, "SELECT 1 FROM epoch WHERE robot = ? AND id < ?",
                       detail::robot_of(*file_, epoch), epoch)
      .next();
}

bool History::knows(std::int64_t epoch, const WatchedRecording& file) const {
  const std::int64_t robot = detail::robot_of(*file_, epoch);
  const bool is_seen =
      detail::Query(*file_,
                    "SELECT 1 FROM seen WHERE robot = ? AND name = ? AND size = ? AND modified = ?",
                    robot, file.name, file.size, file.modified)
          .next();
  if (!is_seen || file_->looked_at.contains({robot, file.name})) return is_seen;
  return !detail::Query(*file_,
                        "SELECT 1 FROM recording WHERE epoch = ? AND name = ? AND state = ?", epoch,
                        file.name, static_cast<std::int64_t>(RecordingState::refused))
              .next();
}

std::optional<History::Place> History::with_content(const std::string& checksum) const {
  detail::Query query(
      *file_,
      "SELECT robot.name, recording.name FROM recording JOIN robot ON robot.id = recording.robot "
      "WHERE checksum = ? AND state != ?",
      checksum, static_cast<std::int64_t>(RecordingState::refused));
  if (!query.next()) return std::nullopt;
  return Place{query.text(0), query.text(1)};
}

void History::add(std::int64_t epoch, std::span<const WatchedRecording> recordings) {
  if (recordings.empty()) return;
  detail::HistoryFile::Transaction adding(*file_);
  const std::int64_t robot = detail::robot_of(*file_, epoch);
  for (const WatchedRecording& of : recordings) {
    if (of.may_pass) {
      detail::Query(*file_, "DELETE FROM seen WHERE robot = ? AND name = ?", robot, of.name).run();
    } else {
      detail::Query(*file_, "INSERT OR REPLACE INTO seen VALUES(?, ?, ?, ?)", robot, of.name,
                    of.size, of.modified)
          .run();
    }
    detail::Query(*file_, "DELETE FROM recording WHERE robot = ? AND name = ? AND state = ?", robot,
                  of.name, static_cast<std::int64_t>(RecordingState::refused))
        .run();
    detail::Query(*file_,
                  "INSERT OR IGNORE INTO recording(robot, epoch, name, checksum, time, state, "
                  "reason, samples, "
                  "statistic, freedom, probability) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                  robot, epoch, of.name, of.checksum, of.time, static_cast<std::int64_t>(of.state),
                  of.reason, std::int64_t{of.samples}, of.statistic, of.freedom, of.probability)
        .run();
    if (file_->has_changed_a_row()) detail::add_changes(*file_, file_->last_row(), of.changes);
  }
  adding.keep();
  for (const WatchedRecording& of : recordings) file_->looked_at.emplace(robot, of.name);
}

std::vector<WatchedRecording> History::recordings(std::int64_t epoch) const {
  std::vector<WatchedRecording> all;
  detail::Query query(*file_,
                      "SELECT id, name, checksum, time, state, reason, samples, statistic, "
                      "freedom, probability FROM "
                      "recording WHERE epoch = ? ORDER BY time, id",
                      epoch);
  while (query.next()) {
    WatchedRecording& of = all.emplace_back();
    of.name = query.text(1);
    of.checksum = query.text(2);
    of.time = query.number(3);
    of.state = static_cast<RecordingState>(query.integer(4));
    of.reason = query.text(5);
    of.samples = static_cast<int>(query.integer(6));
    of.statistic = query.number(7);
    of.freedom = query.number(8);
    of.probability = query.number(9);
    detail::Query changes(*file_,
                          "SELECT owner, is_frame, parameters, units, change, covariance, score, "
                          "explains FROM change "
                          "WHERE recording = ?",
                          query.integer(0));
    while (changes.next()) {
      of.changes.push_back({changes.text(0), changes.integer(1) != 0,
                            detail::lines_of(changes.text(2)), detail::lines_of(changes.text(3)),
                            changes.numbers(4), changes.numbers(5), changes.number(6),
                            changes.integer(7) != 0});
    }
  }
  return all;
}

}  // namespace kinecal

#else

namespace kinecal {

namespace detail {
class HistoryFile {};
}  // namespace detail

History::History(const std::string& file, double) {
  throw InputError(
      file +
      ": a history is an SQLite file, and this kinecal was built without libsqlite3; install "
      "libsqlite3-dev and build again");
}
History::~History() = default;
std::int64_t History::epoch(const std::string&, const std::string&, const std::string&) {
  return 0;
}
bool History::follows_another(std::int64_t) const {
  return false;
}
bool History::knows(std::int64_t, const WatchedRecording&) const {
  return false;
}
std::optional<History::Place> History::with_content(const std::string&) const {
  return std::nullopt;
}
void History::add(std::int64_t, std::span<const WatchedRecording>) {}
std::vector<WatchedRecording> History::recordings(std::int64_t) const {
  return {};
}

}  // namespace kinecal

#endif
