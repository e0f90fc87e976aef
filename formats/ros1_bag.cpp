// SPDX-License-Identifier: Apache-2.0
#include "formats/ros1_bag.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "base/little_endian.h"
#include "base/message_text.h"
#include "formats/mcap_chunk.h"
#include "formats/unpack.h"

namespace disparityd::formats {
namespace {

constexpr std::string_view version_line = "#ROSBAG V2.0\n";
constexpr std::size_t length_size = 4;
constexpr std::uint64_t most_header = std::uint64_t{1} << 20U;
constexpr std::size_t most_of_record = 1000;  // fields; ten are enough

/// Kinds of records, as the format numbers them.
enum class Kind : std::uint8_t { message = 2, bag_header = 3, index = 4, chunk = 5, chunk_info = 6, connection = 7 };

std::uint64_t number_of(std::string_view bytes) {
    return base::get_little_endian(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// Takes a length of 32 bits and so many bytes.
std::span<const std::uint8_t> take_part(std::span<const std::uint8_t>& rest) {
    if (rest.size() < length_size) {
        throw std::runtime_error("a record ends too soon");
    }
    const std::uint64_t length = base::get_little_endian(rest.data(), length_size);
    if (length > rest.size() - length_size) {
        throw std::runtime_error("a part of " + std::to_string(length) + " bytes lies in a record that has " +
                                 std::to_string(rest.size() - length_size) + " left");
    }
    const auto part = rest.subspan(length_size, static_cast<std::size_t>(length));
    rest = rest.subspan(length_size + part.size());
    return part;
}

std::string_view text_of(std::span<const std::uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the name of a type as ROS 2 writes it.
std::string type_name(std::string_view type) {
    const auto slash = type.find('/');
    return slash == std::string_view::npos
               ? std::string(type)
               : std::string(type.substr(0, slash)) + "/msg" + std::string(type.substr(slash));
}

}  // namespace

std::uint64_t Ros1Bag::Record::number(std::string_view field, std::size_t size) const {
    const std::string_view bytes = text(field);
    if (bytes.size() != size) {
        throw std::runtime_error("the field " + std::string(field) + " of a record has " +
                                 std::to_string(bytes.size()) + " bytes, expected " + std::to_string(size));
    }
    return number_of(bytes);
}

std::string_view Ros1Bag::Record::text(std::string_view field) const {
    const auto found = fields.find(field);
    if (found == fields.end()) {
        throw std::runtime_error("a record has no field " + std::string(field));
    }
    return found->second;
}

std::map<std::string_view, std::string_view> Ros1Bag::fields_of(Bytes header) {
    std::map<std::string_view, std::string_view> fields;
    while (!header.empty()) {
        if (fields.size() == most_of_record) {
            throw std::runtime_error("a record has more than " + std::to_string(most_of_record) + " fields");
        }
        const std::string_view field = text_of(take_part(header));
        const auto equals = field.find('=');
        if (equals == std::string_view::npos) {
            throw std::runtime_error("a field of a record has no name");
        }
        fields[field.substr(0, equals)] = field.substr(equals + 1);
    }
    return fields;
}

Ros1Bag::Record Ros1Bag::take_record(Bytes& rest) {
    Record record;
    record.fields = fields_of(take_part(rest));
    record.data = take_part(rest);
    return record;
}

Ros1Bag::Ros1Bag(const std::string& path) : file_(path), end_(file_.size()) {
    std::array<std::uint8_t, version_line.size()> begin{};
    if (file_.size() < begin.size()) {
        throw std::invalid_argument(path + ": is no bag of ROS 1: it has " + std::to_string(file_.size()) + " bytes");
    }
    file_.read(begin);
    if (text_of(begin) != version_line) {
        throw std::invalid_argument(path +
                                    ": is no bag of ROS 1 in version 2.0: it does not begin with '#ROSBAG V2.0'; " +
                                    "`rosbag fix` brings older bags to it");
    }
    try {
        read_bag_header();
    } catch (const std::runtime_error& error) {
        file_.fail_with(error);
    }
}

void Ros1Bag::read_bag_header() {
    const Record header = read_record();
    if (header.number("op", 1) != static_cast<std::uint64_t>(Kind::bag_header)) {
        throw std::runtime_error("the first record is not that of the bag");
    }
    if (header.fields.contains("encryptor") && !header.text("encryptor").empty()) {
        throw std::invalid_argument(file_.path() + ": is a bag that was encrypted by '" +
                                    base::printable(header.text("encryptor")) +
                                    "', which is not read; `rosbag decrypt` makes a plain one of it");
    }
    const std::uint64_t index = header.number("index_pos", 8);
    // A bag that was closed has records behind its index_pos, unless it holds nothing.
    cut_off_ = index > file_.size() || (index == file_.size() && header.number("conn_count", 4) > 0);
    if (index >= file_.position() && index < file_.size() && file_.size() - index <= mcap_most_bytes) {
        read_index(index);
    }
}

void Ros1Bag::read_index(std::uint64_t begin) {
    std::vector<std::uint8_t> records(static_cast<std::size_t>(file_.size() - begin));
    if (!file_.read_at(begin, records)) {
        return;
    }
    try {
        take_index(records);
        lists_all_ = true;
        end_ = begin;
    } catch (const std::runtime_error&) {
        connections_.clear();
        text_bytes_ = 0;
    }
}

void Ros1Bag::take_index(Bytes records) {
    while (!records.empty()) {
        const Record record = take_record(records);
        const auto kind = static_cast<Kind>(record.number("op", 1));
        if (kind == Kind::connection) {
            add_connection(record);
        } else if (kind == Kind::chunk_info) {
            count_messages(record);
        }
    }
}

void Ros1Bag::count_messages(const Record& record) {
    constexpr std::size_t entry = 8;
    for (Bytes rest = record.data; rest.size() >= entry; rest = rest.subspan(entry)) {
        const auto found = connections_.find(static_cast<std::uint32_t>(base::get_little_endian(rest.data(), 4)));
        if (found != connections_.end()) {
            found->second.messages = found->second.messages.value_or(0) + base::get_little_endian(rest.data() + 4, 4);
        }
    }
}

void Ros1Bag::add_connection(const Record& record) {
    const auto id = static_cast<std::uint32_t>(record.number("conn", 4));
    if (connections_.contains(id)) {
        return;  // chunks and index repeat it
    }
    Record header;
    header.fields = fields_of(record.data);
    BagConnection connection{std::string(record.text("topic")), type_name(header.text("type")), "ros1", "ros1msg",
                             std::make_shared<const std::string>(header.text("message_definition"))};
    text_bytes_ += connection.topic.size() + connection.type.size() + connection.definition->size() + 100;
    if (text_bytes_ > most_bag_text_bytes) {
        throw std::runtime_error("its topics and definitions have more than " + std::to_string(most_bag_text_bytes) +
                                 " bytes");
    }
    connections_.emplace(id, std::move(connection));
}

bool Ros1Bag::next(Message& message) {
    try {
        for (;;) {
            while (!chunk_.empty()) {
                if (take(take_record(chunk_), message)) {
                    return true;
                }
            }
            if (ended_ || file_.position() >= end_) {
                if (std::exchange(cut_off_, false) && !ended_) {
                    file_.fail_cut_off();
                }
                return false;
            }
            const Record record = read_record();
            if (record.number("op", 1) == static_cast<std::uint64_t>(Kind::chunk)) {
                open_chunk(record);
            } else if (take(record, message)) {
                return true;
            }
        }
    } catch (const std::runtime_error& error) {
        ended_ = true;
        chunk_ = {};
        file_.fail_with(error);
    }
}

bool Ros1Bag::take(const Record& record, Message& message) {
    const auto kind = static_cast<Kind>(record.number("op", 1));
    if (kind == Kind::connection) {
        add_connection(record);
    }
    if (kind != Kind::message) {
        return false;
    }
    constexpr std::uint64_t second_ns = 1'000'000'000;
    const auto known = connections_.find(static_cast<std::uint32_t>(record.number("conn", 4)));
    if (known == connections_.end()) {
        throw std::runtime_error("a message is of connection " + std::to_string(record.number("conn", 4)) +
                                 ", which is not there");
    }
    const std::uint64_t time = record.number("time", 8);  // seconds, then nanoseconds, of 32 bits each
    message.connection = known->first;
    message.topic = known->second.topic;
    message.log_ns = (time & 0xffffffffU) * second_ns + (time >> 32U);
    message.data = record.data;
    return true;
}

void Ros1Bag::open_chunk(const Record& record) {
    const std::string_view packing = record.text("compression");
    const std::uint64_t size = record.number("size", 4);
    if (size > mcap_most_bytes) {
        throw std::runtime_error("a chunk has " + std::to_string(size) + " bytes, allowed are up to " +
                                 std::to_string(mcap_most_bytes));
    }
    if (packing == "none") {
        chunk_ = record.data;
        return;
    }
    if (packing != "bz2" && packing != "lz4") {
        throw std::runtime_error("a chunk is packed by '" + base::printable(packing) +
                                 "', allowed are bz2, lz4 and none");
    }
    unpacked_.clear();  // so that it never has more than it needs
    unpacked_.resize(static_cast<std::size_t>(size));
    packing == "bz2" ? unpack_bz2(record.data, unpacked_) : unpack_lz4(record.data, unpacked_);
    chunk_ = unpacked_;
}

Ros1Bag::Record Ros1Bag::read_record() {
    Record record;
    record.fields = fields_of(read_part(header_, most_header));
    record.data = read_part(data_, mcap_most_bytes);
    return record;
}

Ros1Bag::Bytes Ros1Bag::read_part(std::vector<std::uint8_t>& into, std::uint64_t most) {
    if (file_.left() < length_size) {
        file_.fail_cut_off();
    }
    std::array<std::uint8_t, length_size> length{};
    file_.read(length);
    const std::uint64_t bytes = base::get_little_endian(length.data(), length.size());
    if (bytes > file_.left()) {
        file_.fail_cut_off();
    }
    if (bytes > most) {
        throw std::runtime_error("a part of a record has " + std::to_string(bytes) + " bytes, allowed are up to " +
                                 std::to_string(most));
    }
    into.clear();  // so that it never has more than it needs
    into.resize(static_cast<std::size_t>(bytes));
    file_.read(into);
    return into;
}

}  // namespace disparityd::formats
