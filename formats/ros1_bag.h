// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "formats/bag_file.h"
#include "formats/ros_bag.h"

namespace disparityd::formats {

/// A bag of ROS 1 (http://wiki.ros.org/Bags/Format/2.0), with chunks packed by bz2, lz4 or not at all. ROS's own
/// library is not used: some damaged files end the program that it reads them in.
class Ros1Bag final : public RosBag {
public:
    /// Opens the file and reads its index, where it has one. An index that is damaged counts as none. Throws as
    /// open_ros_bag().
    explicit Ros1Bag(const std::string& path);

    const std::map<std::uint32_t, BagConnection>& connections() const override { return connections_; }
    bool lists_all() const override { return lists_all_; }
    bool next(Message& message) override;
    std::uint64_t position() const override { return file_.position(); }

private:
    using Bytes = std::span<const std::uint8_t>;

    /// The fields of a record's header, and what follows it.
    struct Record {
        std::map<std::string_view, std::string_view> fields;
        Bytes data;

        std::uint64_t number(std::string_view field, std::size_t size) const;
        std::string_view text(std::string_view field) const;
    };

    static std::map<std::string_view, std::string_view> fields_of(Bytes header);
    static Record take_record(Bytes& rest);
    void read_bag_header();
    void read_index(std::uint64_t begin);
    void take_index(Bytes records);
    void count_messages(const Record& record);
    void add_connection(const Record& record);
    bool take(const Record& record, Message& message);
    void open_chunk(const Record& record);
    Record read_record();
    Bytes read_part(std::vector<std::uint8_t>& into, std::uint64_t most);

    BagFile file_;
    std::uint64_t end_;  ///< where the index begins, or the file ends
    bool lists_all_ = false;
    bool cut_off_ = false;  ///< the index is not there, as the header says it is; false once that was told
    bool ended_ = false;
    std::map<std::uint32_t, BagConnection> connections_;
    std::size_t text_bytes_ = 0;          ///< of all names and definitions
    std::vector<std::uint8_t> header_;    ///< of the record that was read last
    std::vector<std::uint8_t> data_;      ///< its data
    std::vector<std::uint8_t> unpacked_;  ///< a chunk
    Bytes chunk_;                         ///< what of the chunk was not read yet
};

}  // namespace disparityd::formats
