// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/db3_writer.h"

#include <map>
#include <stdexcept>

#include <sqlite3.h>
#include <zstd.h>

#include "formats/mcap_bag.h"

namespace disparityd::test {
namespace {

std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) {
        result += c == '\'' ? "''" : std::string(1, c);
    }
    return result + "'";
}

std::string blob(std::string_view data) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string result = "x'";
    for (const char c : data) {
        const auto byte = static_cast<unsigned char>(c);
        result += digits[byte / 16U];
        result += digits[byte % 16U];
    }
    return result + "'";
}

std::string packed(std::string_view data) {
    std::string result(ZSTD_compressBound(data.size()), '\0');
    result.resize(ZSTD_compress(result.data(), result.size(), data.data(), data.size(), 1));
    return result;
}

}  // namespace

void run_sql(const std::string& database, const std::string& sql) {
    sqlite3* made = nullptr;
    sqlite3_open(database.c_str(), &made);
    const int result = sqlite3_exec(made, sql.c_str(), nullptr, nullptr, nullptr);
    const std::string message = sqlite3_errmsg(made);
    sqlite3_close(made);
    if (result != SQLITE_OK) {
        throw std::runtime_error(database + ": " + message);
    }
}

void write_db3(const std::string& mcap, const std::string& db3, const Db3Features& features) {
    formats::McapBag bag(mcap);
    std::string sql =
        "BEGIN; CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT "
        "NOT NULL, offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data "
        "BLOB "
        "NOT NULL);";
    if (features.definitions) {
        sql +=
            "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT "
            "NULL, encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);";
    }
    std::map<std::string, std::string> definitions;
    for (const auto& [id, connection] : bag.connections()) {
        sql += "INSERT INTO topics VALUES(" + std::to_string(id) + "," + quoted(connection.topic) + "," +
               quoted(connection.type) + ",'cdr','','');";
        definitions[connection.type] = *connection.definition;
    }
    for (const auto& [type, definition] : definitions) {
        if (features.definitions) {
            sql +=
                "INSERT INTO message_definitions(topic_type,encoding,encoded_message_definition,type_description_"
                "hash) VALUES(" +
                quoted(type) + ",'ros2msg'," + quoted(definition) + ",'');";
        }
    }
    formats::RosBag::Message message;
    while (bag.next(message)) {
        const std::string_view data(reinterpret_cast<const char*>(message.data.data()), message.data.size());
        sql += "INSERT INTO messages(topic_id,timestamp,data) VALUES(" + std::to_string(message.connection) + "," +
               std::to_string(message.log_ns) + "," + blob(features.packed ? packed(data) : std::string(data)) + ");";
    }
    sql += features.index ? "CREATE INDEX timestamp_idx ON messages (timestamp ASC);COMMIT;" : "COMMIT;";
    run_sql(db3, sql);
}

}  // namespace disparityd::test
