// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "formats/mcap_writer.h"

namespace disparityd::formats {

/// An MCAP file that grows under its own name: at any time a reader finds whole chunks in it, and a power cut leaves
/// those of all but the last second or so. Only one process writes a file at a time. Pipes and devices are written to.
/// One thread uses an object at a time.
class McapFile {
public:
    enum class Existing { refused, replaced };

    /// Makes the file, readable by its owner and group, as it shows what a camera saw. Throws std::invalid_argument
    /// with one line where there is one that is to stay, std::runtime_error where the system refuses or another process
    /// writes it.
    McapFile(const std::string& path, Existing existing, McapLayout layout = {});
    ~McapFile() = default;  ///< without finish() what is there stays, and has no summary
    McapFile(const McapFile&) = delete;
    McapFile& operator=(const McapFile&) = delete;

    /// What of McapStreamWriter is needed outside. They throw as it does, and base::DiskFull or std::runtime_error
    /// where the system refuses: the file then ends behind its last whole chunk, and nothing more may be written.
    std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view text);
    std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding);
    void write(const McapMessage& message) { writer_.write(message); }

    /// Ends the file and waits until the disk has it. Throws as write().
    void finish();

    // What the file has, also after one of them has thrown.
    std::uint64_t messages() const { return writer_.messages(); }
    std::uint64_t bytes() const { return writer_.bytes(); }
    const std::map<std::uint16_t, std::uint64_t>& messages_of_channels() const {
        return writer_.messages_of_channels();
    }

private:
    /// An open file, closed at the end of the object's life.
    struct OpenFile {
        OpenFile(const std::string& path, Existing existing);
        ~OpenFile();
        OpenFile(const OpenFile&) = delete;
        OpenFile& operator=(const OpenFile&) = delete;

        bool special = false;  ///< a pipe or a device
        int descriptor = -1;
    };

    void append(std::string_view bytes);
    void sync();

    const std::string path_;
    OpenFile file_;
    std::uint64_t size_ = 0;  ///< of what is whole
    std::chrono::steady_clock::time_point next_sync_;
    McapStreamWriter writer_;  ///< the last: it writes when it is made
};

}  // namespace disparityd::formats
