// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/mcap_writer.h"

#include <algorithm>
#include <stdexcept>

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include "formats/mcap_fields.h"

namespace disparityd::test {
namespace {

std::string number(std::uint64_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) {
        text.push_back(static_cast<char>(value >> (8 * i)));
    }
    return text;
}

std::string text(std::string_view value) {
    return number(value.size(), 4) + std::string(value);
}

std::string map(const std::string& entries) {
    return number(entries.size(), 4) + entries;
}

std::uint32_t checksum(std::string_view bytes) {
    return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string packed(const std::string& packing, const std::string& bytes) {
    if (packing == "zstd") {
        std::string result(ZSTD_compressBound(bytes.size()), '\0');
        result.resize(ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), 1));
        return result;
    }
    if (packing == "lz4") {
        std::string result(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
        result.resize(LZ4F_compressFrame(result.data(), result.size(), bytes.data(), bytes.size(), nullptr));
        return result;
    }
    return bytes;
}

constexpr int header = 1, footer = 2, schema_record = 3, channel_record = 4, message_record = 5, chunk_record = 6,
              message_index = 7, chunk_index = 8, attachment_record = 9, attachment_index = 10, statistics_record = 11,
              metadata_record = 12, metadata_index = 13, summary_offset = 14, data_end = 15;

}  // namespace

McapWriter::McapWriter(McapFeatures features, std::string_view profile)
    : features_(std::move(features)), file_(formats::mcap_magic) {
    padded_record(file_, header, text(profile) + text("test"));
}

void McapWriter::record(std::string& to, int opcode, const std::string& content) const {
    to += number(static_cast<std::uint64_t>(opcode), 1) + number(content.size(), 8) + content;
}

void McapWriter::padded_record(std::string& to, int opcode, std::string content) const {
    if (features_.padding) {
        content += "\x01\x02\x03";
    }
    record(to, opcode, content);
}

void McapWriter::to_data(int opcode, const std::string& content) {
    const bool may_be_padded = opcode != message_record;
    std::string& to = features_.chunks ? chunk_ : file_;
    may_be_padded ? padded_record(to, opcode, content) : record(to, opcode, content);
}

std::uint16_t McapWriter::schema(std::string_view name, std::string_view encoding, std::string_view definition) {
    const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
    schemas_.push_back(number(id, 2) + text(name) + text(encoding) + text(definition));
    to_data(schema_record, schemas_.back());
    return id;
}

std::uint16_t McapWriter::channel(std::uint16_t schema, std::string_view topic, std::string_view encoding) {
    const auto id = static_cast<std::uint16_t>(channels_.size());
    channels_.push_back(number(id, 2) + number(schema, 2) + text(topic) + text(encoding) + map(text("a") + text("b")));
    to_data(channel_record, channels_.back());
    return id;
}

void McapWriter::message(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns, std::string_view data) {
    if (features_.chunks) {
        chunk_first_ = chunk_entries_.empty() ? time_ns : std::min(chunk_first_, time_ns);
        chunk_last_ = chunk_entries_.empty() ? time_ns : std::max(chunk_last_, time_ns);
        chunk_entries_[channel].emplace_back(time_ns, chunk_.size());
    }
    first_ = counts_.empty() ? time_ns : std::min(first_, time_ns);
    last_ = counts_.empty() ? time_ns : std::max(last_, time_ns);
    ++counts_[channel];
    to_data(message_record,
            number(channel, 2) + number(sequence, 4) + number(time_ns, 8) + number(time_ns, 8) + std::string(data));
    if (features_.chunks && chunk_.size() >= features_.chunk_bytes) {
        close_chunk();
    }
}

void McapWriter::close_chunk() {
    if (chunk_.empty()) {
        return;
    }
    const std::uint64_t begin = file_.size();
    const std::string small = packed(features_.packing, chunk_);
    padded_record(file_, chunk_record,
                  number(chunk_first_, 8) + number(chunk_last_, 8) + number(chunk_.size(), 8) +
                      number(features_.checksums ? checksum(chunk_) : 0, 4) + text(features_.packing) +
                      number(small.size(), 8) + small);
    const std::uint64_t end = file_.size();
    std::string offsets;
    for (const auto& [channel, entries] : chunk_entries_) {
        std::string list;
        for (const auto& [time, offset] : entries) {
            list += number(time, 8) + number(offset, 8);
        }
        if (features_.message_index) {
            offsets += number(channel, 2) + number(file_.size(), 8);
            padded_record(file_, message_index, number(channel, 2) + map(list));
        }
    }
    chunk_indexes_.push_back(number(chunk_first_, 8) + number(chunk_last_, 8) + number(begin, 8) +
                             number(end - begin, 8) + map(offsets) + number(file_.size() - end, 8) +
                             text(features_.packing) + number(small.size(), 8) + number(chunk_.size(), 8));
    ++chunks_;
    chunk_.clear();
    chunk_entries_.clear();
    chunk_first_ = chunk_last_ = 0;
}

void McapWriter::attachment(std::string_view name, std::string_view data) {
    close_chunk();
    const std::uint64_t begin = file_.size();
    std::string content = number(2, 8) + number(1, 8) + text(name) + text("application/octet-stream") +
                          number(data.size(), 8) + std::string(data);
    record(file_, attachment_record, content + number(features_.checksums ? checksum(content) : 0, 4));
    attachment_indexes_.push_back(number(begin, 8) + number(file_.size() - begin, 8) + number(2, 8) + number(1, 8) +
                                  number(data.size(), 8) + text(name) + text("application/octet-stream"));
    ++attachments_;
}

void McapWriter::metadata(std::string_view name, const std::map<std::string, std::string>& entries) {
    close_chunk();
    const std::uint64_t begin = file_.size();
    std::string list;
    for (const auto& [key, value] : entries) {
        list += text(key) + text(value);
    }
    padded_record(file_, metadata_record, text(name) + map(list));
    metadata_indexes_.push_back(number(begin, 8) + number(file_.size() - begin, 8) + text(name));
    ++metadata_;
}

std::string McapWriter::statistics() const {
    std::uint64_t all = 0;
    std::string list;
    for (const auto& [channel, count] : counts_) {
        all += count;
        list += number(channel, 2) + number(count, 8);
    }
    return number(all, 8) + number(schemas_.size(), 2) + number(channels_.size(), 4) + number(attachments_, 4) +
           number(metadata_, 4) + number(chunks_, 4) + number(first_, 8) + number(last_, 8) + map(list);
}

std::vector<McapWriter::Group> McapWriter::write_summary() {
    std::vector<Group> groups;
    const auto group = [&](bool wanted, int opcode, const std::vector<std::string>& records) {
        const std::size_t begin = file_.size();
        for (const std::string& content : records) {
            if (wanted) {
                padded_record(file_, opcode, content);
            }
        }
        if (file_.size() > begin) {
            groups.push_back({opcode, begin, file_.size()});
        }
    };
    group(features_.repeated_schemas, schema_record, schemas_);
    group(features_.repeated_channels, channel_record, channels_);
    group(features_.statistics, statistics_record, {statistics()});
    group(features_.metadata_index, metadata_index, metadata_indexes_);
    group(features_.attachment_index, attachment_index, attachment_indexes_);
    group(features_.chunk_index, chunk_index, chunk_indexes_);
    return groups;
}

std::string McapWriter::close() {
    close_chunk();
    record(file_, data_end, number(features_.checksums ? checksum(file_) : 0, 4));
    const std::size_t summary = file_.size();
    const std::vector<Group> groups = write_summary();
    const std::size_t offsets = file_.size();
    for (const Group& group : groups) {
        if (features_.summary_offsets) {
            padded_record(file_, summary_offset,
                          number(static_cast<std::uint64_t>(group.opcode), 1) + number(group.begin, 8) +
                              number(group.end - group.begin, 8));
        }
    }
    constexpr std::uint64_t footer_bytes = 20;
    file_ += number(footer, 1) + number(footer_bytes, 8) + number(groups.empty() ? 0 : summary, 8) +
             number(file_.size() > offsets ? offsets : 0, 8);
    file_ += number(features_.checksums ? checksum(std::string_view(file_).substr(summary)) : 0, 4);
    return file_ + std::string(formats::mcap_magic);
}

}  // namespace disparityd::test
