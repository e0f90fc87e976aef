// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "formats/ros_bag.h"

struct sqlite3;
struct sqlite3_stmt;

namespace disparityd::formats {

/// A bag of ROS 2 in a .db3 file, which is a database of SQLite: tables `topics` and `messages`, newer ones
/// `message_definitions`. The file is only read, and nothing in it is run: views, triggers and computed columns are
/// refused.
class SqliteBag final : public RosBag {
public:
    /// Throws as open_ros_bag().
    explicit SqliteBag(const std::string& path);

    const std::map<std::uint32_t, BagConnection>& connections() const override { return connections_; }
    bool lists_all() const override { return true; }
    bool next(Message& message) override;
    std::uint64_t position() const override { return position_; }

private:
    struct Close {
        void operator()(sqlite3* database) const;
        void operator()(sqlite3_stmt* statement) const;
    };
    using Statement = std::unique_ptr<sqlite3_stmt, Close>;

    void open();
    void check_table(const std::string& name) const;
    bool has_table(const std::string& name) const;
    void read_topics();
    void read_definitions();
    void count_text(std::size_t bytes);
    std::string text_of(sqlite3_stmt* row, int column);
    Statement prepare(const std::string& query) const;
    bool step(sqlite3_stmt* statement) const;
    [[noreturn]] void fail(const std::string& what) const;
    [[noreturn]] void fail_of_database() const;

    const std::string path_;
    std::unique_ptr<sqlite3, Close> database_;
    std::map<std::uint32_t, BagConnection> connections_;
    std::size_t text_bytes_ = 0;  ///< of all names and definitions
    Statement messages_;          ///< ended: none
    std::int64_t last_id_ = 0;    ///< of the last message
    bool begun_ = false;
    std::uint64_t position_ = 0;
};

}  // namespace disparityd::formats
