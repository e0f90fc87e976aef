// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap_writer.h"

#include <algorithm>
#include <stdexcept>

#include <zlib.h>
#include <zstd.h>

#include "base/little_endian.h"
#include "formats/mcap_chunk.h"

namespace disparityd::formats {
namespace {

constexpr std::string_view packing = "zstd";
constexpr int compression_level = 1;

void append_number(std::string& to, std::uint64_t value, std::size_t bytes) {
    const std::size_t at = to.size();
    to.resize(at + bytes);
    base::put_little_endian(reinterpret_cast<std::uint8_t*>(to.data()) + at, value, bytes);
}

void append_text(std::string& to, std::string_view text) {
    append_number(to, text.size(), 4);
    to += text;
}

void append_head(std::string& to, McapOpcode opcode, std::uint64_t size) {
    append_number(to, static_cast<std::uint64_t>(opcode), 1);
    append_number(to, size, 8);
}

void append_record(std::string& to, McapOpcode opcode, std::string_view content) {
    append_head(to, opcode, content.size());
    to += content;
}

std::uint32_t checksum_of(std::string_view bytes, std::uint32_t before = 0) {
    return static_cast<std::uint32_t>(::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::uint16_t next_id(std::size_t id) {
    constexpr std::size_t most = 65535;
    if (id > most) {
        throw std::length_error("an MCAP file has at most 65535 schemas, and as many channels");
    }
    return static_cast<std::uint16_t>(id);
}

}  // namespace

void McapStreamWriter::Span::add(std::uint64_t time_ns) {
    first_ns = any ? std::min(first_ns, time_ns) : time_ns;
    last_ns = any ? std::max(last_ns, time_ns) : time_ns;
    any = true;
}

McapStreamWriter::McapStreamWriter(Sink sink, McapLayout layout) : sink_(std::move(sink)), layout_(std::move(layout)) {
    std::string content;
    append_text(content, layout_.profile);
    append_text(content, "disparityd");  // what wrote it
    out_ = mcap_magic;
    append_record(out_, McapOpcode::header, content);
    hand_over();
}

/// Gives the sink what there is.
void McapStreamWriter::hand_over() {
    sink_(out_);
    checksum_ = checksum_of(out_, checksum_);
    position_ += out_.size();
    out_.clear();
}

/// A definition lies in front of the first message that needs it, so that a file that was cut has it.
void McapStreamWriter::define(McapOpcode opcode, const std::string& content) {
    append_record(chunk_, opcode, content);
}

std::uint16_t McapStreamWriter::add_schema(std::string_view name, std::string_view encoding, std::string_view text) {
    const std::uint16_t id = next_id(schemas_.size() + 1);  // 0 is none
    std::string& content = schemas_.emplace_back();
    append_number(content, id, 2);
    append_text(content, name);
    append_text(content, encoding);
    append_text(content, text);
    define(McapOpcode::schema, content);
    return id;
}

std::uint16_t McapStreamWriter::add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding) {
    if (schema > schemas_.size()) {
        throw std::out_of_range("there is no schema " + std::to_string(schema));
    }
    const std::uint16_t id = next_id(channels_.size());
    std::string& content = channels_.emplace_back();
    append_number(content, id, 2);
    append_number(content, schema, 2);
    append_text(content, topic);
    append_text(content, encoding);
    append_number(content, 0, 4);  // nothing more is said of it
    define(McapOpcode::channel, content);
    return id;
}

void McapStreamWriter::write(const McapMessage& message) {
    constexpr std::size_t fields = 2 + 4 + 8 + 8;
    if (message.channel >= channels_.size()) {
        throw std::out_of_range("there is no channel " + std::to_string(message.channel));
    }
    // Definitions may lie in the chunk, too: half of what readers take is enough for any image.
    if (message.data.size() > mcap_most_bytes / 2) {
        throw std::length_error("a message has " + std::to_string(message.data.size()) + " bytes, allowed are up to " +
                                std::to_string(mcap_most_bytes / 2));
    }
    if (chunk_span_.any && message.log_ns >= chunk_span_.first_ns + layout_.chunk_ns) {
        end_chunk();
    }
    entries_[message.channel].emplace_back(message.log_ns, chunk_.size());
    append_head(chunk_, McapOpcode::message, fields + message.data.size());
    append_number(chunk_, message.channel, 2);
    append_number(chunk_, message.sequence, 4);
    append_number(chunk_, message.log_ns, 8);
    append_number(chunk_, message.publish_ns, 8);
    chunk_.append(reinterpret_cast<const char*>(message.data.data()), message.data.size());
    chunk_span_.add(message.log_ns);
    span_.add(message.log_ns);
    if (chunk_.size() >= layout_.chunk_bytes) {
        end_chunk();
    }
}

/// Gives the sink what was written so far. Does nothing where nothing was.
void McapStreamWriter::end_chunk() {
    if (chunk_.empty()) {
        return;
    }
    pack_chunk();
    hand_over();
    for (const auto& [channel, entries] : entries_) {
        counts_[channel] += entries.size();
        messages_ += entries.size();
    }
    chunk_.clear();
    chunk_span_ = {};
    entries_.clear();
}

/// Puts the chunk and its indexes into out_, which is empty.
void McapStreamWriter::pack_chunk() {
    std::string content;
    append_number(content, chunk_span_.first_ns, 8);
    append_number(content, chunk_span_.last_ns, 8);
    append_number(content, chunk_.size(), 8);
    append_number(content, checksum_of(chunk_), 4);
    append_text(content, packing);
    constexpr std::size_t length_bytes = 8;
    const std::size_t begin = mcap_record_head + content.size() + length_bytes;
    out_.resize(begin + ZSTD_compressBound(chunk_.size()));
    const std::size_t packed =
        ZSTD_compress(out_.data() + begin, out_.size() - begin, chunk_.data(), chunk_.size(), compression_level);
    if (ZSTD_isError(packed) != 0) {
        throw std::runtime_error(std::string("zstd cannot pack a chunk: ") + ZSTD_getErrorName(packed));
    }
    out_.resize(begin + packed);
    append_number(content, packed, length_bytes);
    std::string head;
    append_head(head, McapOpcode::chunk, content.size() + packed);
    head += content;
    std::copy(head.begin(), head.end(), out_.begin());

    const std::uint64_t chunk_record = out_.size();
    const std::string offsets = write_message_indexes();
    std::string& index = chunk_indexes_.emplace_back();
    append_number(index, chunk_span_.first_ns, 8);
    append_number(index, chunk_span_.last_ns, 8);
    append_number(index, position_, 8);
    append_number(index, chunk_record, 8);
    append_text(index, offsets);
    append_number(index, out_.size() - chunk_record, 8);
    append_text(index, packing);
    append_number(index, packed, 8);
    append_number(index, chunk_.size(), 8);
}

/// Appends the indexes to out_. Returns where each channel's lies, as the index of the chunk has it.
std::string McapStreamWriter::write_message_indexes() {
    std::string offsets;
    for (const auto& [channel, entries] : entries_) {
        append_number(offsets, channel, 2);
        append_number(offsets, position_ + out_.size(), 8);
        std::string content;
        append_number(content, channel, 2);
        append_number(content, entries.size() * 16, 4);
        for (const auto& [time_ns, offset] : entries) {
            append_number(content, time_ns, 8);
            append_number(content, offset, 8);
        }
        append_record(out_, McapOpcode::message_index, content);
    }
    return offsets;
}

std::string McapStreamWriter::statistics() const {
    std::string content;
    append_number(content, messages_, 8);
    append_number(content, schemas_.size(), 2);
    append_number(content, channels_.size(), 4);
    append_number(content, 0, 4);  // attachments
    append_number(content, 0, 4);  // metadata
    append_number(content, chunk_indexes_.size(), 4);
    append_number(content, span_.first_ns, 8);
    append_number(content, span_.last_ns, 8);
    std::string counts;
    for (const auto& [channel, count] : counts_) {
        append_number(counts, channel, 2);
        append_number(counts, count, 8);
    }
    append_text(content, counts);
    return content;
}

/// Appends records of one kind to the summary in out_, and notes where they lie.
void McapStreamWriter::write_group(McapOpcode opcode, const std::vector<std::string>& contents) {
    const std::uint64_t begin = out_.size();
    for (const std::string& content : contents) {
        append_record(out_, opcode, content);
    }
    if (out_.size() > begin) {
        std::string& offset = summary_offsets_.emplace_back();
        append_number(offset, static_cast<std::uint64_t>(opcode), 1);
        append_number(offset, position_ + begin, 8);
        append_number(offset, out_.size() - begin, 8);
    }
}

void McapStreamWriter::finish() {
    end_chunk();
    std::string data_end;
    append_number(data_end, checksum_, 4);
    append_record(out_, McapOpcode::data_end, data_end);
    hand_over();
    const std::uint64_t summary = position_;
    write_group(McapOpcode::schema, schemas_);
    write_group(McapOpcode::channel, channels_);
    write_group(McapOpcode::statistics, {statistics()});
    write_group(McapOpcode::chunk_index, chunk_indexes_);
    const std::uint64_t offsets = position_ + out_.size();
    for (const std::string& content : summary_offsets_) {
        append_record(out_, McapOpcode::summary_offset, content);
    }
    constexpr std::uint64_t footer_bytes = 8 + 8 + 4;
    append_head(out_, McapOpcode::footer, footer_bytes);
    append_number(out_, summary, 8);
    append_number(out_, offsets, 8);
    append_number(out_, checksum_of(out_), 4);  // of the summary up to here
    out_ += mcap_magic;
    hand_over();
}

}  // namespace disparityd::formats
