// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap_reader.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <zlib.h>

#include "base/little_endian.h"
#include "formats/mcap_chunk.h"

namespace disparityd::formats {
namespace {

constexpr std::size_t footer_size = 20;

/// The end of a file that was closed: the footer's record, then the magic bytes.
constexpr std::size_t tail_size = mcap_record_head + footer_size + 8;

}  // namespace

McapReader::McapReader(const std::string& path) : file_(path) {
    std::array<std::uint8_t, mcap_magic.size()> magic{};
    if (file_.size() < magic.size()) {
        throw std::invalid_argument(path + ": is no MCAP file: it has " + std::to_string(file_.size()) + " bytes");
    }
    read_summary();
    read_bytes(magic);
    if (std::memcmp(magic.data(), mcap_magic.data(), magic.size()) != 0) {
        throw std::invalid_argument(path + ": is no MCAP file: it does not begin as one");
    }
}

void McapReader::read_summary() {
    if (file_.size() < mcap_magic.size() + tail_size) {
        return;
    }
    std::array<std::uint8_t, tail_size> tail{};
    if (!file_.read_at(file_.size() - tail.size(), tail) ||
        std::memcmp(tail.data() + tail.size() - mcap_magic.size(), mcap_magic.data(), mcap_magic.size()) != 0 ||
        tail[0] != static_cast<std::uint8_t>(McapOpcode::footer)) {
        return;
    }
    McapFields footer(std::span<const std::uint8_t>(tail).subspan(mcap_record_head, footer_size));
    const std::uint64_t start = footer.u64();
    footer.u64();
    const std::uint32_t checksum = footer.u32();
    const std::uint64_t end = file_.size() - tail.size();
    if (start < mcap_magic.size() || start > end || end - start > mcap_most_bytes) {
        return;
    }
    std::vector<std::uint8_t> records(static_cast<std::size_t>(end - start));
    if (!file_.read_at(start, records)) {
        return;
    }
    const std::uint32_t of_records = static_cast<std::uint32_t>(::crc32_z(0, records.data(), records.size()));
    constexpr std::size_t checked = mcap_record_head + footer_size - 4;  // up to the checksum itself
    if (checksum != 0 && checksum != ::crc32_z(of_records, tail.data(), checked)) {
        return;
    }
    try {
        take_summary(records);
    } catch (const std::runtime_error&) {
        definitions_ = McapDefinitions();
        counts_.reset();
        has_summary_ = false;
    }
}

void McapReader::take_summary(std::span<const std::uint8_t> records) {
    McapFields rest(records);
    while (!rest.rest().empty()) {
        const auto opcode = static_cast<McapOpcode>(rest.number(1));
        const auto content = rest.bytes(rest.u64());
        if (!definitions_.take(opcode, content) && opcode == McapOpcode::statistics) {
            take_statistics(content);
        }
    }
    // Writers may leave the channels out of the summary.
    has_summary_ = !definitions_.channels().empty();
}

void McapReader::take_statistics(std::span<const std::uint8_t> content) {
    McapFields fields(content);
    constexpr std::size_t before_the_counts = 8 + 2 + 4 + 4 + 4 + 4 + 8 + 8;
    fields.bytes(before_the_counts);
    McapFields entries(fields.bytes(fields.u32()));
    counts_.emplace();
    while (!entries.rest().empty()) {
        const std::uint16_t channel = entries.u16();
        (*counts_)[channel] = entries.u64();
    }
}

std::optional<std::uint64_t> McapReader::message_count(std::uint16_t channel) const {
    if (!counts_) {
        return std::nullopt;
    }
    const auto found = counts_->find(channel);
    return found == counts_->end() ? 0 : found->second;
}

bool McapReader::next(McapMessage& message) {
    try {
        for (;;) {
            if (next_of_chunk(message)) {
                return true;
            }
            const auto head = ended_ ? std::nullopt : next_head();
            if (!head) {
                return false;
            }
            if (read_record(*head, message)) {
                return true;
            }
        }
    } catch (const std::runtime_error& error) {
        ended_ = true;
        chunk_ = {};
        file_.fail_with(error);
    }
}

bool McapReader::next_of_chunk(McapMessage& message) {
    while (!chunk_.empty()) {
        McapFields rest(chunk_);
        const auto opcode = static_cast<McapOpcode>(rest.number(1));
        const auto content = rest.bytes(rest.u64());
        chunk_ = rest.rest();
        if (!definitions_.take(opcode, content) && opcode == McapOpcode::message) {
            message = known_message(content);
            return true;
        }
    }
    return false;
}

McapMessage McapReader::known_message(std::span<const std::uint8_t> content) const {
    const McapMessage message = mcap_message(content);
    if (!definitions_.channels().contains(message.channel)) {
        throw std::runtime_error("a message is of channel " + std::to_string(message.channel) + ", which is not there");
    }
    return message;
}

std::optional<McapReader::RecordHead> McapReader::next_head() {
    if (file_.left() < mcap_record_head) {
        file_.fail_cut_off();
    }
    std::array<std::uint8_t, mcap_record_head> bytes{};
    const std::uint32_t before = checksum_;
    read_bytes(bytes);
    const RecordHead head{static_cast<McapOpcode>(bytes[0]), base::get_little_endian(bytes.data() + 1, 8)};
    if (head.length > file_.left()) {
        file_.fail_cut_off();
    }
    if (head.opcode == McapOpcode::data_end || head.opcode == McapOpcode::footer) {
        ended_ = true;
        if (head.opcode == McapOpcode::data_end) {
            check_data_end(read_content(head.length), before);
        }
        return std::nullopt;
    }
    return head;
}

bool McapReader::read_record(const RecordHead& head, McapMessage& message) {
    switch (head.opcode) {
        case McapOpcode::chunk: chunk_ = mcap_chunk_records(read_content(head.length), unpacked_); return false;
        case McapOpcode::schema:
        case McapOpcode::channel: definitions_.take(head.opcode, read_content(head.length)); return false;
        case McapOpcode::message: message = known_message(read_content(head.length)); return true;
        case McapOpcode::attachment: skip_attachment(head.length); return false;
        default: skip_content(head.length); return false;
    }
}

void McapReader::read_bytes(std::span<std::uint8_t> into) {
    file_.read(into);
    checksum_ = static_cast<std::uint32_t>(::crc32_z(checksum_, into.data(), into.size()));
}

std::span<const std::uint8_t> McapReader::read_content(std::uint64_t length) {
    if (length > mcap_most_bytes) {
        throw std::runtime_error("a record has " + std::to_string(length) + " bytes, allowed are up to " +
                                 std::to_string(mcap_most_bytes));
    }
    record_.clear();  // so that it never has more than it needs
    record_.resize(static_cast<std::size_t>(length));
    read_bytes(record_);
    return record_;
}

/// What is not used is read all the same: the checksum of the data covers it.
void McapReader::skip_content(std::uint64_t length) {
    constexpr std::uint64_t piece = std::uint64_t{1} << 20U;
    for (std::uint64_t left = length; left > 0;) {
        const std::uint64_t size = std::min(left, piece);
        read_content(size);
        left -= size;
    }
}

void McapReader::skip_attachment(std::uint64_t length) {
    constexpr std::uint64_t checksum_bytes = 4;
    if (length < checksum_bytes) {
        throw std::runtime_error("an attachment has " + std::to_string(length) + " bytes");
    }
    const std::uint32_t of_all = std::exchange(checksum_, 0);
    skip_content(length - checksum_bytes);
    const std::uint32_t found = checksum_;
    checksum_ =
        static_cast<std::uint32_t>(::crc32_combine(of_all, found, static_cast<z_off_t>(length - checksum_bytes)));
    const std::uint64_t stated = base::get_little_endian(read_content(checksum_bytes).data(), checksum_bytes);
    if (stated != 0 && stated != found) {
        throw std::runtime_error("the checksum of an attachment is wrong");
    }
}

void McapReader::check_data_end(std::span<const std::uint8_t> content, std::uint32_t checksum) const {
    const std::uint32_t stated = McapFields(content).u32();
    if (stated != 0 && stated != checksum) {
        throw std::runtime_error("the checksum of the data is wrong");
    }
}

}  // namespace disparityd::formats
