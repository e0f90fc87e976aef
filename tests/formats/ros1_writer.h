// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace disparityd::test {

/// Makes a bag of ROS 1, version 2.0, as a text in memory.
class Ros1Writer {
public:
    /// `packing` of chunks: "none", "bz2", "lz4". A bag without an index is one that was not closed.
    explicit Ros1Writer(std::string packing = "none", bool index = true);

    std::uint32_t connection(const std::string& topic, const std::string& type, const std::string& definition);
    void message(std::uint32_t connection, std::int64_t time_ns, const std::string& data);

    /// Ends the chunk; the messages that follow begin another one.
    void end_chunk();

    std::string close();

    /// Returns numbers as ROS 1 writes them.
    static std::string u8(std::uint8_t value) { return std::string(1, static_cast<char>(value)); }
    static std::string u32(std::uint64_t value);
    static std::string text(std::string_view value) { return u32(value.size()) + std::string(value); }

private:
    using Fields = std::vector<std::pair<std::string, std::string>>;
    static std::string record(const Fields& fields, const std::string& data);

    const std::string packing_;
    const bool index_;
    std::string file_;
    std::string chunk_;
    std::vector<std::string> connections_;
    std::map<std::uint32_t, std::uint32_t> counts_;  ///< of the chunk
    std::vector<std::string> chunk_infos_;
};

}  // namespace disparityd::test
