// Any bytes as a .db3 file: nothing crashes, hangs or grows.
#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kinecal/files/bags/rosbag2/db3_messages.ipp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);  // SQLite demands what it may write to
  volatile std::uint64_t read = 0;                     // so that the messages' bytes are looked at
  kinecal::BagReader reader;
  reader.wants = [](const kinecal::BagTopic& topic) { return topic.name.size() % 2 == 0; };
  reader.handle = [&](const kinecal::BagMessage& message) {
    for (const std::byte byte : message.data) read = read + std::to_integer<std::uint64_t>(byte);
  };
  const auto open = [&] {
    kinecal::detail::SqliteDatabase database("file::memory:", size);
    const auto count = static_cast<sqlite3_int64>(bytes.size());
    sqlite3_deserialize(database.handle(), "main", bytes.data(), count, count,
                        SQLITE_DESERIALIZE_READONLY);
    return database;
  };
  kinecal::Diagnostics diagnostics;
  kinecal::detail::read_db3_database(open, "fuzz.db3", reader, diagnostics);
  return 0;
}
