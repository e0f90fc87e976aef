// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/ros1_writer.h"

#include <bzlib.h>
#include <lz4frame.h>

namespace disparityd::test {
namespace {

constexpr std::size_t header_size = 4096;

std::string packed(const std::string& data, const std::string& packing) {
    std::string result(data.size() + 4096 + LZ4F_compressFrameBound(data.size(), nullptr), '\0');
    if (packing == "bz2") {
        auto size = static_cast<unsigned>(result.size());
        BZ2_bzBuffToBuffCompress(result.data(), &size, const_cast<char*>(data.data()),
                                 static_cast<unsigned>(data.size()), 9, 0, 0);
        result.resize(size);
        return result;
    }
    if (packing == "lz4") {
        result.resize(LZ4F_compressFrame(result.data(), result.size(), data.data(), data.size(), nullptr));
        return result;
    }
    return data;
}

}  // namespace

Ros1Writer::Ros1Writer(std::string packing, bool index)
    : packing_(std::move(packing)), index_(index), file_("#ROSBAG V2.0\n" + std::string(header_size, ' ')) {}

std::string Ros1Writer::u32(std::uint64_t value) {
    std::string bytes;
    for (unsigned i = 0; i < 4; ++i) {
        bytes += static_cast<char>(value >> (8 * i));
    }
    return bytes;
}

std::string Ros1Writer::record(const Fields& fields, const std::string& data) {
    std::string header;
    for (const auto& [name, value] : fields) {
        header += text(name + "=" + value);
    }
    return text(header) + text(data);
}

std::uint32_t Ros1Writer::connection(const std::string& topic, const std::string& type, const std::string& definition) {
    const auto id = static_cast<std::uint32_t>(connections_.size());
    const std::string header =
        text("topic=" + topic) + text("type=" + type) + text("md5sum=*") + text("message_definition=" + definition);
    connections_.push_back(record({{"op", u8(7)}, {"conn", u32(id)}, {"topic", topic}}, header));
    chunk_ += connections_.back();
    return id;
}

void Ros1Writer::message(std::uint32_t connection, std::int64_t time_ns, const std::string& data) {
    const auto time = static_cast<std::uint64_t>(time_ns);
    constexpr std::uint64_t second = 1'000'000'000;
    chunk_ +=
        record({{"op", u8(2)}, {"conn", u32(connection)}, {"time", u32(time / second) + u32(time % second)}}, data);
    ++counts_[connection];
}

void Ros1Writer::end_chunk() {
    const std::string place = u32(file_.size()) + u32(0);
    file_ += record({{"op", u8(5)}, {"compression", packing_}, {"size", u32(chunk_.size())}}, packed(chunk_, packing_));
    std::string counts;
    for (const auto& [id, count] : counts_) {
        counts += u32(id) + u32(count);
        file_ += record({{"op", u8(4)}, {"ver", u32(1)}, {"conn", u32(id)}, {"count", u32(0)}}, "");
    }
    chunk_infos_.push_back(record({{"op", u8(6)},
                                   {"ver", u32(1)},
                                   {"chunk_pos", place},
                                   {"start_time", u32(0) + u32(0)},
                                   {"end_time", u32(0) + u32(0)},
                                   {"count", u32(counts_.size())}},
                                  counts));
    chunk_.clear();
    counts_.clear();
}

std::string Ros1Writer::close() {
    if (!chunk_.empty()) {
        end_chunk();
    }
    const std::uint64_t index = index_ ? file_.size() : 0;
    const std::size_t begin = std::string_view("#ROSBAG V2.0\n").size();
    const Fields fields{{"op", u8(3)},
                        {"index_pos", u32(index) + u32(0)},
                        {"conn_count", u32(connections_.size())},
                        {"chunk_count", u32(chunk_infos_.size())}};
    const std::string bare = record(fields, "");
    file_.replace(begin, header_size, record(fields, std::string(header_size - bare.size(), ' ')));
    if (index_) {
        for (const auto* records : {&connections_, &chunk_infos_}) {
            for (const std::string& text : *records) {
                file_ += text;
            }
        }
    }
    return std::move(file_);
}

}  // namespace disparityd::test
