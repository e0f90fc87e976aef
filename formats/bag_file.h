// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

namespace disparityd::formats {

/// A file of records that is read from its begin to its end, with the words for what is wrong with it. All that is
/// thrown is one line that begins with the path. One thread uses an object at a time.
class BagFile {
public:
    /// Throws std::invalid_argument where there is no such file, std::runtime_error where it cannot be read.
    explicit BagFile(const std::string& path);

    const std::string& path() const { return path_; }
    std::uint64_t size() const { return size_; }

    /// Returns how many bytes were read.
    std::uint64_t position() const { return position_; }

    /// Returns how many bytes follow.
    std::uint64_t left() const { return size_ - position_; }

    /// Reads the bytes that follow. Throws std::runtime_error.
    void read(std::span<std::uint8_t> into);

    /// Reads bytes from another place; the position stays. Returns false where they cannot be read.
    bool read_at(std::uint64_t begin, std::span<std::uint8_t> into);

    /// Throws std::runtime_error: the file is damaged where it is read now.
    [[noreturn]] void fail(const std::string& what) const;

    /// Throws std::runtime_error: the file ends too soon.
    [[noreturn]] void fail_cut_off() const;

    /// Called by the handler of `error`: throws it again, with the file and the place where it does not tell them yet.
    [[noreturn]] void fail_with(const std::runtime_error& error) const;

private:
    std::string path_;
    std::ifstream file_;
    std::uint64_t size_ = 0;
    std::uint64_t position_ = 0;
};

}  // namespace disparityd::formats
