// SPDX-License-Identifier: Apache-2.0
#include "formats/sqlite_bag.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <new>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <sqlite3.h>

#include "base/file_kind.h"
#include "base/message_text.h"
#include "formats/mcap_chunk.h"

namespace disparityd::formats {
namespace {

constexpr std::size_t row_bytes = 100;  // that a row counts as, beside its texts
constexpr std::size_t most_topics = 10000;

/// Returns the name by which SQLite opens a file without writing beside it. It then takes no part in what another
/// program writes, which a write-ahead log beside the file would hold.
std::string uri_of(const std::string& path) {
    std::string uri = "file:";
    for (const char c : path.starts_with('/') ? path : "./" + path) {
        uri += c == '%' ? "%25" : c == '?' ? "%3f" : c == '#' ? "%23" : std::string(1, c);
    }
    return uri + (std::filesystem::exists(path + "-wal") ? "?mode=ro" : "?mode=ro&immutable=1");
}

std::uint64_t nanoseconds(std::int64_t stamp) {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(stamp, 0));
}

}  // namespace

void SqliteBag::Close::operator()(sqlite3* database) const {
    sqlite3_close(database);
}

void SqliteBag::Close::operator()(sqlite3_stmt* statement) const {
    sqlite3_finalize(statement);
}

SqliteBag::SqliteBag(const std::string& path) : path_(path) {
    if (!base::is_file(path)) {
        throw std::invalid_argument(path + ": no such file");
    }
    open();
    for (const char* table : {"topics", "messages"}) {
        if (!has_table(table)) {
            throw std::invalid_argument(path + ": is no ROS 2 bag: this database has no table '" + table + "'");
        }
        check_table(table);
    }
    read_topics();
    if (has_table("message_definitions")) {
        check_table("message_definitions");
        read_definitions();
    }
    sqlite3_progress_handler(database_.get(), 0, nullptr, nullptr);  // messages may be many
    // In the order of their numbers, which is that of the recording: an index would have to be sorted.
    messages_ = prepare("SELECT id, topic_id, timestamp, data FROM messages NOT INDEXED");
}

void SqliteBag::open() {
    sqlite3* made = nullptr;
    const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX;
    const int result = sqlite3_open_v2(uri_of(path_).c_str(), &made, flags, nullptr);
    database_.reset(made);
    if (made == nullptr) {
        throw std::bad_alloc();
    }
    if (result != SQLITE_OK) {
        throw std::runtime_error(path_ + ": cannot be read: " + sqlite3_errmsg(made));
    }
    for (const int off :
         {SQLITE_DBCONFIG_ENABLE_VIEW, SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_TRUSTED_SCHEMA}) {
        sqlite3_db_config(made, off, 0, nullptr);
    }
    sqlite3_db_config(made, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_limit(made, SQLITE_LIMIT_LENGTH, static_cast<int>(mcap_most_bytes));
    // Pages that are named again and again make tables without end.
    constexpr int most_operations = 10'000'000;  // of a statement
    sqlite3_progress_handler(
        made, most_operations, [](void*) { return 1; }, nullptr);
    step(prepare("PRAGMA cache_size=-2000").get());  // KiB; else the file says how many pages are kept
}

void SqliteBag::fail(const std::string& what) const {
    throw std::runtime_error(path_ + ": is damaged: " + what);
}

void SqliteBag::fail_of_database() const {
    const int code = sqlite3_errcode(database_.get());
    if (code == SQLITE_NOMEM) {
        throw std::bad_alloc();
    }
    if (code == SQLITE_NOTADB) {
        throw std::invalid_argument(path_ + ": is no .db3 bag: it does not begin as a database of SQLite");
    }
    if (code == SQLITE_INTERRUPT) {
        fail("its tables have more rows than a bag has, or do not end");
    }
    if (code == SQLITE_TOOBIG) {
        fail("a message has more than " + std::to_string(mcap_most_bytes) + " bytes, which is the most allowed");
    }
    const std::string what = base::printable(sqlite3_errmsg(database_.get()));
    if (code == SQLITE_CORRUPT) {
        fail("SQLite says: " + what + "; `sqlite3 OLD.db3 .recover | sqlite3 NEW.db3` saves what can be saved");
    }
    throw std::runtime_error(path_ + ": cannot be read: SQLite says: " + what);
}

SqliteBag::Statement SqliteBag::prepare(const std::string& query) const {
    sqlite3_stmt* made = nullptr;
    if (sqlite3_prepare_v2(database_.get(), query.c_str(), -1, &made, nullptr) != SQLITE_OK) {
        fail_of_database();
    }
    return Statement(made);
}

bool SqliteBag::step(sqlite3_stmt* statement) const {
    const int result = sqlite3_step(statement);
    if (result != SQLITE_ROW && result != SQLITE_DONE) {
        fail_of_database();
    }
    return result == SQLITE_ROW;
}

bool SqliteBag::has_table(const std::string& name) const {
    return step(prepare("SELECT 1 FROM sqlite_master WHERE name = '" + name + "'").get());
}

/// Refuses what is no plain table: its rows are made by what the file says, without end.
void SqliteBag::check_table(const std::string& name) const {
    const Statement kind = prepare("SELECT type, rootpage FROM sqlite_master WHERE name = '" + name + "'");
    bool plain = true;
    while (step(kind.get())) {
        const auto* type = reinterpret_cast<const char*>(sqlite3_column_text(kind.get(), 0));
        plain =
            plain && type != nullptr && std::string_view(type) == "table" && sqlite3_column_int64(kind.get(), 1) > 0;
    }
    const Statement computed = prepare("SELECT 1 FROM pragma_table_xinfo('" + name + "') WHERE hidden <> 0");
    if (!plain || step(computed.get())) {
        throw std::invalid_argument(path_ + ": is no ROS 2 bag: '" + name + "' in this database is no plain table");
    }
}

void SqliteBag::count_text(std::size_t bytes) {
    text_bytes_ += bytes;
    if (text_bytes_ > most_bag_text_bytes) {
        fail("its topics and definitions have more than " + std::to_string(most_bag_text_bytes) + " bytes");
    }
}

std::string SqliteBag::text_of(sqlite3_stmt* row, int column) {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, column));
    count_text(size);
    return text == nullptr ? std::string() : std::string(text, size);
}

void SqliteBag::read_topics() {
    const Statement rows = prepare("SELECT id, name, type, serialization_format FROM topics");
    while (step(rows.get())) {
        count_text(row_bytes);
        const std::int64_t id = sqlite3_column_int64(rows.get(), 0);
        if (id < 0 || id > std::numeric_limits<std::uint32_t>::max() || connections_.size() == most_topics) {
            fail("a topic has the number " + std::to_string(id) + ", allowed are 32 bits, and " +
                 std::to_string(most_topics) + " topics");
        }
        BagConnection& connection = connections_[static_cast<std::uint32_t>(id)];
        connection.topic = text_of(rows.get(), 1);
        connection.type = text_of(rows.get(), 2);
        connection.encoding = text_of(rows.get(), 3);
    }
}

void SqliteBag::read_definitions() {
    const Statement rows = prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
    std::map<std::string, std::pair<std::string, std::shared_ptr<const std::string>>> by_type;
    while (step(rows.get())) {
        count_text(row_bytes);
        const std::string type = text_of(rows.get(), 0);
        const std::string encoding = text_of(rows.get(), 1);
        by_type[type] = {encoding, std::make_shared<const std::string>(text_of(rows.get(), 2))};
    }
    for (auto& [id, connection] : connections_) {
        if (const auto found = by_type.find(connection.type); found != by_type.end()) {
            std::tie(connection.definition_encoding, connection.definition) = found->second;
        }
    }
}

bool SqliteBag::next(Message& message) {
    if (!messages_) {
        return false;
    }
    try {
        if (!step(messages_.get())) {
            messages_.reset();
            return false;
        }
        const std::int64_t id = sqlite3_column_int64(messages_.get(), 0);
        if (begun_ && id <= last_id_) {  // else pages that name each other would never end
            fail("message " + std::to_string(id) + " lies behind message " + std::to_string(last_id_));
        }
        begun_ = true;
        last_id_ = id;
        const std::int64_t topic = sqlite3_column_int64(messages_.get(), 1);
        const auto known = topic < 0 || topic > std::numeric_limits<std::uint32_t>::max()
                               ? connections_.end()
                               : connections_.find(static_cast<std::uint32_t>(topic));
        if (known == connections_.end()) {
            fail("message " + std::to_string(id) + " is of topic " + std::to_string(topic) + ", which is not there");
        }
        message.connection = known->first;
        message.topic = known->second.topic;
        message.log_ns = nanoseconds(sqlite3_column_int64(messages_.get(), 2));
        const void* data = sqlite3_column_blob(messages_.get(), 3);
        message.data = {static_cast<const std::uint8_t*>(data),
                        static_cast<std::size_t>(sqlite3_column_bytes(messages_.get(), 3))};
        position_ += message.data.size();
        return true;
    } catch (const std::exception&) {
        messages_.reset();
        throw;
    }
}

}  // namespace disparityd::formats
